"""Commonsense: where things usually are, and how near two words are."""

from zavis_bt.knowledge.comet import CometPrior
from zavis_bt.knowledge.commonsense_prior import CommonsensePrior
from zavis_bt.knowledge.priors import PRIORS, commonsense, make_prior, none, word
from zavis_bt.knowledge.simple_priors import UniformPrior, WordPrior
from zavis_bt.knowledge.table import CommonsenseTable, load_table
from zavis_bt.knowledge.vectors import WordVectors, word_vectors

__all__ = [
    "PRIORS",
    "CometPrior",
    "CommonsensePrior",
    "CommonsenseTable",
    "UniformPrior",
    "WordPrior",
    "WordVectors",
    "commonsense",
    "load_table",
    "make_prior",
    "none",
    "word",
    "word_vectors",
]
