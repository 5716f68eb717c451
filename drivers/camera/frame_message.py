"""What the messages of the simulator's camera say: requests, name plate and frames (docs/camera_protocol.md)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from drivers.camera.pixels import DepthEncoding, RgbEncoding, WireImage
from drivers.camera.wire import Kind, Message, WireError
from zavis_bt.types import Box, CameraIntrinsics

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Count = Annotated[int, Field(ge=0)]
_Side = Annotated[int, Field(ge=1, le=8192)]
_Edges = tuple[_Number, _Number, _Number, _Number]


class Annotation(NamedTuple):
    """Ground truth about one thing in a frame; nobody but simulated perception may read it."""

    id: str
    category: str
    colour: str | None
    is_furniture: bool
    box: Box
    """Around the visible part, clipped to the image [px]."""
    full_box: Box
    """Around the whole of it before the camera, not clipped [px]."""
    visible_fraction: float
    """Visible share of the silhouette's area, 0 to 1."""
    visible_area: float
    """Visible area [px²]."""
    distance: float
    """From the optical centre to its middle [m]."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class IdentifyRequest(_Entry):
    """Header that says what a connection is for."""

    purpose: Literal["frames", "pixels"] = "frames"


class NextRequest(_Entry):
    """Header of a request for a frame newer than one that is known."""

    after: _Count = 0
    """Number of the frame that is known; 0 for none."""
    wait: Annotated[float, Field(ge=0, le=10)] = 0.5
    """How long the server may wait for a newer one [s]."""
    rgb: RgbEncoding = "raw"
    depth: DepthEncoding = "raw"
    annotations: bool = False
    pixels: Literal["send", "keep"] = "send"
    """Whether the images come with the frame, or stay with the server until they are asked for."""


class PixelsRequest(_Entry):
    """Header of a request for the images of a frame that the server keeps."""

    number: Annotated[int, Field(ge=1)]
    rgb: RgbEncoding = "raw"
    depth: DepthEncoding = "raw"


class Identity(_Entry):
    """Header that says what camera this is."""

    model: str
    firmware: str = ""
    serial: str = ""
    rate: Annotated[float, Field(gt=0, le=1000)]
    """Frames a second, at most [Hz]."""


class NothingNew(_Entry):
    """Header that says there is no newer frame."""

    number: _Count
    now: _Number


class Gone(_Entry):
    """Header that says a frame is no longer kept."""

    number: _Count
    oldest: _Count
    """Of the frames that are still kept; 0 if there are none."""


class Failure(_Entry):
    """Header that says why a request was not served."""

    message: str


class _Intrinsics(_Entry):
    width: _Side
    height: _Side
    fx: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    fy: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    cx: _Number
    cy: _Number


class _Image(_Entry):
    encoding: str
    size: _Count


class _Rgb(_Image):
    encoding: RgbEncoding


class _Depth(_Image):
    encoding: DepthEncoding


class _Thing(_Entry):
    id: str
    category: str
    colour: str | None
    is_furniture: bool
    box: _Edges
    full_box: _Edges
    visible_fraction: _Number
    visible_area: _Number
    distance: _Number

    def value(self) -> Annotation:
        return Annotation(
            self.id,
            self.category,
            self.colour,
            self.is_furniture,
            Box(*self.box),
            Box(*self.full_box),
            self.visible_fraction,
            self.visible_area,
            self.distance,
        )


class _FrameHeader(_Entry):
    number: Annotated[int, Field(ge=1)]
    stamp: _Number
    now: _Number
    intrinsics: _Intrinsics
    rgb: _Rgb
    depth: _Depth
    annotations: list[_Thing] | None = None

    @model_validator(mode="after")
    def _raw_sizes_fit(self) -> _FrameHeader:
        if self.rgb.size == self.depth.size == 0:  # the images are kept
            return self
        pixels = self.intrinsics.width * self.intrinsics.height
        for name, image, size in (("rgb", self.rgb, 3 * pixels), ("depth", self.depth, 2 * pixels)):
            if image.encoding == "raw" and image.size != size:
                raise ValueError(f"{name}: {image.size} bytes (raw it has {size})")
        return self


@dataclass(frozen=True, slots=True)
class WireFrame:
    """A frame as it travels; stamps are on the server's clock."""

    number: int
    """Counts the server's frames from 1."""
    stamp: float
    """Time of capture [s]."""
    now: float
    """Time of sending [s]."""
    intrinsics: CameraIntrinsics
    rgb: WireImage
    depth: WireImage
    annotations: tuple[Annotation, ...] | None = None

    @property
    def is_kept(self) -> bool:
        """Whether the images stayed with the server."""
        return not self.rgb.data and not self.depth.data


HeaderT = TypeVar("HeaderT", bound=BaseModel)


def read_header(model: type[HeaderT], message: Message) -> HeaderT:
    """Return a message's header, checked.

    Raises:
        WireError: It does not say what it should.
    """
    try:
        return model.model_validate(message.header)
    except ValidationError as error:
        fault = error.errors()[0]
        path = ".".join(map(str, fault["loc"]))
        raise WireError(f"{path}: {fault['msg']}" if path else fault["msg"]) from None


def header_message(kind: Kind, header: BaseModel) -> Message:
    """Return the message that has only this header."""
    return Message(kind, header.model_dump())


def frame_message(frame: WireFrame) -> Message:
    """Return the message that brings a frame."""
    header: dict[str, Any] = {
        "number": frame.number,
        "stamp": frame.stamp,
        "now": frame.now,
        "intrinsics": {name: getattr(frame.intrinsics, name) for name in ("width", "height", "fx", "fy", "cx", "cy")},
        "rgb": {"encoding": frame.rgb.encoding, "size": len(frame.rgb.data)},
        "depth": {"encoding": frame.depth.encoding, "size": len(frame.depth.data)},
    }
    if frame.annotations is not None:
        header["annotations"] = [annotation._asdict() for annotation in frame.annotations]
    return Message(Kind.FRAME, header, frame.rgb.data + frame.depth.data)


def read_frame(message: Message) -> WireFrame:
    """Return the frame that a message brings.

    Raises:
        WireError: It does not say what it should.
    """
    header = read_header(_FrameHeader, message)
    split = header.rgb.size
    if split + header.depth.size != len(message.body):
        raise WireError(f"body: {len(message.body)} bytes (rgb and depth have {split} + {header.depth.size})")
    return WireFrame(
        header.number,
        header.stamp,
        header.now,
        CameraIntrinsics(**header.intrinsics.model_dump()),
        WireImage(header.rgb.encoding, message.body[:split]),
        WireImage(header.depth.encoding, message.body[split:]),
        None if header.annotations is None else tuple(thing.value() for thing in header.annotations),
    )
