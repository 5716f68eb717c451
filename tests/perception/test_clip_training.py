"""Training a matcher: its parts by hand, and that it learns."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch")

import torch
import torch.nn.functional as F

from sim.labelled_frames import FrameRecipe, write_frames
from zavis_bt.errors import InputError
from zavis_bt.perception.clip import ClipModel
from zavis_bt.perception.clip.augment import Augmentation, boxes_near, coarsen, cut_squares, repaint
from zavis_bt.perception.clip.backgrounds import draw_backgrounds
from zavis_bt.perception.clip.batches import CropBatches
from zavis_bt.perception.clip.captions import EMPTY, NO_COLOUR, Captions, CaptionWriter
from zavis_bt.perception.clip.colours import held_out_pairs, many_coloured, untold_pairs
from zavis_bt.perception.clip.half_size import can_halve, reading_half_size
from zavis_bt.perception.clip.heads import Labels, label_loss, untold_colour_loss
from zavis_bt.perception.clip.loading import build_untrained
from zavis_bt.perception.clip.loss import contrastive_loss
from zavis_bt.perception.clip.patches import Patches, collect_patches, cut_patch
from zavis_bt.perception.clip.settings import MatcherSettings
from zavis_bt.perception.clip.training import KEPT, MatcherTraining
from zavis_bt.perception.clip.vocabulary import Vocabulary
from zavis_bt.perception.datasets import open_dataset

WORDS = Vocabulary(kinds={"furniture": ("sofa",), "transport": ()}, synonyms={"sofa": ("couch",)})
COLOURS = ("red", "blue", "green", "white", "black", "pink", "grey")


class Figures:
    def __init__(self) -> None:
        self.losses: list[float] = []

    def write(self, iteration: int, losses: dict[str, float], rate: float) -> None:
        self.losses.append(losses["contrast"] + losses["naming"])


@pytest.fixture(scope="module")
def patches(tmp_path_factory: pytest.TempPathFactory) -> Patches:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("matcher")
    recipe = FrameRecipe(seed=91, width=160, categories=("sofa", "fridge", "plant"), least_side=6.0)
    list(write_frames(folder / "data", 24, recipe))
    return collect_patches(open_dataset(folder / "data"), folder / "patches", 64)


def training(patches: Patches, **changes: Any) -> MatcherTraining:
    settings = replace(MatcherSettings(steps=14, batch=12, more_captions=4, learning_rate=3e-3), **changes)
    return MatcherTraining(build_untrained("zavis-tiny"), patches, WORDS, settings)


def test_loss_of_one_pair_each_is_infonce() -> None:
    images, texts = F.normalize(torch.randn(4, 8), dim=1), F.normalize(torch.randn(4, 8), dim=1)
    logits = 10 * images @ texts.T
    labels = torch.arange(4)
    expected = (F.cross_entropy(logits, labels) + F.cross_entropy(logits.T, labels)) / 2
    own = torch.eye(4, dtype=torch.bool)
    loss = contrastive_loss(images, texts, own, own, torch.tensor(10.0))
    torch.testing.assert_close(loss, expected)


def test_true_captions_of_others_are_no_mistakes() -> None:
    images = F.normalize(torch.tensor([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), dim=1)
    true = torch.tensor([[True, True, False], [True, True, False], [False, False, True]])
    own = torch.eye(3, dtype=torch.bool)
    alike = contrastive_loss(images, images, true, true, torch.tensor(50.0))
    assert alike < 1e-6  # told apart from what is wrong
    assert contrastive_loss(images, images, own, own, torch.tensor(50.0)) > 0.3


def test_captions_that_may_be_true_say_nothing() -> None:
    images, texts = F.normalize(torch.randn(3, 8), dim=1), F.normalize(torch.randn(4, 8), dim=1)
    true = torch.eye(3, 4, dtype=torch.bool)
    possible = true.clone()
    possible[0, 3] = True
    other = texts.clone()
    other[3] = -images[0]

    def image_losses(captions: torch.Tensor, possible: torch.Tensor) -> torch.Tensor:
        return contrastive_loss(images[:1], captions[[0, 3]], true[:1, [0, 3]], possible[:1, [0, 3]], torch.tensor(9.0))

    torch.testing.assert_close(image_losses(texts, possible), image_losses(other, possible))
    assert not torch.isclose(image_losses(texts, true), image_losses(other, true))


def test_captions_are_true_of_their_own_crops() -> None:
    writer = CaptionWriter(["sofa", "plant"], ["red", "blue"], WORDS)
    categories, colours = np.array([0, 0, 1, 2, 3]), np.array([0, 1, NO_COLOUR, NO_COLOUR, NO_COLOUR])
    for seed in range(20):
        captions = writer.write(categories, colours, np.random.default_rng(seed))
        true = writer.true_of(categories, colours, captions)
        assert true[np.arange(5), np.arange(5)].all()
        assert not true[:, 5:].any()  # words without examples are true of nothing
        assert all("transport" in text for text in captions.texts[5:])
        for j, text in enumerate(captions.texts[:5]):
            assert not ("red" in text.split() and true[1, j])
            assert not (("couch" in text or "furniture" in text) and true[2, j])


def test_repainted_crops_change_their_hue_alone() -> None:
    plain = torch.tensor([[200.0, 40, 40], [90, 90, 90], [200, 40, 40]])[:, :, None, None].expand(3, 3, 5, 5)
    chosen = torch.tensor([True, True, False])
    painted = repaint(plain.clone(), chosen, torch.Generator().manual_seed(0))
    torch.testing.assert_close(painted.sort(dim=1).values, plain.sort(dim=1).values)
    torch.testing.assert_close(painted[1:], plain[1:])  # grey, and not chosen
    seen = {
        tuple(repaint(plain.clone(), chosen, torch.Generator().manual_seed(k))[0, :, 0, 0].tolist()) for k in range(9)
    }
    assert len(seen) > 1


def painted(patches: Patches) -> Patches:
    """Return patches of which every category has every colour."""
    kinds = patches.categories
    turns = np.array([np.count_nonzero(kinds[:row] == kind) for row, kind in enumerate(kinds)])
    colours = np.where(patches.background, NO_COLOUR, turns % len(COLOURS)).astype(np.int32)
    return replace(patches, colours=colours, colour_names=COLOURS)


def test_the_colour_of_repainted_crops_is_not_known(patches: Patches) -> None:
    patches = painted(patches)
    settings = MatcherSettings(batch=200, augmentation=Augmentation(repainted=0.5))
    writer = CaptionWriter(patches.names, patches.colour_names, WORDS)
    batches = CropBatches(patches, writer, build_untrained("zavis-tiny").preprocessing, settings)
    batch = batches.draw(0, 32)
    own = torch.arange(len(batch.images))
    unsure = (batch.possible & ~batch.true).any(dim=1)
    assert (batch.labels.colours[unsure] == NO_COLOUR).all()
    assert 0.2 < unsure.float().mean() < 0.8
    assert batch.true[own, own].all()
    assert (batch.possible | ~batch.true).all()


def test_pairs_are_held_out_of_what_comes_in_many_colours_only() -> None:
    pairs = {(colour, f"thing {k}") for colour in COLOURS for k in range(60)} | {
        ("orange", f"fruit {k}") for k in range(60)
    }
    held = held_out_pairs(pairs)
    assert held <= pairs
    assert {category.split()[0] for _, category in held} == {"thing"}
    assert 0.05 < len(held) / 420 < 0.17
    assert held_out_pairs(sorted(pairs) * 2) == held
    assert many_coloured(pairs | {("", "glass")}) == {f"thing {k}" for k in range(60)}


def test_a_pair_never_seen_is_untold_where_a_category_has_many_colours() -> None:
    pairs = {(colour, name) for colour in COLOURS for name in ("sofa", "mug")} | {("red", "tomato"), ("", "glass")}
    assert untold_pairs(pairs) == frozenset()
    assert untold_pairs(pairs - {("white", "sofa")}) == {("white", "sofa")}  # but not ("white", "tomato")


def test_labels_are_not_told_from_untold_ones() -> None:
    of_category, of_colour = torch.randn(2, 4), torch.randn(2, 3)
    untold_categories, untold_colours = torch.zeros(2, 4, dtype=torch.bool), torch.zeros(2, 3, dtype=torch.bool)
    untold_categories[0, 1] = untold_colours[1, 2] = True
    labels = Labels(torch.tensor([0, 3]), torch.tensor([0, 1]), untold_categories, untold_colours)
    first, second = (
        F.cross_entropy(of_category[:1, [0, 2, 3]], torch.tensor([0])),
        F.cross_entropy(of_category[1:], torch.tensor([3])),
    )
    colours = F.cross_entropy(of_colour[:1], torch.tensor([0])) + F.cross_entropy(of_colour[1:, :2], torch.tensor([1]))
    torch.testing.assert_close(label_loss(of_category, of_colour, labels), (first + second) / 2 + colours / 4)


def test_untold_colours_are_excluded_no_more_firmly_than_told_ones() -> None:
    grey, white = 0, 1
    untold = torch.tensor([[False, False], [False, False], [False, True], [False, True]])
    labels = Labels(torch.zeros(4), torch.tensor([grey, grey, grey, grey]), torch.zeros(4, 1), untold)
    logits = torch.tensor([[4.0, 1.0], [2.0, -3.0], [5.0, -1.0], [5.0, 4.0]], requires_grad=True)
    loss = untold_colour_loss(logits, labels)
    assert loss.item() == pytest.approx((2.0 + 0.0) / 2)  # gaps 3 and 5 where white is told; 6 and 1 where it is not
    (slope,) = torch.autograd.grad(loss, logits)
    assert slope[2, grey] > 0 > slope[2, white]
    assert not slope[[0, 1, 3]].any()


def test_nothing_is_said_of_untold_colours_without_a_comparison() -> None:
    untold = torch.tensor([[False, True], [False, False]])
    labels = Labels(torch.zeros(2), torch.tensor([0, NO_COLOUR]), torch.zeros(2, 1), untold)
    assert untold_colour_loss(torch.tensor([[9.0, 0.0], [9.0, 0.0]]), labels) == 0
    nothing = Labels(torch.zeros(1), torch.tensor([NO_COLOUR]), torch.zeros(1, 1), untold[:1])
    assert untold_colour_loss(torch.tensor([[9.0, 0.0]]), nothing) == 0


def test_captions_say_nothing_of_untold_pairs() -> None:
    writer = CaptionWriter(["sofa", "mug"], COLOURS, WORDS)
    white, grey = COLOURS.index("white"), COLOURS.index("grey")
    untold = np.zeros((4, len(COLOURS)), dtype=bool)
    untold[0, white] = True  # no white sofa
    nouns = {text: row for row, text in enumerate(writer._texts)}
    said = [
        ("sofa", white),
        ("furniture", white),
        ("mug", white),
        ("sofa", grey),
        ("sofa", NO_COLOUR),
        ("mug", NO_COLOUR),
    ]
    captions = Captions(
        tuple(name for name, _ in said), np.array([nouns[name] for name, _ in said]), np.array([c for _, c in said])
    )
    crops = [(0, grey), (1, white), (0, NO_COLOUR)]  # grey sofa, white mug, sofa
    categories, colours = (np.array([crop[k] for crop in crops]) for k in (0, 1))
    assert writer.untold_of(categories, colours, captions, untold).tolist() == [
        [True, True, False, False, False, False],  # "white sofa" is not told from a grey one
        [True, True, False, False, True, False],  # nor "sofa" from a white mug: it may be white, too
        [True, True, False, False, False, False],
    ]


def test_batches_leave_open_what_the_crops_leave_open(patches: Patches) -> None:
    patches = painted(patches)
    sofa, white = patches.names.index("sofa"), COLOURS.index("white")
    shown = (patches.categories != sofa) | (patches.colours != white)
    columns = ("pixels", "boxes", "limits", "lengths", "categories", "colours", "visible")
    patches = replace(patches, **{name: getattr(patches, name)[shown] for name in columns})
    writer = CaptionWriter(patches.names, COLOURS, WORDS)
    preprocessing = build_untrained("zavis-tiny").preprocessing
    labels = CropBatches(patches, writer, preprocessing, MatcherSettings(batch=200)).draw(0, 32).labels
    is_sofa, is_white = labels.categories == sofa, labels.colours == white
    assert is_sofa.any()
    assert is_white.any()
    assert torch.equal(labels.untold_colours.any(dim=1), is_sofa)
    assert labels.untold_colours[is_sofa, white].all()
    assert torch.equal(labels.untold_categories.any(dim=1), is_white)
    assert labels.untold_categories[is_white, sofa].all()


def test_backgrounds_overlap_nothing_much() -> None:
    things = np.array([[100.0, 100, 300, 300], [400, 200, 500, 450]])
    drawn = draw_backgrounds(things, (640, 480), 50, np.random.default_rng(0))
    assert len(drawn) == 50
    for box, kind in drawn:
        low, high = np.maximum(box[:2], things[:, :2]), np.minimum(box[2:], things[:, 2:])
        common = np.clip(high - low, 0, None).prod(axis=1)
        area = (box[2:] - box[:2]).prod()
        assert (common / (area + (things[:, 2:] - things[:, :2]).prod(axis=1) - common) < 0.3).all()
        assert kind != EMPTY or (common < 0.02 * area).all()


def test_patches_hold_their_boxes() -> None:
    rgb = np.zeros((100, 200, 3), dtype=np.uint8)
    rgb[20:60, 0:30] = (250, 10, 10)
    patch, box, image = cut_patch(rgb, np.array([0.0, 20.0, 30.0, 60.0]), 80)
    square, inside = cut_squares(
        torch.from_numpy(patch).permute(2, 0, 1)[None].float(),
        torch.tensor(box)[None].float(),
        torch.tensor([False]),
        64,
    )
    assert image[0] > 0  # the patch reaches beyond the image
    assert inside.float().mean() == pytest.approx(0.75, abs=0.03)  # 30 by 40
    assert (square[0, 0][inside[0, 0]] > 200).float().mean() > 0.95


def test_boxes_stay_within_their_image() -> None:
    boxes, limits = (
        torch.tensor([[0.1, 0.1, 0.9, 0.9]]).repeat(200, 1),
        torch.tensor([[0.1, 0.0, 0.92, 1.0]]).repeat(200, 1),
    )
    near = boxes_near(boxes, limits, Augmentation(), torch.Generator().manual_seed(0))
    assert (near[:, 0] >= 0.1).all()
    assert (near[:, 2] <= 0.92).all()
    assert (near[:, 2:] > near[:, :2]).all()
    assert near.std(dim=0).min() > 0.005


def test_coarse_crops_lose_detail_and_keep_their_mean() -> None:
    rng = torch.Generator().manual_seed(0)
    images = 255 * torch.rand(20, 3, 64, 64, generator=rng)
    coarse = coarsen(images.clone(), torch.full((20,), 20.0), Augmentation(coarse=1.0), rng)
    assert (coarse.flatten(1).std(dim=1) < 0.7 * images.flatten(1).std(dim=1)).all()
    torch.testing.assert_close(coarse.mean(dim=(2, 3)), images.mean(dim=(2, 3)), atol=3.0, rtol=0)


def test_half_size_reading_leaves_the_network_as_it_was() -> None:
    network = build_untrained("zavis-tiny").network
    size = network.visual.image_size
    assert can_halve(network.visual, size)
    names = {name for name, _ in network.named_parameters()}
    with reading_half_size(network.visual, size):
        network.encode_image(torch.rand(2, 3, size // 2, size // 2)).sum().backward()
    assert {name for name, _ in network.named_parameters()} == names
    assert network.visual.attnpool.positional_embedding.grad is not None


def test_a_few_steps_lower_the_loss_and_write_a_model(patches: Patches) -> None:
    run, figures = training(patches, half_size=0.0), Figures()
    run.run(figures, lambda state: None)
    assert len(figures.losses) == 14
    assert np.mean(figures.losses[-4:]) < np.mean(figures.losses[:3])
    assert all(torch.isfinite(value).all() for value in run.averaged_weights().values())


def test_training_goes_on_as_if_never_interrupted(patches: Patches, tmp_path: Path) -> None:
    whole, first = training(patches, steps=4), training(patches, steps=4, save_every=2)
    whole.run(Figures(), lambda state: None)
    first.run(Figures(), lambda state: KEPT.save(tmp_path, state) if state["done"] == 2 else None)
    again = training(patches, steps=4)
    again.resume(KEPT.load(tmp_path))
    again.run(Figures(), lambda state: None)
    for name, value in whole.averaged_weights().items():
        torch.testing.assert_close(again.averaged_weights()[name], value, msg=name)


def test_a_loss_that_is_no_number_ends_with_a_remedy(patches: Patches) -> None:
    run = training(patches)
    with torch.no_grad():
        run.network.get_parameter("logit_scale").fill_(math.nan)
    with pytest.raises(InputError, match=r"the loss is nan at step 1 \(lower --learning-rate"):
        run.run(Figures(), lambda state: None)


def test_checkpoints_with_faults_are_told(patches: Patches, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no training"):
        KEPT.load(tmp_path)
    (tmp_path / "checkpoint.pt").write_bytes(b"junk")
    with pytest.raises(InputError, match="cannot be read"):
        KEPT.load(tmp_path)
    with pytest.raises(InputError, match="of another training"):
        training(patches).resume({"network": {}, "heads": {}})


def test_words_with_faults_are_told(tmp_path: Path) -> None:
    path = tmp_path / "words.json"
    with pytest.raises(InputError, match="cannot be read"):
        Vocabulary.read(path)
    path.write_text('{"synonym": {}}')
    with pytest.raises(InputError, match=r"words.json: synonym: Extra inputs"):
        Vocabulary.read(path)


def test_full_size_models_can_be_trained_from_their_name() -> None:
    assert isinstance(ClipModel, type)
    with pytest.raises(InputError, match="is unknown"):
        build_untrained("ViT-B32x")
