"""Pictures of candidates."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from zavis_bt.recording.files import write_atomically
from zavis_bt.recording.plain import candidate_to_plain, to_json
from zavis_bt.types import Candidate

_CONTEXT = 0.6  # added on each side, as a share of the box's longer side
_MIN_SIDE = 240  # smaller cut-outs are enlarged [px]
_COLOURS = {True: (34, 160, 84), False: (226, 76, 60)}


def candidate_image(candidate: Candidate, *, accepted: bool = False) -> NDArray[np.uint8]:
    """Return the surroundings of a candidate with its box drawn in, (h, w, 3) rgb; green if it was accepted."""
    import cv2

    rgb, box = candidate.frame.rgb, candidate.box
    margin = _CONTEXT * max(box.x1 - box.x0, box.y1 - box.y0) + 8
    left, right = np.clip([box.x0 - margin, box.x1 + margin], 0, rgb.shape[1]).astype(int)
    top, bottom = np.clip([box.y0 - margin, box.y1 + margin], 0, rgb.shape[0]).astype(int)
    cut = np.ascontiguousarray(rgb[top : max(bottom, top + 1), left : max(right, left + 1)])
    scale = max(1.0, _MIN_SIDE / max(cut.shape[:2]))
    interpolation = cv2.INTER_CUBIC if scale > 1 else cv2.INTER_AREA
    image = cv2.resize(cut, None, fx=scale, fy=scale, interpolation=interpolation)
    corners = np.rint((np.array(box) - [left, top, left, top]) * scale).astype(int)
    for colour, thickness in (((255, 255, 255), 4), (_COLOURS[accepted], 2)):
        cv2.rectangle(image, corners[:2].tolist(), corners[2:].tolist(), colour, thickness)
    return np.asarray(image, dtype=np.uint8)


def encode_png(rgb: NDArray[np.uint8]) -> bytes:
    """Return an (h, w, 3) rgb image as a PNG file."""
    import cv2

    return bytes(cv2.imencode(".png", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))[1])


def write_candidates(folder: Path, candidates: Sequence[Candidate], found: Candidate | None) -> None:
    """Write ``NNN.png`` for each candidate and ``index.json``, which lists them.

    Args:
        folder: Is created if it does not exist.
        candidates: In the order they were seen.
        found: The one that was accepted, if any.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(exist_ok=True)
    index: list[dict[str, Any]] = []
    for number, candidate in enumerate(candidates):
        accepted = candidate is found or candidate == found
        name = f"{number:03d}.png"
        write_atomically(folder / name, encode_png(candidate_image(candidate, accepted=accepted)))
        index.append({"file": name, "accepted": accepted, **candidate_to_plain(candidate)})
    write_atomically(folder / "index.json", to_json(index))
