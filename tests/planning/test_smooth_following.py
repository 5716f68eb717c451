"""Following a path with commands that are limited in jerk."""

from __future__ import annotations

import numpy as np
import pytest
from planning_world import DISC, RECTANGLE, Base, cluttered, drive, grid_of, random_places, robot

from zavis_bt.planning import Costmap, FollowStatus, Navigator

JERK_RATIO = 10.0  # of the shaper


def cross(footprint, seed, smooth):
    states, spec = cluttered(seed, pieces=8), robot(footprint)
    grid = grid_of(states)
    costmap = Costmap(grid, footprint)
    roomy = [p for p in random_places(costmap, 200, seed) if costmap.clearance(np.array([[p.x, p.y]]))[0] > 0.4]
    navigator = Navigator(spec, lambda: grid, smooth=smooth)
    base = Base(spec, costmap, roomy[0])
    follower = navigator.follow(navigator.plan(roomy[0], roomy[1]), roomy[1], yaw_tolerance=0.1)
    return spec, base, drive(base, follower), roomy[1]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_smooth_commands_arrive_without_contact_and_keep_to_the_jerk_limit(footprint, seed):
    spec, base, said, goal = cross(footprint, seed, smooth=True)
    assert said[-1].status is FollowStatus.ARRIVED
    assert base.contacts == 0
    assert base.state.pose.distance(goal) <= 0.12
    speeds = np.array([progress.twist.linear for progress in said[:-1]])  # the last is the end
    jerks = np.abs(np.diff(speeds, 2)) / 0.1**2
    assert jerks.max() <= JERK_RATIO * spec.limits.linear_acceleration * 1.01


def test_smooth_driving_takes_hardly_longer():
    ends = [cross(RECTANGLE, 1, smooth)[1].state.stamp for smooth in (False, True)]
    assert ends[1] <= 1.3 * ends[0]
