"""Rooms full of random things, and views of them: endless images with exact labels to train and test networks on."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from sim.appearance.catalogue import THINGS, shape_of
from sim.appearance.room import RoomLook
from sim.appearance.shape import Shape
from sim.frame import SimFrame
from sim.render_paint import COLOURS
from sim.scene import Scene
from sim.world import Furniture, World, WorldObject
from zavis_bt.geometry import transform_camera_to_map
from zavis_bt.types import FREE, OCCUPIED, CameraIntrinsics, CameraSpec, GridMap, Pose2D

_WALL, _CELL = 0.1, 0.05  # [m]
_SCALE, _PROPORTION = 0.17, 0.17  # standard deviation of the logarithms of a thing's size and of each of its sides
_FARTHEST = 0.6  # that a logarithm is from a typical thing's
_NAMED = 0.6  # share of painted things whose colour is any of the named ones, not one of the usual
_ON_FLOOR = 0.15  # share of small things that lie on the floor
_AT_WALL, _BACK_TO_WALL = 0.7, 0.95  # share of furniture that stands at a wall: with no front, and with one
_TRIES = 30


def random_world(
    rng: np.random.Generator, categories: Sequence[str] | None = None, furniture: int = 7, objects: int = 14
) -> World:
    """Return a room with furniture and objects at random places, of random sizes, colours and looks.

    Args:
        rng: Source of the draws.
        categories: What may be in it; all that has a name if None.
        furniture: Pieces that are tried to place; fewer may fit.
        objects: Small things that are tried to place on furniture and on the floor.
    """
    width, depth = rng.uniform(3.0, 6.0, 2).tolist()
    names = list(THINGS if categories is None else categories)
    standing = [name for name in names if shape_of(name).where == "floor"]
    loose = [name for name in names if shape_of(name).where == "surface"]
    grid = _room(width, depth)
    pieces: list[Furniture] = []
    for number in range(furniture if standing else 0):
        piece = _piece(rng, str(rng.choice(standing)), number, width, depth, pieces)
        pieces += [piece] if piece else []
    things: list[WorldObject] = []
    for number in range(objects if loose else 0):
        thing = _thing(rng, str(rng.choice(loose)), number, width, depth, pieces, things)
        things += [thing] if thing else []
    return World(f"room {rng.integers(1 << 30)}", grid, float(rng.uniform(2.2, 3.0)), tuple(pieces), tuple(things))


def random_frame(
    rng: np.random.Generator,
    scene: Scene,
    intrinsics: CameraIntrinsics,
    distance: tuple[float, float] = (0.5, 3.0),
    height: tuple[float, float] = (0.6, 1.4),
) -> SimFrame:
    """Return a view of a scene in which one of its things is about in the middle.

    `random_standing_frame` aims at nothing.

    Args:
        rng: Source of the draws.
        scene: What there is; its world has a free floor around the origin, as `random_world` makes it.
        intrinsics: The camera.
        distance: Of the camera from the thing, about, beyond the thing's own length [m].
        height: Of the camera [m].
    """
    things = scene.things
    x, y, z, size = 1.0, 1.0, 0.8, 0.0
    if things:
        thing = things[int(rng.integers(len(things)))]
        x, y = thing.x, thing.y
        z = thing.z + thing.size[2] / 2 if isinstance(thing, WorldObject) else thing.height / 2
        size = math.hypot(thing.length, thing.width) if isinstance(thing, Furniture) else 0.0
    eye = float(rng.uniform(*height))

    def drawn() -> Pose2D:
        bearing, reach = rng.uniform(-math.pi, math.pi), size + rng.uniform(*distance)
        return Pose2D(x - reach * math.cos(bearing), y - reach * math.sin(bearing), bearing + rng.normal(0, 0.12))

    pose = _free_pose(scene, eye, drawn)
    tilt = math.atan2(z - eye, math.hypot(pose.x - x, pose.y - y)) + rng.normal(0, 0.08)
    return _frame(scene, intrinsics, pose, eye, float(np.clip(tilt, -1.2, 0.6)))


def random_standing_frame(
    rng: np.random.Generator,
    scene: Scene,
    intrinsics: CameraIntrinsics,
    gap: tuple[float, float] = (0.35, 1.5),
    height: tuple[float, float] = (0.6, 1.4),
) -> SimFrame:
    """Return a view of a scene as a robot has it that stands before furniture and looks about.

    Nothing is aimed at: most of the furniture is beyond the image's border, and flat things on it are seen edge-on.

    Args:
        rng: Source of the draws.
        scene: What there is; without furniture the view is one of `random_frame`.
        intrinsics: The camera.
        gap: Between the camera and the furniture's outline [m].
        height: Of the camera [m].
    """
    pieces = scene.world.furniture
    if not pieces:
        return random_frame(rng, scene, intrinsics, height=height)
    eye = float(rng.uniform(*height))

    def drawn() -> Pose2D:
        piece = pieces[int(rng.integers(len(pieces)))]
        bearing = rng.uniform(-math.pi, math.pi)
        along, aside = abs(math.cos(bearing - piece.yaw)), abs(math.sin(bearing - piece.yaw))
        outline = min(piece.length / 2 / max(along, 1e-9), piece.width / 2 / max(aside, 1e-9))
        reach = outline + rng.uniform(*gap)
        x, y = piece.x - reach * math.cos(bearing), piece.y - reach * math.sin(bearing)
        return Pose2D(x, y, bearing + rng.normal(0, 0.45))

    pose = _free_pose(scene, eye, drawn)
    return _frame(scene, intrinsics, pose, eye, float(rng.uniform(-0.7, 0.1)))


def _free_pose(scene: Scene, eye: float, drawn: Callable[[], Pose2D]) -> Pose2D:
    """Return the first pose drawn that is on free floor and in nothing, or the last of some if none is."""
    for _ in range(_TRIES):
        pose = drawn()
        if scene.world.grid.state_at(pose.x, pose.y) == FREE and not _within(pose, scene.things, eye):
            break
    return pose


def _frame(scene: Scene, intrinsics: CameraIntrinsics, pose: Pose2D, eye: float, tilt: float) -> SimFrame:
    spec = CameraSpec(intrinsics, 0.0, eye, 0.1, 20.0, 10.0)
    transform = transform_camera_to_map(pose, 0.0, tilt, spec)
    return SimFrame(scene, intrinsics, transform, transform, 0.0, (0.1, 20.0))


def random_scene(rng: np.random.Generator, categories: Sequence[str] | None = None) -> Scene:
    """Return a random room in random paint and light."""
    return Scene.of(random_world(rng, categories), RoomLook.drawn(rng))


def _room(width: float, depth: float) -> GridMap:
    border = round(_WALL / _CELL)
    states = np.full((round(depth / _CELL) + 2 * border, round(width / _CELL) + 2 * border), FREE, dtype=np.int8)
    states[:border], states[-border:], states[:, :border], states[:, -border:] = (OCCUPIED,) * 4
    states.setflags(write=False)
    return GridMap(states, _CELL, (-_WALL, -_WALL))


def _colour(rng: np.random.Generator, shape: Shape) -> str | None:
    return str(rng.choice(list(COLOURS))) if rng.random() < _NAMED and shape.painted else None


def _size(rng: np.random.Generator, shape: Shape) -> list[float]:
    """Return sides about those of a typical thing: in homes, scale and proportions of a category vary by a fifth."""
    logarithms = rng.normal(0, _SCALE) + rng.normal(0, _PROPORTION, 3)
    sides: list[float] = (np.array(shape.size) * np.exp(logarithms.clip(-_FARTHEST, _FARTHEST))).tolist()
    return sides


def _piece(
    rng: np.random.Generator, category: str, number: int, width: float, depth: float, others: Sequence[Furniture]
) -> Furniture | None:
    """Return a piece of furniture, most often at a wall and with its back to it, or None if there is no place."""
    shape = shape_of(category)
    length, across, height = _size(rng, shape)
    look = _colour(rng, shape), int(rng.integers(1 << 30))
    at_wall = rng.random() < (_BACK_TO_WALL if shape.has_front else _AT_WALL)
    for _ in range(_TRIES):
        side = int(rng.integers(4))  # of the room: low x, high x, low y, high y
        turn = int(rng.integers(4)) * math.pi / 2
        yaw = turn if rng.random() < 0.8 else float(rng.uniform(-math.pi, math.pi))
        if at_wall and shape.has_front:
            yaw = math.pi / 2 if (side < 2) == _wide(shape) else 0.0
        half_x = (abs(math.cos(yaw)) * length + abs(math.sin(yaw)) * across) / 2
        half_y = (abs(math.sin(yaw)) * length + abs(math.cos(yaw)) * across) / 2
        if 2 * half_x > width or 2 * half_y > depth:
            continue
        x, y = rng.uniform(half_x, width - half_x), rng.uniform(half_y, depth - half_y)
        if at_wall:
            x = (half_x + 0.02, width - half_x - 0.02, x, x)[side]
            y = (y, y, half_y + 0.02, depth - half_y - 0.02)[side]
        reach = math.hypot(length, across) / 2
        if all(math.hypot(x - o.x, y - o.y) > 0.8 * (reach + math.hypot(o.length, o.width) / 2) for o in others):
            return Furniture(f"piece_{number}", category, x, y, yaw, length, across, height, *look)
    return None


def _thing(
    rng: np.random.Generator,
    category: str,
    number: int,
    width: float,
    depth: float,
    furniture: Sequence[Furniture],
    others: Sequence[WorldObject],
) -> WorldObject | None:
    """Return a small thing on a piece of furniture or on the floor, or None if there is no place."""
    shape = shape_of(category)
    sizes = _size(rng, shape)
    bearers = [piece for piece in furniture if shape_of(piece.category).bears]
    look = _colour(rng, shape), int(rng.integers(1 << 30))
    for _ in range(_TRIES):
        length, across, height = sizes if rng.random() < 0.5 else (sizes[1], sizes[0], sizes[2])
        if bearers and rng.random() > _ON_FLOOR:
            piece = bearers[int(rng.integers(len(bearers)))]
            if shape.has_front:  # it looks where the furniture does
                along_x = abs(math.cos(piece.yaw)) > 0.7
                length, across = sizes[:2] if along_x == _wide(shape_of(piece.category)) else (sizes[1], sizes[0])
            along = max(piece.length - max(length, across), 0.0) / 2 * rng.uniform(-1, 1)
            aside = max(piece.width - max(length, across), 0.0) / 2 * rng.uniform(-1, 1)
            cos, sin = math.cos(piece.yaw), math.sin(piece.yaw)
            x, y, z, on = (
                piece.x + cos * along - sin * aside,
                piece.y + sin * along + cos * aside,
                piece.height,
                piece.id,
            )
        else:
            x, y, z, on = rng.uniform(0.2, width - 0.2), rng.uniform(0.2, depth - 0.2), 0.0, None
            if _within(Pose2D(x, y, 0.0), furniture, 0.01):
                continue
        if all(math.hypot(x - o.x, y - o.y) > 0.4 * (length + across + o.size[0] + o.size[1]) / 2 for o in others):
            return WorldObject(f"thing_{number}", category, x, y, z, (length, across, height), on, *look)
    return None


def _wide(shape: Shape) -> bool:
    """Return whether the front of a shape is a long side of its box: beside the box's x axis, not ahead."""
    return shape.pose != "ahead"


def _within(pose: Pose2D, things: Sequence[Furniture | WorldObject], height: float) -> bool:
    """Return whether a point at a height is within or right at the box of a thing."""
    for thing in things:
        length, across, tall, yaw = (
            (thing.length, thing.width, thing.height + 0.5, thing.yaw)
            if isinstance(thing, Furniture)
            else (thing.size[0], thing.size[1], thing.z + thing.size[2], 0.0)
        )
        dx, dy = pose.x - thing.x, pose.y - thing.y
        along = math.cos(yaw) * dx + math.sin(yaw) * dy
        aside = math.cos(yaw) * dy - math.sin(yaw) * dx
        if abs(along) < length / 2 + 0.1 and abs(aside) < across / 2 + 0.1 and height < tall + 0.05:
            return True
    return False
