from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.world_file import load_world
from zavis_bt.bench import load_episodes, shortest_path_length
from zavis_bt.bench.shortest_path import GRACE, ROBOT_RADIUS, VIEW_RANGE

RESOLUTION = 0.05


def room(width: float = 8.0, height: float = 4.0) -> NDArray[np.bool_]:
    """Return the occupied cells of an empty room with its walls outside [0, width] x [0, height]."""
    return np.pad(
        np.zeros((round(height / RESOLUTION), round(width / RESOLUTION)), dtype=bool), 1, constant_values=True
    )


def block(grid: NDArray[np.bool_], x0: float, y0: float, x1: float, y1: float) -> NDArray[np.bool_]:
    changed = grid.copy()
    col0, row0, col1, row1 = (round(value / RESOLUTION) + 1 for value in (x0, y0, x1, y1))
    changed[row0:row1, col0:col1] = True
    return changed


def length(occupied: NDArray[np.bool_], walls: NDArray[np.bool_], start: Any, *targets: tuple[float, float]) -> float:
    return shortest_path_length(occupied, walls, RESOLUTION, (-RESOLUTION, -RESOLUTION), start, targets)


def test_a_straight_drive_ends_where_the_view_begins() -> None:
    free = room()
    assert length(free, free, (1.0, 2.0), (7.0, 2.0)) == pytest.approx(6.0 - VIEW_RANGE, abs=RESOLUTION)


def test_the_length_is_zero_where_the_target_is_in_view_at_the_start() -> None:
    free = room()
    assert length(free, free, (1.0, 2.0), (1.0 + VIEW_RANGE, 2.0)) == 0.0


def test_the_nearest_instance_counts() -> None:
    free = room()
    far, near = (7.0, 2.0), (4.0, 2.0)
    assert length(free, free, (1.0, 2.0), far, near) == length(free, free, (1.0, 2.0), near)


def test_furniture_is_driven_around_but_seen_over() -> None:
    walls = room()
    occupied = block(walls, 2.0, 0.0, 2.5, 4.0)
    assert length(occupied, walls, (1.0, 2.0), (2.75, 2.0)) == 0.0
    assert length(occupied, walls, (1.0, 2.0), (5.0, 2.0)) == math.inf


def test_walls_hide_except_right_before_the_target() -> None:
    free = room()
    thin = block(free, 2.0, 0.0, 2.1, 4.0)
    start = (1.0, 2.0)
    assert length(thin, thin, start, (2.1 + GRACE / 2, 2.0)) == math.inf
    assert length(thin, thin, start, (2.0 + GRACE * 0.9, 2.0)) == 0.0


def test_the_way_around_a_corner_is_taut_and_keeps_the_radius() -> None:
    free = room()
    wall = block(free, 4.0, 0.0, 4.1, 2.5)  # the gap is above it
    target = (6.8, 0.2)
    got = length(wall, wall, (1.0, 0.5), target)
    corner = math.hypot(4.05 - 1.0, 2.5 + ROBOT_RADIUS - 0.5)
    assert corner < got < corner + 2.2


def test_a_gap_narrower_than_the_robot_is_no_way() -> None:
    free = room()
    wall = block(free, 4.0, 0.0, 4.1, 4.0)
    for gap, passable in ((0.3, False), (0.35, True)):
        opened = wall.copy()
        opened[40 : 40 + round(gap / RESOLUTION), :] = free[40 : 40 + round(gap / RESOLUTION), :]
        assert math.isfinite(length(opened, opened, (1.0, 0.5), (7.5, 3.5))) == passable


def test_no_length_is_shorter_than_the_straight_line_to_the_view() -> None:
    rng = np.random.default_rng(0)
    walls = room()
    for _ in range(20):
        cluttered = block(walls, *(corner := rng.uniform(0.5, 3.0, 2)), *(corner + 0.5))
        start, target = rng.uniform((0.3, 3.3), (7.7, 3.7)), rng.uniform((0.1, 0.1), (7.9, 3.9))
        got = length(cluttered, walls, tuple(start), tuple(target))
        straight = math.dist(start, target) - VIEW_RANGE
        assert got >= straight - 1e-9
        assert got <= max(straight, 0.0) * 1.1 + 1.5


def test_a_room_without_a_free_cell_has_no_path() -> None:
    full = np.ones((20, 20), dtype=bool)
    assert length(full, full, (0.5, 0.5), (0.8, 0.8)) == math.inf


def test_the_length_agrees_with_the_episodes(shared: Path) -> None:
    """A single cell at the edge of a view may move the goal, so a few may differ."""
    sample = [
        episode
        for name in ("ithor", "ithor_apartments")
        for episode in load_episodes(shared / "worlds" / name / "episodes.jsonl")
    ][3::6]
    assert len(sample) == 60
    worlds = functools.cache(load_world)
    off = []
    for episode in sample:
        world = worlds(episode.world)
        got = shortest_path_length(
            world.occupied,
            world.walls,
            world.grid.resolution,
            world.grid.origin,
            (episode.start.x, episode.start.y),
            episode.target_positions(),
        )
        assert episode.shortest_path_length is not None
        off.append(abs(got - episode.shortest_path_length))
    assert np.median(off) < 0.002
    assert np.mean(np.array(off) < 0.05) >= 0.95
    assert max(off) < 0.3
