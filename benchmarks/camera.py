"""The network camera and stereo depth: `python -m benchmarks.camera`.

Frames of 640 × 480 over loopback, server and client in one process: wall time from request to frame, CPU time of
both ends together. The pictures are noise on a slope, as costly to compress as a real room, and already rendered; what
rendering costs comes on top and is in a line of its own. The last lines are what the simulator's camera and its driver
cost in the apartment, as the setting `pixels` has it. Stereo depth is timed on one thread.
"""

from __future__ import annotations

import socket
import statistics
import threading
import time
from collections.abc import Callable

import cv2
import numpy as np

from benchmarks.timing import machine
from drivers.camera import open_sim
from drivers.camera.calibration_file import StereoCalibration, matrix_of
from drivers.camera.frame_message import NextRequest, WireFrame, frame_message, header_message, read_frame, read_header
from drivers.camera.pixels import decode_pixels, encode_depth, encode_rgb
from drivers.camera.stereo_depth import StereoDepth
from drivers.camera.wire import Decoder, Kind, encode
from drivers.profiles import builtin_robot
from sim import load_world
from sim.camera import SimCamera
from sim.devices.camera import CameraServer
from sim.devices.plant import Plant
from sim.scene import Scene
from sim.worlds import builtin_world
from zavis_bt.mission import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import CameraIntrinsics, CameraSpec

FRAMES = 60
SECONDS = 6.0
SIZE = (640, 480)
INTRINSICS = CameraIntrinsics.from_fov(*SIZE, 1.05)


def pictures() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    slope = np.linspace(40, 200, SIZE[0])[None, :, None] + np.zeros((SIZE[1], 1, 3))
    rgb = (slope + rng.normal(0.0, 4.0, slope.shape)).clip(0, 255).astype(np.uint8)
    depth = np.linspace(1.0, 8.0, SIZE[0])[None] + rng.normal(0.0, 0.004, SIZE[::-1])
    return rgb, depth.astype(np.float32)


def serve(line: socket.socket) -> None:
    """Answer requests as the simulator's server does, with frames that are rendered already."""
    (rgb, depth), decoder = pictures(), Decoder()
    while data := line.recv(65536):
        for message in decoder.feed(data):
            wanted = read_header(NextRequest, message)
            colours, distances = encode_rgb(rgb, wanted.rgb), encode_depth(depth, wanted.depth)
            frame = WireFrame(wanted.after + 1, 0.0, 0.0, INTRINSICS, colours, distances, ())
            for piece in encode(frame_message(frame)):
                line.sendall(piece)


def over_loopback(rgb: str, depth: str) -> None:
    listener = socket.create_server(("127.0.0.1", 0))
    client = socket.create_connection(listener.getsockname())
    server, _ = listener.accept()
    answering = threading.Thread(target=serve, args=(server,), daemon=True)
    answering.start()
    decoder, latencies, sizes = Decoder(), [], 0
    begin, cpu = time.perf_counter(), time.process_time()
    for number in range(FRAMES):
        asked = time.perf_counter()
        request = NextRequest(after=number, rgb=rgb, depth=depth, annotations=True)
        client.sendall(b"".join(encode(header_message(Kind.NEXT, request))))
        messages: list = []
        while not messages:
            data = client.recv(1 << 18)
            sizes += len(data)
            messages = decoder.feed(data)
        frame = read_frame(messages[0])
        decode_pixels(frame.rgb, frame.depth, frame.intrinsics)
        latencies.append(1000 * (time.perf_counter() - asked))
    wall, cpu = time.perf_counter() - begin, time.process_time() - cpu
    client.close()
    answering.join()
    server.close()
    listener.close()
    median, worst = statistics.median(latencies), sorted(latencies)[int(0.99 * FRAMES)]
    print(
        f"rgb {rgb:<4} depth {depth:<3} {FRAMES / wall:7.0f} frames/s {median:7.1f} ms median {worst:7.1f} ms p99 "
        f"{1000 * cpu / FRAMES:7.1f} ms CPU {sizes / FRAMES / 1000:7.0f} kB"
    )


def stereo(size: tuple[int, int]) -> None:
    intrinsics = CameraIntrinsics.from_fov(*size, 1.05)
    matrix, none, straight = matrix_of(intrinsics), np.zeros(5), np.eye(3)
    left = np.column_stack((matrix, np.zeros(3)))
    right = left.copy()
    right[0, 3] = -0.08 * matrix[0, 0]
    shift = np.array([-0.08, 0.0, 0.0])
    lens = matrix, none, matrix, none
    pair = StereoCalibration(size, *lens, straight, shift, straight, straight, left, right, np.eye(4))
    texture = np.random.default_rng(2).integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)
    image = cv2.GaussianBlur(texture, (0, 0), 1.5)
    depth, moved = StereoDepth(pair, size, 0.4, 8.0), np.roll(image, -20, axis=1)
    depth(image, moved)
    spent = []
    for _ in range(9):
        begin = time.perf_counter()
        depth(image, moved)
        spent.append(1000 * (time.perf_counter() - begin))
    print(f"stereo depth {size[0]} x {size[1]}: {statistics.median(spent):.0f} ms")


def rendering() -> None:
    world = load_world(builtin_world("apartment"))
    camera = SimCamera(Scene.of(world), CameraSpec(INTRINSICS, 0.06, 1.1, 0.3, 10.0, 10.0))
    spent = []
    for number in range(10):
        begin = time.process_time()
        rgb = camera.capture(world.starts[number % len(world.starts)], 0.0, 0.0, 0.0).rgb
        spent.append(1000 * (time.process_time() - begin))
    print(f"rendering {rgb.shape[1]} x {rgb.shape[0]} in the apartment: {statistics.median(spent[1:]):.0f} ms CPU")


def looking(pixels: str, looks: float) -> None:
    """Take frames for a few seconds, and look at so many of them a second."""
    world, spec = load_world(builtin_world("apartment")), load_robot(builtin_robot("pioneer3at_sim")).spec
    plant = Plant(world, spec, world.starts[0])
    server = CameraServer(plant)
    plant.start()
    server.start()
    around = DeviceContext("benchmark", spec, WallClock(), world.starts[0], lambda stamp: np.eye(4))
    time.sleep(1.0)
    idle = cpu_over(SECONDS)
    camera = open_sim({"port": f"tcp://127.0.0.1:{server.port}", "pixels": pixels}, around)
    time.sleep(1.0)
    busy = cpu_over(SECONDS, lambda: camera.frame().rgb if looks else None, 1 / looks if looks else SECONDS)
    rate = camera.report().figures["rate"]
    camera.close()
    server.close()
    plant.close()
    print(f"pixels {pixels:<4} {looks:g} looks/s: frames at {rate}, {busy - idle:5.1%} of a core")


def cpu_over(seconds: float, look: Callable[[], object] = lambda: None, period: float = 1.0) -> float:
    """Return the share of a core that this process takes, looking now and then."""
    begin, cpu = time.perf_counter(), time.process_time()
    while time.perf_counter() - begin < seconds:
        look()
        time.sleep(period)
    return (time.process_time() - cpu) / (time.perf_counter() - begin)


def main() -> None:
    cv2.setNumThreads(1)
    print(f"640 x 480 over loopback, {FRAMES} frames each; {machine()}")
    for rgb, depth in (("raw", "raw"), ("jpeg", "raw"), ("jpeg", "png")):
        over_loopback(rgb, depth)
    stereo((320, 240))
    stereo((640, 480))
    rendering()
    for pixels, looks in (("send", 0.0), ("ask", 0.0), ("ask", 1.0)):
        looking(pixels, looks)


if __name__ == "__main__":
    main()
