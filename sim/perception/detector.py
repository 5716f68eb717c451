"""The simulated open-set detector."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.frame import InstanceView, instances_of
from sim.perception.curves import DetectorSettings, chance_given, logistic
from sim.perception.draws import Draws, frame_key, key_of, keys_of
from sim.perception.labels import Classifier
from sim.perception.words import normal_name
from zavis_bt.types import Box, Detection, FloatArray, RgbdFrame

_PART_SIZE = (0.2, 0.6)  # share of the furniture's sides that a part's box has
_BACKGROUND_SIZE = (0.03, 0.2)  # share of the image's width that a box on nothing has


class SimDetector:
    """Finds what is in sight, with the misses, slips and false alarms of a trained open-set detector.

    Furniture whose category is known gets a class; other furniture and all objects come out as ``unknown``.
    """

    def __init__(
        self, known: Sequence[str], rng: np.random.Generator, settings: DetectorSettings | None = None
    ) -> None:
        """Set up a detector.

        Args:
            known: Classes it was trained on.
            rng: Where its seed comes from.
            settings: How it errs.
        """
        self._settings = settings or DetectorSettings()
        self._draws = Draws(rng)
        self._classify = Classifier([normal_name(name) for name in known], self._draws, self._settings)

    def detect(self, frame: RgbdFrame) -> list[Detection]:
        """Return boxes with a known class or ``unknown``, best first.

        Raises:
            InputError: The frame does not come from the simulated camera.
        """
        instances, moment = instances_of(frame), frame_key(frame)
        found = self._detect_instances(frame, instances, moment) if instances else []
        found += self._imagine(frame, instances, moment)
        return sorted(found, key=lambda detection: -detection.score)

    def _detect_instances(self, frame: RgbdFrame, instances: Sequence[InstanceView], moment: int) -> list[Detection]:
        keys = keys_of([instance.id for instance in instances])
        chances = self._chances(frame, instances, keys)
        hit = np.flatnonzero(self._draws.uniform("detect", keys, moment) < chances)
        wobble = self._draws.normal("edge", keys[:, None], moment, np.arange(4, dtype=np.uint64))
        luck = self._draws.normal("score", keys, moment)
        logits = np.log(np.maximum(chances, 1e-9) / (1.0 - chances))
        scores = logistic(0.55 * logits + 0.3 + 0.5 * luck)
        return [
            self._classify(
                instances[i],
                self._shake(instances[i].box, wobble[i], frame),
                float(scores[i]),
                float(chances[i]),
                int(keys[i]),
                moment,
            )
            for i in hit.tolist()
        ]

    def _chances(self, frame: RgbdFrame, instances: Sequence[InstanceView], keys: NDArray[np.uint64]) -> FloatArray:
        """Return the chance (n,) that each instance is detected in this frame."""
        settings = self._settings
        boxes = np.array([instance.box for instance in instances])
        sides = boxes[:, 2:] - boxes[:, :2]
        furniture = np.array([instance.is_furniture for instance in instances])
        areas = np.array([instance.visible_area for instance in instances])
        fractions = np.array([instance.visible_fraction for instance in instances])
        place = [math.floor(value / settings.place) for value in frame.transform_camera_to_map[:2, 3].tolist()]
        shifts = settings.difficulty * self._draws.normal("difficulty", keys)
        shifts += settings.place_difficulty * self._draws.normal("place", keys, key_of(*map(str, place)))
        chances = chance_given(np.sqrt(sides.prod(axis=1)), sides.min(axis=1), fractions, furniture, shifts, settings)
        pixels = frame.intrinsics.width * frame.intrinsics.height
        chances[furniture & (areas < settings.furniture_share * pixels)] = 0.0
        return chances

    def _shake(self, box: Box, wobble: FloatArray, frame: RgbdFrame) -> Box:
        """Return the box with its edges moved, at least `least_side` wide and high, inside the image."""
        settings, (width, height) = self._settings, (frame.intrinsics.width, frame.intrinsics.height)
        across = max(settings.jitter * (box.x1 - box.x0), settings.jitter_px)
        up = max(settings.jitter * (box.y1 - box.y0), settings.jitter_px)
        x0, x1 = _span(box.x0 + across * wobble[0], box.x1 + across * wobble[2], settings.least_side, width)
        y0, y1 = _span(box.y0 + up * wobble[1], box.y1 + up * wobble[3], settings.least_side, height)
        return Box(x0, y0, x1, y1)

    def _imagine(self, frame: RgbdFrame, instances: Sequence[InstanceView], moment: int) -> list[Detection]:
        """Return the frame's false positives."""
        slots = np.arange(self._settings.most_false, dtype=np.uint64)
        chance = self._settings.false_positives / self._settings.most_false
        luck = self._draws.uniform("false", moment, slots[:, None], np.arange(8, dtype=np.uint64))
        scores = logistic(-0.9 + 0.6 * self._draws.normal("false score", moment, slots))
        furniture = [instance for instance in instances if instance.is_furniture]
        found = []
        for slot in np.flatnonzero(luck[:, 0] < chance).tolist():
            if furniture and luck[slot, 1] < self._settings.parts:
                box = _part_of(furniture[int(luck[slot, 2] * len(furniture))].box, luck[slot])
            else:
                box = _anywhere(frame, luck[slot])
            box = self._shake(box, np.zeros(4), frame)
            found.append(self._classify(None, box, float(scores[slot]), float(scores[slot]), slot, moment))
        return found


def _span(low: float, high: float, least: float, end: int) -> tuple[float, float]:
    """Return the interval clipped to [0, end] and widened to ``least``, as far as that has room."""
    low, high = min(max(min(low, high), 0.0), end), min(max(low, high, 0.0), end)
    if high - low < least:
        low = min(max((low + high - least) / 2, 0.0), max(end - least, 0.0))
        high = min(low + least, float(end))
    return float(low), float(high)


def _part_of(box: Box, luck: FloatArray) -> Box:
    """Return a box inside a box."""
    low, high = _PART_SIZE
    width, height = ((low + (high - low) * luck[3:5]) * (box.x1 - box.x0, box.y1 - box.y0)).tolist()
    x0 = box.x0 + float(luck[5]) * (box.x1 - box.x0 - width)
    y0 = box.y0 + float(luck[6]) * (box.y1 - box.y0 - height)
    return Box(x0, y0, x0 + width, y0 + height)


def _anywhere(frame: RgbdFrame, luck: FloatArray) -> Box:
    """Return a box anywhere in the image."""
    low, high = _BACKGROUND_SIZE
    width, height = ((low + (high - low) * luck[3:5]) * frame.intrinsics.width).tolist()
    x, y = float(luck[5]) * frame.intrinsics.width, float(luck[6]) * frame.intrinsics.height
    return Box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)
