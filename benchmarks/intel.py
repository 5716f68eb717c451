"""A real building: `python -m benchmarks.intel LOG [--picture PNG]`, LOG being a LiDAR log in CARMEN's format.

Builds the map from the log's corrected poses, casts the log's beams in it, finds frontiers and plans across. The log
known as Intel Research Lab (Radish) is the one that the targets are stated for.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from benchmarks.mapping_speed import one_line_a_beam
from benchmarks.timing import machine, take_turns, verdict
from sim.raycast import RayCaster
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.mapping import CarmenScan, OccupancyGrid, find_frontiers, frontier_goal, read_carmen
from zavis_bt.planning import Costmap, GeodesicField, PlanningError, make_planner
from zavis_bt.types import FREE, OCCUPIED, FloatArray, GridMap, Pose2D
from zavis_bt.types import Path as Way

CELL = 0.05
MARGIN = 12.0  # round the places driven, for the rival's fixed array [m]


def build(log: list[CarmenScan]) -> GridMap:
    grid = OccupancyGrid(CELL, no_return_is_free=False)  # the laser loses beams on glass
    for entry in log:
        grid.integrate(entry.scan, entry.pose)
    return grid.map


def build_plainly(log: list[CarmenScan]) -> np.ndarray:
    """Every cell of every beam a miss, its end a hit, in an array of known size: the least a mapper can do."""
    places = np.array([(entry.pose.x, entry.pose.y) for entry in log])
    low, high = places.min(axis=0) - MARGIN, places.max(axis=0) + MARGIN
    cells = np.zeros(np.ceil((high - low) / CELL).astype(int)[::-1], dtype=np.float32)
    for entry in log:
        back = np.isfinite(entry.scan.ranges)
        x, y = (entry.pose.x - low[0]) / CELL, (entry.pose.y - low[1]) / CELL
        one_line_a_beam(cells, x, y, entry.pose.yaw + entry.scan.angles[back], entry.scan.ranges[back], 80.0, CELL)
    return cells


def errors(log: list[CarmenScan], grid: GridMap) -> FloatArray:
    """|cast − measured| of every beam that came back [m]; beams that hit nothing in the map count as 80 m."""
    caster = RayCaster(grid.states == OCCUPIED, grid.resolution, grid.origin)
    found = []
    for entry in log:
        back = np.isfinite(entry.scan.ranges)
        cast = caster.cast(entry.pose.x, entry.pose.y, entry.pose.yaw + entry.scan.angles[back], 80.0)
        found.append(np.abs(np.minimum(cast, 80.0) - entry.scan.ranges[back]))
    return np.concatenate(found)


def farthest(costmap: Costmap, start: Pose2D) -> tuple[Pose2D, Way, int]:
    """The place with the longest way from a start, the way to it, and how many farther ones had none.

    The field knows the robot's inner circle; the planner its outline, so it may refuse what the field can reach.
    """
    field = GeodesicField(costmap, start)
    points = costmap.grid.to_points(np.argwhere(field.reachable)[::3])
    lengths = field.distances(points)
    refused = 0
    while True:
        goal = Pose2D(*points[lengths.argmax()].tolist())
        try:
            return goal, make_planner("astar").plan(costmap, start, goal, np.random.default_rng(0)), refused
        except PlanningError:
            refused += 1
            lengths[np.hypot(*(points - (goal.x, goal.y)).T) < 1.0] = 0.0
            if not lengths.any():
                raise SystemExit(f"no way from ({start.x:.1f}, {start.y:.1f}) to anywhere") from None


def mapping(log: list[CarmenScan], read_seconds: float) -> GridMap:
    begin = time.perf_counter()
    grid = build(log)
    first = time.perf_counter() - begin
    spent = take_turns({"ours": lambda: build(log), "plain": lambda: build_plainly(log)}, 5)
    free = float((grid.states == FREE).sum()) * CELL**2
    print(f"log       {len(log)} scans of {len(log[0].scan.ranges)} beams, read in {read_seconds:.2f} s")
    print(
        f"map       {spent['ours']:.2f} s CPU ({first:.2f} s the first time), {grid.shape[1]} x {grid.shape[0]} cells, "
        f"{free:.0f} m² free; one line a beam {spent['plain']:.2f} s, ratio {spent['plain'] / spent['ours']:.1f}"
    )
    print(f"target, at most 5 s with reading: {verdict(read_seconds + first <= 5.0)}")
    return grid


def casting(log: list[CarmenScan], grid: GridMap) -> None:
    begin = time.process_time()
    all_beams = errors(log, grid)
    rate = len(log) / (time.process_time() - begin)
    median, most = np.percentile(all_beams, [50, 75])
    print(
        f"casts     median {median * 100:.1f} cm, 75 % {most * 100:.1f} cm of {len(all_beams)} beams, "
        f"{rate:,.0f} scans/s"
    )
    unseen = np.percentile(errors(log[1::2], build(log[::2])), [50, 75]) * 100
    print(f"          scans that the map was not made of: median {unseen[0]:.1f} cm, 75 % {unseen[1]:.1f} cm")
    print(f"target, median at most 10 cm: {verdict(median <= 0.10 and unseen[0] <= 10.0)}")


def frontiers(grid: GridMap, costmap: Costmap, start: Pose2D) -> FloatArray:
    """Find the frontiers; return where to drive for those within reach."""
    spent = take_turns({"find": lambda: find_frontiers(grid)}, 9)["find"]
    found, reachable = find_frontiers(grid), GeodesicField(costmap, start).reachable
    goals = [goal for frontier in found if (goal := frontier_goal(frontier, grid, reachable)) is not None]
    print(f"frontiers {len(found)} in {spent * 1e3:.1f} ms CPU, {len(goals)} of them within reach")
    return np.array(goals, dtype=np.float64).reshape(-1, 2)


def planning(costmap: Costmap, start: Pose2D) -> Way:
    one, _, _ = farthest(costmap, start)
    other, way, refused = farthest(costmap, one)
    shortest = float(GeodesicField(costmap, one).distances(np.array([[other.x, other.y]]))[0])
    planner, rng = make_planner("astar"), np.random.default_rng(0)
    spent = take_turns({"plan": lambda: planner.plan(costmap, one, other, rng)}, 9)["plan"]
    print(
        f"planning  from ({one.x:.1f}, {one.y:.1f}) to ({other.x:.1f}, {other.y:.1f}), the farthest pair: "
        f"{way.length:.1f} m, {way.length / shortest:.3f} × the geodesic, in {spent * 1e3:.1f} ms CPU"
    )
    if refused:
        print(f"          {refused} places farther away are reached by a disc of the inner radius, not by the outline")
    return way


def save_picture(path: Path, grid: GridMap, way: Way, goals: FloatArray) -> None:
    import cv2

    from zavis_bt.recording import draw_map

    start = Pose2D(float(way.points[0, 0]), float(way.points[0, 1]))
    points = np.vstack([np.linspace(a, b, 50) for a, b in zip(way.points, way.points[1:], strict=False)])
    title = f"Farthest way, {way.length:.1f} m"
    picture = draw_map(grid, trajectory=points, start=start, frontiers=goals, title=title)
    if not cv2.imwrite(str(path), picture[..., ::-1]):
        raise SystemExit(f"{path}: cannot be written")
    print(f"picture   {path}")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.intel", description=__doc__.split("\n")[0])
    parser.add_argument("log", type=Path, metavar="LOG", help="LiDAR log in CARMEN's format, .log or .log.gz")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="save a picture of map, frontiers and way")
    parser.add_argument("--robot", default="pioneer3at", help="robot whose footprint plans (%(default)s)")
    arguments = parser.parse_args()
    print(machine())
    begin = time.perf_counter()
    log = list(read_carmen(arguments.log))
    grid = mapping(log, time.perf_counter() - begin)
    casting(log, grid)
    costmap = Costmap(grid, load_robot_spec(arguments.robot).footprint)
    start = log[0].pose
    goals = frontiers(grid, costmap, start)
    way = planning(costmap, start)
    if arguments.picture:
        save_picture(arguments.picture, grid, way, goals)


if __name__ == "__main__":
    main()
