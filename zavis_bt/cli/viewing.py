"""The live view as a context: there when asked for, always closed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from zavis_bt.protocols import Observer


@contextmanager
def viewer(wanted: bool) -> Iterator[list[Observer]]:
    """Yield the observers of the live view: one, with its address printed, or none."""
    if not wanted:
        yield []
        return
    from zavis_bt.viz import MeshcatViewer

    view = MeshcatViewer(open_browser=sys.stdout.isatty())
    try:
        print(f"live view: {view.url}", file=sys.stderr)
        yield [view]
    finally:
        view.close()
