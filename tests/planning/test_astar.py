import numpy as np
from planning_world import DISC, RECTANGLE, cluttered, grid_of, random_places, room

from zavis_bt.planning import Costmap, GeodesicField, make_planner
from zavis_bt.types import FREE, OCCUPIED, Pose2D


def ratios(worlds: list[Costmap]) -> list[float]:
    found = []
    for seed, costmap in enumerate(worlds):
        start, *goals = random_places(costmap, 6, seed)
        shortest = GeodesicField(costmap, start).distances(np.array([(goal.x, goal.y) for goal in goals]))
        for goal, length in zip(goals, shortest, strict=True):
            if 1.0 < length < np.inf:
                path = make_planner("astar").plan(costmap, start, goal, np.random.default_rng())
                found.append(path.length / length)
    return found


def test_paths_are_within_two_percent_of_the_shortest_in_the_median():
    found = ratios([Costmap(grid_of(cluttered(seed)), DISC) for seed in range(8)])
    assert len(found) > 20
    assert np.median(found) <= 1.02
    assert max(found) < 1.15


def test_real_rooms_are_planned_within_two_percent_in_the_median(shared):
    from zavis_bt.mapping import load_map

    files = sorted((shared / "worlds" / "ithor").glob("FloorPlan*[0-9].yaml"))[::4]
    found = ratios([Costmap(load_map(file), DISC, unknown="obstacle") for file in files])
    assert np.median(found) <= 1.02


def test_paths_keep_off_obstacles_where_there_is_room():
    states = room(80, 80)
    states[30:50, 38:42] = OCCUPIED
    costmap = Costmap(grid_of(states), DISC)
    path = make_planner("astar").plan(costmap, Pose2D(1.0, 1.6), Pose2D(3.0, 1.6), np.random.default_rng())
    assert costmap.clearance(path.points[1:-1]).min() > 0.22


def test_a_rectangle_enters_a_narrow_door_straight():
    states = room(160, 160)
    states[:, 80] = OCCUPIED
    states[74:85, 80] = FREE
    costmap = Costmap(grid_of(states), RECTANGLE)
    path = make_planner("astar").plan(costmap, Pose2D(2.0, 1.0), Pose2D(6.0, 7.0), np.random.default_rng())
    corners = path.points[1:-1]
    crossing = np.flatnonzero((path.points[:-1, 0] < 4.0) & (path.points[1:, 0] > 4.05))
    assert len(crossing) == 1
    begin, end = path.points[crossing[0]], path.points[crossing[0] + 1]
    heading = np.arctan2(*(end - begin)[::-1])
    assert all(costmap.pose_fits(Pose2D(*(begin + share * (end - begin)), heading)) for share in np.linspace(0, 1, 50))
    assert (costmap.clearance(corners) > costmap.radius).all()
