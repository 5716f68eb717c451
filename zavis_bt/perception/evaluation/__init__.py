"""Open-set detection and naming, judged: measures, and a report to look at."""

from zavis_bt.perception.evaluation.driver import Predict, collect, evaluate
from zavis_bt.perception.evaluation.open_set import ClassResult, OpenSetResult, judge
from zavis_bt.perception.evaluation.sizes import SizeRecall
from zavis_bt.perception.evaluation.tables import Prediction, Truth, truths_of

__all__ = [
    "ClassResult",
    "OpenSetResult",
    "Predict",
    "Prediction",
    "SizeRecall",
    "Truth",
    "collect",
    "evaluate",
    "judge",
    "truths_of",
]
