"""Images of the simulated camera: `python -m benchmarks.render`.

Prints the CPU time of one thread for colour and depth of whole images, single depths, exact labels and the making of
scenes: in the built-in apartment, and in one room with more and more things in it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from benchmarks.timing import machine, verdict
from sim.appearance import random_frame, random_scene, random_world
from sim.camera import SimCamera
from sim.frame import SimFrame
from sim.scene import Scene
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.types import CameraIntrinsics, CameraSpec

SIZES = ((160, 120), (320, 240), (640, 480))
ROUNDS = 40


def milliseconds(work: Callable[[], object]) -> float:
    begin = time.thread_time()
    work()
    return 1e3 * (time.thread_time() - begin)


def apartment() -> bool:
    """Frames all over the built-in apartment; returns whether small images are made in time."""
    world, met = load_world(resolve_world("apartment")), True
    scene, rng = Scene.of(world), np.random.default_rng(0)
    print(f"apartment: {len(scene.things)} things, {len(scene.parts.owners)} parts")
    for width, height in SIZES:
        spec = CameraSpec(CameraIntrinsics.from_fov(width, height, math.radians(60)), 0.0, 0.9, 0.1, 10.0, 15.0)
        camera, rows = SimCamera(scene, spec), []
        pixels = rng.integers(0, (width, height), (200, 2))
        for k in range(ROUNDS + 2):
            frame = camera.capture(world.starts[k % len(world.starts)], rng.uniform(-math.pi, math.pi), -0.3, 0.0)
            depths = milliseconds(lambda frame=frame, pixels=pixels: frame.depth_at(pixels))
            image = milliseconds(lambda frame=frame: frame.rgb)
            rows.append((depths, image, milliseconds(lambda frame=frame: frame.labels)))
        median, most = np.median(rows[2:], axis=0), np.max(rows[2:], axis=0)
        print(
            f"{width:4}x{height}: image {median[1]:6.2f} ms (most {most[1]:.2f}), 200 depths {median[0]:.3f} ms, "
            f"labels {median[2]:.2f} ms"
        )
        met &= bool(width > 160 or median[1] <= 5.0)
    return met


def crowded() -> None:
    """One room with more and more things."""
    camera = CameraIntrinsics.from_fov(640, 480, math.radians(60))
    for objects in (0, 10, 30, 100, 300):
        rows = []
        for seed in range(12):
            rng = np.random.default_rng(seed)
            scene = Scene.of(random_world(rng, furniture=objects // 4, objects=objects))
            dressing = milliseconds(lambda scene=scene: scene.parts)
            frame: SimFrame = random_frame(rng, scene, camera)
            rows.append(
                (len(scene.things), len(scene.parts.owners), dressing, milliseconds(lambda frame=frame: frame.rgb))
            )
        things, parts, dressing, image = np.median(rows[2:], axis=0)
        print(
            f"room of {things:4.0f} things, {parts:5.0f} parts: image 640x480 {image:6.2f} ms, scene {dressing:6.2f} ms"
        )


def training() -> None:
    """New rooms, one labelled image each, as training draws them."""
    camera = CameraIntrinsics.from_fov(320, 240, math.radians(60))

    def draw(seed: int) -> None:
        rng = np.random.default_rng(seed)
        frame = random_frame(rng, random_scene(rng), camera)
        assert frame.rgb.size > 0
        assert frame.labels is not None

    draw(0)
    spent = milliseconds(lambda: [draw(seed) for seed in range(1, 61)]) / 60
    print(f"a new room and a labelled image of 320x240: {spent:.1f} ms")


def main() -> None:
    print(machine())
    met = apartment()
    crowded()
    training()
    print(f"target, at most 5 ms for 160x120 in the apartment: {verdict(met)}")


if __name__ == "__main__":
    main()
