"""`zavis matcher`: train the network that matches names with what is seen, and judge it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from zavis_bt.cli.lists import whole_numbers
from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from zavis_bt.perception.clip.patches import Patches
    from zavis_bt.perception.clip.settings import MatcherSettings
    from zavis_bt.perception.datasets import DetectionDataset

_MODEL = "zavis-tiny"

app = typer.Typer(help="Train the network that matches names with things seen, judge it.", no_args_is_help=True)

Data = Annotated[
    str, typer.Argument(metavar="DATA", help="Images in COCO's or Pascal VOC's form, or sim:COUNT[:SEED].")
]


@app.command()
def train(
    data: Data,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the training, then of the model.")],
    model: Annotated[str, typer.Option(help="Architecture: a name of open_clip, or a model's folder.")] = _MODEL,
    pretrained: Annotated[Path | None, typer.Option(help="Weights to begin with.")] = None,
    steps: Annotated[int, typer.Option(min=1, help="Of the optimiser.")] = 4000,
    epochs: Annotated[float | None, typer.Option(min=0.01, help="Instead of --steps: times each crop is seen.")] = None,
    minutes: Annotated[float | None, typer.Option(min=0.01, help="Time to end by, whatever the steps.")] = None,
    batch: Annotated[int, typer.Option(min=2, help="Crops a step.")] = 256,
    rate: Annotated[float, typer.Option("--learning-rate", min=1e-8, help="At its highest.")] = 2.5e-3,
    half_size: Annotated[float, typer.Option(min=0, max=1, help="Share of the steps at half the image size.")] = 0.5,
    words: Annotated[Path | None, typer.Option(help="JSON of synonyms and groups; a home's if not given.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint in --out.")] = False,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
) -> None:
    """Train a matcher on labelled images; an interrupted training goes on with --resume."""
    from zavis_bt.cli.detector import check_device
    from zavis_bt.cli.detector_data import open_images
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.clip.loading import build_untrained, model_config
    from zavis_bt.perception.clip.patches import collect_patches
    from zavis_bt.perception.clip.settings import MatcherSettings
    from zavis_bt.perception.clip.training import KEPT, MatcherTraining
    from zavis_bt.perception.clip.vocabulary import HOUSEHOLD_WORDS, Vocabulary
    from zavis_bt.perception.clip.writing import write_model
    from zavis_bt.perception.detector import TrainingLog

    check_device(device)
    if not resume and (out / "checkpoint.pt").exists():
        raise InputError(f"--out: {out} holds a training (go on with --resume, or name a new folder)")
    state = KEPT.load(out) if resume else None
    vocabulary = Vocabulary.read(words or HOUSEHOLD_WORDS)
    dataset = open_images(data)
    parts = build_untrained(model, pretrained)
    with progress_bar(len(dataset), "cutting out") as progress:
        size = parts.preprocessing.size
        patches = collect_patches(dataset, out / "patches", size, report=lambda done, _: progress(done))
    if epochs is not None:
        steps = max(math.ceil(epochs * len(patches.categories) / batch), 1)
    settings = MatcherSettings(
        steps, batch, learning_rate=rate, half_size=half_size, from_scratch=pretrained is None, seed=seed
    )
    training = MatcherTraining(parts, patches, vocabulary, settings, device)
    if state is not None:
        training.resume(state)
    with TrainingLog(out) as log, progress_bar(steps, "training") as progress:
        seconds = math.inf if minutes is None else 60 * minutes
        training.run(log, lambda state: KEPT.save(out, state), progress, seconds)
    facts = _facts(dataset, settings, training.done, patches)
    write_model(out, model_config(model), parts.preprocessing, training.averaged_weights(), facts)
    typer.echo(f"written: {out}")


@app.command()
def widen(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A model's folder, or one that comes along.")],
    width: Annotated[int, typer.Option(min=2, help="Of the new image tower.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the wider model.")],
    noise: Annotated[float, typer.Option(min=0.0, help="Of each weight, so that copies can come to differ.")] = 0.04,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
) -> None:
    """Make a trained image tower wider, so that it can learn more from there (train --model OUT --pretrained …)."""
    from zavis_bt.perception.clip.loading import load_parts, model_config, read_facts
    from zavis_bt.perception.clip.widening import widen as widen_weights
    from zavis_bt.perception.clip.widening import widened_config
    from zavis_bt.perception.clip.writing import write_model

    _check_new(out)
    parts, config = load_parts(model, None), model_config(model)
    weights = widen_weights(parts.network.state_dict(), config, width, noise=noise, seed=seed)
    facts = read_facts(model)
    write_model(out, widened_config(config, width), parts.preprocessing, weights, facts | {"widened_to": width})
    typer.echo(f"written: {out}")


@app.command()
def deepen(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A model's folder, or one that comes along.")],
    layers: Annotated[str, typer.Option(help="Blocks of each stage of the new image tower, such as 2,3,3,1.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the deeper model.")],
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
) -> None:
    """Make a trained image tower deeper, so that it can learn more from there (train --model OUT --pretrained …)."""
    from zavis_bt.perception.clip.deepening import deepen as deepen_weights
    from zavis_bt.perception.clip.deepening import deepened_config
    from zavis_bt.perception.clip.loading import load_parts, model_config, read_facts
    from zavis_bt.perception.clip.writing import write_model

    _check_new(out)
    blocks = [*whole_numbers(layers, "--layers", "2,3,3,1")]
    parts, config = load_parts(model, None), model_config(model)
    weights = deepen_weights(parts.network.state_dict(), config, blocks, seed=seed)
    facts = read_facts(model) | {"deepened_to": blocks}
    write_model(out, deepened_config(config, blocks), parts.preprocessing, weights, facts)
    typer.echo(f"written: {out}")


@app.command()
def average(
    models: Annotated[list[str], typer.Argument(metavar="MODEL...", help="Folders of trainings, or a shipped model.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the mean.")],
) -> None:
    """Write the mean of models that trained on from the same weights; it is mostly better than each of them."""
    from zavis_bt.perception.clip.averaging import averaged_facts
    from zavis_bt.perception.clip.loading import load_parts, model_config, read_facts
    from zavis_bt.perception.clip.writing import write_model
    from zavis_bt.perception.training.averaging import averaged_weights

    _check_new(out)
    parts = [load_parts(model, None) for model in models]
    weights = averaged_weights([one.network.state_dict() for one in parts])
    facts = averaged_facts([read_facts(model) for model in models])
    write_model(out, model_config(models[-1]), parts[-1].preprocessing, weights, facts)
    typer.echo(f"written: {out}")


@app.command()
def lit(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The --out folder of a training that has ended.")],
    words: Annotated[Path | None, typer.Option(help="JSON of synonyms and groups; a home's if not given.")] = None,
    without_tested: Annotated[bool, typer.Option(help="Leave the synonyms that eval asks for out of it.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
) -> None:
    """Let a trained image tower be asked with any English word: the model is then called FOLDER-lit."""
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.clip.loading import load_parts
    from zavis_bt.perception.clip.patches import read_patches
    from zavis_bt.perception.clip.vocabulary import HOUSEHOLD_WORDS, Vocabulary
    from zavis_bt.perception.clip.word_tower import WORDS
    from zavis_bt.perception.clip.word_training import fit_word_tower

    steps = 1500
    vocabulary = Vocabulary.read(words or HOUSEHOLD_WORDS)
    if without_tested:
        vocabulary = vocabulary.without(vocabulary.tested_synonyms)
    parts, patches = load_parts(str(folder), None), read_patches(folder / "patches")
    with progress_bar(steps, "fitting") as progress:
        tower = fit_word_tower(parts, patches, vocabulary, steps=steps, seed=seed, progress=progress)
    tower.save(folder / WORDS)
    typer.echo(f"written: {folder / WORDS}")


@app.command("eval")
def evaluate(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A name, or a folder; MODEL@WEIGHTS of open_clip.")],
    data: Data,
    width: Annotated[int | None, typer.Option(min=32, help="Scale images to this width first [px].")] = None,
    words: Annotated[Path | None, typer.Option(help="JSON of synonyms and groups; a home's if not given.")] = None,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
    as_json: Annotated[bool, typer.Option("--json", help="Print one line of JSON.")] = False,
) -> None:
    """Judge a matcher on labelled images: categories, colours, queries, synonyms, objectness."""
    from zavis_bt.cli.detector import check_device
    from zavis_bt.cli.detector_data import open_images
    from zavis_bt.cli.detector_progress import progress_bar
    from zavis_bt.perception.clip import ClipModel
    from zavis_bt.perception.clip.evaluation import MatcherEvaluation
    from zavis_bt.perception.clip.gallery import encode_gallery
    from zavis_bt.perception.clip.loading import read_facts
    from zavis_bt.perception.clip.vocabulary import HOUSEHOLD_WORDS, Vocabulary

    check_device(device)
    vocabulary = Vocabulary.read(words or HOUSEHOLD_WORDS)
    architecture, _, pretrained = model.partition("@")
    opened = ClipModel.load(architecture, pretrained or None, device=device)
    facts = read_facts(architecture)
    dataset = open_images(data)
    with progress_bar(len(dataset), "looking") as progress:
        gallery = encode_gallery(opened, dataset, width=width, report=lambda done, _: progress(done))
    trained = [*map(str, facts.get("categories") or dataset.categories)]
    held_out = [*map(str, facts.get("held_out") or ())]
    report = MatcherEvaluation(opened, gallery, trained, held_out).report(vocabulary)
    source = f"{dataset.name}, {'rendered' if dataset.rendered else 'photographed'} images"
    if as_json:
        document: dict[str, Any] = {"model": model, "trained_on": facts.get("trained_on"), "data": source}
        figures = {name: None if math.isnan(value) else value for name, value in report.figures.items()}
        typer.echo(json.dumps(document | {"figures": figures, "confusions": report.confusions}))
        return
    typer.echo(f"{model} (trained on: {facts.get('trained_on', 'not told')}) on {source}")
    for name, value in report.figures.items():
        typer.echo(f"{value:8.3f}  {name}")
    for true, given, share in report.confusions:
        typer.echo(f"{share:8.3f}  of {true} taken for {given}")


def _check_new(out: Path) -> None:
    from zavis_bt.perception.clip.loading import CONFIG

    if (out / CONFIG).exists():
        raise InputError(f"--out: {out} holds a model (name a new folder)")


def _facts(dataset: DetectionDataset, settings: MatcherSettings, done: int, patches: Patches) -> dict[str, Any]:
    return {
        "trained_on": "rendered pixels" if dataset.rendered else "photographs",
        "data": dataset.name,
        "images": len(dataset),
        "steps": done,
        "batch": settings.batch,
        "learning_rate": settings.learning_rate,
        "half_size": settings.half_size,
        "seed": settings.seed,
        "held_out": patches.held_out,
        "categories": patches.names,
        "colours": patches.colour_names,
    }
