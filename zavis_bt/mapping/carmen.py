"""LiDAR logs in CARMEN's text format."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.types import LaserScan, Pose2D

NO_RETURN = 80.0
"""Readings from here on are the scanner's codes for "nothing came back" [m]."""


@dataclass(frozen=True, slots=True)
class CarmenScan:
    """A ``FLASER`` line of a log."""

    scan: LaserScan
    """What the front laser measured; a reading without return is +inf."""
    pose: Pose2D
    """The laser in the map: corrected, if the log has been through a SLAM system."""
    odometry: Pose2D
    """The robot by its odometry."""


def read_carmen(path: Path | str) -> Iterator[CarmenScan]:
    """Read the front-laser scans of a log, in their order.

    Args:
        path: A text file, or one compressed by gzip if its name ends in ``.gz``.

    Yields:
        The scans; half a circle, the first beam at −90°.

    Raises:
        InputError: The file is missing or cannot be read, or a line is wrong.
    """
    file = Path(path)
    try:
        with _open(file) as lines:
            for number, line in enumerate(lines, start=1):
                if line.startswith("FLASER"):
                    yield _parse(line.split(), f"{file}:{number}")
    except FileNotFoundError as error:
        raise InputError(f"{file}: no such file") from error
    except (OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
        raise InputError(f"{file}: cannot be read: {error}") from error


def _open(path: Path) -> IO[str]:
    return gzip.open(path, "rt", encoding="ascii") if path.suffix == ".gz" else path.open(encoding="ascii")


def _parse(words: list[str], where: str) -> CarmenScan:
    try:
        count = int(words[1])
        values = np.array(words[2 : count + 9], dtype=np.float64)
    except (IndexError, ValueError) as error:
        raise InputError(f"{where}: not a FLASER line (FLASER n, n ranges, two poses, a time): {error}") from error
    if count < 1 or len(values) < count + 7:
        raise InputError(f"{where}: a FLASER line with {len(values)} numbers for {count} beams ({count + 7} expected)")
    ranges = values[:count].copy()
    ranges[ranges >= NO_RETURN] = np.inf
    x, y, yaw, odom_x, odom_y, odom_yaw, stamp = values[count:].tolist()
    # An odd number of beams includes both ends of the half circle; an even one leaves out the last.
    increment = math.pi / (count - 1 if count % 2 and count > 1 else count)
    scan = LaserScan(ranges, -math.pi / 2, increment, 0.0, NO_RETURN, stamp)
    return CarmenScan(scan, Pose2D(x, y, yaw), Pose2D(odom_x, odom_y, odom_yaw))
