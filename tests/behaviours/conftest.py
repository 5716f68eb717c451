from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from scripted import Stage


@pytest.fixture
def stage() -> Stage:
    """A scripted robot in the middle of a square room, 6 m a side."""
    return Stage()
