"""Names of the landmarks a home has.

Landmarks are the furniture on which things lie. The detector tells the known ones itself; the others are told by
text-image matching. A mission may name its own.
"""

from __future__ import annotations

DEFAULT_KNOWN_LANDMARKS = ("tv monitor", "sofa", "dining table")
"""Classes the open-set detector was trained on (the paper's, out of Pascal VOC's 20)."""

DEFAULT_UNKNOWN_LANDMARKS = (
    "armchair",
    "bed",
    "coffee table",
    "desk",
    "drawer",
    "side table",
    "cabinet",
    "countertop",
    "dresser",
    "garbage can",
    "ottoman",
    "shelf",
    "tv stand",
)
"""The paper's six unknown landmarks, then what else a home has.

A box takes the best name on offer, so the list should also hold what is seldom searched but often seen: without
``garbage can`` every bin is an ottoman.
"""
