import heapq
import math

import numpy as np
import pytest
from planning_world import DISC, RESOLUTION, cluttered, doors, grid_of, random_places, room

from zavis_bt.planning import Costmap, GeodesicField
from zavis_bt.planning.steps import BORDER, open_steps, steps_of
from zavis_bt.types import OCCUPIED, Pose2D


def plain_dijkstra(passable: np.ndarray, source: tuple[int, int]) -> np.ndarray:
    """Lengths in 16 directions, in whole cells' true lengths."""
    steps = [(r, c) for r in range(-2, 3) for c in range(-2, 3) if r * r + c * c in (1, 2, 5)]
    best = np.full(passable.shape, math.inf)
    best[source] = 0.0
    queue = [(0.0, source)]
    while queue:
        length, (row, col) = heapq.heappop(queue)
        if length > best[row, col]:
            continue
        for r, c in steps:
            to = row + r, col + c
            if not (0 <= to[0] < passable.shape[0] and 0 <= to[1] < passable.shape[1]) or not passable[to]:
                continue
            if r * r + c * c == 5:
                half = (int(np.sign(r)) if abs(r) == 2 else 0, int(np.sign(c)) if abs(c) == 2 else 0)
                if not (passable[row + half[0], col + half[1]] and passable[to[0] - half[0], to[1] - half[1]]):
                    continue
            if length + math.hypot(r, c) < best[to] - 1e-12:
                best[to] = length + math.hypot(r, c)
                heapq.heappush(queue, (best[to], to))
    return best


@pytest.mark.parametrize("seed", range(6))
def test_reachable_and_lengths_agree_with_plain_dijkstra(seed):
    costmap = Costmap(grid_of(cluttered(seed, size=60, pieces=14)), DISC)
    (start,) = random_places(costmap, 1, seed)
    field = GeodesicField(costmap, start)
    row, col = costmap.grid.to_cells(np.array([[start.x, start.y]]))[0]
    plain = plain_dijkstra(costmap.passable, (row, col)) * RESOLUTION
    assert np.array_equal(field.reachable, np.isfinite(plain))
    cells = np.argwhere(np.isfinite(plain) & (plain > 0.5))[::7]
    ratio = field.distances(costmap.grid.to_points(cells)) / plain[tuple(cells.T)]
    assert ratio.max() < 1.005  # pulled taut it is shorter, but for what strict lines lose at corners
    assert ratio.min() > 0.97


def test_in_the_open_distances_are_straight_lines():
    costmap = Costmap(grid_of(room(80, 80)), DISC)
    points = np.random.default_rng(0).uniform(0.3, 3.7, (50, 2))
    field = GeodesicField(costmap, Pose2D(1.03, 2.01))
    np.testing.assert_allclose(field.distances(points), np.hypot(*(points - (1.03, 2.01)).T), rtol=1e-9, atol=2e-3)


def test_distances_do_not_depend_on_the_order_of_questions():
    costmap = Costmap(grid_of(cluttered(4)), DISC)
    start, *others = random_places(costmap, 12, 5)
    points = np.array([(p.x, p.y) for p in others])
    together = GeodesicField(costmap, start).distances(points)
    field = GeodesicField(costmap, start)
    apart = [float(field.distances(point[None])[0]) for point in points[::-1]]
    np.testing.assert_array_equal(together, apart[::-1])


def test_nothing_is_reached_behind_a_wall():
    states = room(40, 60)
    states[:, 30] = OCCUPIED
    field = GeodesicField(Costmap(grid_of(states), DISC), Pose2D(0.6, 1.0))
    assert not field.reachable[:, 30:].any()
    points = np.array([[2.5, 1.0], [1.0, 1.0], [9.0, 9.0], [1.5, 1.0]])
    assert field.distances(points)[0] == math.inf
    assert field.reaches(points).tolist() == [False, True, False, False]
    assert np.array_equal(np.isfinite(field.distances(points)), field.reaches(points))


def test_a_start_beside_a_wall_gets_out_and_one_inside_reaches_nothing():
    costmap = Costmap(grid_of(room(40, 40)), DISC)
    assert GeodesicField(costmap, Pose2D(0.1, 1.0)).distances(np.array([[1.0, 1.0]]))[0] == pytest.approx(0.9, abs=0.01)
    states = np.full((40, 40), OCCUPIED)
    states[20:, 20:] = 0
    lost = GeodesicField(Costmap(grid_of(states), DISC), Pose2D(0.3, 0.3))
    assert not lost.reachable.any()
    assert lost.distances(np.array([[1.5, 1.5]]))[0] == math.inf


def test_a_door_as_wide_as_the_robot_is_passed():
    field = GeodesicField(Costmap(grid_of(doors(8)), DISC), Pose2D(1.0, 1.5))
    assert field.distances(np.array([[6.5, 1.5]]))[0] == pytest.approx(5.5, rel=0.02)


def test_open_steps_say_which_neighbours_are_passable():
    passable = np.random.default_rng(3).random((12, 17)) < 0.7
    width = 17 + 2 * BORDER
    found, steps = open_steps(passable), steps_of(width)
    grid = np.pad(passable, BORDER).ravel()
    for cell in np.flatnonzero(grid):
        for i in range(16):
            passed = steps.lengths[i] < 2 or (grid[cell + steps.first[i]] and grid[cell + steps.second[i]])
            assert bool(found[cell] >> i & 1) == bool(grid[cell + steps.moves[i]] and passed)
    assert not found[~grid].any()
