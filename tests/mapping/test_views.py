from __future__ import annotations

import math

import numpy as np
import pytest

from zavis_bt.geometry import transform_camera_to_map
from zavis_bt.mapping.views import Views
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    CameraIntrinsics,
    CameraSpec,
    GridMap,
    Landmark,
    Pose2D,
    RgbdFrame,
)

CAMERA = CameraSpec(CameraIntrinsics.from_fov(640, 480, math.radians(60)), 0.0, 0.9, 0.1, 8.0, 15.0)
REACH = 3.0  # from where things on a landmark are found [m]


def frame(x: float = 0.0, y: float = 0.0, yaw_deg: float = 0.0, tilt_deg: float = 0.0) -> RgbdFrame:
    transform = transform_camera_to_map(Pose2D(x, y, math.radians(yaw_deg)), 0.0, math.radians(tilt_deg), CAMERA)
    return RgbdFrame(CAMERA.intrinsics, transform, 0.0, lambda: pytest.fail("the pixels are not needed"))


def views(*frames: RgbdFrame) -> Views:
    seen = Views()
    for each in frames:
        seen.add(each)
    return seen


def landmark(x: float, y: float = 0.0, z: float = 0.7, radius: float = 0.3, id: int = 0) -> Landmark:
    return Landmark(id, (("table", 1.0),), (x, y, z), radius, 1)


def grid(*walls: tuple[float, float, float, float], state: int = FREE) -> GridMap:
    """12 m × 12 m around the origin with these boxes (x0, y0, x1, y1) in it."""
    states = np.full((240, 240), state, dtype=np.int8)
    for x0, y0, x1, y1 in walls:
        (row0, col0), (row1, col1) = GridMap(states, 0.05, (-6.0, -6.0)).to_cells(np.array([[x0, y0], [x1, y1]]))
        states[row0 : row1 + 1, col0 : col1 + 1] = OCCUPIED
    return GridMap(states, 0.05, (-6.0, -6.0))


OPEN = grid()


def is_searched(seen: Views, thing: Landmark, place: GridMap = OPEN) -> bool:
    return thing.id in seen.searched([thing], place, REACH)


def test_nothing_is_searched_before_the_first_view():
    assert views().searched([landmark(2.0)], OPEN, REACH) == frozenset()
    assert views().chances([landmark(2.0)], OPEN).tolist() == [0]


def test_a_landmark_in_view_from_near_is_searched():
    assert is_searched(views(frame()), landmark(2.0))


def test_searched_names_the_ids_of_those_in_view_only():
    things = [landmark(2.0, id=7), landmark(-2.0, id=8), landmark(2.0, 0.4, id=9)]
    assert views(frame()).searched(things, OPEN, REACH) == {7, 9}


def test_what_is_too_far_is_not_searched_until_the_robot_comes_nearer():
    seen = views(frame())
    assert not is_searched(seen, landmark(4.0))
    seen.add(frame(x=1.5))
    assert is_searched(seen, landmark(4.0))


@pytest.mark.parametrize("distance", [2.9, 3.05])
def test_the_distance_ends_at_the_middle_of_the_landmark(distance):
    assert is_searched(views(frame()), landmark(distance)) == (distance < REACH)


@pytest.mark.parametrize("yaw_deg", [45, 90, 180, -45])
def test_what_is_beside_the_image_is_not_searched(yaw_deg):
    assert not is_searched(views(frame(yaw_deg=yaw_deg)), landmark(2.0))


@pytest.mark.parametrize(("tilt_deg", "seen"), [(0, True), (-20, True), (40, False), (-60, False)])
def test_what_is_above_or_below_the_image_is_not_searched(tilt_deg, seen):
    assert is_searched(views(frame(tilt_deg=tilt_deg)), landmark(2.0)) == seen


def test_what_is_behind_a_wall_of_the_map_is_not_searched():
    seen = views(frame())
    assert not is_searched(seen, landmark(2.0), grid((1.0, -2.0, 1.1, 2.0)))
    assert is_searched(seen, landmark(2.0), grid((1.0, 0.5, 1.1, 2.0)))  # the wall ends beside it
    assert is_searched(seen, landmark(2.0), grid((2.8, -2.0, 2.9, 2.0)))  # the wall is behind it


def test_the_landmarks_own_cells_do_not_hide_it():
    assert is_searched(views(frame()), landmark(2.0), grid((1.7, -0.3, 2.3, 0.3)))


def test_what_is_not_known_yet_hides_nothing():
    assert is_searched(views(frame()), landmark(2.0), grid(state=UNKNOWN))


def test_a_wide_landmark_is_searched_only_when_both_its_sides_were_seen():
    table = landmark(1.5, radius=1.0)
    right, left = frame(yaw_deg=-25), frame(yaw_deg=25)
    assert not is_searched(views(right), table)
    assert not is_searched(views(left), table)
    assert not is_searched(views(right, right), table)
    assert is_searched(views(right, left), table)


def test_a_wall_may_hide_one_side():
    table, corner = landmark(2.0, radius=1.0), grid((0.6, 0.2, 0.7, 2.0))
    assert not is_searched(views(frame(y=0.0)), table, corner)
    assert is_searched(views(frame(y=0.0), frame(y=0.9, x=0.8)), table, corner)


def test_forgetting_the_search_begins_anew_but_keeps_the_chances():
    seen = views(frame())
    seen.forget_search()
    assert not is_searched(seen, landmark(2.0))
    assert seen.chances([landmark(2.0)], OPEN).tolist() == [1]
    seen.add(frame())
    assert is_searched(seen, landmark(2.0))
    assert seen.chances([landmark(2.0)], OPEN).tolist() == [2]


@pytest.mark.parametrize(("distance", "count"), [(0.8, 0), (1.2, 1), (3.9, 1), (4.1, 0)])
def test_a_view_is_a_chance_between_one_and_four_metres(distance, count):
    assert views(frame()).chances([landmark(distance)], OPEN).tolist() == [count]


def test_chances_count_the_views_that_should_have_shown_it():
    seen = views(frame(), frame(), frame(yaw_deg=90), frame(yaw_deg=180), frame(x=-3.0), frame(tilt_deg=60))
    assert seen.chances([landmark(2.0), landmark(0.0, 2.0), landmark(0.0, -2.0)], OPEN).tolist() == [2, 1, 0]


def test_a_view_against_a_wall_is_no_chance():
    wall = grid((1.0, -2.0, 1.1, 2.0))
    assert views(frame(), frame(x=0.5)).chances([landmark(2.0)], wall).tolist() == [0]
    assert views(frame(x=-1.0, y=3.0, yaw_deg=-45), frame()).chances([landmark(2.0)], OPEN).tolist() == [1]


def test_without_landmarks_there_is_nothing_to_say():
    assert views(frame()).searched([], OPEN, REACH) == frozenset()
    assert views(frame()).chances([], OPEN).shape == (0,)
