"""The pictures of a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image

from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.evaluation.drawing import TRUTH, Mark, class_colour, draw, sheet, window
from zavis_bt.perception.evaluation.examples import Confusion, Cuts
from zavis_bt.perception.evaluation.tables import Prediction, Truth
from zavis_bt.types import UNKNOWN_CLASS, Box

_FRAME_WIDTH = 400  # of an example [px]
_PATCH = 190  # side of the picture of a miss [px]


@dataclass(frozen=True, slots=True)
class Scenes:
    """Images of a data set, with what is and what was found there."""

    dataset: DetectionDataset
    predictions: Sequence[Prediction]
    cuts: Cuts

    def examples(self, indices: Sequence[int]) -> Image.Image:
        """Return whole images with all detections above the cuts, and all things as thin white boxes."""
        found: dict[int, list[Prediction]] = {index: [] for index in indices}
        for prediction in self.predictions:
            if prediction.image in found and self.cuts.show(prediction):
                found[prediction.image].append(prediction)
        pictures = [self._frame(index, sorted(found[index], key=lambda p: p.score)) for index in indices]
        return sheet(pictures, ["" for _ in pictures], 3)

    def misses(self, truths: Sequence[Truth]) -> Image.Image:
        """Return patches around things that no box covers."""
        marks = [[Mark(truth.box, "", TRUTH)] for truth in truths]
        patches = [self._patch(truth, marked) for truth, marked in zip(truths, marks, strict=True)]
        return sheet(patches, [truth.label for truth in truths], 6)

    def confusions(self, confusions: Sequence[Confusion]) -> Image.Image:
        """Return patches around things of unknown class that were given a known name."""
        patches, captions = [], []
        for confusion in confusions:
            named = confusion.prediction
            marks = [Mark(confusion.truth.box, "", TRUTH, width=1), Mark(named.box, "", class_colour(named.label))]
            patches.append(self._patch(confusion.truth, marks))
            captions.append(f"{confusion.truth.label}: {named.label} {named.score:.2f}")
        return sheet(patches, captions, 6)

    def _frame(self, index: int, found: Sequence[Prediction]) -> Image.Image:
        rgb = self.dataset.image(index, width=_FRAME_WIDTH)
        scale = rgb.shape[1] / self.dataset.size(index)[0]
        marks = [Mark(a.box, "", TRUTH, width=1) for a in self.dataset.annotations(index) if not a.ignored]
        for prediction in found:
            unknown = prediction.label == UNKNOWN_CLASS
            text = f"{'' if unknown else prediction.label + ' '}{prediction.score:.2f}"
            marks.append(Mark(prediction.box, text, class_colour(prediction.label), dashed=unknown))
        return draw(rgb, marks, scale)

    def _patch(self, truth: Truth, marks: Sequence[Mark]) -> Image.Image:
        rgb = self.dataset.image(truth.image)
        x0, y0, x1, y1 = window(truth.box, (rgb.shape[1], rgb.shape[0]))
        scale = _PATCH / max(x1 - x0, 1)
        patch = Image.fromarray(rgb[y0:y1, x0:x1]).resize((_PATCH, _PATCH), Image.Resampling.BILINEAR)
        moved = [Mark(_moved(m.box, x0, y0), m.text, m.colour, m.dashed, m.width) for m in marks]
        return draw(patch, moved, scale)


def _moved(box: Box, x: float, y: float) -> Box:
    return Box(box.x0 - x, box.y0 - y, box.x1 - x, box.y1 - y)
