"""Image files: read whole or scaled down, and checked."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError

_END_OF_JPEG = b"\xff\xd9"
_REDUCED = {8: cv2.IMREAD_REDUCED_COLOR_8, 4: cv2.IMREAD_REDUCED_COLOR_4, 2: cv2.IMREAD_REDUCED_COLOR_2}


def read_picture(path: Path, size: tuple[int, int], width: int | None = None) -> NDArray[np.uint8]:
    """Read an image file.

    Args:
        path: JPEG or another format that OpenCV reads.
        size: Width and height it is said to have [px].
        width: Scale down to this width if the image is wider; JPEG files are then decoded at a half, a quarter or an
            eighth of their size where that is enough.

    Returns:
        (h, w, 3) uint8 RGB, a new array.

    Raises:
        InputError: The file cannot be read, is no whole image, or has another size.
    """
    if width is not None and width < 1:
        raise InputError(f"{path}: cannot be scaled to a width of {width} px (at least 1)")
    data = _whole_file(path)
    factor = next((f for f in _REDUCED if width is not None and size[0] >= width * f), 1)
    decoded = _decode(path, data, size, factor)
    if width is None or decoded.shape[1] <= width:
        return np.ascontiguousarray(decoded[..., ::-1])
    height = max(round(size[1] * width / size[0]), 1)
    scaled = cv2.resize(decoded, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.cvtColor(scaled, cv2.COLOR_BGR2RGB), dtype=np.uint8)


def picture_size(path: Path) -> tuple[int, int]:
    """Return width and height of an image file [px], from its header alone.

    Raises:
        InputError: The file cannot be read or is no image.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            return image.size
    except UnidentifiedImageError as error:
        raise InputError(f"{path}: is no image") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error


def _whole_file(path: Path) -> bytes:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    # Decoders fill the missing part of a cut file with grey and only print a warning. The marker cannot occur by
    # chance, but the small picture that cameras put before the image has one of its own.
    if data[:2] == b"\xff\xd8" and _END_OF_JPEG not in data[len(data) // 2 :]:
        raise InputError(f"{path}: is a cut-off JPEG file (copy it again, or take it out of the data set)")
    return data


def _decode(path: Path, data: bytes, size: tuple[int, int], factor: int) -> NDArray[np.uint8]:
    """Return the image as BGR at one ``factor``-th of its size."""
    expected = (-(-size[1] // factor), -(-size[0] // factor))
    mode = _REDUCED.get(factor, cv2.IMREAD_COLOR)
    buffer = np.frombuffer(data, dtype=np.uint8)
    found: tuple[int, ...] = ()
    # Some tools label a turned photograph as it is stored, others as it is shown.
    for orientation in (0, cv2.IMREAD_IGNORE_ORIENTATION):
        decoded = cv2.imdecode(buffer, mode | orientation) if len(data) else None
        if decoded is None:
            raise InputError(f"{path}: is no image, or a corrupt one (copy it again, or take it out of the data set)")
        found = decoded.shape[:2]
        if found == expected:
            return np.asarray(decoded, dtype=np.uint8)
    was = f"{found[1] * factor}×{found[0] * factor}"
    raise InputError(f"{path}: is {was} px, but the data set says {size[0]}×{size[1]} (its boxes would not fit)")
