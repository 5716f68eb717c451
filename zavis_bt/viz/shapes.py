"""Objects of the three.js scene format, which the meshcat page understands."""

from __future__ import annotations

import base64
import uuid
from typing import Any

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FloatArray
from zavis_bt.viz.solids import Colour, Solid

Json = dict[str, Any]
_FLOAT32, _UINT32 = 0x17, 0x16  # message pack extension codes of typed arrays
_BOTH_SIDES = 2
_NEAREST, _LINEAR, _MIPMAPS = 1003, 1006, 1008


def mesh(solid: Solid, *, opacity: float = 1.0) -> Json:
    """Return a mesh in the colours of its vertices, without lighting."""
    geometry = _buffers({"position": solid.vertices, "color": solid.colours}, solid.faces)
    return _object("Mesh", _material("MeshBasicMaterial", opacity, vertexColors=True), geometry)


def lines(points: FloatArray, colour: Colour) -> Json:
    """Return line segments between consecutive pairs of (2n, 3) points [m]."""
    geometry = _buffers({"position": np.asarray(points, dtype=np.float32)})
    return _object("LineSegments", _material("LineBasicMaterial", 1.0, color=_packed(colour)), geometry)


def dots(points: FloatArray, colour: Colour, size: float) -> Json:
    """Return (n, 3) points [m] drawn as squares of a size [m]."""
    geometry = _buffers({"position": np.asarray(points, dtype=np.float32)})
    return _object("Points", _material("PointsMaterial", 1.0, color=_packed(colour), size=size), geometry)


def picture(png: bytes, low: tuple[float, float], high: tuple[float, float], height: float) -> Json:
    """Return an image lying between two corners of the map [m], its top edge to the north."""
    geometry = {
        "uuid": _id(),
        "type": "PlaneGeometry",
        "width": high[0] - low[0],
        "height": high[1] - low[1],
    }
    texture, images = _texture(png, _NEAREST)
    material = _material("MeshBasicMaterial", 1.0, map=texture["uuid"], transparent=True, depthWrite=False)
    result = _object("Mesh", material, geometry)
    centre = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, height)
    return _placed(result, np.ones(3), centre) | {"textures": [texture], "images": images}


def sprite(png: bytes, position: tuple[float, float, float], aspect: float, share: float) -> Json:
    """Return an image that always faces the viewer, in front of everything.

    Args:
        png: The image.
        position: Its middle [m].
        aspect: Width by height.
        share: Height as a share of the distance to the viewer: the size on the screen never changes.
    """
    texture, images = _texture(png, _LINEAR)
    material = _material(
        "SpriteMaterial",
        1.0,
        map=texture["uuid"],
        transparent=True,
        sizeAttenuation=False,
        depthTest=False,
        depthWrite=False,
    )
    result = _object("Sprite", material)
    result["object"]["renderOrder"] = 10
    return _placed(result, np.array([aspect * share, share, 1.0]), position) | {"textures": [texture], "images": images}


def _id() -> str:
    return str(uuid.uuid4())


def _packed(colour: Colour) -> int:
    return colour[0] << 16 | colour[1] << 8 | colour[2]


def _material(kind: str, opacity: float, **more: Any) -> Json:
    base = {"uuid": _id(), "type": kind, "color": 0xFFFFFF, "side": _BOTH_SIDES, "opacity": opacity}
    return base | {"transparent": opacity < 1, "depthWrite": opacity == 1} | more


def _object(kind: str, material: Json, geometry: Json | None = None) -> Json:
    body: Json = {"uuid": _id(), "type": kind, "material": material["uuid"]}
    if geometry is not None:
        body["geometry"] = geometry["uuid"]
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [geometry] if geometry is not None else [],
        "materials": [material],
        "object": body,
    }


def _placed(result: Json, scale: NDArray[np.float64], position: tuple[float, float, float]) -> Json:
    matrix = np.diag([*scale, 1.0])
    matrix[:3, 3] = position
    result["object"]["matrix"] = matrix.T.ravel().tolist()
    return result


def _texture(png: bytes, magnified: int) -> tuple[Json, list[Json]]:
    image = {"uuid": _id(), "url": "data:image/png;base64," + base64.b64encode(png).decode()}
    texture = {"uuid": _id(), "image": image["uuid"], "magFilter": magnified, "minFilter": _MIPMAPS, "anisotropy": 4}
    return texture, [image]


def _buffers(attributes: dict[str, NDArray[np.float32]], faces: NDArray[np.uint32] | None = None) -> Json:
    data: Json = {"attributes": {name: _array(values) for name, values in attributes.items()}}
    if faces is not None:
        data["index"] = _array(faces) | {"itemSize": 1}
    return {"uuid": _id(), "type": "BufferGeometry", "data": data}


def _array(values: NDArray[np.float32] | NDArray[np.uint32]) -> Json:
    from umsgpack import Ext  # meshcat's message format

    floats = values.dtype == np.float32
    return {
        "itemSize": 3,
        "type": "Float32Array" if floats else "Uint32Array",
        "array": Ext(_FLOAT32 if floats else _UINT32, np.ascontiguousarray(values).tobytes()),
        "normalized": False,
    }
