"""Identifiers, objects and bits of CANopen (CiA 301) and of its profile for drives (CiA 402)."""

from __future__ import annotations

from enum import IntEnum

NMT = 0x000
SYNC = 0x080
EMCY = 0x080  # + node, as all below
TPDO1, TPDO2 = 0x180, 0x280
RPDO1 = 0x200
SDO_ANSWER, SDO_REQUEST = 0x580, 0x600
HEARTBEAT = 0x700

NMT_START, NMT_STOP, NMT_PRE_OPERATIONAL, NMT_RESET_NODE, NMT_RESET_COMMUNICATION = 0x01, 0x02, 0x80, 0x81, 0x82
BOOT_UP, STOPPED, OPERATIONAL, PRE_OPERATIONAL = 0x00, 0x04, 0x05, 0x7F

DEVICE_TYPE, ERROR_REGISTER, ERROR_HISTORY, DEVICE_NAME, SOFTWARE_VERSION = 0x1000, 0x1001, 0x1003, 0x1008, 0x100A
CONSUMER_HEARTBEAT, PRODUCER_HEARTBEAT, IDENTITY = 0x1016, 0x1017, 0x1018
RPDO_PARAMETER, RPDO_MAPPING, TPDO_PARAMETER, TPDO_MAPPING = 0x1400, 0x1600, 0x1800, 0x1A00
PDO_OFF = 1 << 31
"""Bit of a PDO's identifier that switches it off."""

ERROR_CODE, CONTROLWORD, STATUSWORD, QUICK_STOP_OPTION = 0x603F, 0x6040, 0x6041, 0x605A
MODE, MODE_DISPLAY, SUPPORTED_MODES = 0x6060, 0x6061, 0x6502
POSITION, VELOCITY, TARGET_POSITION, TARGET_VELOCITY = 0x6064, 0x606C, 0x607A, 0x60FF
HOME_OFFSET, POSITION_LIMITS, MAX_VELOCITY, MAX_ACCELERATION = 0x607C, 0x607D, 0x607F, 0x60C5
PROFILE_VELOCITY, ACCELERATION, DECELERATION, QUICK_STOP_DECELERATION = 0x6081, 0x6083, 0x6084, 0x6085
HOMING_METHOD, HOMING_SPEEDS, HOMING_ACCELERATION, CYCLE_TIME = 0x6098, 0x6099, 0x609A, 0x60C2

SERVO_DRIVE = 0x0002_0192
"""Device type: profile 402, servo drive."""
PROFILE = 402


class Mode(IntEnum):
    """Modes of operation (6060); ``1 << (mode - 1)`` is a mode's bit in 6502."""

    PROFILE_POSITION = 1
    PROFILE_VELOCITY = 3
    HOMING = 6
    CYCLIC_POSITION = 8
    CYCLIC_VELOCITY = 9

    @property
    def bit(self) -> int:
        """Its bit in the supported modes."""
        return int(1 << (self - 1))


NEW_SET_POINT, AT_ONCE, RELATIVE, FAULT_RESET, HALT = 0x10, 0x20, 0x40, 0x80, 0x100
"""Bits of the controlword; HOMING_START is the new set-point's."""
HOMING_START = NEW_SET_POINT

VOLTAGE, WARNING, REMOTE, TARGET_REACHED, LIMIT_ACTIVE = 0x10, 0x80, 0x200, 0x400, 0x800
"""Bits of the statusword."""
ACKNOWLEDGED, MODE_ERROR = 0x1000, 0x2000
"""Bits of the statusword with a meaning of each mode: set-point acknowledged, homing attained, speed zero, following
the set-points; following or homing error."""


def mapping(index: int, sub: int, bits: int) -> int:
    """Return the word that maps an object into a PDO."""
    return index << 16 | sub << 8 | bits
