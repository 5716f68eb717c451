"""Answers: what a sensor sends, found in a stream of bytes that may be damaged."""

from __future__ import annotations

import re
from collections import deque
from dataclasses import dataclass

from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.lines import checksum, seal, unseal, unseal_information
from drivers.lidar.codec.requests import SCAN_COMMANDS
from drivers.lidar.codec.scans import Readings, decode_readings

_END = b"\n\n"
_LIMIT = 1 << 17  # twice the longest answer: 9999 pairs of three characters each
_INFORMATION = frozenset(("VV", "PP", "II"))
_HEAD = re.compile(
    rb"\n?(VV|PP|II|BM|QT|RS|TM|SS|CR|HS|%ST|SCIP2\.0|[GM][DSE])([0-9]{0,13})(?:;[ -~]{0,16})?\n([0-9A-Z]{2})([0-o])\n"
)


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """An answer whose checksums are right."""

    echo: bytes
    """The request it answers; the scans of a stream have the number of those to come in it."""
    status: str
    """Two characters; ``00`` is good, ``99`` comes with the scans of a stream."""
    lines: tuple[bytes, ...] = ()
    """What follows, without check characters; empty for scans."""
    readings: Readings | None = None
    """Of a scan."""


def encode_answer(echo: bytes, status: str, body: bytes = b"") -> bytes:
    """Return a whole answer.

    Args:
        echo: The request, without line feed.
        status: Two characters.
        body: Finished lines, each with check character and line feed.
    """
    return echo + b"\n" + seal(status.encode("ascii")) + b"\n" + body + b"\n"


class AnswerDecoder:
    """Cuts a stream of bytes into answers. What is damaged is counted and left out; the next sound answer is found."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self.answers = 0
        """Answers found since the start."""
        self.broken = 0
        """Answers left out since the start, because a checksum or a length was wrong."""
        self.garbage = 0
        """Bytes left out that belonged to no answer."""

    def feed(self, data: bytes) -> list[Answer]:
        """Return the answers that ``data`` completes."""
        answers = []
        buffer = self._buffer
        begin, search = 0, max(len(buffer) - 1, 0)
        buffer += data
        while (end := buffer.find(_END, search)) >= 0:
            if end > begin:
                answer = self._decode(bytes(buffer[begin : end + 1]))
                if answer is not None:
                    answers.append(answer)
                    self.answers += 1
            begin = search = end + 2
        del buffer[:begin]
        if len(buffer) > _LIMIT:
            self.garbage += len(buffer) - _LIMIT // 2
            del buffer[: -_LIMIT // 2]
        return answers

    def _decode(self, frame: bytes) -> Answer | None:
        """Return the answer in what lies between two empty lines: at its begin, or else the last in it."""
        first = _HEAD.match(frame)
        answer = _answer(first) if first else None
        if answer is not None:
            return answer
        last = deque(_HEAD.finditer(frame, 1), maxlen=1)
        answer = _answer(last[0]) if last else None
        if first or (last and answer is None):
            self.broken += 1
        else:
            self.garbage += last[0].start() if last else len(frame)
        return answer


def _answer(head: re.Match[bytes]) -> Answer | None:
    """Return the answer that begins with this head, or None if anything in it is wrong."""
    status = head[3]
    if checksum(status) != head[4][0]:
        return None
    body = head.string[head.end() :]
    echo, command = head.string[head.start(1) : head.start(3) - 1], head[1].decode("ascii")
    try:
        if command in SCAN_COMMANDS and body:
            return Answer(echo, status.decode("ascii"), readings=decode_readings(command, body))
        content = unseal_information if command in _INFORMATION else unseal  # a semicolon may also be a digit
        lines = tuple(content(line) for line in body.split(b"\n")[:-1])
    except CodecError:
        return None
    return Answer(echo, status.decode("ascii"), lines)
