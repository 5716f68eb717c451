"""Process data of a drive: unpacked into its dictionary and packed from it by the maps in the dictionary."""

from __future__ import annotations

import contextlib
from typing import Any, NamedTuple

from drivers.pan_tilt.objects import (
    CONTROLWORD,
    PDO_OFF,
    RPDO_MAPPING,
    RPDO_PARAMETER,
    TPDO_MAPPING,
    TPDO_PARAMETER,
)

_COUNT = 4
_LAST_DUMMY = 7  # indices up to here stand for unused bits of a basic type
_SYNCHRONOUS = 240
_BAD_MAPPING, _TOO_LONG, _STATE = 0x0604_0041, 0x0604_0042, 0x0800_0022


class _Pdo(NamedTuple):
    identifier: int
    kind: int
    """Transmission type."""
    objects: tuple[tuple[int, int, int], ...]
    """Index, sub-index, bytes."""
    inhibit: float = 0.0
    """[s]"""
    event: float = 0.0
    """Period of sending without a change [s]; 0 for never."""


class ProcessData:
    """The PDOs of one node. Times are seconds on a clock of the caller's."""

    def __init__(self, node: Any) -> None:
        """Work for a ``canopen.LocalNode``, which keeps the maps."""
        self._node = node
        self.reset()

    def reset(self) -> None:
        """Forget what was received and sent, and read the maps anew."""
        self._received: dict[int, _Pdo] | None = None
        self._transmitted: list[_Pdo] = []
        self._waiting: dict[int, bytes] = {}
        self._sent: dict[int, tuple[float, bytes]] = {}
        self._syncs = 0

    def check_write(self, index: int, sub: int, data: bytes) -> None:
        """Refuse a wrong change of a map, and note a right one.

        Raises:
            canopen.SdoAbortedError: An object cannot be mapped, or a map is longer than a frame.
        """
        if not RPDO_PARAMETER <= index < TPDO_MAPPING + _COUNT:
            return
        self._received = None
        if index in range(RPDO_MAPPING, RPDO_MAPPING + _COUNT) or index >= TPDO_MAPPING:
            _check_mapping(self._node, index, sub, int.from_bytes(data, "little"))

    def receive(self, identifier: int, data: bytes) -> None:
        """Take a frame: at once, or with the next SYNC if the PDO is synchronous; too short ones are dropped."""
        pdo = self._maps().get(identifier)
        if pdo is None or len(data) < sum(size for _, _, size in pdo.objects):
            return
        if pdo.kind <= _SYNCHRONOUS:
            self._waiting[identifier] = data
        else:
            self._unpack(pdo, data)

    def apply_waiting(self) -> None:
        """Unpack what has waited for SYNC."""
        waiting, self._waiting = self._waiting, {}
        for identifier, data in waiting.items():
            pdo = self._maps().get(identifier)
            if pdo is not None:
                self._unpack(pdo, data)

    def due_on_sync(self) -> list[tuple[int, bytes]]:
        """Return identifiers and data of the frames that answer a SYNC."""
        self._maps()
        self._syncs += 1
        due = []
        for pdo in self._transmitted:
            data = self._pack(pdo)
            on_change = pdo.kind == 0 and self._sent.get(pdo.identifier, (0.0, b""))[1] != data
            if on_change or (0 < pdo.kind <= _SYNCHRONOUS and self._syncs % pdo.kind == 0):
                self._sent[pdo.identifier] = 0.0, data
                due.append((pdo.identifier, data))
        return due

    def due_by_event(self, now: float) -> list[tuple[int, bytes]]:
        """Return identifiers and data of the frames that are sent for a change or for their event timer."""
        self._maps()
        due = []
        for pdo in self._transmitted:
            if pdo.kind <= _SYNCHRONOUS:
                continue
            then, before = self._sent.get(pdo.identifier, (-1e9, b""))
            data = self._pack(pdo)
            late = 0 < pdo.event <= now - then
            if late or (data != before and now - then >= pdo.inhibit):
                self._sent[pdo.identifier] = now, data
                due.append((pdo.identifier, data))
        return due

    def _maps(self) -> dict[int, _Pdo]:
        if self._received is None:
            received = [self._read(RPDO_PARAMETER + n, RPDO_MAPPING + n, sends=False) for n in range(_COUNT)]
            transmitted = [self._read(TPDO_PARAMETER + n, TPDO_MAPPING + n, sends=True) for n in range(_COUNT)]
            self._received = {pdo.identifier: pdo for pdo in received if pdo is not None}
            self._transmitted = [pdo for pdo in transmitted if pdo is not None]
        return self._received

    def _read(self, parameter: int, mapping: int, *, sends: bool) -> _Pdo | None:
        identifier = self._number(parameter, 1)
        count = self._number(mapping, 0)
        if identifier & PDO_OFF or count == 0:
            return None
        words = [self._number(mapping, sub) for sub in range(1, count + 1)]
        objects = tuple((word >> 16, word >> 8 & 0xFF, (word & 0xFF) // 8) for word in words)
        kind = self._number(parameter, 2)
        if not sends:
            return _Pdo(identifier & 0x7FF, kind, objects)
        inhibit, event = self._number(parameter, 3) * 1e-4, self._number(parameter, 5) * 1e-3
        return _Pdo(identifier & 0x7FF, kind, objects, inhibit, event)

    def _number(self, index: int, sub: int) -> int:
        return int.from_bytes(self._node.get_data(index, sub), "little")

    def _pack(self, pdo: _Pdo) -> bytes:
        return b"".join(bytes(self._node.get_data(index, sub)) for index, sub, _ in pdo.objects)

    def _unpack(self, pdo: _Pdo, data: bytes) -> None:
        from canopen import SdoAbortedError

        values, place = [], 0
        for index, sub, size in pdo.objects:
            values.append((index, sub, bytes(data[place : place + size])))
            place += size
        # The controlword comes last: it tells what to do with the set-points beside it.
        for index, sub, value in sorted(values, key=lambda entry: entry[0] == CONTROLWORD):
            # What the drive refuses changes nothing, as nobody can be told.
            with contextlib.suppress(SdoAbortedError):
                if index > _LAST_DUMMY:
                    self._node.set_data(index, sub, value)


def _check_mapping(node: Any, index: int, sub: int, value: int) -> None:
    from canopen import SdoAbortedError

    if sub > 0:
        if int.from_bytes(node.get_data(index, 0), "little"):
            raise SdoAbortedError(_STATE)
        if value and not _can_be_mapped(node, value, received=index < TPDO_PARAMETER):
            raise SdoAbortedError(_BAD_MAPPING)
        return
    if value > 8:
        raise SdoAbortedError(_TOO_LONG)
    words = [int.from_bytes(node.get_data(index, number), "little") for number in range(1, value + 1)]
    if not all(words):
        raise SdoAbortedError(_BAD_MAPPING)
    if sum(word & 0xFF for word in words) > 64:
        raise SdoAbortedError(_TOO_LONG)


def _can_be_mapped(node: Any, word: int, *, received: bool) -> bool:
    index, sub, bits = word >> 16, word >> 8 & 0xFF, word & 0xFF
    if index <= _LAST_DUMMY:
        return received and bits in (8, 16, 32)
    variable = node.object_dictionary.get_variable(index, sub)
    if variable is None or not variable.pdo_mappable or len(variable) != bits:
        return False
    return bool(variable.writable if received else variable.readable)
