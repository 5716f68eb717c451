"""Judging a detector, and telling the result."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

    from zavis_bt.perception.datasets import DetectionDataset
    from zavis_bt.perception.detector import NeuralDetector
    from zavis_bt.perception.detector.tuning import Cut
    from zavis_bt.perception.evaluation import OpenSetResult


def judge_detector(
    detector: NeuralDetector,
    dataset: DetectionDataset,
    images: int | None,
    progress: Callable[[int], None],
    *,
    as_json: bool = False,
    report: Path | None = None,
) -> OpenSetResult:
    """Run a detector over a data set and print the measures.

    Args:
        detector: Which.
        dataset: The images.
        images: How many, from the first; all if not given.
        progress: Told how many are done.
        as_json: Print one line of JSON.
        report: Folder for a report.

    Raises:
        InputError: An image cannot be read, or the report cannot be written.
    """
    from zavis_bt.perception.evaluation import collect, judge, truths_of, write_report

    config = detector.network.config
    indices = range(min(images or len(dataset), len(dataset)))
    found = collect(dataset, detector.detect_image, indices=indices, width=config.width, progress=progress)
    result = judge(found, truths_of(dataset, indices), detector.classes, len(indices))
    facts = {"method": config.method, "backbone": config.backbone, "width": config.width, **detector.facts}
    if as_json:
        print(json.dumps({"facts": facts, "data": dataset.name, **result.as_dict()}))
    else:
        _print(result, facts, config.unknown is not None, rendered=dataset.rendered)
    if report is not None:
        write_report(report, result, dataset, found, facts, indices)
    return result


def print_cuts(judged: Sequence[Cut], best: Cut) -> None:
    """Print what each cut of the uncertainty reaches, the best one marked."""
    from rich.console import Console

    table = _table("CDF")
    for cut in judged:
        table.add_row(f"{cut.cdf:g}", *_measures(cut.result), style="bold" if cut is best else "")
    Console(highlight=False).print(table)


def _print(result: OpenSetResult, facts: dict[str, Any], open_set: bool, *, rendered: bool) -> None:
    from rich.console import Console

    table = _table()
    table.add_row(*_measures(result, open_set=open_set))
    console = Console(highlight=False)
    console.print(table)
    pixels = "rendered pixels" if rendered else "photographs"
    trained = ", trained on rendered pixels" if facts.get("rendered") else ""
    console.print(
        f"{result.images} images ({pixels}), {facts['method']} at width {facts['width']}{trained}", style="dim"
    )


def _table(*first: str) -> Table:
    from rich.table import Table

    table = Table(box=None, header_style="dim")
    for name in (*first, "K-mAP@0.5", "U-Recall", "U-Precision", "WI", "A-OSE"):
        table.add_column(name, justify="right")
    return table


def _measures(result: OpenSetResult, *, open_set: bool = True) -> tuple[str, ...]:
    return (
        _share(result.k_map),
        _share(result.u_recall) if open_set else "-",
        _share(result.u_precision) if open_set else "-",
        f"{result.wi:.4f}" if math.isfinite(result.wi) else "-",
        str(result.a_ose),
    )


def _share(value: float) -> str:
    return f"{value:.1%}" if math.isfinite(value) else "-"
