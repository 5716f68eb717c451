"""Planning against rivals timed in the same run: ``python benchmarks/planning.py``.

Every line gives our median time, the rival's, and their ratio; single figures drift between machines, ratios hardly do.
"""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Callable

import cv2
import numpy as np

from zavis_bt.planning import Costmap, DwaPlanner, DwaSettings, GeodesicField, Navigator, make_planner
from zavis_bt.planning.distance_field import distance_field
from zavis_bt.types import (
    BaseLimits,
    BaseState,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
    Twist2D,
)

RESOLUTION = 0.05
DISC = Footprint(0.36, 0.36, disc=True)
ROBOT = RobotSpec(
    "disc",
    DISC,
    BaseLimits(0.6, 0.3, 1.8, 1.0, 4.2),
    LidarSpec(360, math.tau, 0.05, 10.0, 10.0, Pose2D(0.0, 0.0), 0.3),
    PanTiltSpec(-3.0, 3.0, -1.0, 1.0, 2.0, 8.0),
    CameraSpec(CameraIntrinsics.from_fov(640, 480, 1.0), 0.0, 1.0, 0.3, 10.0, 10.0),
)


def rooms(size: int, seed: int = 0) -> GridMap:
    """Rooms of 5 m with doors of 0.9 m and a box in each."""
    rng = np.random.default_rng(seed)
    states = np.zeros((size, size), dtype=np.int8)
    states[[0, -1]] = states[:, [0, -1]] = 100
    for wall in range(100, size - 50, 100):
        states[wall] = states[:, wall] = 100
    for wall in range(100, size - 50, 100):
        for room in range(0, size, 100):
            for across in (True, False):
                door = room + int(rng.integers(10, 70))
                states[(wall, slice(door, door + 18)) if across else (slice(door, door + 18), wall)] = 0
    for row in range(0, size, 100):
        for col in range(0, size, 100):
            r, c = row + int(rng.integers(30, 60)), col + int(rng.integers(30, 60))
            states[r : r + 12, c : c + 20] = 100
    return GridMap(states, RESOLUTION, (0.0, 0.0))


def seconds(work: Callable[[], object], repeats: int) -> float:
    """Median CPU time of one call."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return float(np.median(times))


def report(what: str, ours: Callable[[], object], rivals: dict[str, Callable[[], object]], repeats: int = 15) -> None:
    ours()
    for name, rival in rivals.items():
        rival()
        # Ours and the rival's calls alternate, so that a busy machine slows down both.
        mine, theirs = np.median([(seconds(ours, 3), seconds(rival, 1)) for _ in range(max(repeats // 3, 1))], axis=0)
        print(f"{what:<34} {mine * 1e3:9.3f} ms   {name:<34} {theirs * 1e3:9.3f} ms   ratio {theirs / mine:8.2f}")


def heap_search(cost: np.ndarray, source: tuple[int, int], target: tuple[int, int] | None) -> dict:
    """A* (Dijkstra without a target) in 8 directions in plain Python."""
    steps = [(r, c, math.hypot(r, c)) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]
    best, parent, queue, done = {source: 0.0}, {source: source}, [(0.0, source)], set()
    while queue:
        _, cell = heapq.heappop(queue)
        if cell in done:
            continue
        done.add(cell)
        if cell == target:
            break
        for r, c, length in steps:
            other = cell[0] + r, cell[1] + c
            if not math.isfinite(cost[other]):
                continue
            new = best[cell] + length * (cost[cell] + cost[other]) / 2
            if new < best.get(other, math.inf):
                best[other], parent[other] = new, cell
                ahead = math.hypot(other[0] - target[0], other[1] - target[1]) if target else 0.0
                heapq.heappush(queue, (new + ahead, other))
    return parent


def numpy_dwa(pose: Pose2D, target: tuple[float, float], obstacles: np.ndarray, speeds: int, rates: int) -> int:
    """Rollouts of all samples at once, each pose against each obstacle point."""
    v, w = (grid.ravel() for grid in np.meshgrid(np.linspace(0.2, 0.4, speeds), np.linspace(-0.4, 0.4, rates)))
    yaw = pose.yaw + w[:, None] * np.arange(1, 14) * 0.1
    x = pose.x + np.cumsum(v[:, None] * 0.1 * np.cos(yaw), axis=1)
    y = pose.y + np.cumsum(v[:, None] * 0.1 * np.sin(yaw), axis=1)
    gap = np.hypot(x[..., None] - obstacles[:, 0], y[..., None] - obstacles[:, 1]).min(axis=(1, 2))
    score = np.hypot(x[:, -1] - target[0], y[:, -1] - target[1]) + 0.1 / np.maximum(gap - 0.18, 1e-3)
    return int(np.where(gap > 0.18, score, math.inf).argmin())


def planners(size: int, pairs: int) -> None:
    costmap = Costmap(rooms(size), DISC)
    cells = np.argwhere(costmap.distance > 0.4)
    places = costmap.grid.to_points(cells[np.random.default_rng(1).integers(len(cells), size=(2 * pairs,))])
    poses = [Pose2D(float(x), float(y)) for x, y in places]
    rng = np.random.default_rng(0)
    for name in ("astar", "rrt_connect"):
        make_planner(name).plan(costmap, poses[0], poses[1], rng)
    times: dict[str, list[float]] = {"astar": [], "rrt_connect": [], "plain Python A*": []}
    lengths: dict[str, list[float]] = {"astar": [], "rrt_connect": []}
    for start, goal in zip(poses[::2], poses[1::2], strict=True):
        shortest = float(GeodesicField(costmap, start).distances(np.array([[goal.x, goal.y]]))[0])
        for name, found in lengths.items():
            begin = time.process_time()
            path = make_planner(name).plan(costmap, start, goal, rng)
            times[name].append(time.process_time() - begin)
            found.append(path.length / shortest)
        ends = costmap.grid.to_cells(np.array([(start.x, start.y), (goal.x, goal.y)]))
        source, target = (tuple(map(int, cell)) for cell in ends)
        times["plain Python A*"].append(seconds(lambda s=source, t=target: heap_search(costmap.cost, s, t), 1))
    for name, spent in times.items():
        ratio = np.median(np.array(spent) / np.array(times["astar"]))
        found = lengths.get(name)
        extra = f"   length / shortest {np.median(found):.3f}, at most {max(found):.3f}" if found else ""
        print(f"plan {size} x {size}: {name:<18} {np.median(spent) * 1e3:9.2f} ms   ratio to astar {ratio:7.2f}{extra}")


def main() -> None:
    grid = rooms(300)
    costmap = Costmap(grid, DISC)
    start = Pose2D(1.0, 1.0)
    free = np.where(grid.states == 100, 0, 255).astype(np.uint8)
    report(
        "exact distances, 300 x 300",
        lambda: distance_field(grid.states == 100),
        {"cv2.distanceTransform (no labels)": lambda: cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)},
    )
    source = tuple(map(int, grid.to_cells(np.array([[start.x, start.y]]))[0]))
    _ = costmap.open_steps
    uniform = np.where(costmap.passable, 1.0, math.inf)
    report(
        "geodesic field, 300 x 300",
        lambda: GeodesicField(costmap, start),
        {"heapq Dijkstra, 8 directions": lambda: heap_search(uniform, source, None)},
        3,
    )
    planner, pose, twist, target = DwaPlanner(ROBOT, DwaSettings(speeds=20, rates=31)), start, Twist2D(0.3), (1.8, 1.2)
    near = grid.to_points(np.argwhere(grid.states == 100))
    near = near[np.hypot(*(near - (start.x, start.y)).T) < 1.2]
    report(
        "DWA, 20 x 31 samples",
        lambda: planner.command(pose, twist, target, costmap, 0.1),
        {f"numpy DWA, {len(near)} points": lambda: numpy_dwa(pose, target, near, 20, 31)},
        30,
    )
    following()
    planners(300, 12)
    planners(1000, 6)


def following() -> None:
    grid = rooms(300)
    navigator = Navigator(ROBOT, lambda: grid)
    start, goal = Pose2D(1.0, 1.0), Pose2D(14.0, 14.0)
    follower = navigator.follow(navigator.plan(start, goal), goal)
    state = BaseState(start, Twist2D(0.3), 0.0)
    scan = LaserScan(np.full(360, 4.0), -math.pi, math.tau / 360, 0.05, 10.0, 0.0)
    follower.update(state, scan)
    print(f"following: {seconds(lambda: follower.update(state, scan), 200) * 1e6:.0f} µs an update")


if __name__ == "__main__":
    main()
