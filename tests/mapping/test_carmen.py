from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from sim.raycast import RayCaster
from zavis_bt.errors import InputError
from zavis_bt.mapping import CarmenScan, OccupancyGrid, find_frontiers, read_carmen
from zavis_bt.types import FREE, OCCUPIED, GridMap, Pose2D

LINE = "FLASER 4 1.0 2.5 81.83 0.5 1 2 0.5 3 4 -0.5 12.25 host 12.5\n"


@pytest.fixture(scope="module")
def log(shared: Path) -> list[CarmenScan]:
    return list(read_carmen(shared / "data" / "carmen" / "intel-corrected.log.gz"))


@pytest.fixture(scope="module")
def building(log: list[CarmenScan]) -> GridMap:
    grid = OccupancyGrid(0.05, no_return_is_free=False)  # this scanner loses beams on glass
    for entry in log:
        grid.integrate(entry.scan, entry.pose)
    return grid.map


def test_a_line_becomes_a_scan_with_both_poses(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("# comment\nODOM 1 2 3 0 0 0 1 host 1\n" + LINE)
    (entry,) = read_carmen(tmp_path / "a.log")
    assert entry.scan.ranges.tolist() == [1.0, 2.5, math.inf, 0.5]
    assert (entry.scan.angle_min, entry.scan.angle_increment) == (-math.pi / 2, math.pi / 4)
    assert (entry.pose, entry.odometry) == (Pose2D(1, 2, 0.5), Pose2D(3, 4, -0.5))
    assert entry.scan.stamp == 12.25


def test_an_odd_number_of_beams_spans_the_half_circle(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("FLASER 3 1 2 3 0 0 0 0 0 0 1 host 1\n")
    (entry,) = read_carmen(tmp_path / "a.log")
    assert entry.scan.angles == pytest.approx([-math.pi / 2, 0.0, math.pi / 2])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (LINE + "FLASER\n", r"a\.log:2: not a FLASER line"),
        ("FLASER 4 1.0 2.5\n", r"a\.log:1: a FLASER line with 2 numbers for 4 beams \(11 expected\)"),
        ("FLASER 1 x 1 2 3 1 2 3 4 host 1\n", r"a\.log:1: not a FLASER line"),
        ("FLASER 0 1 2 3 1 2 3 4 host 1\n", r"for 0 beams"),
    ],
)
def test_a_wrong_line_is_named(tmp_path: Path, content: str, message: str) -> None:
    (tmp_path / "a.log").write_text(content)
    with pytest.raises(InputError, match=message):
        list(read_carmen(tmp_path / "a.log"))


def test_a_missing_log_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.log: no such file"):
        list(read_carmen(tmp_path / "none.log"))


def test_a_truncated_archive_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.log.gz").write_bytes(gzip.compress(LINE.encode() * 100)[:40])
    with pytest.raises(InputError, match=r"a\.log\.gz: cannot be read"):
        list(read_carmen(tmp_path / "a.log.gz"))


def test_a_real_log_has_all_its_scans(log: list[CarmenScan]) -> None:
    assert len(log) == 910
    assert all(len(entry.scan.ranges) == 180 for entry in log)


def test_a_real_building_is_mapped(building: GridMap) -> None:
    assert (building.states == FREE).sum() * building.resolution**2 == pytest.approx(500, rel=0.2)
    assert len(find_frontiers(building)) > 10


def test_the_map_explains_the_scans_it_was_made_of(log: list[CarmenScan], building: GridMap) -> None:
    caster = RayCaster(building.states == OCCUPIED, building.resolution, building.origin)
    errors = []
    for entry in log[::5]:
        back = np.isfinite(entry.scan.ranges)
        angles = entry.pose.yaw + entry.scan.angles[back]
        errors.append(np.abs(caster.cast(entry.pose.x, entry.pose.y, angles, 90.0) - entry.scan.ranges[back]))
    median, most = np.percentile(np.concatenate(errors), [50, 80])
    assert median <= 0.05
    assert most <= 0.10
