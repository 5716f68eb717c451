"""Labelled images of things: data sets in COCO's and in Pascal VOC's form."""

from zavis_bt.perception.datasets.dataset import Annotation, DetectionDataset
from zavis_bt.perception.datasets.names import project_name
from zavis_bt.perception.datasets.opening import open_dataset

__all__ = ["Annotation", "DetectionDataset", "open_dataset", "project_name"]
