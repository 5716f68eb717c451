"""The simulator's network camera (docs/camera_protocol.md)."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from drivers.camera.clock_offset import ClockOffset
from drivers.camera.device import CameraDevice
from drivers.camera.frame_message import (
    Failure,
    Identity,
    NextRequest,
    NothingNew,
    WireFrame,
    header_message,
    read_frame,
    read_header,
)
from drivers.camera.pixels import decode_pixels
from drivers.camera.source import Capture, NamePlate
from drivers.camera.wire import VERSION, Decoder, Kind, Message, WireError, encode
from drivers.link import Link
from drivers.settings import Settings, read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext

_CHUNK = 1 << 18
_WAIT = 0.5  # so long the server may wait for a new frame [s]
_AGAIN = 1.0  # an answer that takes longer got lost on the way [s]
_ANSWER = 3.0  # a server that says nothing for so long is lost [s]


HeaderT = TypeVar("HeaderT", bound=BaseModel)


class SimCameraSettings(Settings):
    """Settings of the driver ``sim``."""

    port: str = "tcp://localhost:8102"
    """Where the simulator's camera listens."""
    rgb: Literal["raw", "jpeg"] = "raw"
    depth: Literal["raw", "png"] = "raw"
    annotations: bool = True
    """Whether frames bring the ground truth that simulated perception needs."""


def open_sim(settings: Mapping[str, Any], context: DeviceContext) -> CameraDevice:
    """Open the simulator's camera.

    Raises:
        InputError: A setting is wrong.
        DeviceError: Nothing listens there, or it is no such camera.
    """
    return CameraDevice(SimSource(read_settings(SimCameraSettings, settings, context.where), context), context)


class SimSource:
    """Asks the simulator for one frame after the other."""

    def __init__(self, settings: SimCameraSettings, context: DeviceContext) -> None:
        self._settings, self._context = settings, context
        self._where = f"{context.where}: {settings.port}"
        self._line: _Line | None = None
        self._offset, self._number = ClockOffset(), 0
        self._due = 0.0  # when the next request is, on time.monotonic [s]
        self._asked: float | None = None  # when that was sent which is not answered yet
        self._silent_since = 0.0

    def open(self) -> NamePlate:
        """Connect and ask who is there."""
        self._line = _Line(self._settings.port, self._context)
        self._offset, self._number, self._asked = ClockOffset(), 0, None
        try:
            identity = self._identity(self._line)
        except DeviceError:
            self.close()
            raise
        self._silent_since = time.monotonic()
        figures = {"rate of the server": f"{identity.rate:g} Hz"}
        return NamePlate(identity.model, identity.firmware, identity.serial, figures)

    def capture(self, timeout: float) -> Capture | None:
        """Ask for the next frame when it is due, and wait for it."""
        assert self._line is not None
        if self._asked is None:
            wait = self._due - time.monotonic()
            time.sleep(min(max(wait, 0.0), timeout))
            if wait > timeout:
                return None
            self._ask(self._line)
        for message in self._line.receive(timeout):
            self._asked, self._silent_since = None, time.monotonic()
            if (frame := self._frame(message)) is not None:
                return frame
        self._check_silence()
        return None

    def close(self) -> None:
        """Disconnect."""
        if self._line is not None:
            self._line.close()
            self._line = None

    def _identity(self, line: _Line) -> Identity:
        line.send(Message(Kind.IDENTIFY, {}))
        until = time.monotonic() + _ANSWER
        while time.monotonic() < until:
            for message in line.receive(0.1):
                self._refuse_faults(message)
                if message.kind == Kind.IDENTITY:
                    return self._read(Identity, message)
        raise DeviceError(f"{self._where}: answers, but not as the simulator's camera does (is the port right?)")

    def _ask(self, line: _Line) -> None:
        now, period = time.monotonic(), 1 / self._context.spec.camera.rate
        self._due = max(self._due + period, now)
        self._asked = now
        options = self._settings
        request = NextRequest(
            after=self._number, wait=_WAIT, rgb=options.rgb, depth=options.depth, annotations=options.annotations
        )
        line.send(header_message(Kind.NEXT, request))

    def _frame(self, message: Message) -> Capture | None:
        self._refuse_faults(message)
        if message.kind == Kind.NOTHING_NEW:
            self._hear(self._read(NothingNew, message).now)
            return None
        try:
            frame = read_frame(message)
        except WireError as error:
            raise DeviceError(f"{self._where}: sends a frame that is none: {error}") from None
        self._hear(frame.now)
        if frame.number <= self._number:
            return None
        self._number = frame.number
        stamp = min(self._offset(frame.stamp), self._context.clock.now())
        return Capture(stamp, frame.intrinsics, lambda: self._pixels(frame), frame.annotations)

    def _hear(self, sent: float) -> None:
        assert self._line is not None
        self._offset.add(sent, self._line.heard)

    def _pixels(self, frame: WireFrame) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        try:
            return decode_pixels(frame.rgb, frame.depth, frame.intrinsics)
        except WireError as error:
            raise DeviceError(f"{self._where}: {error}") from None

    def _refuse_faults(self, message: Message) -> None:
        if message.version != VERSION:
            spoken = f"speaks version {message.version} of the camera protocol, this driver version {VERSION}"
            raise DeviceError(f"{self._where}: {spoken} (install the same release on both sides)")
        if message.kind == Kind.ERROR:
            raise DeviceError(f"{self._where}: {self._read(Failure, message).message}")
        if message.kind not in (Kind.FRAME, Kind.NOTHING_NEW, Kind.IDENTITY):
            raise DeviceError(f"{self._where}: sends a message of the unknown kind {message.kind}")

    def _read(self, model: type[HeaderT], message: Message) -> HeaderT:
        try:
            return read_header(model, message)
        except WireError as error:
            raise DeviceError(f"{self._where}: sends a message that is none: {error}") from None

    def _check_silence(self) -> None:
        now = time.monotonic()
        if now - self._silent_since > _ANSWER:
            raise DeviceError(f"{self._where}: no answer for {_ANSWER:g} s (is the simulator stopped?)")
        if self._asked is not None and now - self._asked > _AGAIN:
            self._asked = None


class _Line:
    """Messages to and from the server."""

    def __init__(self, port: str, context: DeviceContext) -> None:
        self._link, self._decoder = Link(port, baud=115200, where=context.where), Decoder()
        self._clock = context.clock
        self.heard = 0.0
        """When the first bytes of the latest messages came [s]."""

    def send(self, message: Message) -> None:
        self._link.write(b"".join(encode(message)))

    def receive(self, timeout: float) -> list[Message]:
        """Return the messages that arrive first, none if there are none after ``timeout`` [s]."""
        until = time.monotonic() + timeout
        while (left := until - time.monotonic()) > 0:
            data = self._link.read(left, _CHUNK)
            if data and not self._decoder.pending:
                self.heard = self._clock.now()
            if messages := self._decoder.feed(data):
                return messages
        return []

    def close(self) -> None:
        self._link.close()
