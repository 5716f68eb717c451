"""Chessboards in images."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError

Corners = NDArray[np.float32]
_LEAST_SPACING = 8.0  # squares smaller than that have no exact corners [px]
_WORST_BLUR = 0.35  # of a square's side, from black to white
_BLUR = 5.0  # [px] that is no blur, however small the squares are


@dataclass(frozen=True, slots=True)
class Board:
    """A chessboard."""

    columns: int
    """Inner corners along its longer
    and its shorter side."""
    rows: int
    square: float
    """Side of a square [m]."""

    @property
    def points(self) -> NDArray[np.float32]:
        """(columns * rows, 3) inner corners on the board, row after row [m]."""
        grid = np.mgrid[: self.rows, : self.columns][::-1].reshape(2, -1).T * self.square
        return np.column_stack((grid, np.zeros(len(grid)))).astype(np.float32)


def parse_board(text: str, square: float) -> Board:
    """Return the board written as ``9x6``: inner corners along both sides.

    Raises:
        InputError: It is written otherwise, or is too small.
    """
    sides = text.lower().replace("×", "x").split("x")
    if len(sides) != 2 or not all(side.strip().isdigit() for side in sides):
        raise InputError(f"--board: '{text}' is no board (inner corners along both sides, e.g. 9x6)")
    short, long = sorted(map(int, sides))
    if short < 3 or long == short:
        raise InputError(f"--board: '{text}' will not do (at least 3 inner corners a side, one more on the other)")
    return Board(long, short, square)


def find_corners(image: NDArray[np.uint8], board: Board) -> tuple[Corners | None, str]:
    """Look for a board's inner corners, to fractions of a pixel.

    Args:
        image: (h, w, 3) or (h, w).
        board: What to look for.

    Returns:
        (n, 2) corners in the order of `Board.points` and nothing; or None and why there are none of use.
    """
    import cv2

    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    shape, flags = (board.columns, board.rows), cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, raw = cv2.findChessboardCornersSB(grey, shape, flags=flags)
    if not found:
        return None, f"no board of {board.columns} x {board.rows} inner corners (all of it in sight and lit evenly?)"
    corners = np.asarray(raw, dtype=np.float32).reshape(-1, 2)
    spacing = _spacing(corners, board)
    if spacing < _LEAST_SPACING:
        return None, f"the board is too small: {spacing:.0f} pixels a square (hold it nearer)"
    blur = _blur(grey, corners, shape)
    if blur > max(_BLUR, _WORST_BLUR * spacing):
        return None, f"blurred: {blur:.0f} pixels from black to white (hold still, more light, focus)"
    return corners, ""


def same_order(left: Corners, right: Corners) -> Corners:
    """Return the right image's corners in the left one's order: a board can be read from either end."""
    return right if np.dot(left[-1] - left[0], right[-1] - right[0]) > 0 else right[::-1].copy()


def _spacing(corners: Corners, board: Board) -> float:
    """Return the least distance of neighbours [px]."""
    grid = corners.reshape(board.rows, board.columns, 2)
    steps = (np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1))
    return float(min(steps))


def _blur(grey: Any, corners: Corners, shape: tuple[int, int]) -> float:
    import cv2

    estimate: Any = cv2.estimateChessboardSharpness  # its stub knows nothing of the tuple it returns
    return float(max(estimate(grey, shape, corners, 0.8, upright)[0][0] for upright in (False, True)))
