"""Small data sets in both forms, written by the tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

THING = """<object><name>{name}</name><difficult>{difficult}</difficult>
<part><name>leg</name><bndbox><xmin>1</xmin><ymin>1</ymin><xmax>2</xmax><ymax>2</ymax></bndbox></part>
<bndbox><xmin>{box[0]}</xmin><ymin>{box[1]}</ymin><xmax>{box[2]}</xmax><ymax>{box[3]}</ymax></bndbox></object>"""


def write_picture(path: Path, size: tuple[int, int] = (64, 48)) -> None:
    """Write an image whose red rises to the right, green downwards; blue is 200."""
    width, height = size
    red, green = np.meshgrid(np.linspace(0, 255, width), np.linspace(0, 255, height))
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), np.dstack([np.full_like(red, 200), green, red]).astype(np.uint8))


def coco(**changes: Any) -> dict[str, Any]:
    """Return a document with two images, the second one empty, and two boxes."""
    document = {
        "images": [
            {"id": 7, "file_name": "a.jpg", "width": 64, "height": 48},
            {"id": 3, "file_name": "b.jpg", "width": 64, "height": 48},
        ],
        "annotations": [
            {"id": 1, "image_id": 7, "category_id": 5, "bbox": [10, 20, 30, 15], "iscrowd": 0},
            {"id": 2, "image_id": 7, "category_id": 9, "bbox": [0, 0, 64, 48], "iscrowd": 1},
        ],
        "categories": [{"id": 5, "name": "couch"}, {"id": 9, "name": "red  thing"}],
    }
    return {**document, **changes}


def write_coco(folder: Path, document: Any = None, images: str = "images", file: str = "annotations.json") -> Path:
    for name in ("a.jpg", "b.jpg"):
        write_picture(folder / images / name)
    (folder / file).parent.mkdir(parents=True, exist_ok=True)
    (folder / file).write_text(json.dumps(coco() if document is None else document))
    return folder


def write_voc(root: Path, name: str, things: str = "", size: str | None = None) -> Path:
    write_picture(root / "JPEGImages" / f"{name}.jpg")
    (root / "Annotations").mkdir(exist_ok=True)
    size = "<size><width>64</width><height>48</height><depth>3</depth></size>" if size is None else size
    (root / "Annotations" / f"{name}.xml").write_text(f"<annotation>{size}{things}</annotation>")
    return root


def thing(name: str, box: tuple[float, float, float, float], difficult: int = 0) -> str:
    return THING.format(name=name, box=box, difficult=difficult)
