"""Small data sets that a detector learns from in seconds: bright discs and dark squares on grey."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np

KNOWN = ("disc", "square")
_THING = "<object><name>{}</name><bndbox><xmin>{}</xmin><ymin>{}</ymin><xmax>{}</xmax><ymax>{}</ymax></bndbox></object>"


def draw(
    rng: np.random.Generator, size: tuple[int, int] = (160, 120)
) -> tuple[np.ndarray, list[tuple[str, list[int]]]]:
    """Return an image and its things as names and ``x, y, width, height``."""
    width, height = size
    image = rng.normal(120, 6, (height, width, 3)).clip(0, 255).astype(np.uint8)
    things = []
    for column in range(2):
        side = int(rng.integers(24, 48))
        x, y = column * width // 2 + int(rng.integers(4, 24)), int(rng.integers(4, height - side - 4))
        name = str(rng.choice(KNOWN))
        if name == "disc":
            cv2.circle(image, (x + side // 2, y + side // 2), side // 2, (40, 220, 240), -1)
        else:
            cv2.rectangle(image, (x, y), (x + side, y + side), (30, 20, 90), -1)
        things.append((name, [x, y, side, side]))
    return image, things


def write_coco_scenes(folder: Path, count: int = 6) -> Path:
    """Write a data set in COCO's form."""
    rng = np.random.default_rng(0)
    images, annotations = [], []
    (folder / "images").mkdir(parents=True)
    for number in range(count):
        image, things = draw(rng)
        name = f"images/{number}.jpg"
        cv2.imwrite(str(folder / name), image)
        images.append({"id": number, "file_name": name, "width": 160, "height": 120})
        for thing, box in things:
            category = KNOWN.index(thing) + 1
            annotations.append(
                {"id": len(annotations) + 1, "image_id": number, "category_id": category, "bbox": box, "iscrowd": 0}
            )
    categories = [{"id": number, "name": name} for number, name in enumerate(KNOWN, start=1)]
    document = {"images": images, "annotations": annotations, "categories": categories}
    (folder / "annotations.json").write_text(json.dumps(document))
    return folder


def write_voc_scenes(folder: Path, count: int = 6) -> Path:
    """Write a data set in Pascal VOC's form."""
    rng = np.random.default_rng(1)
    for name in ("JPEGImages", "Annotations"):
        (folder / name).mkdir(parents=True)
    for number in range(count):
        image, things = draw(rng)
        cv2.imwrite(str(folder / "JPEGImages" / f"{number:06d}.jpg"), image)
        rows = "".join(_THING.format(name, x + 1, y + 1, x + w, y + h) for name, (x, y, w, h) in things)
        size = "<size><width>160</width><height>120</height><depth>3</depth></size>"
        (folder / "Annotations" / f"{number:06d}.xml").write_text(f"<annotation>{size}{rows}</annotation>")
    return folder
