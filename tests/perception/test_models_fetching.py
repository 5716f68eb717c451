"""Fetching from a server on this machine that answers as torch's and the hub do."""

from __future__ import annotations

import hashlib
import http.server
import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from safetensors.numpy import save

from zavis_bt.errors import InputError
from zavis_bt.perception.models import ModelEntry, ModelStore, download, manifest
from zavis_bt.perception.models.seals import read_seal

WEIGHTS = save({"w": np.arange(100.0)})
SUM = hashlib.sha256(WEIGHTS).hexdigest()
KNOWN = {"purpose": "test", "licence": "Apache-2.0", "trained_on": "nothing"}


class Handler(http.server.BaseHTTPRequestHandler):
    files: ClassVar[dict[str, bytes]] = {}

    def do_GET(self) -> None:
        content = self.files.get(self.path.rsplit("/", 1)[-1])
        self.send_response(404 if content is None else 200)
        if content is None:
            self.send_header("X-Error-Code", "EntryNotFound")
        else:
            self.send_header("ETag", f'"{hashlib.sha256(content).hexdigest()}"')
            self.send_header("X-Repo-Commit", "0" * 40)
        self.send_header("Content-Length", str(len(content or b"")))
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(content or b"")

    do_HEAD = do_GET

    def log_message(self, *arguments: object) -> None:
        pass


@pytest.fixture
def files(monkeypatch: pytest.MonkeyPatch) -> dict[str, bytes]:
    monkeypatch.setattr(Handler, "files", {})
    return Handler.files


@pytest.fixture
def address(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def store(tmp_path: Path) -> ModelStore:
    return ModelStore(tmp_path / "models")


def know(monkeypatch: pytest.MonkeyPatch, **entry: object) -> None:
    monkeypatch.setitem(manifest(), "test", ModelEntry.model_validate(KNOWN | entry))


@pytest.mark.parametrize("name", ["net.safetensors", f"net-{SUM[:8]}.safetensors"])
def test_a_file_is_fetched_and_sealed(
    store: ModelStore, address: str, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    files[name] = WEIGHTS
    know(monkeypatch, form="file", url=f"{address}/{name}", files=[name])
    received: list[int] = []
    path = download(store, "test", progress=received.append)
    assert path.read_bytes() == WEIGHTS
    assert sum(received) == len(WEIGHTS)
    assert store.find("test") == path
    seal = read_seal(path.parent)
    assert seal is not None
    assert seal.files[name].sha256 == SUM


def test_a_file_of_another_sum_than_its_name_says_is_refused(
    store: ModelStore, address: str, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    files["net-00000000.safetensors"] = WEIGHTS
    know(monkeypatch, form="file", url=f"{address}/net-00000000.safetensors", files=["net-00000000.safetensors"])
    with pytest.raises(InputError, match="another SHA-256 than published"):
        download(store, "test")
    assert store.state("test").state == "missing"


def test_a_file_that_is_gone_is_said_with_what_to_do(
    store: ModelStore, address: str, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    know(monkeypatch, form="file", url=f"{address}/net.pt", files=["net.pt"])
    with pytest.raises(InputError, match=r"net\.pt is out of reach: .*404.*zavis models add test FILE"):
        download(store, "test")
    assert store.state("test").state == "missing"


def test_a_place_out_of_reach_is_said_with_what_to_do(
    store: ModelStore, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    nobody = address.rsplit(":", 1)[0] + ":9"
    know(monkeypatch, form="file", url=f"{nobody}/net.pt", files=["net.pt"])
    with pytest.raises(InputError, match=r"is out of reach: .*download .*, then: zavis models add test FILE") as caught:
        download(store, "test")
    assert "\n" not in str(caught.value)


@pytest.fixture
def hub(address: str, monkeypatch: pytest.MonkeyPatch) -> str:
    constants = pytest.importorskip("huggingface_hub.constants")
    monkeypatch.setenv("HF_ENDPOINT", address)
    monkeypatch.setattr(constants, "HF_HUB_OFFLINE", False)
    monkeypatch.setattr(constants, "HF_HUB_DISABLE_PROGRESS_BARS", True)
    return address


CLIP = ["open_clip_config.json", "open_clip_model.safetensors | open_clip_pytorch_model.bin"]


def test_a_folder_is_fetched_from_the_hub_and_sealed(
    store: ModelStore, hub: str, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    files["open_clip_config.json"] = json.dumps({"model_cfg": {"embed_dim": 8}}).encode()
    files["open_clip_model.safetensors"] = WEIGHTS
    know(monkeypatch, form="open_clip", hub="somebody/clip", files=CLIP)
    folder = download(store, "test")
    assert (folder / "open_clip_model.safetensors").read_bytes() == WEIGHTS
    assert sorted(path.name for path in folder.iterdir()) == [
        "open_clip_config.json",
        "open_clip_model.safetensors",
        "seal.json",
    ]
    assert store.find("test") == folder


def test_a_file_that_the_hub_lacks_is_named(
    store: ModelStore, hub: str, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    files["open_clip_config.json"] = b"{}"
    know(monkeypatch, form="open_clip", hub="somebody/clip", files=CLIP)
    with pytest.raises(InputError, match=r"holds no open_clip_model\.safetensors or open_clip_pytorch_model\.bin"):
        download(store, "test")
    assert list(store.root.iterdir()) == []


def test_a_hub_out_of_reach_is_said_at_once(store: ModelStore, hub: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HF_ENDPOINT", hub.rsplit(":", 1)[0] + ":9")
    with pytest.raises(InputError, match=r"is out of reach: .*download config\.json, .* zavis models add comet FOLDER"):
        download(store, "comet")


def test_a_hub_that_must_not_be_asked_is_not(store: ModelStore, hub: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("huggingface_hub.constants.HF_HUB_OFFLINE", True)
    with pytest.raises(InputError, match="HF_HUB_OFFLINE"):
        download(store, "comet")


def test_without_the_hubs_library_the_extra_is_named(store: ModelStore, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("zavis_bt.perception.models.fetching.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"needs huggingface_hub \(pip install 'zavis_bt\[neural\]'"):
        download(store, "comet")


@pytest.mark.parametrize(("name", "problem"), [("zavis-tiny", "comes along"), ("mine", "published nowhere")])
def test_what_nobody_publishes_cannot_be_fetched(store: ModelStore, name: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        download(store, name)
