"""Single images to calibrate by: from folders, or from cameras while somebody moves the board."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivers.camera.video import Video
from zavis_bt.errors import DeviceError, InputError

Image = NDArray[np.uint8]
Still = tuple[str, list[Image] | None]
"""A name, and an image of each camera, or None if one cannot be read."""
_SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"}


def stills(sources: Sequence[str], side_by_side: bool, every: float) -> Iterator[Still]:
    """Return images, endlessly from live cameras.

    Args:
        sources: One or two (left, right): a folder of images, a webcam's number, a video file or a stream.
        side_by_side: Whether each image shows the left camera's beside the right one's.
        every: Time between two images of a video or camera [s].

    Raises:
        InputError: A folder is empty, or the folders do not hold equally many images.
        DeviceError: A camera or video cannot be opened, or is lost.
    """
    folders = [Path(source) for source in sources if Path(source).is_dir()]
    if folders and len(folders) < len(sources):
        raise InputError("calibrate: a folder and a camera cannot be a pair (give two of the same)")
    found = _from_folders(folders) if folders else _from_videos(sources, every)
    return (_split(still) for still in found) if side_by_side else found


def _from_folders(folders: Sequence[Path]) -> Iterator[Still]:
    files = [sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES) for folder in folders]
    for folder, found in zip(folders, files, strict=True):
        if not found:
            raise InputError(f"{folder}: holds no images ({', '.join(sorted(_SUFFIXES))})")
    if len({len(found) for found in files}) > 1:
        counts = " and ".join(str(len(found)) for found in files)
        raise InputError(f"calibrate: the folders hold {counts} images (left and right belong together by their order)")
    return ((paths[0].name, _read_all(paths)) for paths in zip(*files, strict=True))


def _read_all(paths: Sequence[Path]) -> list[Image] | None:
    import cv2

    read = [cv2.imdecode(np.frombuffer(path.read_bytes() or b"\0", np.uint8), cv2.IMREAD_COLOR) for path in paths]
    images = [np.asarray(image, dtype=np.uint8) for image in read if image is not None]
    return images if len(images) == len(paths) else None


def _from_videos(sources: Sequence[str], every: float) -> Iterator[Still]:
    videos: list[Video] = []
    try:
        for source in sources:
            videos.append(Video(int(source) if source.isdigit() else source, "calibrate"))
        skip = _pauser(videos[0], every)
        number = 0
        while True:
            try:
                for video in videos:
                    video.grab()
                if skip():
                    continue
                number += 1
                yield f"view {number}", [video.retrieve() for video in videos]
            except DeviceError:
                if videos[0].is_live:
                    raise
                return
    finally:
        for video in videos:
            video.close()


def _pauser(video: Video, every: float) -> Callable[[], bool]:
    """Return what tells, for each image taken, whether to pass it over."""
    due, count = time.monotonic(), -1
    step = max(round(every * (video.rate or 30.0)), 1)

    def skip() -> bool:
        nonlocal due, count
        if not video.is_live:
            count += 1
            return count % step != 0
        if time.monotonic() < due:
            return True
        due = time.monotonic() + every
        return False

    return skip


def _split(still: Still) -> Still:
    name, images = still
    if images is None:
        return still
    middle = images[0].shape[1] // 2
    return name, [images[0][:, :middle].copy(), images[0][:, middle : 2 * middle].copy()]
