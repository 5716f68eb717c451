"""Where the images of a data set lie."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from zavis_bt.errors import InputError


def located(where: Path, places: Sequence[Path], names: Sequence[str]) -> list[Path]:
    """Return the files of these names, all relative to the first of the places that has the first one.

    Folders are listed once each, which is far quicker than to ask for every file.

    Raises:
        InputError: A file is missing.
    """
    if not names:
        return []
    root = next((place for place in places if (place / names[0]).is_file()), None)
    if root is None:
        looked = ", ".join(str(place) for place in dict.fromkeys(places))
        raise InputError(f"{where}: image {names[0]} is missing (looked in {looked})")
    present: dict[Path, frozenset[str]] = {}
    files = [root / name for name in names]
    for name, file in zip(names, files, strict=True):
        folder = file.parent
        if folder not in present:
            present[folder] = frozenset(os.listdir(folder)) if folder.is_dir() else frozenset()
        if file.name not in present[folder]:
            raise InputError(f"{where}: image {name} is missing (looked in {root})")
    return files
