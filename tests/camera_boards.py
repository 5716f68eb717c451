"""Chessboards as known cameras see them."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

COLUMNS, ROWS, SQUARE = 9, 6, 0.03
_DOTS = 40  # texture pixels a square
SIZE = (640, 480)


@dataclass(eq=False)
class BoardCamera:
    """A camera with a lens, somewhere."""

    matrix: np.ndarray = field(
        default_factory=lambda: np.array([[520.0, 0.0, 325.0], [0.0, 515.0, 236.0], [0.0, 0.0, 1.0]])
    )
    distortion: np.ndarray = field(default_factory=lambda: np.array([-0.22, 0.06, 0.001, -0.0005, 0.0]))
    x: float = 0.0
    """To the right of the reference camera [m]."""

    def __post_init__(self) -> None:
        columns, rows = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
        pixels = np.column_stack((columns.ravel(), rows.ravel())).astype(np.float64)[:, None]
        straight = cv2.undistortPoints(pixels, self.matrix, self.distortion)[:, 0]
        self._rays = np.column_stack((straight, np.ones(len(straight))))

    def see(self, turn: np.ndarray, shift: np.ndarray, noise: int | None = None) -> np.ndarray:
        """Return the image (480, 640, 3) of a board whose first inner corner is at ``shift``, turned by ``turn``."""
        rotation, _ = cv2.Rodrigues(np.asarray(turn, dtype=np.float64))
        shift = np.asarray(shift) - (self.x, 0.0, 0.0)
        # A ray meets the board where r3 · (s ray - shift) = 0; there it has the board's coordinates r1, r2 · (…).
        scale = rotation[:, 2] @ shift / (self._rays @ rotation[:, 2])
        on_board = (self._rays * scale[:, None] - shift) @ rotation[:, :2] / SQUARE
        texture = _texture()
        places = ((on_board + 2.0) * _DOTS - 0.5).astype(np.float32).reshape(SIZE[1], SIZE[0], 2)
        grey = cv2.remap(texture, places, None, cv2.INTER_LINEAR, borderValue=(130.0,))
        grey = cv2.GaussianBlur(grey, (0, 0), 0.7)
        if noise is not None:
            grey = np.clip(grey + np.random.default_rng(noise).normal(0.0, 2.0, grey.shape), 0, 255).astype(np.uint8)
        return cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)


def poses(count: int, seed: int = 1) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return turns and shifts of a board all over the image, tilted each in its own way."""
    rng, found = np.random.default_rng(seed), []
    middle = np.array([(COLUMNS - 1) / 2, (ROWS - 1) / 2, 0.0]) * SQUARE
    for number in range(count):
        tilt = 0.55 * np.array([np.cos(2.4 * number), np.sin(2.4 * number), 0.0])
        turn = tilt + np.array([0.0, 0.0, rng.uniform(-0.2, 0.2)])
        distance = rng.uniform(0.42, 0.62)
        place = np.array([rng.uniform(-0.2, 0.3), rng.uniform(-0.18, 0.18), 1.0]) * distance
        found.append((turn, place - cv2.Rodrigues(turn)[0] @ middle))
    return found


def _texture() -> np.ndarray:
    rows, columns = np.indices((ROWS + 3, COLUMNS + 3))
    squares = np.where((rows + columns) % 2, 225, 30).astype(np.uint8)
    squares[[0, -1]] = squares[:, [0, -1]] = 240  # a white rim
    return np.kron(squares, np.ones((_DOTS, _DOTS), dtype=np.uint8))
