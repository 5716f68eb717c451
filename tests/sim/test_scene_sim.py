from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from seen_worlds import middle, piece, rays_of, room, snapshot, thing

from sim.appearance import look_of
from sim.render_rays import FLOOR, NOTHING, WALL
from sim.scene import Scene
from sim.world import Furniture


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
    box = Furniture("obstacle_1", "obstacle", 2.4, 2.2, yaw, 1.4, 0.5, 1.2)
    frame = snapshot(room((box,)), 1.0, 2.0, tilt=-0.2)
    expected = plane_by_plane(box, frame.transform_camera_to_map[:3, 3], rays_of(frame))
    hit = frame.surfaces.ravel() == 0
    assert np.array_equal(hit, expected < np.inf)
    np.testing.assert_allclose(frame.depth.ravel()[hit], expected[hit], rtol=1e-6)
    assert hit.sum() > 200


@pytest.mark.parametrize("height", [0.9, 3.5], ids=["below the walls' tops", "above them"])
@pytest.mark.parametrize("yaw", [0.1, 1.7, 3.0, -1.2])
def test_rays_meet_the_wall_cells_exactly(height, yaw):
    world = room(walls=(slice(40, 43), slice(60, 90)))
    frame = snapshot(world, 1.017, 1.931, yaw, -0.9 if height > 1 else -0.1, height, (48, 36))
    origin, rays = frame.transform_camera_to_map[:3, 3], rays_of(frame)
    expected = cell_by_cell(world, origin, rays)
    with np.errstate(divide="ignore"):
        floor = np.where(rays[:, 2] < 0, -height / rays[:, 2], np.inf)
    nearest = np.minimum(expected, floor)
    depth, surfaces = frame.depth.ravel(), frame.surfaces.ravel()
    np.testing.assert_allclose(depth[nearest < np.inf], nearest[nearest < np.inf], rtol=1e-6)
    assert np.array_equal(surfaces == WALL, expected < floor)
    assert np.array_equal(surfaces == NOTHING, np.isinf(nearest))
    assert np.array_equal(surfaces == FLOOR, (floor <= expected) & (floor < np.inf))


def test_a_box_around_the_eye_does_not_blind_it():
    assert middle(snapshot(room((piece("obstacle", 1.0, 2.0, 1.5),)), 1.0, 2.0)) == WALL


def test_a_carrier_is_open_towards_what_it_carries_and_to_nothing_else():
    dresser = piece("dresser", 2.0, 2.0, 1.2)
    inside = thing("mug", 2.0, 2.0, 0.85, on="dresser_1")
    behind = thing("box", 3.0, 2.0, 0.7)
    assert middle(snapshot(room((dresser,), (inside,)), 1.0, 2.0)) == 1
    assert middle(snapshot(room((dresser,), (behind,)), 1.0, 2.0)) == 0


def test_what_stands_before_a_carrier_hides_what_that_carries():
    dresser = piece("dresser", 3.0, 2.0, 1.2)
    obstacle = piece("obstacle", 2.0, 2.0, 1.0)
    mug = thing("mug", 3.0, 2.0, 0.85, on="dresser_1")
    assert middle(snapshot(room((dresser, obstacle), (mug,)), 1.0, 2.0)) == 1


def test_furniture_that_holds_an_objects_centre_is_open_towards_it():
    assert middle(snapshot(room((piece("obstacle", 2.0, 2.0, 1.2),), (thing("mug", 1.8, 2.0, 0.85),)), 1.0, 2.0)) == 1


def test_the_underside_of_what_stands_on_a_carrier_is_not_seen_through_it():
    block, box = piece("obstacle", 2.0, 2.0, 1.2), thing("box", 2.0, 2.0, 1.2, on="obstacle_1")
    frame = snapshot(room((block,), (box,)), 1.0, 2.0, tilt=0.3)
    points = frame.transform_camera_to_map[:3, 3] + frame.depth.reshape(-1, 1) * rays_of(frame)
    on_box = frame.surfaces.ravel() == 1
    assert on_box.any()
    assert points[on_box, 2].min() > 1.2 + 0.01


def test_one_sees_between_the_legs_of_a_table():
    seed = next(k for k in range(20) if look_of("dining table", None, "", "", k).variant == 0)  # the one with four legs
    table = replace(piece("dining table", 2.5, 2.0, 0.9, size=1.2), appearance=seed)
    box = thing("box", 3.6, 2.3)
    frame = snapshot(room((table,), (box,)), 1.0, 2.0, height=0.5)
    assert (frame.surfaces == 1).sum() > 50
    assert (frame.surfaces == 0).sum() > 100


def test_looks_are_the_same_each_time_and_differ_between_things():
    things = tuple(thing("mug", 2.0 + 0.3 * k, 1.5 + 0.3 * k, 0.8, number=k) for k in range(6))
    first, second = Scene.of(room((), things)), Scene.of(room((), things))
    assert np.array_equal(first.parts.paints, second.parts.paints)
    assert np.array_equal(first.parts.frames, second.parts.frames)
    assert len({tuple(look.colours[0]) for look in first.looks}) == 6


def test_an_empty_world_has_walls_and_a_floor():
    scene = Scene.of(room())
    assert scene.things == ()
    assert len(scene.parts.frames) == 0
    frame = snapshot(room(), 1.0, 2.0, tilt=-0.3)
    assert set(np.unique(frame.surfaces)) == {WALL, FLOOR}
