"""An observer that leaves a run folder behind."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO

from zavis_bt.errors import InputError, ZavisError
from zavis_bt.mapping import save_map
from zavis_bt.mapping.semantic_file import encode_landmarks
from zavis_bt.recording.candidate_images import encode_png, write_candidates
from zavis_bt.recording.files import replace_atomically, write_atomically
from zavis_bt.recording.picture import draw_map
from zavis_bt.recording.plain import to_json
from zavis_bt.recording.run_folder import ENDED, FORMAT, RUNNING, RunFolder
from zavis_bt.recording.tree_text import first_line, tree_text
from zavis_bt.recording.versions import versions
from zavis_bt.types import Event, MissionResult, Observed, Pose2D

_LOG = logging.getLogger(__name__)
_MOVED, _TURNED = 1e-3, 1e-3  # smallest motion that makes a row of the trajectory [m], [rad]


class RunRecorder:
    """Records a mission: an `Observer`, and with `on_event` a sink of the mission's journal.

    Making one creates the folder, so that whatever is wrong with it is said before the mission begins. From then on
    nothing is raised: what cannot be written is logged once and listed in `problems` and in ``run.json``.
    """

    def __init__(self, folder: Path | str, settings: Mapping[str, Any], *, title: str = "") -> None:
        """Create the folder with a ``run.json`` of status ``running``.

        Args:
            folder: Is created with its parents; may exist if it holds no run.
            settings: Everything that decided the run: tree, target, seed, models, ….
            title: Heading of the picture; by default the target and the method.

        Raises:
            InputError: The folder holds a run already, or cannot be written.
        """
        self.folder = RunFolder(Path(folder))
        self.problems: list[str] = []
        self._title = title
        self._target = str(settings.get("target", ""))
        self._header: dict[str, Any] = {
            "format": FORMAT,
            "status": RUNNING,
            "began": datetime.now().astimezone().isoformat(timespec="seconds"),
            "settings": dict(settings),
            "versions": versions(),
        }
        self._rows: list[tuple[float, float, float, float]] = []
        self._start: Pose2D | None = None
        self._events: BinaryIO | None = self._create()

    def _create(self) -> BinaryIO:
        path = self.folder.path
        if self.folder.run.exists():
            raise InputError(f"{path}: holds a run already (choose another folder, or remove this one)")
        try:
            path.mkdir(parents=True, exist_ok=True)
            write_atomically(self.folder.run, to_json(self._header))
            return self.folder.events.open("ab", buffering=0)  # a line is in the file as soon as it is written
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror} (choose another folder)") from error

    def on_event(self, event: Event) -> None:
        """Append an event to the journal file."""
        if self._events is None:
            return
        line = to_json({"stamp": event.stamp, "kind": event.kind, "data": event.data}, indent=None)
        try:
            self._events.write(line.encode())
        except OSError as error:
            self._note("events.jsonl", error)
            self._events.close()
            self._events = None

    def on_start(self, mission: Observed) -> None:
        """Note where the robot starts."""
        self._start = mission.base.pose
        self.on_tick(mission)

    def on_tick(self, mission: Observed) -> None:
        """Note where the robot is, if it moved."""
        pose = mission.base.pose
        if self._rows:
            _, x, y, yaw = self._rows[-1]
            if abs(pose.x - x) < _MOVED and abs(pose.y - y) < _MOVED and abs(pose.yaw - yaw) < _TURNED:
                return
        self._rows.append((mission.stamp, pose.x, pose.y, pose.yaw))

    def on_end(self, mission: Observed, result: MissionResult) -> None:
        """Write everything; a file that cannot be written does not keep the others from being written."""
        files = self.folder
        try:
            self._attempt(files.map, lambda: self._write_map(mission))
            self._put(files.semantic_map, lambda: encode_landmarks(mission.landmarks))
            self._put(files.trajectory, self._trajectory)
            self._put(files.tree, lambda: tree_text(mission.nodes))
            self._attempt(files.candidates, lambda: self._write_candidates(mission))
            self._put(files.picture, lambda: self._picture(mission, result))
        finally:
            self._put(files.run, lambda: self._summary(result))
            self.close()

    def close(self) -> None:
        """Close the journal file; may be called twice. Without an `on_end` before, the run stays ``running``."""
        if self._events is not None:
            self._events.close()
            self._events = None

    def _put(self, path: Path, content: Callable[[], bytes | str]) -> None:
        self._attempt(path, lambda: write_atomically(path, content()))

    def _attempt(self, path: Path, write: Callable[[], None]) -> None:
        try:
            write()
        except Exception as error:  # one broken file must cost neither the other files nor the mission
            self._note(path.name, error)

    def _note(self, name: str, error: Exception) -> None:
        cause = error.__cause__ if isinstance(error.__cause__, OSError) else error
        if isinstance(cause, OSError):
            what = f"cannot be written: {cause.strerror or cause}"
        else:
            what = str(error) if isinstance(error, ZavisError) else f"{type(error).__name__}: {error}"
        self.problems.append(f"{name}: {what}")
        _LOG.error("recording: %s: %s", self.folder.path / name, what)

    def _write_map(self, mission: Observed) -> None:
        paths = [self.folder.map.with_suffix(".pgm"), self.folder.map]
        replace_atomically(paths, lambda temporary: save_map(temporary[1], mission.grid))

    def _write_candidates(self, mission: Observed) -> None:
        write_candidates(self.folder.candidates, mission.candidates, mission.found)

    def _trajectory(self) -> str:
        rows = (f"{stamp:.3f},{x:.4f},{y:.4f},{yaw:.4f}\n" for stamp, x, y, yaw in self._rows)
        return "stamp,x,y,yaw\n" + "".join(rows)

    def _picture(self, mission: Observed, result: MissionResult) -> bytes:
        found = mission.found
        target = found.target if found else self._target
        return encode_png(
            draw_map(
                mission.grid,
                trajectory=mission.trajectory,
                start=self._start,
                landmarks=mission.landmarks,
                visited=[viewpoint.pose for viewpoint in mission.visited],
                candidates=[candidate.position[:2] for candidate in mission.candidates],
                found=found.position[:2] if found else None,
                target=target,
                title=self._title or _heading(target, result),
            )
        )

    def _summary(self, result: MissionResult) -> str:
        ended = {"status": ENDED, "ended": datetime.now().astimezone().isoformat(timespec="seconds")}
        fields = {field.name: getattr(result, field.name) for field in dataclasses.fields(result)}
        return to_json({**self._header, **ended, **fields, "problems": self.problems})


def _heading(target: str, result: MissionResult) -> str:
    outcome = "found" if result.success else f"not found ({first_line(result.reason.split(': ')[-1], 60)})"
    return f"{target or result.id}: {outcome}, {result.path_length:.1f} m, {result.waypoints} viewpoints"
