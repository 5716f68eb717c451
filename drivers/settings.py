"""Settings of a device as the robot file gives them, checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from zavis_bt.errors import InputError, did_you_mean


class Settings(BaseModel):
    """Base of a driver's settings: what is not declared is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


SettingsT = TypeVar("SettingsT", bound=Settings)


def read_settings(model: type[SettingsT], given: Mapping[str, Any], where: str) -> SettingsT:
    """Return the settings of a device.

    Args:
        model: What the driver knows.
        given: What the robot file says.
        where: Place in the robot file, for messages.

    Raises:
        InputError: A setting is unknown, missing or out of range.
    """
    try:
        return model.model_validate(dict(given))
    except ValidationError as error:
        fault = error.errors()[0]
        path = ".".join(str(part) for part in ("settings", *fault["loc"]))
        if fault["type"] == "extra_forbidden":
            name = str(fault["loc"][-1])
            raise InputError(f"{where}.{path}: unknown setting{did_you_mean(name, model.model_fields)}") from None
        if fault["type"] == "missing":
            raise InputError(f"{where}.{path}: is missing") from None
        raise InputError(f"{where}.{path}: {fault['msg']} (got {fault['input']!r})") from None
