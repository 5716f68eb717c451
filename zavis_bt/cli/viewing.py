"""The live view as a context: there when asked for, always closed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from zavis_bt.protocols import Observer


@contextmanager
def viewer(wanted: bool, title: str) -> Iterator[list[Observer]]:
    """Yield the observers of the live view: one, with its address printed, or none.

    At a terminal the view stays after the mission, until Enter is pressed.
    """
    if not wanted:
        yield []
        return
    from zavis_bt.viz import MeshcatViewer

    view = MeshcatViewer(open_browser=sys.stdout.isatty(), title=title)
    try:
        print(f"live view: {view.url}", file=sys.stderr)
        yield [view]
        if sys.stdin.isatty():
            input("The mission has ended. Press Enter to close the live view … ")
    except EOFError:
        pass
    finally:
        view.close()
