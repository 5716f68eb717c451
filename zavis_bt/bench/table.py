"""The summary of a benchmark, for the terminal and as a Markdown file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from zavis_bt.bench.metrics import METRICS, Difference, Estimate, Metric, Summary, compare, summarise
from zavis_bt.bench.results import EpisodeResult

SUMMARY_FILE = "summary.md"
_NOTE = "Means over episodes with 95 % bootstrap intervals."
_PAIRED_NOTE = "Paired over the episodes that both methods were run on; * where the 95 % interval leaves out 0."


def write_summary(results: Sequence[EpisodeResult], out: Path | str, reference: str | None = None) -> Path:
    """Write the tables to ``summary.md``.

    Args:
        results: At least one.
        out: Folder of the benchmark.
        reference: Method that others are compared with; the first by default.

    Returns:
        The file.
    """
    parts = ["# Benchmark", *_crash_notice(results), _NOTE, _markdown(*_summary_rows(results))]
    title, header, rows = _difference_rows(results, reference)
    if rows:
        parts += [f"## {title}", _PAIRED_NOTE, _markdown(header, rows)]
    path = Path(out) / SUMMARY_FILE
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    return path


def print_summary(results: Sequence[EpisodeResult], console: Console, reference: str | None = None) -> None:
    """Show the tables.

    Args:
        results: At least one.
        console: Where to.
        reference: Method that others are compared with; the first by default.
    """
    console.print(_rich("", *_summary_rows(results), caption=f"{_NOTE[:-1]} below them."))
    title, header, rows = _difference_rows(results, reference)
    if rows:
        console.print(_rich(title, header, rows, caption=_PAIRED_NOTE))
    for notice in _crash_notice(results):
        console.print(notice, style="bold red", markup=False)


def _crash_notice(results: Sequence[EpisodeResult]) -> list[str]:
    crashed = [result for result in results if result.crashed]
    if not crashed:
        return []
    runs = "run" if len(results) == 1 else "runs"
    return [
        f"{len(crashed)} of {len(results)} {runs} CRASHED and count as failures (see crashes/; run again to retry). "
        f"First: {crashed[0].id}, {crashed[0].method}: {crashed[0].reason}"
    ]


def _summary_rows(results: Sequence[EpisodeResult]) -> tuple[list[str], list[list[str]]]:
    summaries: list[Summary] = summarise(results)
    header = ["method", "group", "n", *(_heading(metric) for metric in METRICS)]
    return header, [[row.method, row.group, str(row.episodes), *_cells(row.estimates)] for row in summaries]


def _difference_rows(results: Sequence[EpisodeResult], reference: str | None) -> tuple[str, list[str], list[list[str]]]:
    reference = reference or results[0].method
    differences: list[Difference] = compare(results, reference)
    header = ["method", "group", "n", *(_heading(metric) for metric in METRICS)]
    rows = [[row.method, row.group, str(row.episodes), *_cells(row.estimates, signed=True)] for row in differences]
    return f"Difference to {reference}", header, rows


def _heading(metric: Metric) -> str:
    return f"{metric.name} [{metric.unit}]" if metric.unit else metric.name


def _cells(estimates: Sequence[Estimate | None], signed: bool = False) -> list[str]:
    return [_cell(metric, estimate, signed) for metric, estimate in zip(METRICS, estimates, strict=True)]


def _cell(metric: Metric, estimate: Estimate | None, signed: bool) -> str:
    """Return ``mean [low, high]``; a signed one has its sign and a star if the interval leaves out 0."""
    if estimate is None:
        return "–"
    form = f"{'+' if signed else ''}.{metric.decimals}f"
    mean, low, high = (
        format(value * metric.scale + 0.0, form) for value in (estimate.mean, estimate.low, estimate.high)
    )
    star = " *" if signed and not estimate.low <= 0 <= estimate.high else ""
    return f"{mean} [{low}, {high}]{star}"


def _markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---", "---", *["---:"] * (len(header) - 2)], *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _rich(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> Table:
    """Return a table in which each interval's ends stand below the mean, so that it fits a terminal."""
    table = Table(title=title or None, caption=caption, title_justify="left", caption_justify="left", box=SIMPLE_HEAD)
    table.padding, table.pad_edge = (0, 1, 0, 0), False
    for k, heading in enumerate(header):
        table.add_column(Text(heading), justify="left" if k < 2 else "right")
    for row in rows:
        table.add_row(*(_stacked(cell) for cell in row), end_section=True)
    return table


def _stacked(cell: str) -> Text:
    mean, bracket, interval = cell.partition(" [")
    ends, _, star = interval.partition("]")
    low, _, high = ends.partition(", ")
    return Text(mean + star.strip()).append(f"\n{low}\n{high}" if bracket else "", style="dim")
