import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.errors import InputError
from zavis_bt.planning import ORDERS, cost, greedy_order, make_order, nearest_order
from zavis_bt.types import Pose2D, Viewpoint

START = Pose2D(0.0, 0.0)


def viewpoint(x: float, y: float, landmark: int) -> Viewpoint:
    return Viewpoint(Pose2D(x, y), (x, y, 0.5), 0.3, landmark, "desk")


def straight(viewpoints):
    xy = np.array([(v.pose.x, v.pose.y) for v in viewpoints])
    return lambda pose: np.hypot(xy[:, 0] - pose.x, xy[:, 1] - pose.y)


def order(strategy, viewpoints, prior, uncertainty, **settings):
    return strategy(START, viewpoints, np.array(prior), np.array(uncertainty), straight(viewpoints), **settings)


CASES = st.lists(
    st.tuples(*[st.floats(-5, 5)] * 2, st.integers(0, 5), st.floats(0, 1), st.floats(0, 3)), min_size=1, max_size=12
)


def test_cost_is_the_papers_equation():
    found = cost(np.array([2.0]), np.array([0.4]), np.array([1.5]), 3.0, 0.05)
    assert found[0] == pytest.approx(2.0 + 3.0 * (1 + 1e-3 - 0.4) + 0.05 * 1.5)


@given(CASES)
def test_each_choice_costs_least_among_those_left(cases):
    viewpoints = [viewpoint(x, y, landmark) for x, y, landmark, _, _ in cases]
    p, sigma = np.array([c[3] for c in cases]), np.array([c[4] for c in cases])
    chosen = order(greedy_order, viewpoints, p, sigma)
    left = {i for i in range(len(cases)) if p[i] >= 0.2 and sigma[i] <= 2.5}
    here = START
    for index in chosen:
        costs = cost(straight(viewpoints)(here), p, sigma, 3.0, 0.05)
        assert index in left
        assert costs[index] <= min(costs[i] for i in left) + 1e-12
        left = {i for i in left if viewpoints[i].landmark != viewpoints[index].landmark}
        here = viewpoints[index].pose
    assert not left


@given(CASES)
def test_no_landmark_is_visited_twice(cases):
    viewpoints = [viewpoint(x, y, landmark) for x, y, landmark, _, _ in cases]
    for strategy in ORDERS.values():
        chosen = order(strategy, viewpoints, [c[3] for c in cases], [c[4] for c in cases])
        landmarks = [viewpoints[i].landmark for i in chosen]
        assert len(set(landmarks)) == len(landmarks)


def test_a_likely_landmark_far_away_comes_before_an_unlikely_one_near():
    viewpoints = [viewpoint(1, 0, 0), viewpoint(2, 0, 1)]
    assert order(greedy_order, viewpoints, [0.3, 0.9], [0, 0]) == [1, 0]
    assert order(greedy_order, viewpoints, [0.3, 0.9], [0, 0], lambda_1=0.1) == [0, 1]


def test_thresholds_skip_and_their_very_values_do_not():
    viewpoints = [viewpoint(i, 0, i) for i in range(4)]
    assert order(greedy_order, viewpoints, [0.2, 0.19, 0.5, 0.5], [0, 0, 2.5, 2.51]) == [0, 2]


def test_nearest_skips_nothing_and_ignores_prior_and_uncertainty():
    viewpoints = [viewpoint(3, 0, 0), viewpoint(1, 0, 1), viewpoint(2, 0, 2)]
    assert order(nearest_order, viewpoints, [1.0, 0.0, 0.0], [0, 9, 9], lambda_1=20.0, t_c=0.9) == [1, 2, 0]


def test_what_cannot_be_reached_is_left_out():
    viewpoints = [viewpoint(1, 0, 0), viewpoint(2, 0, 1)]
    found = greedy_order(START, viewpoints, np.ones(2), np.zeros(2), lambda _: np.array([math.inf, 2.0]))
    assert found == [1]


def test_nothing_to_visit_is_an_empty_order():
    assert greedy_order(START, [], np.empty(0), np.empty(0), lambda _: np.empty(0)) == []


def test_orders_come_by_name():
    assert make_order("greedy") is greedy_order
    assert make_order("nearest") is nearest_order
    with pytest.raises(InputError, match=r"no strategy 'gredy'.*did you mean 'greedy'"):
        make_order("gredy")


@pytest.mark.parametrize("strategy", ORDERS.values())
def test_unknown_settings_and_wrong_shapes_are_errors(strategy):
    with pytest.raises(InputError, match=r"no setting 'lamda_1'.*did you mean 'lambda_1'"):
        order(strategy, [viewpoint(1, 0, 0)], [1.0], [0.0], lamda_1=3.0)
    with pytest.raises(InputError, match=r"prior has shape \(2,\)"):
        order(strategy, [viewpoint(1, 0, 0)], [1.0, 1.0], [0.0])
