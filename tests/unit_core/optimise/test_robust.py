"""Robust values: the worst and the mean over an interval, against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.optimise.robust import NODES, nodes_over, over_nodes, uncertain_of
from core.study.distributions import read_distribution


def robust_value(evaluate, interval, *, how="worst", nodes=NODES):
    """Return an objective that knows a parameter only within an interval: what counts of it."""
    places, weights = nodes_over(interval, how, nodes)

    def robust(points):
        count = len(points)
        values = np.asarray(evaluate(np.tile(points, (nodes, 1)), np.repeat(places, count)))
        return over_nodes(values.reshape(nodes, count), weights)

    return robust


def hill(points, friction):
    """Return a value with a minimum inside the interval of friction, and a jump at 0.5."""
    return points[:, 0] * (friction - 0.33) ** 2 - np.where(friction > 0.5, points[:, 1], 0.0)


def test_the_worst_case_against_brute_force():
    points = np.random.default_rng(0).uniform(0.5, 1.0, (50, 2))
    fine = np.linspace(0.2, 0.7, 5001)
    brute = np.min([hill(points, np.full(50, f)) for f in fine], axis=0)
    worst = robust_value(hill, (0.2, 0.7), how="worst", nodes=51)(points)
    # The least value lies just beyond the jump; the next node is up to 0.01 further on.
    assert worst == pytest.approx(brute, abs=0.01 * 2 * 0.37)
    assert np.all(worst >= brute - 1e-15)


def test_the_worst_of_a_monotone_value_is_that_of_an_end():
    points = np.ones((3, 1))
    worst = robust_value(lambda p, f: -f * p[:, 0], (0.2, 0.4), nodes=2)(points)
    assert worst == pytest.approx([-0.4] * 3, rel=1e-15)


def test_the_mean_against_brute_force():
    points = np.random.default_rng(0).uniform(0.5, 1.0, (50, 2))
    smooth = robust_value(hill, (0.2, 0.4), how="mean", nodes=2)(points)
    exact = points[:, 0] * ((0.07**3 + 0.13**3) / 3) / 0.2  # two nodes: exact up to cubes
    assert smooth == pytest.approx(exact, rel=1e-13)
    rough = robust_value(hill, (0.2, 0.7), how="mean", nodes=64)(points)
    fine = np.linspace(0.2, 0.7, 20001)
    brute = np.mean([hill(points, np.full(50, f)) for f in fine], axis=0)
    # A jump of 1 at most, over 64 nodes whose weights are pi/2/64 at most.
    assert rough == pytest.approx(brute, abs=math.pi / 2 / 64)


@pytest.mark.parametrize("how", ["worst", "mean"])
def test_a_node_without_a_value_takes_the_value_away(how):
    def no_value(points, friction):
        return np.where(friction > 0.35, np.nan, points[:, 0])

    got = robust_value(no_value, (0.2, 0.4), how=how)(np.ones((2, 1)))
    assert np.isnan(got).all()


@pytest.mark.parametrize(("interval", "how", "nodes"), [
    ((0.4, 0.2), "worst", 3), ((0.2, 0.4), "worst", 1), ((0.2, 0.4), "middle", 3),
    ((0.2, math.inf), "mean", 0),
])  # fmt: skip
def test_wrong_requests_are_refused(interval, how, nodes):
    with pytest.raises(ValueError, match=r"interval|nodes|how"):
        robust_value(hill, interval, how=how, nodes=nodes)


def test_the_quantile_of_what_is_to_be_least_is_that_of_the_output_itself():
    law = {"friction": read_distribution("friction", {"mean": 0.4, "deviation": 0.03})}
    nodes = uncertain_of(law, "quantile", 0.9)
    output = nodes.values["friction"][:, None]
    assert nodes.counts(output, 1.0) == pytest.approx([0.4 + 1.2816 * 0.03], rel=5e-3)
    assert nodes.counts(-output, -1.0) == pytest.approx(-nodes.counts(output, 1.0), rel=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_worst_case_knows_every_corner_and_the_middle(count):
    names = ("friction", "amplitude", "frequency", "gravity")[:count]
    law = {name: read_distribution(name, {"lower": 1.0, "upper": 2.0}) for name in names}
    found = np.array([*uncertain_of(law, "worst", None).values.values()])
    assert {tuple(one) for one in found.T} >= {(1.0,) * count, (2.0,) * count, (1.5,) * count}
    assert found.shape[1] == {1: 9, 2: 25, 3: 27, 4: 17}[count]
