"""Text-image matching with CLIP models; needs the extra ``neural``."""

from zavis_bt.perception.clip.matcher import ClipMatcher
from zavis_bt.perception.clip.model import ClipModel
from zavis_bt.perception.clip.objectness import ClipObjectness

__all__ = ["ClipMatcher", "ClipModel", "ClipObjectness"]
