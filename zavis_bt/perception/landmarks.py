"""Names of the landmarks a home has.

Landmarks are the furniture on which things lie. The detector tells the known ones itself; the others are told by
text-image matching. A mission may name its own.
"""

from __future__ import annotations

from collections.abc import Sequence

from zavis_bt.perception.naming import key

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


def split_landmarks(names: Sequence[str], classes: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return which landmarks a detector knows, and which must be told by matching (O_k and O_u).

    Args:
        names: Of landmarks.
        classes: Known classes of the detector; usual other names of a class count, as "tv monitor" of "tv".
    """
    trained = {key(name) for name in classes}
    distinct: dict[str, str] = {}
    for name in names:
        distinct.setdefault(key(name), name)
    known = tuple(name for same, name in distinct.items() if same in trained)
    return known, tuple(name for same, name in distinct.items() if same not in trained)
