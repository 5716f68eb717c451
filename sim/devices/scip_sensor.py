"""The firmware of a simulated LiDAR: requests in, answers and streams out."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from drivers.lidar.codec import (
    CLOCK_DIGITS,
    CLOCK_SPAN,
    SCAN_COMMANDS,
    Parameters,
    Request,
    RequestError,
    ScanRequest,
    encode_answer,
    encode_information,
    encode_number,
    encode_readings,
    parse_request,
    seal,
)
from sim.devices.scip_eye import Eye, chosen

_LONGEST = 128  # characters of a line, beyond which it cannot be a request
_FIRMWARE = {
    "VEND": "Simulated by zavis",
    "PROD": "SOKUIKI Sensor",
    "FIRM": "1.0.0(simulated)",
    "PROT": "SCIP 2.0",
    "SERI": "H0000001",
}
_DEFAULT_SPEED, _SLOWEST, _RESET_SPEED = 0, 10, 99  # of CR; each level takes 1 % of the speed
_STANDBY, _TIME, _MEASURING, _STREAMING = b"000", b"002", b"003", b"004"


@dataclass(slots=True)
class _Stream:
    request: ScanRequest
    turn: int
    """Whose scan is sent next."""
    laser_before: bool
    sent: int = 0


class Sensor:
    """A sensor that is always in SCIP 2.0. Not to be used by several threads at once."""

    def __init__(self, parameters: Parameters, eye: Eye, clock: Callable[[], float], uptime: float = 0.0) -> None:
        """Switch it on.

        Args:
            parameters: Of its kind.
            eye: What it sees, with times of the same clock.
            clock: Real time [s].
            uptime: How long it has been on [s].
        """
        self._parameters, self._eye, self._clock = parameters, eye, clock
        self._zero = clock() - uptime
        self._rotor = self._zero  # when turn 0 began
        self._line = bytearray()
        self._reset()

    def _reset(self) -> None:
        self._laser = self._sensitive = self._timing = False
        self._speed = _DEFAULT_SPEED
        self._stream: _Stream | None = None

    def hang_up(self) -> None:
        """Stop the stream and leave the time mode: the host has gone."""
        self._stream, self._laser, self._timing = None, False, False
        self._line.clear()

    def hear(self, data: bytes) -> bytes:
        """Return the answers to the requests that ``data`` completes; lines end with LF or CR."""
        answers = b""
        self._line += data.replace(b"\r", b"\n")
        *lines, rest = self._line.split(b"\n")
        self._line = rest
        for line in lines:
            if line:
                answers += self._answer(bytes(line[:_LONGEST]))
        if len(self._line) > _LONGEST:
            del self._line[_LONGEST:]
        return answers

    @property
    def due(self) -> float | None:
        """When the next scan of a stream is to be sent, by the clock [s]; None without stream."""
        return None if self._stream is None else self._rotor + self._stream.turn * self._period

    def scan(self, *, send: bool = True) -> bytes:
        """Return the scan of a stream that is due, and go on to the next; without ``send`` it is left out."""
        stream = self._stream
        if stream is None:
            return b""
        request, turn = stream.request, self._turn()
        stream.turn = max(stream.turn, turn) + request.skip + 1
        if not send:
            return b""
        stream.sent += 1
        if stream.sent == request.count:
            self._stream, self._laser = None, stream.laser_before
        remaining = request.count - stream.sent if request.count else 0
        return encode_answer(request.echo(remaining), "99", self._readings(request, turn))

    @property
    def _period(self) -> float:
        return 60 / self._parameters.scan / (1 - self._speed / 100)

    def _turn(self) -> int:
        return math.floor((self._clock() - self._rotor) / self._period + 1e-6)

    def _milliseconds(self, time: float) -> int:
        return int((time - self._zero) * 1000) % CLOCK_SPAN

    def _readings(self, request: ScanRequest, turn: int) -> bytes:
        sweep = self._eye.sweep(turn)
        values = chosen(sweep, request, self._parameters.amin)
        return encode_readings(self._milliseconds(sweep.time), values, request.digits)

    def _answer(self, line: bytes) -> bytes:
        try:
            request = parse_request(line)
            status, body = self._obey(request)
        except RequestError as error:
            status, body = error.status, b""
        return encode_answer(line, status, body)

    def _obey(self, request: Request) -> tuple[str, bytes]:
        """Return status and lines.

        Raises:
            RequestError: With the status.
        """
        if request.command in SCAN_COMMANDS:
            scan = ScanRequest.parse(request, self._parameters.amax)
            return self._begin(scan) if scan.streams else self._measure(scan)
        match request.command:
            case "VV":
                return "00", encode_information(_FIRMWARE)
            case "PP":
                return "00", encode_information(self._parameters.information)
            case "II":
                return "00", encode_information(self._state())
            case "BM":
                return self._light(), b""
            case "QT":
                self._stream, self._laser = None, False
                return "00", b""
            case "RS":
                self._reset()
                return "00", b""
            case "TM":
                return self._time_mode(request.parameters)
            case "HS":
                return self._sensitivity(request.parameters), b""
            case "CR":
                return self._motor(request.parameters), b""
            case "%ST":
                return "00", seal(self._mode()) + b"\n"
            case "SS":
                return "0F", b""  # there is no serial line
            case _:  # SCIP2.0
                return "0E", b""

    def _begin(self, request: ScanRequest) -> tuple[str, bytes]:
        if self._timing:
            return "10", b""
        self._rotor += (self._eye.fresh - self._rotor) % self._period
        self._stream = _Stream(request, self._turn() + 1, self._laser)
        self._laser = True
        return "00", b""

    def _measure(self, request: ScanRequest) -> tuple[str, bytes]:
        return ("00", self._readings(request, self._turn())) if self._laser else ("10", b"")

    def _light(self) -> str:
        if self._timing:
            return "01"
        was_on, self._laser = self._laser, True
        return "02" if was_on else "00"

    def _time_mode(self, code: str) -> tuple[str, bytes]:
        match code:
            case "0" if self._timing:
                return "02", b""
            case "0" if self._laser:
                return "10", b""
            case "0":
                self._timing = True
            case "1" if not self._timing:
                return "04", b""
            case "1":
                return "00", seal(encode_number(self._milliseconds(self._clock()), CLOCK_DIGITS)) + b"\n"
            case "2" if not self._timing:
                return "03", b""
            case "2":
                self._timing = False
            case _:
                return "01", b""
        return "00", b""

    def _sensitivity(self, code: str) -> str:
        if code not in ("0", "1"):
            return "01"
        before, self._sensitive = self._sensitive, code == "1"
        return "02" if before == self._sensitive else "00"

    def _motor(self, code: str) -> str:
        if not (code.isascii() and code.isdigit()):
            return "01"
        level = _DEFAULT_SPEED if int(code) == _RESET_SPEED else int(code)
        if level > _SLOWEST:
            return "01"
        if level == self._speed:
            return "02"
        self._speed = level
        if self._stream is not None:
            self._stream.turn = self._turn() + 1
        return "00"

    def _mode(self) -> bytes:
        if self._timing:
            return _TIME
        if self._stream is not None:
            return _STREAMING
        return _MEASURING if self._laser else _STANDBY

    def _state(self) -> dict[str, object]:
        return {
            "MODL": self._parameters.model,
            "LASR": "ON" if self._laser else "OFF",
            "SCSP": f"{60 / self._period:.0f}[rpm]",
            "MESM": "high sensitivity" if self._sensitive else "normal",
            "SBPS": "Ethernet",
            "TIME": f"{self._milliseconds(self._clock()):06X}",
            "STAT": "works well",
        }
