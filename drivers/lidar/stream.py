"""A sensor that measures: everything between opening the line and closing it."""

from __future__ import annotations

from collections.abc import Callable

from drivers.lidar.codec import Answer, Request
from drivers.lidar.layout import disagreements, lay_out
from drivers.lidar.session import Session
from drivers.lidar.settings import ScipSettings
from drivers.lidar.startup import NamePlate, identify, switch_on, synchronise, wake
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import LaserScan


class ScanStream:
    """Scans from one connection to a sensor."""

    def __init__(self, settings: ScipSettings, context: DeviceContext, cancelled: Callable[[], bool]) -> None:
        """Connect, find out who answers, set the clock, switch the laser on and ask for scans without end.

        Args:
            settings: Of the device.
            context: Of the device.
            cancelled: Whether to give up; asked while waiting.

        Raises:
            DeviceError: It cannot be done: one line with the remedy.
            InputError: A setting does not suit the sensor.
        """
        self._clock, self._time_offset = context.clock, settings.time_offset
        self._session = Session(settings.port, settings.baud, context.where, cancelled)
        try:
            wake(self._session)
            self.name_plate: NamePlate = identify(self._session)
            parameters, spec = self.name_plate.parameters, context.spec.lidar
            self.layout = lay_out(parameters, spec, settings, context.where)
            self.sensor_clock = synchronise(self._session, self._clock)
            faults = switch_on(self._session, high_sensitivity=settings.high_sensitivity)
            self._begin()
        except BaseException:
            self._session.close()
            raise
        self.problems = faults + disagreements(parameters, self.layout, spec)
        """What was found wrong, one line each."""
        self.period = 60 / parameters.scan * (settings.skip + 1)
        """Between two scans [s]."""
        self.refusal = ""
        """Last status, other than that of a scan, that came in the stream."""

    @property
    def broken(self) -> int:
        """Answers so far whose checksum or length was wrong."""
        return self._session.decoder.broken

    def scans(self, timeout: float) -> list[tuple[LaserScan, float]]:
        """Return the scans that are complete now and when they arrived, after waiting up to ``timeout`` [s] for bytes.

        Raises:
            DeviceError: The line is broken, or ``cancelled`` says so.
        """
        answers = self._session.receive(timeout)
        arrival = self._clock.now()
        return [(scan, arrival) for answer in answers if (scan := self._scan(answer, arrival)) is not None]

    def close(self) -> None:
        """Switch the laser off and close the line; never raises."""
        self._session.close()

    def _begin(self) -> None:
        parameters = self.layout.request.line.decode("ascii")[2:]
        status = self._session.ask(Request(self.layout.request.command, parameters), timeout=1.0).status
        if status != "00":
            raise DeviceError(f"{self._session.place}: will not scan, status {status} (switch it off and on again)")

    def _scan(self, answer: Answer, arrival: float) -> LaserScan | None:
        request = self.layout.request
        if answer.echo != request.line:
            return None
        if answer.status != "99" or answer.readings is None or len(answer.readings.ranges) != request.beams:
            self.refusal = answer.status
            return None
        stamp = self.sensor_clock.stamp(answer.readings.clock, arrival) + self._time_offset
        return self.layout.scan(answer.readings.ranges, stamp)
