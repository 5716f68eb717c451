"""Scripted stand-ins for kinds, so that a mission's logic runs without a robot.

```yaml
bt: 1
mocks:
  scan: success                                  # a status
  navigate: {status: failure, reason: blocked, delay: 2.0}
  detect:                                        # one entry for each run; the last one stays
    - {status: failure, reason: nothing seen}
    - {status: success, outputs: {count: 1}}
```
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from py_trees.common import Status

from zavis_bt.errors import did_you_mean
from zavis_bt.protocols import Clock
from zavis_bt.tree.arguments import value_fault
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.document import Element, Items, Scalar, Table, read_document
from zavis_bt.tree.faults import Faults, Mark
from zavis_bt.tree.includes import FORMAT, Library, tree_signature
from zavis_bt.tree.leaves import EPSILON
from zavis_bt.tree.ports import In, Out, Port
from zavis_bt.tree.spec import Signature

STATUSES = {"success": Status.SUCCESS, "failure": Status.FAILURE, "running": Status.RUNNING}
KEYS = ("status", "reason", "delay", "outputs")


@dataclass(frozen=True, slots=True)
class Take:
    """What a mock does in one run."""

    status: Status = Status.SUCCESS
    reason: str = ""
    delay: float = 0.0
    """Time it is running before, on the mission's clock [s]."""
    outputs: Mapping[str, Any] = field(default_factory=dict)


class Mock(Behaviour):
    """Plays a script instead of doing something."""

    script: ClassVar[tuple[Take, ...]] = (Take(),)

    def __init__(self, name: str = "", **inputs: Any) -> None:
        """Start before the first take."""
        super().__init__(name, **inputs)
        self.runs = 0
        """How often it was started."""
        self._clock: Clock | None = None

    def setup(self, *, clock: Clock | None = None) -> None:
        """Take the mission's clock, which only a delay needs."""
        self._clock = clock

    def initialise(self) -> None:
        """Turn to the next take."""
        self._take = self.script[min(self.runs, len(self.script) - 1)]
        self.runs += 1
        self._end = self._now() + self._take.delay

    def update(self) -> Status:
        """Play the take."""
        if self._now() < self._end - EPSILON:
            return self.running(self._take.reason)
        for name, value in self._take.outputs.items():
            setattr(self, name, value)
        self.feedback_message = self._take.reason
        return self._take.status

    def _now(self) -> float:
        return self._clock.now() if self._clock else 0.0


def mock_class(signature: Signature, script: tuple[Take, ...]) -> type[Behaviour]:
    """Return a mock with the ports of a kind."""
    ports: dict[str, In[Any] | Out[Any]] = {}
    for name, port in signature.inputs.items():
        ports[name] = _with_port(In(object, ""), port)
    for name, port in signature.outputs.items():
        ports[name] = _with_port(Out(object, ""), port)
    return type(f"Mock_{signature.kind}", (Mock,), {**ports, "script": script, "__doc__": signature.doc})


def _with_port(member: Any, port: Port) -> Any:
    member.port = port
    return member


def read_mocks(path: Path, library: Library, file_scope: Mapping[str, Any]) -> dict[str, type[Behaviour]]:
    """Return mocks by kind from a file; what is wrong goes to the library's collector.

    Args:
        path: The file.
        library: Kinds.
        file_scope: Trees that may be mocked too, by name.

    Raises:
        InputError: The file cannot be read.
    """
    faults = library.faults
    document = read_document(path, faults)
    if document is None:
        return {}
    table = document.get("mocks") if isinstance(document, Table) else None
    if not isinstance(document, Table) or not isinstance(table, Table) or set(document) != {"bt", "mocks"}:
        faults.add(document.mark, "structure", f"a file of mocks is 'bt: {FORMAT}' and 'mocks', a mapping from kinds")
        return {}
    if document.entries["bt"].plain != FORMAT:
        faults.add(document.entries["bt"].mark, "version", f"the format of mocks is bt: {FORMAT}")
    kinds = {**{name: None for name in library.behaviours}, **file_scope}
    mocks = {}
    for kind, element in table.entries.items():
        if kind not in kinds:
            faults.add(table.keys[kind], "kind", f"unknown kind '{kind}'{did_you_mean(kind, kinds)}")
            continue
        tree = file_scope.get(kind)
        signature = tree_signature(tree) if tree else _behaviour_signature(library, kind)
        mocks[kind] = mock_class(signature, _script(element, signature, faults))
    return mocks


def _behaviour_signature(library: Library, kind: str) -> Signature:
    class_ = library.behaviours[kind]
    return Signature(kind, class_.__doc__ or "", class_.in_ports, class_.out_ports)


def _script(element: Element, signature: Signature, faults: Faults) -> tuple[Take, ...]:
    parts = element.items if isinstance(element, Items) else (element,)
    if not parts:
        faults.add(element.mark, "structure", "a script needs at least one entry")
    return tuple(_take(part, signature, faults) for part in parts)


def _take(element: Element, signature: Signature, faults: Faults) -> Take:
    if isinstance(element, Scalar):
        return Take(_status(element, faults))
    if not isinstance(element, Table):
        faults.add(element.mark, "structure", "a take is a status or a mapping, such as {status: success}")
        return Take()
    for key in element:
        if key not in KEYS:
            faults.add(element.keys[key], "structure", f"unknown key '{key}' in a take{did_you_mean(key, KEYS)}")
    status = element.get("status")
    delay = _checked(element, "delay", Port(float, True, "", None, ge=0.0, unit="s"), faults)
    reason = _checked(element, "reason", Port(str), faults)
    return Take(
        _status(status, faults) if status else Status.SUCCESS,
        reason or "",
        delay or 0.0,
        _outputs(element, signature, faults),
    )


def _status(element: Element, faults: Faults) -> Status:
    text = element.plain
    if isinstance(text, str) and text.lower() in STATUSES:
        return STATUSES[text.lower()]
    faults.add(element.mark, "type", f"{text!r} is no status{did_you_mean(str(text), STATUSES)}")
    return Status.FAILURE


def _checked(table: Table, key: str, port: Port, faults: Faults) -> Any:
    element = table.get(key)
    if element is None:
        return None
    value, found = value_fault(port, key, element)
    if found:
        faults.add(*found)
    return value


def _outputs(table: Table, signature: Signature, faults: Faults) -> dict[str, Any]:
    element = table.get("outputs")
    if element is None:
        return {}
    if not isinstance(element, Table):
        faults.add(element.mark, "structure", "'outputs' is a mapping from output ports to values")
        return {}
    values = {}
    for name in element:
        port = signature.outputs.get(name)
        if port is None:
            near = did_you_mean(name, signature.outputs)
            faults.add(element.keys[name], "argument", f"'{signature.kind}' has no output '{name}'{near}")
        else:
            values[name] = _checked(element, name, port, faults)
    return values


__all__ = ["Mark", "Mock", "Take", "mock_class", "read_mocks"]
