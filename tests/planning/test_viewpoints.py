import math

import numpy as np
import pytest
from planning_world import DISC, RECTANGLE, grid_of, room

from zavis_bt.planning import Costmap, GeodesicField, generate_viewpoints
from zavis_bt.types import OCCUPIED, UNKNOWN, Footprint, Landmark, Pose2D


def scene(states: np.ndarray, footprint: Footprint = DISC) -> tuple[Costmap, GeodesicField]:
    costmap = Costmap(grid_of(states), footprint)
    return costmap, GeodesicField(costmap, Pose2D(1.0, 1.0))


def landmark(x: float, y: float, radius: float = 0.3) -> Landmark:
    return Landmark(7, (("desk", 1.0),), (x, y, 0.6), radius, 1)


def island() -> np.ndarray:
    states = room(120, 120)
    states[57:63, 57:63] = OCCUPIED
    return states


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_a_free_standing_landmark_is_seen_from_all_bearings(footprint):
    costmap, field = scene(island(), footprint)
    target = landmark(3.0, 3.0, 0.25)
    found = generate_viewpoints(target, costmap, field)
    assert len(found) == 8
    bearings = [math.atan2(v.pose.y - 3.0, v.pose.x - 3.0) % math.tau for v in found]
    np.testing.assert_allclose(np.unwrap(bearings), np.arange(8) * math.tau / 8, atol=0.25)
    for viewpoint in found:
        assert viewpoint.pose.bearing(3.0, 3.0) == pytest.approx(0.0, abs=1e-9)
        assert costmap.pose_fits(viewpoint.pose)
        assert math.isfinite(field.distances(np.array([[viewpoint.pose.x, viewpoint.pose.y]]))[0])
        assert 0.5 <= viewpoint.pose.distance(Pose2D(3.0, 3.0)) <= 0.25 + 1.6 + 1e-9
        assert viewpoint.look_at == target.position
        assert (viewpoint.landmark, viewpoint.label, viewpoint.radius) == (7, "desk", 0.25)


def test_stands_keep_their_distance_from_the_surface():
    states = room(120, 120)
    states[50:70, 40:80] = OCCUPIED  # 2 m wide, 1 m deep; its front face is seen
    costmap, field = scene(states)
    found = generate_viewpoints(landmark(3.0, 2.5, 1.0), costmap, field, min_distance=0.5, max_distance=1.2)
    points = np.array([(v.pose.x, v.pose.y) for v in found])
    assert len(found) >= 4
    assert (costmap.clearance(points) > 0.3).all()
    front = [v for v in found if abs(v.pose.x - 3.0) < 0.1 and v.pose.y < 2.5]
    assert front
    assert all(0.5 <= 2.5 - v.pose.y <= 1.25 for v in front)


def test_walls_hide_and_the_landmarks_own_cells_do_not():
    states = island()
    states[1:119, 70] = OCCUPIED  # a wall 0.4 m to the right of it
    states[90:110, 70] = 0
    costmap, field = scene(states)
    found = generate_viewpoints(landmark(3.0, 3.0, 0.25), costmap, field)
    assert 3 <= len(found) < 8
    assert all(v.pose.x < 3.5 for v in found)


def test_places_out_of_reach_or_unknown_are_not_used():
    states = island()
    states[60:, :] = np.where(states[60:, :] == 0, UNKNOWN, states[60:, :])
    costmap, field = scene(states)
    found = generate_viewpoints(landmark(3.0, 3.0, 0.25), costmap, field)
    assert found
    assert all(v.pose.y < 3.0 for v in found)


def test_a_walled_in_landmark_has_none():
    states = island()
    states[50, 50:71] = states[70, 50:71] = OCCUPIED
    states[50:71, 50] = states[50:71, 70] = OCCUPIED
    costmap, field = scene(states)
    assert generate_viewpoints(landmark(3.0, 3.0, 0.1), costmap, field) == []


def test_the_same_question_gets_the_same_answer():
    costmap, field = scene(island())
    target = landmark(3.0, 3.0)
    assert generate_viewpoints(target, costmap, field) == generate_viewpoints(target, costmap, field)


def test_the_number_of_bearings_is_a_setting():
    costmap, field = scene(island())
    assert len(generate_viewpoints(landmark(3.0, 3.0, 0.25), costmap, field, bearings=4)) == 4
