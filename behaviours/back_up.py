"""BackUp: reverse a little, to get free."""

from __future__ import annotations

from zavis_bt.planning import Navigator
from zavis_bt.protocols import Clock, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Twist2D


class BackUp(Behaviour):
    """Reverse straight, as far as the map says it is free.

    Succeeds after ``distance``. Fails with reason ``no room`` if less than half of it is free, or ``stuck`` if the
    base does not get there in four times the time it should take.
    """

    distance = In(float, "how far", unit="m", default=0.3, gt=0.0, le=2.0)
    speed = In(float, "how fast", unit="m/s", default=0.15, gt=0.0, le=0.5)
    moved = Out(float, "how far it went", unit="m")

    def setup(self, *, robot: Robot, navigator: Navigator, clock: Clock) -> None:
        """Take the resources."""
        self._robot, self._navigator, self._clock = robot, navigator, clock

    def initialise(self) -> None:
        """Note the start."""
        self._start = self._robot.base.state().pose
        self._goal = min(self.distance, self._navigator.free_behind(self._start, self.distance))
        self._deadline = self._clock.now() + 4 * self.distance / self.speed

    def update(self) -> Status:
        """Reverse."""
        self.moved = self._start.distance(self._robot.base.state().pose)
        if self._goal < self.distance / 2:
            return self.fail("no room")
        if self.moved >= self._goal - 0.02:
            return self.succeed(f"moved back {self.moved:.2f} m")
        if self._clock.now() > self._deadline:
            return self.fail("stuck")
        self._robot.base.command(Twist2D(-self.speed, 0.0))
        return self.running(f"{self._goal - self.moved:.2f} m to go")

    def terminate(self, new_status: Status) -> None:
        """Slow down to rest."""
        self._robot.base.command(Twist2D())
