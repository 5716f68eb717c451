"""`zavis detector`: train the open-set detector, judge it, and write it for use."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from zavis_bt.cli.lists import listed
from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from zavis_bt.perception.datasets import DetectionDataset
    from zavis_bt.perception.detector import DetectorNetwork
    from zavis_bt.perception.detector.pseudo_labels import Labelling

_CLIP = "zavis-tiny"
_WEIGHTS_FILE = "detector.safetensors"
_DECODED = 320  # width of the images that a small detector learns from [px]
_BOXES = 3  # times as many iterations of warming up with boxes as with cut-outs
_COLLAGES_FIRST, _COLLAGES = 0.45, 0.35  # shares of the iterations: at the start, and of the rest

app = typer.Typer(help="Train the open-set detector, judge it, write it for use.", no_args_is_help=True)


@app.command()
def train(
    data: Annotated[
        str, typer.Argument(metavar="DATA", help="Images in COCO's or Pascal VOC's form, or sim:COUNT[:SEED].")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the training.")],
    known: Annotated[
        str | None, typer.Option(help="Comma-separated known classes; the usual known landmarks if not given.")
    ] = None,
    method: Annotated[str | None, typer.Option(help="zavis (the paper's; if not given), ore, or faster_rcnn.")] = None,
    backbone: Annotated[str | None, typer.Option(help="tiny (if not given), resnet50_fpn or resnet50_c4.")] = None,
    weights: Annotated[Path | None, typer.Option(help="torchvision's checkpoint of ResNet-50 to begin with.")] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="DETECTOR", help="A trained one to teach further; brings classes, method and backbone along."
        ),
    ] = None,
    clip: Annotated[str, typer.Option(help="Image-text model that tells things from background.")] = _CLIP,
    iterations: Annotated[int, typer.Option(min=1, help="Steps of the optimiser.")] = 4000,
    batch: Annotated[int, typer.Option(min=1, help="Images a step.")] = 16,
    rate: Annotated[
        float | None, typer.Option("--learning-rate", min=1e-8, help="At its highest; by the backbone.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint in --out.")] = False,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
    workers: Annotated[int, typer.Option("--workers", "-j", min=0, help="Processes that read images.")] = 0,
    width: Annotated[int | None, typer.Option(min=32, help="Of what is learnt from [px]; by the backbone.")] = None,
    collages: Annotated[
        bool | None,
        typer.Option("--collages/--no-collages", help="Begin with collages of known things; tiny backbones do."),
    ] = None,
    warm_up: Annotated[
        int,
        typer.Option(
            min=0,
            help="Iterations in which a tiny detector first learns to tell things; three times as many with boxes.",
        ),
    ] = 0,
) -> None:
    """Train a detector on labelled images; an interrupted training goes on with --resume."""
    check_device(device)
    from zavis_bt.cli.detector_data import open_images
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.detector import Checkpoint, Training, TrainingLog, TrainingSettings, Views, save_detector
    from zavis_bt.perception.detector.building import FACTS
    from zavis_bt.perception.detector.decoded import Decoded, are_of_one_size
    from zavis_bt.perception.detector.training import check_data
    from zavis_bt.perception.detector.warm_up import WarmUp

    if start is None:
        network = _new_network(known, method or "zavis", backbone or "tiny", width, weights, seed)
        earlier: dict[str, object] = {}
    else:
        architecture = {"--known": known, "--method": method, "--backbone": backbone, "--weights": weights}
        network, earlier = _trained_network(start, architecture | {"--warm-up": warm_up or None})
    config = network.config
    is_tiny = config.backbone == "tiny"
    images: DetectionDataset = open_images(data)
    if not resume and (out / "checkpoint.pt").exists():
        raise InputError(f"--out: {out} holds a training (go on with --resume, or name a new folder)")
    before = Checkpoint.load(out) if resume else None
    peak = rate or (2e-3 if is_tiny else 1e-4)
    crowded = is_tiny if collages is None else collages
    settings = TrainingSettings(
        iterations,
        batch,
        peak,
        seed,
        workers,
        views=Views() if is_tiny else Views(width or config.width, zoom=1.5, large=0.0),
        collages_first=_COLLAGES_FIRST if crowded and start is None else 0.0,
        collages=_COLLAGES if crowded else 0.0,
        warm_up=WarmUp(warm_up, _BOXES * warm_up) if warm_up else None,
    )
    out.mkdir(parents=True, exist_ok=True)
    check_data(images, config.known)
    if is_tiny and are_of_one_size(images):
        with progress_bar(len(images), "decoding") as progress:
            images = Decoded(images, out / "images.npy", _DECODED, progress)
    training = Training(
        network, images, settings, _labelling(config.method, clip, device, trained=start is not None), device
    )
    if before is not None:
        training.resume(before)
    rendered = images.rendered or bool(earlier.get("rendered"))
    facts = {"data": images.name, "rendered": rendered, "images": len(images), "seed": seed}
    facts |= {"iterations": iterations, "batch": batch, "learning_rate": peak, "clip": clip}
    facts |= {"start": earlier} if earlier else {}
    (out / FACTS).write_text(json.dumps(facts))
    first = 0 if resume else (1 + _BOXES) * warm_up
    with TrainingLog(out) as log, progress_bar(first + iterations) as progress:
        training.run(log, lambda state: state.save(out), lambda done: progress(first + done), progress)
    save_detector(training.network, out / _WEIGHTS_FILE, facts)
    typer.echo(f"written: {out / _WEIGHTS_FILE}")


@app.command("eval")
def evaluate(
    detector: Annotated[str, typer.Argument(metavar="DETECTOR", help="Weights: a name or a file.")],
    data: Annotated[str, typer.Argument(metavar="DATA", help="As for train.")],
    width: Annotated[
        int | None, typer.Option(min=32, help="Working width [px]; the detector's own if not given.")
    ] = None,
    images: Annotated[int | None, typer.Option(min=1, help="Only the first so many images.")] = None,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
    as_json: Annotated[bool, typer.Option("--json", help="Print one line of JSON.")] = False,
    report: Annotated[Path | None, typer.Option(help="Folder for a report with example pictures.")] = None,
) -> None:
    """Judge a detector: K-mAP, U-Recall, U-Precision, WI, A-OSE."""
    check_device(device)
    from zavis_bt.cli.detector_data import open_images
    from zavis_bt.cli.detector_eval import judge_detector
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.detector import NeuralDetector
    from zavis_bt.perception.models import find_weights

    opened = NeuralDetector.load(find_weights(detector), device=device, width=width)
    dataset = open_images(data)
    with progress_bar(min(images or len(dataset), len(dataset))) as progress:
        judge_detector(opened, dataset, images, progress, as_json=as_json, report=report)


@app.command()
def export(
    training: Annotated[Path, typer.Argument(metavar="TRAINING", help="Folder of a training.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Weights file to write (.safetensors).")],
    width: Annotated[int | None, typer.Option(min=32, help="Working width [px].")] = None,
    known_score: Annotated[float | None, typer.Option(min=0, max=1, help="Least score of known classes.")] = None,
    unknown_score: Annotated[float | None, typer.Option(min=0, max=1, help="Least score of unknown things.")] = None,
    cdf: Annotated[float | None, typer.Option(min=0, max=1, help="Uncertainty above which a thing is unknown.")] = None,
) -> None:
    """Write a trained detector as one file, with the width and the thresholds that it is used with."""
    check_device("cpu")
    from zavis_bt.perception.detector.building import export_training

    _check_weights_file("OUT", out)
    given = {"known_score": known_score, "unknown_score": unknown_score, "cdf": cdf}
    export_training(training, out, width, {name: value for name, value in given.items() if value is not None})
    typer.echo(f"written: {out}")


@app.command()
def average(
    detectors: Annotated[list[str], typer.Argument(metavar="DETECTOR...", help="Weights: names or files.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Weights file to write (.safetensors).")],
) -> None:
    """Write the mean of detectors of which one was taught further; it knows what each knew."""
    check_device("cpu")
    from zavis_bt.perception.detector.building import average_detectors
    from zavis_bt.perception.models import find_weights

    _check_weights_file("--out", out)
    average_detectors([find_weights(detector) for detector in detectors], out)
    typer.echo(f"written: {out}")


@app.command()
def tune(
    detector: Annotated[str, typer.Argument(metavar="DETECTOR", help="Weights: a name or a file.")],
    data: Annotated[
        str, typer.Argument(metavar="DATA", help="As for train; images that it neither learnt from nor is judged on.")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Weights file to write (.safetensors).")],
    most_loss: Annotated[float, typer.Option(min=0, max=1, help="Of K-mAP, against the best cut's.")] = 0.02,
    images: Annotated[int | None, typer.Option(min=1, help="Only the first so many images.")] = None,
) -> None:
    """Set above which uncertainty things are unknown: the least WI for a small loss of K-mAP."""
    check_device("cpu")
    from zavis_bt.cli.detector_data import open_images
    from zavis_bt.cli.detector_eval import print_cuts
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.detector import NeuralDetector, save_detector
    from zavis_bt.perception.detector.tuning import best_cut, judge_cuts
    from zavis_bt.perception.models import find_weights

    _check_weights_file("--out", out)
    opened, dataset = NeuralDetector.load(find_weights(detector)), open_images(data)
    with progress_bar(min(images or len(dataset), len(dataset))) as progress:
        judged = judge_cuts(opened, dataset, images=images, progress=progress)
    best, network = best_cut(judged, most_loss), opened.network
    print_cuts(judged, best)
    network.config = network.config.with_choice(cdf=best.cdf)
    save_detector(network, out, {**opened.facts, "cut_set_on": dataset.name})
    typer.echo(f"written: {out}, unknown above a CDF of {best.cdf:g}")


def check_device(device: str) -> None:
    """Refuse devices that are not there, and work without the libraries for it.

    Raises:
        InputError: The device is unknown or missing, or the extra is not installed.
    """
    missing = [name for name in ("torch", "torchvision", "open_clip") if find_spec(name) is None]
    if missing:
        raise InputError(f"zavis detector: needs {missing[0]} (pip install 'zavis_bt[neural]')")
    import torch

    if device.partition(":")[0] not in ("cpu", "cuda"):
        raise InputError(f"--device: '{device}' is unknown (cpu or cuda)")
    if device != "cpu" and not torch.cuda.is_available():
        raise InputError(f"--device: '{device}' is not there (choose cpu)")


def _check_weights_file(name: str, out: Path) -> None:
    if out.suffix != ".safetensors":
        raise InputError(f"{name}: {out} (needs to end in .safetensors)")


def _new_network(
    known: str | None, method: str, backbone: str, width: int | None, weights: Path | None, seed: int
) -> DetectorNetwork:
    from zavis_bt.perception.datasets import project_name
    from zavis_bt.perception.detector import DetectorConfig
    from zavis_bt.perception.detector.building import DEFAULT_KNOWN, build_network
    from zavis_bt.perception.detector.config import backbone_named, method_named

    names = DEFAULT_KNOWN if known is None else tuple(map(project_name, listed(known)))
    working = 320 if backbone == "tiny" else (width or 800)
    frozen = weights is not None
    config = DetectorConfig(names, method_named(method), backbone_named(backbone), width=working, frozen=frozen)
    return build_network(config, seed, weights)


def _trained_network(start: str, settled: dict[str, object]) -> tuple[DetectorNetwork, dict[str, object]]:
    """Return a detector to teach further, and what it was trained on.

    ``settled`` are the options that it leaves no choice for.
    """
    from zavis_bt.perception.detector import load_detector
    from zavis_bt.perception.models import find_weights

    for option, value in settled.items():
        if value is not None:
            raise InputError(f"{option}: {start} of --start brings this along (leave one of the two out)")
    network, facts = load_detector(find_weights(start))
    return network, {"weights": start, **facts}


def _labelling(method: str, clip: str, device: str, *, trained: bool) -> Labelling | None:
    """Return where labels of unknown things come from; a trained network has proposals for them at once."""
    from zavis_bt.perception.detector import ClipLabelling, ProposalLabelling

    if method == "zavis":
        from zavis_bt.perception.clip import ClipModel, ClipObjectness
        from zavis_bt.perception.neural import find_clip

        architecture, pretrained, _ = find_clip(clip)
        objectness = ClipObjectness(ClipModel.load(architecture, pretrained, device=device))
        return ClipLabelling(objectness, start=0.0) if trained else ClipLabelling(objectness)
    return ProposalLabelling() if method == "ore" else None
