"""A name is called: is the box that fits best the right one?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import Annotation, DetectionDataset
from zavis_bt.perception.evaluation.matching import LEAST_IOU
from zavis_bt.perception.evaluation.sizes import SIZES, size_classes
from zavis_bt.types import Box


@dataclass(frozen=True, slots=True)
class Query:
    """A name and the things in one image that it names."""

    image: int
    text: str
    """A category, ``mug``, or a colour and a category, ``red mug``."""
    coloured: bool
    right: tuple[Box, ...]
    """Things of that name; each of them is a right answer."""
    ignored: tuple[Box, ...] = ()
    """Things of that name that are too small or hidden to count: an answer that is none of the others but one of
    these is neither right nor wrong."""

    def verdict(self, answer: Box | None) -> bool | None:
        """Return whether a box is a right answer (IoU > 0.5); None if it is neither right nor wrong."""
        if answer is None:
            return False
        if any(answer.iou(box) > LEAST_IOU for box in self.right):
            return True
        return None if any(answer.iou(box) > LEAST_IOU for box in self.ignored) else False


@dataclass(frozen=True, slots=True)
class NameRate:
    """How often the best box was right; NaN if nothing was asked."""

    name: str
    asked: int
    right: float


@dataclass(frozen=True, slots=True)
class NameResult:
    """Names to boxes, judged."""

    all: NameRate
    categories: NameRate
    coloured: NameRate
    by_size: tuple[NameRate, ...]
    """By the size of the largest thing that was a right answer: the square root of its box's area [px]."""


def queries_of(dataset: DetectionDataset, indices: Iterable[int] | None = None) -> list[Query]:
    """Return one query for each category in an image and one for each colour and category.

    A coloured name is asked only if the colour of every thing of that category is told, as it would be ambiguous
    otherwise; so is a name only if at least one thing of that name counts.
    """
    chosen = range(len(dataset)) if indices is None else indices
    return [query for index in chosen for query in _queries(index, dataset.annotations(index))]


def judge_answers(queries: Sequence[Query], answers: Sequence[Box | None]) -> NameResult:
    """Judge the best box for each query; None is for no box at all.

    Raises:
        InputError: There is not one answer for each query.
    """
    if len(queries) != len(answers):
        raise InputError(f"names: {len(answers)} answers to {len(queries)} queries (one for each)")
    judged = [(query, query.verdict(answer)) for query, answer in zip(queries, answers, strict=True)]
    counted = [(query, bool(verdict)) for query, verdict in judged if verdict is not None]
    sizes = size_classes(np.array([max(q.right, key=lambda box: box.area) for q, _ in counted]).reshape(-1, 4))
    return NameResult(
        _rate("all", (right for _, right in counted)),
        _rate("category", (right for query, right in counted if not query.coloured)),
        _rate("colour and category", (right for query, right in counted if query.coloured)),
        tuple(
            _rate(_between(*borders), (right for (_, right), size in zip(counted, sizes, strict=True) if size == k))
            for k, borders in enumerate(pairwise(SIZES))
        ),
    )


def _queries(index: int, annotations: Sequence[Annotation]) -> list[Query]:
    queries = []
    for category in dict.fromkeys(a.category for a in annotations):
        things = [a for a in annotations if a.category == category]
        names = [(category, False, things)]
        if all(a.colour for a in things):
            colours = dict.fromkeys(a.colour for a in things)
            names += [(f"{colour} {category}", True, [a for a in things if a.colour == colour]) for colour in colours]
        for text, coloured, named in names:
            right = tuple(a.box for a in named if not a.ignored)
            ignored = tuple(a.box for a in named if a.ignored)
            queries += [Query(index, text, coloured, right, ignored)] if right else []
    return queries


def _rate(name: str, verdicts: Iterable[bool]) -> NameRate:
    known = list(verdicts)
    return NameRate(name, len(known), sum(known) / len(known) if known else math.nan)


def _between(least: float, most: float) -> str:
    return f"{least:g}–{most:g} px" if math.isfinite(most) else f"≥ {least:g} px"
