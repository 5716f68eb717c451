"""The shipped matcher on frames drawn afresh: it may not fall below these floors."""

from pathlib import Path

import pytest

pytest.importorskip("torch")

import torch

from sim.labelled_frames import FrameRecipe, write_frames
from zavis_bt.perception.clip import ClipModel
from zavis_bt.perception.clip.evaluation import MatcherEvaluation
from zavis_bt.perception.clip.gallery import encode_gallery
from zavis_bt.perception.clip.loading import read_facts
from zavis_bt.perception.clip.vocabulary import Vocabulary
from zavis_bt.perception.datasets import open_dataset

SEED, FRAMES = 20_257, 72  # of no other data set

FLOORS = {
    "category, clear crops": 0.92,
    "category, clear crops, among the best five": 0.97,
    "held-out pair, clear crops": 0.75,
    "held-out pair, colour of the known category": 0.80,
    "mean AP of colour-noun queries, clear crops": 0.93,
    "synonyms, clear crops": 0.90,
    "objectness, area under ROC": 0.98,
    "things with o(B) > 0.9": 0.92,
}


@pytest.fixture(scope="module")
def figures(tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("shipped") / "frames"
    facts = read_facts("zavis-tiny")
    trained = facts["categories"]
    list(write_frames(folder, FRAMES, FrameRecipe(seed=SEED, categories=tuple(trained))))
    model = ClipModel.load("zavis-tiny")
    gallery = encode_gallery(model, open_dataset(folder))
    found = MatcherEvaluation(model, gallery, trained, facts["held_out"]).report(Vocabulary.read()).figures
    return {name.lstrip("0123456789 "): value for name, value in found.items()}  # "22 synonyms": those in these frames


@pytest.mark.parametrize("name", FLOORS)
def test_figures_keep_above_their_floor(figures: dict[str, float], name: str) -> None:
    assert figures[name] >= FLOORS[name]


def test_things_and_background_are_told_by_the_papers_threshold(figures: dict[str, float]) -> None:
    assert figures["things with o(B) > 0.9"] > 5 * figures["background with o(B) > 0.9"]


def test_the_shipped_model_says_what_it_was_trained_on() -> None:
    facts = read_facts("zavis-tiny")
    assert facts["trained_on"] == "rendered pixels"
    assert len(facts["categories"]) == 122
    weights = Path(__file__).parents[2] / "zavis_bt/perception/weights/zavis_tiny_clip/open_clip_model.safetensors"
    assert weights.stat().st_size < 12e6
