"""What a kind of camera must offer to become a device."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import CameraIntrinsics

Pixels = Callable[[], tuple[NDArray[np.uint8], NDArray[np.float32]]]


@dataclass(frozen=True, slots=True)
class Capture:
    """One instant's images; from where they were taken is not the camera's knowledge."""

    stamp: float
    """Time of capture on the mission's clock [s]."""
    intrinsics: CameraIntrinsics
    pixels: Pixels
    """As `RgbdFrame` wants it; called by other threads, until it succeeds once. May raise `DeviceError`."""
    annotations: tuple[Any, ...] | None = None
    """Ground truth, if the camera is a simulated one that was asked for it."""


@dataclass(frozen=True, slots=True)
class NamePlate:
    """What a camera says of itself."""

    model: str
    firmware: str = ""
    serial: str = ""
    figures: Mapping[str, str] = field(default_factory=dict)


class Source(Protocol):
    """Where a camera's images come from. One thread at a time uses it."""

    def open(self) -> NamePlate:
        """Connect, for the first time or again after `close`.

        Raises:
            DeviceError: It cannot be opened: one line with the remedy.
        """

    def capture(self, timeout: float) -> Capture | None:
        """Wait for the next images, about ``timeout`` [s] at most; None if there are none by then.

        Raises:
            DeviceError: The camera is lost.
        """

    def close(self) -> None:
        """Disconnect; never raises, may be called twice."""
