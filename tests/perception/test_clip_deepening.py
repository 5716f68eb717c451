"""Deeper image towers: they say what the shallow one said, and can come to say more."""

import pytest

pytest.importorskip("torch")

import open_clip
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.deepening import deepen, deepened_config
from zavis_bt.perception.clip.loading import load_parts, model_config

CONFIG = model_config("zavis-tiny")
LAYERS = CONFIG["vision_cfg"]["layers"]
MORE = [count + number for number, count in enumerate(LAYERS)]


@pytest.fixture(scope="module")
def shallow() -> nn.Module:
    return load_parts("zavis-tiny", None).network


def vectors(network: nn.Module) -> Tensor:
    images = torch.randn(4, 3, 64, 64, generator=torch.Generator().manual_seed(0))
    return F.normalize(network.get_submodule("visual")(images), dim=-1)


def deep(shallow: nn.Module) -> nn.Module:
    network = open_clip.CLIP(**deepened_config(CONFIG, MORE)).eval()
    network.load_state_dict(deepen(shallow.state_dict(), CONFIG, MORE))
    return network


def test_a_deeper_tower_says_the_same(shallow: nn.Module) -> None:
    network = deep(shallow)
    stages = [network.get_submodule(f"visual.layer{stage}") for stage in range(1, len(LAYERS) + 1)]
    assert [len(list(stage.children())) for stage in stages] == MORE
    torch.testing.assert_close(vectors(network), vectors(shallow))


def test_new_blocks_learn_all_their_weights_from_the_second_step_on(shallow: nn.Module) -> None:
    network = deep(shallow)
    new = f"visual.layer{len(LAYERS)}.{MORE[-1] - 1}."
    parameters = {name: value for name, value in network.named_parameters() if name.startswith(new)}
    steps = torch.optim.SGD(parameters.values(), lr=0.1)
    target = torch.randn(4, CONFIG["embed_dim"], generator=torch.Generator().manual_seed(1))
    for _ in range(2):
        steps.zero_grad()
        F.mse_loss(vectors(network), F.normalize(target, dim=-1)).backward()
        steps.step()
    still = [name for name, value in parameters.items() if value.grad is None or not value.grad.any()]
    assert not still


def test_the_same_seed_gives_the_same_weights(shallow: nn.Module) -> None:
    one, same, other = (deepen(shallow.state_dict(), CONFIG, MORE, seed=seed) for seed in (1, 1, 2))
    name = f"visual.layer{len(LAYERS)}.{MORE[-1] - 1}.conv1.weight"
    assert torch.equal(one[name], same[name])
    assert not torch.equal(one[name], other[name])


def test_towers_that_cannot_be_made_deeper_are_told() -> None:
    fewer = [LAYERS[0], LAYERS[1] - 1, *LAYERS[2:]]
    for config, layers, told in (
        (CONFIG, LAYERS, "none below these"),
        (CONFIG, fewer, "none below these"),
        (CONFIG, [*MORE, 1], f"{len(LAYERS)} numbers"),
        (open_clip.get_model_config("ViT-B-32"), MORE, "only image towers of residual blocks"),
    ):
        with pytest.raises(InputError, match=told):
            deepened_config(config, layers)
