"""`zavis models`: which models are here, adding them, checking them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from zavis_bt.perception.models import ModelState

_MARKS = {"shipped": "green", "added": "green", "missing": "dim", "damaged": "bold red"}

app = typer.Typer(help="Networks and their weights: which are here, add some, check them.", no_args_is_help=True)


@app.command("list")
def list_models(
    as_json: Annotated[bool, typer.Option("--json", help="Print one line of JSON.")] = False,
) -> None:
    """List all models: what each is for, whether it is here, and how large it is."""
    from rich.console import Console

    from zavis_bt.perception.models import ModelStore

    store = ModelStore()
    states = [store.state(name) for name in store.names()]
    if as_json:
        print(json.dumps({"folder": str(store.root), "models": [_as_data(state) for state in states]}))
        return
    console = Console(highlight=False)
    console.print(_table(states, wide=console.width >= 100))
    console.print(f"added ones lie in {store.root}; get one: zavis models add NAME", soft_wrap=True)
    for state in states:
        if state.state == "damaged":
            console.print(f"{state.name}: {state.problem}", style="red", soft_wrap=True, markup=False)


@app.command()
def add(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A name from the list, or a new one for your own.")],
    source: Annotated[
        Path | None, typer.Argument(metavar="[FILE|FOLDER]", help="What to copy; without it, download a known model.")
    ] = None,
    replace: Annotated[bool, typer.Option("--replace", help="Replace what is there under that name.")] = False,
) -> None:
    """Copy a model to where it is found by name, or download it; its checksums are recorded and compared ever after."""
    from rich.console import Console

    from zavis_bt.perception.models import ModelStore, check_form, download, manifest

    store, console = ModelStore(), Console(highlight=False)
    entry = manifest().get(name)
    if source is None:
        total = round(entry.megabytes * 1e6) if entry and entry.url and entry.megabytes else None
        with _bar(f"fetching {name}", total, console) as progress:
            path = download(store, name, replace=replace, progress=progress)
    else:
        source = source.expanduser()
        check_form(source, entry.form if entry else None, entry.model_type if entry else None)
        with _bar(f"copying {name}", _size_of(source), console) as progress:
            path = store.add(name, source, replace=replace, progress=progress)
    console.print(f"{name}: added to {path}", soft_wrap=True, markup=False)


@app.command()
def check(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME...", help="Which; all that are here if none.")
    ] = None,
) -> None:
    """Compare every file of the models that are here with its checksum. Exit code 1 if one is damaged."""
    from rich.console import Console

    from zavis_bt.perception.models import ModelStore

    store, console = ModelStore(), Console(highlight=False)
    quick = [store.state(name) for name in names or store.names()]
    here = [state for state in quick if state.state != "missing"]
    with _bar("checking", sum(state.size or 0 for state in here), console) as progress:
        states = [store.state(state.name, progress) for state in here]
    for state in states:
        problem = state.problem or f"ok ({_readable(state.size)})"
        style = "red" if state.state == "damaged" else ""
        console.print(f"{state.name}: {problem}", style=style, soft_wrap=True, markup=False)
    missing = [state.name for state in quick if state.state == "missing"]
    if names and missing:
        raise InputError(f"not on this machine: {', '.join(missing)} (zavis models list)")
    if any(state.state == "damaged" for state in states):
        raise typer.Exit(1)


def _table(states: list[ModelState], *, wide: bool) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    table.add_column("name", no_wrap=True)
    for column in ("what for", "trained on", "licence")[: 3 if wide else 2]:
        table.add_column(column)
    table.add_column("state", no_wrap=True)
    table.add_column("size", justify="right", no_wrap=True)
    for state in states:
        entry, mark = state.entry, _MARKS[state.state]
        known = (entry.purpose, entry.trained_on, entry.licence) if entry else ("your own", "", "")
        table.add_row(state.name, *known[: 3 if wide else 2], f"[{mark}]{state.state}[/]", _expected_size(state))
    return table


def _expected_size(state: ModelState) -> str:
    if state.size is not None:
        return _readable(state.size)
    return f"≈ {_readable(state.entry.megabytes * 1e6)}" if state.entry and state.entry.megabytes else ""


def _readable(size: float | None) -> str:
    if size is None:
        return "size unknown"
    return f"{size / 1e9:.2f} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"


def _size_of(source: Path) -> int:
    if source.is_file():
        return source.stat().st_size
    return sum(path.stat().st_size for path in source.rglob("*") if path.is_file())


@contextmanager
def _bar(text: str, total: int | None, console: Console) -> Iterator[Callable[[int], None]]:
    """Yield what takes the bytes that are done; shown at a terminal only, and gone afterwards."""
    if not console.is_terminal or not total:
        yield lambda size: None
        return
    from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TransferSpeedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TransferSpeedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(text, total=total)
        yield lambda size: bar.advance(task, size)


def _as_data(state: ModelState) -> dict[str, object]:
    entry = state.entry
    return {
        "name": state.name,
        "state": state.state,
        "path": str(state.path) if state.path else None,
        "size": state.size,
        "problem": state.problem or None,
        "purpose": entry.purpose if entry else None,
        "trained_on": entry.trained_on if entry else None,
        "licence": entry.licence if entry else None,
    }
