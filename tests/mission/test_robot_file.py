from __future__ import annotations

import math
from pathlib import Path

import pytest

from drivers import builtin_robot, builtin_robots
from zavis_bt.errors import InputError
from zavis_bt.mission import SafetySettings
from zavis_bt.mission.robot_file import DeviceSetting, load_robot


@pytest.fixture
def write(tmp_path: Path):
    def write(old: str = "", new: str = "", *, more: str = "") -> Path:
        text = builtin_robot("locobot").read_text(encoding="utf-8")
        assert old in text
        path = tmp_path / "my.robot.yaml"
        path.write_text(text.replace(old, new, 1) + more, encoding="utf-8")
        return path

    return write


def test_every_built_in_profile_loads() -> None:
    assert {"locobot", "pioneer3at"} <= set(builtin_robots())
    for name in builtin_robots():
        assert load_robot(builtin_robot(name)).spec.name in (name, name.split("_")[0])


def test_the_simulators_profiles_leave_their_devices_to_it() -> None:
    for name in ("locobot", "pioneer3at"):
        assert load_robot(builtin_robot(name)).devices == {}


def test_without_a_safety_section_the_limits_are_the_usual_ones() -> None:
    assert load_robot(builtin_robot("locobot")).safety == SafetySettings()


def test_the_safety_section_sets_what_it_names(write) -> None:
    path = write(more="safety: {margin: 0.1, turn_deceleration_deg: 180, scan_timeout: 0.4, device_timeout: 30}\n")
    assert load_robot(path).safety == SafetySettings(
        margin=0.1, turn_deceleration=math.pi, scan_timeout=0.4, device_timeout=30.0
    )


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("{margine: 0.1}", r"unknown key 'safety.margine' \(did you mean 'margin'\?\)"),
        ("{creep: 0}", "safety.creep: should be greater than 0, not 0"),
        ("{min_battery: 1.5}", "safety.min_battery: should be less than 1, not 1.5"),
        ("{scan_timeout: .nan}", "safety.scan_timeout: should be"),
        ("{tick_limit: 0.01}", "safety.tick_limit: should be greater than or equal to 0.05"),
        ("fast", "safety: should be"),
    ],
)
def test_a_fault_in_the_safety_section_is_named(write, section, message) -> None:
    with pytest.raises(InputError, match=message):
        load_robot(write(more=f"safety: {section}\n"))


def test_degrees_become_radians() -> None:
    spec = load_robot(builtin_robot("pioneer3at")).spec
    assert spec.lidar.field_of_view == pytest.approx(math.pi)
    assert spec.lidar.angle_increment == pytest.approx(math.radians(1))
    assert spec.limits.max_angular == pytest.approx(math.radians(140))
    assert spec.pan_tilt.tilt_min == pytest.approx(math.radians(-46))
    assert spec.camera.intrinsics.horizontal_fov == pytest.approx(math.radians(60))
    assert (spec.footprint.length, spec.footprint.width, spec.footprint.disc) == (0.508, 0.497, False)
    assert spec.lidar.mount.x == 0.16


def test_a_radius_makes_a_disc() -> None:
    footprint = load_robot(builtin_robot("locobot")).spec.footprint
    assert footprint.disc
    assert footprint.inscribed_radius == footprint.circumscribed_radius == 0.18


def test_devices_name_their_driver_and_its_settings(write) -> None:
    path = write(more="devices:\n  base: {driver: pioneer, settings: {port: /dev/ttyUSB0}}\n  lidar: {driver: scip}\n")
    assert load_robot(path).devices == {
        "base": DeviceSetting("pioneer", {"port": "/dev/ttyUSB0"}),
        "lidar": DeviceSetting("scip"),
    }


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("zavis-robot/1", "zavis-robot/9", ":2: format: should be 'zavis-robot/1'"),
        ("max_linear", "max_liner", r"unknown key 'limits.max_liner' \(did you mean 'max_linear'\?\)"),
        ("max_angular_deg", "max_angular", r"unknown key 'limits.max_angular' \(did you mean 'max_angular_deg'\?\)"),
        ("{radius: 0.18}", "{radius: -1}", r":4: footprint.radius: should be greater than 0, not -1"),
        ("{radius: 0.18}", "{radius: 0.18, width: 0.3}", "footprint: give either 'radius', or 'length' and 'width'"),
        ("{radius: 0.18}", "{length: 0.18}", "give either"),
        ("{radius: 0.18}", "{length: 0.4, width: 0.3, centre_x: 0.3}", "outside of the rectangle"),
        ("range_min: 0.05", "range_min: 20", "lidar: range_min must be below range_max"),
        ("pan_min_deg: -180", "pan_min_deg: 190", "pan_tilt: pan_min_deg must be below pan_max_deg"),
        ("field_of_view_deg: 360", "field_of_view_deg: 720", "less than or equal to 360, not 720"),
        ("image: [640, 480]", "image: [640]", r"camera.image\[1\]"),
        ("camera:", "devices: {arm: {driver: x}}\ncamera:", "devices.arm"),
    ],
)
def test_a_fault_is_one_line_that_says_what_would_be_right(write, old: str, new: str, message: str) -> None:
    path = write(old, new)
    with pytest.raises(InputError, match=message) as caught:
        load_robot(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"{path}:")


def test_an_unknown_profile_suggests_the_closest() -> None:
    with pytest.raises(InputError, match="did you mean 'locobot'"):
        builtin_robot("lokobot")
