"""Requests: what a host sends to a sensor."""

from __future__ import annotations

import re
from dataclasses import dataclass

PARAMETERS = {
    "VV": 0, "PP": 0, "II": 0, "BM": 0, "QT": 0, "RS": 0, "TM": 1, "HS": 1, "CR": 2, "SS": 6, "%ST": 0, "SCIP2.0": 0,
    "GD": 10, "GS": 10, "GE": 10, "MD": 13, "MS": 13, "ME": 13,
}  # fmt: skip
"""Commands and how many characters of parameters they take."""
SCAN_COMMANDS = frozenset(("GD", "GS", "GE", "MD", "MS", "ME"))
"""Commands whose answers carry readings."""
_TEXT_LENGTH = 16
_FIELDS = ((4, "01"), (4, "02"), (2, "03"), (1, "06"), (2, "07"))  # start, end, cluster, skip, count: width, status
_COMMAND = re.compile(r"%[A-Z]{2}|SCIP2\.0|[A-Z]{2}")
_PLAIN = re.compile(r"[ -~]*")


class RequestError(ValueError):
    """A sensor does not accept a request."""

    def __init__(self, status: str) -> None:
        """Refuse with this two-character status."""
        super().__init__(f"status {status}")
        self.status = status


@dataclass(frozen=True, slots=True)
class Request:
    """A line to a sensor."""

    command: str
    parameters: str = ""
    text: str = ""
    """Up to 16 characters that come back with the answer."""

    @property
    def line(self) -> bytes:
        """The request without line feed."""
        return f"{self.command}{self.parameters}{';' + self.text if self.text else ''}".encode("ascii")


def parse_request(line: bytes) -> Request:
    """Return the request of a line without line end.

    Raises:
        RequestError: With the status that a sensor answers (SCIP 2.0: status of bad requests).
    """
    content, _, text = line.decode("latin-1").partition(";")
    if len(text) > _TEXT_LENGTH:
        raise RequestError("0G")
    if not _PLAIN.fullmatch(text):
        raise RequestError("0H")
    found = _COMMAND.match(content)
    if found is None or found[0] not in PARAMETERS:
        raise RequestError("0E")
    command, parameters = found[0], content[found.end() :]
    if len(parameters) != PARAMETERS[command]:
        raise RequestError("0C" if len(parameters) < PARAMETERS[command] else "0D")
    return Request(command, parameters, text)


@dataclass(frozen=True, slots=True)
class ScanRequest:
    """A request for readings."""

    command: str
    """GD, GS or GE for one scan, MD, MS or ME for a stream; S is short ranges, E is with intensities."""
    start: int
    """First step."""
    end: int
    """Last step, included."""
    cluster: int = 1
    """Neighbouring steps of which the smallest reading is sent; 0 is the same as 1."""
    skip: int = 0
    """Scans left out between two of a stream."""
    count: int = 0
    """Scans in a stream; 0 is without end."""
    text: str = ""

    @property
    def streams(self) -> bool:
        """Whether it asks for a stream."""
        return self.command[0] == "M"

    @property
    def digits(self) -> int:
        """Characters of a reading."""
        return 2 if self.command[1] == "S" else 3

    @property
    def paired(self) -> bool:
        """Whether ranges and intensities alternate."""
        return self.command[1] == "E"

    @property
    def beams(self) -> int:
        """Readings of a scan, the last of them perhaps of fewer steps than a whole cluster."""
        return -(-(self.end - self.start + 1) // max(self.cluster, 1))

    @property
    def line(self) -> bytes:
        """The request without line feed."""
        return self.echo(self.count)

    def echo(self, remaining: int) -> bytes:
        """Return the echo of a scan after which ``remaining`` follow."""
        parameters = f"{self.start:04d}{self.end:04d}{self.cluster:02d}"
        if self.streams:
            parameters += f"{self.skip:01d}{remaining:02d}"
        return Request(self.command, parameters, self.text).line

    @classmethod
    def parse(cls, request: Request, last_step: int) -> ScanRequest:
        """Return what a request with one of the `SCAN_COMMANDS` asks for.

        Args:
            request: As `parse_request` returns it.
            last_step: Of the sensor.

        Raises:
            RequestError: A number is none (01 start, 02 end, 03 cluster, 06 skip, 07 count), the end is beyond the last
                step (04) or before the start (05).
        """
        numbers: list[int] = []
        at = 0
        for width, status in _FIELDS if request.command[0] == "M" else _FIELDS[:3]:
            field, at = request.parameters[at : at + width], at + width
            if not (field.isascii() and field.isdigit()):
                raise RequestError(status)
            numbers.append(int(field))
        start, end, cluster, skip, count = (*numbers, 0, 0)[:5]
        if end > last_step:
            raise RequestError("04")
        if end < start:
            raise RequestError("05")
        return cls(request.command, start, end, cluster, skip, count, request.text)
