from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.world import Furniture, World, WorldObject, mark_touched
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap, Pose2D


def clipped_area(box: list[tuple[float, float]], x0: float, y0: float, x1: float, y1: float) -> float:
    """Area of a convex polygon inside a rectangle (Sutherland-Hodgman)."""
    polygon = box
    for axis, bound, sign in ((0, x0, 1), (0, x1, -1), (1, y0, 1), (1, y1, -1)):
        clipped = []
        for one, two in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            a, b = sign * (one[axis] - bound), sign * (two[axis] - bound)
            if a >= 0:
                clipped.append(one)
            if a * b < 0:
                t = a / (a - b)
                clipped.append((one[0] + t * (two[0] - one[0]), one[1] + t * (two[1] - one[1])))
        polygon = clipped
        if not polygon:
            return 0.0
    shoelace = sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True))
    return abs(shoelace) / 2


@settings(deadline=None, max_examples=40)
@given(
    st.floats(-0.3, 1.5), st.floats(-0.3, 1.3), st.floats(-4, 4), st.floats(0.03, 0.9), st.floats(0.03, 0.9)
)  # fmt: skip
def test_a_cell_is_touched_where_its_square_and_the_box_overlap(
    x: float, y: float, yaw: float, length: float, width: float
) -> None:
    grid = GridMap(np.zeros((11, 13), dtype=np.int8), 0.1, (-0.05, 0.0))
    touched = np.zeros(grid.shape, dtype=np.bool_)
    mark_touched(touched, grid, Furniture("a", "a", x, y, yaw, length, width, 1.0))
    corners = [
        Pose2D(x, y, yaw) @ Pose2D(a * length / 2, b * width / 2) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    box = [(corner.x, corner.y) for corner in corners]
    for row in range(11):
        for col in range(13):
            x0, y0 = -0.05 + col * 0.1, row * 0.1
            if clipped_area(box, x0, y0, x0 + 0.1, y0 + 0.1) > 1e-9:
                assert touched[row, col]
            if clipped_area(box, x0 - 1e-6, y0 - 1e-6, x0 + 0.1 + 1e-6, y0 + 0.1 + 1e-6) == 0:
                assert not touched[row, col]


def test_a_cell_whose_edge_lies_on_the_box_is_furniture() -> None:
    grid = GridMap(np.full((4, 4), OCCUPIED, dtype=np.int8), 0.25, (0.0, 0.0))
    world = World("w", grid, 2.5, (Furniture("box", "bed", 0.375, 0.375, 0.0, 0.25, 0.25, 0.5),))
    assert world.furniture_cells[:3, :3].all()
    assert world.furniture_cells.sum() == 9


def test_walls_and_furniture_cells_divide_what_is_not_free() -> None:
    states = np.array([[OCCUPIED, UNKNOWN, FREE], [OCCUPIED, OCCUPIED, FREE]], dtype=np.int8)
    world = World("w", GridMap(states, 1.0, (0.0, 0.0)), 2.5, (Furniture("f", "desk", 1.5, 1.5, 0.0, 0.5, 0.5, 0.7),))
    assert world.occupied.tolist() == [[True, True, False], [True, True, False]]
    assert world.furniture_cells.tolist() == [[False, False, False], [False, True, False]]
    assert (world.walls | world.furniture_cells).tolist() == world.occupied.tolist()
    assert not world.occupied.flags.writeable


def test_other_objects_share_the_derived_arrays(room: World) -> None:
    other = room.with_objects([WorldObject("mug_1", "mug", 1.0, 1.0, 0.0, (0.1, 0.1, 0.1))])
    assert other.walls is room.walls
    assert other.ray_caster is room.ray_caster
    assert [thing.id for thing in other.objects] == ["mug_1"]
    assert room.objects == ()


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(-0.2, 1.2), st.floats(-0.2, 1.0), st.floats(0.02, 0.4))
def test_a_disc_fits_where_it_or_its_cell_is_far_enough_from_occupied_centres(
    seed: int, x: float, y: float, radius: float
) -> None:
    occupied = np.random.default_rng(seed).random((8, 10)) < 0.15
    world = World("w", GridMap(np.where(occupied, OCCUPIED, FREE).astype(np.int8), 0.1, (0.0, 0.0)), 2.5)
    rows, cols = np.nonzero(np.pad(occupied, 8, constant_values=True))

    def clearance(px: float, py: float) -> float:
        return float(np.hypot((cols - 7.5) * 0.1 - px, (rows - 7.5) * 0.1 - py).min())

    exact, cell = clearance(x, y), clearance(math.floor(x / 0.1) * 0.1 + 0.05, math.floor(y / 0.1) * 0.1 + 0.05)
    on_edge = min(abs(math.remainder(x, 0.1)), abs(math.remainder(y, 0.1))) < 1e-6
    if not on_edge and min(abs(exact - radius), abs(cell - radius)) > 1e-7:
        assert world.fits(x, y, radius) == (max(exact, cell) > radius)


def test_a_disc_fits_on_the_edge_of_a_passable_cell(room: World) -> None:
    # Cell centres are 0.2 m and 0.15 m from those of the wall; the edge between them belongs to both.
    assert room.fits(0.15, 2.0, 0.18)
    assert not room.fits(0.149, 2.0, 0.18)


@pytest.mark.parametrize("group", ["ithor", "ithor_apartments"])
def test_real_walls_are_what_no_box_touches(shared, group: str) -> None:
    from sim.world_file import load_world

    for path in sorted((shared / "worlds" / group).glob("*.world.yaml"))[::7]:
        world = load_world(path)
        rows, cols = np.nonzero(world.occupied)
        touched = np.zeros(len(rows), dtype=np.bool_)
        for piece in world.furniture:
            assert round(math.degrees(piece.yaw)) % 90 == 0
            turned = round(math.degrees(piece.yaw)) % 180 == 90
            wide, deep = (piece.width, piece.length) if turned else (piece.length, piece.width)
            x = (cols + 0.5) * world.grid.resolution + world.grid.origin[0]
            y = (rows + 0.5) * world.grid.resolution + world.grid.origin[1]
            reach = world.grid.resolution / 2 + 1e-9
            touched |= (abs(x - piece.x) <= wide / 2 + reach) & (abs(y - piece.y) <= deep / 2 + reach)
        assert (world.walls[rows, cols] == ~touched).all()
