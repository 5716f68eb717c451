"""What a camera adds to an image: blur, noise, exposure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class CameraEffects:
    """Imperfections of a camera; by default there are none."""

    exposure: float = 1.0
    """Factor on all brightness."""
    defocus: float = 0.0
    """Standard deviation of the blur [px]."""
    motion: float = 0.0
    """Length of the streak that a point leaves [px]."""
    motion_angle: float = 0.0
    """Direction of the streak in the image [rad]."""
    noise: float = 0.0
    """Standard deviation of the noise of a bright pixel, 0 to 255; that of dark ones is smaller."""
    vignette: float = 0.0
    """Share of the brightness that is lost in the corners."""

    @classmethod
    def drawn(cls, rng: np.random.Generator, width: int) -> CameraEffects:
        """Draw effects as a moving robot's camera has them; half the images are sharp.

        Args:
            rng: Source of the draws.
            width: Of the images, which blur is proportional to [px].
        """
        scale = width / 640
        return cls(
            exposure=float(rng.uniform(0.75, 1.25)),
            defocus=float(rng.uniform(0.3, 1.6) * scale) if rng.random() < 0.3 else 0.0,
            motion=float(rng.uniform(2, 9) * scale) if rng.random() < 0.3 else 0.0,
            motion_angle=float(rng.normal(0.0, 0.4)),
            noise=float(rng.uniform(0, 8)),
            vignette=float(rng.uniform(0, 0.25)),
        )

    def apply(self, rgb: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
        """Return the image (h, w, 3) as the camera takes it."""
        image: NDArray[np.floating[Any]] = rgb.astype(np.float32)
        if self.motion > 1:
            streak = _streak(self.motion, self.motion_angle)
            image = np.asarray(cv2.filter2D(image, -1, streak, borderType=cv2.BORDER_REPLICATE), dtype=np.float32)
        if self.defocus > 0:
            blurred = cv2.GaussianBlur(image, (0, 0), self.defocus, borderType=cv2.BORDER_REPLICATE)
            image = np.asarray(blurred, dtype=np.float32)
        image = image * np.float32(self.exposure)
        if self.vignette > 0:
            image = image * _fall_off(image.shape[0], image.shape[1], self.vignette)
        if self.noise > 0:  # of photons: it grows with the square root of the brightness
            deviation = self.noise * np.sqrt(0.15 + 0.85 * np.clip(image, 0, 255) / 255)
            image = image + deviation * rng.standard_normal(image.shape, dtype=np.float32)
        return np.asarray(np.clip(np.rint(image), 0, 255), dtype=np.uint8)


def _streak(length: float, angle: float) -> NDArray[np.float32]:
    """Return the kernel of a straight motion."""
    half = math.ceil(length / 2)
    kernel = np.zeros((2 * half + 1, 2 * half + 1), dtype=np.float32)
    x, y = length / 2 * math.cos(angle), length / 2 * math.sin(angle)
    ends = [(round((half + sign * x) * 16), round((half + sign * y) * 16)) for sign in (-1, 1)]
    cv2.line(kernel, ends[0], ends[1], 1.0, 1, cv2.LINE_AA, 4)
    return np.asarray(kernel / kernel.sum(), dtype=np.float32)


def _fall_off(height: int, width: int, share: float) -> NDArray[np.float32]:
    """Return (h, w, 1) brightness over the image."""
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    return np.asarray(1 - share * (x * x + y * y)[..., None] / 2, dtype=np.float32)
