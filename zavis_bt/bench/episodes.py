"""Episodes: a world, a start, a target and where every object lies, one JSON object a line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from zavis_bt.documents import explain
from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.types import Pose2D

MAX_FAULTS = 10  # shown at once


@dataclass(frozen=True, slots=True)
class EpisodeObject:
    """A loose object of an episode, as its file has it."""

    id: str
    category: str
    x: float
    """Map frame [m]."""
    y: float
    """Map frame [m]."""
    z: float
    """Above the floor [m]."""
    size: tuple[float, float, float]
    """Extent along x, y and z of the map [m]."""
    on: str | None
    """Id of the furniture that bears it."""


@dataclass(frozen=True, slots=True)
class Episode:
    """One search: where the robot starts, what it looks for and where things are."""

    id: str
    group: str
    """What results are grouped by, e.g. ``bedroom``."""
    world: Path
    """World file."""
    start: Pose2D
    """Map frame."""
    target: str
    """Category looked for."""
    instances: tuple[str, ...]
    """Ids of the objects that count as the target."""
    shortest_path_length: float | None
    """From the start to the nearest pose with an instance in view [m]; None where the file does not say."""
    objects: tuple[EpisodeObject, ...]

    def target_positions(self) -> tuple[tuple[float, float], ...]:
        """Return where the target's instances lie, map frame [m]."""
        return tuple((thing.x, thing.y) for thing in self.objects if thing.id in self.instances)


_Name = Annotated[str, Field(min_length=1)]
_Length = Annotated[float, Field(ge=0)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class _ObjectLine(_Strict):
    id: _Name
    category: _Name
    x: float
    y: float
    z: float
    size: tuple[_Length, _Length, _Length]
    on: _Name | None = None


class _TargetLine(_Strict):
    category: _Name
    instances: Annotated[list[_Name], Field(min_length=1)]


class _EpisodeLine(_Strict):
    id: _Name
    group: _Name
    world: _Name
    start: tuple[float, float, float]
    target: _TargetLine
    shortest_path_length: _Length | None = None
    objects: list[_ObjectLine]


def load_episodes(path: Path | str) -> list[Episode]:
    """Read an episodes file.

    Args:
        path: JSON lines; ``world`` is relative to this file, ``start`` is x, y [m], yaw [deg]. Empty lines are skipped.

    Returns:
        The episodes in the order of the file.

    Raises:
        InputError: The file cannot be read or has faults; the message has one line for each of the first ten.
    """
    path = Path(path)
    episodes: list[Episode] = []
    faults: list[str] = []
    lines_of: dict[str, int] = {}
    for number, text in _lines(path):
        episode, found = _parse(text, path.parent)
        if episode is not None:
            found += _contradictions(episode)
            if (earlier := lines_of.setdefault(episode.id, number)) != number:
                found.append(f"id '{episode.id}' stands in line {earlier} already (give every episode its own)")
            episodes.append(episode)
        faults += [f"{path}:{number}: {fault}" for fault in found]
        if len(faults) > MAX_FAULTS:
            raise InputError("\n".join([*faults[:MAX_FAULTS], f"{path}: and more faults after these"]))
    if faults:
        raise InputError("\n".join(faults))
    if not episodes:
        raise InputError(f"{path}: holds no episodes (one JSON object a line)")
    return episodes


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield (line number, text) of the lines that are not empty."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror} (name an episodes file, *.jsonl)") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 text (name an episodes file, *.jsonl)") from error
    # Not splitlines(): JSON strings may hold the other characters that it takes for line ends.
    yield from ((number, line) for number, line in enumerate(text.split("\n"), start=1) if line.strip())


def _parse(text: str, folder: Path) -> tuple[Episode | None, list[str]]:
    """Return the episode of one line, or None and what is wrong with it."""
    try:
        line = _EpisodeLine.model_validate_json(text)
    except ValidationError as error:
        return None, [_fault(dict(entry)) for entry in error.errors(include_url=False)]
    x, y, yaw = line.start
    objects = tuple(
        EpisodeObject(thing.id, thing.category, thing.x, thing.y, thing.z, thing.size, thing.on)
        for thing in line.objects
    )
    return Episode(
        id=line.id,
        group=line.group,
        world=folder / line.world,
        start=Pose2D(x, y, math.radians(yaw)),
        target=line.target.category,
        instances=tuple(line.target.instances),
        shortest_path_length=line.shortest_path_length,
        objects=objects,
    ), []


def _fault(fault: dict[str, Any]) -> str:
    if fault["type"] == "json_invalid":
        return f"is not JSON: {fault['ctx']['error']}".replace(" at line 1 column", ", column") + " (one object a line)"
    return explain(fault, _EpisodeLine)


def _contradictions(episode: Episode) -> list[str]:
    """Return what is wrong with an episode whose form is right."""
    faults = []
    categories: dict[str, str] = {}
    for thing in episode.objects:
        if thing.id in categories:
            faults.append(f"objects: id '{thing.id}' occurs twice (give every object its own)")
        categories[thing.id] = thing.category
    for instance in episode.instances:
        if instance not in categories:
            faults.append(f"target.instances: no object has the id '{instance}'{did_you_mean(instance, categories)}")
        elif (category := categories[instance]) != episode.target:
            faults.append(f"target.instances: '{instance}' is of category '{category}' (not '{episode.target}')")
    if not episode.world.is_file():
        faults.append(f"world: no such file: {episode.world} (a path relative to the episodes file)")
    return faults
