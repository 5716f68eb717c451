"""Occupancy maps as files of ROS map_server: a YAML file that names and explains a greyscale image.

The image's first row is the largest y; a grid's first row is the smallest.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from zavis_bt.documents import check, read_document
from zavis_bt.errors import InputError
from zavis_bt.mapping.pgm import read_bytes, read_pgm, write_pgm
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap

_WHITE, _BLACK, _GREY = 254, 0, 205  # pixels of free, occupied and unknown cells, as map_saver writes them

Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class _MapFile(BaseModel):
    """The YAML file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    image: Annotated[str, Field(min_length=1)]
    resolution: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    origin: tuple[Finite, Finite, Finite]
    mode: Literal["trinary"] = "trinary"
    negate: bool
    occupied_thresh: Share
    free_thresh: Share

    @model_validator(mode="after")
    def _consistent(self) -> _MapFile:
        if self.origin[2] != 0:
            raise ValueError(f"origin is rotated by {self.origin[2]:g} rad (rotated maps are not supported; write 0)")
        if self.free_thresh >= self.occupied_thresh:
            raise ValueError(f"free_thresh {self.free_thresh:g} must be below occupied_thresh {self.occupied_thresh:g}")
        return self


def load_map(yaml_path: Path | str) -> GridMap:
    """Read a trinary map_server map.

    Args:
        yaml_path: The YAML file; the image is found relative to its folder.

    Returns:
        The map; its version is 0.

    Raises:
        InputError: The file or its image is missing, or wrong in some way.
    """
    path = Path(yaml_path)
    description = _read_description(path)
    shade, white = _read_image(path.parent / description.image)
    table = _state_of_shade(white, description)
    states = np.ascontiguousarray(table[shade][::-1])
    states.setflags(write=False)
    return GridMap(states, description.resolution, description.origin[:2])


def save_map(yaml_path: Path | str, grid: GridMap) -> None:
    """Write a map_server map: the YAML file and, beside it under the same name, the PGM image.

    Args:
        yaml_path: The YAML file; its folder must exist.
        grid: What to write. `load_map` gives the same states, resolution and origin again.

    Raises:
        InputError: The files cannot be written.
    """
    path = Path(yaml_path)
    image = path.with_suffix(".pgm")
    pixels = np.full(grid.shape, _GREY, dtype=np.uint8)
    pixels[grid.states == FREE] = _WHITE
    pixels[grid.states == OCCUPIED] = _BLACK
    x, y = (float(value) for value in grid.origin)
    try:
        write_pgm(image, pixels[::-1])
        path.write_text(
            f'image: "{_escaped(image.name)}"\nmode: trinary\nresolution: {float(grid.resolution)!r}\n'
            f"origin: [{x!r}, {y!r}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
            encoding="utf-8",
        )
    except OSError as error:
        raise InputError(f"{path}: the map cannot be written: {error.strerror}") from error


def _read_description(path: Path) -> _MapFile:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    content, faults = check(read_document(path), _MapFile)
    if content is None:
        raise InputError(faults[0] + (f" [and {len(faults) - 1} more]" if len(faults) > 1 else ""))
    return content


def _read_image(path: Path) -> tuple[NDArray[np.uint16], int]:
    if path.suffix.lower() in (".pgm", ".pnm"):
        return read_pgm(path)
    import cv2

    data = np.frombuffer(read_bytes(path), np.uint8)
    pixels = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if data.size else None
    if pixels is None:
        raise InputError(f"{path}: not an image that can be read (PGM or PNG)")
    return pixels.astype(np.uint16), 255


def _state_of_shade(white: int, description: _MapFile) -> NDArray[np.int8]:
    """Return the state of every pixel value from black (0) to white, as map_server defines them."""
    brightness = np.arange(white + 1) / white
    occupancy = brightness if description.negate else 1 - brightness
    table = np.full(white + 1, UNKNOWN, dtype=np.int8)
    table[occupancy < description.free_thresh] = FREE
    table[occupancy > description.occupied_thresh] = OCCUPIED
    return table


def _escaped(name: str) -> str:
    return name.replace("\\", "\\\\").replace('"', '\\"')
