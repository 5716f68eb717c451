"""Fixtures that more than one room's tests use."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared() -> Path:
    """Folder with real worlds and logs, which the product neither contains nor needs."""
    folder = Path(os.environ.get("ZAVIS_SHARED", Path(__file__).parents[2] / "shared"))
    if not (folder / "worlds").is_dir():
        pytest.skip("no folder of real worlds and logs: set ZAVIS_SHARED")
    return folder
