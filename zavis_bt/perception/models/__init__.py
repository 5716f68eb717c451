"""Models: which there are, where they lie, and whether they are what they were."""

from zavis_bt.perception.models.fetching import download
from zavis_bt.perception.models.finding import find_weights
from zavis_bt.perception.models.forms import check_form, check_weights_file
from zavis_bt.perception.models.manifest import WEIGHTS, ModelEntry, manifest, remedy
from zavis_bt.perception.models.seals import FileSum, Seal
from zavis_bt.perception.models.store import ModelState, ModelStore, default_root

__all__ = [
    "WEIGHTS",
    "FileSum",
    "ModelEntry",
    "ModelState",
    "ModelStore",
    "Seal",
    "check_form",
    "check_weights_file",
    "default_root",
    "download",
    "find_weights",
    "manifest",
    "remedy",
]
