from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file

from zavis_bt.errors import InputError
from zavis_bt.perception.models import ModelStore, check_form, default_root, find_weights, manifest
from zavis_bt.perception.models.seal import seal_weights
from zavis_bt.perception.models.seals import SEAL, read_seal


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ZAVIS_MODELS", str(tmp_path / "models"))
    return tmp_path / "models"


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    path = tmp_path / "mine.safetensors"
    save_file({"w": np.arange(1000.0)}, path)
    return path


def clip_folder(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "open_clip_config.json").write_text(json.dumps({"model_cfg": {"embed_dim": 8}}))
    save_file({"w": np.zeros(8)}, folder / "open_clip_model.safetensors")
    return folder


def bart_folder(folder: Path, model_type: str = "bart") -> Path:
    folder.mkdir(parents=True)
    (folder / "config.json").write_text(json.dumps({"model_type": model_type}))
    (folder / "tokenizer.json").write_text("{}")
    save_file({"w": np.zeros(8)}, folder / "model.safetensors")
    return folder


def test_an_added_file_is_found_by_its_name(root: Path, weights: Path) -> None:
    ModelStore().add("mine", weights)
    found = find_weights("mine")
    assert found == root / "mine" / "mine.safetensors"
    assert found.read_bytes() == weights.read_bytes()


def test_an_added_folder_is_found_by_its_name(root: Path, tmp_path: Path) -> None:
    ModelStore().add("vit-b-32-laion2b", clip_folder(tmp_path / "download"))
    assert find_weights("vit-b-32-laion2b") == root / "vit-b-32-laion2b"
    assert ModelStore().state("vit-b-32-laion2b").state == "added"


def test_a_path_is_taken_as_it_is(root: Path, weights: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(weights.parent)
    assert find_weights(weights) == weights
    assert find_weights(str(weights)) == weights
    assert find_weights(weights.name) == Path(weights.name)


def test_a_model_that_is_not_here_says_where_to_get_it(root: Path) -> None:
    with pytest.raises(InputError) as caught:
        find_weights("comet")
    for part in ("mismayil/comet-bart-ai2", "pytorch_model.bin", "zavis models add comet FOLDER"):
        assert part in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", [name for name, entry in manifest().items() if not entry.shipped])
def test_every_model_that_is_fetched_says_from_where(root: Path, name: str) -> None:
    with pytest.raises(
        InputError, match=rf"zavis models add {name}; .*https://.*zavis models add {name} (FILE|FOLDER)"
    ):
        find_weights(name)


def test_an_unknown_name_suggests_the_nearest(root: Path) -> None:
    with pytest.raises(InputError, match=r"neither a model nor a file of that name \(did you mean 'comet'\?\)"):
        find_weights("commet")


def test_a_path_to_nothing_is_refused(root: Path) -> None:
    with pytest.raises(InputError, match="no such file or folder"):
        find_weights("./nothing.pt")


@pytest.mark.parametrize("damage", [lambda content: content[:-1], lambda content: content[:-1] + b"x", None])
def test_changed_files_are_refused_with_what_to_do(
    root: Path, weights: Path, damage: Callable[[bytes], bytes] | None
) -> None:
    path = ModelStore().add("mine", weights)
    if damage is None:
        path.unlink()
    else:
        path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(InputError, match=r"model 'mine': .*\(zavis models add mine FILE\|FOLDER --replace\)"):
        ModelStore().find("mine")


def test_what_was_put_there_by_hand_is_trusted_once(root: Path, tmp_path: Path) -> None:
    folder = bart_folder(root / "comet")
    assert ModelStore().find("comet") == folder
    save_file({"w": np.ones(8)}, folder / "model.safetensors")
    with pytest.raises(InputError, match="SHA-256"):
        ModelStore().find("comet")


def test_another_model_of_the_name_is_replaced_only_if_asked(root: Path, weights: Path) -> None:
    store = ModelStore()
    first = store.add("mine", weights)
    assert store.add("mine", weights) == first  # the same again
    save_file({"w": np.zeros(3)}, weights)
    with pytest.raises(InputError, match=r"there is another of that name .*--replace"):
        store.add("mine", weights)
    assert store.add("mine", weights, replace=True).read_bytes() == weights.read_bytes()


def test_a_copy_that_fails_leaves_nothing(root: Path, tmp_path: Path) -> None:
    def broken(read: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ModelStore().add("vit-b-32-laion2b", clip_folder(tmp_path / "download"), progress=broken)
    assert list(root.iterdir()) == []


def test_weights_of_other_libraries_stay_behind(root: Path, tmp_path: Path) -> None:
    source = bart_folder(tmp_path / "download")
    (source / "flax_model.msgpack").write_bytes(b"x" * 100)
    (source / ".gitattributes").write_text("")
    folder = ModelStore().add("comet", source)
    assert {path.name for path in folder.iterdir()} == {"config.json", "tokenizer.json", "model.safetensors", SEAL}


@pytest.mark.parametrize("name", ["", "Mine", "../mine", "a/b", ".mine", "mine!"])
def test_names_that_are_none_are_refused(root: Path, weights: Path, name: str) -> None:
    with pytest.raises(InputError, match="is no name"):
        ModelStore().add(name, weights)


def test_what_comes_along_cannot_be_replaced(root: Path, weights: Path) -> None:
    with pytest.raises(InputError, match="comes along"):
        ModelStore().add("zavis-tiny-detector", weights)


@pytest.mark.parametrize(
    ("name", "content", "problem"),
    [
        ("a.safetensors", b"", "is empty"),
        ("a.safetensors", b"\x10\x00\x00\x00\x00\x00\x00\x00{}", "damaged or incomplete"),
        ("a.pt", b"PK\x03\x04 and the rest is missing", "damaged or incomplete"),
        ("a.pt", b"version https://git-lfs.github.com/spec/v1\noid sha256:0", "git-lfs"),
        ("a.pt", b"<!doctype html><html>not found</html>", "web page"),
        ("a.pt", b"no weights at all", "holds no weights"),
    ],
)
def test_files_that_are_no_weights_are_refused(tmp_path: Path, name: str, content: bytes, problem: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=problem):
        check_form(path)


def test_a_zip_that_torch_did_not_save_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.pt", "w") as archive:
        archive.writestr("readme.txt", "weights to come")
    with pytest.raises(InputError, match="not one that torch saved"):
        check_form(tmp_path / "a.pt")


def test_folders_that_are_incomplete_are_refused(tmp_path: Path) -> None:
    folder = bart_folder(tmp_path / "bart")
    with pytest.raises(InputError, match="model_type is 'bart'"):
        check_form(folder, "transformers", "bert")
    with pytest.raises(InputError, match=r"open_clip_config\.json: is missing"):
        check_form(folder, "open_clip")
    (folder / "tokenizer.json").unlink()
    with pytest.raises(InputError, match="holds no tokenizer"):
        check_form(folder)
    (folder / "config.json").write_text("[]")
    with pytest.raises(InputError, match="is no configuration"):
        check_form(folder)


def test_a_file_is_no_folder_and_a_folder_no_file(tmp_path: Path, weights: Path) -> None:
    with pytest.raises(InputError, match="is one file"):
        check_form(weights, "open_clip")
    with pytest.raises(InputError, match="is a folder"):
        check_form(clip_folder(tmp_path / "clip"), "file")
    with pytest.raises(InputError, match="no such file"):
        check_form(tmp_path / "nothing")


def test_a_damaged_seal_is_said(root: Path, weights: Path) -> None:
    ModelStore().add("mine", weights)
    (root / "mine" / SEAL).write_text("{")
    assert ModelStore().state("mine").state == "damaged"


def test_models_lie_in_the_users_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ZAVIS_MODELS", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert default_root() == Path("/somewhere/zavis_bt/models")
    monkeypatch.setenv("ZAVIS_MODELS", "/elsewhere")
    assert default_root() == Path("/elsewhere")


def test_sealed_weights_are_found_until_they_change(tmp_path: Path) -> None:
    save_file({"w": np.zeros(8)}, tmp_path / "zavis_tiny_detector.safetensors")
    clip_folder(tmp_path / "zavis_tiny_clip")
    store = ModelStore(tmp_path / "none", weights=tmp_path)
    with pytest.raises(InputError, match="never sealed"):
        store.find("zavis-tiny-detector")
    seal_weights(tmp_path)
    assert store.find("zavis-tiny") == tmp_path / "zavis_tiny_clip"
    assert store.find("zavis-tiny-detector") == tmp_path / "zavis_tiny_detector.safetensors"
    save_file({"w": np.ones(8)}, tmp_path / "zavis_tiny_detector.safetensors")
    with pytest.raises(InputError, match=r"SHA-256 .*\(install zavis_bt again\)"):
        store.find("zavis-tiny-detector")


def test_a_seal_names_every_file_of_a_folder_once(tmp_path: Path) -> None:
    clip_folder(tmp_path / "zavis_tiny_clip")
    seal_weights(tmp_path)
    again = seal_weights(tmp_path)
    assert set(again.files) == {
        f"zavis_tiny_clip/{name}" for name in ("open_clip_config.json", "open_clip_model.safetensors")
    }
    assert read_seal(tmp_path) == again
