from __future__ import annotations

import math

import numpy as np
import pytest

from zavis_bt.mapping import Mapper, MapperSettings, SemanticMap
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    BaseLimits,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LandmarkSighting,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
)

SPEC = RobotSpec(
    "tester",
    Footprint(0.4, 0.4, disc=True),
    BaseLimits(0.5, 0.2, 1.0, 0.5, 1.0),
    LidarSpec(181, math.pi, 0.05, 8.0, 10.0, Pose2D(0.2, 0.0, 0.0), 0.3),
    PanTiltSpec(-2.0, 2.0, -1.0, 1.0, 1.0, 1.0),
    CameraSpec(CameraIntrinsics.from_fov(320, 240, 1.0), 0.0, 1.0, 0.3, 5.0, 10.0),
)


def scan_at(stamp: float, distance: float = 2.0) -> LaserScan:
    return LaserScan(np.full(181, distance), -math.pi / 2, math.pi / 180, 0.05, 8.0, stamp)


def test_a_scan_is_taken_from_the_sensors_mount() -> None:
    mapper = Mapper(SPEC)
    assert mapper.update(scan_at(0.0), Pose2D(1.0, 0.0, math.pi / 2))
    assert mapper.grid.state_at(1.0, 0.2 + 2.01) == OCCUPIED


def test_the_robots_own_place_is_free_though_no_beam_saw_it() -> None:
    mapper = Mapper(SPEC)
    mapper.update(scan_at(0.0), Pose2D(0.0, 0.0))
    assert mapper.grid.state_at(-0.15, 0.0) == FREE


def test_no_scan_is_no_news() -> None:
    mapper = Mapper(SPEC)
    assert not mapper.update(None, Pose2D(0.0, 0.0))
    assert mapper.grid.version == 0


@pytest.mark.parametrize(
    ("stamp", "pose", "fused"),
    [
        (5.0, Pose2D(9.0, 9.0, 1.0), False),  # the same scan again
        (5.1, Pose2D(0.02, 0.0, 0.02), False),
        (5.1, Pose2D(0.06, 0.0, 0.0), True),
        (5.1, Pose2D(0.0, 0.0, math.radians(-4)), True),
        (5.9, Pose2D(0.0, 0.0, 0.0), False),
        (6.0, Pose2D(0.0, 0.0, 0.0), True),
        (0.0, Pose2D(0.06, 0.0, 0.0), True),
    ],
)
def test_a_scan_is_fused_when_the_robot_moved_or_a_second_passed(stamp: float, pose: Pose2D, fused: bool) -> None:
    mapper = Mapper(SPEC)
    mapper.update(scan_at(5.0), Pose2D(0.0, 0.0, 0.0))
    assert mapper.update(scan_at(stamp), pose) is fused


def test_a_turn_over_the_half_circle_counts_as_small() -> None:
    mapper = Mapper(SPEC)
    mapper.update(scan_at(0.0), Pose2D(0.0, 0.0, math.pi - 0.01))
    assert not mapper.update(scan_at(0.1), Pose2D(0.0, 0.0, -math.pi + 0.01))


def test_settings_reach_the_grid() -> None:
    mapper = Mapper(SPEC, settings=MapperSettings(max_range=1.0))
    mapper.update(scan_at(0.0), Pose2D(0.0, 0.0))
    assert not (mapper.grid.states == OCCUPIED).any()


def test_seeding_resumes_from_saved_maps() -> None:
    first, second = Mapper(SPEC), Mapper(SPEC)
    first.update(scan_at(0.0), Pose2D(0.0, 0.0))
    first.semantic.integrate([LandmarkSighting((("desk", 1.0),), (1.0, 0.0, 0.5), 0.5, 0.9, 0.0)])
    second.seed(first.grid, SemanticMap.from_json(first.semantic.to_json()))
    np.testing.assert_array_equal(second.grid.states, first.grid.states)
    assert second.semantic.landmarks == first.semantic.landmarks
    assert second.update(scan_at(0.0), Pose2D(0.0, 0.0))


def test_a_seeded_map_is_no_more_than_its_grid() -> None:
    mapper = Mapper(SPEC)
    mapper.seed(GridMap(np.full((10, 10), FREE, np.int8), 0.05, (0.0, 0.0)))
    assert mapper.grid.shape == (10, 10)
    assert mapper.semantic.landmarks == ()
