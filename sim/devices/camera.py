"""The simulated RGB-D camera on the network (docs/camera_protocol.md)."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable

from drivers.camera.frame_message import (
    Annotation,
    Failure,
    Gone,
    IdentifyRequest,
    Identity,
    NextRequest,
    NothingNew,
    PixelsRequest,
    WireFrame,
    frame_message,
    header_message,
    read_header,
)
from drivers.camera.pixels import WireImage, encode_depth, encode_rgb
from drivers.camera.wire import VERSION, Decoder, Kind, Message, WireError, encode
from sim.devices.plant import Plant
from sim.devices.shutter import Shutter
from sim.frame import SimFrame
from sim.physics import STEPS_PER_SECOND
from zavis_bt.errors import DeviceError

_STEP = 1 / STEPS_PER_SECOND  # [s]
_CHUNK = 1 << 16
_MOST_LINES = 16  # eight clients, each with a second line for pixels
_PATIENCE = 5.0  # a client that takes nothing for so long is dropped [s]


class CameraServer:
    """Serves what the plant's camera sees to up to eight clients, each of which asks for frame after frame.

    Nothing is rendered that nobody asks for: a client may leave a frame's pixels here, and fetch them within the next
    600 frames over a second line.
    """

    def __init__(self, plant: Plant, host: str = "127.0.0.1", port: int = 0) -> None:
        """Listen at once; answer from `start` on.

        Args:
            plant: Whose camera.
            host: Address to listen at.
            port: TCP port; any free one if 0.

        Raises:
            DeviceError: The port is not free, or may not be used.
        """
        self._plant, self._rate = plant, plant.spec.camera.rate
        self._shutter = Shutter(plant.frame, self._rate)
        self._stepped: tuple[float, float] | None = None  # time in the world, and on time.monotonic [s]
        plant.controllers.append(self._note_step)
        try:
            self._listener = socket.create_server((host, port))
        except OSError as error:
            raise DeviceError(f"camera server: {host}:{port}: {error.strerror} (choose another port)") from error
        self.port: int = self._listener.getsockname()[1]
        """TCP port it listens at."""
        self._closed = threading.Event()
        self._lines: set[socket.socket] = set()
        self._pixel_lines: set[socket.socket] = set()
        self._guard = threading.Lock()
        self._threads = [threading.Thread(target=self._accept, name="camera server", daemon=True)]

    @property
    def clients(self) -> int:
        """Clients that are connected, be it with a second line for pixels or without."""
        return len(self._lines) - len(self._pixel_lines)

    def start(self) -> None:
        """Answer; the first picture is made before, so that no client waits for the compiler."""
        first = self._plant.frame()
        _ = first.rgb, first.instances
        self._threads[0].start()

    def freeze(self) -> None:
        """Take no new pictures, as a hung sensor does; clients stay connected."""
        self._shutter.frozen = True

    def thaw(self) -> None:
        """Take pictures again."""
        self._shutter.frozen = False

    def close(self) -> None:
        """Hang up; may be called twice."""
        self._closed.set()
        with contextlib.suppress(ValueError):  # a second time
            self._plant.controllers.remove(self._note_step)
        self._shutter.close()
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that waits for clients
        self._listener.close()
        with self._guard:
            lines = tuple(self._lines)
        for line in lines:
            with contextlib.suppress(OSError):
                line.shutdown(socket.SHUT_RDWR)
        for thread in self._threads:
            if thread.is_alive():
                thread.join(timeout=2.0)

    def _accept(self) -> None:
        while not self._closed.is_set():
            try:
                line, _ = self._listener.accept()
            except OSError:  # closed
                return
            line.settimeout(_PATIENCE)
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._threads = [thread for thread in self._threads if thread.is_alive()]
            thread = threading.Thread(target=self._serve, args=(line,), name="camera client", daemon=True)
            self._threads.append(thread)
            thread.start()

    def _serve(self, line: socket.socket) -> None:
        """Answer one client until it goes."""
        with self._guard:
            self._lines.add(line)
            full = len(self._lines) > _MOST_LINES
        try:
            with line:
                self._converse(line, _refusal if full else self._answer)
        except OSError:  # the client has gone
            pass
        finally:
            with self._guard:
                self._lines.discard(line)
                self._pixel_lines.discard(line)

    def _converse(self, line: socket.socket, answer: Callable[[socket.socket, Message], Message]) -> None:
        decoder = Decoder()
        while not self._closed.is_set():
            try:
                data = line.recv(_CHUNK)
            except TimeoutError:  # says nothing, but is there
                continue
            if not data:
                return
            for request in decoder.feed(data):
                _send(line, answer(line, request))

    def _answer(self, line: socket.socket, request: Message) -> Message:
        if request.version != VERSION:
            return _failure(f"version {request.version} of the protocol is not spoken here (version {VERSION} is)")
        try:
            match request.kind:
                case Kind.IDENTIFY:
                    return self._identify(line, read_header(IdentifyRequest, request))
                case Kind.NEXT:
                    return self._next(read_header(NextRequest, request))
                case Kind.PIXELS:
                    return self._look_back(read_header(PixelsRequest, request))
        except WireError as error:
            return _failure(str(error))
        return _failure(f"requests of kind {request.kind} are unknown")

    def _identify(self, line: socket.socket, asked: IdentifyRequest) -> Message:
        if asked.purpose == "pixels":
            with self._guard:
                self._pixel_lines.add(line)
        return header_message(Kind.IDENTITY, Identity(model="zavis simulated camera", rate=self._rate))

    def _next(self, wanted: NextRequest) -> Message:
        number, frame = self._shutter.newer_than(wanted.after, wanted.wait)
        if frame is None:
            return header_message(Kind.NOTHING_NEW, NothingNew(number=number, now=self._now()))
        if wanted.pixels == "keep":
            rgb, depth = WireImage(wanted.rgb, b""), WireImage(wanted.depth, b"")
        else:
            rgb, depth = encode_rgb(frame.rgb, wanted.rgb), encode_depth(frame.depth, wanted.depth)
        annotations = _annotations(frame) if wanted.annotations else None
        return frame_message(WireFrame(number, frame.stamp, self._now(), frame.intrinsics, rgb, depth, annotations))

    def _look_back(self, wanted: PixelsRequest) -> Message:
        frame = self._shutter.taken(wanted.number)
        if frame is None:
            return header_message(Kind.GONE, Gone(number=wanted.number, oldest=self._shutter.oldest))
        rgb, depth = encode_rgb(frame.rgb, wanted.rgb), encode_depth(frame.depth, wanted.depth)
        return frame_message(WireFrame(wanted.number, frame.stamp, self._now(), frame.intrinsics, rgb, depth))

    def _note_step(self, now: float) -> None:
        self._stepped = now + _STEP, time.monotonic()  # the step that begins now ends this instant

    def _now(self) -> float:
        """Return the world's time [s], which clients compare with theirs, between its steps too."""
        if self._stepped is None:
            return self._plant.now
        stamp, read = self._stepped
        return stamp + min(time.monotonic() - read, _STEP)


def _annotations(frame: SimFrame) -> tuple[Annotation, ...]:
    return tuple(Annotation(*instance) for instance in frame.instances)


def _refusal(line: socket.socket, request: Message) -> Message:
    return _failure(f"{_MOST_LINES} connections are open already (close a client)")


def _failure(text: str) -> Message:
    return header_message(Kind.ERROR, Failure(message=text))


def _send(line: socket.socket, message: Message) -> None:
    for piece in encode(message):
        line.sendall(piece)
