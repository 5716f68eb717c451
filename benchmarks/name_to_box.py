"""Measure how often a name leads to the right box, end to end, and how long a frame takes.

    python -m benchmarks.name_to_box DATA [--eyes EYES] [--widths 160 320 640] [--images 500]

DATA is a labelled data set (zavis sim frames). For every category in an image, and every colour and category, the
boxes of the detector are matched with that name; the best one is right if its IoU with a thing of that name is above
0.5. The columns tell whose fault the rest is:

    missions     the best candidate of a mission, by m + W ln s: of the boxes that it looks at, unknown ones, those
                 whose class the detector is not sure of, and those whose class the name speaks of
    by m alone   of the same boxes the best by the matching score: a part of a mug looks like a mug, too
    all boxes    as missions, but of all boxes, whatever their label
    annotated    best match of the annotated boxes: the matcher alone
    detector     whether any box at all is right: the detector alone
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from zavis_bt.perception import Eyes, EyesSettings, open_eyes
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.clip import ClipMatcher, ClipModel
from zavis_bt.perception.datasets import DetectionDataset, open_dataset
from zavis_bt.perception.detector import NeuralDetector
from zavis_bt.perception.evaluation import NameRate, NameResult, Query, judge_answers, queries_of
from zavis_bt.perception.eyes_file import read_eyes
from zavis_bt.perception.looking import frame_of
from zavis_bt.perception.models import find_weights
from zavis_bt.perception.naming import may_name
from zavis_bt.perception.neural import find_clip
from zavis_bt.types import Box, Detection

ROWS = ("missions", "by m alone", "all boxes", "annotated", "detector")
SMALL_FRAME = 160  # width of the frames that are timed [px]
WARM_UP = 5  # frames
THREADS_TIMED = (1, 2)


@dataclass
class Answers:
    """The box chosen for each query, by row."""

    queries: list[Query] = field(default_factory=list)
    boxes: dict[str, list[Box | None]] = field(default_factory=lambda: {row: [] for row in ROWS})


def main() -> None:
    options = parsed()
    dataset = open_dataset(options.data)
    eyes = opened(options)
    indices = np.linspace(0, len(dataset) - 1, min(options.images, len(dataset))).round().astype(int).tolist()
    answers = Answers()
    for index in indices:
        ask(answers, dataset, index, eyes)
    results = {row: judge_answers(answers.queries, boxes) for row, boxes in answers.boxes.items()}
    note = " (rendered pixels)" if dataset.rendered else ""
    print(f"{dataset.name}: {len(indices)} images, {len(answers.queries)} names{note}\n")
    print_results(results)
    detector = NeuralDetector.load(find_weights(eyes.about["detector"]), width=SMALL_FRAME)
    architecture, pretrained, _ = find_clip(eyes.about["clip"])
    matcher = ClipMatcher(ClipModel.load(architecture, pretrained))
    times = {threads: timed(dataset, indices[: options.timed], detector, matcher, threads) for threads in THREADS_TIMED}
    print_times(times)
    if options.out is not None:
        told = {"data": dataset.name, "rendered": dataset.rendered, "eyes": dict(eyes.about)}
        told |= {"thresholds": asdict(eyes.thresholds)}
        rates = {row: asdict(result) for row, result in results.items()}
        options.out.write_text(json.dumps({**told, "names": rates, "milliseconds": times}, indent=1))


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--eyes", default="neural", help="neural, or an eyes file")
    parser.add_argument("--widths", type=int, nargs="+", help="the detector looks at, joined [px]; the eyes' own")
    parser.add_argument("--images", type=int, default=500, help="at even distances")
    parser.add_argument("--timed", type=int, default=100, help="frames of 160×120")
    parser.add_argument("--threads", type=int, default=1, help="while names are judged")
    parser.add_argument("--out", type=Path)
    return parser.parse_args()


def opened(options: argparse.Namespace) -> Eyes:
    name, settings = "neural", EyesSettings()
    if options.eyes != name:
        name, settings = read_eyes(Path(options.eyes))
    widths = settings.widths if options.widths is None else tuple(options.widths)
    return open_eyes(name, replace(settings, widths=widths, threads=options.threads))


def ask(answers: Answers, dataset: DetectionDataset, index: int, eyes: Eyes) -> None:
    """Answer all queries of an image."""
    queries = queries_of(dataset, [index])
    if not queries:
        return
    frame = frame_of(dataset.image(index))
    found = list(eyes.detector.detect(frame))
    boxes = [each.box for each in found]
    annotated = [each.box for each in dataset.annotations(index)]
    texts = [query.text for query in queries]
    scores, exact = (np.asarray(eyes.matcher.match(frame, each, texts)) for each in (boxes, annotated))
    limits = eyes.thresholds
    weighed = limits.candidate_scores(scores, np.array([each.score for each in found]))
    for k, query in enumerate(queries):
        answers.queries.append(query)
        matched = [is_matched(each, query.text, limits) for each in found]
        chosen = (
            best(boxes, weighed[:, k], matched),
            best(boxes, scores[:, k], matched),
            best(boxes, weighed[:, k]),
            best(annotated, exact[:, k]),
            next((box for box in boxes if query.verdict(box)), None),
        )
        for row, box in zip(ROWS, chosen, strict=True):
            answers.boxes[row].append(box)


def is_matched(found: Detection, text: str, limits: Thresholds) -> bool:
    if limits.is_faint(found.label, found.score):
        return False
    return limits.is_unknown(found.label, found.score) or may_name(text, found.label)


def best(boxes: Sequence[Box], scores: NDArray[np.floating], mask: Sequence[bool] | None = None) -> Box | None:
    allowed = np.ones(len(boxes), dtype=bool) if mask is None else np.array(mask, dtype=bool)
    return boxes[int(np.argmax(np.where(allowed, scores, -math.inf)))] if allowed.any() else None


def as_array(boxes: Sequence[Box]) -> NDArray[np.float64]:
    return np.array(boxes, dtype=np.float64).reshape(-1, 4)


def timed(
    dataset: DetectionDataset, indices: Sequence[int], detector: NeuralDetector, matcher: ClipMatcher, threads: int
) -> dict[str, float]:
    """Return the median milliseconds of a 160×120 frame for both parts and together, and the mean number of boxes."""
    torch.set_num_threads(threads)
    texts = ["red wallet", "mug", "plant", "table", "shelf", "bed"]  # of a mission: a target and landmarks
    detecting, matching, counts = [], [], []
    for index in [*indices[:WARM_UP], *indices]:
        rgb = dataset.image(index, width=SMALL_FRAME)
        seconds, found = clocked(lambda rgb=rgb: detector.detect_image(rgb))
        detecting.append(seconds)
        boxes = as_array([each.box for each in found])
        matching.append(clocked(lambda rgb=rgb, boxes=boxes: matcher.match_image(rgb, boxes, texts))[0])
        counts.append(len(boxes))
    both = [a + b for a, b in zip(detecting, matching, strict=True)]
    parts = {"detector": detecting, "matcher": matching, "together": both}
    medians = {name: 1e3 * statistics.median(values[WARM_UP:]) for name, values in parts.items()}
    return medians | {"boxes": statistics.fmean(counts[WARM_UP:])}


def clocked(work: Callable[[], list[Detection]]) -> tuple[float, list[Detection]]:
    start = time.perf_counter()
    answer = work()
    return time.perf_counter() - start, answer


def print_results(results: dict[str, NameResult]) -> None:
    def rates(result: NameResult) -> Iterator[NameRate]:
        yield from (result.all, result.categories, result.coloured, *result.by_size)

    print(f"{'right boxes':24}{'asked':>7}" + "".join(f"{row:>12}" for row in results))
    for rows in zip(*map(rates, results.values()), strict=True):
        print(f"{rows[0].name:24}{rows[0].asked:7}" + "".join(f"{rate.right:12.3f}" for rate in rows))


def print_times(times: dict[int, dict[str, float]]) -> None:
    print(f"\n160×120 frames, median  {'detector':>10}{'matcher':>10}{'together':>10}{'boxes':>8}")
    for threads, row in times.items():
        parts = "".join(f"{row[name]:7.1f} ms" for name in ("detector", "matcher", "together"))
        print(f"{threads} thread{'s' * (threads > 1):17} {parts}{row['boxes']:8.1f}")


if __name__ == "__main__":
    main()
