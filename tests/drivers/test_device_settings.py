from __future__ import annotations

from typing import Annotated

import pytest
from pydantic import Field

from drivers.settings import Settings, read_settings
from zavis_bt.errors import InputError


class Sample(Settings):
    port: str
    baud: Annotated[int, Field(gt=0)] = 9600


def test_what_is_given_is_read_and_the_rest_has_defaults():
    assert read_settings(Sample, {"port": "/dev/ttyUSB0"}, "here") == Sample(port="/dev/ttyUSB0", baud=9600)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({}, "my.robot.yaml: devices.base.settings.port: is missing"),
        (
            {"port": "x", "buad": 1},
            "my.robot.yaml: devices.base.settings.buad: unknown setting (did you mean 'baud'?)",
        ),
        (
            {"port": "x", "baud": -1},
            "my.robot.yaml: devices.base.settings.baud: Input should be greater than 0 (got -1)",
        ),
    ],
)
def test_a_fault_is_one_line_that_says_where(given, line):
    with pytest.raises(InputError) as caught:
        read_settings(Sample, given, "my.robot.yaml: devices.base")
    assert str(caught.value) == line
