"""In which order viewpoints are visited."""

from __future__ import annotations

import importlib.metadata
import math
from collections.abc import Callable, Sequence
from types import MappingProxyType

import numpy as np

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.protocols import VisitOrder
from zavis_bt.types import FloatArray, Pose2D, Viewpoint

_GROUP = "zavis_bt.strategies"
_SETTINGS = ("lambda_1", "lambda_2", "t_c", "t_u")


def cost(
    distance: FloatArray, prior: FloatArray, uncertainty: FloatArray, lambda_1: float, lambda_2: float
) -> FloatArray:
    """Return the cost of going to each of n viewpoints next (Eq. cost_function).

    The paper's 1^{-3} is read as 1e-3, as the additive constant it was meant to be.

    Args:
        distance: (n,) from the viewpoint before [m].
        prior: (n,) p(target | landmark).
        uncertainty: (n,) semantic uncertainty σ_c of the landmark [nat].
        lambda_1: Weight of the prior [m].
        lambda_2: Weight of the uncertainty [m/nat].

    Returns:
        (n,) costs [m].
    """
    return distance + lambda_1 * (1 + 1e-3 - prior) + lambda_2 * uncertainty


def greedy_order(
    start: Pose2D,
    viewpoints: Sequence[Viewpoint],
    prior: FloatArray,
    uncertainty: FloatArray,
    distances: Callable[[Pose2D], FloatArray],
    *,
    lambda_1: float = 3.0,
    lambda_2: float = 0.05,
    t_c: float = 0.2,
    t_u: float = 2.5,
    **unknown: float,
) -> list[int]:
    """Visit next what costs least from where one is: the paper's order (section Waypoint Generator).

    Args:
        start: Where the robot is.
        viewpoints: n candidates, several for each landmark.
        prior: (n,) p(target | landmark).
        uncertainty: (n,) semantic uncertainty of the landmark [nat].
        distances: Returns the (n,) distances from a pose to all viewpoints [m]; inf where there is no path.
        lambda_1: Weight of the prior λ1 [m].
        lambda_2: Weight of the uncertainty λ2 [m/nat].
        t_c: Landmarks less probable than this are skipped.
        t_u: Landmarks more uncertain than this are skipped [nat].
        unknown: No further setting is known.

    Returns:
        Indices into ``viewpoints``, one of each landmark that is not skipped and can be reached.

    Raises:
        InputError: A setting is not known, or the arrays do not match the viewpoints.
    """
    _check(unknown, viewpoints, prior, uncertainty)
    p, sigma = np.asarray(prior, dtype=np.float64), np.asarray(uncertainty, dtype=np.float64)
    waiting = (p >= t_c) & (sigma <= t_u)
    landmarks = np.array([viewpoint.landmark for viewpoint in viewpoints], dtype=np.intp)
    order: list[int] = []
    here = start
    while waiting.any():
        costs = np.where(waiting, cost(distances(here), p, sigma, lambda_1, lambda_2), math.inf)
        best = int(costs.argmin())
        if not costs[best] < math.inf:
            break
        order.append(best)
        waiting &= landmarks != landmarks[best]
        here = viewpoints[best].pose
    return order


def nearest_order(
    start: Pose2D,
    viewpoints: Sequence[Viewpoint],
    prior: FloatArray,
    uncertainty: FloatArray,
    distances: Callable[[Pose2D], FloatArray],
    **settings: float,
) -> list[int]:
    """Visit next what is nearest: λ1 = λ2 = 0 and no landmark skipped.

    Args:
        start: Where the robot is.
        viewpoints: n candidates, several for each landmark.
        prior: (n,) not used.
        uncertainty: (n,) not used.
        distances: Returns the (n,) distances from a pose to all viewpoints [m]; inf where there is no path.
        settings: Those of `greedy_order` are accepted, so that orders can be exchanged, and not used.

    Returns:
        Indices into ``viewpoints``, one of each landmark that can be reached.

    Raises:
        InputError: A setting is not known, or the arrays do not match the viewpoints.
    """
    unknown = {name: value for name, value in settings.items() if name not in _SETTINGS}
    return greedy_order(
        start,
        viewpoints,
        prior,
        uncertainty,
        distances,
        lambda_1=0.0,
        lambda_2=0.0,
        t_c=-math.inf,
        t_u=math.inf,
        **unknown,
    )


ORDERS = MappingProxyType({"greedy": greedy_order, "nearest": nearest_order})
"""The orders that come with the framework."""


def make_order(name: str) -> VisitOrder:
    """Return the order strategy of that name: a built-in one, or an entry point of the group ``zavis_bt.strategies``.

    Raises:
        InputError: No such strategy.
    """
    if name in ORDERS:
        return ORDERS[name]
    others = importlib.metadata.entry_points(group=_GROUP)
    if name not in others.names:
        raise InputError(f"order: no strategy '{name}'{did_you_mean(name, {*ORDERS, *others.names})}")
    order: VisitOrder = others[name].load()
    return order


def _check(
    unknown: dict[str, float], viewpoints: Sequence[Viewpoint], prior: FloatArray, uncertainty: FloatArray
) -> None:
    for name in unknown:
        raise InputError(f"order: no setting '{name}'{did_you_mean(name, _SETTINGS)}")
    for what, values in (("prior", prior), ("uncertainty", uncertainty)):
        if np.shape(values) != (len(viewpoints),):
            raise InputError(f"order: {what} has shape {np.shape(values)} (right: ({len(viewpoints)},))")
