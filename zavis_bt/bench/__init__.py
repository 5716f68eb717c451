"""Benchmarks: episodes, parallel runs that resume, metrics with intervals, tables."""

from zavis_bt.bench.episodes import Episode, EpisodeObject, load_episodes
from zavis_bt.bench.metrics import METRICS, POOLED, Difference, Estimate, Metric, Summary, compare, summarise
from zavis_bt.bench.results import EpisodeResult, load_results
from zavis_bt.bench.runner import Task, make_tasks, run_benchmark
from zavis_bt.bench.shortest_path import shortest_path_length
from zavis_bt.bench.table import print_summary, write_summary

__all__ = [
    "METRICS",
    "POOLED",
    "Difference",
    "Episode",
    "EpisodeObject",
    "EpisodeResult",
    "Estimate",
    "Metric",
    "Summary",
    "Task",
    "compare",
    "load_episodes",
    "load_results",
    "make_tasks",
    "print_summary",
    "run_benchmark",
    "shortest_path_length",
    "summarise",
    "write_summary",
]
