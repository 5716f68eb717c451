"""How fast SCIP 2.0 is decoded and encoded: `python -m benchmarks.scip`. One core, all checksums verified."""

from __future__ import annotations

import numpy as np

from benchmarks.timing import machine, take_turns, verdict
from drivers.lidar.codec import AnswerDecoder, ScanRequest, encode_answer, encode_readings

BEAMS = 1081
SCANS = 500
ROUNDS = 9
CHUNK = 4096  # what a read from the line returns at most
TARGET = 5_000  # scans of 1081 beams a second


def stream(command: str) -> bytes:
    """SCANS answers of a sensor with 1081 beams, one after the other."""
    request, rng = ScanRequest(command, 0, BEAMS - 1), np.random.default_rng(0)
    values = BEAMS * (2 if request.paired else 1)
    top = 4096 if request.digits == 2 else 30_000
    return b"".join(
        encode_answer(
            request.line,
            "99",
            encode_readings(25 * i, rng.integers(20, top, values, dtype=np.int32), request.digits),
        )
        for i in range(SCANS)
    )


def decode(data: bytes) -> None:
    decoder = AnswerDecoder()
    scans = [answer for at in range(0, len(data), CHUNK) for answer in decoder.feed(data[at : at + CHUNK])]
    assert len(scans) == SCANS
    assert decoder.broken == 0
    assert scans[-1].readings is not None
    assert len(scans[-1].readings.ranges) == BEAMS


def encode() -> None:
    request, values = ScanRequest("MD", 0, BEAMS - 1), np.full(BEAMS, 12_345, dtype=np.int32)
    for i in range(SCANS):
        encode_answer(request.line, "99", encode_readings(i, values, 3))


def main() -> None:
    streams = {command: stream(command) for command in ("MD", "MS", "ME")}
    calls = {command: lambda data=data: decode(data) for command, data in streams.items()}
    spent = take_turns({**calls, "encode": encode}, ROUNDS, SCANS)
    print(f"scans of {BEAMS} beams a second of CPU time, medians of {ROUNDS} turns; {machine()}")
    for name, seconds in spent.items():
        size = len(streams[name]) / SCANS if name in streams else len(streams["MD"]) / SCANS
        label = f"decode {name}" if name in streams else "encode MD"
        print(f"{label}  {1 / seconds:9,.0f} scans/s  {seconds * 1e6:6.1f} µs  {size / seconds / 1e6:6.1f} MB/s")
    print(f"target, at least {TARGET:,} scans a second decoded: {verdict(1 / spent['MD'] >= TARGET)}")


if __name__ == "__main__":
    main()
