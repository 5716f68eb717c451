"""World files: ``format: zavis-world/1``, a map_server map with furniture, objects and starts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim.world import Furniture, World, WorldObject
from zavis_bt.documents import Document, check, explain, read_document
from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.mapping.map_server import load_map
from zavis_bt.types import FREE, GridMap, Pose2D

Name = Annotated[str, Field(min_length=1)]
Metres = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Seed = Annotated[int, Field(ge=0, strict=True)]


class Placed(BaseModel):
    """What every entry has."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Name
    category: Name
    x: Metres
    y: Metres
    colour: Name | None = None
    appearance: Seed | None = None


class FurnitureEntry(Placed):
    """A piece of furniture in the file."""

    yaw_deg: Metres = 0.0
    size: tuple[Length, Length]
    height: Length

    def value(self) -> Furniture:
        """Return it in SI units."""
        yaw = math.radians(self.yaw_deg)
        look = self.colour, self.appearance
        return Furniture(self.id, self.category, self.x, self.y, yaw, *self.size, self.height, *look)


class ObjectEntry(Placed):
    """A loose object in a world file or in an episode."""

    z: Metres
    size: tuple[Length, Length, Length]
    on: Name | None = None

    def value(self) -> WorldObject:
        """Return it as the world has it."""
        look = self.colour, self.appearance
        return WorldObject(self.id, self.category, self.x, self.y, self.z, self.size, self.on, *look)


class WorldFile(BaseModel):
    """The whole file; starts are ``[x, y, yaw_deg]``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["zavis-world/1"]
    name: Name
    source: str = ""
    map: Name
    wall_height: Length = 2.5
    furniture: tuple[FurnitureEntry, ...] = ()
    objects: tuple[ObjectEntry, ...] = ()
    starts: tuple[tuple[Metres, Metres, Metres], ...] = ()


def load_world(path: Path | str) -> World:
    """Read a world.

    Args:
        path: The world file; its map is found relative to its folder.

    Returns:
        The world, checked.

    Raises:
        InputError: The file or its map is missing or wrong; the message is one line about the first fault.
    """
    world, faults = inspect_world(path)
    if world is None:
        raise InputError(faults[0] + (f" [and {len(faults) - 1} more]" if len(faults) > 1 else ""))
    return world


def inspect_world(path: Path | str) -> tuple[World | None, list[str]]:
    """Read a world and name all its faults.

    Returns:
        The world, or None if it has faults; and the faults, one line each.
    """
    path = Path(path)
    try:
        document = read_document(path)
        content, faults = check(document, WorldFile)
        if content is None:
            return None, faults
        grid = _load_map(document, content)
    except InputError as error:
        return None, [str(error)]
    faults = [*_repeated(document, content), *_misplaced(document, content, grid)]
    if faults:
        return None, faults
    furniture = tuple(entry.value() for entry in content.furniture)
    objects = tuple(entry.value() for entry in content.objects)
    starts = tuple(Pose2D(x, y, math.radians(yaw_deg)) for x, y, yaw_deg in content.starts)
    return World(content.name, grid, content.wall_height, furniture, objects, starts, path), []


def read_objects(entries: Iterable[Mapping[str, Any]], where: str) -> tuple[WorldObject, ...]:
    """Return the objects of an episode.

    Args:
        entries: As in the file.
        where: Where they stand, e.g. ``episodes.jsonl:12``, for messages.

    Raises:
        InputError: An entry is not an object; ``where: objects[i].key: …``.
    """
    objects = []
    for index, entry in enumerate(entries):
        try:
            objects.append(ObjectEntry.model_validate(entry).value())
        except ValidationError as error:
            fault = explain(dict(error.errors()[0]), ObjectEntry)
            raise InputError(f"{where}: objects[{index}]: {fault}") from error
    return tuple(objects)


def _load_map(document: Document, content: WorldFile) -> GridMap:
    path = document.path.parent / content.map
    if not path.is_file():
        raise InputError(f"{document.where('map')}: map: no file {path} (a map_server YAML beside the world)")
    return load_map(path)


def _repeated(document: Document, content: WorldFile) -> Iterable[str]:
    """Yield a fault for each id that occurs twice in its list."""
    entries: Sequence[Placed]
    for name, entries in (("furniture", content.furniture), ("objects", content.objects)):
        seen: dict[str, int] = {}
        for index, entry in enumerate(entries):
            first = seen.setdefault(entry.id, index)
            if first != index:
                line = document.where(name, first).rpartition(":")[2]
                yield f"{document.where(name, index)}: {name} id '{entry.id}' occurs twice (first in line {line})"


def _misplaced(document: Document, content: WorldFile, grid: GridMap) -> Iterable[str]:
    """Yield a fault for each thing that is not where it could be."""
    entries: Sequence[Placed]
    for name, entries in (("furniture", content.furniture), ("objects", content.objects)):
        for index, entry in enumerate(entries):
            if not _inside(grid, entry.x, entry.y):
                where = document.where(name, index)
                yield f"{where}: {name} '{entry.id}' at ({entry.x:g}, {entry.y:g}) is outside the map {_extent(grid)}"
    bearers = {entry.id for entry in content.furniture}
    for index, thing in enumerate(content.objects):
        if thing.on is not None and thing.on not in bearers:
            where = document.where("objects", index)
            yield f"{where}: object '{thing.id}' is on unknown furniture '{thing.on}'{did_you_mean(thing.on, bearers)}"
    for index, (x, y, _) in enumerate(content.starts):
        if grid.state_at(x, y) != FREE:
            what = "is in an obstacle" if _inside(grid, x, y) else f"is outside the map {_extent(grid)}"
            yield f"{document.where('starts', index)}: start ({x:g}, {y:g}) {what} (a free cell is needed)"


def _inside(grid: GridMap, x: float, y: float) -> bool:
    rows, cols = grid.shape
    (x0, y0), side = grid.origin, grid.resolution
    return x0 <= x <= x0 + cols * side and y0 <= y <= y0 + rows * side


def _extent(grid: GridMap) -> str:
    rows, cols = grid.shape
    (x0, y0), side = grid.origin, grid.resolution
    return f"(x {x0:g} to {x0 + cols * side:g}, y {y0:g} to {y0 + rows * side:g})"
