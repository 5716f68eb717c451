"""Whether two spellings name the same class."""

from __future__ import annotations

import re
from collections.abc import Sequence

_WORD = re.compile(r"[^\W_]+")
_MOST_WORDS = 64  # of a target's text that are read
_ALSO_CALLED = {
    "tv": ("tvmonitor", "television"),
    "sofa": ("couch",),
    "plant": ("pottedplant", "houseplant"),
    "motorbike": ("motorcycle",),
    "aeroplane": ("airplane",),
    "fridge": ("refrigerator",),
    "cellphone": ("mobilephone",),
}
_SAME = {other: name for name, others in _ALSO_CALLED.items() for other in others}


def key(name: str) -> str:
    """Return what is alike for all spellings of a class's name.

    Case, spaces and punctuation do not matter, and data sets' different names of one class are one: ``diningtable``
    is ``Dining table``, Pascal VOC's ``tvmonitor`` and COCO's ``tv`` are the same.
    """
    joined = "".join(_words(name))
    return _SAME.get(joined, joined)


def may_name(target: str, label: str) -> bool:
    """Return whether a target's text may speak of a detector's class.

    It does if the class's name is among its words ("the red sofa" of ``sofa``, "spray bottle" of ``bottle``), or its
    last word is one of the class's name ("the tv" of ``tv monitor``). Usual other names of the class count ("couch").
    """
    words, label_words = _words(target), _words(label)
    names = (key(label), *_ALSO_CALLED.get(key(label), ()))
    return bool(words) and (any(_contain(words, name) for name in names) or words[-1] in label_words)


def _words(text: str) -> list[str]:
    return [match.group().lower() for _, match in zip(range(_MOST_WORDS), _WORD.finditer(text), strict=False)]


def _contain(words: Sequence[str], joined: str) -> bool:
    """Return whether neighbouring words, written together, give ``joined``."""
    for start in range(len(words)):
        run = ""
        for word in words[start:]:
            run += word
            if run == joined:
                return True
            if len(run) >= len(joined):
                break
    return False
