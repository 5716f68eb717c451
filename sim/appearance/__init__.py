"""How things look to the camera: a catalogue of shapes by category, and what varies from one to the next."""

from sim.appearance.catalogue import SHAPES, SYNONYMS, shape_of
from sim.appearance.look import Look
from sim.appearance.room import Covering, RoomLook
from sim.appearance.shape import Shape

__all__ = ["SHAPES", "SYNONYMS", "Covering", "Look", "RoomLook", "Shape", "shape_of"]
