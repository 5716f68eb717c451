"""`zavis …`: the command line's root, and how its commands end.

Exit codes: 0 done, 1 user error (one line, no traceback), 2 usage, 3 bug (traceback), 4 mission failed,
130 interrupted,
143 or 129 ended by SIGTERM or SIGHUP, as orderly as by Ctrl-C.
"""

from __future__ import annotations

import sys
import traceback
from typing import Any

import typer
from typer.core import TyperGroup

from zavis_bt import __version__
from zavis_bt.cli import (
    bench,
    camera,
    demo,
    detector,
    doctor,
    drive,
    matcher,
    models,
    perception,
    run,
    sim,
    tree,
    world,
)
from zavis_bt.cli.ending import Ended, say_last, signals_end
from zavis_bt.errors import ZavisError

USER_ERROR, BUG, FAILED, INTERRUPTED = 1, 3, 4, 130


class Guarded(TyperGroup):
    """Turns whatever a command raises into one line and an exit code, in one place."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command."""
        try:
            with signals_end():
                return super().invoke(ctx)
        except ZavisError as error:
            print(error, file=sys.stderr)
            raise typer.Exit(USER_ERROR) from None
        except Ended as ended:
            say_last(f"ended by {ended}")
            raise typer.Exit(ended.exit_code) from None
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except BrokenPipeError:  # the reader of our output has gone: nothing to say and nobody to say it to
            sys.stderr.close()
            raise typer.Exit(USER_ERROR) from None
        except Exception as error:  # a bug, of any type: it gets its own exit code, here only
            if type(error).__module__.split(".")[0] in ("typer", "click"):
                raise
            traceback.print_exc()
            print("This is a bug in zavis_bt: please report it with the lines above.", file=sys.stderr)
            raise typer.Exit(BUG) from None


app = typer.Typer(
    cls=Guarded,
    help="Search missions as behaviour trees: in simulation, on the robot, compared with each other.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help, at half the start-up time
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command("demo")(demo.demo)
app.command("run")(run.run)
app.command("bench")(bench.bench)
app.command("doctor")(doctor.doctor)
app.command("drive")(drive.drive)
app.add_typer(camera.app, name="camera")
app.add_typer(detector.app, name="detector")
app.add_typer(matcher.app, name="matcher")
app.add_typer(models.app, name="models")
app.add_typer(perception.app, name="perception")
app.add_typer(sim.app, name="sim")
app.add_typer(tree.app, name="tree")
app.add_typer(world.app, name="world")


def _version(asked: bool) -> None:
    if asked:
        print(f"zavis_bt {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version."),
) -> None:
    """Read the options that stand before a command."""


def main() -> None:
    """Run the command line."""
    app(prog_name="zavis")
