"""`zavis perception`: look at eyes, and measure what their scores mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from zavis_bt.cli.lists import listed, whole_numbers
from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from zavis_bt.perception.calibrating import Calibration
    from zavis_bt.perception.datasets import DetectionDataset
    from zavis_bt.types import FloatArray

_BINS, _WIDTH = 20, 28  # of the histogram
_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)

app = typer.Typer(help="Look at eyes, and measure what their scores mean.", no_args_is_help=True)


@app.command()
def show(
    eyes: Annotated[str, typer.Argument(metavar="EYES", help="neural, a plug-in, or an eyes file.")] = "neural",
) -> None:
    """Say what eyes are made of: weights, checksums, known classes, thresholds."""
    from rich.console import Console

    from zavis_bt.cli.seeing import eyes_in_records, is_simulated
    from zavis_bt.perception import open_eyes

    if is_simulated(eyes):
        raise InputError(f"{eyes}: has no weights to show (see docs/simulated_perception.md)")
    opened = open_eyes(eyes)
    console = Console(highlight=False)
    for name, value in eyes_in_records(opened).items():
        _print_entry(name, value, console)
    if opened.classes is not None:
        console.print(f"[bold]knows[/] {', '.join(opened.classes)}")


@app.command()
def calibrate(
    data: Annotated[str, typer.Argument(metavar="DATA", help="Labelled images in COCO's or Pascal VOC's form.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Eyes file to write, for --perception.")],
    detector: Annotated[str | None, typer.Option(help="Detector's weights: a name or a file.")] = None,
    clip: Annotated[
        str | None, typer.Option(help="Image-text model: a name, MODEL@PRETRAINED of open_clip, or a folder.")
    ] = None,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
    widths: Annotated[
        str | None, typer.Option(help="Working widths of the detector [px], comma-separated; its own if not given.")
    ] = None,
    images: Annotated[int, typer.Option(min=1, help="Look at so many images, spread over the data.")] = 400,
    false_alarms: Annotated[
        float, typer.Option(min=0.0001, max=0.5, help="Share of images in which what is not there may be seen.")
    ] = 0.05,
    detection: Annotated[
        float | None, typer.Option(min=0.0, max=0.99, help="Least confidence of an unknown box; the best if not given.")
    ] = None,
    relative: Annotated[
        bool | None, typer.Option("--relative/--plain", help="Scores relative to those of all categories, or not.")
    ] = None,
    landmarks: Annotated[str | None, typer.Option(help="Comma-separated landmark names instead of the usual.")] = None,
) -> None:
    """Measure a model's thresholds on labelled images, and write them down for --perception FILE."""
    from rich.console import Console

    from zavis_bt.perception import EyesSettings, Thresholds, open_eyes
    from zavis_bt.perception.calibrating import calibrated
    from zavis_bt.perception.datasets import open_dataset
    from zavis_bt.perception.eyes_file import write_eyes
    from zavis_bt.perception.landmarks import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS

    if not out.parent.is_dir():
        raise InputError(f"--out: there is no folder {out.parent} (make it first)")
    labelled = open_dataset(data)
    sizes = () if widths is None else whole_numbers(widths, "--widths", "160,320,640")
    settings = EyesSettings(detector, clip, device, sizes, thresholds=Thresholds())
    eyes = open_eyes("neural", settings)
    names = (*DEFAULT_KNOWN_LANDMARKS, *DEFAULT_UNKNOWN_LANDMARKS) if landmarks is None else listed(landmarks)
    console = Console(highlight=False)
    with _bar(console) as progress:
        found = calibrated(
            eyes,
            labelled,
            names,
            count=images,
            false_alarms=false_alarms,
            detection=detection,
            relative=relative,
            progress=progress,
        )
    settings = EyesSettings(
        str(eyes.about["detector"]),
        str(eyes.about["clip"]),
        device,
        sizes,
        thresholds=found.thresholds,
        contrast=found.contrast,
        checksums=tuple(sorted(eyes.about["sha256"].items())),
    )
    write_eyes(out, settings, provenance(found, labelled, false_alarms))
    report(found, false_alarms, console)
    console.print(f"written: {out}  (use it: --perception {out})", soft_wrap=True)


def provenance(found: Calibration, data: DetectionDataset, false_alarms: float) -> dict[str, Any]:
    """Return where thresholds come from, as YAML's types."""
    return {
        "data": data.name,
        "rendered": data.rendered,
        "images": found.images,
        "boxes": found.boxes,
        "false_alarms": false_alarms,
        "recall": round(found.recall, 3),
        "right_scores": _quantiles(found.right),
        "wrong_scores": _quantiles(found.wrong),
        "landmarks": {
            "boxes": found.landmarks,
            "recall": round(found.landmark_recall, 3),
            "false_alarms": round(found.landmark_false, 3),
            "accuracy": round(found.landmark_accuracy, 3),
        },
    }


def report(found: Calibration, false_alarms: float, console: Console) -> None:
    """Print thresholds, what they reach, and the scores that they set apart."""
    from rich.table import Table

    table = Table(box=None, header_style="dim")
    table.add_column("threshold")
    table.add_column("value", justify="right")
    table.add_column("reaches")
    limits = found.thresholds
    what = f"{found.recall:.0%} of what is detected is told; a false alarm in {false_alarms:.1%} of the images"
    table.add_row("match (m_t)", f"{limits.match:.2f}", what)
    what = f"{found.landmark_recall:.0%} of the landmarks' boxes pass, {found.landmark_false:.0%} of the others"
    table.add_row("landmark", f"{limits.landmark:.2f}", what)
    table.add_row("known", f"{limits.known:.3f}", "confidence of a known class")
    table.add_row("detection", f"{limits.detection:.2f}", "confidence of unknown boxes")
    table.add_row("trust (W)", f"{limits.trust:g}", "of the detector's confidence beside the matching score")
    table.add_row("temperature (T_o)", f"{limits.temperature:.3f}", f"{found.landmark_accuracy:.0%} best names right")
    if found.contrast is not None:
        others = f"scores are relative to those of {len(found.contrast.texts)} texts"
        table.add_row("contrast (T)", f"{found.contrast.temperature:.3f}", others)
    console.print(table)
    for line in histogram(found.right, found.wrong, limits.match):
        console.print(line, markup=False)
    console.print(f"{found.boxes} boxes in {found.images} images, {found.landmarks} of them landmarks", style="dim")


def histogram(right: FloatArray, wrong: FloatArray, threshold: float) -> Iterator[str]:
    """Yield lines that show two distributions of scores, bars scaled to each one's highest."""
    import numpy as np

    wrong = wrong[np.isfinite(wrong)]
    scores = np.concatenate((right, wrong))
    edges = np.linspace(scores.min(), scores.max() + 1e-6, _BINS + 1)
    counts = [np.histogram(values, edges)[0] for values in (wrong, right)]
    bars = [count * (_WIDTH / max(int(count.max()), 1)) for count in counts]
    yield f"{'score':>7}  {'not in sight':>{_WIDTH}} │ {'shown':<{_WIDTH}}"
    for k in range(_BINS - 1, -1, -1):
        mark = "◄ m_t" if edges[k] <= threshold < edges[k + 1] else ""
        left, bar = ("█" * round(values[k]) for values in bars)
        yield f"{edges[k]:7.1f}  {left:>{_WIDTH}} │ {bar:<{_WIDTH}} {mark}".rstrip()


def _quantiles(scores: FloatArray) -> dict[str, float]:
    import numpy as np

    finite = scores[np.isfinite(scores)]
    values = np.quantile(finite, _QUANTILES) if len(finite) else np.zeros(len(_QUANTILES))
    return {f"{quantile:g}": round(float(value), 2) for quantile, value in zip(_QUANTILES, values, strict=True)}


def _print_entry(name: str, value: Any, console: Console, indent: str = "") -> None:
    if isinstance(value, dict):
        console.print(f"{indent}[bold]{name}[/]")
        for key, inner in value.items():
            _print_entry(key, inner, console, indent + "  ")
    else:
        console.print(f"{indent}[bold]{name}[/] {value}", soft_wrap=True)


@contextmanager
def _bar(console: Console) -> Iterator[Callable[[int, int], None]]:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("looking at images"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
