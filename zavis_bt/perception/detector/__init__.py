"""The open-set detector: finds known things, and things that are none of them; needs the extra ``neural``."""

from zavis_bt.perception.detector.batches import Views
from zavis_bt.perception.detector.checkpoint import Checkpoint
from zavis_bt.perception.detector.config import Choice, DetectorConfig
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.neural_detector import NeuralDetector
from zavis_bt.perception.detector.pseudo_labels import ClipLabelling, ProposalLabelling
from zavis_bt.perception.detector.training import Training, TrainingSettings
from zavis_bt.perception.detector.training_log import TrainingLog
from zavis_bt.perception.detector.weights_file import load_detector, save_detector

__all__ = [
    "Checkpoint",
    "Choice",
    "ClipLabelling",
    "DetectorConfig",
    "DetectorNetwork",
    "NeuralDetector",
    "ProposalLabelling",
    "Training",
    "TrainingLog",
    "TrainingSettings",
    "Views",
    "load_detector",
    "save_detector",
]
