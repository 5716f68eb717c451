"""Fixtures for the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from good_files import write_good_files

from sim.clock import SimClock


@pytest.fixture
def _good_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand in a folder of good files."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    write_good_files()


@pytest.fixture
def _nothing_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fail if a simulation is started."""
    monkeypatch.setattr(SimClock, "wait_until", lambda *_: pytest.fail("the simulation was started"))
