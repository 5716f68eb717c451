"""Colour and depth from the images of a calibrated stereo pair."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.camera.calibration_file import Size, StereoCalibration, intrinsics_of, matrix_of
from zavis_bt.types import CameraIntrinsics, FloatArray

_MOST_SEARCHED = 0.4  # share of the image's width that disparities are searched over, at most


@dataclass(frozen=True)
class StereoDepth:
    """Rectifies both images at once to the wanted size, and matches them by OpenCV's semi-global matching.

    The colour image is the rectified left one; depth belongs to its pixels.
    """

    calibration: StereoCalibration
    size: Size
    """Width and height of what comes out [px]."""
    depth_min: float
    """Nearest and
    farthest depth that is believed [m]."""
    depth_max: float
    block_size: int = 5
    """Side of the blocks compared, odd [px]; larger ones smooth more and need less texture."""
    uniqueness: int = 10
    """By how many percent the best match must beat the second best."""

    @property
    def intrinsics(self) -> CameraIntrinsics:
        """Camera model of what comes out."""
        return intrinsics_of(self.calibration.P1, self.calibration.size, self.size)

    @cached_property
    def nearest(self) -> float:
        """Nearest depth that can be measured [m]: ``depth_min``, unless that would be searched too far for."""
        low, count = self._search
        return max(self.depth_min, self._pull / (low + count - self._shift))

    def __call__(
        self, left: NDArray[np.uint8], right: NDArray[np.uint8]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return colour and depth; may be called by several threads at once.

        Args:
            left: (h, w, 3) as OpenCV delivers it, blue first, or (h, w) grey.
            right: The same of the other camera.

        Returns:
            (h', w', 3) uint8, red first, and (h', w') float32 [m], 0 for no reading.
        """
        import cv2

        first, second = (self._rectified(image, maps) for image, maps in zip((left, right), self._maps, strict=True))
        depth = self._depth(_grey(first), _grey(second))
        rgb = cv2.cvtColor(first, cv2.COLOR_GRAY2RGB if first.ndim == 2 else cv2.COLOR_BGR2RGB)
        return np.asarray(rgb, dtype=np.uint8), depth

    def _depth(self, left: NDArray[np.uint8], right: NDArray[np.uint8]) -> NDArray[np.float32]:
        import cv2

        low, count = self._search
        margin = low + count  # matching leaves so many columns out at the left edge
        wide = [cv2.copyMakeBorder(image, 0, 0, margin, 0, cv2.BORDER_REPLICATE) for image in (left, right)]
        disparity: NDArray[np.float32] = self._matcher().compute(*wide)[:, margin:].astype(np.float32) / 16
        found = disparity >= low
        offset = disparity - np.float32(self._shift)
        depth = np.zeros_like(offset)
        np.divide(np.float32(self._pull), offset, out=depth, where=found & (offset > 0))
        depth[(depth < self.depth_min) | (depth > self.depth_max)] = 0.0
        return depth

    def _matcher(self) -> Any:
        """Return a new matcher: it keeps what it works on in itself, so that threads cannot share one."""
        import cv2

        low, count = self._search
        area = self.block_size**2
        return cv2.StereoSGBM.create(
            minDisparity=low,
            numDisparities=count,
            blockSize=self.block_size,
            P1=8 * area,
            P2=32 * area,
            disp12MaxDiff=1,
            preFilterCap=31,
            uniquenessRatio=self.uniqueness,
            speckleWindowSize=100,
            speckleRange=2,
            mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
        )

    @property
    def _pull(self) -> float:
        """Disparity times depth [px m]."""
        return self.intrinsics.fx * self.calibration.baseline

    @property
    def _shift(self) -> float:
        """Disparity of what is infinitely far [px]."""
        scale = self.size[0] / self.calibration.size[0]
        return float(self.calibration.P1[0, 2] - self.calibration.P2[0, 2]) * scale

    @property
    def _search(self) -> tuple[int, int]:
        """Return the least disparity looked for, and over how many, a multiple of 16 [px]."""
        low = math.floor(self._pull / self.depth_max + self._shift)
        high = math.ceil(self._pull / max(self.depth_min, 1e-3) + self._shift)
        most = max(int(self.size[0] * _MOST_SEARCHED) // 16, 1)
        return max(low, 0), 16 * min(max(math.ceil((high - max(low, 0) + 1) / 16), 1), most)

    @cached_property
    def _maps(self) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
        c = self.calibration
        return self._map(c.K1, c.D1, c.R1, c.P1), self._map(c.K2, c.D2, c.R2, c.P2)

    def _map(self, matrix: FloatArray, distortion: FloatArray, turn: FloatArray, projection: FloatArray) -> Any:
        import cv2

        target = matrix_of(intrinsics_of(projection, self.calibration.size, self.size))
        return cv2.initUndistortRectifyMap(matrix, distortion, turn, target, self.size, cv2.CV_16SC2)

    def _rectified(self, image: NDArray[np.uint8], maps: tuple[Any, Any]) -> NDArray[np.uint8]:
        import cv2

        return np.asarray(cv2.remap(image, *maps, cv2.INTER_LINEAR), dtype=np.uint8)


def _grey(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    import cv2

    return image if image.ndim == 2 else np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
