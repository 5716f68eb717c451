"""The LiDAR as a mission's device."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping
from typing import Any

from drivers.lidar.settings import ScipSettings
from drivers.lidar.stream import ScanStream
from drivers.lidar.tally import Tally
from drivers.settings import read_settings
from zavis_bt.errors import DeviceError, ZavisError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import DeviceReport, LaserScan

_READ = 0.1  # [s]
_SILENCE = 0.5  # without a scan [s]
_SPIN_UP = 2.0  # until the first scan [s]
_BACK_OFF = (0.2, 2.0)  # first and longest pause between attempts to connect [s]
_BROKEN_SHARE = 0.01  # of broken scans, from which on it is a problem


def open_lidar(settings: Mapping[str, Any], context: DeviceContext) -> ScipLidar:
    """Open a LiDAR that speaks SCIP 2.0.

    Args:
        settings: As `ScipSettings` has them.
        context: Robot, clock and place in the robot file.

    Raises:
        InputError: A setting is wrong.
        DeviceError: The sensor cannot be opened.
    """
    return ScipLidar(read_settings(ScipSettings, settings, context.where), context)


class ScipLidar:
    """A LiDAR that is listened to by its own thread, and connected to again whenever it falls silent."""

    def __init__(self, settings: ScipSettings, context: DeviceContext) -> None:
        """Connect and start to scan.

        Raises:
            InputError: A setting does not suit the sensor.
            DeviceError: The sensor cannot be opened.
        """
        self._settings, self._context = settings, context
        self._closing = threading.Event()
        self._tally = Tally()
        self._fault = ""
        self._pause = _BACK_OFF[0]
        self._scan: LaserScan | None = None
        self._stream = self._connect()
        self._thread = threading.Thread(target=self._run, name="lidar", daemon=True)
        self._thread.start()

    def scan(self) -> LaserScan | None:
        """Return the latest scan, None before the first; while the sensor is silent it stays, and its stamp with it."""
        return self._scan

    def report(self) -> DeviceReport:
        """Return its name plate, its figures so far and what is wrong with it."""
        stream, layout = self._stream, self._stream.layout
        version, model = stream.name_plate.version, stream.name_plate.parameters.model
        now = self._context.clock.now()
        figures = {
            **self._tally.figures(now),
            "clock": "synchronised" if stream.sensor_clock.synchronised else "by arrival only",
            "beams": f"{layout.request.beams} of {math.degrees(layout.angle_increment):.4g}°",
            "range": f"{layout.range_min:g} to {layout.range_max:g} m",
        }
        problems = (*self._link_problems(now), *stream.problems)
        return DeviceReport(model, version.get("FIRM", ""), version.get("SERI", ""), figures, problems)

    def close(self) -> None:
        """Switch the laser off and release the line; never raises, may be called twice."""
        self._closing.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=3.0)

    def _run(self) -> None:
        connected = True
        while connected:
            try:
                self._listen()
            except DeviceError as error:
                self._fault = str(error)
            finally:
                self._stream.close()
            connected = self._reconnect()

    def _listen(self) -> None:
        """Take scans until the device is closed or falls silent."""
        stream, now = self._stream, self._context.clock.now
        heard, patience = now(), _SPIN_UP
        while not self._closing.is_set():
            broken = stream.broken
            for scan, arrival in stream.scans(_READ):
                self._scan, self._fault, self._pause = scan, "", _BACK_OFF[0]
                self._tally.count(arrival, scan.stamp)
                heard, patience = arrival, max(_SILENCE, 3 * stream.period)
            self._tally.broken += stream.broken - broken
            if now() - heard > patience:
                status = f", status {stream.refusal}" if stream.refusal else ""
                raise DeviceError(
                    f"{self._place}: no sound scan for {patience:.1f} s{status} (see its cable and power)"
                )

    def _reconnect(self) -> bool:
        """Try to connect, with growing pauses, until it succeeds; return False if the device was closed before."""
        while not self._closing.wait(self._pause):
            self._pause = min(2 * self._pause, _BACK_OFF[1])
            try:
                self._stream = self._connect()
            except ZavisError as error:
                self._fault = str(error)
                continue
            self._tally.begin_anew()
            self._tally.reconnects += 1
            return True
        return False

    def _connect(self) -> ScanStream:
        return ScanStream(self._settings, self._context, self._closing.is_set)

    @property
    def _place(self) -> str:
        return f"{self._context.where}: {self._settings.port}"

    def _link_problems(self, now: float) -> list[str]:
        problems = [self._fault] if self._fault else []
        tally, stream = self._tally, self._stream
        rate = tally.rate(now)
        if rate and rate < 0.8 / stream.period:
            problems.append(
                f"scans arrive at {rate:.1f} Hz instead of {1 / stream.period:.1f} Hz (is the line fast enough? "
                "raise 'cluster' or 'skip')"
            )
        if tally.broken > _BROKEN_SHARE * (tally.scans + tally.broken):
            problems.append(f"{tally.broken} answers came with wrong checksums (see its cable)")
        return problems
