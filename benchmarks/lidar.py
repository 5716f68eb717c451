"""Ray casting against rivals timed in the same run: `python -m benchmarks.lidar`.

The worlds are squares of 5 cm cells with a border and 30 boxes and discs. Rivals: a cell-by-cell walk compiled by
numba, exact too, which also gives the error; and ir-sim's LiDAR (`pip install ir-sim`), which gets the same shapes as
its own objects rather than as cells. Its ranges differ by the cells' corners: the last but one column says for 19 of
20 beams how much. One thread each.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit

from benchmarks.timing import machine, take_turns, verdict
from sim.raycast import RayCaster

CELL = 0.05
ROUNDS = 9
TARGET = 20_000  # scans of 181 beams a second
Shape = tuple[str, float, float, float, float]  # kind, centre x, y, half length, half width or radius
Scanner = Callable[[float, float, float], np.ndarray]


def shapes(side: int) -> list[Shape]:
    """30 boxes and discs of 1 to 3 % of the world's side (half their size)."""
    rng, size = np.random.default_rng(side), side * CELL
    places = rng.uniform(0.08 * size, 0.92 * size, (30, 2))
    halves = rng.uniform(0.01 * size, 0.03 * size, (30, 2))
    return [
        ("disc" if i % 2 else "box", *map(float, place), *map(float, half))
        for i, (place, half) in enumerate(zip(places, halves, strict=True))
    ]


def cells_of(side: int, things: list[Shape]) -> np.ndarray:
    """(side, side) cells whose centre lies in a shape, and the border."""
    y, x = (np.mgrid[:side, :side] + 0.5) * CELL
    cells = np.zeros((side, side), dtype=np.bool_)
    cells[[0, -1]] = cells[:, [0, -1]] = True
    for kind, cx, cy, a, b in things:
        if kind == "disc":
            cells |= np.hypot(x - cx, y - cy) <= a
        else:
            cells |= (np.abs(x - cx) <= a) & (np.abs(y - cy) <= b)
    return cells


def poses_in(cells: np.ndarray, count: int = 40) -> np.ndarray:
    """(count, 3) x, y, yaw in free cells with free neighbours, anywhere in their cell."""
    rng, free = np.random.default_rng(1), ~cells
    inner = free.copy()
    for axis in (0, 1):
        for step in (-2, -1, 1, 2):
            inner &= np.roll(free, step, axis)
    spots = np.argwhere(inner)
    spots = spots[rng.integers(len(spots), size=count)]
    xy = (spots[:, ::-1] + rng.uniform(0.05, 0.95, (count, 2))) * CELL
    return np.column_stack((xy, rng.uniform(-math.pi, math.pi, count)))


@njit(cache=True)
def walk(cells: np.ndarray, u: float, v: float, angles: np.ndarray, reach: float, cell: float) -> np.ndarray:
    """From cell to cell across the nearer edge, as in every textbook."""
    rows, cols = cells.shape
    ranges = np.full(len(angles), np.inf)
    for i in range(len(angles)):
        du, dv = math.cos(angles[i]), math.sin(angles[i])
        step_u, step_v = (1 if du > 0 else -1), (1 if dv > 0 else -1)
        col, row = int(u), int(v)
        next_u = ((col + (du > 0)) - u) / du if du != 0.0 else np.inf
        next_v = ((row + (dv > 0)) - v) / dv if dv != 0.0 else np.inf
        wide = abs(1.0 / du) if du != 0.0 else np.inf
        high = abs(1.0 / dv) if dv != 0.0 else np.inf
        travelled = 0.0
        while travelled <= reach and 0 <= col < cols and 0 <= row < rows:
            if cells[row, col]:
                ranges[i] = travelled * cell
                break
            if next_u <= next_v:
                travelled, next_u, col = next_u, next_u + wide, col + step_u
            else:
                travelled, next_v, row = next_v, next_v + high, row + step_v
    return ranges


IR_WORLD = """
world: {{height: {size}, width: {size}, step_time: 0.1, sample_time: 0.1}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.01}}
    state: [0.2, 0.2, 0]
    sensors:
      - {{name: lidar2d, range_min: 0, range_max: {range_max}, angle_range: {span}, number: {beams}}}
obstacle:
  - shape: {{name: linestring, vertices: [[{a}, {a}], [{b}, {a}], [{b}, {b}], [{a}, {b}], [{a}, {a}]]}}
    state: [0, 0, 0]
"""


def irsim_scanner(side: int, things: list[Shape], beams: int, span: float, range_max: float) -> Scanner | None:
    """ir-sim's LiDAR in the same world, or None where ir-sim is not installed."""
    os.environ.setdefault("MPLBACKEND", "agg")
    quiet = io.StringIO()
    with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet), tempfile.TemporaryDirectory() as folder:
        try:
            import irsim
        except ImportError:
            return None
        size = side * CELL
        text = IR_WORLD.format(size=size, range_max=range_max, span=span, beams=beams, a=CELL, b=size - CELL)
        for kind, x, y, a, b in things:
            outline = (
                f"name: circle, radius: {a}" if kind == "disc" else f"name: rectangle, length: {2 * a}, width: {2 * b}"
            )
            text += f"  - shape: {{{outline}}}\n    state: [{x}, {y}, 0]\n"
        file = Path(folder, "world.yaml")
        file.write_text(text)
        world = irsim.make(str(file), display=False, log_level="ERROR")
    lidar = world.robot.sensors[0]

    def scan(x: float, y: float, yaw: float) -> np.ndarray:
        lidar.step(np.array([[x], [y], [yaw]]))
        return np.where(lidar.valid, lidar.range_data, np.inf)

    return scan


def all_of(scanner: Scanner, poses: np.ndarray) -> Callable[[], np.ndarray]:
    return lambda: np.array([scanner(*pose) for pose in poses.tolist()])


def compare(side: int, beams: int, range_max: float) -> bool:
    things = shapes(side)
    cells = cells_of(side, things)
    poses, caster = poses_in(cells), RayCaster(cells, CELL, (0.0, 0.0))
    span = math.pi if beams == 181 else 1.5 * math.pi
    step = span / (beams - 1)
    fan = -span / 2 + step * np.arange(beams)

    def ours(x: float, y: float, yaw: float) -> np.ndarray:
        return caster.sweep(x, y, yaw - span / 2, step, beams, range_max)

    def cell_walk(x: float, y: float, yaw: float) -> np.ndarray:
        return walk(cells, x / CELL, y / CELL, yaw + fan, range_max / CELL, CELL)

    scanners: dict[str, Scanner] = {"ours": ours, "walk": cell_walk}
    if rival := irsim_scanner(side, things, beams, span, range_max):
        scanners["irsim"] = rival
    calls = {name: all_of(scanner, poses) for name, scanner in scanners.items()}
    exact, cast = calls["walk"](), calls["ours"]()
    error = np.abs(np.where(np.isfinite(exact), exact, range_max) - np.where(np.isfinite(cast), cast, range_max)).max()
    rate = {name: 1 / seconds for name, seconds in take_turns(calls, ROUNDS, len(poses)).items()}
    line = f"{side:4d}² {beams:4d} {range_max:3.0f} m {rate['ours']:12,.0f} {rate['walk']:12,.0f} "
    line += f"{rate['ours'] / rate['walk']:7.1f} ×"
    if rival:
        both = np.where(np.isfinite(cast), cast, range_max), calls["irsim"]()
        apart = np.percentile(np.abs(both[0] - np.where(np.isfinite(both[1]), both[1], range_max)), 95)
        line += f" {rate['irsim']:12,.0f} {rate['ours'] / rate['irsim']:7.0f} × {apart * 100:7.1f} cm"
    else:
        line += f" {'-':>12} {'-':>9} {'-':>10}"
    print(f"{line} {error:14.1e} m")
    return beams != 181 or rate["ours"] >= TARGET


def main() -> None:
    if "OPENBLAS_NUM_THREADS" not in os.environ:  # read when numpy is imported; ir-sim multiplies matrices
        os.execve(
            sys.executable, [sys.executable, "-m", "benchmarks.lidar"], {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        )
    print(f"scans a second of CPU time, medians of {ROUNDS} turns; {machine()}")
    if irsim_scanner(200, [], 3, 1.0, 8.0) is None:
        print("ir-sim is not installed (pip install ir-sim): left out")
    print("world beams range    RayCaster    cell walk     ratio       ir-sim     ratio  differs  largest error (walk)")
    met = [compare(side, beams, reach) for side in (200, 1000) for beams in (181, 1081) for reach in (8.0, 30.0)]
    print(f"target, at least {TARGET:,} scans of 181 beams a second: {verdict(all(met))}")


if __name__ == "__main__":
    main()
