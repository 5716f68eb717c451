"""The command line: the only room that composes all others."""

from zavis_bt.cli.main import main

__all__ = ["main"]
