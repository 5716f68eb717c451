"""Composites that py_trees lacks, or whose own would let an old and a new action overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import py_trees
from py_trees.common import Status
from py_trees.composites import Composite

from zavis_bt.errors import ZavisError
from zavis_bt.tree.behaviour import Behaviour, TakenOver
from zavis_bt.tree.scope import Binding, Variable

Node = py_trees.behaviour.Behaviour


class ReactiveSelector(py_trees.composites.Selector, TakenOver):
    """Selector without memory that stops its running child before an action of higher priority starts.

    Every behaviour that `acts` announces its start. What only looks (a condition) starts and ends without stopping
    anything. An action that took over and failed within the same tick does so once: until it runs, it no longer stops
    the child that it would only have interrupted.
    """

    def __init__(self, name: str, children: Sequence[Node]) -> None:
        """Take the children, the highest priority first."""
        super().__init__(name, memory=False, children=children)
        self._branch: dict[int, int] = {}
        self._in_vain: set[int] = set()
        for index, child in enumerate(children):
            for node in child.iterate():
                self._branch[id(node)] = index
                if isinstance(node, Behaviour) and node.acts:
                    node.takes_over = (*node.takes_over, self)

    def initialise(self) -> None:
        """Forget who took over in vain."""
        self._in_vain.clear()

    def tick(self) -> Iterator[Node]:
        """Tick the children, the highest priority first."""
        yield from super().tick()
        self._in_vain -= {index for index, child in enumerate(self.children) if child.status is Status.RUNNING}

    def give_way(self, newcomer: Behaviour) -> None:
        """Stop the running child if it is of lower priority than the newcomer's branch."""
        branch = self._branch[id(newcomer)]
        if branch in self._in_vain:
            return
        for child in self.children[branch + 1 :]:
            if child.status is Status.RUNNING:
                child.stop(Status.INVALID)
                self._in_vain.add(branch)


class Guard(Composite):
    """Runs ``do`` while all conditions hold; when one fails, ``do`` is stopped and then ``else`` runs.

    Conditions are ticked in order at every tick, up to the first that does not succeed; a running one counts as not
    yet holding. The outcome is what ``do`` or ``else`` returns; without ``else`` a failed condition is a failure.
    """

    def __init__(self, name: str, conditions: Sequence[Node], do: Node, otherwise: Node | None) -> None:
        """Take the conditions and what to do while they hold and when not."""
        super().__init__(name, [*conditions, do, *([otherwise] if otherwise else [])])
        self._conditions = list(conditions)
        self._do = do
        self._otherwise = otherwise

    def tick(self) -> Iterator[Node]:
        """Check the conditions, then tick one of the two branches."""
        if self.status is not Status.RUNNING:
            self.feedback_message = ""
            self._stop(self.children)
            self.initialise()
        failed = None
        for condition in self._conditions:
            yield from condition.tick()
            if condition.status is not Status.SUCCESS:
                failed = condition
                break
        yield from self._branch(failed)
        status = self.current_child.status if self.current_child else Status.FAILURE
        if status is Status.RUNNING:
            self.status = status
        else:
            self.stop(status)
        yield self

    def _branch(self, failed: Node | None) -> Iterator[Node]:
        if failed is None:
            self.feedback_message = ""
            self._stop([self._otherwise] if self._otherwise else [])
            self.current_child = self._do
            yield from self._do.tick()
            return
        self.feedback_message = f"{failed.name}: {failed.feedback_message}".removesuffix(": ")
        self._stop([self._do, *self._conditions[self._conditions.index(failed) + 1 :]])
        if failed.status is Status.RUNNING:
            self.current_child = failed
        elif self._otherwise is not None:
            self.current_child = self._otherwise
            yield from self._otherwise.tick()
        else:
            self.current_child = failed

    @staticmethod
    def _stop(nodes: Sequence[Node]) -> None:
        for node in nodes:
            if node.status is not Status.INVALID:
                node.stop(Status.INVALID)

    def stop(self, new_status: Status = Status.INVALID) -> None:
        """Stop what still runs."""
        for child in self.children:
            if child.status is Status.RUNNING:
                child.stop(Status.INVALID)
        super().stop(new_status)


class ForEach(Composite):
    """Runs its child for each item of a list, one item after another, as the list was at the start."""

    def __init__(self, name: str, child: Node, items: Binding, item: Variable, until: str) -> None:
        """Set up the loop.

        Args:
            name: Shown to people.
            child: Ticked to its end for each item.
            items: Where the list is read.
            item: Where the child finds its item.
            until: ``success``, ``failure`` or ``all``.
        """
        super().__init__(name, [child])
        self._source = items
        self._item = item
        self._until = until
        self._items: tuple[object, ...] = ()
        self._index = 0

    def tick(self) -> Iterator[Node]:
        """Tick the child for the present item; the next item begins at the next tick."""
        child = self.children[0]
        if self.status is not Status.RUNNING and not self._start():
            yield self
            return
        if child.status is not Status.RUNNING:
            self._item.write(self._items[self._index])
        self.feedback_message = f"{self._index + 1} of {len(self._items)}"
        yield from child.tick()
        outcome = self._outcome(child.status)
        if outcome is Status.RUNNING:
            self.status = outcome
        else:
            self.stop(outcome)
        yield self

    def _start(self) -> bool:
        """Take the list; return whether there is anything to do."""
        child = self.children[0]
        if child.status is not Status.INVALID:
            child.stop(Status.INVALID)
        self._index = 0
        self.current_child = None
        try:
            self._items = tuple(self._source.read())
        except (ZavisError, TypeError) as error:
            self.feedback_message = str(error)
            self.stop(Status.FAILURE)
            return False
        if not self._items:
            self.feedback_message = "nothing to do"
            self.stop(Status.FAILURE if self._until == "success" else Status.SUCCESS)
            return False
        self.current_child = child
        return True

    def _outcome(self, status: Status) -> Status:
        if status is Status.RUNNING or status is Status.INVALID:
            return Status.RUNNING
        if status.name.lower() == self._until:
            return status
        self._index += 1
        if self._index < len(self._items):
            return Status.RUNNING
        return Status.FAILURE if self._until == "success" else Status.SUCCESS

    def stop(self, new_status: Status = Status.INVALID) -> None:
        """Stop the child if it runs, and forget the item."""
        child = self.children[0]
        if child.status is Status.RUNNING:
            child.stop(Status.INVALID)
        super().stop(new_status)
        self._item.clear()


class Recovery(Composite):
    """Tries its first child until it succeeds; the second one runs between attempts, whatever it returns."""

    def __init__(self, name: str, attempt: Node, recover: Node, attempts: int) -> None:
        """Take what to try, what to do between attempts, and how often to try."""
        super().__init__(name, [attempt, recover])
        self._attempts = attempts
        self._failures = 0

    def tick(self) -> Iterator[Node]:
        """Tick the attempt, or the recovery that follows a failed one."""
        attempt, recover = self.children
        if self.status is not Status.RUNNING:
            self._failures = 0
            self.feedback_message = ""
            for child in self.children:
                if child.status is not Status.INVALID:
                    child.stop(Status.INVALID)
            self.current_child = attempt
        if self.current_child is recover:
            yield from recover.tick()
            self.current_child = recover if recover.status is Status.RUNNING else attempt
            self.status = Status.RUNNING
        else:
            yield from attempt.tick()
            self._after(attempt)
        yield self

    def _after(self, attempt: Node) -> None:
        if attempt.status is Status.RUNNING:
            self.status = Status.RUNNING
        elif attempt.status is Status.SUCCESS:
            self.stop(Status.SUCCESS)
        else:
            self._failures += 1
            self.feedback_message = f"{self._failures} of {self._attempts} attempts failed"
            if self._failures < self._attempts:
                self.current_child = self.children[1]
                self.status = Status.RUNNING
            else:
                self.stop(Status.FAILURE)
