"""Images of the simulator's camera protocol: pixels to bytes and back (docs/camera_protocol.md)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivers.camera.wire import WireError
from zavis_bt.types import CameraIntrinsics

RgbEncoding = Literal["raw", "jpeg"]
DepthEncoding = Literal["raw", "png"]
_JPEG_QUALITY = 90
_PNG_LEVEL = 1  # the quickest; more gains little on depth


@dataclass(frozen=True, slots=True)
class WireImage:
    """An image as it travels."""

    encoding: str
    data: bytes


def encode_rgb(rgb: NDArray[np.uint8], encoding: RgbEncoding) -> WireImage:
    """Return a colour image (h, w, 3), red first, for the wire."""
    if encoding == "raw":
        return WireImage(encoding, rgb.tobytes())
    import cv2

    _, data = cv2.imencode(".jpg", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    return WireImage(encoding, data.tobytes())


def encode_depth(depth: NDArray[np.float32], encoding: DepthEncoding) -> WireImage:
    """Return a depth image (h, w) [m] for the wire: whole millimetres, 0 for no reading or too far for 16 bits."""
    millimetres = np.rint(depth * 1000.0)
    pixels = np.where(millimetres <= 65535, millimetres, 0.0).astype("<u2")
    if encoding == "raw":
        return WireImage(encoding, pixels.tobytes())
    import cv2

    _, data = cv2.imencode(".png", pixels, [cv2.IMWRITE_PNG_COMPRESSION, _PNG_LEVEL])
    return WireImage(encoding, data.tobytes())


def decode_pixels(
    rgb: WireImage, depth: WireImage, intrinsics: CameraIntrinsics
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return colour (h, w, 3) uint8 and depth (h, w) float32 [m].

    Raises:
        WireError: An image is damaged, or is not there.
    """
    shape = intrinsics.height, intrinsics.width
    colours = _decoded(rgb, (*shape, 3), np.dtype(np.uint8))
    millimetres = _decoded(depth, shape, np.dtype("<u2"))
    return colours, millimetres.astype(np.float32) / np.float32(1000)


def _decoded(image: WireImage, shape: Sequence[int], dtype: np.dtype[Any]) -> NDArray[Any]:
    if image.encoding == "raw":
        if len(image.data) != math.prod(shape) * dtype.itemsize:
            raise WireError(f"the raw image has {len(image.data)} bytes ({math.prod(shape) * dtype.itemsize} would do)")
        return np.frombuffer(image.data, dtype).reshape(shape)
    import cv2

    flag = cv2.IMREAD_UNCHANGED if len(shape) == 2 else cv2.IMREAD_COLOR
    pixels = cv2.imdecode(np.frombuffer(image.data, np.uint8), flag) if image.data else None
    if pixels is None or pixels.shape != tuple(shape) or pixels.dtype != dtype:
        raise WireError(f"the {image.encoding} image is damaged")
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB) if len(shape) == 3 else pixels
