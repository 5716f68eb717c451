from __future__ import annotations

import math

import numpy as np
import pytest
from seen_worlds import piece, room, thing

from sim.render_rays import FLOOR, NOTHING, WALL
from sim.scene import Scene
from sim.world import Furniture

EYE = np.array([1.0, 2.0, 0.9])


def directions(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 3))


def plane_by_plane(piece: Furniture, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Entry into a box as the nearest hit of its six faces, each a plane with bounds."""
    cos, sin = math.cos(piece.yaw), math.sin(piece.yaw)
    axes = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    half = np.array([piece.length, piece.width, piece.height]) / 2
    start = axes @ (origin - (piece.x, piece.y, piece.height / 2))
    steps = rays @ axes.T
    best = np.full(len(rays), np.inf)
    for axis in range(3):
        for side in (-1, 1):
            t = (side * half[axis] - start[axis]) / steps[:, axis]
            hits = start + t[:, None] * steps
            others = [k for k in range(3) if k != axis]
            inside = (np.abs(hits[:, others]) <= half[others]).all(axis=1) & (t > 0)
            best = np.where(inside & (t < best), t, best)
    return best


def cell_by_cell(world, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Entry into the walls as the nearest hit of every wall cell, each a box."""
    cells = np.argwhere(world.walls)
    low = np.column_stack((cells[:, ::-1] * 0.05 + world.grid.origin, np.full(len(cells), -1e9)))
    high = np.column_stack((low[:, :2] + 0.05, np.full(len(cells), world.wall_height)))
    a, b = (low[None] - origin) / rays[:, None], (high[None] - origin) / rays[:, None]
    enter, leave = np.minimum(a, b).max(axis=2), np.maximum(a, b).min(axis=2)
    return np.where((enter <= leave) & (enter > 0), enter, np.inf).min(axis=1)


@pytest.mark.parametrize("yaw", [0.0, 0.4, math.pi / 2, 2.5])
def test_rays_enter_oriented_boxes_where_their_faces_are(yaw):
    box = Furniture("desk_1", "desk", 2.4, 2.2, yaw, 1.4, 0.5, 1.2)
    rays = directions(4000) + np.array([1.0, 0.0, 0.0])
    expected = plane_by_plane(box, EYE, rays)
    distances, surfaces = Scene.of(room((box,))).cast(EYE, rays)
    assert np.array_equal(surfaces == 0, expected < np.inf)
    np.testing.assert_allclose(distances[surfaces == 0], expected[surfaces == 0], rtol=1e-9)
    assert (surfaces == 0).sum() > 200


@pytest.mark.parametrize("height", [0.9, 3.5], ids=["below the walls' tops", "above them"])
def test_rays_meet_the_wall_cells_exactly(height):
    world = room(walls=(slice(40, 43), slice(60, 90)))
    origin, rays = np.array([1.017, 1.931, height]), directions(600, seed=1)
    rays[:, 2] -= 0.5 * (height > 1)
    expected = cell_by_cell(world, origin, rays)
    floor = np.where(rays[:, 2] < 0, -height / rays[:, 2], np.inf)
    distances, surfaces = Scene.of(world).cast(origin, rays)
    np.testing.assert_allclose(distances, np.minimum(expected, floor), rtol=1e-9)
    assert np.array_equal(surfaces == WALL, expected < floor)
    assert np.array_equal(surfaces == NOTHING, np.isinf(np.minimum(expected, floor)))
    assert (surfaces == WALL).sum() > 50


def test_rays_along_the_axes_meet_walls_and_floor():
    rays = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, -1], [0, 0, 1]])
    distances, surfaces = Scene.of(room()).cast(EYE, rays)
    np.testing.assert_allclose(distances, [5, 1, 2, 2, 0.9, np.inf], rtol=1e-9)
    assert surfaces.tolist() == [WALL, WALL, WALL, WALL, FLOOR, NOTHING]


def test_distances_are_in_units_of_the_direction():
    distances, _ = Scene.of(room()).cast(EYE, np.array([[1.0, 0, 0], [2.0, 0, 0]]))
    assert distances[0] == pytest.approx(2 * distances[1])


def test_a_box_around_the_eye_does_not_blind_it():
    _, surfaces = Scene.of(room((piece("bed", 1.0, 2.0, 1.5),))).cast(EYE, np.array([[1.0, 0, 0]]))
    assert surfaces.tolist() == [WALL]


def test_a_carrier_is_open_towards_what_it_carries_and_to_nothing_else():
    dresser = piece("dresser", 2.0, 2.0, 1.2)
    inside = thing("mug", 2.0, 2.0, 0.85, on="dresser_1")
    behind = thing("box", 3.0, 2.0, 0.7)
    _, surfaces = Scene.of(room((dresser,), (inside,))).cast(EYE, np.array([[1.0, 0, 0]]))
    assert surfaces.tolist() == [1]
    _, surfaces = Scene.of(room((dresser,), (behind,))).cast(EYE, np.array([[1.0, 0, 0]]))
    assert surfaces.tolist() == [0]


def test_what_stands_before_a_carrier_hides_what_that_carries():
    dresser = piece("dresser", 3.0, 2.0, 1.2)
    chair = piece("chair", 2.0, 2.0, 1.0)
    mug = thing("mug", 3.0, 2.0, 0.85, on="dresser_1")
    _, surfaces = Scene.of(room((dresser, chair), (mug,))).cast(EYE, np.array([[1.0, 0, 0]]))
    assert surfaces.tolist() == [1]


def test_furniture_that_holds_an_objects_centre_is_open_towards_it():
    _, surfaces = Scene.of(room((piece("bed", 2.0, 2.0, 1.2),), (thing("mug", 1.8, 2.0, 0.85),))).cast(
        EYE, np.array([[1.0, 0, 0]])
    )
    assert surfaces.tolist() == [1]


def test_the_underside_of_what_stands_on_a_carrier_is_not_seen_through_it():
    shelf, book = piece("shelf", 2.0, 2.0, 1.2), thing("book", 2.0, 2.0, 1.2, on="shelf_1")
    up = np.array([[1.0, 0.0, 0.3]])  # meets the book from below, through the shelf's top
    _, surfaces = Scene.of(room((shelf,), (book,))).cast(EYE, up)
    assert surfaces.tolist() == [0]


def test_an_empty_world_has_walls_and_a_floor():
    scene = Scene.of(room())
    assert scene.things == ()
    assert scene.paints.shape == (9, 3)
