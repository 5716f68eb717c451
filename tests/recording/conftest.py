"""The scripted mission lives beside the viewer's tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "viz"))
