"""Random and mutated bytes into every decoder at a line: `python -m benchmarks.fuzz`.

Each decoder gets a million bytes in pieces of any length: noise, sound packets with bits flipped, bytes lost, doubled
or inserted, packets cut off and spliced, and nonsense inside sound frames, so that what lies behind the checksum is
reached too. Every now and then the line is good again; then packets are sent until one is decoded. A decoder passes if
nothing it is not allowed to raise escapes, if it needs no more than two packets to find one, and if it holds as little
memory at the end as it did half way. Frames on the CAN bus go to the pan-tilt driver and to the simulated drives while
both are at work; they must be able to move again when it is over.
"""

from __future__ import annotations

import argparse
import gc
import itertools
import sys
import time
import tracemalloc
import zlib
from collections.abc import Callable

import numpy as np

from benchmarks.fuzz_can import fuzz_can
from benchmarks.fuzz_decoders import SUBJECTS, Subject
from benchmarks.fuzz_result import Result
from benchmarks.timing import machine, verdict

BYTES = 1_000_000


def garbage(subject: Subject, rng: np.random.Generator) -> bytes:
    """Return some bytes of one kind of damage."""
    kind = rng.integers(6)
    if kind == 0:
        return rng.bytes(int(rng.integers(1, 300)))
    if kind == 1:
        return subject.framed(rng.bytes(int(rng.integers(0, 190))))
    packets = bytearray(b"".join(subject.sound(rng) for _ in range(rng.integers(1, 4))))
    if kind == 2:
        for at in rng.integers(0, len(packets), rng.integers(1, 10)):
            packets[at] ^= 1 << int(rng.integers(8))
    elif kind == 3:
        begin, end = sorted(rng.integers(0, len(packets), 2))
        del packets[begin:end]
    elif kind == 4:
        at = int(rng.integers(0, len(packets)))
        packets[at:at] = rng.bytes(int(rng.integers(1, 20))) if rng.integers(2) else packets[at : at + 30]
    else:
        del packets[int(rng.integers(0, len(packets))) :]
    return bytes(packets)


def feed(subject: Subject, data: bytes, rng: np.random.Generator) -> None:
    """Give the bytes in pieces, as a line does."""
    cuts = np.unique(rng.integers(0, len(data) + 1, 3))
    for begin, end in itertools.pairwise((0, *cuts.tolist(), len(data))):
        subject.take(data[begin:end])


def recover(subject: Subject, rng: np.random.Generator) -> int:
    """Send sound packets until one is decoded; return how many that took."""
    subject.settle()
    for packets in range(1, 100):
        before = subject.decoded
        subject.take(subject.sound(rng))
        if subject.decoded > before:
            return packets
    return 100


def fuzz(subject: Subject, size: int, seed: int) -> Result:
    """Feed a decoder ``size`` bytes."""
    rng, result, first = np.random.default_rng([seed, zlib.crc32(subject.name.encode())]), Result(), 0
    while result.eaten < size:
        data = garbage(subject, rng)
        try:
            feed(subject, data, rng)
            if rng.random() < 0.2:
                result.recoveries += 1
                result.worst = max(result.worst, recover(subject, rng))
        except Exception as error:  # what is measured: a decoder must never raise, whatever the type
            result.error = f"{type(error).__name__}: {error} at {data!r}"
            break
        result.eaten += len(data)
        if not first and result.eaten > size / 2:
            recover(subject, rng)
            gc.collect()
            tracemalloc.start()
            first = tracemalloc.get_traced_memory()[0]
    recover(subject, rng)
    gc.collect()
    last, result.peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    result.growth = last - first
    return result


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--bytes", type=int, default=BYTES)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    print(machine())
    runs: dict[str, Callable[[], Result]] = {
        kind.name: lambda kind=kind: fuzz(kind(), arguments.bytes, arguments.seed) for kind in SUBJECTS
    }
    for side in ("driver", "drives"):
        runs[f"CANopen, {side}"] = lambda side=side: fuzz_can(side, arguments.bytes, arguments.seed)
    results = [_shown(name, run) for name, run in runs.items()]
    return 0 if all(result.passed for result in results) else 1


def _shown(name: str, run: Callable[[], Result]) -> Result:
    begin = time.process_time()
    result = run()
    spent = time.process_time() - begin
    packets = f" after {result.worst} packet(s) at most" if result.worst else ""
    print(
        f"{name:18s} {result.eaten:8d} bytes in {spent:5.1f} s, {result.recoveries} times good again{packets},"
        f" memory {result.growth:+d} bytes (peak {result.peak}): {result.error or verdict(result.passed)}",
        flush=True,
    )
    return result


if __name__ == "__main__":
    sys.exit(main())
