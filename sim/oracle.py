"""The simulated person, who knows which instance is meant."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from sim.frame import InstanceView, instances_of
from sim.perception.words import normal_name
from sim.targets import Similarity, views_named
from zavis_bt.protocols import Clock
from zavis_bt.types import Answer, Box, Candidate

LEAST_IOU = 0.3
LEAST_IOA = 0.5


def shows(box: Box, true: Box) -> bool:
    """Return whether a candidate's box shows what the true box holds: IoU > 0.3 or IoA > 0.5.

    IoA is the intersection over the area of the true box: the share of the instance that the candidate shows.
    """
    return box.iou(true) > LEAST_IOU or box.intersection(true) > LEAST_IOA * true.area


class OracleAnswer:
    """The person's answer, given after a while."""

    def __init__(self, answer: Answer, clock: Clock | None, due: float) -> None:
        self._answer, self._clock, self._due = answer, clock, due

    def done(self) -> bool:
        """Return whether the person has answered."""
        return self._clock is None or self._clock.now() >= self._due

    def result(self) -> Answer:
        """Return the answer; waits for it."""
        if self._clock is not None:
            self._clock.wait_until(self._due)
        return self._answer

    def cancel(self) -> None:
        """The answer is no longer wanted; a person needs no cleaning up."""


class Oracle:
    """Says yes to the first candidate that shows a target instance, as far as that is visible in its frame."""

    def __init__(self, targets: Collection[str] | str, clock: Clock | None = None, answer_time: float = 0.0) -> None:
        """Set up a person who has something in mind.

        Args:
            targets: Ids of the instances that are meant, or names: a category, or a colour and a category. A single
                text is one name or id.
            clock: The mission's clock; needed for an answer that takes time.
            answer_time: How long the person takes to answer [s].
        """
        self._targets = frozenset(map(normal_name, [targets] if isinstance(targets, str) else targets))
        self._clock, self._answer_time = clock, answer_time
        if answer_time > 0 and clock is None:
            raise ValueError("an answer that takes time needs a clock")

    def ask(self, target: str, candidates: Sequence[Candidate]) -> OracleAnswer:
        """Return the answer to the question which candidate is the target.

        Raises:
            InputError: A candidate's frame does not come from the simulated camera.
        """
        due = self._clock.now() + self._answer_time if self._clock is not None else 0.0
        clock = self._clock if self._answer_time > 0 else None
        return OracleAnswer(self._judge(target, candidates), clock, due)

    def _judge(self, target: str, candidates: Sequence[Candidate]) -> Answer:
        for number, candidate in enumerate(candidates):
            for instance in self._meant(instances_of(candidate.frame)):
                if shows(candidate.box, instance.box):
                    return Answer(number, f"it shows {instance.id}")
        return Answer(None, f"none of {len(candidates)} shows the {target}")

    def _meant(self, instances: Sequence[InstanceView]) -> Iterable[InstanceView]:
        return filter(self._is_meant, instances)

    def _is_meant(self, instance: InstanceView) -> bool:
        names = instance.id, instance.category, f"{instance.colour} {instance.category}"
        return not self._targets.isdisjoint(map(normal_name, names))


class NamedOracle(Oracle):
    """An oracle that knows no more of the world than the text and the frames it is shown."""

    def __init__(self, text: str, similarity: Similarity, clock: Clock | None = None, answer_time: float = 0.0) -> None:
        """Set up a person who has what a text names in mind.

        Args:
            text: For example "the red wallet".
            similarity: Of two names, 1 for the same; very similar ones are synonyms.
            clock: The mission's clock; needed for an answer that takes time.
            answer_time: How long the person takes to answer [s].
        """
        super().__init__((), clock, answer_time)
        self._text, self._similarity = text, similarity

    def _meant(self, instances: Sequence[InstanceView]) -> Iterable[InstanceView]:
        ids = views_named(instances, self._text, self._similarity)
        return (instance for instance in instances if instance.id in ids)
