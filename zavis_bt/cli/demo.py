"""`zavis demo`: a whole mission in the built-in apartment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def demo(
    target: Annotated[str, typer.Option("--target", "-t", help="What to find.")] = "red wallet",
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
    perception: Annotated[
        str, typer.Option(help="Who sees: simulated, neural, a plug-in, or an eyes file.")
    ] = "simulated",
    view: Annotated[
        bool, typer.Option("--view/--no-view", help="Show map, robot and tree live in the browser.")
    ] = True,
    record: Annotated[Path | None, typer.Option(help="Folder for the run; new one under runs/ if not given.")] = None,
) -> None:
    """Find the red wallet in the built-in apartment with a simulated Pioneer 3-AT."""
    from zavis_bt.cli.files import load_robot_spec, resolve_tree
    from zavis_bt.cli.run import report, run_mission, simulated
    from zavis_bt.cli.simulate import Choices

    choices = Choices(
        tree=resolve_tree("search"),
        robot=load_robot_spec("pioneer3at"),
        method="search",
        perception=perception,
        real_time=view,
    )
    print(f"Looking for “{target}” in the built-in apartment …")
    result, folder = run_mission(simulated(choices, "apartment", target, seed, None), record=record, view=view)
    report(result, folder)
    if not result.success:
        raise typer.Exit(4)
