"""How well simulated perception sees: chances of detection and mean matching scores, with their settings.

docs/simulated_perception.md says where the numbers come from and shows the curves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zavis_bt.types import FloatArray


@dataclass(frozen=True, slots=True)
class DetectorSettings:
    """How the simulated open-set detector errs."""

    ceiling: float = 0.92
    """Chance in one frame to detect what is large and in full view."""
    half_size: float = 16.8
    """Root of the visible box's area at which half the ceiling is reached [px]."""
    slope: float = 2.25
    """Of the chance's logit over the logarithm of that size."""
    smallest: float = 5.0
    """Size below which nothing is detected [px]."""
    short_side: tuple[float, float] = (0.5, 3.0)
    """Shorter side of the visible box at which the chance begins to rise from 0, and no longer suffers [px]."""
    visible: tuple[float, float] = (0.05, 0.65)
    """The same for an object's visible fraction."""
    visible_furniture: tuple[float, float] = (0.02, 0.25)
    """The same for furniture, which is recognised when the image's border cuts off most of it."""
    furniture_share: float = 0.002
    """Share of the image that furniture must fill to be detected."""
    difficulty: float = 0.4
    """Spread of the logit between instances: some are harder, wherever one stands."""
    place_difficulty: float = 0.8
    """Spread of the logit between places to stand: a second look from the same place helps less than from another."""
    place: float = 0.5
    """Side of what counts as the same place [m]."""
    false_positives: float = 1.2
    """Mean number of boxes a frame that show a part of a piece of furniture or nothing."""
    most_false: int = 4
    """At most so many of them in one frame."""
    parts: float = 0.6
    """Share of these that show a part of a piece of furniture, if any is in sight."""
    jitter: float = 0.05
    """Spread of a box's edges, as a share of its sides; also at least `jitter_px`."""
    jitter_px: float = 0.7
    """[px]"""
    least_side: float = 4.0
    """No box is narrower [px]."""
    known_as_unknown: float = 0.1
    """Share of known furniture that comes out as `unknown`: the paper's cut at the 0.9 quantile of the uncertainty."""
    unknown_as_known: float = 0.03
    """Share of unknown furniture that gets a known class; a third of it for objects and false positives."""


@dataclass(frozen=True, slots=True)
class MatcherSettings:
    """Scores of the simulated text-image matcher, on the 100 × cosine scale."""

    match: float = 31.5
    """Mean score of a text that names what a good crop shows."""
    unrelated: float = 20.0
    """Mean score of a text about something else."""
    background: float = 17.0
    """Mean score of any text where the box shows nothing."""
    half_similarity: float = 0.2
    """Word similarity at which a text gets half of what an exact name gets."""
    lookalikes: float = 0.02
    """Share of objects that resemble what a text names, whatever the words: the reason why a person is asked."""
    resemblance: tuple[float, float] = (0.5, 0.95)
    """How well the text then fits, between these."""
    instance_spread: float = 0.7
    """Spread between instances and texts, the same in every view."""
    view_spread: float = 0.8
    """Spread between views."""
    background_spread: float = 1.2
    small_loss: float = 0.25
    """Share of the gain over `unrelated` that a crop of few pixels loses; falls with size over `small_size`."""
    small_size: float = 12.0
    """[px]"""
    hidden_loss: float = 0.15
    """Share of the gain lost when nearly all of it is hidden."""
    misplaced_loss: float = 0.4
    """Share of the gain lost as the box and the visible part come apart (IoU towards 0)."""
    same_colour: float = 0.8
    """Added when the text's colour is the instance's."""
    other_colour: float = 2.2
    """Taken away when it is another, as far as the text's noun fits."""


def detection_chance(
    size: FloatArray, short_side: FloatArray, fraction: FloatArray, furniture: bool, settings: DetectorSettings
) -> FloatArray:
    """Return the chance that a detector finds an instance in one frame, over all instances and places.

    Args:
        size: (n,) root of the visible box's area [px].
        short_side: (n,) its shorter side [px].
        fraction: (n,) visible fraction.
        furniture: Whether the instances are furniture.
        settings: The curve.
    """
    spread = math.hypot(settings.difficulty, settings.place_difficulty)
    nodes, weights = np.polynomial.hermite_e.hermegauss(15)
    shifted = [chance_given(size, short_side, fraction, furniture, spread * node, settings) for node in nodes]
    return np.asarray(np.tensordot(weights / weights.sum(), np.array(shifted), axes=1))


def chance_given(
    size: FloatArray,
    short_side: FloatArray,
    fraction: FloatArray,
    furniture: bool | FloatArray,
    difficulty: float | FloatArray,
    settings: DetectorSettings,
) -> FloatArray:
    """Return the chance of detection of instances of a given difficulty [logit]; arguments as `detection_chance`."""
    size = np.asarray(size, dtype=np.float64)
    # A mean of logistic curves over normal shifts is flatter than each: steepen them, so that their mean has the slope.
    spread = settings.difficulty**2 + settings.place_difficulty**2
    steeper = math.sqrt(1.0 + math.pi * spread / 8.0)
    logit = settings.slope * steeper * np.log(np.maximum(size, 1e-3) / settings.half_size) - difficulty
    low, high = settings.visible
    low_furniture, high_furniture = settings.visible_furniture
    seen = np.where(furniture, ramp(fraction, low_furniture, high_furniture), ramp(fraction, low, high))
    chance = settings.ceiling * logistic(logit) * seen * ramp(short_side, *settings.short_side)
    return np.asarray(np.where(size < settings.smallest, 0.0, chance))


def name_fit(similarity: FloatArray, settings: MatcherSettings) -> FloatArray:
    """Return how well a text names a thing, 0 to 1, from the similarity of the words (−1 to 1).

    Word vectors give cosines near 0 for most pairs, 0.2 for a mug and a cup, 0.5 for a sofa and a couch; a steep
    curve through `half_similarity` makes the last nearly as good as the name itself.
    """
    squared = np.clip(similarity, 0.0, 1.0) ** 2
    half = settings.half_similarity**2
    return np.asarray(squared / (squared + half) * (1.0 + half))


def crop_quality(size: FloatArray, fraction: FloatArray, overlap: FloatArray, settings: MatcherSettings) -> FloatArray:
    """Return the share of the gain over `unrelated` that a crop keeps.

    Args:
        size: Root of the visible box's area [px].
        fraction: Visible fraction.
        overlap: IoU of the given box and the visible part's.
        settings: The losses.
    """
    small = settings.small_loss * np.exp(-np.asarray(size) / settings.small_size)
    hidden = settings.hidden_loss * (1.0 - np.asarray(fraction))
    return np.asarray(1.0 - small - hidden - settings.misplaced_loss * (1.0 - np.asarray(overlap)))


def ramp(value: FloatArray, low: float, high: float) -> FloatArray:
    """Return 0 below low, 1 above high, a straight line between."""
    return np.asarray(np.clip((np.asarray(value) - low) / (high - low), 0.0, 1.0))


def logistic(logit: FloatArray) -> FloatArray:
    """Return the probability of a logit."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.asarray(logit))))
