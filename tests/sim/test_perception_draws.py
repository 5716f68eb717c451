from __future__ import annotations

import numpy as np
import pytest
from seen_worlds import look, room

from sim.perception.draws import Draws, frame_key, key_of, keys_of


@pytest.fixture
def draws():
    return Draws(np.random.default_rng(7))


def test_uniform_numbers_are_uniform(draws):
    numbers = draws.uniform("a", np.arange(20000, dtype=np.uint64))
    assert numbers.min() >= 0
    assert numbers.max() < 1
    np.testing.assert_allclose(np.histogram(numbers, 10, (0, 1))[0], 2000, atol=200)


def test_normal_numbers_are_normal(draws):
    numbers = draws.normal("a", np.arange(20000, dtype=np.uint64))
    assert numbers.mean() == pytest.approx(0, abs=0.03)
    assert numbers.std() == pytest.approx(1, abs=0.03)
    assert (np.abs(numbers) < 1.96).mean() == pytest.approx(0.95, abs=0.01)


def test_neighbouring_keys_are_independent(draws):
    numbers = draws.normal("a", np.arange(20001, dtype=np.uint64))
    assert np.corrcoef(numbers[:-1], numbers[1:])[0, 1] == pytest.approx(0, abs=0.03)
    other = draws.normal("b", np.arange(20001, dtype=np.uint64))
    assert np.corrcoef(numbers, other)[0, 1] == pytest.approx(0, abs=0.03)


def test_numbers_depend_on_seed_question_and_keys_alone(draws):
    again = Draws(np.random.default_rng(7))
    again.uniform("something else", 3)
    assert draws.uniform("a", 1, 2) == again.uniform("a", 1, 2)
    assert draws.uniform("a", 1, 2) != draws.uniform("a", 2, 1)
    assert draws.uniform("a", 1) != draws.uniform("b", 1)
    assert draws.uniform("a", 1) != Draws(np.random.default_rng(8)).uniform("a", 1)


def test_arrays_of_keys_are_broadcast_and_agree_with_single_ones(draws):
    rows, cols = keys_of(["x", "y", "z"]), np.arange(4, dtype=np.uint64)
    table = draws.uniform("a", rows[:, None], cols)
    assert table.shape == (3, 4)
    assert table[1, 2] == draws.uniform("a", key_of("y"), 2)[0]


def test_keys_are_the_same_on_every_machine():
    assert key_of("mug_1") == 12637336053153805551
    assert key_of("a", "b") != key_of("ab")


def test_frames_are_told_apart_by_time_and_place():
    frames = [look(room(), 1.0, 2.0), look(room(), 1.0, 2.0, stamp=1.0), look(room(), 1.1, 2.0), look(room(), 1.0, 2.0)]
    keys = [frame_key(frame) for frame in frames]
    assert len(set(keys)) == 3
    assert keys[0] == keys[3]
