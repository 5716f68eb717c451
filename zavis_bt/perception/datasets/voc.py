"""Data sets in Pascal VOC's form: an XML file for each image."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.datasets.names import project_name
from zavis_bt.perception.datasets.pictures import picture_size
from zavis_bt.perception.datasets.table import Columns, TableDataset

_KINDS = (".jpg", ".jpeg", ".png")


class _Thing(NamedTuple):
    category: str
    box: tuple[float, float, float, float]
    difficult: bool


def open_voc(root: Path, split: str | None = None) -> TableDataset:
    """Open a data set in Pascal VOC's form.

    ``difficult`` objects are ignored ones. Boxes, whose pixels count from 1 and include the last, become edges that
    count from 0.

    Args:
        root: Folder with ``Annotations/*.xml`` and ``JPEGImages/``.
        split: Name of a list in ``ImageSets/Main/``; all annotated images if it is not given.

    Raises:
        InputError: The split, an image or an annotation is missing, an XML file is corrupt or not of this form, or a
            box lies outside its image.
    """
    names = _all_names(root) if split is None else _names_of(root, split)
    files = _files(root, names)
    sizes: list[tuple[int, int]] = []
    things: list[_Thing] = []
    image: list[int] = []
    number: list[int] = []
    for index, (name, file) in enumerate(zip(names, files, strict=True)):
        where = root / "Annotations" / f"{name}.xml"
        tree = _parse(where)
        sizes.append(_size(where, tree) or picture_size(file))
        found = [_thing(where, k, element) for k, element in enumerate(tree.iterfind("object"), start=1)]
        things += found
        image += [index] * len(found)
        number += range(1, len(found) + 1)
    columns = Columns(
        np.array(image, dtype=np.intp),
        np.array([thing.box for thing in things], dtype=np.float64).reshape(-1, 4),
        [thing.category for thing in things],
        np.array([thing.difficult for thing in things], dtype=np.bool_),
    )
    return TableDataset(
        f"{root}:{split}" if split else str(root),
        files,
        np.array(sizes, dtype=np.intp).reshape(-1, 2),
        columns,
        lambda k: f"{root / 'Annotations' / names[image[k]]}.xml: object {number[k]}",
    )


def _all_names(root: Path) -> list[str]:
    return sorted(file.stem for file in (root / "Annotations").glob("*.xml"))


def _names_of(root: Path, split: str) -> list[str]:
    folder = root / "ImageSets" / "Main"
    try:
        lines = (folder / f"{split}.txt").read_text(encoding="utf-8").splitlines()
    except OSError as error:
        splits = [file.stem for file in folder.glob("*.txt")]
        raise InputError(f"{folder}: has no list {split}.txt{did_you_mean(split, splits)}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{folder / split}.txt: is not UTF-8 text") from error
    return [line.split()[0] for line in lines if line.strip()]


def _files(root: Path, names: Sequence[str]) -> list[Path]:
    folder = root / "JPEGImages"
    present = {file.stem: file for file in folder.iterdir() if file.suffix.lower() in _KINDS} if folder.is_dir() else {}
    missing = next((name for name in names if name not in present), None)
    if missing is not None:
        raise InputError(f"{root}: image {missing}.jpg is missing (looked in {folder})")
    return [present[name] for name in names]


def _parse(where: Path) -> ElementTree.Element:
    try:
        return ElementTree.fromstring(where.read_bytes())
    except OSError as error:
        raise InputError(f"{where}: cannot be read: {error.strerror}") from error
    except (ElementTree.ParseError, ValueError) as error:  # ValueError: an encoding that is not known
        raise InputError(f"{where}: is not XML: {error}") from error


def _size(where: Path, tree: ElementTree.Element) -> tuple[int, int] | None:
    """Return width and height, or None if the file does not tell (some tools write 0)."""
    texts = [tree.findtext(f"size/{side}") or "0" for side in ("width", "height")]
    try:
        width, height = (int(float(text)) for text in texts)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{where}: size: {' × '.join(texts)} is not a number of pixels") from error
    return (width, height) if width > 0 and height > 0 else None


def _thing(where: Path, k: int, element: ElementTree.Element) -> _Thing:
    name = (element.findtext("name") or "").strip()
    if not name:
        raise InputError(f"{where}: object {k}: has no name")
    texts = [element.findtext(f"bndbox/{side}") for side in ("xmin", "ymin", "xmax", "ymax")]
    try:
        x0, y0, x1, y1 = (float(text or "") for text in texts)
    except ValueError as error:
        raise InputError(f"{where}: object {k}: bndbox should have numbers xmin, ymin, xmax and ymax") from error
    difficult = (element.findtext("difficult") or "0").strip() not in ("0", "")
    return _Thing(project_name(name), (x0 - 1, y0 - 1, x1, y1), difficult)
