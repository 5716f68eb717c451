"""Where models lie on this machine: those that come along, and those that were added."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.models.forms import check_form
from zavis_bt.perception.models.manifest import WEIGHTS, ModelEntry, manifest, remedy
from zavis_bt.perception.models.seals import (
    Progress,
    Seal,
    broken,
    files_below,
    read_seal,
    sum_file,
    sums_of,
    write_seal,
)

State = Literal["shipped", "added", "missing", "damaged"]
_NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
_OF_OTHERS = (".msgpack", ".h5", ".ot", ".onnx", ".tflite", ".gguf")  # the same weights for other libraries


@dataclass(frozen=True, slots=True)
class ModelState:
    """How a model stands on this machine."""

    name: str
    state: State
    entry: ModelEntry | None
    """What is known of it; None for one of the user's own."""
    path: Path | None = None
    """Where it is, if it is here."""
    size: int | None = None
    """Bytes, if it is here."""
    problem: str = ""
    """What is wrong, if it is damaged."""


def default_root() -> Path:
    """Return the folder of added models: ``$ZAVIS_MODELS``, else ``zavis_bt/models`` in the user's cache."""
    if chosen := os.environ.get("ZAVIS_MODELS"):
        return Path(chosen).expanduser()
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "zavis_bt" / "models"


class ModelStore:
    """The models that come along and those in a folder of added ones, each in a folder of its name with a seal.

    A file that somebody put there by hand is trusted when it is first seen: its checksum is recorded then, and must
    be the same ever after.

    Args:
        root: Folder of added models; None for `default_root`.
        weights: Folder of the weights that come along.
    """

    def __init__(self, root: Path | None = None, weights: Path = WEIGHTS) -> None:
        self.root = root or default_root()
        self._weights = weights

    def names(self) -> list[str]:
        """Return the names of all models: first those that are known, then the user's own."""
        own = sorted(path.name for path in self._folders() if path.name not in manifest())
        return [*manifest(), *own]

    def find(self, name: str) -> Path:
        """Return the file or folder of a model after comparing it with its seal.

        Raises:
            InputError: There is no such model, it is not here, or it is damaged.
        """
        state = self.state(name, progress=lambda read: None)
        if state.state == "missing":
            raise InputError(f"model '{name}': is not on this machine ({remedy(name)})")
        if state.state == "damaged" or state.path is None:
            raise InputError(f"model '{name}': {state.problem} ({_repair(state)})")
        return state.path

    def state(self, name: str, progress: Progress | None = None) -> ModelState:
        """Return how a model stands.

        Args:
            name: Its name.
            progress: Takes the bytes read; without it only names and sizes are compared with the seal.

        Raises:
            InputError: There is no such model.
        """
        entry = manifest().get(name)
        if entry is None and not (self.root / name).is_dir():
            raise InputError(
                f"model '{name}': there is neither a model nor a file of that name{did_you_mean(name, self.names())}"
            )
        if entry is not None and entry.shipped:
            return self._shipped_state(name, entry, entry.shipped, progress)
        if not (self.root / name).is_dir():
            return ModelState(name, "missing", entry)
        return self._added_state(name, entry, progress)

    def add(self, name: str, source: Path, *, replace: bool = False, progress: Progress | None = None) -> Path:
        """Copy a file or folder to the models, and seal it.

        Args:
            name: Name to find it by; for a known model the form of its files is checked against it.
            source: Weights file, or folder.
            replace: Whether a model of that name may be replaced.
            progress: Takes the bytes copied.

        Raises:
            InputError: The name or the source will not do, or there is another model of that name.
        """
        entry = manifest().get(name)
        check_form(source, entry.form if entry else None, entry.model_type if entry else None)

        def copy(folder: Path) -> Seal:
            return _copy(source, folder, progress)

        return self.fill(name, copy, replace=replace)

    def fill(self, name: str, write: Callable[[Path], Seal], *, replace: bool = False) -> Path:
        """Make a model's folder in one step: nobody sees it half full, and it is only there if all went well.

        Args:
            name: Name of the model.
            write: Puts the files into the folder it is given, and returns their seal.
            replace: Whether a model of that name may be replaced.

        Raises:
            InputError: The name will not do, there is another model of that name, or the disk refuses.
        """
        self._check_name(name)
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            with self._staging(name) as staging:
                seal = write(staging / name)
                write_seal(staging / name, seal)
                self._place(name, staging, seal, replace)
        except OSError as error:
            raise InputError(f"{error.filename or self.root}: {error.strerror} (see $ZAVIS_MODELS)") from error
        return self._path_of(self.root / name, seal)

    def _check_name(self, name: str) -> None:
        if not _NAME.fullmatch(name):
            raise InputError(f"model '{name}': is no name (small letters, digits, '.', '_' and '-')")
        entry = manifest().get(name)
        if entry is not None and entry.shipped:
            raise InputError(f"model '{name}': comes along and cannot be replaced (choose another name)")

    @contextmanager
    def _staging(self, name: str) -> Iterator[Path]:
        staging = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=self.root))
        try:
            (staging / name).mkdir()
            yield staging
        finally:
            shutil.rmtree(staging, ignore_errors=True)

    def _place(self, name: str, staging: Path, seal: Seal, replace: bool) -> None:
        target = self.root / name
        if target.is_dir():
            old = read_seal(target) if not replace else None
            same = old is not None and old.files == seal.files and broken(target, old.files) is None
            if not replace and not same:
                raise InputError(f"model '{name}': there is another of that name in {target} (--replace to replace it)")
            target.rename(staging / "replaced")
        (staging / name).rename(target)

    def _folders(self) -> list[Path]:
        if not self.root.is_dir():
            return []
        return [path for path in self.root.iterdir() if path.is_dir() and _NAME.fullmatch(path.name)]

    def _shipped_state(self, name: str, entry: ModelEntry, place: str, progress: Progress | None) -> ModelState:
        path = self._weights / place
        seal = read_seal(self._weights)
        files = seal.files if seal else {}
        mine = {file: total for file, total in files.items() if file == place or file.startswith(f"{place}/")}
        if not path.exists():
            return ModelState(name, "missing", entry)
        if not mine:
            return ModelState(name, "damaged", entry, path, problem=f"{path}: was never sealed")
        return _judged(name, "shipped", entry, path, Seal(source="", files=mine), self._weights, progress)

    def _added_state(self, name: str, entry: ModelEntry | None, progress: Progress | None) -> ModelState:
        folder = self.root / name
        try:
            seal = read_seal(folder)
            if seal is None:
                seal = _trust(folder, entry)
        except InputError as error:
            return ModelState(name, "damaged", entry, problem=str(error))
        return _judged(name, "added", entry, self._path_of(folder, seal), seal, folder, progress)

    @staticmethod
    def _path_of(folder: Path, seal: Seal) -> Path:
        return folder / next(iter(seal.files)) if seal.single else folder


def _judged(
    name: str,
    state: State,
    entry: ModelEntry | None,
    path: Path,
    seal: Seal,
    folder: Path,
    progress: Progress | None,
) -> ModelState:
    size = sum(file.size for file in seal.files.values())
    problem = broken(folder, seal.files, progress)
    return ModelState(name, "damaged" if problem else state, entry, path, size, problem or "")


def _trust(folder: Path, entry: ModelEntry | None) -> Seal:
    """Seal a folder that was filled by hand."""
    files = files_below(folder)
    single = len(files) == 1 and (entry is None or entry.form == "file")
    form, model_type = (entry.form, entry.model_type) if entry else (None, None)
    check_form(folder / files[0] if single else folder, form, model_type)
    seal = Seal(source="put here by hand", single=single, files=sums_of(folder))
    try:
        write_seal(folder, seal)
    except OSError:
        return seal  # a folder of somebody else's: it is as good as it can be known
    return seal


def _copy(source: Path, folder: Path, progress: Progress | None) -> Seal:
    if source.is_file():
        total = sum_file(source, progress, copy_to=folder / source.name)
        return Seal(source=str(source.resolve()), single=True, files={source.name: total})
    sums = {}
    for path in files_below(source):
        if path.suffix in _OF_OTHERS:
            continue
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        sums[path.as_posix()] = sum_file(source / path, progress, copy_to=folder / path)
    return Seal(source=str(source.resolve()), files=sums)


def _repair(state: ModelState) -> str:
    if state.entry is not None and state.entry.shipped:
        return "install zavis_bt again"
    place = "" if state.entry is not None else " FILE|FOLDER"
    return f"zavis models add {state.name}{place} --replace"
