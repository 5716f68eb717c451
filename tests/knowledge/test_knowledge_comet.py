"""The prior of a BART that was taught, within a second, where three things are."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("transformers")

from tokenizers import ByteLevelBPETokenizer
from transformers import AutoTokenizer, BartConfig, BartForConditionalGeneration

from zavis_bt.errors import InputError
from zavis_bt.knowledge import CometPrior, make_prior, word_vectors
from zavis_bt.knowledge.comet import CometGenerator

PLACES = {"laptop": "office desk", "pillow": "bed", "mug": "kitchen table"}
LANDMARKS = ("desk", "bed", "sofa", "dining table")
SMALL = {
    "d_model": 32, "encoder_layers": 1, "decoder_layers": 1, "encoder_attention_heads": 2, "decoder_attention_heads": 2,
    "encoder_ffn_dim": 64, "decoder_ffn_dim": 64, "max_position_embeddings": 64, "dropout": 0.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model in the files of the published one: no tokenizer.json, torch's own weights, settings of another task."""
    torch.manual_seed(0)
    folder = tmp_path_factory.mktemp("comet")
    size = write_tokenizer(folder)
    config = BartConfig(vocab_size=size, **SMALL)
    settings = config.to_dict() | {"num_beams": 4, "early_stopping": True, "no_repeat_ngram_size": 3, "min_length": 1}
    settings["task_specific_params"] = {"summarization": {"max_length": 128, "min_length": 12}}
    (folder / "config.json").write_text(json.dumps(settings))
    torch.save(taught(BartForConditionalGeneration(config), folder).state_dict(), folder / "pytorch_model.bin")
    return folder


def write_tokenizer(folder: Path) -> int:
    marks = ["<s>", "<pad>", "</s>", "<unk>", "<mask>"]
    tokenizer = ByteLevelBPETokenizer()
    texts = [f"a {target} {place}" for target, place in PLACES.items()]
    tokenizer.train_from_iterator(texts, vocab_size=320, special_tokens=marks, show_progress=False)
    tokenizer.save_model(str(folder))
    size: int = tokenizer.get_vocab_size()
    (folder / "added_tokens.json").write_text(json.dumps({"AtLocation": size, "[GEN]": size + 1}))
    (folder / "tokenizer_config.json").write_text(json.dumps({"model_max_length": 1024}))
    named = {"bos": "<s>", "cls": "<s>", "pad": "<pad>", "eos": "</s>", "sep": "</s>", "unk": "<unk>", "mask": "<mask>"}
    (folder / "special_tokens_map.json").write_text(json.dumps({f"{k}_token": v for k, v in named.items()}))
    return size + 2


def taught(model: Any, folder: Path) -> Any:
    tokenizer = AutoTokenizer.from_pretrained(folder)
    queries = tokenizer([f"a {target} AtLocation [GEN]" for target in PLACES], padding=True, return_tensors="pt")
    answers = tokenizer([f" {place}" for place in PLACES.values()], padding=True, return_tensors="pt")["input_ids"]
    answers[answers == tokenizer.pad_token_id] = -100
    optimiser = torch.optim.Adam(model.parameters(), lr=1e-2)
    for _ in range(80):
        loss = model(**queries, labels=answers).loss
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    return model


@pytest.mark.parametrize(("target", "landmark"), [("laptop", "desk"), ("Pillow", "bed"), ("mug", "dining table")])
def test_things_are_likeliest_where_the_network_says(folder: Path, target: str, landmark: str) -> None:
    prior = make_prior("comet", model=folder, beams=2, generations=1)
    assert LANDMARKS[int(prior.probability(target, LANDMARKS).argmax())] == landmark


def test_places_come_likeliest_first_each_once(folder: Path) -> None:
    places = CometGenerator(folder, beams=20, generations=20).places("laptop")
    assert places[0] == "office desk"
    assert 2 <= len(places) <= 20
    assert len(set(places)) == len(places)


def test_the_same_target_has_the_same_places(folder: Path) -> None:
    first, second = (CometGenerator(folder, beams=5, generations=5).places("mug") for _ in range(2))
    assert first == second


def test_probability_is_the_greatest_likeness_to_any_place() -> None:
    prior = CometPrior(lambda target: ("office desk", "living room"), word_vectors())
    likeness = word_vectors().similarities(("office desk", "living room"), LANDMARKS).max(axis=0)
    np.testing.assert_allclose(prior.probability("laptop", LANDMARKS), np.clip(likeness, 0.0, 1.0))


def test_what_no_place_is_known_of_may_be_anywhere() -> None:
    np.testing.assert_array_equal(CometPrior(lambda target: (), word_vectors()).probability("x", LANDMARKS), 1.0)


def test_the_network_is_asked_once_for_each_target() -> None:
    asked = []

    def places(target: str) -> tuple[str, ...]:
        asked.append(target)
        return ("desk",)

    prior = CometPrior(places, word_vectors())
    for target in ("Laptop", "laptop", "mug", "laptop"):
        prior.probability(target, LANDMARKS)
    assert asked == ["laptop", "mug"]


@pytest.mark.parametrize("target", ["", "  ", "ünïcödé ☕", "x" * 5000, "[GEN] [GEN]", "</s>"], ids=range(6))
def test_any_text_has_an_answer(folder: Path, target: str) -> None:
    prior = make_prior("comet", model=folder, beams=2, generations=2)
    probability = prior.probability(target, LANDMARKS)
    assert probability.shape == (4,)
    assert ((probability >= 0.0) & (probability <= 1.0)).all()
    assert prior.probability(target, ()).shape == (0,)


def test_a_network_that_is_not_here_is_named_with_what_to_download(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ZAVIS_MODELS", str(tmp_path))
    with pytest.raises(InputError, match=r"'comet': is not on this machine .*comet-bart-ai2 .*zavis models add comet"):
        make_prior("comet")


def test_without_torch_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("zavis_bt.knowledge.comet.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"needs torch \(pip install 'zavis_bt\[neural\]'\)"):
        make_prior("comet")


@pytest.mark.parametrize(("beams", "generations"), [(20, 0), (5, 6)])
def test_impossible_searches_are_refused(beams: int, generations: int) -> None:
    with pytest.raises(InputError, match="prior 'comet': generations is"):
        make_prior("comet", beams=beams, generations=generations)


def test_weights_of_another_size_are_refused(folder: Path, tmp_path: Path) -> None:
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    settings = json.loads((folder / "config.json").read_text()) | {"encoder_layers": 2}
    (tmp_path / "config.json").write_text(json.dumps(settings))
    with pytest.raises(InputError, match=r"weights of its BART are missing"):
        make_prior("comet", model=tmp_path)


@pytest.mark.parametrize("file", ["config.json", "pytorch_model.bin", "vocab.json"])
def test_damaged_files_are_refused_in_one_line(folder: Path, tmp_path: Path, file: str) -> None:
    for path in folder.iterdir():
        content = path.read_bytes()
        (tmp_path / path.name).write_bytes(content[: len(content) // 2] if path.name == file else content)
    with pytest.raises(InputError, match="cannot be loaded as COMET-BART") as caught:
        make_prior("comet", model=tmp_path)
    assert "\n" not in str(caught.value)


def test_devices_that_are_not_there_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"device 'abacus': .*\(choose cpu\)"):
        make_prior("comet", model=folder, device="abacus")


def test_asking_for_a_prior_without_a_network_loads_none() -> None:
    assert "zavis_bt.knowledge.comet" in sys.modules
    assert not hasattr(sys.modules["zavis_bt.knowledge.comet"], "torch")
