"""What the LiDAR and the camera deliver, and boxes in images."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types.motion import FloatArray


@dataclass(frozen=True, slots=True)
class LaserScan:
    """One sweep of the LiDAR. Beam i looks along ``angle_min + i * angle_increment`` in the sensor's frame."""

    ranges: FloatArray
    """(n,) [m]; a beam without return is +inf, a broken one NaN."""
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    stamp: float

    @property
    def angles(self) -> FloatArray:
        """(n,) beam directions in the sensor's frame [rad]."""
        return self.angle_min + self.angle_increment * np.arange(len(self.ranges), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class CameraIntrinsics:
    """Pinhole model without distortion [px]."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @classmethod
    def from_fov(cls, width: int, height: int, horizontal_fov: float) -> CameraIntrinsics:
        """Return square-pixel intrinsics with the principal point in the middle; ``horizontal_fov`` [rad]."""
        focal = width / 2 / math.tan(horizontal_fov / 2)
        return cls(width, height, focal, focal, width / 2, height / 2)

    @property
    def horizontal_fov(self) -> float:
        """Full horizontal opening angle [rad]."""
        return 2 * math.atan(self.width / 2 / self.fx)

    @property
    def vertical_fov(self) -> float:
        """Full vertical opening angle [rad]."""
        return 2 * math.atan(self.height / 2 / self.fy)


class Box(NamedTuple):
    """An axis-aligned box in an image [px], edges as real numbers, ``x0 < x1`` and ``y0 < y1``."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        """Area [px²]."""
        return max(self.x1 - self.x0, 0.0) * max(self.y1 - self.y0, 0.0)

    def intersection(self, other: Box) -> float:
        """Return the common area [px²]."""
        width = min(self.x1, other.x1) - max(self.x0, other.x0)
        height = min(self.y1, other.y1) - max(self.y0, other.y0)
        return max(width, 0.0) * max(height, 0.0)

    def iou(self, other: Box) -> float:
        """Return intersection over union, 0 to 1."""
        common = self.intersection(other)
        union = self.area + other.area - common
        return common / union if union > 0 else 0.0


class _OncePerFrame:
    """A frame's images, made once. Frames do not wait for one another, as with a `cached_property` of Python 3.11."""

    def __get__(self, frame: RgbdFrame, owner: type[RgbdFrame]) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        with frame._guard:
            if "_pixels" not in frame.__dict__:  # which is looked into first from now on
                frame.__dict__["_pixels"] = frame._source()
            made: tuple[NDArray[np.uint8], NDArray[np.float32]] = frame.__dict__["_pixels"]
            return made


class RgbdFrame:
    """A colour and depth image of one instant, with the camera's pose at that instant.

    Pixels come from ``pixels`` when somebody first asks for them: a camera that renders, decodes or fetches does no
    work for frames that are only passed on. Any thread may ask; whoever comes while another waits gets the same.
    """

    def __init__(
        self,
        intrinsics: CameraIntrinsics,
        transform_camera_to_map: FloatArray,
        stamp: float,
        pixels: Callable[[], tuple[NDArray[np.uint8], NDArray[np.float32]]],
    ) -> None:
        """Describe a frame.

        Args:
            intrinsics: Camera model.
            transform_camera_to_map: (4, 4) homogeneous transform of optical camera points to the map, at capture.
            stamp: Time of capture on the mission's clock [s].
            pixels: Returns rgb (h, w, 3) uint8 and depth (h, w) float32 [m along the optical axis; 0 = no reading].
                Called until it succeeds once; what it raises (`DeviceError`) goes to whoever asked.
        """
        self.intrinsics = intrinsics
        self.transform_camera_to_map = transform_camera_to_map
        self.stamp = stamp
        self._source = pixels
        self._guard = threading.Lock()

    _pixels = _OncePerFrame()

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8."""
        return self._pixels[0]

    @property
    def depth(self) -> NDArray[np.float32]:
        """(h, w) metres along the optical axis; 0 = no reading."""
        return self._pixels[1]

    def depth_at(self, pixels: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the depth at (n, 2) pixels ``[column, row]``, shape (n,) [m]; the same values as in ``depth``."""
        return self.depth[pixels[:, 1], pixels[:, 0]]

    def crop(self, box: Box) -> NDArray[np.uint8]:
        """Return the patch inside the box, (h', w', 3) uint8, at least one pixel."""
        height, width = self.intrinsics.height, self.intrinsics.width
        x0, y0 = int(np.clip(box.x0, 0, width - 1)), int(np.clip(box.y0, 0, height - 1))
        x1, y1 = int(np.clip(math.ceil(box.x1), x0 + 1, width)), int(np.clip(math.ceil(box.y1), y0 + 1, height))
        return self.rgb[y0:y1, x0:x1]


UNKNOWN_CLASS = "unknown"


@dataclass(frozen=True, slots=True)
class Detection:
    """One box of the open-set detector."""

    box: Box
    label: str
    """A known class, or `UNKNOWN_CLASS`."""
    score: float
    """Confidence, 0 to 1."""
    probabilities: tuple[tuple[str, float], ...] = ()
    """Class probabilities of a known detection, summing to 1; empty for `UNKNOWN_CLASS`."""
    epistemic: float = 0.0
    """Eq. epis of the paper."""
    aleatoric: float = 0.0
    """Eq. alea of the paper [nat]."""
