"""What eyes make of labelled images.

A detected box shows the annotation that it overlaps by half (IoU); one that overlaps none by a third shows nothing;
the others are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.datasets import Annotation, DetectionDataset
from zavis_bt.perception.eyes import Eyes
from zavis_bt.perception.naming import may_name
from zavis_bt.types import UNKNOWN_CLASS, Box, CameraIntrinsics, FloatArray, RgbdFrame

_SHOWN, _NOT_SHOWN = 0.5, 1 / 3  # IoU
_FIELD_OF_VIEW = 1.05  # of the made-up camera of an image without one [rad]


@dataclass(frozen=True, slots=True)
class Look:
    """What eyes made of one image."""

    shows: tuple[str | None, ...]
    """(n,) category that each box shows; None for nothing."""
    scores: FloatArray
    """(n, m) of n boxes with m texts."""
    named: NDArray[np.bool_]
    """(n, m) whether the box has a known class that the text names."""
    labels: tuple[str, ...]
    """(n,) the detector's."""
    confidence: FloatArray
    """(n,) the detector's, 0 to 1."""
    present: frozenset[str]
    """Categories that are annotated, be it as ignored."""

    def without_faint(self, thresholds: Thresholds) -> Look:
        """Return what is left without the boxes that a `Perceiver` would not look at."""
        rows = zip(self.labels, self.confidence.tolist(), strict=True)
        kept = np.flatnonzero([not thresholds.is_faint(*row) for row in rows])
        return Look(
            tuple(self.shows[k] for k in kept),
            self.scores[kept],
            self.named[kept],
            tuple(self.labels[k] for k in kept),
            self.confidence[kept],
            self.present,
        )

    def matched(self, thresholds: Thresholds) -> NDArray[np.bool_]:
        """Return (n, m) whether a `Perceiver` would match the box with the text."""
        rows = zip(self.labels, self.confidence.tolist(), strict=True)
        unknown = np.array([thresholds.is_unknown(*row) for row in rows], dtype=np.bool_)
        return np.asarray(unknown[:, None] | self.named)


def look_at(eyes: Eyes, images: DetectionDataset, indices: Sequence[int], texts: Sequence[str]) -> Iterator[Look]:
    """Yield what eyes make of images, one by one.

    Args:
        eyes: Detector and matcher.
        images: Labelled.
        indices: Which of them.
        texts: What boxes are matched with.

    Raises:
        InputError: An image cannot be read.
    """
    for index in indices:
        annotations = images.annotations(index)
        frame = frame_of(images.image(index), stamp=float(index))
        boxes, labels, confidence, shows = [], [], [], []
        for found in eyes.detector.detect(frame):
            shown, sure = what_it_shows(found.box, annotations)
            if sure:
                boxes.append(found.box)
                labels.append(found.label)
                confidence.append(found.score)
                shows.append(shown)
        named = np.array([[_is_named(text, label) for text in texts] for label in labels], dtype=np.bool_)
        shape = len(boxes), len(texts)
        scores = np.asarray(eyes.matcher.match(frame, boxes, texts), dtype=np.float64) if boxes else np.empty(shape)
        present = frozenset(annotation.category for annotation in annotations)
        yield Look(tuple(shows), scores, named.reshape(shape), tuple(labels), np.array(confidence), present)


def frame_of(rgb: NDArray[np.uint8], stamp: float = 0.0) -> RgbdFrame:
    """Return an image (h, w, 3) as a frame without depth, of a camera that is made up."""
    height, width = rgb.shape[:2]
    camera = CameraIntrinsics.from_fov(width, height, _FIELD_OF_VIEW)
    return RgbdFrame(camera, np.eye(4), stamp, lambda: (rgb, np.zeros((height, width), dtype=np.float32)))


def what_it_shows(box: Box, annotations: Sequence[Annotation]) -> tuple[str | None, bool]:
    """Return the category that a box shows, None for nothing, and whether that is beyond doubt."""
    overlaps = [box.iou(annotation.box) for annotation in annotations]
    best = int(np.argmax(overlaps)) if overlaps else -1
    if best < 0 or overlaps[best] < _NOT_SHOWN:
        return None, True
    return annotations[best].category, overlaps[best] >= _SHOWN and not annotations[best].ignored


def _is_named(text: str, label: str) -> bool:
    return label != UNKNOWN_CLASS and may_name(text, label)
