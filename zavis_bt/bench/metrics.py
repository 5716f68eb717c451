"""What a benchmark reports: means over episodes with bootstrap confidence intervals, and paired differences.

An episode that was run with several seeds counts once, with the mean of its runs: episodes are what is resampled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from zavis_bt.bench.results import EpisodeResult
from zavis_bt.types import FloatArray

POOLED = "all"
_SAMPLES = 10_000
_BLOCK = 1_000  # resamples held in memory at once
_LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Metric:
    """A number that each result has, or does not have."""

    name: str
    value: Callable[[EpisodeResult], float | None]
    unit: str = ""
    decimals: int = 2
    scale: float = 1.0
    """Factor from the value to what is shown in ``unit``."""
    higher_is_better: bool = False


def _unless_crashed(value: Callable[[EpisodeResult], float | None]) -> Callable[[EpisodeResult], float | None]:
    return lambda result: None if result.crashed else value(result)


METRICS = (
    Metric("SR", lambda result: float(result.success), "%", 1, 100.0, higher_is_better=True),
    Metric("SPL", lambda result: result.spl, "", 4, higher_is_better=True),
    Metric("waypoints", _unless_crashed(lambda result: float(result.waypoints))),
    Metric("scans", _unless_crashed(lambda result: result.details.get("scans"))),
    Metric("path", _unless_crashed(lambda result: result.path_length), "m"),
    Metric("time", _unless_crashed(lambda result: result.sim_seconds), "s", 1),
)
"""SPL is S·l / max(p, l) (Anderson et al. 2018); a crash counts as a failure and has no further numbers."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean with its 95 % confidence interval."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Summary:
    """How a method did on a group of episodes."""

    method: str
    group: str
    """A group of the episodes, or `POOLED`."""
    episodes: int
    estimates: tuple[Estimate | None, ...]
    """One for each of `METRICS`; None where no episode has the number."""
    crashed: int = 0
    """Runs in which the program failed."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A method minus another over the episodes that both were run on."""

    method: str
    reference: str
    group: str
    episodes: int
    estimates: tuple[Estimate | None, ...]


def summarise(results: Sequence[EpisodeResult], seed: int = 0) -> list[Summary]:
    """Return a summary for each method and group, and for each method over all groups when there are several.

    Args:
        results: Of any methods and groups; their order of appearance is kept.
        seed: Of the bootstrap.
    """
    summaries = []
    for method in _methods(results):
        own = [result for result in results if result.method == method]
        for group in _groups(results):
            chosen = _of_group(own, group)
            if chosen:
                _, values = _by_episode(chosen)
                crashed = sum(result.crashed for result in chosen)
                summaries.append(Summary(method, group, len(values), _estimates(values, seed), crashed))
    return summaries


def compare(results: Sequence[EpisodeResult], reference: str, seed: int = 0) -> list[Difference]:
    """Return the paired differences of every other method to the reference, by group and over all.

    Only episodes that both methods have results of count; the interval comes from resampling these pairs.

    Args:
        results: Of at least the reference.
        reference: Name of the method that is subtracted.
        seed: Of the bootstrap.
    """
    differences = []
    base = [result for result in results if result.method == reference]
    for method in _methods(results):
        own = [result for result in results if result.method == method]
        for group in _groups(results) if method != reference else ():
            values = _paired(_of_group(own, group), _of_group(base, group))
            if len(values):
                differences.append(Difference(method, reference, group, len(values), _estimates(values, seed)))
    return differences


def bootstrap(values: FloatArray, seed: int = 0, samples: int = _SAMPLES) -> FloatArray:
    """Return the 95 % percentile bootstrap interval of the mean of each column.

    Args:
        values: (n, k), NaN where an episode lacks a number; rows are resampled whole.
        seed: Same seed, same interval.
        samples: Number of resamples.

    Returns:
        (2, k) lower and upper ends; NaN for a column without numbers.
    """
    values = np.asarray(values, dtype=np.float64)
    rng = np.random.default_rng(seed)
    blocks = [min(_BLOCK, samples - begun) for begun in range(0, samples, _BLOCK)]
    means = np.concatenate([_resampled_means(values, rng, block) for block in blocks])
    ends = np.full((2, values.shape[1]), np.nan)
    for k in np.flatnonzero(np.isfinite(values).any(axis=0)):
        ends[:, k] = np.nanquantile(means[:, k], [(1 - _LEVEL) / 2, (1 + _LEVEL) / 2])
    return ends


def _resampled_means(values: FloatArray, rng: np.random.Generator, samples: int) -> FloatArray:
    """Return the (samples, k) means of (n, k) values resampled by rows; NaN where no number was drawn."""
    n = len(values)
    drawn = rng.integers(n, size=(samples, n)) + np.arange(samples)[:, None] * n
    times_drawn = np.bincount(drawn.ravel(), minlength=samples * n).reshape(samples, n).astype(np.float64)
    known = np.isfinite(values)
    return _ratio(times_drawn @ np.where(known, values, 0.0), times_drawn @ known)


def _ratio(sums: FloatArray, counts: FloatArray) -> FloatArray:
    """Return sums / counts, NaN where the count is 0."""
    ratio: FloatArray = np.divide(sums, counts, out=np.full(sums.shape, np.nan), where=counts > 0)
    return ratio


def _estimates(values: FloatArray, seed: int) -> tuple[Estimate | None, ...]:
    """Return an estimate for each column of (n, k) values."""
    low, high = bootstrap(values, seed)
    return tuple(
        Estimate(float(np.nanmean(column)), float(low[k]), float(high[k])) if np.isfinite(column).any() else None
        for k, column in enumerate(values.T)
    )


def _by_episode(results: Sequence[EpisodeResult]) -> tuple[list[str], FloatArray]:
    """Return the ids of the episodes, sorted, and their (n, k) metrics, the mean over their runs."""
    runs: dict[str, list[list[float]]] = {}
    for result in results:
        row = [np.nan if (value := metric.value(result)) is None else float(value) for metric in METRICS]
        runs.setdefault(result.id, []).append(row)
    ids = sorted(runs)
    return ids, np.array([_mean_of_runs(np.array(runs[id_])) for id_ in ids])


def _mean_of_runs(rows: FloatArray) -> FloatArray:
    """Return the mean of each column over the rows that have a number."""
    known = np.isfinite(rows)
    return _ratio(np.where(known, rows, 0.0).sum(axis=0), known.sum(axis=0).astype(np.float64))


def _paired(results: Sequence[EpisodeResult], base: Sequence[EpisodeResult]) -> FloatArray:
    """Return the (n, k) differences over the episodes that both have."""
    if not results or not base:
        return np.empty((0, len(METRICS)))
    ids, values = _by_episode(results)
    base_ids, base_values = _by_episode(base)
    _, own_rows, base_rows = np.intersect1d(ids, base_ids, assume_unique=True, return_indices=True)
    difference: FloatArray = values[own_rows] - base_values[base_rows]
    return difference


def _methods(results: Sequence[EpisodeResult]) -> list[str]:
    return list(dict.fromkeys(result.method for result in results))


def _groups(results: Sequence[EpisodeResult]) -> list[str]:
    groups = list(dict.fromkeys(result.group for result in results))
    return [*groups, POOLED] if len(groups) > 1 else groups


def _of_group(results: Sequence[EpisodeResult], group: str) -> list[EpisodeResult]:
    return [result for result in results if group in (POOLED, result.group)]
