"""The weights that come along."""

from __future__ import annotations

import pytest

from zavis_bt.perception.models import WEIGHTS, ModelStore, manifest
from zavis_bt.perception.models.seals import broken, files_below, read_seal, sums_of

SHIPPED = sorted(name for name, entry in manifest().items() if entry.shipped)


@pytest.mark.parametrize("name", SHIPPED)
def test_what_comes_along_is_here_and_as_it_was_sealed(name: str) -> None:
    state = ModelStore().state(name, progress=lambda read: None)
    assert state.state == "shipped", state.problem


def test_every_file_is_sealed() -> None:
    seal = read_seal(WEIGHTS)
    assert seal is not None
    assert sorted(seal.files) == sorted(path.as_posix() for path in files_below(WEIGHTS))
    assert broken(WEIGHTS, seal.files, progress=lambda read: None) is None
    assert sums_of(WEIGHTS) == seal.files


def test_what_comes_along_is_a_few_megabytes() -> None:
    assert sum(total.size for total in sums_of(WEIGHTS).values()) < 25e6


def test_what_comes_along_says_that_it_learnt_from_rendered_pixels() -> None:
    assert {manifest()[name].trained_on for name in SHIPPED} == {"rendered pixels"}
