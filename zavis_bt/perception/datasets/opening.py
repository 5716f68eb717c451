"""Data sets by their path."""

from __future__ import annotations

from pathlib import Path

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.datasets.coco import open_coco
from zavis_bt.perception.datasets.dataset import DetectionDataset
from zavis_bt.perception.datasets.voc import open_voc

_FORMS = "a folder with annotations.json or Annotations/*.xml, or a JSON file in COCO's form"


def open_dataset(path: str | Path) -> DetectionDataset:
    """Open a data set of labelled images.

    Args:
        path: One of

            - a folder with ``annotations.json``, as `zavis sim frames` writes it;
            - a JSON file in COCO's form, ``coco/annotations/instances_val2017.json``, or for short ``coco:val2017``;
            - a folder in Pascal VOC's form, ``VOC2007``, or one list of it, ``VOC2007:trainval``.

    Raises:
        InputError: There is no such data set, or it has a fault.
    """
    whole = Path(path)
    if whole.exists():
        return _open(whole, None)
    folder, colon, split = str(path).rpartition(":")
    if colon and Path(folder).is_dir():
        return _open(Path(folder), split)
    raise InputError(f"{path}: there is no such data set (name {_FORMS})")


def _open(path: Path, split: str | None) -> DetectionDataset:
    if path.is_file():
        return open_coco(path)
    if (path / "Annotations").is_dir():
        return open_voc(path, split)
    if split is None and (path / "annotations.json").is_file():
        return open_coco(path / "annotations.json")
    files = sorted((path / "annotations").glob("*.json"))
    if files:
        return open_coco(_of_split(path, files, split))
    raise InputError(f"{path}: is no data set (name {_FORMS})")


def _of_split(path: Path, files: list[Path], split: str | None) -> Path:
    """Return the file with the boxes of a split: ``instances_val2017.json`` of val2017."""
    splits = {file.stem.removeprefix("instances_"): file for file in files}
    if split is None:
        raise InputError(f"{path}: has several parts (name one, {path}:{next(iter(splits))}, or a file)")
    if split not in splits:
        raise InputError(f"{path}: has no part '{split}'{did_you_mean(split, splits)}")
    return splits[split]
