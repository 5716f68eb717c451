"""Which shape things of a category have."""

from __future__ import annotations

import hashlib
from functools import lru_cache

from sim.appearance import furniture, household, kitchen, leisure, office, seats_and_beds, wear
from sim.appearance.shape import Part, Pattern, Shape, ball, box, rod, shape

GROUPS = (seats_and_beds, furniture, kitchen, office, leisure, household, wear)
SHAPES: dict[str, Shape] = {name: one for group in GROUPS for name, one in group.SHAPES.items()}
"""All shapes by category."""
THINGS = tuple(name for name in SHAPES if name != "obstacle")
"""Categories that people have a word for; a plain block is what is left when there is none."""
_ALSO_CALLED = {
    "sofa": "couch, loveseat", "chair": "dining chair", "armchair": "arm chair", "stool": "bar stool",
    "ottoman": "footstool, pouf", "dining table": "table, kitchen table",
    "side table": "nightstand, night stand, bedside table, end table", "dresser": "chest of drawers, commode",
    "drawer": "drawers", "shelf": "bookshelf, bookcase, shelves", "cabinet": "cupboard, wardrobe, closet",
    "countertop": "counter, counter top, kitchen counter", "tv stand": "sideboard, television stand",
    "fridge": "refrigerator", "oven": "stove", "washing machine": "washer",
    "garbage can": "trash can, waste basket, bin, dustbin", "floor lamp": "standing lamp",
    "plant": "house plant, houseplant, potted plant", "painting": "picture",
    "tv": "television, tv monitor, tvmonitor", "computer monitor": "monitor", "desk lamp": "table lamp, lamp",
    "tumbler": "glass", "bottle": "wine bottle, water bottle", "spray bottle": "soap bottle",
    "mug": "coffee cup, coffee mug", "cup": "tea cup, teacup", "pot": "saucepan", "pan": "frying pan",
    "kettle": "teapot, tea kettle", "bread": "loaf, loaf of bread", "book": "notebook", "newspaper": "magazine",
    "laptop": "computer, notebook computer", "cell phone": "mobile phone, phone, cellphone, smartphone",
    "remote control": "remote, tv remote", "alarm clock": "clock", "watch": "wristwatch, wrist watch",
    "key chain": "keys, key, keychain", "credit card": "bank card, banknote", "cd": "compact disc, dvd",
    "pen": "ballpoint pen", "pillow": "cushion", "cloth": "dish cloth, rag, dishcloth",
    "towel": "hand towel, bath towel", "teddy bear": "teddy, stuffed bear", "statue": "figurine, sculpture",
    "box": "cardboard box, carton", "tissue box": "tissues, box of tissues", "basket ball": "basketball, ball",
    "soccer ball": "football", "baseball bat": "bat", "tennis racket": "racket, racquet", "boots": "boot",
    "shoe": "shoes, sneaker, sneakers", "hat": "cap", "backpack": "rucksack", "wallet": "purse",
    "handbag": "hand bag, bag", "soap bar": "soap, bar of soap", "toilet paper": "toilet roll",
    "glasses": "eyeglasses, spectacles", "salt shaker": "salt, pepper shaker", "keyboard": "computer keyboard",
    "mouse": "computer mouse", "flowers": "flower, bouquet",
}  # fmt: skip
SYNONYMS: dict[str, str] = {other: name for name, others in _ALSO_CALLED.items() for other in others.split(", ")}
"""Other names of the same things."""


def normal(category: str) -> str:
    """Return a category in lower case, its words set apart by single blanks."""
    return " ".join(category.lower().replace("_", " ").replace("-", " ").split())


@lru_cache(maxsize=1024)
def shape_of(category: str) -> Shape:
    """Return how things of a category look; one that is not in the catalogue has a shape made from its name."""
    name = normal(category)
    name = SYNONYMS.get(name, name)
    found = SHAPES.get(name)
    if found is None:  # "kitchen chair" is a chair
        found = next((SHAPES[end] for end in _endings(name) if end in SHAPES), None)
    return found or _made_up(name)


def _endings(name: str) -> list[str]:
    words = name.split()
    endings = [" ".join(words[k:]) for k in range(1, len(words))]
    return [SYNONYMS.get(one, one) for one in endings]


def _made_up(name: str) -> Shape:
    """Return the shape of something never heard of: two to four blocks, cylinders or balls on one another."""
    draw = hashlib.blake2b(name.encode(), digest_size=16).digest()
    count = 2 + draw[0] % 3
    widths = [1.0 - 0.12 * (draw[1 + k] % 5) for k in range(count)]
    widths[draw[6] % count] = 1.0
    pattern = Pattern(("checks", "stripes", "dots", "bands")[draw[7] % 4], "accent", (3, 3))
    parts: list[Part] = []
    for k, width in enumerate(widths):
        make = (box, rod, ball)[draw[8 + k] % 3] if 0 < k < count - 1 else (box, rod)[draw[8 + k] % 2]
        paint = ("body", "trim")[k % 2]
        parts.append(
            make((-width, width), (-width, width), (k / count, (k + 1) / count), paint, pattern if k == 1 else None)
        )
    return shape(tuple(parts), size=(0.2, 0.2, 0.2))
