"""What every LiDAR must do."""

from __future__ import annotations

import numpy as np
import pytest
from conformance_rigs import Rig, duration
from conformance_room import BY_THE_WALL, distances

from zavis_bt.types import LaserScan, Pose2D, Twist2D

START = BY_THE_WALL


def latest(rig: Rig) -> LaserScan:
    """Return a scan whose sweep began after now."""
    begin = rig.clock.now()
    assert rig.wait_for(lambda: (scan := rig.robot.lidar.scan()) is not None and scan.stamp > begin + 0.1)
    scan = rig.robot.lidar.scan()
    assert scan is not None
    return scan


def expected(rig: Rig, scan: LaserScan, base: Pose2D) -> np.ndarray:
    """Return what it must measure from there by the rules: inf beyond the range, NaN before it."""
    spec = rig.robot.spec.lidar
    ranges = distances(base @ spec.mount, scan.angles)
    ranges[ranges > spec.range_max] = np.inf
    ranges[ranges < spec.range_min] = np.nan
    return ranges


def differences(scan: LaserScan, ranges: np.ndarray) -> np.ndarray:
    """Return how far measured and expected ranges lie apart, where both are numbers."""
    both = np.isfinite(ranges) & np.isfinite(scan.ranges)
    assert both.sum() > 50
    difference: np.ndarray = np.abs(scan.ranges[both] - ranges[both])
    return difference


def test_the_geometry_is_the_robots(rig: Rig) -> None:
    spec, scan = rig.robot.spec.lidar, latest(rig)
    assert scan.ranges.shape == (spec.beams,)
    assert scan.ranges.dtype == np.float64
    assert (scan.range_min, scan.range_max) == pytest.approx((spec.range_min, spec.range_max), abs=0.001)
    assert scan.angle_min == pytest.approx(spec.angle_min, abs=1e-9)
    assert scan.angle_increment == pytest.approx(spec.angle_increment, abs=1e-12)


def test_ranges_are_the_distances_in_the_room(rig: Rig) -> None:
    truth, scan = rig.truth(), latest(rig)
    ranges = expected(rig, scan, truth)
    # A beam along an edge may fall on either side of it.
    assert np.quantile(differences(scan, ranges), 0.97) < 0.002
    assert (np.isfinite(scan.ranges) == np.isfinite(ranges)).mean() > 0.98


def test_no_return_is_infinite_and_too_near_is_not_a_number(rig: Rig) -> None:
    spec, scan = rig.robot.spec.lidar, latest(rig)
    finite = scan.ranges[np.isfinite(scan.ranges)]
    assert len(finite) > 0.05 * len(scan.ranges)
    assert finite.min() >= spec.range_min - 0.001
    assert finite.max() <= spec.range_max + 0.001
    assert not np.isneginf(scan.ranges).any()
    ranges = expected(rig, scan, rig.truth())
    assert np.isinf(ranges).sum() > 20
    assert np.isnan(ranges).sum() > 20
    assert (np.isinf(scan.ranges) == np.isinf(ranges)).mean() > 0.98
    assert (np.isnan(scan.ranges) == np.isnan(ranges)).mean() > 0.98


def test_scans_cannot_be_written_to(rig: Rig) -> None:
    scan = latest(rig)
    with pytest.raises(ValueError, match="read-only"):
        scan.ranges[0] = 1.0


def test_the_scan_is_the_same_object_until_the_next(rig: Rig) -> None:
    seen: list[LaserScan] = []
    for _ in range(30):
        scan = rig.robot.lidar.scan()
        assert scan is not None
        if not seen or scan is not seen[-1]:
            seen.append(scan)
        rig.run(0.02)
    stamps = [scan.stamp for scan in seen]
    assert len(set(stamps)) == len(stamps) > 2
    assert stamps == sorted(stamps)


def test_a_scan_keeps_its_values_and_shares_no_memory_with_the_next(rig: Rig) -> None:
    rig.robot.base.command(Twist2D(0.0, rig.spin))
    scan = latest(rig)
    values = scan.ranges.tolist()
    other = latest(rig)
    assert not np.shares_memory(scan.ranges, other.ranges)
    np.testing.assert_array_equal(scan.ranges, values)


def test_scans_come_at_their_rate_and_fresh(rig: Rig) -> None:
    rate, stamps = rig.robot.spec.lidar.rate, set()
    begin = latest(rig).stamp
    for _ in range(25):
        rig.run(0.02)
        scan = rig.robot.lidar.scan()
        assert scan is not None
        assert rig.clock.now() - 1 / rate - rig.stale <= scan.stamp <= rig.clock.now()
        stamps.add(scan.stamp)
    # A device that keeps its rate between two scans may still deliver them unevenly on a busy machine.
    assert 0.5 < len(stamps) / ((max(stamps) - begin) * rate + 1) < 1.3


def test_a_scan_taken_while_turning_belongs_to_the_pose_at_its_stamp(rig: Rig) -> None:
    begin, odometry = rig.truth(), rig.robot.base.state().pose
    errors = []
    for _ in range(14):
        rig.drive(Twist2D(0.0, rig.spin), 0.1)
        scan = rig.robot.lidar.scan()
        assert scan is not None
        pose = begin @ (odometry.inverse() @ rig.robot.base.pose_at(scan.stamp))
        errors.append(float(np.median(differences(scan, expected(rig, scan, pose)))))
    assert np.median(errors) < rig.turning_error


def test_nothing_blocks(rig: Rig) -> None:
    assert duration(rig.robot.lidar.scan) < 0.002
