"""Writing robot files: a model, and the devices that play it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError
from zavis_bt.types import Footprint, RobotSpec

_DIGITS = 9  # of angles in degrees: finer than any encoder


def write_robot_file(path: Path, spec: RobotSpec, devices: Mapping[str, Mapping[str, Any]]) -> None:
    """Write a robot file.

    Args:
        path: Where; what is there is replaced.
        spec: The robot's model.
        devices: By kind: ``driver`` and ``settings``.

    Raises:
        InputError: The file cannot be written.
    """
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.default_flow_style = False
    try:
        with path.open("w", encoding="utf-8") as file:
            yaml.dump({**_model(spec), "devices": {kind: dict(device) for kind, device in devices.items()}}, file)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error


def _model(spec: RobotSpec) -> dict[str, Any]:
    limits, unit, camera = spec.limits, spec.pan_tilt, spec.camera
    return {
        "format": "zavis-robot/1",
        "name": spec.name,
        "footprint": _footprint(spec.footprint),
        "limits": {
            "max_linear": limits.max_linear,
            "max_reverse": limits.max_reverse,
            "max_angular_deg": _degrees(limits.max_angular),
            "linear_acceleration": limits.linear_acceleration,
            "angular_acceleration_deg": _degrees(limits.angular_acceleration),
        },
        "lidar": _lidar(spec),
        "pan_tilt": {
            "pan_min_deg": _degrees(unit.pan_min),
            "pan_max_deg": _degrees(unit.pan_max),
            "tilt_min_deg": _degrees(unit.tilt_min),
            "tilt_max_deg": _degrees(unit.tilt_max),
            "max_rate_deg": _degrees(unit.max_rate),
            "max_acceleration_deg": _degrees(unit.max_acceleration),
        },
        "camera": {
            "image": [camera.intrinsics.width, camera.intrinsics.height],
            "horizontal_fov_deg": _degrees(camera.intrinsics.horizontal_fov),
            "x": camera.x,
            "height": camera.height,
            "depth_min": camera.depth_min,
            "depth_max": camera.depth_max,
            "rate": camera.rate,
        },
    }


def _footprint(footprint: Footprint) -> dict[str, float]:
    if footprint.disc:
        return {"radius": footprint.length / 2}
    return {"length": footprint.length, "width": footprint.width, "centre_x": footprint.centre_x}


def _lidar(spec: RobotSpec) -> dict[str, float]:
    lidar = spec.lidar
    return {
        "beams": lidar.beams,
        "field_of_view_deg": _degrees(lidar.field_of_view),
        "range_min": lidar.range_min,
        "range_max": lidar.range_max,
        "rate": lidar.rate,
        "x": lidar.mount.x,
        "y": lidar.mount.y,
        "yaw_deg": _degrees(lidar.mount.yaw),
        "height": lidar.height,
    }


def _degrees(angle: float) -> float:
    return round(math.degrees(angle), _DIGITS)
