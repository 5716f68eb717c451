"""Fetching models from where they are published."""

from __future__ import annotations

import os
import re
import shutil
import urllib.error
import urllib.request
from importlib.util import find_spec
from pathlib import Path

from zavis_bt.errors import InputError
from zavis_bt.perception.models.forms import check_form
from zavis_bt.perception.models.manifest import ModelEntry, by_hand, manifest
from zavis_bt.perception.models.seals import Progress, Seal, sum_file, sums_of
from zavis_bt.perception.models.store import ModelStore

PATIENCE = 5.0  # so long an answer may take before the place counts as out of reach [s]
_CHUNK = 1 << 20  # bytes
_PUBLISHED_SUM = re.compile(r"-([0-9a-f]{8,64})\.")  # torch's habit: the first digits of the SHA-256 end the name


def download(store: ModelStore, name: str, *, replace: bool = False, progress: Progress | None = None) -> Path:
    """Fetch a known model from where it is published, check its form and seal it.

    Args:
        store: Where to put it.
        name: Name of the model.
        replace: Whether what is there under that name may be replaced.
        progress: Takes the bytes received, for a single file; the hub's own library shows bars of its own.

    Raises:
        InputError: Nobody publishes it, or it is out of reach; the message says what to do instead.
    """
    entry = manifest().get(name)
    if entry is None or entry.shipped:
        what = "comes along" if entry else "is published nowhere that is known"
        raise InputError(f"model '{name}': {what} ({by_hand(name)})")

    def fetch(folder: Path) -> Seal:
        return _from_url(name, entry, folder, progress) if entry.url else _from_hub(name, entry, folder)

    return store.fill(name, fetch, replace=replace)


def _from_url(name: str, entry: ModelEntry, folder: Path, progress: Progress | None) -> Seal:
    assert entry.url is not None
    target = folder / entry.files[0]
    try:
        with urllib.request.urlopen(entry.url, timeout=PATIENCE) as answer, target.open("wb") as stream:
            while chunk := answer.read(_CHUNK):
                stream.write(chunk)
                if progress is not None:
                    progress(len(chunk))
    except (urllib.error.URLError, TimeoutError, ConnectionError) as error:
        raise _out_of_reach(name, entry.url, error) from error
    check_form(target, entry.form)
    total = sum_file(target)
    published = _PUBLISHED_SUM.search(target.name)
    if published and not total.sha256.startswith(published[1]):
        raise InputError(f"model '{name}': what came from {entry.url} has another SHA-256 than published (try again)")
    return Seal(source=entry.url, single=True, files={target.name: total})


def _from_hub(name: str, entry: ModelEntry, folder: Path) -> Seal:
    assert entry.hub is not None
    if find_spec("huggingface_hub") is None:
        raise InputError(f"model '{name}': needs huggingface_hub (pip install 'zavis_bt[neural]'; or {by_hand(name)})")
    _knock(name)
    for names in entry.alternatives():
        _fetch_any(name, entry.hub, names, folder)
    shutil.rmtree(folder / ".cache", ignore_errors=True)  # notes of the hub's library
    check_form(folder, entry.form, entry.model_type)
    return Seal(source=entry.page, files=sums_of(folder))


def _knock(name: str) -> None:
    """Ask the hub for a sign of life: its library goes on asking for half a minute where there is none."""
    from huggingface_hub import constants

    endpoint = _endpoint()
    if constants.HF_HUB_OFFLINE:
        raise InputError(f"model '{name}': HF_HUB_OFFLINE forbids to ask the hub (unset it; or {by_hand(name)})")
    request = urllib.request.Request(endpoint, method="HEAD")
    try:
        urllib.request.urlopen(request, timeout=PATIENCE).close()
    except urllib.error.HTTPError:
        return  # it answers
    except (urllib.error.URLError, TimeoutError, ConnectionError) as error:
        raise _out_of_reach(name, endpoint, error) from error


def _endpoint() -> str:
    """Return the hub's address, or that of a mirror that ``HF_ENDPOINT`` names."""
    from huggingface_hub import constants

    return os.environ.get("HF_ENDPOINT") or constants.ENDPOINT


def _fetch_any(name: str, hub: str, files: tuple[str, ...], folder: Path) -> None:
    from huggingface_hub import hf_hub_download
    from huggingface_hub.errors import HfHubHTTPError, LocalEntryNotFoundError, RemoteEntryNotFoundError

    for file in files:
        try:
            hf_hub_download(hub, file, local_dir=folder, endpoint=_endpoint(), etag_timeout=PATIENCE)
            return
        except RemoteEntryNotFoundError:
            continue
        except (HfHubHTTPError, LocalEntryNotFoundError, TimeoutError, ConnectionError) as error:
            raise _out_of_reach(name, f"{hub}/{file}", error) from error
    raise InputError(f"model '{name}': {hub} holds no {' or '.join(files)} ({by_hand(name)})")


def _out_of_reach(name: str, place: str, error: Exception) -> InputError:
    why = " ".join(str(error).removeprefix("<urlopen error ").removesuffix(">").split()) or type(error).__name__
    return InputError(f"model '{name}': {place} is out of reach: {why} ({by_hand(name)})")
