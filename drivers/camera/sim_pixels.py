"""Pixels that stayed with the simulator's camera, fetched when somebody looks (docs/camera_protocol.md)."""

from __future__ import annotations

import threading
import time

from drivers.camera.frame_message import Gone, PixelsRequest, WireFrame, header_message, read_frame
from drivers.camera.sim_line import ANSWER, SimLine
from drivers.camera.wire import Kind, Message, WireError
from zavis_bt.errors import DeviceError

_PATIENCE = 2.0  # so long somebody who looks at a frame waits for its pixels [s]
_SLICE = 0.1  # a fetch sees within so long that the line was closed [s]


class PixelLine:
    """A connection of its own for pixels, so that the one that frames come by never waits for rendering.

    Any thread may fetch; they take turns. After a fault the line is of no more use: a server that was started anew
    counts its frames anew, so none that came before may be asked for.
    """

    def __init__(self, line: SimLine) -> None:
        """Fetch over a line that nobody else uses; owned from now on.

        Raises:
            DeviceError: It does not lead to such a camera; it is closed then.
        """
        self._line, self._turn = line, threading.Lock()
        self._unanswered: float | None = None  # when that was asked for which nothing was heard after
        self.fault = ""
        """Why it is of no more use; empty as long as it is."""
        try:
            line.identify("pixels")
        except DeviceError:
            line.close()
            raise

    def fetch(self, frame: WireFrame) -> WireFrame:
        """Return a kept frame with its images, encoded as its header says.

        Raises:
            DeviceError: The line is lost, the server no longer keeps the frame, or it takes more than two seconds.
        """
        until = time.monotonic() + _PATIENCE
        answer = None
        if self._turn.acquire(timeout=_PATIENCE):
            try:
                answer = self._ask(frame, until)
            finally:
                self._turn.release()
        if isinstance(answer, WireFrame):
            return answer
        where = f"{self._line.where}: frame {frame.number}"
        if answer is None:
            raise DeviceError(f"{where}: its pixels did not come within {_PATIENCE:g} s (is the computer overloaded?)")
        raise DeviceError(
            f"{where}: is too old, the oldest that the server keeps is {answer.oldest} (look at it sooner)"
        )

    def close(self) -> None:
        """Disconnect; whoever waits for pixels gets none."""
        self.fault = self.fault or f"{self._line.where}: the connection is closed, and the pixels left there are lost"
        with self._turn:
            self._line.close()

    def _ask(self, frame: WireFrame, until: float) -> WireFrame | Gone | None:
        try:
            self._check()
            self._send(frame)
            while (left := until - time.monotonic()) > 0:
                self._check()
                for message in self._line.receive(min(left, _SLICE)):
                    self._unanswered = None
                    if (answer := self._answer(message, frame)) is not None:
                        return answer
            self._check_silence()
        except DeviceError as error:
            self.fault = self.fault or str(error)
            raise
        return None

    def _send(self, frame: WireFrame) -> None:
        request = PixelsRequest.model_validate(
            {"number": frame.number, "rgb": frame.rgb.encoding, "depth": frame.depth.encoding}
        )
        self._line.send(header_message(Kind.PIXELS, request))
        self._unanswered = self._unanswered or time.monotonic()

    def _answer(self, message: Message, frame: WireFrame) -> WireFrame | Gone | None:
        """Return what a message says of the frame; None if it is late and about another one."""
        if message.kind == Kind.GONE:
            gone = self._line.read(Gone, message)
            return gone if gone.number == frame.number else None
        try:
            answer = read_frame(message)
        except WireError as error:
            raise DeviceError(f"{self._line.where}: sends a frame that is none: {error}") from None
        if answer.number != frame.number:
            return None
        if answer.is_kept or (answer.stamp, answer.intrinsics) != (frame.stamp, frame.intrinsics):
            raise DeviceError(f"{self._line.where}: frame {frame.number}: sends the pixels of another frame, or none")
        return answer

    def _check(self) -> None:
        if self.fault:
            raise DeviceError(self.fault)

    def _check_silence(self) -> None:
        if self._unanswered is not None and time.monotonic() - self._unanswered > ANSWER:
            raise DeviceError(f"{self._line.where}: no pixels for {ANSWER:g} s (is the simulator stopped?)")
