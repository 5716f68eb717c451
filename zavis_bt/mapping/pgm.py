"""Portable greymaps: the images of map_server maps, read and written without an image library."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError

_GAP = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"(P[25])" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)(?:#[^\n]*\n|\s)")
_COMMENT = re.compile(rb"#[^\n]*")


def read_pgm(path: Path) -> tuple[NDArray[np.uint16], int]:
    """Read a binary (P5) or plain (P2) greymap.

    Args:
        path: The file.

    Returns:
        (rows, cols) pixels, first row at the top, and the value that means white.

    Raises:
        InputError: The file is missing, is not a greymap or is cut off.
    """
    data = read_bytes(path)
    header = _HEADER.match(data)
    if header is None:
        raise InputError(f"{path}: not a PGM image (a header 'P5 width height 255' or 'P2 …')")
    cols, rows, white = (int(number) for number in header.group(2, 3, 4))
    if not (cols and rows and 0 < white < 65536):
        raise InputError(f"{path}: a PGM of {cols} × {rows} pixels with white {white} (sizes and 1 to 65535 expected)")
    body = data[header.end() :]
    values = _plain(path, body, cols * rows) if header[1] == b"P2" else _binary(body, white, cols * rows)
    if values.size < cols * rows:
        raise InputError(f"{path}: cut off after {values.size} of {cols * rows} pixels")
    pixels = values[: cols * rows].reshape(rows, cols)
    if header[1] == b"P2" or white not in (255, 65535):
        _check_values(path, pixels, white)
    return pixels, white


def write_pgm(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write (rows, cols) pixels, first row at the top, as a binary greymap with white 255."""
    rows, cols = pixels.shape
    path.write_bytes(b"P5\n%d %d\n255\n" % (cols, rows) + np.ascontiguousarray(pixels).tobytes())


def read_bytes(path: Path) -> bytes:
    """Return the file's content.

    Raises:
        InputError: The file is missing or cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error


def _binary(body: bytes, white: int, count: int) -> NDArray[np.uint16]:
    dtype = np.dtype(np.uint8 if white < 256 else ">u2")
    available = min(count, len(body) // dtype.itemsize)
    return np.frombuffer(body, dtype, available).astype(np.uint16)


def _plain(path: Path, body: bytes, count: int) -> NDArray[np.uint16]:
    words = _COMMENT.sub(b"", body).split()[:count]
    try:
        return np.array([int(word) for word in words], dtype=np.uint16)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{path}: a plain PGM holds numbers from 0 to 65535 only: {error}") from error


def _check_values(path: Path, pixels: NDArray[np.uint16], white: int) -> None:
    if int(pixels.max()) > white:
        raise InputError(f"{path}: a pixel of {int(pixels.max())} is brighter than white ({white})")
