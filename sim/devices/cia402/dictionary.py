"""The drives' object dictionary, and the electronic data sheet that describes it to foreign masters."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from drivers.pan_tilt.objects import PDO_OFF, RPDO1, SERVO_DRIVE, TPDO1, Mode, mapping

_I8, _I16, _I32, _U8, _U16, _U32, _TEXT = 2, 3, 4, 5, 6, 7, 9  # data types of CiA 301
_MODES = sum(mode.bit for mode in Mode)
_NONE = 0xFFFF_FFFF


@dataclass(frozen=True)
class _Entry:
    index: int
    name: str
    kind: int
    default: int | str = 0
    access: str = "rw"
    mapped: bool = False


@dataclass(frozen=True)
class _Record:
    index: int
    name: str
    entries: tuple[tuple[str, int, int, str], ...]
    """Name, type, default, access; sub-index 1 and up."""
    array: bool = False
    count_access: str = "ro"
    count: int | None = None


def object_dictionary(node: int, *, units_per_degree: float = 1000.0, limits: tuple[int, int] = (0, 0)) -> Any:
    """Return a new dictionary of a drive, a ``canopen.ObjectDictionary``.

    Args:
        node: The drive's node number.
        units_per_degree: The drive's unit of angles; speeds are a second, accelerations a second squared.
        limits: Software position limits as the maker has set them [units]; none if both are 0.
    """
    from canopen import ObjectDictionary

    dictionary = cast(Any, ObjectDictionary)()  # canopen gives its constructor no types
    dictionary.node_id = node
    information = dictionary.device_information
    information.vendor_name, information.product_name = "zavis", "Simulated pan-tilt drive"
    information.vendor_number, information.product_number, information.revision_number = 0, 1, 1
    information.allowed_baudrates = {125e3, 250e3, 500e3, 1000e3}
    information.nr_of_RXPDO = information.nr_of_TXPDO = 4
    for entry in _entries(node, units_per_degree):
        dictionary.add_object(_variable(entry))
    for record in (*_records(node, units_per_degree, limits), *_pdos(node)):
        dictionary.add_object(_group(record))
    return dictionary


def export_eds(path: Path, units_per_degree: float = 1000.0) -> None:
    """Write the electronic data sheet of the drives; identifiers in it are relative to the node number."""
    from canopen import export_od

    dictionary = object_dictionary(0, units_per_degree=units_per_degree)
    for variable in (dictionary[0x1014], *(dictionary[first + n][1] for first in (0x1400, 0x1800) for n in range(4))):
        variable.default_raw = f"$NODEID+0x{variable.default:X}"
    dictionary[0x60C2][2].default_raw = str(dictionary[0x60C2][2].default)  # canopen writes -3 as 0x-3
    with warnings.catch_warnings(), path.open("w", encoding="utf-8") as file:
        warnings.simplefilter("ignore", DeprecationWarning)  # canopen asks for the date in a way newer Pythons dislike
        export_od(dictionary, file, "eds")


def _entries(node: int, per_degree: float) -> tuple[_Entry, ...]:
    def degrees(value: float) -> int:
        return round(value * per_degree)

    return (
        _Entry(0x1000, "Device type", _U32, SERVO_DRIVE, "ro"),
        _Entry(0x1001, "Error register", _U8, 0, "ro", True),
        _Entry(0x1005, "COB-ID SYNC message", _U32, 0x80),
        _Entry(0x1008, "Manufacturer device name", _TEXT, "Simulated pan-tilt drive", "const"),
        _Entry(0x100A, "Manufacturer software version", _TEXT, "1.0", "const"),
        _Entry(0x1014, "COB-ID EMCY", _U32, 0x80 + node, "ro"),
        _Entry(0x1017, "Producer heartbeat time", _U16, 500),
        _Entry(0x603F, "Error code", _U16, 0, "ro", True),
        _Entry(0x6040, "Controlword", _U16, 0, "rw", True),
        _Entry(0x6041, "Statusword", _U16, 0, "ro", True),
        _Entry(0x605A, "Quick stop option code", _I16, 2),
        _Entry(0x6060, "Modes of operation", _I8, 0, "rw", True),
        _Entry(0x6061, "Modes of operation display", _I8, 0, "ro", True),
        _Entry(0x6064, "Position actual value", _I32, 0, "ro", True),
        _Entry(0x606C, "Velocity actual value", _I32, 0, "ro", True),
        _Entry(0x607A, "Target position", _I32, 0, "rw", True),
        _Entry(0x607C, "Home offset", _I32, 0),
        _Entry(0x607F, "Max profile velocity", _U32, degrees(180), "rw", True),
        _Entry(0x6081, "Profile velocity", _U32, degrees(45), "rw", True),
        _Entry(0x6083, "Profile acceleration", _U32, degrees(180), "rw", True),
        _Entry(0x6084, "Profile deceleration", _U32, degrees(180), "rw", True),
        _Entry(0x6085, "Quick stop deceleration", _U32, degrees(720), "rw", True),
        _Entry(0x6098, "Homing method", _I8, 37),
        _Entry(0x609A, "Homing acceleration", _U32, degrees(90)),
        _Entry(0x60C5, "Max acceleration", _U32, degrees(4000), "rw", True),
        _Entry(0x60FF, "Target velocity", _I32, 0, "rw", True),
        _Entry(0x6502, "Supported drive modes", _U32, _MODES, "ro"),
    )


def _records(node: int, per_degree: float, limits: tuple[int, int]) -> tuple[_Record, ...]:
    errors = tuple((f"Standard error field {number}", _U32, 0, "ro") for number in range(1, 9))
    watched = tuple((f"Consumer heartbeat time {number}", _U32, 0, "rw") for number in range(1, 5))
    identity = (("Vendor-ID", 0), ("Product code", 1), ("Revision number", 0x0001_0000), ("Serial number", node))
    return (
        _Record(0x1003, "Pre-defined error field", errors, True, "rw", 0),
        _Record(0x1016, "Consumer heartbeat time", watched, True),
        _Record(0x1018, "Identity object", tuple((name, _U32, value, "ro") for name, value in identity)),
        _Record(
            0x607D,
            "Software position limit",
            (("Min position limit", _I32, limits[0], "rw"), ("Max position limit", _I32, limits[1], "rw")),
            True,
        ),
        _Record(
            0x6099,
            "Homing speeds",
            (
                ("Speed during search for switch", _U32, round(30 * per_degree), "rw"),
                ("Speed during search for zero", _U32, round(3 * per_degree), "rw"),
            ),
            True,
        ),
        _Record(
            0x60C2,
            "Interpolation time period",
            (("Interpolation time period value", _U8, 20, "rw"), ("Interpolation time index", _I8, -3, "rw")),
        ),
    )


_RECEIVED = (
    ((0x6040, 16), (0x607A, 32)),
    ((0x60FF, 32), (0x6060, 8)),
    (),
    (),
)
_TRANSMITTED = (
    ((0x6041, 16), (0x6064, 32)),
    ((0x606C, 32), (0x6061, 8)),
    (),
    (),
)


def _pdos(node: int) -> list[_Record]:
    """Return parameters and mappings of four PDOs a way; the last two are off at first."""
    records = []
    for number, (received, transmitted) in enumerate(zip(_RECEIVED, _TRANSMITTED, strict=True)):
        taken = RPDO1 + number * 0x100 + node | (0 if received else PDO_OFF)
        sent = TPDO1 + number * 0x100 + node | (0 if transmitted else PDO_OFF)
        kinds = ("COB-ID", _U32), ("Transmission type", _U8)
        timing = (
            ("Inhibit time", _U16, 0, "rw"),
            ("Compatibility entry", _U8, 0, "rw"),
            ("Event timer", _U16, 0, "rw"),
        )
        values = [
            [(name, kind, value, "rw") for (name, kind), value in zip(kinds, numbers, strict=True)]
            for numbers in ((taken, 255), (sent, 1))
        ]
        records += [
            _Record(0x1400 + number, f"RPDO {number + 1} communication parameter", tuple(values[0])),
            _Record(0x1800 + number, f"TPDO {number + 1} communication parameter", (*values[1], *timing)),
            _mapping(0x1600 + number, f"RPDO {number + 1} mapping parameter", received),
            _mapping(0x1A00 + number, f"TPDO {number + 1} mapping parameter", transmitted),
        ]
    return records


def _mapping(index: int, name: str, objects: tuple[tuple[int, int], ...]) -> _Record:
    words = [mapping(target, 0, bits) for target, bits in objects]
    words += [0] * (8 - len(words))
    entries = tuple((f"Mapped object {number}", _U32, word, "rw") for number, word in enumerate(words, 1))
    return _Record(index, name, entries, count_access="rw", count=len(objects))


def _variable(entry: _Entry, sub: int = 0) -> Any:
    from canopen.objectdictionary import ODVariable

    variable: Any = ODVariable(entry.name, entry.index, sub)
    variable.data_type, variable.access_type = entry.kind, entry.access
    variable.default, variable.pdo_mappable = entry.default, entry.mapped
    return variable


def _group(record: _Record) -> Any:
    from canopen.objectdictionary import ODArray, ODRecord

    group = (ODArray if record.array else ODRecord)(record.name, record.index)
    count = len(record.entries) if record.count is None else record.count
    number = _Entry(record.index, "Number of entries", _U8, count, record.count_access)
    group.add_member(_variable(number))
    for sub, (name, kind, default, access) in enumerate(record.entries, 1):
        group.add_member(_variable(_Entry(record.index, name, kind, default, access), sub))
    return group
