"""Open-set detection and naming, judged: measures, and a report to look at."""

from zavis_bt.perception.evaluation.driver import Predict, collect, evaluate, predictions_of
from zavis_bt.perception.evaluation.open_set import ClassResult, OpenSetResult, judge
from zavis_bt.perception.evaluation.queries import NameRate, NameResult, Query, judge_answers, queries_of
from zavis_bt.perception.evaluation.report import write_report
from zavis_bt.perception.evaluation.sizes import SizeRecall
from zavis_bt.perception.evaluation.tables import Prediction, Truth, truths_of

__all__ = [
    "ClassResult",
    "NameRate",
    "NameResult",
    "OpenSetResult",
    "Predict",
    "Prediction",
    "Query",
    "SizeRecall",
    "Truth",
    "collect",
    "evaluate",
    "judge",
    "judge_answers",
    "predictions_of",
    "queries_of",
    "truths_of",
    "write_report",
]
