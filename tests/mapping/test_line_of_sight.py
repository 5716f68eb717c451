from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from zavis_bt.mapping import clear_line, visible_from

WALLS = arrays(np.bool_, (12, 15), elements=st.booleans(), fill=st.just(False))
CELLS = st.tuples(st.integers(0, 11), st.integers(0, 14))


@settings(deadline=None)
@given(walls=WALLS, a=CELLS, b=CELLS)
def test_sight_is_mutual(walls: np.ndarray, a: tuple[int, int], b: tuple[int, int]) -> None:
    assert clear_line(walls, a, b) == clear_line(walls, b, a)


@settings(deadline=None)
@given(walls=WALLS, a=CELLS, b=CELLS)
def test_a_clear_line_crosses_no_wall(walls: np.ndarray, a: tuple[int, int], b: tuple[int, int]) -> None:
    steps = np.linspace(0, 1, 400)[:, None]
    points = np.array(a) + steps * (np.array(b) - np.array(a)) + 0.5
    inner = np.abs(points - np.round(points)).min(axis=1) > 1e-6  # points on a border belong to no cell alone
    cells = {tuple(cell) for cell in np.floor(points[inner]).astype(int).tolist()} - {a, b}
    if clear_line(walls, a, b):
        assert not any(walls[cell] for cell in cells)
    elif len(cells) and abs(a[0] - b[0]) != abs(a[1] - b[1]) and (abs(a[0] - b[0]) + abs(a[1] - b[1])) % 2 == 1:
        assert any(walls[cell] for cell in cells)  # an odd sum means the line runs through no corner


def test_a_line_cannot_slip_between_walls_that_touch_at_a_corner() -> None:
    walls = np.zeros((5, 5), dtype=bool)
    walls[2, 1] = walls[1, 2] = True
    assert not clear_line(walls, (0, 0), (4, 4))
    walls[2, 1] = False
    assert clear_line(walls, (0, 0), (4, 4))


def test_the_ends_may_be_blocked() -> None:
    walls = np.zeros((3, 6), dtype=bool)
    walls[1, 0] = walls[1, 5] = True
    assert clear_line(walls, (1, 0), (1, 5))
    walls[1, 3] = True
    assert not clear_line(walls, (1, 0), (1, 5))


def test_many_targets_are_judged_like_single_ones() -> None:
    rng = np.random.default_rng(0)
    walls = rng.random((40, 50)) < 0.1
    targets = np.column_stack((rng.integers(-2, 42, 200), rng.integers(-2, 52, 200)))
    seen = visible_from(walls, (20, 25), targets)
    assert seen.tolist() == [clear_line(walls, (20, 25), (row, col)) for row, col in targets.tolist()]
    outside = (targets < 0).any(axis=1) | (targets >= (40, 50)).any(axis=1)
    assert not seen[outside].any()
    assert seen.any()
