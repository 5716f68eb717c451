"""How fast ARCOS is decoded, and how steadily a base is driven: `python -m benchmarks.arcos`.

Decoding is timed on one core with all checksums verified, next to a parser as in textbooks, which takes one byte after
the other through its states. Driving goes over TCP to the simulated Pioneer in another process, and what counts are the
times at which velocities arrive there: while this process has nothing else to do, while another thread of it computes
in pure Python, and from a `stop` to the arrival of the emergency stop.
"""

from __future__ import annotations

import itertools
import multiprocessing
import select
import socket
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection

from benchmarks.timing import machine, spread, take_turns, verdict
from drivers import builtin_robot
from drivers.pioneer import PioneerBase, open_base
from drivers.pioneer.codec import CommandNumber, PacketDecoder, Sip, decode_command, decode_sip, encode_sip
from sim.devices.arcos import ArcosServer
from sim.devices.plant import Plant
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import FloatArray, Pose2D, Twist2D

PACKETS = 5_000
ROUNDS = 9
CHUNK = 4096  # what a read from the line returns at most
TARGET = 50_000  # packets a second
JITTER_TARGET = 0.005  # 99 of 100 [s]
SECONDS = 10.0
STOPS = 20
PERIOD = 0.05  # [s]


def decode(data: bytes) -> None:
    decoder, count = PacketDecoder(), 0
    for at in range(0, len(data), CHUNK):
        for payload in decoder.feed(data[at : at + CHUNK]):
            decode_sip(payload)
            count += 1
    assert count == PACKETS


def walk(data: bytes) -> None:
    """Framing and checksum alone, byte by byte."""
    state, length, count, payload = 0, 0, 0, bytearray()
    for byte in data:
        if state == 0:
            state = 1 if byte == 0xFA else 0
        elif state == 1:
            state = 2 if byte == 0xFB else 0
        elif state == 2:
            state, length, payload = 3, byte, bytearray()
        else:
            payload.append(byte)
            if len(payload) == length:
                count += textbook_checksum(payload[:-2]) == payload[-2] << 8 | payload[-1]
                state = 0
    assert count == PACKETS


def textbook_checksum(payload: bytearray) -> int:
    total, at = 0, 0
    while len(payload) - at > 1:
        total = (total + (payload[at] << 8 | payload[at + 1])) & 0xFFFF
        at += 2
    return total ^ payload[at] if at < len(payload) else total


def measure_decoding() -> None:
    streams = {
        f"{count} sonar readings": encode_sip(Sip(x=123, heading=-456, sonar=((3, 2500),) * count)) * PACKETS
        for count in (0, 4, 16)
    }
    calls = {name: lambda data=data: decode(data) for name, data in streams.items()}
    typical = streams["4 sonar readings"]
    spent = take_turns({**calls, "byte by byte, 4, framing only": lambda: walk(typical)}, ROUNDS, PACKETS)
    print(f"status packets a second of CPU time, medians of {ROUNDS} turns; {machine()}")
    for name, seconds in spent.items():
        print(f"{name:30}  {1 / seconds:9,.0f} packets/s  {seconds * 1e6:5.1f} µs")
    slowest = min(1 / spent[name] for name in streams)
    print(f"target, at least {TARGET:,} packets a second: {verdict(slowest >= TARGET)}")


def serve(pipe: Connection) -> None:
    """Play the robot in a process of its own; on the pipe: the port, then for anything, the arrivals so far."""
    world, spec = load_world(resolve_world("apartment")), load_robot(builtin_robot("pioneer3at")).spec
    plant = Plant(world, spec, world.starts[0])
    server = ArcosServer(plant, port=0)
    arrivals: list[tuple[float, int]] = []
    with socket.create_server(("127.0.0.1", 0)) as front:
        plant.start()
        server.start()
        threading.Thread(target=tap, args=(front, server.port, arrivals), daemon=True).start()
        pipe.send(front.getsockname()[1])
        while pipe.recv():
            taken = arrivals[:]
            del arrivals[: len(taken)]
            pipe.send(taken)
    server.close()
    plant.close()


def tap(front: socket.socket, port: int, arrivals: list[tuple[float, int]]) -> None:
    """Pass bytes on both ways, and write down when which command arrives."""
    client, decoder = front.accept()[0], PacketDecoder()
    with client, socket.create_connection(("127.0.0.1", port)) as robot:
        for line in (client, robot):
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        while True:
            for line in select.select([client, robot], [], [])[0]:
                data, now = line.recv(CHUNK), time.monotonic()
                if not data:
                    return
                (robot if line is client else client).sendall(data)
                if line is client:
                    arrivals += [(now, decode_command(payload).number) for payload in decoder.feed(data)]


@contextmanager
def driven() -> Iterator[tuple[PioneerBase, Connection]]:
    """Open the driver on a robot in another process."""
    processes = multiprocessing.get_context("spawn")
    ours, theirs = processes.Pipe()
    process = processes.Process(target=serve, args=(theirs,), daemon=True)
    process.start()
    base = open_base({"port": f"tcp://127.0.0.1:{ours.recv()}"}, context())
    try:
        yield base, ours
    finally:
        base.close()
        ours.send(False)
        process.join()


def context() -> DeviceContext:
    def nowhere(stamp: float) -> FloatArray:
        raise AssertionError("a base has no camera")

    spec = load_robot(builtin_robot("pioneer3at")).spec
    return DeviceContext("benchmark", spec, WallClock(), Pose2D(0.0, 0.0), nowhere)


def arrivals_while(base: PioneerBase, robot: Connection, command_every: float) -> list[float]:
    """Return the times at which velocities arrive while a mission commands the base."""
    robot.send(True)
    robot.recv()
    end, i = time.monotonic() + SECONDS, 0
    while time.monotonic() < end:
        base.command(Twist2D(0.0, 0.3 if i % 20 < 10 else -0.3))
        time.sleep(command_every)
        i += 1
    robot.send(True)
    times = [at for at, number in robot.recv() if number == CommandNumber.VEL]
    base.stop()
    return times


def report_jitter(name: str, times: Sequence[float]) -> None:
    off = sorted(abs(after - before - PERIOD) for before, after in itertools.pairwise(times))
    p99 = off[int(0.99 * len(off))]
    rate = (len(times) - 1) / (times[-1] - times[0])
    print(
        f"{name:30}  {rate:5.2f} Hz  jitter median {off[len(off) // 2] * 1e3:.2f} ms, 99 of 100 {p99 * 1e3:.2f} ms,"
        f" worst {off[-1] * 1e3:.1f} ms; target 5 ms: {verdict(p99 < JITTER_TARGET)}"
    )


def stop_latencies(base: PioneerBase, robot: Connection) -> list[float]:
    """Return the times from `stop` to the arrival of the emergency stop [s]."""
    latencies = []
    for _ in range(STOPS):
        base.command(Twist2D(0.0, 0.2))
        time.sleep(0.2)
        robot.send(True)
        robot.recv()
        begin = time.monotonic()
        base.stop()
        time.sleep(0.05)
        robot.send(True)
        latencies.append(next(at for at, number in robot.recv() if number == CommandNumber.E_STOP) - begin)
    return latencies


@contextmanager
def busy() -> Iterator[None]:
    """Keep another thread of this process computing in pure Python, as a mission's planning may."""
    ended = threading.Event()

    def compute() -> None:
        while not ended.is_set():
            sum(i * i for i in range(1000))

    thread = threading.Thread(target=compute, daemon=True)
    thread.start()
    yield
    ended.set()
    thread.join()


def measure_driving() -> None:
    print(f"velocities as they arrive at the robot, {SECONDS:.0f} s of turning; {machine()}")
    with driven() as (base, robot):
        report_jitter("nothing else to do", arrivals_while(base, robot, 0.1))
        with busy():
            report_jitter("a thread computes in Python", arrivals_while(base, robot, 0.1))
            usual = sys.getswitchinterval()
            sys.setswitchinterval(0.001)
            report_jitter("the same, switched every 1 ms", arrivals_while(base, robot, 0.1))
            sys.setswitchinterval(usual)
        print(f"from stop() to its arrival: {spread([late * 1e3 for late in stop_latencies(base, robot)])} ms")
        report = base.report()
        print("; ".join(f"{name} {value}" for name, value in report.figures.items()))


def main() -> None:
    measure_decoding()
    measure_driving()


if __name__ == "__main__":
    main()
