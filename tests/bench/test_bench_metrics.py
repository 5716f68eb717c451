from __future__ import annotations

import math

import numpy as np
import pytest
from bench_samples import result
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.bench import METRICS, POOLED, EpisodeResult, Estimate, Summary, compare, summarise
from zavis_bt.bench.metrics import Difference, bootstrap

NAMES = [metric.name for metric in METRICS]


def of(row: Summary | Difference, name: str) -> Estimate:
    estimate = row.estimates[NAMES.index(name)]
    assert estimate is not None
    return estimate


def searches(method: str, outcomes: list[int], group: str = "bedroom", **changes: object) -> list[EpisodeResult]:
    return [
        result(id=f"{group}{k}", method=method, group=group, success=bool(won), spl=won * 0.5, **changes)
        for k, won in enumerate(outcomes)
    ]


def test_means_are_means() -> None:
    (row,) = summarise(searches("zavis", [1, 1, 0, 1]))
    assert (row.method, row.group, row.episodes) == ("zavis", "bedroom", 4)
    assert (of(row, "SR").mean, of(row, "SPL").mean, of(row, "path").mean) == (0.75, 0.375, 4.0)


def test_groups_are_pooled_only_when_there_are_several() -> None:
    both = [*searches("zavis", [1, 0]), *searches("zavis", [1, 1], group="living room")]
    assert [(row.group, row.episodes) for row in summarise(both)] == [("bedroom", 2), ("living room", 2), (POOLED, 4)]
    assert of(summarise(both)[2], "SR").mean == 0.75


def test_the_interval_narrows_with_the_root_of_the_number_of_episodes() -> None:
    few, many = (of(summarise(searches("zavis", [1, 0] * n))[0], "SR") for n in (25, 400))
    assert (few.high - few.low) / (many.high - many.low) == pytest.approx(4.0, rel=0.1)
    assert (few.high - few.low) / 2 == pytest.approx(1.96 * math.sqrt(0.25 / 50), rel=0.1)


def test_the_interval_covers_the_true_mean_as_often_as_it_says() -> None:
    rng = np.random.default_rng(1)
    hits = 0
    for trial in range(200):
        low, high = bootstrap(rng.normal(3.0, 1.0, (60, 1)), seed=trial, samples=400)
        hits += low[0] <= 3.0 <= high[0]
    assert 0.90 <= hits / 200 <= 0.985


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=20))
def test_the_interval_lies_between_the_extremes_and_repeats(values: list[float]) -> None:
    column = np.array(values)[:, None]
    low, high = bootstrap(column, seed=3, samples=100)
    slack = 1e-9 * max(abs(column).max(), 1.0)
    assert column.min() - slack <= low[0] <= high[0] <= column.max() + slack
    np.testing.assert_array_equal(bootstrap(column, seed=3, samples=100), (low, high))


def test_columns_are_resampled_alike_and_gaps_left_out() -> None:
    values = np.array([[1.0, 1.0, np.nan], [2.0, 2.0, np.nan], [3.0, 3.0, np.nan], [4.0, np.nan, np.nan]])
    ends = bootstrap(values[:, [0, 0]], seed=0, samples=200)
    np.testing.assert_array_equal(ends[:, 0], ends[:, 1])
    low, high = bootstrap(values, seed=0, samples=200)
    assert high[1] <= 3.0 < high[0]
    assert np.isnan([low[2], high[2]]).all()


def test_a_number_that_no_episode_has_is_none() -> None:
    (row,) = summarise([result(spl=None, details={})])
    assert row.estimates[NAMES.index("SPL")] is None
    assert row.estimates[NAMES.index("scans")] is None
    assert of(row, "SR").mean == 1.0


def test_seeds_of_an_episode_count_as_one() -> None:
    runs = [result(id="a", seed=k, success=k > 0, spl=None if k == 0 else 0.5) for k in range(4)]
    (row,) = summarise([*runs, result(id="b", success=False, spl=0.0)])
    assert row.episodes == 2
    assert of(row, "SR").mean == pytest.approx(0.375)
    assert of(row, "SPL").mean == pytest.approx(0.25)


def test_a_crash_is_a_failure_without_further_numbers() -> None:
    crash = result(id="e2", success=False, spl=0.0, reason="crash: ZeroDivisionError", path_length=0.0)
    (row,) = summarise([result(), crash])
    assert (of(row, "SR").mean, of(row, "SPL").mean, of(row, "path").mean, row.crashed) == (0.5, 0.25, 4.0, 1)


def test_differences_are_paired() -> None:
    rng = np.random.default_rng(0)
    luck = rng.random(200)
    first = searches("first", [int(u < 0.5) for u in luck])
    better = searches("better", [int(u < 0.6) for u in luck])
    (row,) = compare([*first, *better], "first")
    gap = of(row, "SR")
    apart = of(summarise(better)[0], "SR")
    assert gap.mean == pytest.approx(np.mean(luck < 0.6) - np.mean(luck < 0.5))
    assert gap.low > 0
    assert gap.high - gap.low < 0.75 * (apart.high - apart.low)


def test_only_episodes_that_both_have_are_compared() -> None:
    first, second = searches("first", [1, 1, 0]), searches("second", [0, 1])
    (row,) = compare([*first, *second], "first")
    assert (row.method, row.reference, row.episodes) == ("second", "first", 2)
    assert of(row, "SR").mean == -0.5
    assert compare([*first, *searches("third", [1], group="kitchen")], "first") == []
