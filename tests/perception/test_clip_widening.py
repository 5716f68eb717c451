"""Wider image towers: they say what the narrow one said, and can come to say more."""

import pytest

pytest.importorskip("torch")

import open_clip
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.loading import load_parts, model_config
from zavis_bt.perception.clip.widening import widen, widened_config

CONFIG = model_config("zavis-tiny")
WIDTH = CONFIG["vision_cfg"]["width"]


@pytest.fixture(scope="module")
def narrow() -> nn.Module:
    return load_parts("zavis-tiny", None).network


def vectors(network: nn.Module) -> Tensor:
    images = torch.randn(4, 3, 64, 64, generator=torch.Generator().manual_seed(0))
    with torch.no_grad():
        return F.normalize(network.get_submodule("visual")(images), dim=-1)


def wide(narrow: nn.Module, width: int, noise: float) -> nn.Module:
    network = open_clip.CLIP(**widened_config(CONFIG, width)).eval()
    network.load_state_dict(widen(narrow.state_dict(), CONFIG, width, noise=noise))
    return network


@pytest.mark.parametrize("width", [WIDTH + 2, WIDTH + 8, 2 * WIDTH, 3 * WIDTH])
def test_a_wider_tower_says_the_same(narrow: nn.Module, width: int) -> None:
    network = wide(narrow, width, noise=0.0)
    torch.testing.assert_close(vectors(network), vectors(narrow), atol=1e-4, rtol=1e-3)
    assert network.get_parameter("visual.conv3.weight").shape[0] == width


def test_noise_parts_the_copies_and_changes_little(narrow: nn.Module) -> None:
    network = wide(narrow, 2 * WIDTH, noise=0.04)
    assert (vectors(network) * vectors(narrow)).sum(dim=-1).min() > 0.8
    kernels = network.get_parameter("visual.layer1.0.conv2.weight").flatten(1)
    assert len(kernels.unique(dim=0)) == len(kernels) == 2 * WIDTH


def test_towers_that_cannot_be_made_wider_are_told() -> None:
    for config, width, told in (
        (CONFIG, WIDTH, "an even number above"),
        (CONFIG, WIDTH + 1, "an even number above"),
        (open_clip.get_model_config("ViT-B-32"), 1024, "only image towers of residual blocks"),
    ):
        with pytest.raises(InputError, match=told):
            widened_config(config, width)
