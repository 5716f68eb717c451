"""How things look to the camera: a catalogue of shapes by category, and what varies from one to the next."""

from typing import TYPE_CHECKING, Any

from sim.appearance.catalogue import SHAPES, SYNONYMS, THINGS, shape_of
from sim.appearance.effects import CameraEffects
from sim.appearance.look import Look, look_of
from sim.appearance.room import Covering, RoomLook
from sim.appearance.shape import Shape

if TYPE_CHECKING:
    from sim.appearance.random_rooms import random_frame, random_scene, random_standing_frame, random_world

__all__ = [
    "SHAPES",
    "SYNONYMS",
    "THINGS",
    "CameraEffects",
    "Covering",
    "Look",
    "RoomLook",
    "Shape",
    "look_of",
    "random_frame",
    "random_scene",
    "random_standing_frame",
    "random_world",
    "shape_of",
]


def __getattr__(name: str) -> Any:
    # Random rooms are scenes, and scenes need the catalogue: they are loaded when asked for.
    if name.startswith("random_") and name in __all__:
        from sim.appearance import random_rooms

        return getattr(random_rooms, name)
    raise AttributeError(f"module 'sim.appearance' has no attribute '{name}'")
