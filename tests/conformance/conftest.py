"""The robots that the claims are held against."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from conformance_rigs import KINDS, Rig, open_rig

from zavis_bt.types import Pose2D


@pytest.fixture(scope="module", params=KINDS)
def opened(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    """One robot for a whole module: devices take a moment to open."""
    start: Pose2D = request.module.START
    with open_rig(request.param, tmp_path_factory.mktemp("rig"), start) as rig:
        yield rig


@pytest.fixture
def rig(opened: Rig) -> Rig:
    """That robot, at rest."""
    opened.rest()
    return opened
