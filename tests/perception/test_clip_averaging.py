"""The mean of models that trained on from the same weights."""

import pytest

pytest.importorskip("torch")

import torch
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.averaging import averaged_facts
from zavis_bt.perception.training.averaging import averaged_weights


def weights(seed: int) -> dict[str, Tensor]:
    rng = torch.Generator().manual_seed(seed)
    return {
        "kernel": torch.randn(3, 2, generator=rng),
        "steps": torch.tensor(seed),
        "half": torch.ones(2).half() * seed,
    }


def test_weights_are_the_mean_and_whole_numbers_the_last() -> None:
    one, two, three = weights(1), weights(2), weights(3)
    mean = averaged_weights([one, two, three])
    torch.testing.assert_close(3 * mean["kernel"], one["kernel"] + two["kernel"] + three["kernel"])
    assert mean["steps"] == 3
    assert mean["half"].dtype == torch.float16
    assert mean["half"].tolist() == [2.0, 2.0]


def test_what_was_learnt_in_opposite_directions_is_unlearnt() -> None:
    before, change = weights(1)["kernel"], weights(2)["kernel"]
    mean = averaged_weights([{"kernel": before + change}, {"kernel": before - change}])
    torch.testing.assert_close(mean["kernel"], before)


def test_the_models_themselves_are_left_as_they_are() -> None:
    one, two = weights(1), weights(2)
    averaged_weights([one, two])
    torch.testing.assert_close(one["kernel"], weights(1)["kernel"])
    torch.testing.assert_close(two["kernel"], weights(2)["kernel"])


def test_held_out_is_only_what_none_was_shown() -> None:
    facts = averaged_facts([{"held_out": ["red mug", "blue pen"]}, {"held_out": ["blue pen"], "categories": ["mug"]}])
    assert facts == {"held_out": ["blue pen"], "categories": ["mug"], "average_of": 2}


@pytest.mark.parametrize(
    ("models", "told"),
    [
        ([weights(1)], "name two or more"),
        ([weights(1), {"kernel": torch.ones(3, 2)}], "architectures differ"),
        ([weights(1), {**weights(1), "kernel": torch.ones(2, 3)}], "architectures differ"),
    ],
)
def test_models_without_a_mean_are_told(models: list[dict[str, Tensor]], told: str) -> None:
    with pytest.raises(InputError, match=told):
        averaged_weights(models)
