"""From one frame to landmarks and candidates."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.perception.boxes import clip, suppress, touches_border
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.landmarks import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS
from zavis_bt.perception.naming import key, may_name
from zavis_bt.perception.projection import Located, locate_landmark, locate_object
from zavis_bt.protocols import Detector, Matcher
from zavis_bt.types import (
    UNKNOWN_CLASS,
    Box,
    Candidate,
    Detection,
    FloatArray,
    LandmarkSighting,
    Percept,
    RgbdFrame,
)

_SAME = 0.7  # boxes that overlap more show the same thing [IoU]
_CUT_OFF = 0.5  # what a sighting cut off by the image's edge keeps of its score: its middle and radius are biased

Distribution = tuple[tuple[str, float], ...]


class Perceiver:
    """The paper's detection module: open-set detection, text-image matching, projection to the map.

    - A box of a known landmark class is a sighting with the detector's class probabilities, restricted to the known
      landmarks.
    - An ``unknown`` box is matched with the names of the unknown landmarks and with the target, in one call of the
      matcher a frame. If its score for the target is at least m_t, it is a candidate. If not, and its best landmark's
      score is at least the landmarks' threshold and it is as large as furniture, it is a sighting with
      softmax(m / T_o) over the names.
    - Both are projected with the depth and camera pose of this very frame. What has no depth is left out: it could
      be neither drawn on the map nor driven to, and is seen again from nearer.

    Deviations from the paper, which matches ``unknown`` boxes only and makes a landmark of each: boxes of a known
    class that the target's text names ("the sofa", "spray bottle" for ``bottle``) are matched with the target, too,
    as the user may ask for what the detector happens to know; a box whose class the detector is not sure of is told by
    matching with the names of all landmarks; what matches the target, matches no landmark's name or
    is small is no landmark, so that mugs do not become desks; of boxes that show the same thing one is kept, of a
    known and an ``unknown`` one the known.
    """

    def __init__(
        self,
        detector: Detector,
        matcher: Matcher,
        *,
        known: Sequence[str] = DEFAULT_KNOWN_LANDMARKS,
        unknown: Sequence[str] = DEFAULT_UNKNOWN_LANDMARKS,
        thresholds: Thresholds | None = None,
        min_landmark_size: float = 0.25,
    ) -> None:
        """Connect a detector and a matcher.

        Args:
            detector: Open-set detector.
            matcher: Text-image matcher.
            known: Names O_k of the landmarks that are classes of the detector; case and spaces do not matter, and
                usual other names will do.
            unknown: Names O_u of the landmarks told by matching.
            thresholds: Those that belong to detector and matcher; of CLIP ViT-B/32 if not given.
            min_landmark_size: Larger side of the smallest ``unknown`` landmark [m].

        Raises:
            InputError: A name is empty.
        """
        if any(not key(name) for name in (*known, *unknown)):
            raise InputError("perceiver: a landmark's name is empty (write it in words, such as 'coffee table')")
        self._detector = detector
        self._matcher = matcher
        self._known = {key(name): name for name in known}
        self._unknown = tuple(dict.fromkeys(unknown))
        self._landmarks = tuple(dict.fromkeys((*self._unknown, *known)))
        self._thresholds = thresholds or Thresholds()
        self._min_landmark_size = min_landmark_size

    def perceive(self, frame: RgbdFrame, target: str) -> Percept:
        """Return what a frame shows.

        Args:
            frame: Colour and depth image.
            target: What is looked for, in free words; if blank, there are no candidates.

        Returns:
            Sightings and candidates, each best first, of distinct things.

        Raises:
            InputError: The matcher's scores have the wrong shape.
        """
        boxes = [
            (detection, box) for detection in self._detect(frame) if (box := clip(detection.box, frame.intrinsics))
        ]
        unknown = [(d, box) for d, box in boxes if self._thresholds.is_unknown(d.label, d.score)]
        classed = [(d, box) for d, box in boxes if not self._thresholds.is_unknown(d.label, d.score)]
        known = [(d, box) for d, box in classed if key(d.label) in self._known]
        named = [(d, box) for d, box in classed if may_name(target, d.label)]
        matched = [*unknown, *named]
        names = self._landmarks if any(d.label != UNKNOWN_CLASS for d, _ in unknown) else self._unknown
        scores = self._match(frame, [box for _, box in matched], [*names, *([target] if target.strip() else [])])
        confidence = np.array([detection.score for detection, _ in matched], dtype=np.float64)
        of_target = self._thresholds.candidate_scores(scores[:, len(names) :].max(axis=1, initial=-np.inf), confidence)
        sightings = self._known_sightings(frame, known) + self._matched_sightings(frame, unknown, scores, of_target)
        distinct = [sighting for sighting, _ in suppress(sightings, lambda pair: pair[1], _SAME)]
        distinct.sort(key=lambda sighting: -sighting.score)
        return Percept(tuple(distinct), self._candidates(frame, target, [box for _, box in matched], of_target))

    def _detect(self, frame: RgbdFrame) -> list[Detection]:
        found = self._detector.detect(frame)
        faint = self._thresholds.is_faint
        usable = [one for one in found if math.isfinite(one.score) and not faint(one.label, one.score)]
        return sorted(usable, key=lambda detection: (-detection.score, detection.box))

    def _match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        """Return m of n boxes with m texts, (n, m); -inf for no score."""
        if not boxes or not texts:
            return np.empty((len(boxes), len(texts)))
        scores = np.asarray(self._matcher.match(frame, boxes, texts), dtype=np.float64)
        if scores.shape != (len(boxes), len(texts)):
            raise InputError(f"matcher: scores of shape {scores.shape} (should be {(len(boxes), len(texts))})")
        return np.where(np.isfinite(scores), scores, -np.inf)

    def _known_sightings(
        self, frame: RgbdFrame, known: Sequence[tuple[Detection, Box]]
    ) -> list[tuple[LandmarkSighting, Box]]:
        sightings = []
        for detection, box in known:
            located = locate_landmark(frame, box)
            if located is not None:
                sightings.append(_sighting(frame, detection, box, self._known_distribution(detection), located))
        return sightings

    def _known_distribution(self, detection: Detection) -> Distribution:
        """Return the detector's class probabilities, restricted to the known landmarks."""
        shares = [(self._known[key(name)], p) for name, p in detection.probabilities if key(name) in self._known]
        total = sum(p for _, p in shares)
        if not (math.isfinite(total) and total > 0):
            return ((self._known[key(detection.label)], 1.0),)
        return tuple((name, p / total) for name, p in shares)

    def _matched_sightings(
        self,
        frame: RgbdFrame,
        found: Sequence[tuple[Detection, Box]],
        scores: FloatArray,
        of_target: FloatArray,
    ) -> list[tuple[LandmarkSighting, Box]]:
        """Return the sightings among boxes told by matching.

        Args:
            frame: Of the boxes.
            found: The boxes.
            scores: Rows of the boxes, then others'; columns of the unknown landmarks' names, the known ones', others.
            of_target: The same rows' scores as candidates.
        """
        sightings = []
        for (detection, box), row, target in zip(found, scores, of_target, strict=False):
            names = self._unknown if detection.label == UNKNOWN_CLASS else self._landmarks
            asked = row[: len(names)]
            best = asked.max(initial=-np.inf)
            if target >= self._thresholds.match or best < self._thresholds.landmark or not math.isfinite(best):
                continue
            located = locate_landmark(frame, box)
            if located is None or not self._large_enough(frame, box, located):
                continue
            shares = softmax(asked / self._thresholds.temperature).tolist()
            sightings.append(_sighting(frame, detection, box, tuple(zip(names, shares, strict=True)), located))
        return sightings

    def _large_enough(self, frame: RgbdFrame, box: Box, located: Located) -> bool:
        if touches_border(box, frame.intrinsics):
            return True  # what is cut off may be as large as it likes
        width = (box.x1 - box.x0) / frame.intrinsics.fx * located.depth
        height = (box.y1 - box.y0) / frame.intrinsics.fy * located.depth
        return max(width, height) >= self._min_landmark_size

    def _candidates(
        self, frame: RgbdFrame, target: str, boxes: Sequence[Box], scores: FloatArray
    ) -> tuple[Candidate, ...]:
        candidates = []
        for index in np.argsort(-scores, kind="stable"):
            if scores[index] < self._thresholds.match:
                break
            located = locate_object(frame, boxes[index])
            if located is not None:
                candidates.append(Candidate(target, float(scores[index]), boxes[index], located.position, frame))
        return tuple(suppress(candidates, lambda candidate: candidate.box, _SAME))


def softmax(logits: FloatArray) -> FloatArray:
    """Return exp(x_i) / Σ_j exp(x_j) of (n,) logits, n ≥ 1, at least one finite; -inf counts as probability 0."""
    shifted = np.exp(logits - logits.max())
    probabilities: FloatArray = shifted / shifted.sum()
    return probabilities


def _sighting(
    frame: RgbdFrame, detection: Detection, box: Box, distribution: Distribution, located: Located
) -> tuple[LandmarkSighting, Box]:
    score = detection.score * (_CUT_OFF if touches_border(box, frame.intrinsics) else 1.0)
    return LandmarkSighting(distribution, located.position, located.radius, score, frame.stamp), box
