"""Fixtures that more than one room's tests use."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")  # of torch and BLAS; pytest -n has a process for each core already


def pytest_configure() -> None:
    """Let Ctrl-C work here and in what tests start, even if a shell began the tests in the background without it."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def shared() -> Path:
    """Folder with real worlds and logs, which the product neither contains nor needs."""
    folder = Path(os.environ.get("ZAVIS_SHARED", Path(__file__).parents[2] / "shared"))
    if not (folder / "worlds").is_dir():
        pytest.skip("no folder of real worlds and logs: set ZAVIS_SHARED")
    return folder
