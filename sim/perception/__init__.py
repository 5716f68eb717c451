"""Detector and matcher of the simulation: they know what is in sight and err as published ones do."""

from sim.perception.curves import DetectorSettings, MatcherSettings
from sim.perception.detector import SimDetector
from sim.perception.fitted import FITTED_THRESHOLDS, FITTED_TO_NETWORKS
from sim.perception.matcher import SimMatcher

__all__ = [
    "FITTED_THRESHOLDS",
    "FITTED_TO_NETWORKS",
    "DetectorSettings",
    "MatcherSettings",
    "SimDetector",
    "SimMatcher",
]
