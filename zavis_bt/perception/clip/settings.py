"""How a matcher is trained."""

from __future__ import annotations

from dataclasses import dataclass, field

from zavis_bt.perception.clip.augment import Augmentation


@dataclass(frozen=True, slots=True)
class MatcherSettings:
    """How a matcher is trained."""

    steps: int = 4000
    batch: int = 256
    """Crops a step."""
    more_captions: int = 128
    """Of other crops: only to be told from."""
    background: float = 0.12
    """Share of crops that show no whole thing."""
    learning_rate: float = 2.5e-3
    """At its highest; it rises over a first part and falls along a cosine."""
    weight_decay: float = 0.05
    half_size: float = 0.5
    """Share of the steps in which the image tower reads squares of half its size, where it can: four times as fast."""
    least_visible: float = 0.3
    """Of a thing, to be learnt from; those of which twice that is in sight count in full [share]."""
    averaging: float = 0.99
    """Of the weights that are kept: their share of the average before, a step."""
    from_scratch: bool = True
    """Whether the text tower's word vectors are random at the start."""
    seed: int = 0
    """Of weights and draws."""
    save_every: int = 200
    """Steps between checkpoints."""
    augmentation: Augmentation = field(default_factory=Augmentation)
