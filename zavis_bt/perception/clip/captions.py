"""Captions of crops, and which caption is true of which crop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.clip.prompts import BACKGROUND_PROMPTS
from zavis_bt.perception.clip.vocabulary import Vocabulary

EMPTY, PART = "(empty)", "(part)"
"""Pseudo-categories of crops that show no whole thing: a piece of wall or floor, a piece of things."""

NO_COLOUR = -1
"""Index of the colour of a caption that names none, and of a crop that has none."""

_TEMPLATES = (*("a photo of {}",) * 5, "{}", "a {}", "the {}", "a photo of a {}", "a {} in a room")
_COLOURED, _NAMED, _KIND, _GROUP = 0.50, 0.24, 0.12, 0.08  # shares of captions of things; the rest names a colour
_OTHER_NAME = 0.35  # share of names that are synonyms, where there are any
_COLOUR_ONLY = ("{}", "{} thing", "{} object")
_UNTRUE = 0.04  # share of captions that are true of nothing, for nouns that have no example


@dataclass(frozen=True, slots=True)
class Captions:
    """A batch of captions."""

    texts: tuple[str, ...]
    """(n,)"""
    nouns: NDArray[np.intp]
    """(n,) what they speak of: rows of `CaptionWriter.truth`."""
    colours: NDArray[np.intp]
    """(n,) the colour they name, or `NO_COLOUR`."""


class CaptionWriter:
    """Writes random captions for crops of known category and colour."""

    def __init__(self, categories: Sequence[str], colours: Sequence[str], vocabulary: Vocabulary) -> None:
        """Collect the words.

        Args:
            categories: Names of the things; crops name them by index. Two more follow: `EMPTY` and `PART`.
            colours: Names of the colours; crops name them by index.
            vocabulary: Other words.
        """
        self.categories = (*categories, EMPTY, PART)
        self._colours = [(name, *vocabulary.colour_synonyms.get(name, ())) for name in colours]
        self._texts: list[str] = []
        self._rows: list[NDArray[np.bool_]] = []
        others = vocabulary.synonyms
        self._names = [[self._noun(word, [name]) for word in (name, *others.get(name, ()))] for name in categories]
        self._kinds = self._about_each(vocabulary.kinds)
        self._groups = self._about_each(vocabulary.groups)
        self._thing = self._noun("", categories)
        scenes = [self._noun(text, [EMPTY, PART]) for text in BACKGROUND_PROMPTS]
        surfaces = [self._noun(text, [EMPTY]) for text in ("wall", "floor")]
        self._scenes = {EMPTY: scenes + surfaces, PART: [*scenes, self._noun("part of something", [PART])]}
        self.truth: NDArray[np.bool_] = np.array(self._rows)
        self._untrue = np.flatnonzero(~self.truth.any(axis=1))

    def words(self) -> list[str]:
        """Return texts that hold every word a caption may have."""
        colours = [name for names in self._colours for name in names]
        return [*self._texts, *colours, *(text.format("") for text in (*_TEMPLATES, *_COLOUR_ONLY))]

    def write(self, categories: NDArray[np.intp], colours: NDArray[np.intp], rng: np.random.Generator) -> Captions:
        """Return a caption for each crop.

        Args:
            categories: (n,) indices.
            colours: (n,) indices or `NO_COLOUR`.
            rng: Source of the draws.

        Returns:
            n captions, and a few that are true of none of them if there are words without examples.
        """
        written = [self._one(k, c, rng) for k, c in zip(categories.tolist(), colours.tolist(), strict=True)]
        if len(self._untrue):
            count = max(round(_UNTRUE * len(written)), 1)
            written += [(int(noun), NO_COLOUR, False) for noun in rng.choice(self._untrue, count)]
        texts = tuple(self._text(noun, colour, alone, rng) for noun, colour, alone in written)
        nouns, named = (np.array([row[k] for row in written], dtype=np.intp) for k in (0, 1))
        return Captions(texts, nouns, named)

    def true_of(self, categories: NDArray[np.intp], colours: NDArray[np.intp], captions: Captions) -> NDArray[np.bool_]:
        """Return whether caption j is true of crop i, (n, m): a red sofa is a sofa, furniture and a red thing."""
        colour = (captions.colours == NO_COLOUR) | (captions.colours == colours[:, None])
        both: NDArray[np.bool_] = self.true_in_some_colour(categories, captions) & colour
        return both

    def true_in_some_colour(self, categories: NDArray[np.intp], captions: Captions) -> NDArray[np.bool_]:
        """Return whether caption j would be true of crop i if that had the colour, (n, m)."""
        nouns: NDArray[np.bool_] = self.truth[captions.nouns][:, categories].T
        return nouns

    def untold_of(
        self,
        categories: NDArray[np.intp],
        colours: NDArray[np.intp],
        captions: Captions,
        untold: NDArray[np.bool_],
    ) -> NDArray[np.bool_]:
        """Return whether training says nothing of caption j for crop i, (n, m).

        Such a caption names the crop's category in an untold colour of it, or only categories that are untold in the
        crop's colour.

        Args:
            categories: (n,) indices.
            colours: (n,) indices or `NO_COLOUR`.
            captions: m of them.
            untold: (k + 2, c) the pairs of category and colour that training says nothing of.
        """
        none = np.zeros((len(untold), 1), dtype=bool)
        padded = np.hstack([untold, none])  # no colour is the last, which `NO_COLOUR` counts to
        other_colour = self.true_in_some_colour(categories, captions) & padded[categories][:, captions.colours]
        of_noun = self.truth[captions.nouns]
        told: NDArray[np.float32] = of_noun.astype(np.float32) @ (~padded).astype(np.float32)
        all_untold: NDArray[np.bool_] = of_noun.any(axis=1, keepdims=True) & (told == 0)
        says_it = (captions.colours == NO_COLOUR) | (captions.colours == colours[:, None])
        only: NDArray[np.bool_] = other_colour | (all_untold.T[colours] & says_it)
        return only

    def _noun(self, text: str, categories: Sequence[str]) -> int:
        self._texts.append(text)
        self._rows.append(np.isin(self.categories, [*categories]))
        return len(self._texts) - 1

    def _about_each(self, groups: Mapping[str, Sequence[str]]) -> list[list[int]]:
        """Return the nouns that are true of each category."""
        nouns = [self._noun(text, members) for text, members in groups.items()]
        return [[noun for noun in nouns if self._rows[noun][k]] for k in range(len(self.categories))]

    def _one(self, category: int, colour: int, rng: np.random.Generator) -> tuple[int, int, bool]:
        """Return a noun, a colour, and whether the colour stands alone."""
        if category >= len(self._names):
            scenes = self._scenes[self.categories[category]]
            return scenes[rng.integers(len(scenes))], NO_COLOUR, False
        names, draw = self._names[category], rng.random()
        noun = names[rng.integers(1, len(names))] if len(names) > 1 and rng.random() < _OTHER_NAME else names[0]
        if draw < _COLOURED:
            return noun, colour, False
        kinds, groups = self._kinds[category], self._groups[category]
        if _COLOURED + _NAMED <= draw < _COLOURED + _NAMED + _KIND and kinds:
            return kinds[rng.integers(len(kinds))], NO_COLOUR, False
        if _COLOURED + _NAMED + _KIND <= draw < _COLOURED + _NAMED + _KIND + _GROUP and groups:
            return groups[rng.integers(len(groups))], colour if rng.random() < 0.3 else NO_COLOUR, False
        if draw >= _COLOURED + _NAMED + _KIND + _GROUP and colour != NO_COLOUR:
            return self._thing, colour, True
        return noun, NO_COLOUR, False

    def _text(self, noun: int, colour: int, alone: bool, rng: np.random.Generator) -> str:
        words = [] if colour == NO_COLOUR else self._colours[colour]
        word = words[0 if rng.random() < 0.8 else int(rng.integers(len(words)))] if words else ""
        said = _COLOUR_ONLY[rng.integers(len(_COLOUR_ONLY))].format(word) if alone else self._texts[noun]
        return _TEMPLATES[rng.integers(len(_TEMPLATES))].format(said if alone or not word else f"{word} {said}")
