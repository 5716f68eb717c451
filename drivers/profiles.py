"""Robot profiles that come with the package."""

from __future__ import annotations

from pathlib import Path

from zavis_bt.errors import InputError, did_you_mean

_FOLDER = Path(__file__).parent / "robots"
_SUFFIX = ".robot.yaml"


def builtin_robots() -> tuple[str, ...]:
    """Return the names of the profiles."""
    return tuple(sorted(path.name.removesuffix(_SUFFIX) for path in _FOLDER.glob(f"*{_SUFFIX}")))


def builtin_robot(name: str) -> Path:
    """Return the file of a profile.

    Raises:
        InputError: There is no profile of that name.
    """
    if name not in builtin_robots():
        raise InputError(f"robot: no built-in robot '{name}'{did_you_mean(name, builtin_robots())}")
    return _FOLDER / f"{name}{_SUFFIX}"
