"""Names as people write them, brought to one form."""

from __future__ import annotations

import re
import unicodedata

_CAMEL = re.compile(r"(?<=[0-9])(?=[A-Z][a-z])|(?<=[a-z]{2})(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_SEPARATORS = re.compile(r"[\W_]+")
_PREPOSITIONS = re.compile(
    r" (?:about|at|behind|beside|by|for|from|in|inside|near|of|on|that|to|under|which|with|without) "
)
_LONGEST = 256  # characters; longer texts are no names, and reading them must take bounded time


def normalise(text: str) -> str:
    """Return the text in lower case with single spaces: ``RemoteControl``, ``remote_control`` → ``remote control``.

    Only the first 256 characters count.
    """
    text = unicodedata.normalize("NFKC", text[:_LONGEST])
    return _SEPARATORS.sub(" ", _CAMEL.sub(" ", text)).strip().lower()


def singular(name: str) -> str:
    """Return the normalised name with its last word in the singular, by the regular rules of English."""
    if name.endswith("ies") and len(name) > 4:
        return name[:-3] + "y"
    if name.endswith(("ches", "shes", "sses", "xes", "zes")):
        return name[:-2]
    if name.endswith("s") and not name.endswith(("ss", "us")):
        return name[:-1]
    return name


def phrases(name: str) -> list[str]:
    """Return what a normalised name may be called, the most telling first.

    English puts the head of a noun phrase last and what describes it after a preposition: of ``my red wallet with
    stripes`` first come ``my red wallet``, ``red wallet`` and ``wallet``, then the parts of ``stripes``.
    """
    parts = _PREPOSITIONS.split(f" {name} ")
    words = [part.split() for part in parts]
    return [name, *(" ".join(part[start:]) for part in words for start in range(len(part)))]
