"""`zavis world`: check worlds, look at them, begin one."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from zavis_bt.errors import InputError

_DEFAULT_RADIUS = 0.18  # [m] of the smaller built-in robot

app = typer.Typer(help="Check worlds, look at them, begin one.", no_args_is_help=True)

WorldArgument = Annotated[str, typer.Argument(metavar="W", help="A world file, or the name of a built-in world.")]


@app.command()
def check(
    worlds: Annotated[list[str], typer.Argument(metavar="W...", help="World files or names of built-in worlds.")],
    radius: Annotated[float, typer.Option(min=0.01, help="Radius of the robot that must get about [m].")] = (
        _DEFAULT_RADIUS
    ),
) -> None:
    """Name all faults of worlds, and warn of what a robot cannot reach. Exit code 1 if there is a fault."""
    results = [_check(world, radius) for world in worlds]
    if not all(results):
        raise typer.Exit(1)


@app.command()
def show(
    world: WorldArgument,
    out: Annotated[Path | None, typer.Option(help="Write a picture to this file (.png, .jpg).")] = None,
) -> None:
    """Draw a world in the terminal, or as a picture with labels."""
    from sim.world_file import load_world
    from sim.worlds import resolve_world

    loaded = load_world(resolve_world(world))
    if out is None:
        from sim.sketch import sketch

        print(sketch(loaded, shutil.get_terminal_size((100, 40)).columns))
        return
    from sim.picture import save_picture

    save_picture(loaded, out)
    print(f"{out}: {loaded.name}, {_counts(len(loaded.furniture), len(loaded.objects), len(loaded.starts))}")


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Its name: letters, digits, '-' and '_'.")],
) -> None:
    """Write a small world with comments and its map to the current folder. Overwrites nothing."""
    from sim.worlds import write_starter

    path = write_starter(name, Path())
    print(f"{path}: written; see it with: zavis world show {path}")


def _check(name: str, radius: float) -> bool:
    """Print what is to be said about a world; return whether it is without fault."""
    from sim.reach import free_area, warnings
    from sim.world_file import inspect_world
    from sim.worlds import resolve_world

    try:
        path = resolve_world(name)
    except InputError as error:
        typer.echo(str(error), err=True)
        return False
    world, faults = inspect_world(path)
    for fault in faults:
        typer.echo(fault, err=True)
    if world is None:
        return False
    for warning in warnings(world, radius):
        typer.echo(f"{path}: warning: {warning}")
    counts = _counts(len(world.furniture), len(world.objects), len(world.starts))
    typer.echo(f"{path}: ok: {counts}, {free_area(world):.1f} m² free")
    return True


def _counts(furniture: int, objects: int, starts: int) -> str:
    return (
        f"{furniture} piece{'s' * (furniture != 1)} of furniture, {objects} object{'s' * (objects != 1)}, "
        f"{starts} start{'s' * (starts != 1)}"
    )
