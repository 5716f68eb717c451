from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy import ndimage

from zavis_bt.mapping import find_frontiers, frontier_goal
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap

STATES = arrays(np.int8, array_shapes(min_dims=2, max_dims=2, max_side=24), elements=st.sampled_from([-1, 0, 0, 100]))


def grid_of(states: np.ndarray) -> GridMap:
    return GridMap(states.astype(np.int8), 0.05, (-1.0, 2.0))


def half_open_room() -> np.ndarray:
    states = np.full((30, 40), UNKNOWN)
    states[5:25, 5:35] = OCCUPIED
    states[6:24, 6:35] = FREE  # open to the right
    return states


@settings(max_examples=80, deadline=None)
@given(states=STATES)
def test_frontiers_are_the_clusters_of_free_cells_beside_unknown_ones(states: np.ndarray) -> None:
    unknown = np.pad(states == UNKNOWN, 1, constant_values=True)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    labels, count = ndimage.label((states == FREE) & beside, structure=np.ones((3, 3)))
    expected = []
    for number in range(1, count + 1):
        cells = np.argwhere(labels == number)
        if np.ptp(cells, axis=0).max() + 1 >= 6:
            expected.append({tuple(cell) for cell in cells.tolist()})
    found = find_frontiers(grid_of(states))
    assert [{tuple(cell) for cell in frontier.cells.tolist()} for frontier in found] == expected


def test_an_opening_is_one_frontier_with_its_middle_and_length() -> None:
    (frontier,) = find_frontiers(grid_of(half_open_room()))
    assert frontier.length == pytest.approx(18 * 0.05)
    assert frontier.centroid == pytest.approx((-1.0 + 34.5 * 0.05, 2.0 + 15.0 * 0.05))
    assert set(frontier.cells[:, 1].tolist()) == {34}


def test_unknown_specks_inside_free_space_are_no_frontier() -> None:
    states = np.full((30, 30), OCCUPIED)
    states[1:-1, 1:-1] = FREE
    states[10, 10] = states[20, 20] = states[20, 21] = states[21, 20] = UNKNOWN
    assert find_frontiers(grid_of(states)) == []


def test_the_length_limit_is_inclusive() -> None:
    states = np.full((10, 10), OCCUPIED)
    states[5, 2:8], states[6, 2:8] = FREE, UNKNOWN
    assert len(find_frontiers(grid_of(states), min_length=0.3)) == 1
    assert find_frontiers(grid_of(states), min_length=0.301) == []


def test_a_closed_room_has_no_frontier() -> None:
    states = half_open_room()
    states[:, 34] = OCCUPIED
    assert find_frontiers(grid_of(states)) == []


def test_an_empty_map_has_no_frontier() -> None:
    assert find_frontiers(GridMap(np.zeros((0, 0), np.int8), 0.05, (0.0, 0.0))) == []


def test_the_goal_is_the_reachable_member_nearest_the_middle() -> None:
    grid = grid_of(half_open_room())
    (frontier,) = find_frontiers(grid)
    reachable = np.ones(grid.shape, dtype=bool)
    reachable[10:20] = False
    goal = frontier_goal(frontier, grid, reachable)
    assert goal == pytest.approx((-1.0 + 34.5 * 0.05, 2.0 + 9.5 * 0.05))
    assert frontier_goal(frontier, grid, np.zeros(grid.shape, dtype=bool)) is None


def test_a_function_may_say_what_is_reachable() -> None:
    grid = grid_of(half_open_room())
    (frontier,) = find_frontiers(grid)
    x, y = frontier_goal(frontier, grid, lambda points: points[:, 1] > 3.0) or (0.0, 0.0)
    assert (x, y) == pytest.approx((-1.0 + 34.5 * 0.05, 2.0 + 20.5 * 0.05))
