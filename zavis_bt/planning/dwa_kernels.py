"""Rolling out and judging motions of a differential drive. Lengths in cells, as in `grid_kernels`."""

from __future__ import annotations

import math
from typing import NamedTuple

from numba import njit

from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.planning.grid_kernels import Body, body_fits
from zavis_bt.types import FloatArray

_TURN_STEP = 0.02  # between checked headings [rad]


class Rollout(NamedTuple):
    """How motions are rolled out and judged; lengths in cells."""

    horizon: float
    """How far ahead [s]."""
    step: float
    """Longest time between two checked poses [s]."""
    stride: float
    """Farthest that a part of the outline moves between two checked poses."""
    deceleration: float
    """[cells/s²]"""
    angular_deceleration: float
    """[rad/s²]"""
    reaction: float
    """Time in which a command is carried out [s]."""
    heading_weight: float
    """[cells/rad] off the target's bearing at the end."""
    path_weight: float
    """Cells of distance to the target that a cell off the path is worth."""
    clearance_weight: float
    """[cells] where the outline touches an obstacle all the way."""
    comfort: float
    """Clearance beyond the outline from which more is not better."""
    smoothness: float
    """[cells per rad/s] of change in the turn rate."""


@njit(cache=True, nogil=True)
def best_motion(
    field: DistanceField,
    body: Body,
    rollout: Rollout,
    pose: tuple[float, float, float],
    speeds: FloatArray,
    rates: FloatArray,
    now: tuple[float, float],
    target: tuple[float, float],
    path: FloatArray,
    obstacles: FloatArray,
    give: float,
) -> tuple[int, int, float]:
    """Find the best speed [cells/s] and turn rate [rad/s].

    A motion is admissible if the outline stays free until it is carried out and while the base brakes from it. It is
    judged by where its arc leads within the horizon, or before it would collide: near the target, facing it, near the
    path, off obstacles.

    Args:
        field: Distances to mapped obstacles.
        body: The outline.
        rollout: Settings.
        pose: u, v, yaw of the robot.
        speeds: (n,) to choose from.
        rates: (m,) to choose from.
        now: Speed [cells/s] and turn rate [rad/s] at present; they change evenly while the command is carried out.
        target: u, v of where to go next.
        path: (k, 2) u, v of the path from the robot to a little beyond the target.
        obstacles: (j, 2) u, v of obstacles that are not on the map.
        give: How deep these may reach into the outline.

    Returns:
        Indices of speed and turn rate, (-1, -1) if none is admissible, and by how much the motion scores better than
        to stand still.
    """
    still = _judge(field, body, rollout, pose, now, 0.0, 0.0, target, path, obstacles, give, math.inf)
    best, found = math.inf, (-1, -1)
    for i in range(len(speeds) - 1, -1, -1):  # the fastest is most often best, and spares work on the others
        for j in range(len(rates)):
            score = _judge(field, body, rollout, pose, now, speeds[i], rates[j], target, path, obstacles, give, best)
            score += rollout.smoothness * abs(rates[j] - now[1])
            if score < best:
                best, found = score, (i, j)
    return found[0], found[1], min(still, 1e9) - best


@njit(cache=True, nogil=True)
def _judge(
    field: DistanceField,
    body: Body,
    rollout: Rollout,
    pose: tuple[float, float, float],
    now: tuple[float, float],
    speed: float,
    rate: float,
    target: tuple[float, float],
    path: FloatArray,
    obstacles: FloatArray,
    give: float,
    best: float,
) -> float:
    """Return the score of one motion, the lower the better; inf if it is not admissible."""
    u, v, yaw = pose
    if math.hypot(target[0] - u, target[1] - v) - max(speed, now[0]) * rollout.horizon > best:
        return math.inf  # cannot get near enough to the target to be the best
    spin = 0.0 if body.disc else abs(rate)
    step = min(rollout.step, rollout.stride / max(abs(speed) + spin * body.outer, 1e-9))
    count = 1 + math.ceil((rollout.horizon - rollout.reaction) / step)
    moving = speed != 0.0 or now[0] != 0.0 or not body.disc
    turn, chord = _arc((speed + now[0]) / 2, (rate + now[1]) / 2, rollout.reaction)
    cos, sin, cos_turn, sin_turn = math.cos(yaw + turn / 2), math.sin(yaw + turn / 2), 1.0, 0.0
    lack, done = 0.0, 0
    rows, cols = field.distance.shape
    clear = body.outer + 0.7072  # no obstacle is near if that of the cell is this far
    for k in range(count):
        nu, nv, nyaw = u + chord * cos, v + chord * sin, yaw + turn
        row, col = math.floor(nv + 0.5), math.floor(nu + 0.5)
        inside = 0 <= row < rows and 0 <= col < cols
        room = float(field.distance[row, col]) if inside else 0.0
        near = room < clear or len(obstacles) > 0
        if moving and near and not _free(field, body, nu, nv, nyaw, obstacles, give):
            if k == 0:
                return math.inf
            break
        u, v, yaw, done = nu, nv, nyaw, k + 1
        missing = 1.0 - (room - body.inner) / rollout.comfort
        if missing > 0.0:
            lack += min(missing, 1.0) ** 2
        if k == 0:
            turn, chord = _arc(speed, rate, step)
            cos, sin = math.cos(yaw + turn / 2), math.sin(yaw + turn / 2)
            cos_turn, sin_turn = math.cos(turn), math.sin(turn)
        else:
            cos, sin = cos * cos_turn - sin * sin_turn, sin * cos_turn + cos * sin_turn
    du, dv = target[0] - u, target[1] - v
    distance = math.hypot(du, dv)
    off = (math.atan2(dv, du) - yaw) / math.tau if distance > 0.5 else 0.0
    off = math.tau * abs(off - round(off))
    score = distance + rollout.heading_weight * off * min(1.0, distance / 6.0)
    score += rollout.path_weight * _path_distance(path, u, v)
    score += rollout.clearance_weight * lack / max(done, 1)
    if score < best and moving and (lack > 0.0 or len(obstacles) > 0):  # near obstacles, and worth the work
        return score if _can_brake(field, body, rollout, pose, now, speed, rate, obstacles, give) else math.inf
    return score


@njit(cache=True, nogil=True)
def _can_brake(
    field: DistanceField,
    body: Body,
    rollout: Rollout,
    pose: tuple[float, float, float],
    now: tuple[float, float],
    speed: float,
    rate: float,
    obstacles: FloatArray,
    give: float,
) -> bool:
    """Return whether the outline stays free if the motion is commanded once, and then to stand still."""
    u, v, yaw = pose
    seconds, linear, angular = rollout.reaction, (speed + now[0]) / 2, (rate + now[1]) / 2
    spin = 0.0 if body.disc else body.outer
    while True:
        count = max(math.ceil((abs(linear) + spin * abs(angular)) * seconds / rollout.stride), 1)
        turn, chord = _arc(linear, angular, seconds / count)
        for _ in range(count):
            u, v = u + chord * math.cos(yaw + turn / 2), v + chord * math.sin(yaw + turn / 2)
            yaw += turn
            if not _free(field, body, u, v, yaw, obstacles, give):
                return False
        if speed == 0.0 and (rate == 0.0 or body.disc):
            return True
        seconds = rollout.step
        slower = max(abs(speed) - rollout.deceleration * seconds, 0.0)
        calmer = math.copysign(max(abs(rate) - rollout.angular_deceleration * seconds, 0.0), rate)
        linear, angular = (speed + slower) / 2, (rate + calmer) / 2
        speed, rate = slower, calmer


@njit(cache=True, inline="always")
def _arc(speed: float, rate: float, seconds: float) -> tuple[float, float]:
    """Return the angle and the chord of an arc."""
    turn = rate * seconds
    half = turn / 2
    return turn, speed * seconds * (math.sin(half) / half if abs(half) > 1e-6 else 1.0)


@njit(cache=True, nogil=True)
def _free(field: DistanceField, body: Body, u: float, v: float, yaw: float, obstacles: FloatArray, give: float) -> bool:
    if not body_fits(field, body, u, v, yaw):
        return False
    if len(obstacles) == 0:
        return True
    reach = max(body.outer - give, 0.0) ** 2
    cos, sin = math.cos(yaw), math.sin(yaw)
    for i in range(len(obstacles)):
        du, dv = obstacles[i, 0] - u, obstacles[i, 1] - v
        if du * du + dv * dv >= reach:
            continue
        if body.disc:
            return False
        ahead, aside = cos * du + sin * dv, cos * dv - sin * du
        if give - body.back < ahead < body.front - give and abs(aside) < body.half_width - give:
            return False
    return True


@njit(cache=True, nogil=True)
def motion_fits(
    field: DistanceField,
    body: Body,
    pose: tuple[float, float, float],
    speed: float,
    rate: float,
    seconds: float,
    obstacles: FloatArray,
    give: float,
) -> bool:
    """Return whether the outline stays free on an arc of constant twist."""
    u, v, yaw = pose
    if speed == 0.0 and body.disc:
        return True
    count = max(math.ceil(abs(speed) * seconds), math.ceil(abs(rate) * seconds / _TURN_STEP), 1)
    turn, chord = _arc(speed, rate, seconds / count)
    for _ in range(count):
        u, v = u + chord * math.cos(yaw + turn / 2), v + chord * math.sin(yaw + turn / 2)
        yaw += turn
        if not _free(field, body, u, v, yaw, obstacles, give):
            return False
    return True


@njit(cache=True, nogil=True)
def _path_distance(path: FloatArray, u: float, v: float) -> float:
    """Return the distance from a point to a polyline."""
    best = math.inf
    for i in range(len(path) - 1):
        du, dv = path[i + 1, 0] - path[i, 0], path[i + 1, 1] - path[i, 1]
        squared = du * du + dv * dv
        share = ((u - path[i, 0]) * du + (v - path[i, 1]) * dv) / squared if squared > 0.0 else 0.0
        share = min(max(share, 0.0), 1.0)
        best = min(best, (path[i, 0] + share * du - u) ** 2 + (path[i, 1] + share * dv - v) ** 2)
    return math.sqrt(best) if len(path) > 1 else 0.0
