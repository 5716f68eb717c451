"""The scene: what there is to draw of a mission, and what of it has changed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from zavis_bt.recording.canvas import known_bounds
from zavis_bt.types import FloatArray, MissionResult, Observed, RobotSpec
from zavis_bt.viz import pieces, robot_model, shapes
from zavis_bt.viz.ground import floor_image, walls
from zavis_bt.viz.link import Message
from zavis_bt.viz.panel import facts, tree_rows, verdict

ROOT = "/zavis"
_SLOW = 0.5  # least time between updates of what is costly and changes all the time [s]


def pack(command: Mapping[str, Any]) -> bytes:
    """Return a command as the page reads it."""
    import umsgpack  # meshcat's message format

    return bytes(umsgpack.packb(command))


class Scene:
    """Turns what a mission shows into messages for the page, each only when there is news."""

    def __init__(self) -> None:
        """Nothing was drawn yet."""
        self._drawn: dict[str, object] = {}
        self._parts: dict[str, set[str]] = {}
        self._slow_due = 0.0

    def opening(self, spec: RobotSpec, title: str) -> Iterator[Message]:
        """Yield what is drawn once: an empty stage and the robot."""
        yield Message(f"{ROOT}#delete", pack({"type": "delete", "path": ROOT}))
        yield self._words("title", {"title": title or spec.name})
        edges, sides = robot_model.frustum(spec.camera)
        yield self._object("robot/body", shapes.mesh(robot_model.body(spec)))
        yield self._object("robot/camera/housing", shapes.mesh(robot_model.camera(spec.camera)))
        yield self._object("robot/camera/edges", shapes.lines(edges, (214, 138, 12)))
        yield self._object("robot/camera/view", shapes.mesh(sides, opacity=0.16))
        mount = robot_model.base_transform(spec.lidar.mount)
        mount[2, 3] = spec.lidar.height
        yield self._transform("robot/lidar", mount)

    def news(self, mission: Observed, now: float, *, everything: bool = False) -> Iterator[Message]:
        """Yield what changed since the last call.

        Args:
            mission: What to show.
            now: Any steady time, which paces what is costly [s].
            everything: Whether to disregard that pace.
        """
        slow = everything or now >= self._slow_due
        if slow:
            self._slow_due = now + _SLOW
            yield from self._ground(mission)
            yield from self._trajectory(mission.trajectory)
            yield self._words("facts", {"facts": facts(mission)})
        yield from self._robot(mission)
        yield from self._scan(mission)
        path = mission.path
        yield from self._changed("path", path, lambda: None if path is None else pieces.path(path))
        yield from self._group("landmarks", pieces.landmarks(mission.landmarks))
        yield from self._group("viewpoints", pieces.viewpoints(mission.visited, mission.viewpoints))
        yield from self._group("candidates", pieces.candidates(mission.candidates, mission.found))
        nodes = mission.nodes
        if self._drawn.get("nodes") != nodes:
            self._drawn["nodes"] = nodes
            yield self._words("tree", {"nodes": tree_rows(nodes)})

    def closing(self, result: MissionResult) -> Iterator[Message]:
        """Yield how the mission ended."""
        yield self._words("verdict", verdict(result))

    # -- parts ---------------------------------------------------------------------------------------------------

    def _ground(self, mission: Observed) -> Iterator[Message]:
        grid = mission.grid
        if grid.states.size == 0 or self._drawn.get("grid") == (grid.version, grid.shape, grid.origin):
            return
        self._drawn["grid"] = (grid.version, grid.shape, grid.origin)
        high = (grid.origin[0] + grid.shape[1] * grid.resolution, grid.origin[1] + grid.shape[0] * grid.resolution)
        yield self._object("map/floor", shapes.picture(floor_image(grid), grid.origin, high, 0.0))
        solid = walls(grid)
        if solid is not None:
            yield self._object("map/walls", shapes.mesh(solid))
        bounds = known_bounds(grid, np.empty((0, 2)), 0.2)
        if self._drawn.get("bounds") != bounds:
            self._drawn["bounds"] = bounds
            yield self._words("view", {"bounds": bounds})

    def _robot(self, mission: Observed) -> Iterator[Message]:
        pose, joints = mission.base.pose, mission.pan_tilt
        if self._drawn.get("pose") != pose:
            self._drawn["pose"] = pose
            yield self._transform("robot", robot_model.base_transform(pose))
        if self._drawn.get("joints") != (joints.pan, joints.tilt):
            self._drawn["joints"] = (joints.pan, joints.tilt)
            transform = robot_model.camera_transform(mission.robot.camera, joints.pan, joints.tilt)
            yield self._transform("robot/camera", transform)

    def _scan(self, mission: Observed) -> Iterator[Message]:
        scan = mission.scan
        stamp = None if scan is None else scan.stamp
        if self._drawn.get("scan", "none yet") == stamp:
            return
        self._drawn["scan"] = stamp
        for name, drawn in pieces.scan(scan).items():
            yield from self._put(f"robot/lidar/{name}", drawn)

    def _trajectory(self, points: FloatArray) -> Iterator[Message]:
        if self._drawn.get("trajectory", 0) != len(points):
            self._drawn["trajectory"] = len(points)
            yield from self._put("trajectory", pieces.trajectory(points))

    # -- commands ------------------------------------------------------------------------------------------------

    def _changed(self, name: str, value: object, draw: Callable[[], shapes.Json | None]) -> Iterator[Message]:
        """Draw a part anew if the value it shows is not the very one last shown."""
        if self._drawn.get(name) is not value:
            self._drawn[name] = value
            yield from self._put(name, draw())

    def _group(self, name: str, members: Iterable[tuple[str, object, pieces.Piece]]) -> Iterator[Message]:
        """Draw the members of a group that changed, and remove those that are no longer there."""
        present = set()
        for key, value, piece in members:
            present.add(key)
            slot = f"{name}/{key}"
            if self._drawn.get(slot) != value:
                self._drawn[slot] = value
                for part, drawn in piece().items():
                    yield from self._put(f"{slot}/{part}", drawn)
        for key in self._parts.get(name, set()) - present:
            self._drawn.pop(f"{name}/{key}", None)
            yield self._delete(f"{name}/{key}")
        self._parts[name] = present

    def _put(self, name: str, drawn: shapes.Json | None) -> Iterator[Message]:
        yield self._delete(name) if drawn is None else self._object(name, drawn)

    def _object(self, name: str, drawn: shapes.Json) -> Message:
        path = f"{ROOT}/{name}"
        return Message(f"{path}#object", pack({"type": "set_object", "path": path, "object": drawn}))

    def _transform(self, name: str, matrix: FloatArray) -> Message:
        path = f"{ROOT}/{name}"
        command = {"type": "set_transform", "path": path, "matrix": matrix.T.ravel().tolist()}
        return Message(f"{path}#transform", pack(command))

    def _delete(self, name: str) -> Message:
        path = f"{ROOT}/{name}"
        return Message(f"{path}#delete", pack({"type": "delete", "path": path}))

    def _words(self, kind: str, content: Mapping[str, Any]) -> Message:
        return Message(f"{ROOT}/words#{kind}", pack({"type": kind, "json": json.dumps(content)}))
