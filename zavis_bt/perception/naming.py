"""Whether two spellings name the same class."""

from __future__ import annotations

import re
from collections.abc import Sequence

_WORD = re.compile(r"[^\W_]+")
_MOST_WORDS = 64  # of a target's text that are read


def key(name: str) -> str:
    """Return the name without case, spaces and punctuation: ``diningtable`` is ``Dining table``."""
    return "".join(_words(name))


def may_name(target: str, label: str) -> bool:
    """Return whether a target's text may speak of a detector's class.

    It does if the class's name is among its words ("the red sofa" of ``sofa``, "spray bottle" of ``bottle``), or its
    last word is one of the class's name ("the tv" of ``tv monitor``).
    """
    words, label_words = _words(target), _words(label)
    return bool(words) and (_contain(words, key(label)) or words[-1] in label_words)


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
