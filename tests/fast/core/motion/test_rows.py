"""Rows of parts: isotonic contact by scipy, time stepping, and what studies of them say."""

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

import vibrafeed
from night import count
from refusals import problems_of
from rows import cell
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.kernels.rows.contact import collide, pool_means, start_movable_parts
from vibrafeed.core.motion.kernels.rows.row_state import row_at
from vibrafeed.core.quantities import REGIMES

# --- another method: isotonic regression by scipy


def test_contact_is_isotonic_regression():
    random = np.random.default_rng(1)
    for _ in range(count(300, 5000)):
        n = int(random.integers(2, 9))
        row = row_at(cell(1, 0, random.uniform(0.1, 0.9, n), mass=random.uniform(0.2, 3.0, n)), 0.0)
        row.value[:] = random.normal(size=n)
        found = isotonic_regression(row.value.copy(), weights=row.mass)
        blocks = pool_means(row, 0, n)
        assert row.value == pytest.approx(found.x, abs=1e-14)
        assert blocks == len(found.blocks) - 1


def test_starts_obey_friction_and_push_only():
    random = np.random.default_rng(2)
    for _ in range(count(300, 5000)):
        n = int(random.integers(2, 9))
        static = random.uniform(0.1, 0.9, n)
        row = row_at(cell(1, 0, static, mass=random.uniform(0.2, 3.0, n)), 0.0)
        push, load = random.uniform(-1.0, 1.0), random.uniform(0.2, 1.5)
        start_movable_parts(row, push, load, -1)
        # Movers are the front under a push forward, the rear under one backward.
        way = slice(None) if push > 0 else slice(None, None, -1)
        alone = abs(push) - static[way] * load
        moves = isotonic_regression(alone, weights=row.mass[way]).x > 1e-13
        assert row.mode[way].tolist() == (np.sign(push) * moves).tolist()


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_collisions_keep_momentum_and_gain_no_energy(restitution):
    random = np.random.default_rng(3)
    for _ in range(count(200, 3000)):
        n = int(random.integers(2, 8))
        row = row_at(cell(1, 0, [0.3] * n, mass=random.uniform(0.2, 3.0, n)), 0.0)
        before = random.normal(size=n)
        row.speed[:], met = before, np.diff(before)
        if met.min() >= 0:
            continue
        lost, _ = collide(row, int(np.argmin(met)), restitution)
        assert row.mass @ row.speed == pytest.approx(row.mass @ before, abs=1e-13)
        energy = (row.mass @ before**2 - row.mass @ row.speed**2) / 2
        assert energy == pytest.approx(lost, abs=1e-13)
        assert lost >= 0.0
        # Parts that met part, at least by the restitution; none overlaps.
        assert (np.diff(row.speed) >= -restitution * met - 1e-12)[met < 0].all()


# --- studies


STUDY = {
    "kind": "simulate", "scene": "row-on-plane", "outputs": ["conveying_velocity", "platoons"],
}  # fmt: skip
DRIVEN = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20}


@pytest.mark.parametrize(
    ("more", "place", "says"),
    [
        ({}, "parameters.parts", "it is missing"),
        ({"parts": 4}, "parameters.friction", "it is missing"),
        ({"parts": 1, "friction": 0.3}, "parameters.parts", "at least 2"),
        ({"parts": 4, "friction": 0.3, "alpha": 5}, "parameters.alpha", "not used"),
        ({"part_friction_1": 0.3, "part_friction_3": 0.2}, "parameters.friction", "it is missing"),
        (
            {"part_friction_1": 0.3, "part_mass_2": "4 g", "friction": 0.2},
            "parameters.mass",
            "it is missing",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(more, place, says):
    assert any(
        one.place == place and says in str(one)
        for one in problems_of(prepare_content, {**STUDY, "parameters": {**DRIVEN, **more}})
    )


def regimes(outputs=("platoons",), **given):
    """Return a study of a row, and the names of its regimes."""
    found = vibrafeed.simulate(
        scene="row-on-plane", outputs=list(outputs), **{**DRIVEN, "max_periods": 60, **given}
    )
    names = {flag.value: name for name, flag in REGIMES.items()}
    return found, [names[value] for value in found.regime.values.ravel().tolist()]


APART = {"part_friction_1": 0.3, "part_friction_2": 0.34, "part_friction_3": 0.28}


@pytest.mark.parametrize(
    ("given", "names"),
    [
        (APART, ["separating"]),
        ({"parts": 3, "friction": 0.3}, ["hopping"]),
        ({"part_friction_1": 0.3, "part_friction_2": 0.4, "amplitude": "1.2 mm"},
         ["out_of_phase_possible"]),
        # Parts that rebound from the floor are followed by no method.
        ({"parts": 3, "friction": 0.3, "restitution": [0.0, 0.2], "max_periods": 10},
         ["hopping", "not_supported"]),
        # A part that friction can tip: mu b > h, 0.34 of 12 mm are 35.3 mm.
        ({**APART, "length": "12 mm", "height": ["35 mm", "36 mm"]}, ["separating", "tipping"]),
        ({"parts": 2, "friction": 0.3, "length": "12 mm", "height": ["39 mm", "41 mm"]},
         ["hopping", "tipping"]),
        # A stop holds the parts in front on a slope, and not those behind.
        ({"part_friction_1": 0.05, "part_friction_2": 0.3, "amplitude": "0.1 mm",
          "fixed_stop_gap": 0, "gamma": [-10, 10]}, ["blocked", "runaway"]),
    ],
)  # fmt: skip
def test_regimes_of_rows(given, names):
    assert regimes(**given)[1] == names


SLOPE = [
    # Friction at the rear and in front, and whether parts at the lower end leave: alone, or
    # pushed by the part above. tan(10 deg) is 0.1763.
    (10, (0.05, 0.3), True), (10, (0.3, 0.05), True), (10, (0.3, 0.06), False),
    (-10, (0.3, 0.05), True), (-10, (0.05, 0.3), True), (-10, (0.06, 0.3), False),
]  # fmt: skip


@pytest.mark.parametrize(("gamma", "friction", "away"), SLOPE)
def test_parts_that_run_down_a_slope_for_ever_have_no_mean_velocity(gamma, friction, away):
    found = vibrafeed.simulate(
        scene="row-on-plane", outputs=["conveying_velocity"], frequency=50, amplitude="0.1 mm",
        beta=20, gamma=gamma, part_friction_1=friction[0], part_friction_2=friction[1],
    )  # fmt: skip
    assert (found.regime == REGIMES["runaway"].value) == away
    assert np.isnan(found.conveying_velocity) == away


@pytest.mark.parametrize(
    ("given", "leaves", "way"),
    [
        (APART, "slowest_velocity", 1),  # what comes behind is no faster
        ({"parts": 3, "friction": 0.3}, "conveying_velocity", 1),
        ({**APART, "beta": 160}, "fastest_part_velocity", -1),
        ({"part_friction_1": 0.1, "part_friction_2": 0.8, "gamma": 4, "amplitude": "0.25 mm",
          "beta": 30}, None, 0),  # some leave at each end
    ],
)  # fmt: skip
def test_parts_a_minute_are_those_that_leave_at_either_end(given, leaves, way):
    outputs = ["feed_rate", "conveying_velocity", "slowest_velocity", "fastest_part_velocity"]
    found, _ = regimes(outputs, **given, length="12 mm")
    rate, mean, last, first = (float(found[name]) for name in outputs)
    assert last <= mean <= first
    assert np.sign([last, first]).tolist() == ([way, way] if way else [-1, 1])
    expected = 60 * float(found[leaves]) / 0.012 if leaves else 0.0
    assert rate == pytest.approx(expected, rel=1e-12)
