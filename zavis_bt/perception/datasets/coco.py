"""Data sets in COCO's form: one JSON file that lists images, boxes and categories."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets.files import located
from zavis_bt.perception.datasets.names import project_name
from zavis_bt.perception.datasets.table import Columns, TableDataset

Records = Sequence[dict[str, Any]]


def open_coco(file: Path) -> TableDataset:
    """Open a data set in COCO's form.

    ``iscrowd`` boxes are ignored ones. Two fields more than COCO's are understood: ``colour`` and
    ``visible_fraction`` of an annotation, and ``rendered`` of ``info``.

    Args:
        file: The annotations. Images lie relative to it, in ``images/`` beside it, or as in COCO itself, where
            ``annotations/instances_val2017.json`` belongs to ``val2017/``.

    Raises:
        InputError: The file cannot be read or is not of this form, an image is missing, a category has no name, or
            a box lies outside its image.
    """
    document = _read(file)
    images, boxes = _list(file, document, "images"), _list(file, document, "annotations")
    names = _names(file, _list(file, document, "categories"))
    numbers = _numbers(file, images)
    info = document.get("info")
    return TableDataset(
        str(file),
        located(file, _places(file), [str(name) for name in _column(file, "images", images, "file_name")]),
        _sizes(file, images),
        _columns(file, boxes, numbers, names),
        lambda k: _place(file, boxes, images, numbers, k),
        rendered=isinstance(info, dict) and bool(info.get("rendered")),
        categories=tuple(names.values()),
    )


def _read(file: Path) -> dict[str, Any]:
    try:
        document = json.loads(file.read_bytes())
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not UTF-8 text") from error
    except json.JSONDecodeError as error:
        raise InputError(f"{file}:{error.lineno}: is not JSON: {error.msg} (is the file cut off?)") from error
    except RecursionError as error:
        raise InputError(f"{file}: is nested too deeply for COCO's form") from error
    if not isinstance(document, dict):
        raise InputError(f"{file}: should hold images, annotations and categories, as COCO's files")
    return document


def _list(file: Path, document: dict[str, Any], part: str) -> Records:
    records = document.get(part)
    if not isinstance(records, list):
        raise InputError(f"{file}: {part}: is missing or no list (COCO's files have images, annotations, categories)")
    for k, record in enumerate(records):
        if not isinstance(record, dict):
            raise InputError(f"{file}: {part}[{k}]: should hold keys and values")
    return records


def _column(file: Path, part: str, records: Records, key: str) -> list[Any]:
    try:
        return [record[key] for record in records]
    except KeyError:
        k = next(k for k, record in enumerate(records) if key not in record)
        raise InputError(f"{file}: {part}[{k}]: key '{key}' is missing") from None


def _floats(file: Path, part: str, key: str, values: list[Any], width: int) -> NDArray[np.float64]:
    """Return rows of ``width`` numbers as an array (n, width)."""
    for k, value in enumerate(values):
        if type(value) is not list or len(value) != width or not all(type(x) in (int, float) for x in value):
            raise InputError(f"{file}: {part}[{k}]: {key} should be {width} numbers, not {str(value)[:60]}")
    return np.array(values, dtype=np.float64).reshape(-1, width)


def _names(file: Path, categories: Records) -> dict[int, str]:
    ids = _column(file, "categories", categories, "id")
    names = _column(file, "categories", categories, "name")
    for k, name in enumerate(names):
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"{file}: categories[{k}]: should have a name, not {name!r}")
    return {number: project_name(name) for number, name in zip(ids, names, strict=True)}


def _numbers(file: Path, images: Records) -> dict[Any, int]:
    """Return the index of each image by its id."""
    numbers = {number: index for index, number in enumerate(_column(file, "images", images, "id"))}
    if len(numbers) != len(images):
        raise InputError(f"{file}: images: two have the same id (each needs its own)")
    return numbers


def _sizes(file: Path, images: Records) -> NDArray[np.intp]:
    pairs = zip(_column(file, "images", images, "width"), _column(file, "images", images, "height"), strict=True)
    sizes = _floats(file, "images", "width and height", [list(pair) for pair in pairs], 2)
    wrong = np.flatnonzero(~np.all(sizes >= 1, axis=1))
    if len(wrong):
        raise InputError(f"{file}: images[{wrong[0]}]: has no area")
    return sizes.astype(np.intp)


def _columns(file: Path, boxes: Records, numbers: dict[Any, int], names: dict[int, str]) -> Columns:
    image = _looked_up(file, boxes, "image_id", numbers, "image")
    category = _looked_up(file, boxes, "category_id", names, "name among the categories")
    box = _floats(file, "annotations", "bbox", _column(file, "annotations", boxes, "bbox"), 4)
    box[:, 2:] += box[:, :2]
    visible = [[record.get("visible_fraction", 1.0)] for record in boxes]
    return Columns(
        np.array(image, dtype=np.intp),
        box,
        category,
        np.array([bool(record.get("iscrowd")) for record in boxes], dtype=np.bool_),
        [record.get("colour") for record in boxes],
        _floats(file, "annotations", "visible_fraction", visible, 1)[:, 0],
    )


def _looked_up(file: Path, boxes: Records, key: str, table: dict[Any, Any], what: str) -> list[Any]:
    ids = _column(file, "annotations", boxes, key)
    try:
        return [table[number] for number in ids]
    except (KeyError, TypeError):
        k = next(k for k, number in enumerate(ids) if not isinstance(number, int) or number not in table)
        raise InputError(f"{file}: annotations[{k}]: {key} {ids[k]} has no {what}") from None


def _places(file: Path) -> list[Path]:
    """Return the folders that image names may be relative to, likeliest first."""
    split = file.stem.rpartition("_")[2]
    root = file.parent.parent
    return [file.parent, file.parent / "images", root / split, root / "images" / split, root / "images", root]


def _place(file: Path, boxes: Records, images: Records, numbers: dict[Any, int], k: int) -> str:
    name = images[numbers[boxes[k]["image_id"]]]["file_name"]
    return f"{file}: annotation {boxes[k].get('id', k)} of {name}"
