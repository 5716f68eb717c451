"""Fit simulated perception to neural eyes: `python -m benchmarks.fit_simulated_perception EPISODES [--eyes neural]`.

Neural eyes look at rendered frames of the episodes' worlds, as missions take them: from free places, at the heights
and tilts of scans and looks. What they find is compared with what is in sight, which the simulator knows. The fields
of `DetectorSettings` and `MatcherSettings` that follow are printed, beside shares measured and simulated.
"""

from __future__ import annotations

import argparse
import math
import pickle
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from benchmarks.simulated_perception import viewpoints
from sim.camera import SimCamera
from sim.frame import InstanceView, SimFrame
from sim.perception import DetectorSettings, MatcherSettings
from sim.perception.curves import detection_chance
from sim.perception.matcher import what_it_shows
from sim.scene import Scene
from zavis_bt.bench import load_episodes
from zavis_bt.cli.bench import world_of
from zavis_bt.perception import DEFAULT_UNKNOWN_LANDMARKS, Eyes, Thresholds, open_eyes
from zavis_bt.perception.naming import key
from zavis_bt.types import UNKNOWN_CLASS, CameraIntrinsics, CameraSpec

SPEC = CameraSpec(CameraIntrinsics.from_fov(640, 480, math.radians(60)), 0.0, 0.9, 0.1, 10.0, 15.0)
TILTS = (-0.35, 0.0, -0.6)
FOUND = 0.4  # IoU from which a box is of an instance
SIMULATED_THRESHOLD = 29.0
PIXELS = SPEC.intrinsics.width * SPEC.intrinsics.height


@dataclass(frozen=True, slots=True)
class Sight:
    """An instance in a frame, and what came of it."""

    size: float
    short_side: float
    fraction: float
    area: float
    furniture: bool
    known: bool
    label: str | None
    """Of the box that found it."""
    id: str
    score: float | None
    """Of its own name, if an `unknown` box found it."""
    named: bool | None
    """Whether the best landmark's name was right; None if it is no landmark that is told by matching."""
    passed: bool | None
    """Whether the best name reached the landmarks' threshold; likewise."""
    edges: tuple[float, ...]
    """How far the box's edges are off, as a share of its sides."""


@dataclass(frozen=True, slots=True)
class Frame:
    sights: tuple[Sight, ...]
    false: int
    """Boxes that show no instance."""
    parts: int
    """Of these, boxes inside furniture."""
    wrong: tuple[float, ...]
    """Scores of ``unknown`` boxes on objects and a text for something else."""
    nothing: tuple[float, ...]
    """Scores of ``unknown`` boxes that show nothing, with the names of what is searched."""


def frames(path: Path, count: int, seed: int) -> Iterator[tuple[SimFrame, list[str]]]:
    """Yield frames from viewpoints around furniture and from starts, with the names of what is searched there."""
    rng = np.random.default_rng(seed)
    episodes = load_episodes(path)
    names = sorted({episode.target for episode in episodes})
    for number in range(count):
        episode = episodes[int(rng.integers(len(episodes)))]
        world = world_of(episode)
        camera = SimCamera(Scene.of(world), SPEC)
        piece = world.furniture[int(rng.integers(len(world.furniture)))]
        poses = [episode.start, *viewpoints(world, piece)]
        pose = poses[int(rng.integers(len(poses)))]
        pan = rng.uniform(-0.5, 0.5) if pose is not episode.start else rng.uniform(-math.pi, math.pi)
        yield camera.capture(pose, float(pan), float(rng.choice(TILTS)), float(number)), names


def judge(eyes: Eyes, frame: SimFrame, names: Sequence[str]) -> Frame:
    """Compare what eyes see with what is in sight."""
    limits = eyes.thresholds
    found = [
        replace(one, label=UNKNOWN_CLASS) if limits.is_unknown(one.label, one.score) else one
        for one in eyes.detector.detect(frame)
        if not limits.is_faint(one.label, one.score)
    ]
    classes = {key(name) for name in eyes.classes or ()}
    landmarks = [name for name in DEFAULT_UNKNOWN_LANDMARKS if key(name) not in classes]
    shown = [what_it_shows(one.box, frame.instances) for one in found]
    texts = sorted({*names, *landmarks, *(one.category for one in frame.instances)})
    plain = np.asarray(eyes.matcher.match(frame, [one.box for one in found], texts)).reshape(len(found), len(texts))
    scores = limits.candidate_scores(plain, np.array([one.score for one in found]))
    of_landmarks = plain[:, [texts.index(name) for name in landmarks]]
    best: dict[str, int] = {}
    for k, (instance, overlap) in enumerate(shown):
        if instance is not None and overlap >= FOUND:
            before = best.get(instance.id)
            if before is None or overlap > shown[before][1]:
                best[instance.id] = k
    sights = tuple(
        _sight(instance, best.get(instance.id), found, scores, texts, of_landmarks, landmarks, classes, limits)
        for instance in frame.instances
    )
    on_nothing = [one.box for one, (_, overlap) in zip(found, shown, strict=True) if overlap < FOUND]
    furniture = [one.box for one in frame.instances if one.is_furniture]
    parts = sum(any(box.intersection(other) >= 0.6 * box.area for other in furniture) for box in on_nothing)
    wrong = [
        float(scores[k, texts.index(name)])
        for k, (instance, overlap) in enumerate(shown)
        if instance is not None and overlap >= FOUND and not instance.is_furniture and found[k].label == UNKNOWN_CLASS
        for name in names
        if key(name) != key(instance.category)
    ]
    empty = [k for k, (instance, _) in enumerate(shown) if instance is None and found[k].label == UNKNOWN_CLASS]
    nothing = scores[np.ix_(empty, [texts.index(name) for name in names])].ravel().tolist()
    return Frame(sights, len(on_nothing), parts, tuple(wrong), tuple(nothing))


def _sight(instance: InstanceView, k, found, scores, texts, of_landmarks, landmarks, classes, limits) -> Sight:
    width, height = instance.box.x1 - instance.box.x0, instance.box.y1 - instance.box.y0
    score = named = passed = None
    label, edges = None, ()
    if k is not None:
        box, label = found[k].box, found[k].label
        if label == UNKNOWN_CLASS:
            score = float(scores[k, texts.index(instance.category)])
        edges = (
            (box.x0 - instance.box.x0) / width,
            (box.x1 - instance.box.x1) / width,
            (box.y0 - instance.box.y0) / height,
            (box.y1 - instance.box.y1) / height,
        )
        if label == UNKNOWN_CLASS and instance.category in landmarks:
            named = landmarks[int(of_landmarks[k].argmax())] == instance.category
            passed = bool(of_landmarks[k].max() >= limits.landmark)
    return Sight(
        math.sqrt(instance.box.area),
        min(width, height),
        instance.visible_fraction,
        instance.visible_area,
        instance.is_furniture,
        key(instance.category) in classes,
        label,
        instance.id,
        score,
        named,
        passed,
        edges,
    )


def fit_detector(seen: Sequence[Frame]) -> DetectorSettings:
    """Return the settings under which what was found is likeliest."""
    sights = [one for frame in seen for one in frame.sights]
    start = DetectorSettings()
    kept = [one for one in sights if not (one.furniture and one.area < start.furniture_share * PIXELS)]
    size, side, fraction = (
        np.array([getattr(one, name) for one in kept]) for name in ("size", "short_side", "fraction")
    )
    furniture = np.array([one.furniture for one in kept])
    hit = np.array([one.label is not None for one in kept])

    def settings_of(x: np.ndarray) -> DetectorSettings:
        return replace(
            start,
            ceiling=1 / (1 + math.exp(-x[0])),
            half_size=math.exp(x[1]),
            slope=math.exp(x[2]),
            short_side=(start.short_side[0], start.short_side[0] + math.exp(x[3])),
            visible=(start.visible[0], start.visible[0] + math.exp(x[4])),
            visible_furniture=(start.visible_furniture[0], start.visible_furniture[0] + math.exp(x[5])),
        )

    def surprise(x: np.ndarray) -> float:
        settings, total = settings_of(x), 0.0
        for kind in (True, False):
            mask = furniture == kind
            chance = detection_chance(size[mask], side[mask], fraction[mask], kind, settings).clip(1e-3, 1 - 1e-3)
            total -= float(np.where(hit[mask], np.log(chance), np.log(1 - chance)).sum())
        return total / len(kept) + 1e-3 * float((x**2).sum()) / len(x)

    first = np.array([2.0, math.log(17), math.log(2.2), math.log(2.5), math.log(0.6), math.log(0.25)])
    best = minimize(surprise, first, method="Nelder-Mead", options={"maxiter": 1500, "xatol": 1e-3, "fatol": 1e-5})
    return settings_of(best.x)


def fit_matcher(seen: Sequence[Frame], limits: Thresholds) -> tuple[MatcherSettings, Thresholds]:
    """Return settings and thresholds under which texts pass as often as with the eyes.

    Scores are mapped by the straight line that takes the mean of wrong texts to `unrelated`, and the eyes' m_t to 29.
    """
    start = MatcherSettings()
    objects = [one for frame in seen for one in frame.sights if one.score is not None and not one.furniture]
    wrong = np.array([score for frame in seen for score in frame.wrong])
    gain = (SIMULATED_THRESHOLD - start.unrelated) / (limits.match - wrong.mean())
    scores = np.array([one.score for one in objects])
    nothing = np.array([score for frame in seen for score in frame.nothing])
    right, background = (start.unrelated + gain * (values - wrong.mean()) for values in (scores, nothing))
    size = np.array([one.size for one in objects])
    columns = np.stack((np.ones(len(size)), np.exp(-size / start.small_size)), axis=1)
    (large, small), *_ = np.linalg.lstsq(columns, right, rcond=None)
    rest = right - columns @ (large, small)
    groups: dict[str, list[float]] = {}
    for one, value in zip(objects, rest.tolist(), strict=True):
        groups.setdefault(one.id, []).append(value)
    several = [values for values in groups.values() if len(values) > 1]
    within = np.concatenate([np.array(values) - np.mean(values) for values in several])
    spread = gain * float(wrong.std())  # the settings have one for right and wrong texts
    share = min(float((within**2).sum()) / max(len(within) - len(several), 1) / float(rest.var()), 1.0)
    matcher = replace(
        start,
        match=round(float(large), 2),
        background=round(float(background.mean()), 2),
        background_spread=round(float(background.std()), 2),
        small_loss=round(float(np.clip(-small / (large - start.unrelated), 0.0, 0.9)), 3),
        view_spread=round(spread * math.sqrt(share), 2),
        instance_spread=round(spread * math.sqrt(1 - share), 2),
    )
    landmark = _landmark_threshold(matcher, [one for frame in seen for one in frame.sights])
    thresholds = Thresholds(SIMULATED_THRESHOLD, round(landmark, 2), round(gain * limits.temperature, 3))
    print(f"right {right.mean():.2f} ± {right.std():.2f}, wrong ± {spread:.2f} on the simulated scale")
    return matcher, thresholds


def _landmark_threshold(matcher: MatcherSettings, sights: Sequence[Sight]) -> float:
    """Return the threshold that as many landmarks pass as pass the eyes'."""
    told = [one for one in sights if one.passed is not None]
    rng = np.random.default_rng(0)
    means = np.full(len(DEFAULT_UNKNOWN_LANDMARKS), matcher.unrelated)
    means[0] = matcher.match
    spread = math.hypot(matcher.instance_spread, matcher.view_spread)
    best = (means + spread * rng.standard_normal((20_000, len(means)))).max(axis=1)
    return float(np.quantile(best, 1 - np.mean([one.passed for one in told])))


def report(seen: Sequence[Frame], fitted: DetectorSettings, threshold: float) -> None:
    sights = [one for frame in seen for one in frame.sights]
    for kind in (False, True):
        of_kind = [one for one in sights if one.furniture == kind and one.fraction > 0.5]
        print("furniture" if kind else "objects", "more than half in sight: found, told (simulated by the fit):")
        for low, high in ((5, 8), (8, 12), (12, 18), (18, 28), (28, 45), (45, 80), (80, 160), (160, 700)):
            chosen = [one for one in of_kind if low <= one.size < high]
            if len(chosen) < 8:
                continue
            arrays = (np.array([getattr(one, name) for one in chosen]) for name in ("size", "short_side", "fraction"))
            expected = detection_chance(*arrays, kind, fitted).mean()
            found = np.mean([one.label is not None for one in chosen])
            told = [one.score >= threshold for one in chosen if one.score is not None]
            print(
                f"  {low:3} to {high:3} px: {found:.2f} ({expected:.2f}) of {len(chosen)}, "
                f"told {np.mean(told) if told else math.nan:.2f} of {len(told)}"
            )
    hits = [one for one in sights if one.label is not None]
    known = [one.label != UNKNOWN_CLASS for one in hits if one.known and one.furniture]
    strange = [one.label != UNKNOWN_CLASS for one in hits if not one.known]
    named = [one.named for one in hits if one.named is not None]
    edges = np.array([one.edges for one in hits])
    wrong = [one for frame in seen for one in frame.wrong]
    print(
        f"boxes on nothing: {np.mean([frame.false for frame in seen]):.2f} a frame, "
        f"{sum(frame.parts for frame in seen) / max(sum(frame.false for frame in seen), 1):.2f} of them on furniture"
    )
    print(f"edges off by {edges.std():.3f} of the sides, median {np.median(np.abs(edges)):.3f}")
    print(
        f"known as unknown {1 - np.mean(known):.3f} of {len(known)}, "
        f"unknown as known {np.mean(strange):.3f} of {len(strange)}"
    )
    passed = [one.passed for one in hits if one.passed is not None]
    print(f"landmarks' names right {np.mean(named):.3f} of {len(named)}, over the threshold {np.mean(passed):.3f}")
    print(f"wrong texts above the threshold {np.mean(np.array(wrong) >= threshold):.5f} of {len(wrong)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("episodes", type=Path)
    parser.add_argument("--eyes", default="neural")
    parser.add_argument("--count", type=int, default=1000, help="frames")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="file for what was seen, used again if it is there")
    options = parser.parse_args()
    eyes = open_eyes(options.eyes)
    if options.keep and options.keep.is_file():
        seen = pickle.loads(options.keep.read_bytes())
    else:
        seen = [judge(eyes, *pair) for pair in frames(options.episodes, options.count, options.seed)]
    if options.keep:
        options.keep.write_bytes(pickle.dumps(seen))
    fitted = fit_detector(seen)
    report(seen, fitted, eyes.thresholds.match)
    print(fitted)
    print(*fit_matcher(seen, eyes.thresholds), sep="\n")


if __name__ == "__main__":
    main()
