"""A report to look at: measures, curves and example pictures, in one file without anything from outside."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np
from PIL import Image

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.evaluation.charts import Bar, Curve, bar_chart, curve_chart
from zavis_bt.perception.evaluation.examples import best_cuts, spread, worst_confusions, worst_misses
from zavis_bt.perception.evaluation.matching import Verdicts, judge_detections, overlaps
from zavis_bt.perception.evaluation.open_set import OpenSetResult, precision_recall
from zavis_bt.perception.evaluation.page import STYLE, as_image, cell, figure, rows_of
from zavis_bt.perception.evaluation.pictures import Scenes
from zavis_bt.perception.evaluation.tables import (
    Classes,
    Prediction,
    Table,
    prediction_table,
    truth_table,
    truths_of,
)
from zavis_bt.types import FloatArray

_EXAMPLES, _PATCHES = 9, 18
_KNOWN, _UNKNOWN = "#2463c4", "#c22aa5"


def write_report(
    folder: Path,
    result: OpenSetResult,
    dataset: DetectionDataset,
    predictions: Sequence[Prediction],
    facts: Mapping[str, object],
    indices: Sequence[int] | None = None,
) -> Path:
    """Write ``report.html``, ``result.json`` and the pictures ``examples``, ``misses`` and ``confusions`` (PNG).

    Args:
        folder: Made if need be; an older report there is replaced.
        result: What `judge` said of the predictions.
        dataset: The images.
        predictions: All detections in them.
        facts: What a reader should know of the model, by name, in this order. ``rendered``: true if it was trained on
            rendered pixels, which the report then says beside the figures.
        indices: Which images were judged; all if not given.

    Returns:
        The report's file.

    Raises:
        InputError: An image cannot be read, or the folder cannot be written.
    """
    chosen = range(len(dataset)) if indices is None else indices
    classes = Classes([each.name for each in result.per_class])
    given = truths_of(dataset, sorted(chosen))
    detections, truths = prediction_table(predictions, classes), truth_table(given, classes)
    pairs = overlaps(detections, truths)
    verdicts = judge_detections(detections, truths, pairs, classes.unknown)
    unknown = truths.of(classes.unknown)
    scenes = Scenes(dataset, predictions, best_cuts(detections, truths, verdicts, classes.unknown))
    pictures = {
        "examples": scenes.examples(spread(chosen, _EXAMPLES)),
        "misses": scenes.misses(worst_misses(truths, pairs, given, _PATCHES)),
        "confusions": scenes.confusions(worst_confusions(verdicts, pairs, predictions, given, unknown, _PATCHES)),
    }
    curves = _curves(detections, truths, verdicts, classes.unknown)
    page = _page(result, dataset, facts, pictures, curves, scenes)
    return _write(folder, page, pictures, {"facts": dict(facts), "data": dataset.name, **result.as_dict()})


def _write(folder: Path, page: str, pictures: Mapping[str, Image.Image], data: Mapping[str, object]) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, picture in pictures.items():
            picture.save(folder / f"{name}.png")
        (folder / "result.json").write_text(json.dumps(data, indent=1, default=str), encoding="utf-8")
        (folder / "report.html").write_text(page, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror or error}") from error
    return folder / "report.html"


def _page(
    result: OpenSetResult,
    dataset: DetectionDataset,
    facts: Mapping[str, object],
    pictures: Mapping[str, Image.Image],
    curves: Sequence[Curve],
    scenes: Scenes,
) -> str:
    cuts = scenes.cuts
    shown = (
        f"White: what is there. Coloured: known classes from score {cuts.known:.2f}. Dashed: unknown from score "
        f"{cuts.unknown:.2f}. These cuts balance precision and recall best; the figures count all detections."
    )
    parts = [
        f"<h1>Open-set detection</h1>{_statement(facts, dataset)}",
        _figures(result),
        f'<table class="facts">{rows_of([("data", dataset.name), *_told(facts)])}</table>',
        f'<div class="pair">{figure(curve_chart(curves, "recall", "precision"), "Best-scored detections first.")}'
        f"{figure(_size_chart(result), 'Of all things that count, by boxes of whatever label.')}</div>",
        f"<h2>Examples</h2>{as_image(pictures['examples'], 'examples')}<p>{shown}</p>",
        _patches("Misses", pictures["misses"], "The largest things that no box covers (IoU > 0.5).", result.images > 0),
        _patches(
            "Named though unknown",
            pictures["confusions"],
            "The most confident known names on things of unknown class.",
            result.a_ose > 0,
        ),
        _classes(result),
    ]
    body = "\n".join(parts)
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><style>{STYLE}</style>'
    return (
        f'<!doctype html><html lang="en"><head>{head}<title>Open-set detection</title></head><body>{body}</body></html>'
    )


def _statement(facts: Mapping[str, object], dataset: DetectionDataset) -> str:
    said = ["Trained on rendered pixels."] if facts.get("rendered") else []
    said += ["Judged on rendered pixels."] if dataset.rendered else []
    if not said:
        return ""
    return f'<p class="statement">{" ".join(said)} The figures say nothing about photographs.</p>'


def _told(facts: Mapping[str, object]) -> list[tuple[str, str]]:
    return [(name, str(value)) for name, value in facts.items() if name != "rendered"]


def _figures(result: OpenSetResult) -> str:
    figures = [
        ("K-mAP", _number(result.k_map), "mean average precision of known classes at IoU 0.5"),
        ("U-Recall", _number(result.u_recall), f"of {result.unknown_truths} things of unknown class"),
        ("U-Precision", _number(result.u_precision), f"of {result.unknown_detections} boxes labelled unknown"),
        ("WI", _number(result.wi, 4), "wilderness impact at recall 0.8; lower is better"),
        ("A-OSE", str(result.a_ose), "known names on things of unknown class; lower is better"),
        ("Images", str(result.images), ""),
    ]
    tiles = "".join(
        f"<div><b>{value}</b><span>{name}</span><small>{note}</small></div>" for name, value, note in figures
    )
    return f'<div class="figures">{tiles}</div>'


def _size_chart(result: OpenSetResult) -> str:
    bars = [Bar(f"{size.least:g}+", size.recall, f"n {size.truths}") for size in result.by_size]
    return bar_chart(bars, "square root of the box's area [px]", "recall")


def _patches(title: str, picture: Image.Image, text: str, wanted: bool) -> str:
    if not wanted or picture.width <= 1:
        return f"<h2>{title}</h2><p>None.</p>"
    return f"<h2>{title}</h2>{as_image(picture, title.lower())}<p>{text}</p>"


def _classes(result: OpenSetResult) -> str:
    head = "<tr><th>class<th>AP at IoU 0.5<th>recall<th>precision<th>things<th>detections</tr>"
    rows = "".join(
        f"<tr><td>{escape(each.name)}{cell(each.average_precision)}<td>{_number(each.recall)}"
        f"<td>{_number(each.precision)}<td>{each.truths}<td>{each.detections}</tr>"
        for each in sorted(result.per_class, key=lambda each: -np.nan_to_num(each.average_precision, nan=-1.0))
    )
    return f'<h2>Known classes</h2><table class="classes">{head}{rows}</table>'


def _curves(detections: Table, truths: Table, verdicts: Verdicts, unknown: int) -> list[Curve]:
    grid = np.linspace(0, 1, 101)
    shown = [k for k in range(unknown) if np.any(truths.of(k))]
    known = [_on_grid(*precision_recall(detections, truths, verdicts, k), grid) for k in shown]
    recall, precision = precision_recall(detections, truths, verdicts, unknown)
    curves = [Curve("known, mean", grid, np.mean(known, axis=0), _KNOWN)] if known else []
    if len(recall):
        reached = grid[grid <= recall[-1]]
        curves.append(Curve("unknown", reached, _on_grid(recall, precision, reached), _UNKNOWN))
    return curves


def _on_grid(recall: FloatArray, precision: FloatArray, grid: FloatArray) -> FloatArray:
    """Return, for each recall of the grid, the best precision at that recall or a higher one; 0 where none is."""
    best = np.append(np.maximum.accumulate(precision[::-1])[::-1], 0.0)
    interpolated: FloatArray = best[np.searchsorted(recall, grid, side="left")]
    return interpolated


def _number(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"
