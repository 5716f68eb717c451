"""Perception: what a frame shows, projected to the map."""

from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.eyes import Eyes, EyesFactory, EyesSettings, open_eyes
from zavis_bt.perception.landmarks import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS, split_landmarks
from zavis_bt.perception.perceiver import Perceiver
from zavis_bt.perception.projection import Located, locate_landmark, locate_object

__all__ = [
    "DEFAULT_KNOWN_LANDMARKS",
    "DEFAULT_UNKNOWN_LANDMARKS",
    "Eyes",
    "EyesFactory",
    "EyesSettings",
    "Located",
    "Perceiver",
    "Thresholds",
    "locate_landmark",
    "locate_object",
    "open_eyes",
    "split_landmarks",
]
