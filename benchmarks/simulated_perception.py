"""Measure what docs/simulated_perception.md says about simulated perception, and draw its picture.

    python -m benchmarks.simulated_perception --picture docs/pictures/simulated_perception.svg [--episodes FILE]

Everything is measured by running detector and matcher on frames; only the drawn lines are the settings' curves.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from sim import Furniture, World, WorldObject, load_world, read_objects
from sim.camera import SimCamera
from sim.frame import SimFrame
from sim.oracle import Oracle
from sim.perception import DetectorSettings, SimDetector, SimMatcher
from sim.perception.curves import detection_chance
from sim.scene import Scene
from sim.worlds import builtin_world
from zavis_bt.geometry import aim
from zavis_bt.types import FREE, UNKNOWN_CLASS, Box, CameraIntrinsics, CameraSpec, Candidate, GridMap, Pose2D, entropy

SPEC = CameraSpec(CameraIntrinsics.from_fov(640, 480, math.radians(60)), 0.0, 0.9, 0.3, 8.0, 15.0)
FOCAL = SPEC.intrinsics.fx
THRESHOLD = 29.0


def similarity() -> Callable[[str, str], float]:
    """Cosine of word vectors, as missions use it."""
    import wordllama

    model = wordllama.WordLlama.load(cache_dir=os.path.dirname(wordllama.__file__), disable_download=True)
    vectors: dict[str, np.ndarray] = {}

    def alike(a: str, b: str) -> float:
        for word in (a, b):
            if word not in vectors:
                vectors[word] = model.embed([word], norm=True)[0]
        return float(vectors[a] @ vectors[b])

    return alike


def empty_room(furniture: Sequence[Furniture] = (), objects: Sequence[WorldObject] = ()) -> World:
    states = np.full((200, 400), FREE, dtype=np.int8)
    return World("empty", GridMap(states, 0.05, (0.0, 0.0)), 2.5, tuple(furniture), tuple(objects))


def cube(side: float, distance: float, name: str = "mug") -> WorldObject:
    return WorldObject(f"{name}_1", name, 1.0 + distance + side / 2, 5.0, 0.9 - side / 2, (side, side, side))


def frame_of(world: World, x: float = 1.0, y: float = 5.0, stamp: float = 0.0) -> SimFrame:
    target = world.objects[0] if world.objects else world.furniture[0]
    base = Pose2D(x, y)
    pan, _ = aim(base, SPEC, (target.x, target.y, 0.9))
    return SimCamera(Scene.of(world), SPEC).capture(base, pan, 0.0, stamp)


def detectors(count: int, false_positives: float = 0.0) -> Iterator[SimDetector]:
    settings = DetectorSettings(false_positives=false_positives)
    for seed in range(count):
        yield SimDetector(["sofa", "dining table", "tv monitor"], np.random.default_rng(seed), settings)


def rates_by_size(sizes: Sequence[float], count: int) -> list[float]:
    """Share of detectors that find a cube of this many pixels in one frame."""
    frames = [frame_of(empty_room(objects=[cube(0.1, 0.1 * FOCAL / size)])) for size in sizes]
    return [float(np.mean([bool(judge.detect(frame)) for judge in detectors(count)])) for frame in frames]


def rates_by_fraction(offsets: Sequence[float], count: int) -> list[tuple[float, float]]:
    """Visible fraction and share found, of a cube of 60 px behind a screen that covers a part of it."""
    rows = []
    for offset in offsets:
        screen = Furniture("shelf_1", "shelf", 3.0, 5.0 - 1.0 + offset, 0.0, 0.1, 2.0, 2.0)
        box = cube(0.4, 0.4 * FOCAL / 60)
        world = empty_room([screen], [box])
        frame = SimCamera(Scene.of(world), SPEC).capture(Pose2D(1.0, 5.0), 0.0, 0.0, 0.0)
        view = next((view for view in frame.instances if view.id == box.id), None)
        if view is None:
            continue
        hits = [any(one.box.iou(view.box) > 0.3 for one in judge.detect(frame)) for judge in detectors(count)]
        rows.append((view.visible_fraction, float(np.mean(hits))))
    return rows


def rates_by_looks(size: float, looks: int, count: int, moving: bool) -> list[float]:
    """Share found at least once after 1, 2, … looks, from one place or each from another one around the cube."""
    distance = 0.1 * FOCAL / size
    box = cube(0.1, distance)
    frames = []
    for k in range(looks):
        turn = math.pi / 8 * k if moving else 0.0
        x, y = box.x - (distance + 0.05) * math.cos(turn), box.y + (distance + 0.05) * math.sin(turn)
        frames.append(frame_of(empty_room(objects=[box]), x, y, float(k)))
    found = np.array([[bool(judge.detect(frame)) for frame in frames] for judge in detectors(count)])
    return np.maximum.accumulate(found, axis=1).mean(axis=0).tolist()


def scores_of(
    category: str, texts: Sequence[str], size: float, count: int, alike: Callable[[str, str], float]
) -> np.ndarray:
    """Scores (count, texts) of the cube's own box, over matchers."""
    frame = frame_of(empty_room(objects=[cube(0.1, 0.1 * FOCAL / size, category)]))
    box = frame.instances[0].box
    return np.array(
        [SimMatcher(alike, np.random.default_rng(seed)).match(frame, [box], texts)[0] for seed in range(count)]
    )


def label_entropy(category: str, names: Sequence[str], views: int, count: int, alike: Callable[[str, str], float]):
    """Mean entropy of the fused label and share of right labels after 1, 2, … views of a piece of furniture."""
    world = empty_room([Furniture("piece_1", category, 3.0, 5.0, 0.0, 0.8, 1.2, 0.7)])
    frames = [frame_of(world, stamp=float(k)) for k in range(views)]
    spread, right = np.empty((count, views)), np.empty((count, views))
    for seed in range(count):
        matcher = SimMatcher(alike, np.random.default_rng(seed))
        total = np.zeros(len(names))
        for k, frame in enumerate(frames):
            total += matcher.match(frame, [frame.instances[0].box], names)[0]
            mean = total / (k + 1) * math.sqrt(k + 1)
            label = np.exp(mean - mean.max())
            spread[seed, k] = entropy(label / label.sum())
            right[seed, k] = names[int(np.argmax(total))] == category
    return spread.mean(axis=0), right.mean(axis=0)


def viewpoints(world: World, piece: Furniture) -> Iterator[Pose2D]:
    """The nearest place of each of eight bearings, 0.7 to 2 m from the middle of a piece of furniture."""
    for bearing in np.arange(8) * math.tau / 8:
        for distance in (0.7, 1.0, 1.3, 1.6, 2.0):
            x, y = piece.x + distance * math.cos(bearing), piece.y + distance * math.sin(bearing)
            if world.fits(x, y, 0.18):
                yield Pose2D(x, y, bearing + math.pi)
                break


def search(path: Path, per_landmark: int, count: int, alike: Callable[[str, str], float]) -> dict[str, float]:
    """Look at every piece of furniture of rooms from some viewpoints, nine frames each; is the target confirmed?"""
    lines = path.read_text().splitlines()
    rng = np.random.default_rng(0)
    confirmed, asked, wrong, frames, things = 0, 0, 0, 0, 0
    seconds = np.zeros(3)
    for line in (lines[k] for k in rng.choice(len(lines), count, replace=False)):
        episode = json.loads(line)
        world = load_world(path.parent / episode["world"])
        world = world.with_objects(read_objects(episode["objects"], str(path)))
        camera, seed = SimCamera(Scene.of(world), SPEC), int(rng.integers(2**31))
        detector = SimDetector(["tv monitor", "sofa", "dining table"], np.random.default_rng(seed))
        matcher, text = SimMatcher(alike, np.random.default_rng(seed + 1)), episode["target"]["category"]
        oracle, found = Oracle(episode["target"]["instances"]), False
        for piece in world.furniture:
            poses = list(viewpoints(world, piece))
            for pose in (poses[k] for k in rng.permutation(len(poses))[:per_landmark]):
                for pan, tilt in itertools.product((-0.42, 0.0, 0.42), (0.1, -0.25, -0.6)):
                    frame, frames = camera.capture(pose, pan, tilt, float(frames)), frames + 1
                    marks = [time.thread_time()]
                    shown = frame.instances
                    marks.append(time.thread_time())
                    result = detector.detect(frame)
                    marks.append(time.thread_time())
                    boxes = [one.box for one in result if one.label == UNKNOWN_CLASS]
                    scores = matcher.match(frame, boxes, [text])[:, 0]
                    marks.append(time.thread_time())
                    seconds += np.diff(marks)
                    things += len(shown)
                    for box in (box for box, score in zip(boxes, scores, strict=True) if score > THRESHOLD):
                        answer = oracle.ask(text, [Candidate(text, 0.0, box, (0.0, 0.0, 0.0), frame)]).result()
                        asked, wrong = asked + 1, wrong + (answer.accepted is None)
                        found |= answer.accepted is not None
        confirmed += found
    names = ("instances ms", "detect ms", "match ms")
    times = dict(zip(names, (seconds / frames * 1e3).round(3).tolist(), strict=True))
    return {
        "confirmed": confirmed / count,
        "frames": frames / count,
        "wrong share": wrong / max(asked, 1),
        "in sight": things / frames,
        **times,
    }


def speed(name: str) -> None:
    """Median times of frames all over a world that comes along."""
    world = load_world(builtin_world(name))
    scene, rng, rounds = Scene.of(world), np.random.default_rng(0), 40
    for width, height in ((640, 480), (160, 120)):
        spec = replace(SPEC, intrinsics=CameraIntrinsics.from_fov(width, height, math.radians(60)))
        camera, times = SimCamera(scene, spec), []
        depths = partial(SimFrame.depth_at, pixels=rng.integers(0, (width, height), (200, 2)))
        for k in range(rounds):
            start = world.starts[k % len(world.starts)]
            frame = camera.capture(start, rng.uniform(-math.pi, math.pi), -0.3, 0.0)
            marks = [time.thread_time()]
            for work in (SimFrame.instances.func, depths, SimFrame.rgb.fget):
                work(frame)
                marks.append(time.thread_time())
            times.append(np.diff(marks) * 1e3)
        median, worst = np.median(times[1:], axis=0), np.max(times[1:], axis=0)
        for what, typical, most in zip(("instances", "200 depths", "image"), median, worst, strict=True):
            print(f"{name} {width}x{height} {what}: median {typical:.2f} ms, worst {most:.2f} ms")


def picture(path: Path, measured: list[tuple[float, float]], scores: dict[str, np.ndarray]) -> None:
    """Draw chances of detection over size, and distributions of scores."""
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 360" font-family="sans-serif" font-size="12">']
    parts.append('<rect width="900" height="360" fill="white"/>')
    sizes = np.geomspace(4, 300, 150)

    def at(size: float, chance: float) -> tuple[float, float]:
        return 60 + 350 * math.log(size / 4) / math.log(75), 310 - 270 * chance

    for fraction, colour in ((1.0, "#1f77b4"), (0.4, "#2ca02c"), (0.2, "#d62728")):
        chances = detection_chance(sizes, sizes, np.full(150, fraction), False, DetectorSettings())
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(at, sizes.tolist(), chances.tolist()))
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        x, y = at(300, float(chances[-1]))
        parts.append(
            f'<text x="{x - 4:.0f}" y="{y - 6:.0f}" text-anchor="end" fill="{colour}">{fraction:.0%} visible</text>'
        )
    for size, chance in measured:
        x, y = at(size, chance)
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="none" stroke="#1f77b4" stroke-width="2"/>')
    for size in (5, 10, 20, 40, 100, 300):
        parts.append(_label(at(size, 0)[0], 328, str(size)))
    for chance in (0, 0.25, 0.5, 0.75, 1):
        x, y = at(4, chance)
        parts.append(f'<line x1="60" x2="410" y1="{y}" y2="{y}" stroke="#ddd"/>' + _label(x - 18, y + 4, f"{chance:g}"))
    parts.append(_label(235, 350, "root of the visible box's area [px]"))
    parts.append(_label(235, 22, "chance of detection in one frame (circles: measured)"))
    parts += _densities(scores)
    path.write_text("\n".join([*parts, "</svg>"]) + "\n")


def _densities(scores: dict[str, np.ndarray]) -> Iterator[str]:
    colours = ("#1f77b4", "#9467bd", "#2ca02c", "#7f7f7f")
    bins = np.linspace(13, 36, 47)

    def at(score: float, density: float) -> tuple[float, float]:
        return 490 + 380 * (score - 13) / 23, 310 - 520 * density

    x = at(THRESHOLD, 0)[0]
    yield f'<line x1="{x}" x2="{x}" y1="40" y2="310" stroke="#d62728" stroke-dasharray="5 4"/>'
    yield _label(x - 4, 38, "threshold 29")
    for (name, values), colour in zip(scores.items(), colours, strict=True):
        density, _ = np.histogram(values, bins, density=True)
        middles = (bins[1:] + bins[:-1]) / 2
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(at, middles.tolist(), density.tolist()))
        yield f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>'
        x, y = at(float(np.median(values)), float(density.max()))
        yield f'<text x="{x:.0f}" y="{y - 8:.0f}" text-anchor="middle" fill="{colour}">{name}</text>'
    for score in range(14, 37, 2):
        yield _label(at(score, 0)[0], 328, str(score))
    yield '<line x1="490" x2="870" y1="310" y2="310" stroke="#ddd"/>'
    yield _label(680, 350, "matching score m")
    yield _label(680, 22, "scores of the text “mug” for crops of 60 px")


def _label(x: float, y: float, text: str) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="middle" fill="#333">{text}</text>'


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--episodes", type=Path, help="episodes file of rooms to search")
    parser.add_argument("--count", type=int, default=1000, help="seeds behind each number")
    options = parser.parse_args()
    alike, count = similarity(), options.count

    sizes = (4.5, 6, 10, 14, 20, 28, 40, 60, 100, 160)
    rates = rates_by_size(sizes, count)
    print("detected by size [px]:", {size: round(rate, 3) for size, rate in zip(sizes, rates, strict=True)})
    shown = rates_by_fraction(np.array([-0.2, -0.06, -0.02, 0.02, 0.06]), count)
    print("detected by visible fraction, 60 px:", [(round(f, 2), round(r, 3)) for f, r in shown])
    for moving in (False, True):
        looks = rates_by_looks(14, 6, count, moving)
        print("found after looks at 14 px,", "new places:" if moving else "one place:", np.round(looks, 3).tolist())
    empty = SimCamera(Scene.of(empty_room()), SPEC)
    false = [
        len(judge.detect(empty.capture(Pose2D(1, 5), 0, 0, float(k)))) for k, judge in enumerate(detectors(count, 1.2))
    ]
    print("false positives a frame:", np.mean(false))

    for size in (100, 40, 20, 10):
        values = scores_of("mug", ["mug"], size, count, alike)[:, 0]
        print(f"true matches at {size} px: mean {values.mean():.2f}, above 29: {(values > THRESHOLD).mean():.3f}")
    for text in ("mug", "cup", "bowl", "book", "remote control"):
        values = scores_of("mug", [text], 60, count, alike)[:, 0]
        high = (values > THRESHOLD).mean()
        print(f"'{text}' for a mug (similarity {alike(text, 'mug'):.2f}): {values.mean():.2f}, above 29: {high:.3f}")
    names = ["armchair", "side table", "coffee table", "desk", "bed", "drawer"]
    for category in ("side table", "desk", "bed"):
        spread, right = label_entropy(category, names, 8, count // 4, alike)
        print(
            f"label of a {category}: entropy",
            np.round(spread[[0, 1, 3, 7]], 2),
            "right",
            np.round(right[[0, 1, 3, 7]], 2),
        )

    speed("apartment")
    if options.picture:
        frame = SimCamera(Scene.of(empty_room()), SPEC).capture(Pose2D(1, 5), 0, 0, 0.0)
        nothing = [
            SimMatcher(alike, np.random.default_rng(k)).match(frame, [Box(9, 9, 69, 69)], ["mug"])[0, 0]
            for k in range(count)
        ]
        scores = {name: scores_of(name, ["mug"], 60, count, alike)[:, 0] for name in ("mug", "cup", "book")}
        picture(options.picture, list(zip(sizes, rates, strict=True)), {**scores, "nothing": np.array(nothing)})
    if options.episodes:
        for per_landmark in (1, 2, 3):
            print(per_landmark, "viewpoints a landmark:", search(options.episodes, per_landmark, 100, alike))


if __name__ == "__main__":
    main()
