"""The mixture of logit networks against sums by hand."""

import math

import pytest

torch = pytest.importorskip("torch")

from zavis_bt.perception.detector.gaussian import Gaussian
from zavis_bt.perception.detector.mln import (
    Mixture,
    MixtureHead,
    aleatoric,
    epistemic,
    mace_loss,
    total_uncertainty,
)


def mixture(shares: list[list[float]], weights: list[float]) -> Mixture:
    """One box, by the probabilities of each mixture."""
    return Mixture(torch.tensor([shares]).log(), torch.tensor([weights]).log())


TWO = mixture([[0.5, 0.25, 0.25], [0.1, 0.8, 0.1]], [0.75, 0.25])


def test_loss_is_the_cross_entropy_weighted_by_the_mixtures() -> None:
    by_hand = 0.75 * -math.log(0.25) + 0.25 * -math.log(0.8)
    assert mace_loss(TWO, torch.tensor([1])).item() == pytest.approx(by_hand, rel=1e-5)


def test_loss_of_one_mixture_is_the_cross_entropy() -> None:
    logits = torch.randn(5, 1, 4)
    labels = torch.tensor([0, 1, 2, 3, 0])
    single = Mixture(logits, torch.zeros(5, 1))
    expected = torch.nn.functional.cross_entropy(logits[:, 0], labels)
    torch.testing.assert_close(mace_loss(single, labels), expected)


def test_epistemic_uncertainty_is_the_spread_of_probabilities() -> None:
    mean = [0.75 * 0.5 + 0.25 * 0.1, 0.75 * 0.25 + 0.25 * 0.8, 0.75 * 0.25 + 0.25 * 0.1]
    spread = 0.75 * sum((a - b) ** 2 for a, b in zip([0.5, 0.25, 0.25], mean, strict=True))
    spread += 0.25 * sum((a - b) ** 2 for a, b in zip([0.1, 0.8, 0.1], mean, strict=True))
    assert epistemic(TWO).item() == pytest.approx(spread, rel=1e-5)


def test_aleatoric_uncertainty_is_the_mean_entropy() -> None:
    first = -(0.5 * math.log(0.5) + 2 * 0.25 * math.log(0.25))
    second = -(0.8 * math.log(0.8) + 2 * 0.1 * math.log(0.1))
    assert aleatoric(TWO).item() == pytest.approx(0.75 * first + 0.25 * second, rel=1e-5)


def test_agreeing_mixtures_have_no_epistemic_uncertainty() -> None:
    agreed = mixture([[0.2, 0.8], [0.2, 0.8]], [0.4, 0.6])
    assert epistemic(agreed).item() == pytest.approx(0, abs=1e-6)
    assert total_uncertainty(agreed).item() == pytest.approx(aleatoric(agreed).item(), rel=1e-5)


def test_certain_mixtures_that_contradict_have_no_aleatoric_uncertainty() -> None:
    contradicting = Mixture(torch.tensor([[[1000.0, 0.0], [0.0, 1000.0]]]), torch.tensor([[0.5, 0.5]]).log())
    assert aleatoric(contradicting).item() == pytest.approx(0, abs=1e-6)
    assert epistemic(contradicting).item() == pytest.approx(0.5, rel=1e-5)


def test_mean_probabilities_sum_to_one() -> None:
    head = MixtureHead(8, 6, 5)
    found = head(torch.randn(7, 8))
    assert found.logits.shape == (7, 5, 6)
    torch.testing.assert_close(found.mean().sum(dim=1), torch.ones(7))
    torch.testing.assert_close(found.weights.sum(dim=1), torch.ones(7))


def test_gaussian_of_parts_is_that_of_the_whole() -> None:
    values = torch.randn(101, dtype=torch.float64) * 3 + 5
    parts = Gaussian()
    for part in values.split([1, 40, 60]):
        parts.add(part)
    parts.add(values[:0])
    assert parts.mean.item() == pytest.approx(values.mean().item())
    assert parts.std.item() == pytest.approx(values.std(correction=0).item())


def test_gaussian_cdf_is_the_normal_distributions() -> None:
    fitted = Gaussian()
    fitted.add(torch.tensor([1.0, 3.0]))  # mean 2, deviation 1
    at = torch.tensor([2.0, 3.0, 2.0 + 1.2816])
    assert fitted.cdf(at).tolist() == pytest.approx([0.5, 0.8413, 0.9], abs=1e-3)
    assert fitted.log_density(torch.tensor([2.0])).item() == pytest.approx(-0.5 * math.log(2 * math.pi), abs=1e-6)


def test_nothing_is_strange_before_anything_was_fitted() -> None:
    assert Gaussian().cdf(torch.tensor([1e9])).tolist() == [0.0]
