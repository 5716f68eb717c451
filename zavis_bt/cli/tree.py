"""``zavis tree``: check, show and format mission trees, and look up what they can be made of."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from zavis_bt.tree import Registry
    from zavis_bt.tree.spec import Signature

app = typer.Typer(no_args_is_help=True, help="Check, show and format mission trees.")

Files = Annotated[list[Path], typer.Argument(help="Tree files.", show_default=False)]


@app.command()
def check(
    files: Files,
    mocks: Annotated[Path | None, typer.Option(help="File of mocks to check as well.", show_default=False)] = None,
) -> None:
    """Report every fault of tree files with its place."""
    from zavis_bt.errors import TreeError
    from zavis_bt.tree import check_tree

    registry, failed = _registry(), False
    for path in files:
        try:
            check_tree(path, registry, mocks=mocks)
        except TreeError as error:
            failed = True
            typer.echo(str(error), err=True)
        else:
            typer.echo(f"{path}: ok")
    if failed:
        raise typer.Exit(1)


@app.command()
def show(
    file: Annotated[Path, typer.Argument(help="Tree file.", show_default=False)],
    dot: Annotated[bool, typer.Option("--dot", help="Write Graphviz' language.")] = False,
    html: Annotated[bool, typer.Option("--html", help="Write a web page.")] = False,
) -> None:
    """Draw a tree with the ids of its nodes."""
    from zavis_bt.tree import check_tree
    from zavis_bt.tree.drawing import dot_tree, html_tree, text_tree

    tree = check_tree(file, _registry())
    if dot:
        typer.echo(dot_tree(tree))
    elif html:
        typer.echo(html_tree(tree, file.name))
    else:
        typer.echo(text_tree(tree.nodes()))


@app.command()
def fmt(
    files: Files,
    check_only: Annotated[bool, typer.Option("--check", help="Change nothing; exit 1 if a file would change.")] = False,
) -> None:
    """Bring tree files to their canonical form, comments kept."""
    from zavis_bt.tree.formatting import format_text

    changed = False
    for path in files:
        text = _read(path)
        formatted = format_text(text, str(path))
        if formatted == text:
            continue
        changed = True
        typer.echo(f"{path}: {'would be changed' if check_only else 'formatted'}")
        if not check_only:
            path.write_text(formatted, encoding="utf-8")
    if changed and check_only:
        raise typer.Exit(1)


@app.command()
def schema(
    files: Annotated[list[Path] | None, typer.Argument(help="Tree files whose trees are kinds too.")] = None,
) -> None:
    """Write the JSON Schema of tree files, for editors."""
    import json

    from zavis_bt.tree.schema import file_schema

    typer.echo(json.dumps(file_schema(_signatures(files or [])), indent=2, ensure_ascii=False))


@app.command()
def kinds(name: Annotated[str | None, typer.Argument(help="One kind, in full.", show_default=False)] = None) -> None:
    """List what trees can be made of: ports, types, units, ranges."""
    from rich.console import Console

    from zavis_bt.cli.tree_tables import kind_page, kinds_table
    from zavis_bt.errors import InputError, did_you_mean

    known = {signature.kind: signature for signature in _all_signatures()}
    if name is None:
        Console().print(kinds_table(known.values()))
    elif name in known:
        Console().print(kind_page(known[name]))
    else:
        raise InputError(f"unknown kind '{name}'{did_you_mean(name, known)}")


def _registry() -> Registry:
    from zavis_bt.tree import Registry

    return Registry.from_entry_points()


def _signatures(files: list[Path]) -> list[Signature]:
    """Return the behaviours, and the trees that nodes of the files may call."""
    from zavis_bt.tree.faults import Faults
    from zavis_bt.tree.includes import Library, tree_signature
    from zavis_bt.tree.loader import read_library
    from zavis_bt.tree.spec import Signature

    registry = _registry()
    behaviours = Library(registry, Faults()).behaviours
    found = [
        Signature(kind, class_.__doc__ or "", class_.in_ports, class_.out_ports) for kind, class_ in behaviours.items()
    ]
    for path in files:
        _, file = read_library(path, registry)
        found += [tree_signature(tree) for tree in file.scope.values()]
    return found


def _all_signatures() -> list[Signature]:
    from zavis_bt.tree.controls import CONTROLS, SET, SET_DOC
    from zavis_bt.tree.spec import Signature

    builtin = [control.signature for control in CONTROLS.values()]
    return [*builtin, Signature(SET, SET_DOC, {}, {}), *_signatures([])]


def _read(path: Path) -> str:
    from zavis_bt.errors import InputError

    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
