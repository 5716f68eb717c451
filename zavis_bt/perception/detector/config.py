"""What a detector is: method, classes, architecture and how its boxes are chosen."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, Literal, TypeVar, get_args

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.types import UNKNOWN_CLASS

Method = Literal["zavis", "ore", "faster_rcnn"]
BackboneName = Literal["tiny", "resnet50_fpn", "resnet50_c4"]

_METHODS: tuple[Method, ...] = get_args(Method)
_BACKBONES: tuple[BackboneName, ...] = get_args(BackboneName)
_Choice = TypeVar("_Choice", bound=str)


def method_named(name: str) -> Method:
    """Return the method of a name.

    Raises:
        InputError: There is none.
    """
    return _one_of("method", name, _METHODS)


def backbone_named(name: str) -> BackboneName:
    """Return the backbone of a name.

    Raises:
        InputError: There is none.
    """
    return _one_of("backbone", name, _BACKBONES)


def _one_of(what: str, name: str, choices: tuple[_Choice, ...]) -> _Choice:
    for choice in choices:
        if choice == name:
            return choice
    raise InputError(f"{what}: '{name}' is unknown{did_you_mean(name, choices)}")


@dataclass(frozen=True, slots=True)
class Choice:
    """Which boxes of a network's become detections."""

    known_score: float = 0.05
    """Least score of a known class."""
    unknown_score: float = 0.3
    """Least score of an unknown thing."""
    known_nms: float = 0.5
    """IoU above which of two boxes of one known class the worse goes."""
    unknown_nms: float = 0.4
    """The same for boxes of unknown things."""
    covered: float = 0.5
    """IoU with a better known box above which an unknown box goes."""
    most: int = 40
    """Detections in one image."""
    cdf: float = 0.9
    """Of the total uncertainty's Gaussian, above which a box is of an unknown thing."""
    quality_power: float = 0.5
    """Weight of the localisation quality in scores of unknown things, as an exponent."""


@dataclass(frozen=True, slots=True)
class DetectorConfig:
    """A detector's description, kept in its weights file."""

    known: tuple[str, ...]
    """The K known classes."""
    method: Method = "zavis"
    """The paper's, open-world detection with energies (ORE), or plain Faster R-CNN without ``unknown``."""
    backbone: BackboneName = "tiny"
    """Small and trained from nothing, or ResNet-50."""
    mixtures: int = 5
    """J of the mixture of logits; 1 is a usual softmax head and used by the other methods."""
    width: int = 320
    """Working width: wider images are scaled down to it [px]."""
    frozen: bool = False
    """Whether batch normalisation keeps the statistics that its weights came with, as small batches want it."""
    choice: Choice = field(default_factory=Choice)

    def __post_init__(self) -> None:
        method_named(str(self.method))
        backbone_named(str(self.backbone))
        if not self.known or UNKNOWN_CLASS in self.known or len(set(self.known)) < len(self.known):
            raise InputError(f"known: needs one or more different classes, none of them '{UNKNOWN_CLASS}'")
        if not 1 <= self.mixtures <= 64 or not 32 <= self.width <= 4096:
            raise InputError(f"mixtures {self.mixtures}, width {self.width}: out of range (1 to 64, 32 to 4096)")

    @property
    def unknown(self) -> int | None:
        """Index of ``unknown`` among the labels, right after the known; None for the method without it."""
        return None if self.method == "faster_rcnn" else len(self.known)

    @property
    def labels(self) -> int:
        """Number of labels with background, which is the last: K + 2, or K + 1 without ``unknown``."""
        return len(self.known) + (1 if self.unknown is None else 2)

    @property
    def components(self) -> int:
        """Number of mixtures that the method has: J, or 1."""
        return self.mixtures if self.method == "zavis" else 1

    def with_choice(self, **changes: Any) -> DetectorConfig:
        """Return a copy that chooses its boxes otherwise; ``changes`` are fields of `Choice`."""
        return replace(self, choice=replace(self.choice, **changes))

    def to_json(self) -> str:
        """Return the description as text."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> DetectorConfig:
        """Return the description in a text.

        Raises:
            InputError: It is no description of a detector that this version knows.
        """
        try:
            content: dict[str, Any] = json.loads(text)
            choice = Choice(**content.pop("choice"))
            content["known"] = tuple(content["known"])
            strange = set(content) - {each.name for each in fields(cls)}
            if strange:
                raise InputError(
                    f"detector: unknown settings {', '.join(sorted(strange))} (written by a newer version)"
                )
            return cls(choice=choice, **content)
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise InputError(f"detector: its description cannot be read: {error!r} (export it again)") from error
