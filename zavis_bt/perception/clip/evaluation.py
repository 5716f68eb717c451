"""How well a model names crops."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.clip.gallery import Gallery
from zavis_bt.perception.clip.model import ClipModel
from zavis_bt.perception.clip.prompts import BACKGROUND_PROMPTS, OBJECT_PROMPTS
from zavis_bt.perception.clip.vocabulary import Vocabulary

_LARGE = 24.0  # crops of a longer shorter side are reported apart [px at 640 px width]
_CLEAR_SIDE, _CLEAR_SIGHT = 16.0, 0.6  # what a crop shown clearly has at least [px at 640 px width, share in sight]
_ENOUGH = 3  # crops that a "colour noun" query must have to count

Scores = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class MatcherReport:
    """Figures of one model on one data set; shares are 0 to 1, NaN where there is nothing to count."""

    figures: dict[str, float]
    """By name."""
    confusions: list[tuple[str, str, float]]
    """Most frequent: true name, given name, share of the true one's crops."""


class MatcherEvaluation:
    """Measures of one model on one gallery."""

    def __init__(
        self, model: ClipModel, gallery: Gallery, trained: Sequence[str], held_out: Collection[str] = ()
    ) -> None:
        """Take a gallery.

        Args:
            model: The one that encoded it.
            gallery: Crops.
            trained: Names of the categories the model was trained on; the gallery may hold others.
            held_out: Colours and categories that training left out together, such as ``red wallet``.
        """
        self._model, self._gallery = model, gallery
        self._shown = sorted(set(gallery.categories.tolist()) - {""})
        self._names = [name for name in self._shown if name in trained] or self._shown
        self._colours = sorted(set(gallery.colours.tolist()) - {""})
        self._known = np.isin(gallery.categories, self._names)
        pairs = zip(gallery.colours.tolist(), gallery.categories.tolist(), strict=True)
        self._held_out = np.isin([" ".join(pair) for pair in pairs], [*held_out])
        self._clear = (gallery.sides >= _CLEAR_SIDE) & (gallery.visible >= _CLEAR_SIGHT)

    def report(self, vocabulary: Vocabulary) -> MatcherReport:
        """Return all figures."""
        figures = self.categories(vocabulary.twins) | self.never_drawn()
        if self._colours:
            figures |= self.pairs() | self.queries()
        figures |= self.synonyms(vocabulary.tested_synonyms, vocabulary) | self.objectness()
        return MatcherReport(figures, self.confusions())

    def scores(self, texts: Sequence[str], rows: NDArray[np.bool_] | None = None) -> Scores:
        """Return 100 × cosine of the gallery's crops (or some of them) with texts."""
        vectors = self._gallery.vectors if rows is None else self._gallery.vectors[np.flatnonzero(rows)]
        scores: Scores = (100 * vectors @ self._model.encode_texts(texts).T).cpu().numpy()
        return scores

    def categories(self, twins: Sequence[Sequence[str]] = ()) -> dict[str, float]:
        """Return the share of crops whose category's name scores best among those trained, by size and sight."""
        gallery, known = self._gallery, self._known
        given, true = self._best(self._names, known), gallery.categories[known]
        right, clear, large = given == true, self._clear[known], gallery.sides[known] >= _LARGE
        like = {name: names[0] for names in twins for name in names}
        alike = np.array([like.get(a, a) == like.get(b, b) for a, b in zip(given, true, strict=True)], dtype=bool)
        five = np.argsort(-self.scores(self._names, known), axis=1)[:, :5]
        among = (np.asarray(self._names)[five] == true[:, None]).any(axis=1)
        return {
            "category, all crops": _mean(right),
            "category, clear crops": _mean(right[clear]),
            "category, clear crops of pairs that training has": _mean(right[clear & ~self._held_out[known]]),
            f"category, clear crops of {_LARGE:g} px and more": _mean(right[clear & large]),
            f"category, clear crops under {_LARGE:g} px": _mean(right[clear & ~large]),
            "category, clear crops, twins as one": _mean(alike[clear]),
            "category, clear crops, among the best five": _mean(among[clear]),
        }

    def never_drawn(self) -> dict[str, float]:
        """Return the same for categories that training never showed, among all names."""
        never = (self._gallery.categories != "") & ~self._known & self._clear
        right = self._best(self._shown, never) == self._gallery.categories[never]
        return {"category, clear crops of categories never drawn in training": _mean(right)}

    def pairs(self) -> dict[str, float]:
        """Return how well category and colour are told, together and apart, over pairs that training left out."""
        gallery = self._gallery
        held = self._known & self._clear & self._held_out
        if not held.any():
            return {}
        texts = [f"{colour} {name}" for colour in self._colours for name in self._names]
        scores = self.scores(texts, held).reshape(-1, len(self._colours), len(self._names))
        colour = np.searchsorted(self._colours, gallery.colours[held])
        name = np.searchsorted(self._names, gallery.categories[held])
        best = scores.reshape(len(scores), -1).argmax(axis=1)
        rows = np.arange(len(scores))
        return {
            "held-out pair, clear crops": _mean(best == colour * len(self._names) + name),
            "held-out pair, colour of the known category": _mean(scores[rows, :, name].argmax(axis=1) == colour),
            "held-out pair, category of the known colour": _mean(scores[rows, colour].argmax(axis=1) == name),
        }

    def queries(self) -> dict[str, float]:
        """Return the average precision of "colour noun" queries over all crops, and over clear crops and background."""
        everything = np.ones(len(self._known), dtype=bool)
        clear = self._clear | (self._gallery.categories == "")
        return self._queries(everything, "all crops") | self._queries(clear, "clear crops")

    def _queries(self, rows: NDArray[np.bool_], which: str) -> dict[str, float]:
        names, colours = self._gallery.categories[rows], self._gallery.colours[rows]
        pairs = Counter(zip(colours.tolist(), names.tolist(), strict=True))
        known = {*self._names}
        asked = [pair for pair, n in sorted(pairs.items()) if n >= _ENOUGH and pair[0] and pair[1] in known]
        if not asked:
            return {}
        scores = self.scores([" ".join(pair) for pair in asked], rows)
        precisions = {
            pair: average_precision(column, (colours == pair[0]) & (names == pair[1]))
            for pair, column in zip(asked, scores.T, strict=True)
        }
        figures = {f"mean AP of colour-noun queries, {which}": float(np.mean([*precisions.values()]))}
        wallet = precisions.get(("red", "wallet"))
        return figures | ({} if wallet is None else {f"AP of red wallet, {which}": wallet})

    def synonyms(self, words: Sequence[str], vocabulary: Vocabulary) -> dict[str, float]:
        """Return the mean, over synonyms, of the share of crops named right when one takes its category's place."""
        shares = []
        for word in words:
            name = vocabulary.category_of(word)
            if name in self._names:
                rows = (self._gallery.categories == name) & self._clear
                texts = [word if other == name else other for other in self._names]
                shares.append(_mean(self._best(texts, rows) == word))
        return {f"{len(shares)} synonyms, clear crops": float(np.nanmean(shares))} if np.isfinite(shares).any() else {}

    def objectness(self) -> dict[str, float]:
        """Return how o(B) tells things from background: the area under the ROC curve, and the shares above 0.9."""
        thing = self._gallery.categories != ""
        logits = self._model.logit_scale / 100 * self.scores((*BACKGROUND_PROMPTS, *OBJECT_PROMPTS))
        shares = np.exp(logits - logits.max(axis=1, keepdims=True))
        o = 1 - shares[:, : len(BACKGROUND_PROMPTS)].sum(axis=1) / shares.sum(axis=1)
        if thing.all():
            return {}
        return {
            "objectness, area under ROC": _area_under_roc(o, thing),
            "things with o(B) > 0.9": _mean(o[thing] > 0.9),
            "background with o(B) > 0.9": _mean(o[~thing] > 0.9),
        }

    def confusions(self, most: int = 15) -> list[tuple[str, str, float]]:
        """Return the most frequent mistakes among trained categories."""
        rows = self._known & self._clear
        true = self._gallery.categories[rows].tolist()
        given = self._best(self._names, rows).tolist()
        totals = Counter(true)
        wrong = Counter(pair for pair in zip(true, given, strict=True) if pair[0] != pair[1])
        shares = [(a, b, count / totals[a]) for (a, b), count in wrong.items()]
        return sorted(shares, key=lambda row: -row[2])[:most]

    def _best(self, texts: Sequence[str], rows: NDArray[np.bool_]) -> NDArray[np.str_]:
        if not rows.any():
            return np.array([], dtype=np.str_)
        best: NDArray[np.str_] = np.asarray(texts)[self.scores(texts, rows).argmax(axis=1)]
        return best


def average_precision(scores: NDArray[np.floating], relevant: NDArray[np.bool_]) -> float:
    """Return the mean, over relevant items, of the precision down to them; NaN if there are none."""
    hits = relevant[np.argsort(-scores, kind="stable")]
    precision = np.cumsum(hits) / np.arange(1, len(hits) + 1)
    return float(precision[hits].mean()) if hits.any() else float("nan")


def _area_under_roc(scores: NDArray[np.floating], positive: NDArray[np.bool_]) -> float:
    ranks = np.argsort(np.argsort(scores, kind="stable")) + 1
    n, m = int(positive.sum()), int((~positive).sum())
    return float((ranks[positive].sum() - n * (n + 1) / 2) / (n * m)) if n and m else float("nan")


def _mean(values: NDArray[np.bool_]) -> float:
    return float(values.mean()) if len(values) else float("nan")
