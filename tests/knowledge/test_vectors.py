from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from zavis_bt.errors import ZavisError
from zavis_bt.knowledge import WordVectors


@pytest.fixture(scope="module")
def vectors() -> WordVectors:
    return WordVectors()


def test_text_is_most_similar_to_itself(vectors: WordVectors) -> None:
    names = ["sofa", "coffee table", "remote control", "mug"]
    cosines = vectors.similarities(names, names)
    np.testing.assert_allclose(np.diag(cosines), 1.0, atol=1e-9)
    np.testing.assert_allclose(cosines, cosines.T, atol=1e-12)
    assert (cosines[~np.eye(len(names), dtype=bool)] < 0.9).all()


def test_related_words_are_nearer_than_unrelated_ones(vectors: WordVectors) -> None:
    for word, near, far in [("sofa", "couch", "fridge"), ("laptop", "computer", "pillow"), ("television", "tv", "bed")]:
        assert vectors.similarity(word, near) > vectors.similarity(word, far) + 0.2


def test_spelling_does_not_matter(vectors: WordVectors) -> None:
    assert vectors.similarity("RemoteControl", "remote_control") == pytest.approx(1.0)


@pytest.mark.parametrize("text", ["", "   ", "__", "\n"])
def test_text_without_words_is_similar_to_nothing(vectors: WordVectors, text: str) -> None:
    assert vectors.similarity(text, "sofa") == 0.0
    assert vectors.similarity(text, text) == 0.0
    assert vectors.coverage(text) == 0.0


@settings(max_examples=60)
@given(st.text(max_size=60), st.text(max_size=60))
def test_any_text_has_a_similarity(a: str, b: str) -> None:
    cosine = VECTORS.similarity(a, b)
    assert -1.0 <= cosine <= 1.0
    assert cosine == pytest.approx(VECTORS.similarity(b, a), abs=1e-12)


VECTORS = WordVectors()


def test_very_long_text_is_read_as_its_beginning(vectors: WordVectors) -> None:
    long = "mug " * 2500
    assert len(long) == 10_000
    assert vectors.similarity(long, "mug") > 0.9


def test_shapes_follow_the_arguments(vectors: WordVectors) -> None:
    assert vectors.similarities(["a", "b"], ["c", "d", "e"]).shape == (2, 3)
    assert vectors.similarities([], ["c"]).shape == (0, 1)
    assert vectors.similarities(["a"], []).shape == (1, 0)


def test_words_in_pieces_are_not_covered(vectors: WordVectors) -> None:
    assert vectors.coverage("book") == 1.0
    assert vectors.coverage("ukulele") == 0.0
    assert vectors.coverage("ukulele book") == 0.5


def test_vectors_are_those_of_the_library(vectors: WordVectors) -> None:
    code = (
        "import pathlib, wordllama as w\n"
        "m = w.WordLlama.load(cache_dir=pathlib.Path(w.__file__).parent, disable_download=True)\n"
        "print(m.similarity('coffee table', 'dining table'))\n"
    )
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert vectors.similarity("coffee table", "dining table") == pytest.approx(float(printed), abs=1e-3)


def test_library_itself_is_not_imported() -> None:
    code = "import sys; from zavis_bt.knowledge import make_prior\n" + (
        "assert not {'wordllama', 'tokenizers', 'safetensors'} & set(sys.modules)\n"
        "make_prior('commonsense').probability('book', ['desk'])\n"
        "assert 'wordllama' not in sys.modules\n"
    )
    root = Path(__file__).parents[2]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=root)


def test_missing_vectors_are_one_line_for_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ZavisError, match=r"wordllama: its word vectors .* are missing"):
        WordVectors().similarity("a", "b")
