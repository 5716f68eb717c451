"""What drives' error codes mean (CiA 301 and 402), and what helps."""

from __future__ import annotations

_EXACT = {
    0x3210: "over-voltage (is the supply right, does braking feed energy back?)",
    0x3220: "under-voltage (is the supply strong enough?)",
    0x4210: "drive too hot (let it cool down)",
    0x4310: "drive too hot (let it cool down)",
    0x7320: "position sensor (is the encoder's cable plugged in?)",
    0x7305: "position sensor (is the encoder's cable plugged in?)",
    0x8110: "CAN overrun, frames were lost (is the bus overloaded?)",
    0x8120: "CAN error passive (are both ends of the bus terminated?)",
    0x8130: "lost this computer's heartbeat (is the bus cable plugged in, the computer overloaded?)",
    0x8140: "recovered from bus off (are both ends of the bus terminated?)",
    0x8210: "a PDO was too short",
    0x8611: "following error (is the axis blocked or overloaded?)",
    0x8612: "position limit exceeded (turn the axis back into its range)",
}
_FAMILIES = (
    (0x2000, 0xF000, "over-current (is the axis blocked or the motor cable damaged?)"),
    (0x3000, 0xF000, "voltage out of range (check the supply)"),
    (0x4000, 0xF000, "temperature out of range (let it cool down)"),
    (0x5000, 0xF000, "drive hardware"),
    (0x6000, 0xF000, "drive software"),
    (0x7000, 0xF000, "attached module: motor, brake or sensor"),
    (0x8100, 0xFF00, "communication"),
    (0x8200, 0xFF00, "protocol"),
    (0x8000, 0xF000, "monitoring"),
    (0x9000, 0xFF00, "external error (is an input for it switched on?)"),
    (0xF000, 0xFF00, "additional function"),
    (0xFF00, 0xFF00, "maker's own error (see its manual)"),
    (0x1000, 0xFF00, "generic error"),
)


def describe(code: int) -> str:
    """Return an error code in words, with the code: ``8611 following error (…)``."""
    text = _EXACT.get(code)
    if text is None:
        text = next((words for value, mask, words in _FAMILIES if code & mask == value), "unknown error")
    return f"{code:04X} {text}"


def clears(code: int) -> bool:
    """Return whether an emergency message says that errors have gone."""
    return code & 0xFF00 == 0
