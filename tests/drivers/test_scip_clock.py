from __future__ import annotations

import numpy as np
import pytest

from drivers.lidar.clock import SensorClock
from drivers.lidar.codec import CLOCK_SPAN

DELAY = 0.008  # least time from measurement to arrival [s]


class Crystal:
    """A sensor's clock that runs fast or slow."""

    def __init__(self, at_zero: int, drift: float = 0.0) -> None:
        self.at_zero, self.drift = at_zero, drift

    def raw(self, time: float) -> int:
        return int(self.at_zero + 1000 * time * (1 + self.drift)) % CLOCK_SPAN

    def exchanges(self, time: float, rng: np.random.Generator) -> list[tuple[float, float, int]]:
        ways = rng.exponential(0.0005, (10, 2))
        return [(time, time + there + back, self.raw(time + there)) for there, back in ways.tolist()]


def errors(clock: SensorClock, crystal: Crystal, seconds: float, rng: np.random.Generator, begin: float = 0.1):
    """How far the stamps are from the truth over so many seconds of scans."""
    found = []
    for time in np.arange(begin, begin + seconds, 0.1).tolist():
        arrival = time + DELAY + float(rng.exponential(0.004))
        stamp = clock.stamp(crystal.raw(time), arrival)
        assert stamp <= arrival
        found.append(stamp - time)
    return np.abs(found)


@pytest.mark.parametrize("drift", [-1e-4, 0.0, 1e-4])
def test_stamps_are_true_for_hours_with_a_drifting_crystal_that_wraps(drift):
    rng, crystal = np.random.default_rng(1), Crystal(CLOCK_SPAN - 60_000, drift)
    clock = SensorClock(crystal.exchanges(0.0, rng))
    assert errors(clock, crystal, 3 * 3600.0, rng).max() < 0.006


def test_without_synchronisation_the_delay_alone_is_missing():
    rng, crystal = np.random.default_rng(1), Crystal(1000)
    clock = SensorClock()
    assert not clock.synchronised
    assert errors(clock, crystal, 60.0, rng)[50:].max() < DELAY + 0.003


def test_scans_that_were_held_up_keep_their_time():
    rng, crystal = np.random.default_rng(1), Crystal(1000)
    clock = SensorClock(crystal.exchanges(0.0, rng))
    errors(clock, crystal, 30.0, rng)
    for time in (31.0, 31.1, 31.2):
        assert clock.stamp(crystal.raw(time), 32.5) == pytest.approx(time, abs=0.006)


@pytest.mark.parametrize("at_zero", [5_000_000, 15_000_000])
def test_a_restarted_sensor_is_noticed(at_zero):
    rng, crystal = np.random.default_rng(1), Crystal(at_zero)
    clock = SensorClock(crystal.exchanges(0.0, rng))
    errors(clock, crystal, 30.0, rng)
    assert errors(clock, Crystal(-31_000), 30.0, rng, begin=31.0)[50:].max() < 0.01


def test_a_scan_from_just_before_the_synchronisation_is_no_restart():
    rng, crystal = np.random.default_rng(1), Crystal(1000)
    clock = SensorClock(crystal.exchanges(1.0, rng))
    assert clock.stamp(crystal.raw(0.97), 1.01) == pytest.approx(0.97, abs=0.003)
    assert errors(clock, crystal, 60.0, rng, begin=1.1).max() < 0.006
