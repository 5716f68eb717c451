"""Finding a model by what a person writes: a path, or a name."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from zavis_bt.errors import InputError
from zavis_bt.perception.models.store import ModelStore


def find_weights(name_or_path: str | Path) -> Path:
    """Return the file or folder of a model.

    Args:
        name_or_path: A path, taken as it is; or the name of a model that comes along or was added, compared with its
            checksums once a process.

    Raises:
        InputError: There is neither; the message says what to download, from where, and where to put it.
    """
    if isinstance(name_or_path, str) and _is_name(name_or_path):
        return _found(name_or_path, ModelStore().root)
    path = Path(name_or_path).expanduser()
    if not path.exists():
        raise InputError(f"{path}: no such file or folder (models by name: zavis models list)")
    return path


@lru_cache(maxsize=32)
def _found(name: str, root: Path) -> Path:
    return ModelStore(root).find(name)


def _is_name(text: str) -> bool:
    return text in ModelStore().names() or not ("/" in text or Path(text).exists())
