"""Looking at a mission while it runs."""

from zavis_bt.viz.viewer import MeshcatViewer

__all__ = ["MeshcatViewer"]
