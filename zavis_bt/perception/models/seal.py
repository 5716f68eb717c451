"""Seal the weights that come along: ``python -m zavis_bt.perception.models.seal`` after they were trained anew."""

from __future__ import annotations

from pathlib import Path

from zavis_bt.perception.models.forms import check_form
from zavis_bt.perception.models.manifest import WEIGHTS, manifest
from zavis_bt.perception.models.seals import Seal, sums_of, write_seal


def seal_weights(folder: Path = WEIGHTS) -> Seal:
    """Check the form of the weights that come along, and write their sizes and checksums beside them.

    Raises:
        InputError: One of them is of another form than it should be.
    """
    for entry in manifest().values():
        if entry.shipped and (folder / entry.shipped).exists():
            check_form(folder / entry.shipped, entry.form)
    seal = Seal(source="trained by this project", files=sums_of(folder))
    write_seal(folder, seal)
    return seal


if __name__ == "__main__":
    for name, file in seal_weights().files.items():
        print(f"{file.sha256}  {file.size:>10,}  {name}")
