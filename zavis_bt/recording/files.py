"""Files that are there as a whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def write_atomically(path: Path, content: bytes | str) -> None:
    """Write a file so that a reader sees the old content or the new, never a part.

    Args:
        path: The file; its folder must exist.
        content: What it will hold; text is encoded as UTF-8.

    Raises:
        OSError: It cannot be written; a file that was there before is unchanged.
    """
    data = content.encode() if isinstance(content, str) else content
    replace_atomically([path], lambda temporary: temporary[0].write_bytes(data))


def replace_atomically(paths: list[Path], write: Callable[[list[Path]], object]) -> None:
    """Let a function write files of the same names in a folder aside, then move them to their places.

    Args:
        paths: The files, all in one existing folder; they are moved in this order.
        write: Gets the paths to write instead.

    Raises:
        OSError: A file cannot be written; whatever ``write`` raises comes through. Nothing was moved.
    """
    aside = paths[0].parent / f".{paths[0].name}.{os.getpid()}.part"
    aside.mkdir()
    temporary = [aside / path.name for path in paths]
    try:
        write(temporary)
        for source, target in zip(temporary, paths, strict=True):
            source.replace(target)
    finally:
        for leftover in temporary:
            leftover.unlink(missing_ok=True)
        aside.rmdir()
