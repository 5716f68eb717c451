import math

import numpy as np
import pytest
from planning_world import DISC, RECTANGLE, grid_of, room

from zavis_bt.planning import BackUpMove, Costmap, TurnMove, choose_recovery
from zavis_bt.planning.recovery import free_distance
from zavis_bt.types import OCCUPIED, Pose2D


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_a_robot_before_a_wall_backs_up(footprint):
    costmap = Costmap(grid_of(room(60, 60)), footprint)
    assert choose_recovery(costmap, Pose2D(2.6, 1.5, 0.0)) == BackUpMove(0.3)


def test_a_robot_with_a_wall_behind_turns_to_where_there_is_room():
    states = room(60, 60)
    states[20:40, 40] = OCCUPIED
    costmap = Costmap(grid_of(states), DISC)
    move = choose_recovery(costmap, Pose2D(1.78, 1.5, math.pi))
    assert isinstance(move, TurnMove)
    assert abs(math.remainder(move.heading - math.pi, math.tau)) < 0.3


def test_free_distance_ends_at_the_obstacle():
    costmap = Costmap(grid_of(room(60, 60)), DISC)
    for x in np.linspace(1.0, 2.5, 7):
        expected = min(59 * 0.05 + 0.025 - 0.18 - x, 1.0)
        assert free_distance(costmap, Pose2D(float(x), 1.5, 0.4), 0.0, 1.0) == pytest.approx(expected, abs=0.021)


def test_an_overlapping_robot_may_move_out_but_not_in():
    costmap = Costmap(grid_of(room(60, 60)), DISC)
    pose = Pose2D(0.15, 1.5, 0.0)
    assert free_distance(costmap, pose, 0.0, 0.4) == pytest.approx(0.4)
    assert free_distance(costmap, pose, math.pi, 0.4) == 0.0
