"""How fast neural eyes are: `python -m benchmarks.neural [EYES]`.

Frames of the built-in apartment at three sizes through detector and matcher (one target and the usual landmarks), on
one thread and on two, beside the time to draw them; then what `import torch` costs, and that only neural eyes pay it.
Wall times, since threads share the work: trust them on a quiet machine only.
"""

from __future__ import annotations

import math
import subprocess
import sys
import time
from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.timing import machine, spread, verdict
from sim.camera import SimCamera
from sim.frame import SimFrame
from sim.scene import Scene
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.perception import DEFAULT_UNKNOWN_LANDMARKS, Eyes, Perceiver, open_eyes
from zavis_bt.types import CameraIntrinsics, CameraSpec

SIZES = ((160, 120), (320, 240), (640, 480))
FRAMES = 24
ROUNDS = 3
TARGET = "red wallet"
TARGETS = {1: 40.0, 2: 25.0}  # [ms] of a 160x120 frame by threads
_LOADED = """
import sys, time
begin = time.perf_counter()
import {module}
print(time.perf_counter() - begin, "torch" in sys.modules)
"""


def frames(width: int, height: int) -> list[SimFrame]:
    """Views of the apartment that do not look at a wall from near."""
    world = load_world(resolve_world("apartment"))
    camera = CameraSpec(CameraIntrinsics.from_fov(width, height, math.radians(60)), 0.0, 0.9, 0.1, 10.0, 15.0)
    eye, rng, found = SimCamera(Scene.of(world), camera), np.random.default_rng(0), []
    while len(found) < FRAMES:
        pose = world.starts[len(found) % len(world.starts)]
        frame = eye.capture(pose, rng.uniform(-math.pi, math.pi), -0.3, float(len(found)))
        if len(frame.instances) >= 5:
            found.append(frame)
    return found


def milliseconds(work: Callable[[int], object]) -> list[float]:
    """Return the median time of each frame's work over the rounds, the first of which warms up."""
    spent = np.empty((ROUNDS + 1, FRAMES))
    for turn in range(ROUNDS + 1):
        for k in range(FRAMES):
            begin = time.perf_counter()
            work(k)
            spent[turn, k] = 1e3 * (time.perf_counter() - begin)
    return np.median(spent[1:], axis=0).tolist()


def look(eyes: Eyes, views: Sequence[SimFrame], threads: int) -> float:
    """Print the times on so many threads; return the median [ms]."""
    import torch

    torch.set_num_threads(threads)
    perceiver = Perceiver(eyes.detector, eyes.matcher, unknown=DEFAULT_UNKNOWN_LANDMARKS, thresholds=eyes.thresholds)
    texts = [*DEFAULT_UNKNOWN_LANDMARKS, TARGET]
    boxes = [[one.box for one in eyes.detector.detect(view)] for view in views]
    drawn = milliseconds(lambda k: views[k].unrendered().rgb)
    detect = milliseconds(lambda k: eyes.detector.detect(views[k]))
    match = milliseconds(lambda k: eyes.matcher.match(views[k], boxes[k], texts))
    whole = milliseconds(lambda k: perceiver.perceive(views[k], TARGET))
    camera, count = views[0].intrinsics, np.mean([len(one) for one in boxes])
    print(
        f"{threads} thread{'s' * (threads > 1)}, {camera.width:3}x{camera.height}: drawing {spread(drawn)} ms; "
        f"detector {spread(detect)} ms, matcher {spread(match)} ms for {count:.0f} boxes, all {spread(whole)} ms"
    )
    return float(np.median(whole))


def imports() -> None:
    for module in ("zavis_bt.cli.main", "zavis_bt.perception", "zavis_bt.cli.simulate", "torch"):
        out = subprocess.run(
            [sys.executable, "-c", _LOADED.format(module=module)], capture_output=True, text=True, check=True
        )
        seconds, torch = out.stdout.split()
        print(f"import {module}: {float(seconds):.2f} s, torch {'loaded' if torch == 'True' else 'not loaded'}")


def main() -> None:
    print(machine())
    eyes = open_eyes(sys.argv[1] if len(sys.argv) > 1 else "neural")
    for threads, target in TARGETS.items():
        medians = [look(eyes, frames(*size), threads) for size in SIZES]
        print(f"target, at most {target:g} ms for 160x120 on {threads}: {verdict(medians[0] <= target)}")
    imports()


if __name__ == "__main__":
    main()
