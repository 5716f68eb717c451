"""The folder of a benchmark: what it was asked, what is done, and what crashed.

``bench.json`` holds the settings; ``results.jsonl`` grows by a line whenever an episode ends and is put into the order
of the tasks when the run ends; ``crashes/`` holds a traceback for each episode in which the program failed.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

from zavis_bt.bench.results import RESULTS_FILE, EpisodeResult, load_results, to_line
from zavis_bt.errors import InputError

_FORMAT = "zavis-bench/1"
Key = tuple[str, str, int]


class BenchFolder:
    """Keeps results so that a killed run loses no more than the episodes that were running."""

    def __init__(self, path: Path, settings: Mapping[str, Any], keys: Sequence[Key]) -> None:
        """Open a folder, new or of an earlier run, and hold it for this process.

        Args:
            path: The folder; made if it does not exist.
            settings: What decides the results, as JSON's types; kept beside them.
            keys: Episode, method and seed of every task, in order.

        Raises:
            InputError: The folder is in use, is not a benchmark's, or holds results of other settings or tasks.
        """
        self.path = path
        self._order = {key: index for index, key in enumerate(keys)}
        self._lock = _locked(path)
        try:
            _check_settings(path, settings)
            kept = [result for result in self._earlier() if not result.crashed]
            shutil.rmtree(path / "crashes", ignore_errors=True)
            self.done = {result.key: result for result in kept}
            self._write(kept)
        except BaseException:
            os.close(self._lock)
            raise
        self._file: IO[str] = (path / RESULTS_FILE).open("a", encoding="utf-8")

    def add(self, result: EpisodeResult) -> None:
        """Keep a result; it survives whatever happens to this process."""
        self._file.write(to_line(result) + "\n")
        self._file.flush()
        self.done[result.key] = result

    def add_traceback(self, result: EpisodeResult, text: str) -> None:
        """Keep the traceback of a crash in a file of its own."""
        folder = self.path / "crashes"
        folder.mkdir(exist_ok=True)
        name = re.sub(r"[^\w.-]+", "_", f"{result.id}-{result.method}-{result.seed}")
        (folder / f"{name}.txt").write_text(f"{result.reason}\n\n{text}", encoding="utf-8")

    def results(self) -> list[EpisodeResult]:
        """Return what is done, in the order of the tasks."""
        return sorted(self.done.values(), key=lambda result: self._order[result.key])

    def close(self) -> None:
        """Put the results into the order of the tasks and let go of the folder."""
        self._file.close()
        self._write(self.results())
        os.close(self._lock)

    def _earlier(self) -> list[EpisodeResult]:
        """Return the results of earlier runs."""
        results = load_results(self.path) if (self.path / RESULTS_FILE).exists() else []
        for result in results:
            if result.key not in self._order:
                raise InputError(
                    f"{self.path}: holds a result that is not asked for: episode {result.id}, method {result.method}, "
                    f"seed {result.seed} (ask for it too, or name another folder)"
                )
        return results

    def _write(self, results: Iterable[EpisodeResult]) -> None:
        """Replace the results file at one stroke."""
        partial = self.path / f"{RESULTS_FILE}.partial"
        partial.write_text("".join(to_line(result) + "\n" for result in results), encoding="utf-8")
        partial.replace(self.path / RESULTS_FILE)


def _locked(path: Path) -> int:
    """Make the folder if need be and return its descriptor, locked as long as it is open."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise InputError(f"{path}: cannot be used: {error.strerror} (name a folder to write to)") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        raise InputError(f"{path}: is in use by another benchmark (wait for it, or name another folder)") from error
    return descriptor


def _check_settings(path: Path, settings: Mapping[str, Any]) -> None:
    """Compare the settings with those in the folder, and put there what is new.

    A setting that is itself a mapping may gain entries, as a benchmark gains methods.
    """
    file = path / "bench.json"
    wanted = json.loads(json.dumps(dict(settings)))
    if file.exists():
        found = _read_settings(file)
        for key in sorted(found.keys() | wanted.keys()):
            wanted[key] = _agreed(path, key, found.get(key), wanted.get(key))
    elif any(path.iterdir()):
        raise InputError(f"{path}: is not empty and not a benchmark's folder (name a new one)")
    text = json.dumps({"format": _FORMAT, "settings": wanted}, indent=2, ensure_ascii=False)
    partial = file.with_suffix(".partial")
    partial.write_text(text + "\n", encoding="utf-8")
    partial.replace(file)


def _read_settings(file: Path) -> dict[str, Any]:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        found = content["settings"] if content["format"] == _FORMAT else None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: is damaged (name another folder)") from error
    if not isinstance(found, dict):
        raise InputError(f"{file}: is of another version of zavis (name another folder)")
    return found


def _agreed(path: Path, key: str, found: Any, wanted: Any) -> Any:
    if isinstance(found, dict) and isinstance(wanted, dict):
        shared = found.keys() & wanted.keys()
        return found | wanted | {name: _agreed(path, f"{key} of {name}", found[name], wanted[name]) for name in shared}
    if found != wanted:
        raise InputError(
            f"{path}: was begun with {key} = {json.dumps(found)}, not {json.dumps(wanted)} "
            "(use the same settings to resume, or name another folder)"
        )
    return wanted
