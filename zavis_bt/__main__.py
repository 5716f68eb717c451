"""`python -m zavis_bt` is `zavis`."""

from zavis_bt.cli import main

main()
