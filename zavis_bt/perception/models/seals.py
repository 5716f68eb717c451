"""Seals: which files belong to a model, with their sizes and SHA-256."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from zavis_bt.errors import InputError

SEAL = "seal.json"
Progress = Callable[[int], None]
"""Takes how many bytes more are done."""

_CHUNK = 1 << 20  # bytes


class FileSum(BaseModel):
    """What a file must be like."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    size: Annotated[int, Field(ge=0)]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Seal(BaseModel):
    """What a folder of weights held when it was sealed."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["zavis-seal/1"] = "zavis-seal/1"
    source: str
    """Where the files came from."""
    single: bool = False
    """Whether the model is one file, not a folder."""
    files: dict[str, FileSum]
    """By path below the folder of the seal."""


def read_seal(folder: Path) -> Seal | None:
    """Return the seal of a folder, None if it has none.

    Raises:
        InputError: The seal is damaged.
    """
    path = folder / SEAL
    try:
        return Seal.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except ValidationError as error:
        fault = error.errors()[0]
        raise InputError(f"{path}: is damaged: {fault['msg']} (add the model again)") from error


def write_seal(folder: Path, seal: Seal) -> None:
    """Write the seal of a folder."""
    (folder / SEAL).write_text(seal.model_dump_json(indent=2) + "\n", encoding="utf-8")


def files_below(folder: Path) -> list[Path]:
    """Return the files of a folder by name, without seal and hidden ones."""
    found = (path for path in folder.rglob("*") if path.is_file())
    relative = (path.relative_to(folder) for path in found)
    return sorted(path for path in relative if path.parts != (SEAL,) and not _skipped(path))


def sums_of(folder: Path, progress: Progress | None = None) -> dict[str, FileSum]:
    """Return size and checksum of every file of a folder."""
    return {path.as_posix(): sum_file(folder / path, progress) for path in files_below(folder)}


def sum_file(path: Path, progress: Progress | None = None, *, copy_to: Path | None = None) -> FileSum:
    """Return size and checksum of a file; on the way copy it, if asked for.

    Raises:
        InputError: It cannot be read, or the copy cannot be written.
    """
    digest, size = hashlib.sha256(), 0
    try:
        with path.open("rb") as stream, copy_to.open("wb") if copy_to else nullcontext() as copy:
            while chunk := stream.read(_CHUNK):
                digest.update(chunk)
                size += len(chunk)
                if copy is not None:
                    copy.write(chunk)
                if progress is not None:
                    progress(len(chunk))
    except OSError as error:
        raise InputError(f"{error.filename or copy_to or path}: {error.strerror}") from error
    return FileSum(size=size, sha256=digest.hexdigest())


def broken(folder: Path, sums: Mapping[str, FileSum], progress: Progress | None = None) -> str | None:
    """Return what is wrong with the files, None if they are as they were sealed.

    Args:
        folder: Folder of the seal.
        sums: What they must be like.
        progress: Takes the bytes read; without it only names and sizes are compared.
    """
    for name, expected in sums.items():
        path = folder / name
        if not path.is_file():
            return f"{path}: is missing"
        size = path.stat().st_size
        if size != expected.size:
            return f"{path}: has {size:,} bytes, not {expected.size:,}"
        if progress is not None and sum_file(path, progress).sha256 != expected.sha256:
            return f"{path}: its SHA-256 is not that of the file that was sealed"
    return None


def _skipped(path: Path) -> bool:
    return any(part.startswith(".") or part == "__pycache__" for part in path.parts)
