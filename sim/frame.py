"""Frames of the simulated camera: images made when asked for, and what is really in them."""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.render import Picture, measure, render
from sim.render_labels import Label, pixel_boxes, whole_pixels
from sim.render_parts import Visible, visible_parts
from sim.render_rays import IntArray
from sim.scene import Scene
from sim.visibility import Bounds, View, bounds_of, sightings
from zavis_bt.errors import InputError
from zavis_bt.types import Box, CameraIntrinsics, FloatArray, RgbdFrame


class InstanceView(NamedTuple):
    """A piece of furniture or an object as one frame shows it: ground truth, for simulated perception only."""

    id: str
    category: str
    colour: str | None
    is_furniture: bool
    box: Box
    """Around the visible part, clipped to the image [px]."""
    full_box: Box
    """Around the whole of it before the camera, not clipped [px]."""
    visible_fraction: float
    """Visible share of the silhouette's area, 0 to 1; what the image's border cuts off is not visible."""
    visible_area: float
    """Visible area [px²]."""
    distance: float
    """From the optical centre to its middle [m]."""


class SimFrame(RgbdFrame):
    """A frame that casts single rays for single depths, and knows what it shows."""

    def __init__(
        self,
        scene: Scene,
        intrinsics: CameraIntrinsics,
        true_transform: FloatArray,
        transform_camera_to_map: FloatArray,
        stamp: float,
        depth_range: tuple[float, float],
    ) -> None:
        """Describe a frame of a scene.

        Args:
            scene: What there is to see.
            intrinsics: Camera model.
            true_transform: (4, 4) camera pose in the scene.
            transform_camera_to_map: (4, 4) camera pose as the robot believes it.
            stamp: Time of capture [s].
            depth_range: Least and greatest depth the camera measures [m].
        """
        super().__init__(intrinsics, transform_camera_to_map, stamp, self._render_all)
        self._scene, self._true_transform = scene, true_transform
        self._depth_range = depth_range

    def unrendered(self) -> SimFrame:
        """Return the same frame, for which nothing is computed yet."""
        poses = self._true_transform, self.transform_camera_to_map
        return SimFrame(self._scene, self.intrinsics, *poses, self.stamp, self._depth_range)

    @cached_property
    def _view(self) -> View:
        return View.of(self._true_transform, self.intrinsics)

    @cached_property
    def _bounds(self) -> Bounds:
        return bounds_of(self._scene.solids, self._view)

    @cached_property
    def _visible(self) -> Visible:
        scene = self._scene
        return visible_parts(scene.parts, scene.wall_faces, scene.world.wall_height, self._view)

    @cached_property
    def instances(self) -> tuple[InstanceView, ...]:
        """What is in sight, at least partly, nearest first; what is smaller than a few pixels is left out."""
        scene, bounds = self._scene, self._bounds
        found = sightings(scene.solids, self._view, bounds)
        offsets = scene.solids.boxes[found.indices, :3] - self._view.position
        distances = np.sqrt((offsets**2).sum(axis=1)).tolist()
        rows = zip(
            found.indices.tolist(),
            found.boxes.tolist(),
            bounds.rectangles[found.indices].tolist(),
            found.fractions.tolist(),
            found.areas.tolist(),
            distances,
            strict=True,
        )
        return tuple(self._describe(*row) for row in rows)

    def depth_at(self, pixels: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the depth at (n, 2) pixels ``[column, row]``, casting only these rays."""
        return measure(self._scene, self._view, self._visible, pixels, self._depth_range)

    @property
    def surfaces(self) -> IntArray:
        """(h, w) what each pixel shows: index of the thing in `Scene.things`, or negative for walls, floor, nothing."""
        return self._picture.surfaces

    @property
    def labels(self) -> tuple[Label, ...]:
        """What has pixels in the image, with its exact box; unlike `instances` it asks for the whole image."""
        things, looks, furniture = self._scene.things, self._scene.looks, len(self._scene.furniture)
        boxes, pixels = pixel_boxes(self.surfaces, len(things))
        whole = whole_pixels(self._scene.parts, self._visible, self._view)
        found = []
        for k in np.flatnonzero(pixels).tolist():
            thing, box = things[k], Box(*(float(edge) for edge in boxes[k]))
            share = float(pixels[k] / max(whole[k], pixels[k]))
            found.append(Label(k, thing.id, thing.category, looks[k].colour, k < furniture, box, int(pixels[k]), share))
        return tuple(found)

    def crop(self, box: Box) -> NDArray[np.uint8]:
        """Return the patch inside the box, rendering no more than it."""
        if "_picture" in self.__dict__:
            return super().crop(box)
        width, height = self.intrinsics.width, self.intrinsics.height
        x0, y0 = int(np.clip(box.x0, 0, width - 1)), int(np.clip(box.y0, 0, height - 1))
        x1, y1 = int(np.clip(math.ceil(box.x1), x0 + 1, width)), int(np.clip(math.ceil(box.y1), y0 + 1, height))
        return self._render((x0, y0, x1, y1)).rgb

    @cached_property
    def _picture(self) -> Picture:
        return self._render((0, 0, self.intrinsics.width, self.intrinsics.height))

    def _render_all(self) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        return self._picture.rgb, self._picture.depth

    def _render(self, window: tuple[int, int, int, int]) -> Picture:
        return render(self._scene, self._view, self._visible, window, self._depth_range)

    def _describe(
        self, index: int, box: list[float], full: list[float], fraction: float, area: float, distance: float
    ) -> InstanceView:
        thing = self._scene.things[index]
        is_furniture = index < len(self._scene.furniture)
        return InstanceView(
            thing.id, thing.category, thing.colour, is_furniture, Box(*box), Box(*full), fraction, area, distance
        )


def instances_of(frame: RgbdFrame) -> tuple[InstanceView, ...]:
    """Return what a frame really shows, be it from the simulated camera at hand or from one on the network.

    Raises:
        InputError: The frame does not come from the simulated camera.
    """
    if isinstance(frame, SimFrame):
        return frame.instances
    annotations = getattr(frame, "annotations", None)  # frames off the wire have the same fields
    if annotations is None:
        kind = type(frame).__name__
        raise InputError(
            f"simulated perception: got a {kind} (it can only judge frames of the simulated camera; "
            "on a robot file's devices that is 'camera: {driver: sim}' with annotations)"
        )
    return tuple(InstanceView(*annotation) for annotation in annotations)
