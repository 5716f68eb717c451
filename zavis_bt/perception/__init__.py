"""Perception: what a frame shows, projected to the map."""

from zavis_bt.perception.landmarks import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS
from zavis_bt.perception.perceiver import Perceiver
from zavis_bt.perception.projection import Located, locate_landmark, locate_object

__all__ = [
    "DEFAULT_KNOWN_LANDMARKS",
    "DEFAULT_UNKNOWN_LANDMARKS",
    "Located",
    "Perceiver",
    "locate_landmark",
    "locate_object",
]
