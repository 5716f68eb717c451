"""One detector that looks at an image at several scales."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from zavis_bt.perception.boxes import suppress
from zavis_bt.protocols import Detector
from zavis_bt.types import Detection, RgbdFrame

_SAME = 0.5  # boxes that overlap more are of one thing [IoU]


class SeveralScales:
    """Joins what detectors of the same classes see: small things in the large image, large ones in the small."""

    def __init__(self, detectors: Mapping[int, Detector]) -> None:
        """Take detectors by the width that they scale larger images down to [px]; they enlarge none."""
        self._detectors = sorted(detectors.items())

    def detect(self, frame: RgbdFrame) -> list[Detection]:
        """Return what all of them see, best first; of boxes of one class around one thing the best is kept."""
        found = [
            detection for detector in self._worth_asking(frame.intrinsics.width) for detection in detector.detect(frame)
        ]
        kept: list[Detection] = []
        for label in dict.fromkeys(one.label for one in found):
            alike = sorted((one for one in found if one.label == label), key=lambda one: -one.score)
            kept += suppress(alike, lambda one: one.box, _SAME)
        return sorted(kept, key=lambda one: -one.score)

    def _worth_asking(self, width: int) -> Sequence[Detector]:
        """Return the detectors that see such images at different sizes: of those that scale none, the first."""
        smaller = sum(own < width for own, _ in self._detectors)
        return [detector for _, detector in self._detectors[: smaller + 1]]
