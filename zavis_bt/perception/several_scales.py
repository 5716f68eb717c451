"""One detector that looks at an image at several scales."""

from __future__ import annotations

from collections.abc import Sequence

from zavis_bt.perception.boxes import suppress
from zavis_bt.protocols import Detector
from zavis_bt.types import Detection, RgbdFrame

_SAME = 0.6  # boxes that overlap more are of one thing [IoU]


class SeveralScales:
    """Joins what detectors of the same classes see: small things in the large image, large ones in the small."""

    def __init__(self, detectors: Sequence[Detector]) -> None:
        self._detectors = tuple(detectors)

    def detect(self, frame: RgbdFrame) -> list[Detection]:
        """Return what all of them see, best first; of boxes around one thing the best is kept."""
        found = [detection for detector in self._detectors for detection in detector.detect(frame)]
        return suppress(sorted(found, key=lambda one: -one.score), lambda one: one.box, _SAME)
