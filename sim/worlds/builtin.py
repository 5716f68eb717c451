"""Worlds by name."""

from __future__ import annotations

from pathlib import Path

from zavis_bt.errors import InputError, did_you_mean

_FOLDER = Path(__file__).parent
_SUFFIX = ".world.yaml"


def builtin_worlds() -> tuple[str, ...]:
    """Return the names of the built-in worlds."""
    return tuple(sorted(path.name.removesuffix(_SUFFIX) for path in _FOLDER.glob(f"*{_SUFFIX}")))


def builtin_world(name: str) -> Path:
    """Return the file of a built-in world.

    Raises:
        InputError: There is none of that name.
    """
    if name not in builtin_worlds():
        raise InputError(f"world: no built-in world '{name}'{did_you_mean(name, builtin_worlds())}")
    return _FOLDER / f"{name}{_SUFFIX}"


def resolve_world(name_or_path: str | Path) -> Path:
    """Return the file of a world that is given by path, with or without ``.world.yaml``, or by a built-in name.

    Raises:
        InputError: There is no such file and no such built-in world.
    """
    path = Path(name_or_path)
    for candidate in (path, path.with_name(path.name + _SUFFIX) if path.name else path):
        if candidate.is_file():
            return candidate
    name = str(name_or_path)
    if name in builtin_worlds():
        return builtin_world(name)
    beside = {file.name for file in path.parent.glob(f"*{_SUFFIX}") if file.is_file()}
    choices = {*builtin_worlds(), *(str(path.parent / file) for file in beside)}
    raise InputError(f"world: no file and no built-in world '{name}'{did_you_mean(name, choices)}")
