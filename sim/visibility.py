"""Which boxes an image shows: their rectangles in the image and how much of each is in sight.

A box's visible part is found with rays to a grid of points on the faces turned to the camera. Each point stands for
the image area of its grid cell, so that the sum over all points is the silhouette's area.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim.render_rays import BOTTOM, COS, CX, CY, CZ, HX, HY, HZ, SIN, IntArray, Solids, is_hidden
from zavis_bt.types import CameraIntrinsics, FloatArray

NEAR = 0.05
"""Optical depth below which nothing is projected [m]."""
MIN_SIDE = 3.0
"""Root of the area of a rectangle below which a box is left out: no detector finds it [px]."""

_POINT_SPACING = 14.0  # [px] between rays to a face, about
_FEWEST, _MOST = 3, 10  # rays along one side of a face


class View(NamedTuple):
    """A camera at one instant, for the kernels."""

    position: FloatArray
    """(3,) optical centre in the map [m]."""
    rotation: FloatArray
    """(3, 3) optical to map."""
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    @classmethod
    def of(cls, transform_camera_to_map: FloatArray, intrinsics: CameraIntrinsics) -> View:
        """Return the view of a camera with this pose."""
        rotation = np.ascontiguousarray(transform_camera_to_map[:3, :3])
        position = np.ascontiguousarray(transform_camera_to_map[:3, 3])
        i = intrinsics
        return cls(position, rotation, float(i.fx), float(i.fy), float(i.cx), float(i.cy), i.width, i.height)


class Bounds(NamedTuple):
    """Where boxes lie in the image."""

    rectangles: FloatArray
    """(n, 4) x0, y0, x1, y1 around the part of each box before the camera, not clipped to the image [px]."""
    nearest: FloatArray
    """(n,) least optical depth of that part [m]; inf for a box behind the camera."""
    inside: IntArray
    """(k,) the boxes whose rectangle meets the image, nearest first."""


class Sightings(NamedTuple):
    """What is in sight of k boxes, at least partly."""

    indices: IntArray
    """(k,) the box."""
    boxes: FloatArray
    """(k, 4) x0, y0, x1, y1 around the visible part, clipped to the image [px]."""
    fractions: FloatArray
    """(k,) visible share of the silhouette's area; what the image's border cuts off is not visible."""
    areas: FloatArray
    """(k,) visible area [px²]."""


def bounds_of(solids: Solids, view: View) -> Bounds:
    """Return where all boxes lie in the image."""
    rectangles, nearest = np.empty((len(solids.boxes), 4)), np.empty(len(solids.boxes))
    _project_boxes(solids.boxes, view, rectangles, nearest)
    x0, y0, x1, y1 = rectangles.T
    meets = (nearest < math.inf) & (x1 > 0) & (y1 > 0) & (x0 < view.width) & (y0 < view.height)
    inside = np.flatnonzero(meets)
    return Bounds(rectangles, nearest, inside[np.argsort(nearest[inside], kind="stable")].astype(np.int32))


def sightings(solids: Solids, view: View, bounds: Bounds) -> Sightings:
    """Return the visible part of every box in the image that is at least `MIN_SIDE` large."""
    count = len(bounds.inside)
    table, indices = np.empty((count, 6)), np.empty(count, dtype=np.int32)
    seen = _measure_boxes(solids, view, bounds, table, indices)
    return Sightings(indices[:seen], table[:seen, :4], table[:seen, 4], table[:seen, 5])


@njit(cache=True, nogil=True, error_model="numpy")
def _corner(boxes: FloatArray, box: int, along: float, across: float, up: float) -> tuple[float, float, float]:
    """Return the map point at the given fractions (−1 to 1) of a box's half extents."""
    cos, sin = boxes[box, COS], boxes[box, SIN]
    x, y = along * boxes[box, HX], across * boxes[box, HY]
    return (
        boxes[box, CX] + cos * x - sin * y,
        boxes[box, CY] + sin * x + cos * y,
        boxes[box, CZ] + up * boxes[box, HZ],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _to_optical(view: View, x: float, y: float, z: float) -> tuple[float, float, float]:
    rx, ry, rz = x - view.position[0], y - view.position[1], z - view.position[2]
    r = view.rotation
    return (
        rx * r[0, 0] + ry * r[1, 0] + rz * r[2, 0],
        rx * r[0, 1] + ry * r[1, 1] + rz * r[2, 1],
        rx * r[0, 2] + ry * r[1, 2] + rz * r[2, 2],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _stretch(rectangle: FloatArray, u: float, v: float) -> None:
    """Widen a rectangle so that it holds the pixel position."""
    rectangle[0], rectangle[1] = min(rectangle[0], u), min(rectangle[1], v)
    rectangle[2], rectangle[3] = max(rectangle[2], u), max(rectangle[3], v)


@njit(cache=True, nogil=True, error_model="numpy")
def _project_boxes(boxes: FloatArray, view: View, rectangles: FloatArray, nearest: FloatArray) -> None:
    corners = np.empty((8, 3))
    for box in range(len(boxes)):
        rectangle = rectangles[box]
        rectangle[:2], rectangle[2:] = math.inf, -math.inf
        nearest[box] = math.inf
        for k in range(8):
            x, y, z = _corner(boxes, box, 2.0 * (k & 1) - 1.0, 1.0 * (k & 2) - 1.0, 0.5 * (k & 4) - 1.0)
            corners[k] = _to_optical(view, x, y, z)
            if corners[k, 2] > NEAR:
                depth = corners[k, 2]
                nearest[box] = min(nearest[box], depth)
                _stretch(
                    rectangle,
                    view.fx * corners[k, 0] / depth + view.cx,
                    view.fy * corners[k, 1] / depth + view.cy,
                )
        if nearest[box] < math.inf:
            _clip_edges(view, corners, rectangle, nearest[box : box + 1])


@njit(cache=True, nogil=True, error_model="numpy")
def _clip_edges(view: View, corners: FloatArray, rectangle: FloatArray, nearest: FloatArray) -> None:
    """Add the points where a box's twelve edges pass the near plane."""
    for k in range(8):
        for bit in (1, 2, 4):
            other = k | bit
            if other == k or (corners[k, 2] > NEAR) == (corners[other, 2] > NEAR):
                continue
            share = (NEAR - corners[k, 2]) / (corners[other, 2] - corners[k, 2])
            x = corners[k, 0] + share * (corners[other, 0] - corners[k, 0])
            y = corners[k, 1] + share * (corners[other, 1] - corners[k, 1])
            nearest[0] = NEAR
            _stretch(rectangle, view.fx * x / NEAR + view.cx, view.fy * y / NEAR + view.cy)


@njit(cache=True, nogil=True, error_model="numpy")
def _rivals(bounds: Bounds, box: int, rivals: IntArray) -> int:
    """Collect the boxes that may hide a box: their rectangles overlap. Returns their number."""
    count, rectangle = 0, bounds.rectangles[box]
    for k in range(len(bounds.inside)):
        other = bounds.inside[k]
        rival = bounds.rectangles[other]
        apart = rival[0] > rectangle[2] or rival[2] < rectangle[0] or rival[1] > rectangle[3] or rival[3] < rectangle[1]
        if other != box and not apart:
            rivals[count] = other
            count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def _measure_boxes(solids: Solids, view: View, bounds: Bounds, table: FloatArray, indices: IntArray) -> int:
    """Fill rows of visible box, fraction and area; returns how many boxes are in sight."""
    seen = 0
    rivals = np.empty(len(bounds.inside), np.int32)
    for k in range(len(bounds.inside)):
        box = bounds.inside[k]
        rectangle = bounds.rectangles[box]
        size = math.sqrt((rectangle[2] - rectangle[0]) * (rectangle[3] - rectangle[1]))
        if size < MIN_SIDE:
            continue
        count = _rivals(bounds, box, rivals)
        row = table[seen]
        row[:2], row[2:4], row[4:] = math.inf, -math.inf, 0.0
        points = int(min(max(math.ceil(size / _POINT_SPACING), _FEWEST), _MOST))
        for face in range(6):
            if face != BOTTOM or solids.hulls[box, 0] < 0:  # a hull hides the underside of what it carries
                _measure_face(solids, view, box, face, points, rivals, count, row)
        if row[5] > 0.0:
            row[4] = row[5] / row[4]
            row[0], row[1] = max(row[0], 0.0), max(row[1], 0.0)
            row[2], row[3] = min(row[2], view.width), min(row[3], view.height)
            indices[seen] = box
            seen += 1
    return seen


@njit(cache=True, nogil=True, error_model="numpy")
def _on_face(face: int, a: float, b: float) -> tuple[float, float, float]:
    """Return fractions of the half extents for the point (a, b) of a face, each −1 to 1."""
    side = 2.0 * (face & 1) - 1.0
    if face < 2:
        return side, a, b
    if face < 4:
        return a, side, b
    return a, b, side


@njit(cache=True, nogil=True, error_model="numpy")
def _measure_face(
    solids: Solids, view: View, box: int, face: int, points: int, rivals: IntArray, count: int, row: FloatArray
) -> None:
    """Add a face's silhouette area to row[4], its visible area to row[5], its visible cells to the box row[:4]."""
    boxes, hulls, clearance, room = solids
    axis = face // 2
    along, across, up = _on_face(face, 0.0, 0.0)
    mx, my, mz = _corner(boxes, box, along, across, up)
    ox, oy, oz = view.position
    half = boxes[box, HX + axis]
    nx = (mx - boxes[box, CX]) / half
    ny = (my - boxes[box, CY]) / half
    nz = (mz - boxes[box, CZ]) / half
    facing = (ox - mx) * nx + (oy - my) * ny + (oz - mz) * nz  # distance of the camera from the face's plane
    if facing <= 0.0:
        return
    others = 4.0 * boxes[box, HX + (axis + 1) % 3] * boxes[box, HX + (axis + 2) % 3]
    scale = others / (points * points) * facing * view.fx * view.fy
    for i in range(points):
        for j in range(points):
            along, across, up = _on_face(face, (2 * i + 1) / points - 1.0, (2 * j + 1) / points - 1.0)
            px, py, pz = _corner(boxes, box, along, across, up)
            x, y, depth = _to_optical(view, px, py, pz)
            if depth <= NEAR:
                continue
            area = scale / depth**3  # image area of a small piece of a plane
            row[4] += area
            u, v = view.fx * x / depth + view.cx, view.fy * y / depth + view.cy
            if not (0.0 <= u < view.width and 0.0 <= v < view.height):
                continue
            ray = (ox, oy, oz, px - ox, py - oy, pz - oz)
            if is_hidden(boxes, hulls, clearance, room, ray, box, rivals, count):
                continue
            row[5] += area
            _stretch_cell(boxes, view, box, face, i, j, points, row)


@njit(cache=True, nogil=True, error_model="numpy")
def _stretch_cell(
    boxes: FloatArray, view: View, box: int, face: int, i: int, j: int, points: int, rectangle: FloatArray
) -> None:
    """Widen a rectangle so that it holds the four corners of a face's grid cell."""
    for di in range(2):
        for dj in range(2):
            along, across, up = _on_face(face, 2.0 * (i + di) / points - 1.0, 2.0 * (j + dj) / points - 1.0)
            px, py, pz = _corner(boxes, box, along, across, up)
            x, y, depth = _to_optical(view, px, py, pz)
            if depth > NEAR:
                _stretch(rectangle, view.fx * x / depth + view.cx, view.fy * y / depth + view.cy)
