"""Which cells see each other."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


def clear_line(blocked: NDArray[np.bool_], cell0: tuple[int, int], cell1: tuple[int, int]) -> bool:
    """Tell whether the straight line between the centres of two cells meets no blocked cell between them.

    The two cells themselves may be blocked: what is looked at usually is. A line through the corner where four cells
    meet is blocked if both cells beside it are. Seen from either end the answer is the same.

    Args:
        blocked: (rows, cols) cells that hide what is behind them.
        cell0: ``(row, col)``.
        cell1: ``(row, col)``.

    Returns:
        Whether the cells see each other; a cell outside the grid sees nothing.
    """
    return bool(_clear(blocked, int(cell0[0]), int(cell0[1]), int(cell1[0]), int(cell1[1])))


def visible_from(blocked: NDArray[np.bool_], origin: tuple[int, int], targets: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Tell for many cells whether one cell sees them, by the rule of `clear_line`.

    Args:
        blocked: (rows, cols) cells that hide what is behind them.
        origin: ``(row, col)``.
        targets: (n, 2) ``[row, col]``.

    Returns:
        (n,) whether there is a clear line.
    """
    cells = np.ascontiguousarray(targets, dtype=np.intp).reshape(-1, 2)
    seen: NDArray[np.bool_] = _visible(blocked, int(origin[0]), int(origin[1]), cells)
    return seen


@njit(cache=True, nogil=True)
def _visible(blocked: NDArray[np.bool_], row: int, col: int, targets: NDArray[np.intp]) -> NDArray[np.bool_]:
    seen = np.empty(len(targets), dtype=np.bool_)
    for i in range(len(targets)):
        seen[i] = _clear(blocked, row, col, targets[i, 0], targets[i, 1])
    return seen


@njit(cache=True, nogil=True)
def _clear(blocked: NDArray[np.bool_], row0: int, col0: int, row1: int, col1: int) -> bool:
    rows, cols = blocked.shape
    if not (0 <= row0 < rows and 0 <= row1 < rows and 0 <= col0 < cols and 0 <= col1 < cols):
        return False
    d_row, d_col = abs(row1 - row0), abs(col1 - col0)
    step_row, step_col = 1 if row1 > row0 else -1, 1 if col1 > col0 else -1
    row, col = row0, col0
    lead = d_row - d_col  # sign says which border the line crosses next: > 0 between rows, < 0 between columns
    for _ in range(d_row + d_col):
        if lead == 0:
            if blocked[row, col + step_col] and blocked[row + step_row, col]:
                return False
            row, col = row + step_row, col + step_col
            lead += 2 * d_row - 2 * d_col
        elif lead > 0:
            row += step_row
            lead -= 2 * d_col
        else:
            col += step_col
            lead += 2 * d_row
        if row == row1 and col == col1:
            return True
        if blocked[row, col]:
            return False
    return True
