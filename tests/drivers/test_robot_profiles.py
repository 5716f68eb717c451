from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivers.camera.realsense_source import RealSenseSettings
from drivers.camera.recorded_source import RecordedSettings
from drivers.camera.sim_source import SimCameraSettings
from drivers.camera.stereo_source import StereoSettings
from drivers.lidar.settings import ScipSettings
from drivers.pan_tilt.settings import HomingSettings, PanTiltSettings
from drivers.pioneer.settings import PioneerSettings
from drivers.profiles import builtin_robot, builtin_robots
from drivers.settings import read_settings
from zavis_bt.errors import InputError
from zavis_bt.mission.device_robot import KINDS, find_driver
from zavis_bt.mission.robot_file import load_robot

SETTINGS = {
    "pioneer": PioneerSettings,
    "cia402": PanTiltSettings,
    "scip": ScipSettings,
    "sim": SimCameraSettings,
    "realsense": RealSenseSettings,
}
WITH_DEVICES = [name for name in builtin_robots() if load_robot(builtin_robot(name)).devices]


@pytest.mark.parametrize("name", builtin_robots())
def test_a_profile_is_a_robot_that_fits_through_doors(name):
    spec = load_robot(builtin_robot(name)).spec
    assert 0.1 < spec.footprint.inscribed_radius < 0.4
    assert spec.limits.max_linear <= 0.8


@pytest.mark.parametrize("name", WITH_DEVICES)
def test_every_device_of_a_profile_has_a_driver_that_takes_its_settings(name):
    file = load_robot(builtin_robot(name))
    assert set(file.devices) == set(KINDS)
    for kind in KINDS:
        assert callable(find_driver(file, kind))
        device = file.devices[kind]
        read_settings(SETTINGS[device.driver], device.settings, f"{name}: devices.{kind}")


def test_there_are_profiles_for_simulated_and_for_real_devices():
    assert {"pioneer3at_sim", "pioneer3at_hardware", "pioneer3dx_hardware"} <= set(WITH_DEVICES)
    assert {"pioneer3at", "locobot"} <= set(builtin_robots()) - set(WITH_DEVICES)


def test_the_served_robot_is_the_simulated_one_with_a_quicker_lidar():
    served, simulated = (load_robot(builtin_robot(name)).spec for name in ("pioneer3at_sim", "pioneer3at"))
    assert served.lidar.rate > simulated.lidar.rate
    as_simulated = replace(served, name=simulated.name, lidar=replace(served.lidar, rate=simulated.lidar.rate))
    assert as_simulated == simulated


@pytest.mark.parametrize("name", WITH_DEVICES)
def test_serial_lines_and_buses_are_explained_where_they_are_set(name):
    text = Path(builtin_robot(name)).read_text(encoding="utf-8")
    assert "#" in text.split("devices:")[1]


def test_an_unknown_profile_is_told_with_the_nearest_one():
    with pytest.raises(InputError, match="did you mean 'pioneer3at_sim'"):
        builtin_robot("pioneer3at_simm")


@pytest.mark.parametrize("settings", [*SETTINGS.values(), HomingSettings, StereoSettings, RecordedSettings])
def test_every_setting_is_explained_in_the_manual(settings):
    manual = (Path(__file__).parents[2] / "docs" / "robot.md").read_text(encoding="utf-8")
    for name in settings.model_fields:
        assert f"`{name}`" in manual
