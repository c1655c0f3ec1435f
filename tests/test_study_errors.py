"""Errors against the truth are those that were made by hand, and the Pareto front is one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octomarch as om
from octomarch.study.errors import depth_errors, normal_angles, percentiles, ray_errors, status_counts
from octomarch.study.front import pareto_front

HIT, MISS, STEP_LIMIT = om.Status.HIT, om.Status.MISS, om.Status.STEP_LIMIT


def test_percentiles_are_errors_that_were_put_in():
    truth = np.full(1000, 5.0)
    error = np.arange(1, 1001) / 1000
    depth = truth + error * np.random.default_rng(0).choice([-1, 1], 1000)
    found = depth_errors(depth, np.zeros(1000, int), truth)
    assert found.rays == 1000
    assert (found.p50, found.p95, found.p99) == pytest.approx((0.5, 0.95, 0.99))
    assert (found.false_hits, found.false_misses, found.cut) == (0, 0, 0)


def test_rays_that_end_wrong_are_told_apart_and_infinitely_wrong():
    truth = np.array([[1.0, 2.0, np.inf, np.inf, np.inf, 3.0, np.nan]])
    depth = np.array([[1.0, np.inf, 4.0, np.inf, 7.0, 3.5, 9.0]])
    status = np.array([[HIT, MISS, HIT, MISS, STEP_LIMIT, STEP_LIMIT, HIT]])
    found = depth_errors(depth, status, truth)
    assert found.rays == 5  # neither the sky nor what is not known
    assert (found.false_hits, found.false_misses) == (1, 1)
    np.testing.assert_array_equal(ray_errors(depth, truth)[0], [0, np.inf, np.inf, np.nan, np.inf, 0.5, np.nan])
    assert found.p99 == math.inf


def test_surfaces_beyond_the_far_limit_are_cut_and_no_error():
    truth, depth = np.array([1.0, 70.0, 70.0]), np.array([1.25, np.inf, 50.0])
    found = depth_errors(depth, np.array([HIT, MISS, HIT]), truth, max_distance=60.0)
    assert (found.cut, found.false_misses, found.rays) == (1, 0, 2)
    assert found.p99 == 20.0


def test_nothing_to_compare_gives_no_error():
    nothing = np.full(4, np.inf)
    found = depth_errors(nothing, np.full(4, MISS), nothing)
    assert (found.rays, found.p50, found.p99) == (0, 0.0, 0.0)
    assert percentiles(np.array([])) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("degrees", [0.0, 1e-9, 1e-3, 30.0, 90.0, 180.0])
def test_angles_between_normals_are_exact(degrees: float):
    turn = math.radians(degrees)
    a, b = np.array([[0.0, 0.0, 1.0]]), np.array([[math.sin(turn), 0.0, math.cos(turn)]])
    assert normal_angles(a, b)[0] == pytest.approx(degrees, rel=1e-12)


def test_statuses_are_counted():
    assert status_counts(np.array([0, 0, 1, 2, 3, 4])) == {
        "hit": 2,
        "miss": 1,
        "step_limit": 1,
        "inside": 1,
        "invalid": 1,
    }


def dominates(a: np.ndarray, b: np.ndarray) -> bool:
    return bool((a <= b).all() and (a < b).any())


COSTS = st.integers(1, 4).flatmap(
    lambda k: st.lists(
        st.tuples(*[st.one_of(st.integers(0, 5).map(float), st.floats(0, 1), st.just(math.inf))] * k), max_size=25
    ).map(lambda rows: np.array(rows, dtype=float).reshape(-1, k))
)


@given(COSTS)
def test_nothing_dominates_the_front_and_it_dominates_all_the_rest(costs: np.ndarray):
    front = pareto_front(costs).tolist()
    assert len(set(front)) == len(front)
    assert not any(dominates(a, costs[i]) for i in front for a in costs)
    for i in set(range(len(costs))) - set(front):
        assert any(dominates(costs[j], costs[i]) or (costs[j] == costs[i]).all() for j in front)
    assert (costs[front[:-1], 0] <= costs[front[1:], 0]).all()


@given(COSTS, st.randoms(use_true_random=False))
def test_the_front_does_not_depend_on_the_order_of_rows(costs: np.ndarray, random: object):
    order = np.arange(len(costs))
    random.shuffle(order)  # type: ignore[attr-defined]
    assert {tuple(row) for row in costs[pareto_front(costs)]} == {
        tuple(row) for row in costs[order][pareto_front(costs[order])]
    }


def test_no_front_has_what_was_not_measured():
    assert pareto_front([[1, np.nan], [2, 0]]).tolist() == [1]
    assert pareto_front(np.empty((0, 2))).tolist() == []
