"""How names are put to a CLIP model: "a photo of [object]", and the prompts that tell things from background."""

from __future__ import annotations

import re

BACKGROUND_PROMPTS = ("background", "road scene", "house scene")
"""The first b = 3 prompts of the paper's set S."""

OBJECT_PROMPTS = (
    "animal",
    "fashion accessory",
    "transport",
    "traffic sign",
    "home appliance",
    "food",
    "sport equipment",
    "furniture",
    "office supplies",
    "electronics",
    "kitchenware",
)
"""The other eleven prompts of S: kinds of things."""

_PHOTO = "a photo of"
_ARTICLE = re.compile(r"^(?:the|a|an|my|your|our|some)\s+(?=\S)", re.IGNORECASE)


def photo_of(text: str) -> str:
    """Return the paper's prompt for a name: ``the red wallet`` becomes ``a photo of red wallet``.

    Articles and possessives in front are dropped, so that all ways to ask for a thing score alike. A text that is a
    prompt already stays as it is.
    """
    text = " ".join(text.split())
    if text.lower().startswith((_PHOTO + " ", "a picture of ", "an image of ")):
        return text
    return f"{_PHOTO} {_ARTICLE.sub('', text)}"
