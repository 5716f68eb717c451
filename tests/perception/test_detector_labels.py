"""What boxes are learnt as."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from zavis_bt.perception.detector import ClipLabelling, DetectorConfig, ProposalLabelling
from zavis_bt.perception.detector.clustering import Clusters, free_energy
from zavis_bt.perception.detector.mln import Mixture
from zavis_bt.perception.detector.proposals import Proposals, Target, relabel
from zavis_bt.perception.detector.pseudo_labels import pseudo_count
from zavis_bt.perception.detector.rois import sample

UNKNOWN, BACKGROUND = 2, 3
IMAGES = torch.zeros(1, 3, 120, 160)


def boxes(*rows: tuple[float, ...]) -> torch.Tensor:
    return torch.tensor(rows, dtype=torch.float32).reshape(-1, 4)


def target(*known: tuple[float, ...], ignored: tuple[tuple[float, ...], ...] = ()) -> Target:
    return Target(boxes(*known), torch.ones(len(known), dtype=torch.long), boxes(*ignored))


def proposed(*rows: tuple[float, ...]) -> Proposals:
    scores = torch.linspace(0.9, 0.1, len(rows))
    return Proposals([boxes(*rows)], [scores], [], torch.zeros(0), torch.zeros(0))


@pytest.mark.parametrize(("iteration", "count"), [(0, 1), (333, 1), (334, 2), (666, 2), (667, 3), (999, 3)])
def test_number_of_pseudo_labels_grows_in_three_steps(iteration: int, count: int) -> None:
    assert pseudo_count(iteration, 1000) == count


def test_best_proposals_that_clip_takes_for_things_become_unknown() -> None:
    rows = [(0, 0, 20, 20), (30, 0, 50, 20), (60, 0, 80, 20), (90, 0, 110, 20), (120, 0, 140, 20), (0, 40, 20, 60)]
    chances = np.array([0.95, 0.2, 0.99, 0.91, 0.7], dtype=np.float32)
    shown: list[tuple[int, ...]] = []

    def objectness(rgb: np.ndarray, asked: np.ndarray) -> np.ndarray:
        shown.append(rgb.shape)
        return chances[: len(asked)]

    labels = target((120, 0, 140, 20))
    ClipLabelling(objectness)(IMAGES, proposed(*rows), [labels], progress=0.5)
    assert labels.pseudo.tolist() == [[0, 0, 20, 20], [60, 0, 80, 20]]
    assert labels.ignored.tolist() == [[90, 0, 110, 20], [0, 40, 20, 60]]  # the third of two, and a doubtful one
    assert shown == [(120, 160, 3)]


def test_no_pseudo_labels_before_proposals_are_boxes() -> None:
    labels = target()
    ClipLabelling(lambda rgb, asked: np.ones(len(asked), np.float32))(
        IMAGES, proposed((0, 0, 20, 20)), [labels], progress=0.01
    )
    assert not len(labels.pseudo)


def test_overlapping_proposals_are_one_thing() -> None:
    labels = target()
    everything = ClipLabelling(lambda rgb, asked: np.ones(len(asked), np.float32))
    everything(IMAGES, proposed((0, 0, 20, 20), (1, 0, 21, 20), (0, 1, 20, 21)), [labels], progress=0.9)
    assert labels.pseudo.tolist() == [[0, 0, 20, 20]]


def test_ore_takes_the_best_proposal_that_is_no_known_thing() -> None:
    labels = target((0, 0, 20, 20))
    ProposalLabelling()(IMAGES, proposed((1, 0, 20, 20), (60, 0, 80, 20), (90, 0, 110, 20)), [labels], progress=0.0)
    assert labels.pseudo.tolist() == [[60, 0, 80, 20]]


def test_boxes_are_learnt_as_what_they_lie_on() -> None:
    labels = target((0, 0, 20, 20), ignored=((100, 0, 120, 20),))
    labels.pseudo = boxes((60, 0, 80, 20))
    proposals = boxes((0, 1, 20, 20), (60, 1, 80, 20), (100, 1, 120, 20), (140, 90, 160, 120), (60, 0, 80, 50))
    chosen = sample(proposals, labels, UNKNOWN, BACKGROUND)
    found = {tuple(box): int(label) for box, label in zip(chosen.boxes.tolist(), chosen.labels, strict=True)}
    assert found[(0, 1, 20, 20)] == 1
    assert found[(60, 1, 80, 20)] == UNKNOWN
    assert found[(140, 90, 160, 120)] == BACKGROUND
    assert (100, 1, 120, 20) not in found  # on an ignored region
    assert (60, 0, 80, 50) not in found  # too near a pseudo label for background, too far for the thing


def test_anchors_on_ignored_regions_are_neither_thing_nor_background() -> None:
    labels = target(ignored=((0, 0, 20, 20),))
    labels.pseudo = boxes((60, 0, 80, 20))
    anchors = boxes((0, 0, 18, 20), (60, 0, 78, 20), (100, 0, 120, 20), (60, 0, 80, 50))
    marks = torch.zeros(4)
    relabel(marks, anchors, labels)
    assert marks.tolist() == [-1, 1, 0, -1]


def test_free_energy_falls_with_the_known_logits_only() -> None:
    quiet, loud = torch.zeros(1, 1, 4), torch.tensor([[[9.0, 0.0, 0.0, 0.0]]])
    other = torch.tensor([[[0.0, 0.0, 9.0, 9.0]]])
    energies = [free_energy(Mixture(each, torch.zeros(1, 1)), known=2).item() for each in (quiet, loud, other)]
    assert energies[0] == pytest.approx(-np.log(2), rel=1e-5)
    assert energies[1] < energies[0] == pytest.approx(energies[2])


def test_boxes_are_unknown_where_their_energy_is_likelier_so() -> None:
    clusters = Clusters(DetectorConfig(("cup", "sofa"), method="ore"), 8)
    clusters.known_energy.add(torch.tensor([-9.0, -8.0, -10.0]))
    clusters.unknown_energy.add(torch.tensor([-2.0, -1.0, -3.0]))
    logits = torch.tensor([[[9.0, 0.0, 0.0, 0.0]], [[1.0, 0.0, 3.0, 0.0]]])
    assert clusters.is_unknown(Mixture(logits, torch.zeros(2, 1))).tolist() == [False, True]


def test_features_near_their_own_prototype_cost_least() -> None:
    clusters = Clusters(DetectorConfig(("cup", "sofa"), method="ore"), 2)
    clusters.prototypes.copy_(torch.tensor([[0.0, 0.0], [30.0, 0.0], [0.0, 30.0]]))
    clusters.seen.fill_(1)
    clusters.steps.fill_(1000)
    clusters.frozen = True
    labels = torch.tensor([0, 1])
    good = clusters.loss(torch.tensor([[0.0, 0.0], [30.0, 0.0]]), labels)
    bad = clusters.loss(torch.tensor([[30.0, 0.0], [0.0, 0.0]]), labels)
    assert good.item() == pytest.approx(0, abs=1e-4)
    assert bad.item() == pytest.approx((30 + 10 + 30 + 10) / 6, rel=1e-4)
