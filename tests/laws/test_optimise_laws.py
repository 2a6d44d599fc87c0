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
SIDE = 10  # 10 x 10 x 10 designs


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


def study(scene: str, variant: str, criterion: dict, **more):
    parameters = {
        "frequency": FREQUENCY,
        "gravity": GRAVITY,
        "amplitude": AMPLITUDE,
        "friction": FRICTION,
        **more.pop("parameters", {"gamma": GAMMA}),
    }
    return parse_study(
        {
            "kind": "optimise",
            "scene": scene,
            "variant": variant,
            "criterion": criterion,
            "parameters": parameters,
            **more,
        }
    )


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
    dataset = run_study(
        study(
            "rectangle-on-plane",
            "thesis",
            {"kind": "limit", "limit": LIMIT},
            floor_contact=floor,
        )
    )
    d = Designs(dataset)
    alpha, beta, limited, exists, case_a = printed_answer(d, floor, LIMIT)
    # Within rounding of the last design that has an answer there may be one or none.
    np.testing.assert_array_equal(dataset.optimum_status == STATUS["infeasible"], ~exists)
    assert 100 < (case_a & exists).sum() < 900
    assert (limited & exists & ~case_a).sum() > 50
    found_alpha, found_beta = angles(dataset)
    # Where cos(alpha) is all but 0 the level is flat over alpha: its slope is the condition.
    smooth = exists & (alpha < 1.55)
    assert smooth.sum() > 0.95 * exists.sum()
    np.testing.assert_allclose(found_alpha[smooth], alpha[smooth], rtol=0, atol=ANGLE)
    np.testing.assert_allclose(found_beta[smooth], beta[smooth], rtol=0, atol=ANGLE)
    assert np.nanmax(dataset.optimum_gap) < GAP
    np.testing.assert_array_equal(is_tight(dataset, "limit")[smooth], limited[smooth])
    if floor:
        np.testing.assert_array_equal(is_tight(dataset, "floor_contact")[smooth], case_a[smooth])
    a_x = d.P * (np.cos(beta) * np.cos(alpha) + d.mu * np.sin(beta)) - d.along - d.mu * d.normal
    np.testing.assert_allclose(dataset.objective.values[smooth], a_x[smooth], rtol=0, atol=1e-10)
    assert np.nanmin(dataset.margin_limit) == 0


@pytest.mark.parametrize("floor", [True, False])
def test_the_printed_plane_without_a_limit(floor):
    dataset = run_study(
        study("cylinder-on-plane", "thesis", {"kind": "maximise"}, floor_contact=floor)
    )
    d = Designs(dataset)
    beta = np.arctan(d.mu)
    if floor:
        np.testing.assert_array_equal(
            is_tight(dataset, "floor_contact"), d.lift_off <= np.arctan(d.mu)
        )
        beta = np.minimum(beta, d.lift_off)
    found_alpha, found_beta = angles(dataset)
    np.testing.assert_allclose(found_alpha, 0.0, rtol=0, atol=ANGLE)
    np.testing.assert_allclose(found_beta, beta, rtol=0, atol=ANGLE)
    assert dataset.optimum_gap.max() < GAP


@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("wall", [True, False])
def test_the_printed_track(variant, wall):
    dataset = run_study(
        study(
            "rectangle-on-track",
            variant,
            {"kind": "maximise", "output": "starting_acceleration"},
            parameters={"delta": DELTA, "gamma": 3.0},
            wall_contact=wall,
        )
    )
    d = Designs(dataset)
    if variant == "thesis" and wall:  # the printed balance pulls at every lean
        assert (dataset.optimum_status == STATUS["infeasible"]).all()
        return
    alpha = np.arctan(d.mu)
    if wall:
        at_wall = np.arcsin(np.minimum(1.0, d.across / d.P))
        np.testing.assert_array_equal(is_tight(dataset, "wall_contact"), at_wall <= alpha)
        alpha = np.minimum(alpha, at_wall)
    found_alpha, found_beta = angles(dataset)
    np.testing.assert_allclose(found_alpha, alpha, rtol=0, atol=ANGLE)
    np.testing.assert_allclose(found_beta, 0.0, rtol=0, atol=ANGLE)
    assert dataset.optimum_gap.max() < GAP
    assert is_tight(dataset, "beta_lower").all()


def test_the_physical_track_with_each_contact_at_its_limit():
    dataset = run_study(
        study(
            "rectangle-on-track",
            "physical",
            {"kind": "maximise"},
            parameters={"delta": DELTA, "gamma": 3.0},
        )
    )
    d = Designs(dataset)
    P, mu, y, z = d.P, d.mu, d.across, d.normal
    # theory 12.3: the wall's limit first, else the top of the sphere
    kept = np.minimum(y / P, 1.0)
    sine_wall = np.minimum(mu * np.sqrt((1 - kept**2) / (1 + mu * mu)), z / P)
    room = np.sqrt(np.maximum(1 - sine_wall**2, 1e-300))
    alpha_wall = np.arcsin(np.minimum(kept / room, 1.0))
    at_wall = (y < P) & (np.tan(alpha_wall) <= mu)
    sine_free = np.minimum(np.sin(np.arctan(mu / np.hypot(1.0, mu))), z / P)
    alpha = np.where(at_wall, alpha_wall, np.arctan(mu))
    beta = np.arcsin(np.where(at_wall, sine_wall, sine_free))
    load = z - P * np.sin(beta) + y - P * np.cos(beta) * np.sin(alpha)
    moves = P * np.cos(beta) * np.cos(alpha) - d.along - mu * load > 0
    np.testing.assert_array_equal(dataset.optimum_status == STATUS["no_motion"], ~moves)
    found_alpha, found_beta = angles(dataset)
    np.testing.assert_allclose(found_alpha[moves], alpha[moves], rtol=0, atol=ANGLE)
    np.testing.assert_allclose(found_beta[moves], beta[moves], rtol=0, atol=ANGLE)
    assert np.nanmax(dataset.optimum_gap) < GAP
    np.testing.assert_array_equal(is_tight(dataset, "wall_contact")[moves], at_wall[moves])
    at_floor = z / P <= np.where(at_wall, mu * np.sqrt((1 - kept**2) / (1 + mu * mu)),
                                 mu / np.sqrt(1 + 2 * mu * mu))  # fmt: skip
    np.testing.assert_array_equal(is_tight(dataset, "floor_contact")[moves], at_floor[moves])
    for wall in (True, False):
        for floor in (True, False):
            assert (moves & (at_wall == wall) & (at_floor == floor)).sum() > 5, (wall, floor)


@pytest.mark.parametrize("scene", spread(["rectangle-on-plane", "cylinder-on-plane"], 1))
def test_the_physical_plane_has_no_trade_off(scene):
    falling = sorted(-abs(angle) for angle in GAMMA)
    dataset = run_study(
        study(
            scene,
            "physical",
            {"kind": "maximise"},
            parameters={"gamma": falling},
            outputs=["acceleration_y"],
        )
    )
    d = Designs(dataset)
    beta = np.minimum(np.arctan(d.mu), d.lift_off)
    slips = d.P * np.cos(beta) - d.along > d.mu * (d.normal - d.P * np.sin(beta))
    moves = dataset.optimum_status.values == STATUS["optimal"]
    assert slips.sum() > 500
    np.testing.assert_array_equal(moves, slips)
    found_alpha, found_beta = angles(dataset)
    np.testing.assert_allclose(found_alpha[moves], 0.0, rtol=0, atol=ANGLE)
    np.testing.assert_allclose(found_beta[moves], beta[moves], rtol=0, atol=ANGLE)
    np.testing.assert_array_equal(dataset.acceleration_y.values[moves], 0.0)
    np.testing.assert_array_equal(
        is_tight(dataset, "floor_contact")[moves], (d.lift_off <= np.arctan(d.mu))[moves]
    )


# --- optimisers that know nothing of the answers


@pytest.mark.parametrize(
    ("method", "angle", "gap"),
    [
        # Compares values only: a value that is equal to rounding ends the search, and an angle is
        # known to the square root of that, 1e-8, over the curvature along a limit.
        ("scipy", 1e-5, 1e-9),
        ("search", 1e-5, 1e-9),
    ],
)
def test_optimisers_agree_with_the_answer(method, angle, gap):
    parameters = {"gamma": 4.0, "amplitude": [1e-4, 4e-4], "friction": [0.2, 0.7]}
    given = study(
        "rectangle-on-plane",
        "thesis",
        {"kind": "limit", "limit": 0.5},
        parameters=parameters,
        method=method,
    )
    dataset = run_study(given)
    alpha, beta, limited, exists, _ = printed_answer(Designs(dataset), True, 0.5)
    assert exists.all()
    assert limited.any()
    found_alpha, found_beta = angles(dataset)
    np.testing.assert_allclose(found_alpha, alpha, rtol=0, atol=angle)
    np.testing.assert_allclose(found_beta, beta, rtol=0, atol=angle)
    assert np.abs(dataset.optimum_gap).max() < gap
    np.testing.assert_array_equal(is_tight(dataset, "limit"), limited)


# --- the trade-off


def front_of_case_b(points: int = 200, **more):
    return study(
        "rectangle-on-plane",
        "thesis",
        {"kind": "pareto", "points": points},
        parameters={"amplitude": 1e-4, "friction": 0.5},
        **more,
    )


def test_the_front_of_case_b_is_the_curve():
    dataset = run_study(front_of_case_b())
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


def test_the_front_of_case_a_without_contact():
    given = study(
        "rectangle-on-plane",
        "thesis",
        {"kind": "pareto", "points": 50},
        parameters={"amplitude": 5e-4, "friction": 0.5},
        floor_contact=False,
    )
    dataset = run_study(given)
    d = Designs(dataset.isel(front=0))
    alpha, beta = angles(dataset)
    np.testing.assert_array_equal(alpha, 0.0)
    ends = [np.arctan(0.5), float(d.lift_off)]
    np.testing.assert_allclose(beta[[0, -1]], ends, rtol=0, atol=1e-12)


def test_a_front_without_trade_off_is_one_point():
    given = study(
        "rectangle-on-plane",
        "thesis",
        {"kind": "pareto", "points": 20},
        parameters={"amplitude": 5e-4, "friction": 0.5},
    )
    dataset = run_study(given)
    assert np.ptp(dataset.best_beta.values) == 0
    np.testing.assert_array_equal(np.flatnonzero(dataset.knee.values), [0])


def test_a_front_of_200_points_takes_less_work_than_ten_single_limits():
    single = study(
        "rectangle-on-plane",
        "thesis",
        {"kind": "limit", "limit": 1.0},
        parameters={"amplitude": 1e-4, "friction": 0.5},
    )
    front = front_of_case_b()

    assert calls(lambda: run_study(front)) < 10 * calls(lambda: run_study(single))
