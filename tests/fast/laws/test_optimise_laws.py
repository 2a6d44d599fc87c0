"""Studies of optimisation against the answers of theory 12, on a thousand designs each.

The answers are written down here once more, as the theory states them: none of the code's own
exact forms takes part.
"""

from __future__ import annotations

import numpy as np
import pytest

from night import spread
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.problem import STATUS
from work import calls

RANDOM = np.random.default_rng(512)
GRAVITY = 9.81
FREQUENCY = 60.0
SIDE = 4  # 4 x 4 x 4 designs


def axis(low: float, high: float) -> list[float]:
    return sorted(RANDOM.uniform(low, high, SIDE).tolist())


# P from 1.1 to 90 m/s2: sliding only where it is strong, lift-off only where it is stronger.
AMPLITUDE = sorted((10 ** RANDOM.uniform(-5.1, -3.2, SIDE)).tolist())
FRICTION = axis(0.03, 1.2)
GAMMA = axis(-15.0, 25.0)
DELTA = axis(0.0, 75.0)  # on the steepest leans the wall carries more than the floor
LIMIT = 1.5

# The angles' own rounding, times how flat the answer is; the maintainer's bars.
ANGLE, GAP = 1e-7, 1e-12


def study(scene: str, variant: str, criterion: dict, *, parameters=None, **more):
    """Return the answers to a study of optimisation."""
    parameters = {
        "frequency": FREQUENCY, "gravity": GRAVITY, "amplitude": AMPLITUDE, "friction": FRICTION,
        **({"gamma": GAMMA} if parameters is None else parameters),
    }  # fmt: skip
    content = {"kind": "optimise", "scene": scene, "variant": variant, "criterion": criterion}
    return parse_study({**content, "parameters": parameters, **more})


class Designs:
    """The parameters of the cells of a dataset, in the units of the code."""

    def __init__(self, dataset):
        self.dims = dataset["regime"].dims
        self.dataset = dataset
        self.P = self.of("amplitude") * (2 * np.pi * FREQUENCY) ** 2
        self.mu = self.of("friction")
        gamma, delta = np.radians(self.of("gamma")), np.radians(self.of("delta"))
        self.along = GRAVITY * np.sin(gamma) + 0 * self.P
        self.normal = GRAVITY * np.cos(gamma) * np.cos(delta) + 0 * self.P
        self.across = GRAVITY * np.cos(gamma) * np.sin(delta) + 0 * self.P
        self.lift_off = np.arcsin(np.minimum(1.0, self.normal / self.P))

    def of(self, name: str):
        if name not in self.dataset.coords:
            return np.zeros(self.dataset["regime"].shape)
        values = self.dataset[name].broadcast_like(self.dataset["regime"])
        return values.transpose(*self.dims).values


def angles(dataset):
    return np.radians(dataset.best_alpha.values), np.radians(dataset.best_beta.values)


def agree(dataset, alpha, beta, where=..., angle=ANGLE):
    """Assert that the best angles are these, and known to be."""
    for found, right in zip(angles(dataset), (alpha, beta), strict=True):
        right = np.broadcast_to(right, found.shape)
        np.testing.assert_allclose(found[where], right[where], rtol=0, atol=angle)
    gap = dataset.optimum_gap
    assert np.nanmax(gap) < GAP if angle == ANGLE else np.nanmax(np.abs(gap)) < 1e-9


def is_tight(dataset, name):
    return dataset[f"binds_{name}"].values == 1


def bisected(function, low, high):
    """Return the root of an increasing function, all cells at once."""
    for _ in range(80):
        middle = (low + high) / 2
        below = function(middle) < 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2


def printed_answer(d: Designs, floor: bool, limit: float):
    """Return alpha, beta, which limit binds, and where there is an answer (theory 12.1)."""
    P, mu, G = d.P, d.mu, d.normal
    beta_m = np.arctan(mu)
    case_a = d.lift_off <= beta_m
    left = np.arcsin(np.minimum((G + limit / mu) / P, np.sin(beta_m)))
    beta_a = d.lift_off if floor else left
    binds_a = np.zeros_like(case_a) if floor else (G + limit / mu) / P < np.sin(beta_m)

    def excess(alpha):
        ca, sa = np.cos(alpha), np.sin(alpha)
        root = np.sqrt(1 + mu * mu * (1 + np.sin(2 * alpha)))
        return P * (sa + mu * mu * (ca + sa)) / root - (mu * G - limit)

    zero = np.zeros_like(P)
    turned = excess(zero) < 0
    exists = excess(zero + np.pi / 2) >= 0
    alpha_b = np.where(turned, bisected(excess, zero, zero + np.pi / 2), 0.0)
    beta_b = np.arctan(mu * (np.cos(alpha_b) + np.sin(alpha_b)))
    alpha, beta = np.where(case_a, 0.0, alpha_b), np.where(case_a, beta_a, beta_b)
    return alpha, beta, np.where(case_a, binds_a, turned), case_a | exists, case_a


@pytest.mark.parametrize("floor", [True, False])
def test_the_printed_plane_keeps_its_limit(floor):
    limit = {"kind": "limit", "limit": LIMIT}
    dataset = run_study(study("rectangle-on-plane", "thesis", limit, floor_contact=floor))
    d = Designs(dataset)
    alpha, beta, limited, exists, case_a = printed_answer(d, floor, LIMIT)
    # Within rounding of the last design that has an answer there may be one or none.
    np.testing.assert_array_equal(dataset.optimum_status == STATUS["infeasible"], ~exists)
    assert 5 < (case_a & exists).sum() < 0.9 * d.P.size
    assert (limited & exists & ~case_a).sum() > 3
    # Where cos(alpha) is all but 0 the level is flat over alpha: its slope is the condition.
    smooth = exists & (alpha < 1.55)
    assert smooth.sum() > 0.95 * exists.sum()
    agree(dataset, alpha, beta, smooth)
    np.testing.assert_array_equal(is_tight(dataset, "limit")[smooth], limited[smooth])
    if floor:
        np.testing.assert_array_equal(is_tight(dataset, "floor_contact")[smooth], case_a[smooth])
    a_x = d.P * (np.cos(beta) * np.cos(alpha) + d.mu * np.sin(beta)) - d.along - d.mu * d.normal
    np.testing.assert_allclose(dataset.objective.values[smooth], a_x[smooth], rtol=0, atol=1e-10)
    assert np.nanmin(dataset.margin_limit) == 0


@pytest.mark.parametrize("floor", [True, False])
def test_the_printed_plane_without_a_limit(floor):
    most = {"kind": "maximise"}
    dataset = run_study(study("cylinder-on-plane", "thesis", most, floor_contact=floor))
    d = Designs(dataset)
    beta = np.arctan(d.mu)
    if floor:
        np.testing.assert_array_equal(is_tight(dataset, "floor_contact"), d.lift_off <= beta)
        beta = np.minimum(beta, d.lift_off)
    agree(dataset, 0.0, beta)


@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("wall", [True, False])
def test_the_printed_track(variant, wall):
    most = {"kind": "maximise", "output": "starting_acceleration"}
    given = {"parameters": {"delta": DELTA, "gamma": 3.0}, "wall_contact": wall}
    dataset = run_study(study("rectangle-on-track", variant, most, **given))
    d = Designs(dataset)
    if variant == "thesis" and wall:  # the printed balance pulls at every lean
        assert (dataset.optimum_status == STATUS["infeasible"]).all()
        return
    alpha = np.arctan(d.mu)
    if wall:
        at_wall = np.arcsin(np.minimum(1.0, d.across / d.P))
        np.testing.assert_array_equal(is_tight(dataset, "wall_contact"), at_wall <= alpha)
        alpha = np.minimum(alpha, at_wall)
    agree(dataset, alpha, 0.0)
    assert is_tight(dataset, "beta_lower").all()


@pytest.mark.parametrize("scene", spread(["rectangle-on-plane", "cylinder-on-plane"], 1))
def test_the_physical_plane_has_no_trade_off(scene):
    falling = {"gamma": sorted(-abs(angle) for angle in GAMMA)}
    given = {"parameters": falling, "outputs": ["acceleration_y"]}
    dataset = run_study(study(scene, "physical", {"kind": "maximise"}, **given))
    d = Designs(dataset)
    beta = np.minimum(np.arctan(d.mu), d.lift_off)
    slips = d.P * np.cos(beta) - d.along > d.mu * (d.normal - d.P * np.sin(beta))
    assert slips.sum() > 0.5 * d.P.size
    np.testing.assert_array_equal(dataset.optimum_status == STATUS["optimal"], slips)
    agree(dataset, 0.0, beta, slips)
    np.testing.assert_array_equal(dataset.acceleration_y.values[slips], 0.0)
    lifted = (d.lift_off <= np.arctan(d.mu))[slips]
    np.testing.assert_array_equal(is_tight(dataset, "floor_contact")[slips], lifted)


# --- optimisers that know nothing of the answers


@pytest.mark.parametrize("method", ["scipy", "search"])
def test_optimisers_agree_with_the_answer(method):
    parameters = {"gamma": 4.0, "amplitude": [1e-4, 4e-4], "friction": [0.2, 0.7]}
    limit = {"kind": "limit", "limit": 0.5}
    given = {"parameters": parameters, "method": method}
    dataset = run_study(study("rectangle-on-plane", "thesis", limit, **given))
    alpha, beta, limited, exists, _ = printed_answer(Designs(dataset), True, 0.5)
    assert exists.all()
    assert limited.any()
    # Compares values only: a value that is equal to rounding ends the search, and an angle is
    # known to the square root of that, 1e-8, over the curvature along a limit.
    agree(dataset, alpha, beta, angle=1e-5)
    np.testing.assert_array_equal(is_tight(dataset, "limit"), limited)


# --- the trade-off


def of_case_b(criterion: dict):
    given = {"amplitude": 1e-4, "friction": 0.5}
    return study("rectangle-on-plane", "thesis", criterion, parameters=given)


def test_the_front_of_case_b_is_the_curve():
    dataset = run_study(of_case_b({"kind": "pareto", "points": 200}))
    alpha, beta = angles(dataset)
    curve = np.arctan(0.5 * (np.cos(alpha) + np.sin(alpha)))
    np.testing.assert_allclose(beta, curve, rtol=0, atol=1e-8)
    a_x, a_y = dataset.acceleration_x.values, np.abs(dataset.acceleration_y.values)
    assert np.all(np.diff(a_x) < 0)
    assert np.all(np.diff(a_y) < 0)
    assert (alpha[0], dataset.front.values[0], dataset.front.values[-1]) == (0.0, 0.0, 1.0)
    assert a_y[-1] < 1e-14
    assert dataset.optimum_gap.max() < GAP
    # The knee: no point lies farther from the chord between the ends.
    share = (a_x - a_x[-1]) / (a_x[0] - a_x[-1]) - (a_y - a_y[-1]) / (a_y[0] - a_y[-1])
    assert dataset.knee.values.sum() == 1
    assert share[dataset.knee.values == 1][0] == share.max() > 0.2


def test_a_front_of_200_points_takes_less_work_than_ten_single_limits():
    single = of_case_b({"kind": "limit", "limit": 1.0})
    front = of_case_b({"kind": "pareto", "points": 200})
    assert calls(lambda: run_study(front)) < 10 * calls(lambda: run_study(single))
