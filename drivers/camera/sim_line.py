"""One connection to the simulator's camera (docs/camera_protocol.md)."""

from __future__ import annotations

import time
from typing import Literal, TypeVar

from pydantic import BaseModel

from drivers.camera.frame_message import Failure, IdentifyRequest, Identity, header_message, read_header
from drivers.camera.wire import VERSION, Decoder, Kind, Message, WireError, encode
from drivers.link import Link
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext

ANSWER = 3.0
"""A server that says nothing for so long is lost [s]."""
_CHUNK = 1 << 18
_ANSWERS = (Kind.IDENTITY, Kind.FRAME, Kind.NOTHING_NEW, Kind.GONE)

HeaderT = TypeVar("HeaderT", bound=BaseModel)


class SimLine:
    """Messages to and from the server. One thread at a time uses it."""

    def __init__(self, port: str, context: DeviceContext) -> None:
        """Connect.

        Raises:
            DeviceError: Nothing listens there.
        """
        self._link, self._decoder = Link(port, baud=115200, where=context.where), Decoder()
        self._clock = context.clock
        self.where = f"{context.where}: {port}"
        """Place to begin error messages with."""
        self.heard = 0.0
        """When the first bytes of the latest messages came [s]."""

    def identify(self, purpose: Literal["frames", "pixels"]) -> Identity:
        """Say what the connection is for, and return who is there.

        Raises:
            DeviceError: Nobody answers, or it is no such camera.
        """
        self.send(header_message(Kind.IDENTIFY, IdentifyRequest(purpose=purpose)))
        until = time.monotonic() + ANSWER
        while time.monotonic() < until:
            for message in self.receive(0.1):
                if message.kind == Kind.IDENTITY:
                    return self.read(Identity, message)
        raise DeviceError(f"{self.where}: answers, but not as the simulator's camera does (is the port right?)")

    def send(self, message: Message) -> None:
        """Send a message.

        Raises:
            DeviceError: The line is broken.
        """
        self._link.write(b"".join(encode(message)))

    def receive(self, timeout: float) -> list[Message]:
        """Return the messages that arrive first, none if there are none after ``timeout`` [s].

        Raises:
            DeviceError: The line is broken, the server reports an error, or it speaks another language.
        """
        until = time.monotonic() + timeout
        while (left := until - time.monotonic()) > 0:
            data = self._link.read(left, _CHUNK)
            if data and not self._decoder.pending:
                self.heard = self._clock.now()
            if messages := self._decoder.feed(data):
                for message in messages:
                    self._refuse_faults(message)
                return messages
        return []

    def read(self, model: type[HeaderT], message: Message) -> HeaderT:
        """Return a message's header, checked.

        Raises:
            DeviceError: It does not say what it should.
        """
        try:
            return read_header(model, message)
        except WireError as error:
            raise DeviceError(f"{self.where}: sends a message that is none: {error}") from None

    def close(self) -> None:
        """Disconnect."""
        self._link.close()

    def _refuse_faults(self, message: Message) -> None:
        if message.version != VERSION:
            spoken = f"speaks version {message.version} of the camera protocol, this driver version {VERSION}"
            raise DeviceError(f"{self.where}: {spoken} (install the same release on both sides)")
        if message.kind == Kind.ERROR:
            raise DeviceError(f"{self.where}: {self.read(Failure, message).message}")
        if message.kind not in _ANSWERS:
            raise DeviceError(f"{self.where}: sends a message of the unknown kind {message.kind}")
