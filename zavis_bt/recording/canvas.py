"""A drawing area in map coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, FloatArray, GridMap

Colour = tuple[int, int, int]
Bounds = tuple[float, float, float, float]

GRID_COLOURS: dict[int, Colour] = {UNKNOWN: (218, 222, 229), FREE: (255, 255, 255), OCCUPIED: (58, 65, 78)}
_SUPERSAMPLING = 2
_SHIFT = 4  # fractional bits of OpenCV's coordinates


def grid_image(grid: GridMap) -> NDArray[np.uint8]:
    """Return the grid in colours, (rows, cols, 3) rgb, north (the largest y) up."""
    palette = np.full((256, 3), GRID_COLOURS[UNKNOWN], dtype=np.uint8)
    palette[[FREE, OCCUPIED]] = GRID_COLOURS[FREE], GRID_COLOURS[OCCUPIED]
    return np.asarray(palette[grid.states[::-1].view(np.uint8)])


def known_bounds(grid: GridMap, points: FloatArray, margin: float) -> Bounds:
    """Return x0, y0, x1, y1 [m] around the known cells and (n, 2) points; the whole grid if there is neither."""
    rows, cols = np.nonzero(grid.states != UNKNOWN)
    cells = np.column_stack((rows, cols))
    corners = grid.to_points(np.array([cells.min(axis=0), cells.max(axis=0)])) if len(cells) else np.empty((0, 2))
    shown = np.vstack((corners, points))
    if not len(shown):
        x, y = grid.origin
        shown = np.array([[x, y], [x + grid.shape[1] * grid.resolution, y + grid.shape[0] * grid.resolution]])
    (x0, y0), (x1, y1) = shown.min(axis=0) - margin, shown.max(axis=0) + margin
    return float(x0), float(y0), float(x1), float(y1)


class Canvas:
    """An image of a piece of the map. Shapes are given in metres, their strokes in pixels of the finished image."""

    def __init__(self, bounds: Bounds, scale: float) -> None:
        """Start with unknown ground.

        Args:
            bounds: x0, y0, x1, y1 of the piece [m].
            scale: Pixels a metre.
        """
        self.scale = scale
        self._x0, _, _, self._y1 = bounds
        self.width = max(1, round((bounds[2] - bounds[0]) * scale))
        self.height = max(1, round((bounds[3] - bounds[1]) * scale))
        size = (self.height * _SUPERSAMPLING, self.width * _SUPERSAMPLING, 3)
        self._image = np.full(size, GRID_COLOURS[UNKNOWN], dtype=np.uint8)

    def to_pixels(self, points: FloatArray) -> FloatArray:
        """Return (n, 2) pixel positions (u, v) in the finished image of (n, 2) map points [m]."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        return (points - [self._x0, self._y1]) * [self.scale, -self.scale]

    def draw_grid(self, grid: GridMap) -> None:
        """Paint the grid's cells."""
        import cv2

        if grid.states.size == 0:
            return
        top_left = self.to_pixels(np.array([[grid.origin[0], grid.origin[1] + grid.shape[0] * grid.resolution]]))[0]
        factor = grid.resolution * self.scale * _SUPERSAMPLING
        u, v = top_left * _SUPERSAMPLING
        matrix = np.array([[factor, 0.0, u + factor / 2 - 0.5], [0.0, factor, v + factor / 2 - 0.5]])
        height, width = self._image.shape[:2]
        self._image = np.asarray(
            cv2.warpAffine(
                np.ascontiguousarray(grid_image(grid)),
                matrix,
                (width, height),
                flags=cv2.INTER_NEAREST,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=GRID_COLOURS[UNKNOWN],
            ),
            dtype=np.uint8,
        )

    def line(self, points: FloatArray, colour: Colour, thickness: float) -> None:
        """Draw a polyline through (n, 2) map points [m]; ``thickness`` [px]."""
        import cv2

        stroke = max(1, round(thickness * _SUPERSAMPLING))
        cv2.polylines(self._image, [self._fixed(self.to_pixels(points))], False, colour, stroke, cv2.LINE_AA, _SHIFT)

    def gradient_line(self, points: FloatArray, colours: NDArray[np.uint8], thickness: float) -> None:
        """Draw a polyline whose segment i of n - 1 has the colour i of (n - 1, 3)."""
        import cv2

        stroke, fixed = max(1, round(thickness * _SUPERSAMPLING)), self._fixed(self.to_pixels(points))
        for a, b, colour in zip(fixed[:-1], fixed[1:], colours.tolist(), strict=True):
            cv2.line(self._image, a.tolist(), b.tolist(), colour, stroke, cv2.LINE_AA, _SHIFT)

    def disc(self, centre: FloatArray, radius: float, colour: Colour, *, opacity: float = 1.0) -> None:
        """Fill a disc about a pixel position of the finished image; ``radius`` [px]."""
        import cv2

        target = self._image.copy() if opacity < 1 else self._image
        c, r = self._fixed(centre[None])[0].tolist(), round(radius * _SUPERSAMPLING * (1 << _SHIFT))
        cv2.circle(target, c, r, colour, cv2.FILLED, cv2.LINE_AA, _SHIFT)
        if opacity < 1:
            cv2.addWeighted(target, opacity, self._image, 1 - opacity, 0, dst=self._image)

    def ring(self, centre: FloatArray, radius: float, colour: Colour, thickness: float) -> None:
        """Draw a circle about a pixel position; ``radius`` and ``thickness`` [px]."""
        import cv2

        c, r = self._fixed(centre[None])[0].tolist(), round(radius * _SUPERSAMPLING * (1 << _SHIFT))
        cv2.circle(self._image, c, r, colour, max(1, round(thickness * _SUPERSAMPLING)), cv2.LINE_AA, _SHIFT)

    def polygon(self, corners: FloatArray, fill: Colour, outline: Colour, thickness: float) -> None:
        """Fill a simple polygon of (n, 2) pixel positions and draw its outline, ``thickness`` [px]."""
        import cv2

        fixed = self._fixed(corners)
        cv2.fillPoly(self._image, [fixed], fill, cv2.LINE_AA, _SHIFT)
        stroke = max(1, round(thickness * _SUPERSAMPLING))
        cv2.polylines(self._image, [fixed], True, outline, stroke, cv2.LINE_AA, _SHIFT)

    def finish(self) -> NDArray[np.uint8]:
        """Return the finished image, (height, width, 3) rgb."""
        import cv2

        size = (self.width, self.height)
        return np.asarray(cv2.resize(self._image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)

    @staticmethod
    def _fixed(pixels: FloatArray) -> NDArray[np.int32]:
        return np.rint(np.asarray(pixels) * _SUPERSAMPLING * (1 << _SHIFT)).astype(np.int32)


def star(centre: FloatArray, radius: float) -> FloatArray:
    """Return the (10, 2) corners of a five-pointed star about a pixel position, a point up."""
    angles = np.arange(10) * np.pi / 5
    radii = np.where(np.arange(10) % 2 == 0, radius, 0.45 * radius)
    return np.asarray(centre + np.column_stack((np.sin(angles), -np.cos(angles))) * radii[:, None])


def arrow_head(tip: FloatArray, direction: float, size: float) -> FloatArray:
    """Return the (3, 2) corners of an arrow's head; ``direction`` in the map [rad], ``size`` [px]."""
    turned = np.array([direction, direction + 2.7, direction - 2.7])
    reach = np.array([0.0, size, size])
    return np.asarray(tip + np.column_stack((np.cos(turned), -np.sin(turned))) * reach[:, None])


def diamond(centre: FloatArray, radius: float) -> FloatArray:
    """Return the (4, 2) corners of a square on its tip about a pixel position."""
    return np.asarray(centre + np.array([[0, -1], [1, 0], [0, 1], [-1, 0]], dtype=np.float64) * radius)


def blend(a: Sequence[int], b: Sequence[int], share: float) -> Colour:
    """Return the colour at ``share`` of the way from a to b."""
    mixed = np.rint(np.array(a) + (np.array(b) - np.array(a)) * float(np.clip(share, 0, 1))).astype(int)
    return int(mixed[0]), int(mixed[1]), int(mixed[2])
