"""Values with 50 digits: against direct computations; where none is known, none is given."""

from __future__ import annotations

import math
from pathlib import Path

import mpmath
import numpy as np
import pytest

from plans import make_plan
from precise import (
    CONTEXT,
    DIGITS,
    NotPreciseError,
    Number,
    errors_of,
    exact_values,
    sensitivities,
)
from vibrafeed.core.intake import prepare_content, read_content
from vibrafeed.core.plan.grid import random_positions
from vibrafeed.core.plan.plan import run_equations, scene_parameters
from vibrafeed.core.scenes import SCENES, instead_of

ROOT = Path(__file__).parents[4]
# Next to lift-off the normal acceleration is a difference of nearly equal numbers.
NEAR = {"frequency": 50.0, "amplitude": 2e-4, "gravity": 9.81, "gamma": 0.0}


def ill_conditioned(count=40):
    """Return cells whose drive lifts the part off to a share of 1e-6 to 1e-1."""
    plan = make_plan("rectangle-on-plane", "thesis", ("normal_acceleration",), (*NEAR, "beta"))
    drive = NEAR["amplitude"] * (2 * np.pi * NEAR["frequency"]) ** 2
    share = 1 - np.logspace(-6, -1, count)
    cells = {name: np.full(count, value) for name, value in NEAR.items()}
    return plan, {**cells, "beta": np.arcsin(share * NEAR["gravity"] / drive)}


def direct(cells, k):
    """Return n0 = g cos(gamma) - A (2 pi f)^2 sin(beta) and |terms| of its slopes, 60 digits."""
    with mpmath.workdps(60):
        g, a, f, beta, gamma = (
            mpmath.mpf(float(cells[name][k]))
            for name in ("gravity", "amplitude", "frequency", "beta", "gamma")
        )
        weight = g * mpmath.cos(gamma)
        p = a * (2 * mpmath.pi * f) ** 2
        drive = p * mpmath.sin(beta)
        # By g, by A, by f (a square), by beta; gamma is 0 and adds nothing.
        moved = weight + drive + 2 * drive + abs(p * mpmath.cos(beta) * beta)
        return weight - drive, moved


def test_ulps_of_an_ill_conditioned_difference_agree_with_a_direct_computation():
    plan, cells = ill_conditioned()
    exact = exact_values(plan, cells)["normal_acceleration"]
    moved = sensitivities(plan, cells)["normal_acceleration"]
    got = run_equations(plan, cells)["normal_acceleration"]
    errors = errors_of(got, exact, moved, np.float64)
    for k in range(len(exact)):
        value, slopes = direct(cells, k)
        assert abs(exact[k] - value) < 1e-46 * 10  # 50 digits of terms near 10
        assert abs(moved[k] / slopes - 1) < 1e-18  # differences over a step of 1e-20
        ulps = abs(mpmath.mpf(float(got[k])) - value) / math.ulp(float(value))
        assert errors.ulps[k] == pytest.approx(float(ulps), rel=1e-12)
        assert errors.condition[k] == pytest.approx(float(slopes / value), rel=1e-12)
    assert errors.ulps.max() > 1e4  # cancellation is seen ...
    assert errors.conditioned.max() < 8  # ... and laid to the condition of the problem


def test_a_wrong_digit_is_seen():
    plan, cells = ill_conditioned(4)
    exact = exact_values(plan, cells)["normal_acceleration"]
    moved = sensitivities(plan, cells)["normal_acceleration"]
    wrong = np.array([float(value) for value in exact]) * (1 + 1e-8)
    assert errors_of(wrong, exact, moved, np.float64).relative == pytest.approx(1e-8, rel=1e-6)


@pytest.mark.parametrize("variant", SCENES["rectangle-on-track"].variants)
def test_every_output_of_the_track_is_known_to_fifty_digits(variant):
    scene = SCENES["rectangle-on-track"]
    names = [n for n in scene_parameters(scene, variant) if not instead_of(n)]
    random = np.random.default_rng(1)
    values = {name: random.uniform(0.2, 0.4, 3) for name in names}
    values["friction_static"] = values["friction_kinetic"] + 0.1
    plan = make_plan(scene.name, variant, scene.outputs(variant), names)
    for name, exact in exact_values(plan, values).items():
        floats = np.broadcast_to(run_equations(plan, values)[name], 3)
        for value, got in zip(exact, floats, strict=True):
            assert isinstance(value, CONTEXT.mpf), name
            if CONTEXT.isfinite(value):
                assert float(value) == pytest.approx(float(got), rel=1e-9, abs=1e-12), name


def test_pi_in_the_equations_is_pi():
    plan = make_plan(
        "rectangle-on-plane", "thesis", ("vibration_acceleration",), ("frequency", "amplitude")
    )
    one = {"frequency": np.ones(1), "amplitude": np.ones(1)}
    (value,) = exact_values(plan, one)["vibration_acceleration"]
    with mpmath.workdps(DIGITS):
        assert abs(value - 4 * mpmath.pi**2) < mpmath.mpf(10) ** -47


def test_a_parameter_is_the_float_that_it_is():
    """Half a turn in floats is short of pi by 1.2e-16, and so is its sine."""
    plan = make_plan("rectangle-on-plane", "thesis", ("gravity_along",), ("gravity", "gamma"))
    half = {"gravity": np.ones(1), "gamma": np.array([np.pi])}
    (value,) = exact_values(plan, half)["gravity_along"]
    assert float(value) == pytest.approx(1.2246467991473532e-16, rel=1e-15)


def test_an_equation_that_rounds_has_no_value_rather_than_a_wrong_one():
    """The screws of this scene are made in floats."""
    sweep = prepare_content(read_content(ROOT / "configs/cylinder-rolling.toml"))
    plan = sweep.plan.only("floor_pitch")
    cells = sweep.grid.at(random_positions(sweep.grid, 3, 2004), 3, plan.parameters)
    with pytest.raises(NotPreciseError, match="cylinder-rolling"):
        exact_values(plan, cells)


def test_numbers_behave_as_floats_at_the_edges():
    values = [0.0, -0.0, 1.0, -1.0, math.inf, -math.inf, math.nan]
    for x in values:
        for y in values:
            with np.errstate(all="ignore"):
                want = float(np.float64(x) / np.float64(y))
            got = float((Number(x) / Number(y)).value)
            # mpmath has one zero: the sign of 1/-0 is that of 1/0.
            assert (math.isnan(got) and math.isnan(want)) or abs(got) == abs(want)
            assert (Number(x) < Number(y)) == (x < y)
