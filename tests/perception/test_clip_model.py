"""CLIP models: loading, what they return, what is said of models that cannot be loaded."""

import json
import resource
import shutil
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from zavis_bt.errors import InputError
from zavis_bt.perception.clip import ClipMatcher, ClipModel, ClipObjectness
from zavis_bt.perception.clip.crops import Preprocessing, cut_out
from zavis_bt.perception.clip.folding import fold_batch_norms
from zavis_bt.perception.clip.loading import CONFIG, SHIPPED, WEIGHTS, load_parts
from zavis_bt.perception.clip.prompts import photo_of
from zavis_bt.types import Box, CameraIntrinsics, RgbdFrame


@pytest.fixture(scope="module")
def model() -> ClipModel:
    torch.set_num_threads(1)
    return ClipModel.load("zavis-tiny")


def crops_of(*shapes: tuple[int, int]) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.integers(0, 256, (*shape, 3), dtype=np.uint8) for shape in shapes]


def test_vectors_have_unit_length(model: ClipModel) -> None:
    images = model.encode_images(crops_of((40, 20), (1, 1), (3, 200)))
    texts = model.encode_texts(["red wallet", "sofa"])
    assert images.shape == (3, model.dimension)
    assert texts.shape == (2, model.dimension)
    for vectors in (images, texts):
        np.testing.assert_allclose(vectors.norm(dim=1).numpy(), 1, atol=1e-5)


def test_scores_are_a_hundred_times_the_cosine(model: ClipModel) -> None:
    crops, texts = crops_of((40, 20), (30, 30)), ["red wallet", "sofa", "wall"]
    expected = 100 * model.encode_images(crops) @ model.encode_texts(texts).T
    scores = model.scores(crops, texts)
    assert scores.dtype == np.float32
    np.testing.assert_allclose(scores, expected.numpy(), rtol=1e-4, atol=1e-3)
    assert model.scores([], texts).shape == (0, 3)
    assert model.scores(crops, []).shape == (2, 0)
    assert model.encode_images([]).shape == (0, model.dimension)


def test_batches_do_not_change_scores(model: ClipModel) -> None:
    crops = crops_of(*[(20 + k, 30) for k in range(70)])
    together, alone = model.scores(crops, ["mug"]), model.scores(crops[66:67], ["mug"])
    np.testing.assert_allclose(together[66], alone[0], atol=1e-3)


def test_articles_spaces_and_case_do_not_matter(model: ClipModel) -> None:
    vectors = model.encode_texts(["red wallet", "the red  wallet", "A photo of red wallet", "My Red Wallet"])
    np.testing.assert_allclose(vectors.numpy(), vectors[:1].expand(4, -1).numpy(), atol=1e-5)
    assert photo_of("the red wallet") == "a photo of red wallet"
    assert photo_of("an") == "a photo of an"


def test_words_that_were_never_learnt_are_left_out(model: ClipModel) -> None:
    plain, adorned, strange = model.encode_texts(["red wallet", "red zirconium wallet", "zirconium"])
    torch.testing.assert_close(adorned, plain)
    assert torch.isfinite(strange).all()
    assert not torch.allclose(strange, plain, atol=0.1)


def test_texts_are_encoded_once(model: ClipModel, monkeypatch: pytest.MonkeyPatch) -> None:
    before = model.encode_texts(["a green globe"])
    monkeypatch.setattr(model, "_tokenizer", lambda texts: pytest.fail(f"{texts} encoded again"))
    assert torch.equal(model.encode_texts(["a green globe", "green globe"]), before.expand(2, -1))


def test_crops_without_pixels_are_refused(model: ClipModel) -> None:
    with pytest.raises(InputError, match="crop of shape"):
        model.encode_images([np.zeros((0, 4, 3), dtype=np.uint8)])
    with pytest.raises(InputError, match="no text"):
        model.encode_texts([])


def test_long_things_are_shown_whole() -> None:
    look = Preprocessing(64, (0.5, 0.5, 0.5), (0.25, 0.25, 0.25))
    rod = np.zeros((10, 200, 3), dtype=np.uint8)
    rod[:, :10], rod[:, -10:] = 255, 255
    image = look.apply([rod])[0]
    assert image.shape == (3, 64, 64)
    assert image[:, 32, 0].min() > 1.5  # both bright ends are there
    assert image[:, 32, 63].min() > 1.5
    assert image[:, 0].abs().max() < 0.02  # beside it the mean colour


def test_boxes_beyond_the_image_still_show_a_pixel() -> None:
    rgb = np.zeros((6, 8, 3), dtype=np.uint8)
    boxes = np.array([[-5, -5, -1, -1], [7.5, 5.5, 20, 20], [1.2, 1.2, 3.1, 2.9]])
    assert [crop.shape for crop in cut_out(rgb, boxes)] == [(1, 1, 3), (1, 1, 3), (2, 3, 3)]


def test_an_image_of_8000_by_6000_is_matched(model: ClipModel) -> None:
    rgb = np.zeros((6000, 8000, 3), dtype=np.uint8)
    scores = ClipMatcher(model).match_image(rgb, np.array([[0, 0, 8000, 6000], [10, 10, 11, 11]]), ["sofa"])
    assert scores.shape == (2, 1)
    assert np.isfinite(scores).all()


def test_matcher_scores_boxes_of_a_frame(model: ClipModel) -> None:
    rgb = crops_of((48, 64))[0]
    camera = CameraIntrinsics.from_fov(64, 48, 1.0)
    frame = RgbdFrame(camera, np.eye(4), 0.0, lambda: (rgb, np.ones((48, 64), dtype=np.float32)))
    boxes = [Box(4, 4, 20, 30), Box(30, 10, 60, 40)]
    scores = ClipMatcher(model).match(frame, boxes, ["mug", "sofa"])
    np.testing.assert_allclose(scores, model.scores([frame.crop(box) for box in boxes], ["mug", "sofa"]), atol=1e-4)
    assert ClipMatcher(model).match(frame, [], ["mug"]).shape == (0, 1)


def test_objectness_is_the_share_of_the_eleven_prompts(model: ClipModel) -> None:
    rgb = crops_of((48, 64))[0]
    objectness = ClipObjectness(model)(rgb, np.array([[4, 4, 20, 30], [0, 0, 64, 48]]))
    assert objectness.shape == (2,)
    assert ((objectness >= 0) & (objectness <= 1)).all()
    assert ClipObjectness(model)(rgb, np.zeros((0, 4))).shape == (0,)


def test_folding_keeps_the_vectors() -> None:
    network = load_parts("zavis-tiny", None).network
    images = torch.rand(2, 3, network.visual.image_size, network.visual.image_size)
    with torch.inference_mode():
        before = network.encode_image(images)
        fold_batch_norms(network.visual)
        after = network.encode_image(images)
    torch.testing.assert_close(after, before, atol=1e-4, rtol=1e-3)
    assert not any(isinstance(module, torch.nn.BatchNorm2d) for module in network.modules())


def test_models_that_do_not_exist_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'ViT-B-32'"):
        ClipModel.load("ViT-B32")
    with pytest.raises(InputError, match="no weights named"):
        ClipModel.load("ViT-B-32")
    with pytest.raises(InputError, match="neither a file nor a published tag"):
        ClipModel.load("ViT-B-32", "nonsense")
    with pytest.raises(InputError, match=r"is no CLIP model \(a folder with"):
        ClipModel.load(str(tmp_path))


def test_folders_with_faults_are_told_in_one_line(tmp_path: Path) -> None:
    shipped = SHIPPED["zavis-tiny"]
    shutil.copy(shipped / CONFIG, tmp_path)
    with pytest.raises(InputError, match="there are no weights"):
        ClipModel.load(str(tmp_path))
    (tmp_path / WEIGHTS).write_bytes((shipped / WEIGHTS).read_bytes()[:1000])
    with pytest.raises(InputError, match="fetch it again") as corrupt:
        ClipModel.load(str(tmp_path))
    assert "\n" not in str(corrupt.value)
    (tmp_path / WEIGHTS).write_bytes((shipped / WEIGHTS).read_bytes())
    document = json.loads((tmp_path / CONFIG).read_text())
    document["model_cfg"]["vision_cfg"]["width"] = 32
    (tmp_path / CONFIG).write_text(json.dumps(document))
    with pytest.raises(InputError, match="belong to another architecture"):
        ClipModel.load(str(tmp_path))
    (tmp_path / CONFIG).write_text("{")
    with pytest.raises(InputError, match="cannot be loaded"):
        ClipModel.load(str(tmp_path))


def test_a_full_size_model_runs_through_matching_within_2_gb() -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    full = ClipModel.untrained("ViT-B-32")
    rgb = crops_of((480, 640))[0]
    boxes = np.array([[0, 0, 640, 480], [5, 5, 6, 6]])
    assert full.preprocessing.size == 224
    assert ClipMatcher(full).match_image(rgb, boxes, ["red wallet"]).shape == (2, 1)
    assert full.dimension == 512
    assert ClipObjectness(full)(rgb, boxes).shape == (2,)
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024 < 2048
