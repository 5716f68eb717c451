from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scene import INTRINSICS, box_around, frame_of

from zavis_bt.perception import locate_landmark, locate_object
from zavis_bt.types import Box, Pose2D, RgbdFrame

PANEL = ((3.0, -0.5, 0.6), (3.05, 0.5, 1.4))  # an upright panel, 1 m wide, 3 m ahead


def test_panel_is_where_it_stands_and_as_wide_as_it_is() -> None:
    frame = frame_of([PANEL])
    located = locate_landmark(frame, box_around(PANEL, frame))
    assert located is not None
    np.testing.assert_allclose(located.position, (3.0, 0.0, 1.0), atol=0.02)
    assert located.radius == pytest.approx(0.5, rel=0.05)
    assert located.depth == pytest.approx(3.0, abs=1e-3)


@pytest.mark.parametrize("locate", [locate_landmark, locate_object])
def test_depth_is_exact_on_a_plane(locate) -> None:
    depth = np.full((INTRINSICS.height, INTRINSICS.width), 2.5, dtype=np.float32)
    frame = RgbdFrame(INTRINSICS, np.eye(4), 0.0, lambda: (np.zeros((*depth.shape, 3), dtype=np.uint8), depth))
    located = locate(frame, Box(100, 60, 221, 181))
    u, v = 160.5, 120.5  # the box's middle
    expected = ((u - INTRINSICS.cx) / INTRINSICS.fx * 2.5, (v - INTRINSICS.cy) / INTRINSICS.fy * 2.5, 2.5)
    np.testing.assert_allclose(located.position, expected, atol=2.5 / INTRINSICS.fx)
    assert located.depth == 2.5


@settings(max_examples=25, deadline=None)
@given(x=st.floats(-4, 4), y=st.floats(-4, 4), yaw=st.floats(-math.pi, math.pi), tilt=st.floats(-0.4, 0.1))
def test_position_does_not_depend_on_where_the_robot_stands(x: float, y: float, yaw: float, tilt: float) -> None:
    base = Pose2D(x, y, yaw)
    middle = base @ Pose2D(3.0, 0.0)
    block = ((middle.x - 0.2, middle.y - 0.2, 0.5), (middle.x + 0.2, middle.y + 0.2, 0.9))
    frame = frame_of([block], base, tilt)
    for locate in (locate_landmark, locate_object):
        located = locate(frame, box_around(block, frame))
        assert located is not None
        assert math.hypot(located.position[0] - middle.x, located.position[1] - middle.y) < 0.32
        assert 0.5 <= located.position[2] <= 0.91
        assert 0.1 < located.radius < 0.36


def test_object_is_told_from_the_wall_behind_it() -> None:
    bottle, wall = ((2.0, -0.04, 0.9), (2.08, 0.04, 1.2)), ((4.0, -3.0, 0.0), (4.1, 3.0, 2.5))
    frame = frame_of([bottle, wall])
    tight = box_around(bottle, frame)
    loose = Box(tight.x0 - 8, tight.y0 - 8, tight.x1 + 8, tight.y1 + 8)  # mostly wall
    located = locate_object(frame, loose)
    assert located is not None
    np.testing.assert_allclose(located.position[:2], (2.0, 0.0), atol=0.03)
    assert located.radius < 0.1


def test_speckle_before_the_object_is_not_the_object() -> None:
    depth = np.full((INTRINSICS.height, INTRINSICS.width), 3.0, dtype=np.float32)
    box = Box(100, 60, 200, 160)
    depth[110, 150] = 0.4  # the very middle of the box
    frame = RgbdFrame(INTRINSICS, np.eye(4), 0.0, lambda: (np.zeros((*depth.shape, 3), dtype=np.uint8), depth))
    located = locate_object(frame, box)
    assert located is not None
    assert located.depth == 3.0


def test_floor_and_wall_do_not_belong_to_the_table() -> None:
    top, wall = ((2.5, -0.6, 0.65), (3.3, 0.6, 0.7)), ((5.0, -3.0, 0.0), (5.1, 3.0, 2.5))
    frame = frame_of([top, wall], tilt=-0.2)
    to_its_feet = box_around(((2.5, -0.6, 0.0), (3.3, 0.6, 0.7)), frame)
    located = locate_landmark(frame, to_its_feet)
    assert located is not None
    assert located.position[0] == pytest.approx(2.9, abs=0.45)
    assert located.position[1] == pytest.approx(0.0, abs=0.05)
    assert located.position[2] > 0.5


@pytest.mark.parametrize("locate", [locate_landmark, locate_object])
@pytest.mark.parametrize("value", [0.0, np.nan, np.inf, -1.0])
def test_without_depth_there_is_no_position(locate, value: float) -> None:
    depth = np.full((INTRINSICS.height, INTRINSICS.width), value, dtype=np.float32)
    frame = RgbdFrame(INTRINSICS, np.eye(4), 0.0, lambda: (np.zeros((*depth.shape, 3), dtype=np.uint8), depth))
    assert locate(frame, Box(10, 10, 50, 50)) is None


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**16),
    holes=st.floats(0, 1),
    corner=st.tuples(st.floats(0, 318), st.floats(0, 238)),
    size=st.tuples(st.floats(1, 320), st.floats(1, 240)),
)
def test_any_depth_gives_finite_values(
    seed: int, holes: float, corner: tuple[float, float], size: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.1, 10.0, (INTRINSICS.height, INTRINSICS.width)).astype(np.float32)
    depth[rng.random(depth.shape) < holes] = 0.0
    frame = RgbdFrame(INTRINSICS, np.eye(4), 0.0, lambda: (np.zeros((*depth.shape, 3), dtype=np.uint8), depth))
    box = Box(corner[0], corner[1], min(corner[0] + size[0], 320.0), min(corner[1] + size[1], 240.0))
    for locate in (locate_landmark, locate_object):
        located = locate(frame, box)
        if located is not None:
            assert np.isfinite([*located.position, located.radius, located.depth]).all()
            assert located.radius >= 0
            assert 0.1 <= located.depth <= 10.0
