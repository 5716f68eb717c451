"""The decoders that stand at a line, each as its driver or device uses it, and what belongs on that line."""

from __future__ import annotations

import contextlib
from abc import ABC, abstractmethod

import numpy as np

from drivers.camera.frame_message import (
    Gone,
    IdentifyRequest,
    NextRequest,
    PixelsRequest,
    WireFrame,
    frame_message,
    header_message,
    read_frame,
    read_header,
)
from drivers.camera.frame_message import Identity as CameraIdentity
from drivers.camera.pixels import decode_pixels, encode_depth, encode_rgb
from drivers.camera.wire import Decoder, Kind, Message, WireError, encode
from drivers.lidar import codec as scip
from drivers.pioneer import codec as arcos
from zavis_bt.types import CameraIntrinsics


class Subject(ABC):
    """A decoder, and what it finds."""

    name: str

    def __init__(self) -> None:
        self.decoded = 0
        """Sound packets so far, whose content made sense too."""

    @abstractmethod
    def take(self, data: bytes) -> None:
        """Give it bytes as they would come from the line. Must never raise."""

    def settle(self) -> None:
        """Let the line be silent for a while: reads of it end without a byte."""
        self.take(b"")

    @abstractmethod
    def sound(self, rng: np.random.Generator) -> bytes:
        """Return a packet that it must decode."""

    def framed(self, payload: bytes) -> bytes:
        """Return nonsense within a sound frame, if the line has such."""
        return payload


class ArcosDriver(Subject):
    """What a robot sends."""

    name = "ARCOS, driver"

    def __init__(self) -> None:
        super().__init__()
        self._decoder = arcos.PacketDecoder()

    def take(self, data: bytes) -> None:
        for payload in self._decoder.feed(data):
            self._read(payload)

    def settle(self) -> None:
        for payload in self._decoder.expire():
            self._read(payload)

    def _read(self, payload: bytes) -> None:
        with contextlib.suppress(arcos.PacketError):
            if arcos.is_sip(payload):
                arcos.decode_sip(payload)
                self.decoded += 1
        for decode in (arcos.decode_config, arcos.decode_encoders, arcos.decode_aux, arcos.decode_identity):
            with contextlib.suppress(arcos.PacketError):
                decode(payload)

    def sound(self, rng: np.random.Generator) -> bytes:
        sip = arcos.Sip(
            moving=bool(rng.integers(2)), x=int(rng.integers(65536)), heading=int(rng.integers(-2048, 2048))
        )
        return arcos.encode_sip(sip)

    def framed(self, payload: bytes) -> bytes:
        kinds = bytes((0x20, 0x32, 0x33, 0x90, 0xB0, 0x02))
        payload = payload[: arcos.MAX_PAYLOAD] or b"\0"
        return arcos.encode(bytes((kinds[payload[0] % len(kinds)],)) + payload[1:])


class ArcosRobot(Subject):
    """What a client sends to the simulated robot."""

    name = "ARCOS, robot"

    def __init__(self) -> None:
        super().__init__()
        self._decoder = arcos.PacketDecoder()

    def take(self, data: bytes) -> None:
        for payload in self._decoder.feed(data):
            self._read(payload)

    def settle(self) -> None:
        for payload in self._decoder.expire():
            self._read(payload)

    def _read(self, payload: bytes) -> None:
        command = arcos.decode_command(payload)
        command.halves(), command.integer(), command.string()
        self.decoded += command.number == arcos.CommandNumber.VEL and isinstance(command.argument, int)

    def sound(self, rng: np.random.Generator) -> bytes:
        return arcos.encode_command(arcos.CommandNumber.VEL, int(rng.integers(-700, 700)))

    def framed(self, payload: bytes) -> bytes:
        return arcos.encode(payload[: arcos.MAX_PAYLOAD] or b"\0")


class ScipDriver(Subject):
    """What a LiDAR sends."""

    name = "SCIP, driver"

    def __init__(self) -> None:
        super().__init__()
        self._decoder = scip.AnswerDecoder()

    def take(self, data: bytes) -> None:
        for answer in self._decoder.feed(data):
            self.decoded += answer.readings is not None
            with contextlib.suppress(scip.CodecError):
                scip.Parameters.of(scip.decode_information(answer.lines))

    def sound(self, rng: np.random.Generator) -> bytes:
        ranges = rng.integers(20, 30000, 181).astype(np.int32)
        body = scip.encode_readings(int(rng.integers(1 << 24)), ranges, 3)
        return scip.encode_answer(b"MD0000018001000", "99", body)

    def framed(self, payload: bytes) -> bytes:
        lines = (scip.seal(line) + b"\n" for line in payload.split(b"\n") if line)
        echo = (b"PP", b"VV", b"MD0000018001000", b"GE0000018001")[len(payload) % 4]
        return scip.encode_answer(echo, ("00", "99")[len(payload) % 2], b"".join(lines))


class ScipSensor(Subject):
    """What a host sends to the simulated LiDAR: its lines."""

    name = "SCIP, sensor"
    _LONGEST = 128

    def __init__(self) -> None:
        super().__init__()
        self._rest = b""

    def take(self, data: bytes) -> None:
        *lines, rest = (self._rest + data).replace(b"\r", b"\n").split(b"\n")
        self._rest = rest[-self._LONGEST :]
        for line in lines:
            with contextlib.suppress(scip.RequestError):
                request = scip.parse_request(line)
                if request.command in scip.SCAN_COMMANDS:
                    scip.ScanRequest.parse(request, 180)
                    self.decoded += 1

    def settle(self) -> None:
        self.take(b"\n")

    def sound(self, rng: np.random.Generator) -> bytes:
        return b"MD%04d%04d01000\n" % (rng.integers(0, 90), rng.integers(90, 181))

    def framed(self, payload: bytes) -> bytes:
        return (b"MD", b"GD", b"TM", b"SS", b"%ST")[len(payload) % 5] + payload[:20].replace(b"\n", b"0") + b"\n"


class Camera(Subject):
    """Both ends of the simulator's camera line."""

    name = "camera, both ends"
    _INTRINSICS = CameraIntrinsics.from_fov(16, 12, 1.0)

    def __init__(self) -> None:
        super().__init__()
        self._decoder = Decoder()

    def take(self, data: bytes) -> None:
        for message in self._decoder.feed(data):
            for model in (CameraIdentity, IdentifyRequest, NextRequest, PixelsRequest, Gone):
                with contextlib.suppress(WireError):
                    read_header(model, message)
            with contextlib.suppress(WireError):
                frame = read_frame(message)
                decode_pixels(frame.rgb, frame.depth, frame.intrinsics)
                self.decoded += 1

    def sound(self, rng: np.random.Generator) -> bytes:
        packed = bool(rng.integers(2))
        rgb = encode_rgb(rng.integers(0, 256, (12, 16, 3), dtype=np.uint8), "jpeg" if packed else "raw")
        depth = encode_depth(rng.uniform(0, 9, (12, 16)).astype(np.float32), "png" if packed else "raw")
        return b"".join(encode(frame_message(WireFrame(1, 0.1, 0.2, self._INTRINSICS, rgb, depth))))

    def framed(self, payload: bytes) -> bytes:
        if len(payload) % 3:
            return b"".join(encode(header_message(Kind.NEXT, NextRequest())))[: -len(payload) % 7] + payload
        header = {"number": 1, "rgb": {"encoding": "png", "size": len(payload)}, "x": payload.decode("latin-1")}
        return b"".join(encode(Message(payload[0] if payload else 0, header, payload)))


SUBJECTS: tuple[type[Subject], ...] = (ArcosDriver, ArcosRobot, ScipDriver, ScipSensor, Camera)
