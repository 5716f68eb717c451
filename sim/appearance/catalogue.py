"""Which shape things of a category have."""

from __future__ import annotations

import hashlib
from functools import lru_cache

from sim.appearance import furniture, kitchen, leisure, office, seats_and_beds, household, wear
from sim.appearance.shape import Part, Pattern, Shape, ball, box, rod, shape

GROUPS = (seats_and_beds, furniture, kitchen, office, leisure, household, wear)
SHAPES: dict[str, Shape] = {name: one for group in GROUPS for name, one in group.SHAPES.items()}
"""All shapes by category."""
SYNONYMS: dict[str, str] = {
    "couch": "sofa", "loveseat": "sofa", "dining chair": "chair", "arm chair": "armchair", "bar stool": "stool", "footstool": "ottoman",
    "pouf": "ottoman", "table": "dining table", "kitchen table": "dining table", "nightstand": "side table", "night stand": "side table",
    "bedside table": "side table", "end table": "side table", "chest of drawers": "dresser", "commode": "dresser", "drawers": "drawer",
    "bookshelf": "shelf", "bookcase": "shelf", "shelves": "shelf", "cupboard": "cabinet", "wardrobe": "cabinet", "closet": "cabinet",
    "counter": "countertop", "counter top": "countertop", "kitchen counter": "countertop", "sideboard": "tv stand", "television stand": "tv stand",
    "refrigerator": "fridge", "stove": "oven", "washer": "washing machine", "trash can": "garbage can", "waste basket": "garbage can",
    "bin": "garbage can", "dustbin": "garbage can", "standing lamp": "floor lamp", "house plant": "plant", "houseplant": "plant",
    "potted plant": "plant", "picture": "painting", "television": "tv", "tv monitor": "tv", "tvmonitor": "tv", "monitor": "computer monitor",
    "table lamp": "desk lamp", "lamp": "desk lamp", "glass": "tumbler", "wine bottle": "bottle", "water bottle": "bottle",
    "soap bottle": "spray bottle", "coffee cup": "mug", "coffee mug": "mug", "tea cup": "cup", "teacup": "cup", "saucepan": "pot", "frying pan": "pan",
    "teapot": "kettle", "tea kettle": "kettle", "loaf": "bread", "loaf of bread": "bread", "notebook": "book", "magazine": "newspaper",
    "computer": "laptop", "notebook computer": "laptop", "mobile phone": "cell phone", "phone": "cell phone", "cellphone": "cell phone", "smartphone": "cell phone",
    "remote": "remote control", "tv remote": "remote control", "clock": "alarm clock", "wristwatch": "watch", "wrist watch": "watch",
    "keys": "key chain", "key": "key chain", "keychain": "key chain", "bank card": "credit card", "compact disc": "cd", "dvd": "cd", "ballpoint pen": "pen",
    "cushion": "pillow", "dish cloth": "cloth", "rag": "cloth", "dishcloth": "cloth", "hand towel": "towel", "bath towel": "towel", "teddy": "teddy bear",
    "stuffed bear": "teddy bear", "figurine": "statue", "sculpture": "statue", "cardboard box": "box", "carton": "box", "tissues": "tissue box",
    "box of tissues": "tissue box", "basketball": "basket ball", "ball": "basket ball", "football": "soccer ball", "bat": "baseball bat",
    "racket": "tennis racket", "racquet": "tennis racket", "boot": "boots", "shoes": "shoe", "sneaker": "shoe", "sneakers": "shoe", "cap": "hat",
    "rucksack": "backpack", "purse": "wallet", "hand bag": "handbag", "bag": "handbag", "soap": "soap bar", "bar of soap": "soap bar",
    "toilet roll": "toilet paper", "eyeglasses": "glasses", "spectacles": "glasses", "salt": "salt shaker", "pepper shaker": "salt shaker",
    "computer keyboard": "keyboard", "computer mouse": "mouse", "banknote": "credit card", "flower": "flowers", "bouquet": "flowers",
}  # fmt: skip
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
        parts.append(make((-width, width), (-width, width), (k / count, (k + 1) / count), paint, pattern if k == 1 else None))
    return shape(tuple(parts), size=(0.2, 0.2, 0.2))
