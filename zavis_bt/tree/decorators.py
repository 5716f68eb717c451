"""Decorators that py_trees lacks, or whose own would use wall time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import py_trees
from py_trees.common import Status
from py_trees.decorators import Decorator

from zavis_bt.errors import ZavisError
from zavis_bt.protocols import Clock
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.condition import Evaluate
from zavis_bt.tree.leaves import EPSILON
from zavis_bt.tree.scope import Binding, Scope, Variable

Node = py_trees.behaviour.Behaviour


class Timeout(Decorator):
    """Stops its child and fails when it takes longer than a time on the mission's clock."""

    def __init__(self, name: str, child: Node, seconds: float) -> None:
        """Take the child and its time [s]."""
        super().__init__(name, child)
        self.seconds = seconds
        self._clock: Clock | None = None
        self._end = 0.0

    def setup(self, *, clock: Clock) -> None:  # type: ignore[override]  # trees read the resources' names from here
        """Take the mission's clock."""
        self._clock = clock

    def initialise(self) -> None:
        """Start the time."""
        assert self._clock is not None
        self.feedback_message = ""
        self._end = self._clock.now() + self.seconds

    def update(self) -> Status:
        """Return the child's status, or fail when the time is over."""
        assert self._clock is not None
        if self.decorated.status is Status.RUNNING and self._clock.now() >= self._end - EPSILON:
            self.feedback_message = f"timed out after {self.seconds:g} s"
            self.decorated.stop(Status.INVALID)
            return Status.FAILURE
        return self.decorated.status


class Retry(py_trees.decorators.Retry):
    """py_trees' own, saying which attempt it is."""

    def update(self) -> Status:
        """Return the child's status, RUNNING while attempts are left."""
        status = super().update()
        failed = status is Status.FAILURE
        done = f"{self.failures} attempts failed" if failed else f"attempt {self.failures + 1} of {self.num_failures}"
        self.feedback_message = done
        return status


class Repeat(py_trees.decorators.Repeat):
    """py_trees' own, saying which round it is."""

    def update(self) -> Status:
        """Return the child's status, RUNNING while rounds are left."""
        status = super().update()
        if status is not Status.RUNNING:
            self.feedback_message = f"{self.success} rounds"
            return status
        rounds = f" of {self.num_success}" if self.num_success > 0 else ""
        self.feedback_message = f"round {self.success + 1}{rounds}"
        return status


class Call(Decorator):
    """A tree called as a kind. Its own variables begin anew with each start."""

    def __init__(self, name: str, child: Node, variables: Sequence[Variable]) -> None:
        """Take the tree's root node and variables."""
        super().__init__(name, child)
        self._variables = variables

    def initialise(self) -> None:
        """Forget the variables of the run before."""
        for variable in self._variables:
            variable.clear()

    def update(self) -> Status:
        """Return the root node's status."""
        return self.decorated.status


class When(Decorator):
    """Starts its child only if a comparison holds, otherwise fails."""

    def __init__(self, name: str, child: Node, condition: Evaluate, text: str, scope: Scope) -> None:
        """Take the child, the comparison and the names it reads."""
        super().__init__(name, child)
        self._check = Condition(name, condition, text, scope)

    def tick(self) -> Iterator[Node]:
        """Compare at the start, then tick the child."""
        if self.status is not Status.RUNNING and self._check.update() is not Status.SUCCESS:
            self.feedback_message = self._check.feedback_message
            self.stop(Status.FAILURE)
            yield self
            return
        self.feedback_message = ""
        yield from super().tick()

    def update(self) -> Status:
        """Return the child's status."""
        return self.decorated.status


class Condition(Behaviour):
    """Succeeds if a comparison holds."""

    def __init__(self, name: str, condition: Evaluate, text: str, scope: Scope) -> None:
        """Take the comparison and the names it reads."""
        super().__init__(name)
        self._condition = condition
        self._text = text
        self._scope = scope

    def update(self) -> Status:
        """Compare."""
        try:
            holds = self._condition(self._scope.read)
        except (ZavisError, TypeError) as error:  # not written yet, or None where a number is compared
            return self.fail(f"{self._text}: {error}")
        return self.succeed() if holds else self.fail(f"{self._text} does not hold")


class Assign(Behaviour):
    """Gives variables a value: the kind ``set``."""

    def __init__(self, name: str, values: Sequence[tuple[Variable, Binding]]) -> None:
        """Take the variables, each with what it becomes."""
        super().__init__(name)
        self._values = values

    def update(self) -> Status:
        """Write the values."""
        for variable, source in self._values:
            variable.write(source.read())
        return self.succeed()
