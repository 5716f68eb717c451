from __future__ import annotations

import math
import re

import numpy as np
import pytest

from drivers.lidar.codec import Parameters
from drivers.lidar.layout import disagreements, lay_out
from drivers.lidar.settings import ScipSettings
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import LidarSpec, Pose2D

UST = Parameters("UST-10LX", 20, 30000, 1440, 0, 1080, 540, 2400)
URG = Parameters("URG-04LX", 20, 5600, 1024, 44, 725, 384, 600)


def spec(beams: int, degrees: float, *, range_max: float = 10.0, rate: float = 40.0) -> LidarSpec:
    return LidarSpec(beams, math.radians(degrees), 0.05, range_max, rate, Pose2D(0.0, 0.0), 0.3)


def settings(**given) -> ScipSettings:
    return ScipSettings(port="tcp://x:1", **given)


def laid_out(sensor: Parameters, of: LidarSpec, **given):
    return lay_out(sensor, of, settings(**given), "here")


def test_the_whole_sweep_of_a_ust_is_asked_for():
    layout = laid_out(UST, spec(1081, 270))
    assert layout.request.line == b"MD0000108001000"
    assert layout.angle_min == pytest.approx(math.radians(-135))
    assert layout.angle_increment == pytest.approx(math.radians(0.25))
    assert disagreements(UST, layout, spec(1081, 270)) == ()


def test_only_the_steps_within_the_field_of_view_are_asked_for():
    layout = laid_out(UST, spec(721, 180))
    assert (layout.request.start, layout.request.end, layout.request.beams) == (180, 900, 721)
    assert layout.angle_min == pytest.approx(-math.pi / 2)


def test_a_full_circle_is_not_measured_twice_at_its_seam():
    around = Parameters("X", 20, 30000, 360, 0, 360, 180, 600)
    assert laid_out(around, spec(360, 360)).request.beams == 360


def test_beams_look_along_the_middle_of_their_clusters():
    layout = laid_out(UST, spec(270, 270), cluster=4)
    assert (layout.request.start, layout.request.end, layout.request.beams) == (0, 1079, 270)
    assert layout.angle_min == pytest.approx(math.radians((1.5 - 540) / 4))
    assert layout.angle_increment == pytest.approx(math.radians(1))


@pytest.mark.parametrize("cluster", [1, 3])
def test_a_sensor_upside_down_sees_the_same_from_left_to_right(cluster):
    upright = laid_out(URG, spec(683, 240), cluster=cluster)
    hanging = laid_out(URG, spec(683, 240), cluster=cluster, flipped=True)
    readings = np.arange(1000, 1000 + upright.request.beams, dtype=np.int32)
    one, other = upright.scan(readings, 0.0), hanging.scan(readings, 0.0)
    assert np.array_equal(one.ranges, other.ranges[::-1])
    assert one.angles == pytest.approx(-other.angles[::-1])


def test_readings_out_of_range_are_infinite_and_codes_are_broken_beams():
    layout = laid_out(UST, spec(1081, 270))
    readings = np.full(1081, 1234, dtype=np.int32)
    readings[:7] = 0, 4, 49, 50, 10_000, 10_001, 65_533
    scan = layout.scan(readings, 3.5)
    assert scan.ranges[:8] == pytest.approx([math.nan] * 3 + [0.05, 10.0, math.inf, math.inf, 1.234], nan_ok=True)
    assert (scan.ranges.dtype, scan.ranges.flags.writeable, scan.stamp) == (np.float64, False, 3.5)
    assert (scan.range_min, scan.range_max) == (0.05, 10.0)


def test_the_range_ends_where_the_sensor_does():
    layout = laid_out(URG, spec(683, 240))
    assert layout.range_max == 5.6
    readings = np.full(layout.request.beams, 5601, dtype=np.int32)
    assert np.isinf(layout.scan(readings, 0.0).ranges).all()


@pytest.mark.parametrize(
    ("sensor", "given", "said"),
    [
        (UST, spec(181, 180), r"721 beams 0\.25° apart.*181 1° apart.*cluster"),
        (URG, spec(1081, 270, range_max=5.6, rate=10), r"sees 239\.\d° of the 270°"),
        (URG, spec(681, 239.0625, rate=10), r"up to 5\.6 m only"),
        (UST, spec(1081, 270, rate=10), r"40 scans a second.*there are 10.*skip"),
    ],
)
def test_a_sensor_other_than_in_the_robot_file_is_reported(sensor, given, said):
    (line,) = disagreements(sensor, laid_out(sensor, given), given)
    assert re.search(said, line), line


def test_a_sensor_that_looks_elsewhere_is_refused():
    with pytest.raises(DeviceError, match=r"^here: BACK measures nothing within 90° straight ahead"):
        laid_out(Parameters("BACK", 20, 30000, 1440, 800, 1080, 540, 2400), spec(361, 90))


def test_a_cluster_wider_than_the_field_of_view_is_refused():
    with pytest.raises(InputError, match=r"^here\.settings\.cluster: 99 is more than the 41 steps"):
        laid_out(UST, spec(41, 10), cluster=99)
