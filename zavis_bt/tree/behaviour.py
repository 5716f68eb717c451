"""Base class of leaf behaviours: typed ports, outcomes with a reason, and a life cycle that holds under faults."""

from __future__ import annotations

import copy
import logging
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import py_trees
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation

from zavis_bt.errors import ZavisError
from zavis_bt.tree.ports import In, Out, Port

log = logging.getLogger(__name__)

_WORD_START = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def kind_name(class_name: str) -> str:
    """Return the name by which trees call a class: ``GoToFrontier`` is ``go_to_frontier``."""
    return _WORD_START.sub("_", class_name).lower()


if TYPE_CHECKING:

    class _Leaf:
        """`BehaviourWithPorts` as subclasses see it, but for ``setup``.

        The base's ``setup(**kwargs)`` would forbid every override that names the resources it takes.
        """

        INPUT_PORTS: dict[str, PortInformation]
        OUTPUT_PORTS: dict[str, PortInformation]
        name: str
        status: Status
        feedback_message: str
        iterator: Iterator[py_trees.behaviour.Behaviour]
        parent: py_trees.behaviour.Behaviour | None
        blackboards: list[py_trees.blackboard.Client]

        def __init__(self, name: str) -> None: ...
        def initialise(self) -> None: ...
        def update(self) -> Status: ...
        def terminate(self, new_status: Status) -> None: ...
        def shutdown(self) -> None: ...
        def tick_once(self) -> None: ...
        def setup_ports(self, port_remappings: dict[str, str], subtree_namespace: str) -> None: ...
else:
    _Leaf = BehaviourWithPorts


class Behaviour(_Leaf):
    """A leaf of the tree.

    Subclasses declare ports with `In` and `Out` and override py_trees' methods: ``setup`` (resources come in by the
    names of its keyword-only parameters), ``initialise``, ``update`` and ``terminate``.

    What it adds to py_trees: ``terminate`` is called exactly once for each ``initialise``, never otherwise; an
    exception in ``initialise`` or ``update`` makes this behaviour fail with the exception as its reason, and one in
    ``terminate`` is logged, so that no fault of one behaviour keeps another from being stopped.
    """

    kind: ClassVar[str] = ""
    """Name in tree files."""
    acts: ClassVar[bool] = False
    """Whether it starts something that must be stopped; true of every class with a ``terminate`` of its own."""
    in_ports: ClassVar[dict[str, Port]] = {}
    out_ports: ClassVar[dict[str, Port]] = {}

    def __init_subclass__(cls, **kwargs: Any) -> None:
        cls.kind = kind_name(cls.__name__)
        if "acts" not in vars(cls):
            cls.acts = cls.terminate is not Behaviour.terminate
        members = {name: value for base in reversed(cls.__mro__) for name, value in vars(base).items()}
        cls.in_ports = {name: member.port for name, member in members.items() if isinstance(member, In)}
        cls.out_ports = {name: member.port for name, member in members.items() if isinstance(member, Out)}
        for name in (cls.in_ports | cls.out_ports).keys() & RESERVED:
            raise TypeError(f"{cls.__name__}: a port cannot be called '{name}', which py_trees uses itself")
        cls.INPUT_PORTS = dict[str, PortInformation](cls.in_ports)
        cls.OUTPUT_PORTS = dict[str, PortInformation](cls.out_ports)
        # Kinds are found through a Registry that is passed around; py_trees' own is one table for the whole process.
        kwargs.setdefault("register", False)
        super().__init_subclass__(**kwargs)

    def __init__(self, name: str = "", **inputs: Any) -> None:
        """Create a behaviour outside of any tree, or for a tree that wires its ports afterwards.

        Args:
            name: Shown to people; the kind if empty.
            inputs: Values of input ports.
        """
        super().__init__(name=name or self.kind)
        defaults = {port: copy.deepcopy(info.default_value) for port, info in self.in_ports.items() if info.optional}
        self.constants: dict[str, Any] = defaults
        self.wires: dict[str, str] = {}
        self.written: dict[str, Any] = {}
        self.takes_over: tuple[TakenOver, ...] = ()
        self.__begun = False
        self.bind(**inputs)

    def bind(self, **inputs: Any) -> None:
        """Give input ports constant values.

        Raises:
            TypeError: There is no such input, or the value has another type.
            ValueError: The value is out of range.
        """
        for name, value in inputs.items():
            if name not in self.in_ports:
                raise TypeError(f"{self.kind} has no input '{name}'")
            try:
                self.constants[name] = self.in_ports[name].check(value)
            except (TypeError, ValueError) as error:
                raise type(error)(f"{self.kind}: '{name}' {error}") from None

    def wire(self, wires: dict[str, str], namespace: str) -> None:
        """Connect ports to absolute blackboard keys, known to py_trees' blackboard under the namespace."""
        self.setup_ports(wires, namespace)
        self.wires.update(wires)
        for name in wires:
            self.constants.pop(name, None)

    def setup(self, *args: Any, **kwargs: Any) -> None:
        """Take resources by name; override with keyword-only parameters, those with a default being optional."""

    def running(self, reason: str = "") -> Status:
        """Return RUNNING, saying what is being done."""
        self.feedback_message = reason
        return Status.RUNNING

    def succeed(self, reason: str = "") -> Status:
        """Return SUCCESS with a reason."""
        self.feedback_message = reason
        return Status.SUCCESS

    def fail(self, reason: str) -> Status:
        """Return FAILURE with a reason."""
        self.feedback_message = reason
        return Status.FAILURE

    @property
    def begun(self) -> bool:
        """Whether it was initialised and not yet terminated."""
        return self.__begun

    def tick(self) -> Iterator[py_trees.behaviour.Behaviour]:
        """Run one tick; see the class for what happens to exceptions."""
        started = self.status is Status.RUNNING
        try:
            if not started:
                self.__begin()
                started = True
            status = self.update()
            if not isinstance(status, Status) or status is Status.INVALID:
                raise TypeError(f"update() returned {status!r}, not RUNNING, SUCCESS or FAILURE")
        except Exception as error:  # containment: whatever a behaviour raises is its own failure, not the tree's end
            status = self.__contain(error)
        if status is not Status.RUNNING:
            self.__end(status, quietly=not started)
        self.status = status
        yield self  # type: ignore[misc]  # it is a py_trees behaviour, see _Leaf

    def stop(self, new_status: Status) -> None:
        """Terminate if begun, and take the status."""
        self.__end(new_status)
        self.status = new_status
        self.iterator = self.tick()

    def get_input(self, port_name: str, default: Any = None) -> Any:
        """Return the value of an input port, as reading its attribute does."""
        return getattr(self, port_name, default)

    def get_last_output(self, port_name: str) -> Any:
        """Return what an output port carries, as reading its attribute does."""
        return getattr(self, port_name)

    def _set_output(self, port_name: str, value: Any) -> None:
        setattr(self, port_name, value)

    def __begin(self) -> None:
        for rival in self.takes_over:
            rival.give_way(self)
        self.feedback_message = ""
        self.__begun = True
        self.initialise()

    def __end(self, status: Status, quietly: bool = False) -> None:
        if not self.__begun:
            return
        self.__begun = False
        try:
            self.terminate(status)
        except Exception:  # containment: what one behaviour cannot stop must not keep the others from being stopped
            level = logging.DEBUG if quietly else logging.ERROR  # after a failed initialise half of it is missing
            log.log(level, "%s: terminate() raised", self.name, exc_info=True)

    def __contain(self, error: Exception) -> Status:
        if isinstance(error, ZavisError):
            return self.fail(str(error))
        log.error("%s raised", self.name, exc_info=error)
        return self.fail(f"{type(error).__name__}: {error}")


class TakenOver:
    """Somebody whose running child has to make room before another behaviour starts."""

    def give_way(self, newcomer: Behaviour) -> None:
        """Stop what runs and is of lower priority than the newcomer."""


RESERVED = frozenset(name for name in dir(Behaviour) if not name.startswith("_")) | {
    *("name", "id", "status", "children", "parent", "logger", "iterator", "feedback_message", "blackboards"),
    *("blackbox_level", "qualified_name", "constants", "wires", "written", "takes_over"),
}
"""Names that a port must not take."""
