"""What a run was made with."""

from __future__ import annotations

import platform
from importlib import metadata

import zavis_bt

_LIBRARIES = (
    "meshcat",
    "numba",
    "numpy",
    "ompl",
    "open_clip_torch",
    "opencv-python-headless",
    "py_trees",
    "ruckig",
    "torch",
    "transformers",
    "wordllama",
)


def versions() -> dict[str, str]:
    """Return the versions of Python, the platform, this package and the libraries that are installed."""
    found = {"python": platform.python_version(), "platform": platform.platform(), "zavis_bt": zavis_bt.__version__}
    for name in _LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue  # an extra that is not installed here
    return found
