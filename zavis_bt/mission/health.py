"""Whether all devices are heard of and able, tick by tick."""

from __future__ import annotations

from collections.abc import Iterator

from zavis_bt.mission.safety import SafeRobot, SafetySettings, frame_timeout, scan_timeout
from zavis_bt.protocols import Journal

_RETRY = 0.5  # so long a device that refused a command is left alone [s]
_AGAIN = 1.0  # a fault that comes back within this time is the same one [s]


class Health:
    """Watches base, LiDAR, pan-tilt unit and camera.

    Tells the journal ``fault`` (device, reason) when one fails and ``recovered`` (devices, seconds) when all are well
    again.
    """

    def __init__(self, robot: SafeRobot, settings: SafetySettings, journal: Journal) -> None:
        """Take the robot; nothing is read yet."""
        self._robot, self._settings, self._journal = robot, settings, journal
        self._scan_timeout = scan_timeout(settings, robot.spec.lidar)
        self._frame_timeout = frame_timeout(settings, robot.spec.camera)
        self.faults: dict[str, str] = {}
        """Reason by device; empty while all are well."""
        self._failed: set[str] = set()
        self._since = self._well_at = float("-inf")
        self._retry_at: dict[str, float] = {}

    @property
    def well(self) -> bool:
        """Whether all devices were well at the latest check."""
        return not self.faults

    def check(self, now: float) -> bool:
        """Look at all devices, after `SafeBase.read`; return whether all are well."""
        faults = dict(self._look(now))
        if faults and not self.faults and now - self._well_at > _AGAIN:
            self._since = now
        for device in faults.keys() - self.faults.keys():
            self._failed.add(device)
            self._journal.record("fault", device=device, reason=faults[device])
        if self.faults and not faults:
            self._journal.record("recovered", devices=sorted(self._failed), seconds=now - self._since)
            self._failed.clear()
            self._retry_at.clear()
        if not faults and self.faults:
            self._well_at = now
        self.faults = faults
        return not faults

    def given_up(self, now: float) -> str:
        """Return why the mission cannot go on, in plain words; empty while there is hope."""
        if self.well or now - self._since < self._settings.device_timeout:
            return ""
        device, reason = next(iter(self.faults.items()))
        return f"{device}: {reason}"

    def _look(self, now: float) -> Iterator[tuple[str, str]]:
        settings, base, unit = self._settings, self._robot.base, self._robot.pan_tilt
        state, joints, scan = base.latest, unit.state(), base.scan
        frame = self._robot.camera.frame()
        reasons = {
            "base": state.fault
            or _old("word from it", now, state.stamp, settings.base_timeout)
            or self._refused("base", base.trouble, now),
            "lidar": _old("scan", now, None if scan is None else scan.stamp, self._scan_timeout),
            "pan_tilt": joints.fault
            or _old("word from it", now, joints.stamp, settings.pan_tilt_timeout)
            or self._refused("pan_tilt", unit.trouble, now),
            "camera": _old("frame", now, None if frame is None else frame.stamp, self._frame_timeout),
        }
        return ((device, reason) for device, reason in reasons.items() if reason)

    def _refused(self, device: str, trouble: str, now: float) -> str:
        """Return what a device raised at a command, for a while: then it may try again."""
        if not trouble:
            return ""
        retry_at = self._retry_at.setdefault(device, now + _RETRY)
        return trouble.removeprefix(f"{device}: ") if now < retry_at else ""


def _old(what: str, now: float, stamp: float | None, limit: float) -> str:
    if stamp is None:
        return f"no {what} yet (is it powered and connected?)"
    age = now - stamp
    return f"no {what} for {age:.{0 if age >= 1 else 1}f} s (is it powered and connected?)" if age > limit else ""
