"""Images that detectors are trained and judged on: data sets, and rooms drawn by the simulator."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from zavis_bt.perception.datasets import DetectionDataset

_PREFIX = "sim:"


def open_images(data: str) -> DetectionDataset:
    """Open a data set, or draw ``sim:COUNT[:SEED]`` once and keep it.

    Raises:
        InputError: There is no such data set, or the number of images is none.
    """
    from zavis_bt.perception.datasets import open_dataset

    return open_dataset(_drawn(data) if data.startswith(_PREFIX) else data)


def _drawn(data: str) -> Path:
    from sim.labelled_frames import FrameRecipe, write_frames
    from zavis_bt.cli.detector_progress import progress_bar

    count, seed = _numbers(data)
    folder = _cache() / f"frames-{count}-{seed}"
    if folder.is_dir():
        return folder
    folder.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=folder.parent) as part, progress_bar(count, "drawing") as progress:
        for done in write_frames(Path(part) / "frames", count, FrameRecipe(seed=seed)):
            progress(done)
        (Path(part) / "frames").rename(folder)  # only whole data sets are kept
    return folder


def _numbers(data: str) -> tuple[int, int]:
    parts = data.removeprefix(_PREFIX).split(":")
    if len(parts) > 2 or not all(part.isdigit() for part in parts) or int(parts[0]) < 1:
        raise InputError(f"{data}: is no number of drawn images (sim:COUNT or sim:COUNT:SEED, as sim:2000:7)")
    return int(parts[0]), int(parts[1]) if len(parts) > 1 else 0


def _cache() -> Path:
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "zavis_bt"
