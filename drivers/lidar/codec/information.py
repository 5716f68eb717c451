"""What a sensor says of itself: the answers to VV, PP and II."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields

from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.lines import seal_information


def encode_information(values: Mapping[str, object]) -> bytes:
    """Return lines ``NAME:value;`` with check characters and line feeds."""
    return b"".join(seal_information(f"{name}:{value}".encode("ascii")) + b"\n" for name, value in values.items())


def decode_information(lines: Iterable[bytes]) -> dict[str, str]:
    """Return the values by name; lines without a name are left out."""
    pairs = (line.decode("latin-1").partition(":") for line in lines)
    return {name.strip(): value.strip() for name, colon, value in pairs if colon}


@dataclass(frozen=True, slots=True)
class Parameters:
    """A sensor's geometry, which PP tells."""

    model: str
    dmin: int
    """Least range [mm]."""
    dmax: int
    """Greatest range [mm]."""
    ares: int
    """Steps of a full turn."""
    amin: int
    """First step that is measured."""
    amax: int
    """Last step that is measured."""
    afrt: int
    """Step that looks straight ahead."""
    scan: int
    """Turns a minute."""

    @classmethod
    def of(cls, information: Mapping[str, str]) -> Parameters:
        """Return the parameters in an answer to PP.

        Raises:
            CodecError: One is missing, is no number, or makes no sense.
        """
        names = [field.name for field in fields(cls)][1:]
        try:
            found = cls(information["MODL"], *(int(information[name.upper()]) for name in names))
        except KeyError as error:
            raise CodecError(f"its parameters lack {error.args[0]}") from error
        except ValueError as error:
            raise CodecError(f"a parameter is no number: {dict(information)}") from error
        if found.ares < 1 or found.scan < 1 or not 0 <= found.amin <= found.amax <= 9999:
            raise CodecError(f"its parameters make no sense: {found}")
        return found

    @property
    def information(self) -> dict[str, object]:
        """The values by their names in the answer to PP."""
        names = [field.name for field in fields(self)][1:]
        return {"MODL": self.model, **{name.upper(): getattr(self, name) for name in names}}
