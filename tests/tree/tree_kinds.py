"""Behaviours, a clock and a loader for tests of trees."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from zavis_bt.tree import Behaviour, In, Out, Registry, Status, Tree, load_tree
from zavis_bt.types import Candidate, Pose2D, Viewpoint


class ManualClock:
    """Time that passes only when somebody waits for it."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        self.time = max(self.time, stamp)


class Log:
    """What happened, in order."""

    def __init__(self) -> None:
        self.events: list[str] = []


class Act(Behaviour):
    """Run for some ticks, then end; note start and stop in the log."""

    ticks = In(int, "ticks until it ends", default=1, ge=1)
    ends = In(str, "how", default="success", choices=("success", "failure"))
    label = In(str, "name in the log", default="")

    def setup(self, *, log: Log) -> None:
        self._log = log

    def initialise(self) -> None:
        self._count = 0
        self._log.events.append(f"start {self.label or self.name}")

    def update(self) -> Status:
        self._count += 1
        if self._count < self.ticks:
            return self.running(f"tick {self._count}")
        return self.succeed("done") if self.ends == "success" else self.fail(f"{self.label or self.name} failed")

    def terminate(self, new_status: Status) -> None:
        self._log.events.append(f"stop {self.label or self.name} {new_status.name}")


class Flag(Behaviour):
    """A condition that a test switches in the resource `flags`."""

    name_of = In(str, "which flag")

    def setup(self, *, flags: dict[str, bool]) -> None:
        self._flags = flags

    def update(self) -> Status:
        return self.succeed() if self._flags[self.name_of] else self.fail(f"{self.name_of} is down")


class Raise(Behaviour):
    """A bug."""

    where = In(str, "which method raises", default="update")

    def initialise(self) -> None:
        if self.where == "initialise":
            raise ValueError("broken")

    def update(self) -> Status:
        if self.where == "update":
            raise ValueError("broken")
        return self.running()

    def terminate(self, new_status: Status) -> None:
        if self.where == "terminate":
            raise ValueError("broken")


class Produce(Behaviour):
    """Give numbers."""

    count = In(int, "how many", default=3)
    numbers = Out(list[int], "0, 1, …", unit="m")
    total = Out(int, "their sum", unit="m")

    def update(self) -> Status:
        self.numbers = list(range(self.count))
        self.total = sum(self.numbers)
        return self.succeed()


class Consume(Behaviour):
    """Take a number; succeeds from `wanted` on."""

    value = In(float, "a number")
    wanted = In(float, "smallest accepted one", default=0.0)
    seen: list[float]

    def __init__(self, name: str = "", **inputs: Any) -> None:
        super().__init__(name, **inputs)
        self.seen = []

    def update(self) -> Status:
        self.seen.append(self.value)
        return self.succeed() if self.value >= self.wanted else self.fail(f"{self.value:g} is too small")


class EstopReleased(Flag):
    """The emergency stop is not pressed."""

    name_of = In(str, "which flag", default="estop")


class BatteryAbove(Behaviour):
    """The battery holds."""

    level = In(float, "state of charge", ge=0.0, le=1.0)

    def update(self) -> Status:
        return self.succeed()


class Scan(Behaviour):
    """Look around."""

    turns = In(int, "turns", default=1, ge=1)

    def update(self) -> Status:
        return self.succeed()


class GenerateWaypoints(Behaviour):
    """Propose viewpoints."""

    target = In(str, "what is looked for")
    waypoints = Out(list[Viewpoint], "in visiting order")

    def update(self) -> Status:
        poses = [Pose2D(float(index), 0.0) for index in range(3)]
        self.waypoints = [Viewpoint(pose, (pose.x, 1.0, 0.5), 0.2, 0, "desk") for pose in poses]
        return self.succeed()


class Navigate(Act):
    """Drive."""

    goal = In(Pose2D | Viewpoint, "where to stand")
    tolerance = In(float, "accepted distance", unit="m", default=0.3, ge=0.05, le=2.0)
    path_length = Out(float, "driven", unit="m")


class Look(Behaviour):
    """Aim the camera."""

    at = In(Viewpoint, "at what")

    def update(self) -> Status:
        return self.succeed()


class Detect(Behaviour):
    """Find candidates."""

    target = In(str, "what is looked for")
    candidates = Out(list[Candidate], "best first")

    def update(self) -> Status:
        self.candidates = []
        return self.succeed()


class Confirm(Behaviour):
    """Ask."""

    candidates = In(list[Candidate], "what to show")

    def update(self) -> Status:
        return self.fail("turned down")


class GoToFrontier(Scan):
    """Widen the map."""


class GoHome(Scan):
    """Drive to the dock."""


class BackUp(Behaviour):
    """Drive back."""

    distance = In(float, "how far", unit="m", gt=0.0)

    def update(self) -> Status:
        return self.succeed()


KINDS: list[type[Behaviour]] = [
    *(Act, Flag, Raise, Produce, Consume, EstopReleased, BatteryAbove, Scan, GenerateWaypoints),
    *(Navigate, Look, Detect, Confirm, GoToFrontier, GoHome, BackUp),
]
REGISTRY = Registry(KINDS)

SEARCH = """\
# yaml-language-server: $schema=tree.schema.json
bt: 1                                          # format version, required
include: [safety.yaml]                         # its trees become kinds: safety.dock, safety.estop_clear
root: search
trees:
  search:
    params: {target: str, min_battery: {type: float, default: 0.2}}   # load-time constants
    do:
      guard:                                   # conditions are checked at every tick
        while:
          - safety.estop_clear
          - battery_above: {level: $min_battery}
        do: {mission: {target: $target}}
        else: {safety.dock: {reason: guard}}   # starts after `do` has been stopped
  mission:
    in: {target: str}
    do:
      sequence:
        - scan: {turns: 1}
          name: initial scan
          timeout: 60
        - selector:
            - sequence:
                - generate_waypoints: {target: $target}
                  save: {waypoints: waypoints} # output port -> variable of this tree
                - for_each: {items: $waypoints, as: waypoint, until: success}
                  do: {visit: {goal: $waypoint, target: $target}}
            - sequence:                        # nothing confirmed: widen the map, next round
                - go_to_frontier
                - scan: {turns: 1}
                - fail: searched
          retry: 20                            # whole rounds, until one succeeds
  visit:
    in: {goal: Viewpoint, target: str}
    do:
      sequence:
        - navigate: {goal: $goal, tolerance: 0.3}
          timeout: 90                          # per attempt: retry(timeout(navigate))
          retry: 3
          recover: {back_up: {distance: 0.3}}  # runs between attempts
        - look: {at: $goal}
        - detect: {target: $target}
          save: {candidates: found}
        - confirm: {candidates: $found}        # a person answers
          timeout: 120
"""

SAFETY = """\
bt: 1
trees:
  estop_clear:
    do: estop_released
  dock:
    params: {reason: str}
    do:
      sequence:
        - go_home
        - succeed: $reason
"""


class Bench:
    """A loaded tree with everything it needs."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.clock = ManualClock()
        self.log = Log()
        self.flags: dict[str, bool] = {"estop": True, "a": True, "b": True}
        tree.setup({"clock": self.clock, "log": self.log, "flags": self.flags})

    def tick(self, times: int = 1, step: float = 0.1) -> Status:
        for _ in range(times):
            self.tree.tick()
            self.clock.time += step
        return self.tree.status

    def to_the_end(self, most: int = 200) -> Status:
        for _ in range(most):
            if self.tick() is not Status.RUNNING:
                break
        return self.tree.status


def write(folder: Path, text: str, name: str = "t.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def tree_text(do: str, head: str = "") -> str:
    """Return a file with one tree; `do` is the YAML below ``do:``, indented by six blanks there."""
    body = "\n".join("      " + line for line in do.strip("\n").splitlines())
    return f"bt: 1\nroot: main\n{head}trees:\n  main:\n    do:\n{body}\n"


def bench(folder: Path, do: str, head: str = "", **inputs: Any) -> Bench:
    return Bench(load_tree(write(folder, tree_text(do, head)), REGISTRY, inputs))
