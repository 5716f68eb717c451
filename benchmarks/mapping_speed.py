"""Speed of mapping against simple rivals timed in the same run: `python -m benchmarks.mapping_speed`.

Each rival does the least that gives a comparable result. Turns are interleaved and the medians compared, so that
what else the machine does falls on both alike.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from numba import njit

from sim.raycast import RayCaster
from zavis_bt.mapping import OccupancyGrid, find_frontiers, load_map, save_map
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap, LaserScan, Pose2D

CELL = 0.05
ROUNDS = 9


def world(side: int) -> np.ndarray:
    """Return a square of cells with a border and 30 boxes and discs."""
    rng = np.random.default_rng(side)
    cells = np.zeros((side, side), dtype=np.uint8)
    cells[[0, -1]] = 1
    cells[:, [0, -1]] = 1
    for i in range(30):
        col, row = rng.integers(side // 20, side - side // 20, 2).tolist()
        size = int(rng.integers(side // 100 + 1, side // 30 + 2))
        if i % 2:
            cv2.circle(cells, (col, row), size, 1, -1)
        else:
            cv2.rectangle(cells, (col, row), (col + size, row + 2 * size), 1, -1)
    return cells.astype(bool)


def scans_in(walls: np.ndarray, beams: int, range_max: float, count: int = 40) -> list[tuple[LaserScan, Pose2D]]:
    rng, caster = np.random.default_rng(1), RayCaster(walls, CELL, (0.0, 0.0))
    clear = np.argwhere(cv2.distanceTransform((~walls).astype(np.uint8), cv2.DIST_L2, 5) > 5)
    step = math.pi / (beams - 1)
    scans = []
    for row, col in clear[rng.integers(len(clear), size=count)].tolist():
        pose = Pose2D((col + 0.5) * CELL, (row + 0.5) * CELL, float(rng.uniform(-math.pi, math.pi)))
        angles = pose.yaw - math.pi / 2 + step * np.arange(beams)
        ranges = caster.cast(pose.x, pose.y, angles, range_max)
        scans.append((LaserScan(ranges, -math.pi / 2, step, 0.02, range_max, 0.0), pose))
    return scans


@njit(cache=True)
def one_line_a_beam(
    log_odds: np.ndarray, x: float, y: float, angles: np.ndarray, ranges: np.ndarray, range_max: float, cell: float
) -> None:
    """Walk the cells of every beam, each a miss, then count the hit: what most mappers do."""
    for i in range(len(angles)):
        length = min(ranges[i], range_max) / cell
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        steps = int(length * max(abs(dx), abs(dy)))
        for k in range(steps):
            row, col = int(y + dy * length * k / steps), int(x + dx * length * k / steps)
            if 0 <= row < log_odds.shape[0] and 0 <= col < log_odds.shape[1]:
                log_odds[row, col] = max(log_odds[row, col] - np.float32(0.4), np.float32(-2.0))
        row, col = int(y + dy * (length + 0.05)), int(x + dx * (length + 0.05))
        if ranges[i] < range_max and 0 <= row < log_odds.shape[0] and 0 <= col < log_odds.shape[1]:
            log_odds[row, col] = min(log_odds[row, col] + np.float32(0.9), np.float32(3.5))


def cv2_frontiers(grid: GridMap) -> int:
    free, unknown = (grid.states == FREE).astype(np.uint8), (grid.states == UNKNOWN).astype(np.uint8)
    beside = cv2.dilate(unknown, cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))) & free
    _, _, stats, _ = cv2.connectedComponentsWithStats(beside, connectivity=8)
    return int((stats[1:, 2:4].max(axis=1) >= 6).sum())


def cv2_map(folder: Path) -> GridMap:
    from ruamel.yaml import YAML

    with (folder / "map.yaml").open() as file:
        fields = YAML(typ="safe").load(file)
    shade = 1 - cv2.imread(str(folder / fields["image"]), cv2.IMREAD_UNCHANGED)[::-1] / 255.0
    states = np.where(
        shade > fields["occupied_thresh"], OCCUPIED, np.where(shade < fields["free_thresh"], FREE, UNKNOWN)
    )
    return GridMap(states.astype(np.int8), fields["resolution"], tuple(fields["origin"][:2]))


def compare(title: str, ours: Callable[[], object], rival: Callable[[], object], work: int = 1) -> None:
    times: tuple[list[float], list[float]] = ([], [])
    for turn in range(ROUNDS + 1):
        for spent, run in zip(times, (ours, rival), strict=True):
            start = time.process_time()
            run()
            if turn:  # the first turn compiles
                spent.append((time.process_time() - start) / work)
    mine, theirs = (float(np.median(spent)) for spent in times)
    print(
        f"{title:52s} {1e3 * mine:9.3f} ms {1 / mine:9.0f} /s   rival {1e3 * theirs:9.3f} ms   × {theirs / mine:5.2f}"
    )


def mapping(side: int, beams: int, range_max: float) -> None:
    scans = scans_in(world(side), beams, range_max)
    grid, plain = OccupancyGrid(CELL), np.zeros((side, side), dtype=np.float32)
    angles = [pose.yaw + scan.angles for scan, pose in scans]

    def ours() -> None:
        for scan, pose in scans:
            grid.integrate(scan, pose)

    def ours_with_map() -> None:
        for scan, pose in scans:
            grid.integrate(scan, pose)
            _ = grid.map

    def rival() -> None:
        for (scan, pose), directions in zip(scans, angles, strict=True):
            one_line_a_beam(plain, pose.x / CELL, pose.y / CELL, directions, scan.ranges, range_max, CELL)

    name = f"{side}², {beams} beams, {range_max:g} m"
    compare(f"fuse a scan, {name}", ours, rival, len(scans))
    compare(f"fuse a scan and read the map, {name}", ours_with_map, rival, len(scans))


def frontiers(side: int) -> None:
    walls = world(side)
    grid = OccupancyGrid(CELL)
    for scan, pose in scans_in(walls, 181, 8.0, 25):
        grid.integrate(scan, pose)
    known = grid.map
    states = np.full((side, side), UNKNOWN, dtype=np.int8)
    row, col = (round(-value / CELL) for value in (known.origin[1], known.origin[0]))
    part = known.states[max(row, 0) : row + side, max(col, 0) : col + side]
    states[: part.shape[0], : part.shape[1]] = part
    square = GridMap(states, CELL, (0.0, 0.0))
    assert len(find_frontiers(square)) > 0
    share = (states != UNKNOWN).mean()
    compare(f"frontiers, {side}², {share:.0%} explored", lambda: find_frontiers(square), lambda: cv2_frontiers(square))


def map_files() -> None:
    states = np.random.default_rng(0).choice(np.array([UNKNOWN, FREE, OCCUPIED], np.int8), (300, 300))
    with TemporaryDirectory() as name:
        folder = Path(name)
        save_map(folder / "map.yaml", GridMap(states, CELL, (0.0, 0.0)))
        compare("load a map of 300²", lambda: load_map(folder / "map.yaml"), lambda: cv2_map(folder))


def main() -> None:
    for side, beams, range_max in ((200, 181, 30.0), (1000, 181, 8.0), (1000, 181, 30.0), (1000, 1081, 30.0)):
        mapping(side, beams, range_max)
    frontiers(1000)
    map_files()


if __name__ == "__main__":
    main()
