"""Regularised friction on a stiff floor: exact laws in the limit, and stiff on the way there."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.motions import regularised_motion
from mean_velocities import MEAN_VELOCITIES
from night import first_by_day
from vibrafeed.core.motion.methods import regularised
from vibrafeed.core.motion.methods.regularised import (
    COARSER,
    SAFETY,
    SOFTER,
    SOLVERS,
    TWICE_COARSER,
    follow_run,
)
from vibrafeed.core.motion.methods.regularised.laws import PEAK, Cell, laws
from vibrafeed.core.motion.result import STATUS

RANDOM = np.random.default_rng(139)
GROUPS = {name: case.groups() for name, case in MEAN_VELOCITIES.items()}


def motion(given: dict, **changes):
    settings = {
        "slip_speed": 1e-4, "contact_stiffness": 1e8, "tolerance": 1e-6, "max_periods": 60,
        "solver": "Radau", "planar": True,
    }  # fmt: skip
    return regularised_motion(**{**given, **settings, **changes})


@functools.cache
def worked(name: str, solver: str = "Radau"):
    """Return the motion of a worked value, which several tests look at.

    At 1e-7 the laws' error is far above the integrator's, which scatters: at 1e-6 sliding is found,
    by luck of the steps, between 2 and 100 times as well as estimated.
    """
    return motion(GROUPS[name], solver=solver, tolerance=1e-7)


def mean_of(name: str, slip_speed: float = 1e-4, contact_stiffness: float = 1e8) -> float:
    """Return the velocity alone of a worked value: three more runs tell the error."""
    given = GROUPS[name]
    kinetic, static, restitution = (
        given[key] for key in ("friction_kinetic", "friction_static", "restitution")
    )
    law = laws(kinetic, static, restitution, slip_speed, contact_stiffness)
    drive, gravity = (
        (given[f"{of}_number_along"], given[f"{of}_number_normal"]) for of in ("drive", "gravity")
    )
    _, orbit, _ = follow_run(Cell(law, drive, gravity), "Radau", 1e-7, 60)
    assert orbit.status == "periodic"
    return orbit.velocity


def test_the_velocity_alone_is_that_of_the_motion():
    assert worked("stick-slip").velocity == mean_of("stick-slip")


@pytest.mark.parametrize(
    ("name", "changes", "order"),
    first_by_day(
        [
            # A delay of slip_speed^(2/3) where friction passes its peak: there
            # slip du/dt = t - u^2, whose scale of t is slip^(2/3).
            ("stick-slip", {"slip_speed": [1e-5, 1e-6]}, 2 / 3),
            # Friction lacks the share (slip/u)^2/2 of its force, over a time slip/acceleration.
            ("sliding", {"slip_speed": [1e-3, 1e-4]}, 1),
            # The damped floor recovers in 2 x damping ratio/stiffness^(1/2), the ratio growing as
            # stiffness^(1/6).
            ("hop after hop", {"contact_stiffness": [1e7, 1e9]}, -1 / 3),
            ("hop", {"contact_stiffness": [1e7, 1e9]}, -1 / 3),
        ]
    ),
)
def test_worked_means_are_approached_at_the_order_of_the_laws(name, changes, order):
    ((setting, swept),) = changes.items()
    velocities = np.array([mean_of(name, **{setting: value}) for value in swept])
    errors = np.abs(velocities - MEAN_VELOCITIES[name].scaled)
    measured = np.diff(np.log(errors)) / np.diff(np.log(swept))
    # Before the limit the next order still adds its share, h^(1/3) at the worst: within a tenth
    # tells 1/3, 2/3 and 1 apart.
    assert measured == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("name", first_by_day(MEAN_VELOCITIES))
def test_the_estimate_covers_the_error_without_exaggeration(name):
    found = worked(name)
    error = abs(found.velocity - MEAN_VELOCITIES[name].scaled)
    # Factors 4 and 16: the difference is 1.5 times the error at the slowest orders, somewhat less
    # before the limit, and 3 times at order 1.
    assert 1.2 * SAFETY * error <= found.error <= 3.3 * SAFETY * error


@pytest.mark.night
@pytest.mark.parametrize(
    # LSODA may stay with its explicit formula after a landing.
    ("name", "solvers"),
    first_by_day([("stick-slip", SOLVERS), ("hop", ("Radau", "BDF"))]),
)
def test_integrators_agree(name, solvers):
    found = [worked(name, solver) for solver in solvers]
    for other in found[1:]:
        # A few thousand steps of 1e-7 each; the regularisation's own error is 1e-3 and more.
        assert other.velocity == pytest.approx(float(found[0].velocity), rel=1e-4)
        for field in ("stick", "forward", "backward", "flight", "landing_speed", "hop_height"):
            first = float(getattr(found[0], field))
            assert getattr(other, field) == pytest.approx(first, abs=1e-3), field


@pytest.mark.night
def test_flight_and_landing_of_a_hop():
    """The hop at a throw number of 1.2."""
    given = {**GROUPS["hop on a climb"], "gravity_number_along": 0.0, "gravity_number_normal": 1.0}
    stiffness, length, landing = np.array([1e6, 1e8]), 2.40230492451042, 0.575055135178
    found = motion(given | {"drive_number_normal": 1.2}, contact_stiffness=stiffness)
    # At lift-off the part is still as deep as the weight of its time of recovery, stiffness^(-1/3),
    # makes it: the hop, a cube of time at its start, is late by less than the cube root.
    allowed = (6 * stiffness ** (-4 / 3)) ** (1 / 3)
    assert np.all(np.abs(2 * np.pi * found.flight - length) < allowed)
    assert np.all(np.abs(found.landing_speed - landing) < allowed)
    assert np.all(found.impacts == 1)
    shares = found.stick + found.forward + found.backward + found.flight
    assert shares == pytest.approx(np.ones(2), abs=1e-12)  # cuts of one period


@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.5, 0.2, math.exp(-2), 0.05])
def test_an_impact_gives_the_restitution_at_any_speed(restitution):
    stiffness = 1e8
    law = laws(0.0, 0.0, restitution, 1e-4, stiffness)
    for speed in (0.1, 1.0, 50.0):

        def force(time, state, law=law):
            return law.unclamped(-state[0], -state[1])

        force.terminal, force.direction = True, -1
        path = solve_ivp(
            lambda time, state: [state[1], -force(time, state)], (0, 1), [1e-16, speed],
            events=force, rtol=1e-10, atol=1e-14 * speed,
        )  # fmt: skip
        # The damper is missing over the depth of the weight, 1/stiffness, of a way of
        # speed/stiffness^(1/2) and more over 2 damping ratios: up to 7 are needed here.
        missing = 10 / (speed * stiffness**0.5)
        assert -path.y[1, -1] / speed == pytest.approx(restitution, rel=missing)


def test_friction_stays_in_its_cone_and_reaches_both_coefficients():
    for kinetic, static in ((0.3, 0.3), (0.25, 0.35), (0.0, 0.5), (0.1, 2.0), (0.3, 0.3001)):
        law = laws(kinetic, static, 0.0, 1e-5, 1e6)
        speeds = np.concatenate([np.geomspace(1e-9, 1e-1, 4001), [PEAK * 1e-5]])
        ratio = np.array([law.friction(speed)[0] * speed for speed in speeds])
        assert np.all(ratio <= static * (1 + 1e-14))
        # At 1e4 slip speeds the law is short by (1e-4)^2/2.
        assert ratio[-2] == pytest.approx(kinetic, rel=1e-8)
        if static > kinetic:
            assert ratio[-1] == pytest.approx(static, rel=1e-14)


def random_cell(coordinates: int) -> tuple[Cell, np.ndarray]:
    drive, gravity = RANDOM.uniform(-3, 3, (2, coordinates))
    law = laws(0.3, RANDOM.choice([0.3, 0.5]), RANDOM.uniform(), 0.05, 100.0)
    return Cell(law, tuple(drive), (*gravity[:-1], 1.0)), RANDOM.normal(size=2 * coordinates) * 0.1


@pytest.mark.parametrize("coordinates", [2, 3])
def test_jacobian_is_the_derivative(coordinates):
    for _ in range(200):
        cell, state = random_cell(coordinates)
        step = 1e-6  # a central difference errs by step^2 and by rounding over step
        spring = -cell.laws.stiffness * state[coordinates - 1]
        force = cell.laws.unclamped(state[coordinates - 1], state[-1])
        if min(abs(spring), abs(force), abs(spring - 1)) < 1e-2:
            continue  # the force of the floor has a kink here
        numeric = [
            np.subtract(cell.rate(1.0, state + move), cell.rate(1.0, state - move)) / (2 * step)
            for move in step * np.eye(2 * coordinates)
        ]
        exact = cell.jacobian(1.0, state)
        np.testing.assert_allclose(np.transpose(numeric), exact, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("coordinates", [2, 3])
def test_contact_takes_energy_and_never_pulls(coordinates):
    n = coordinates
    for _ in range(500):
        cell, state = random_cell(n)
        free = [d * math.sin(1.0) - g for d, g in zip(cell.drive, cell.gravity, strict=True)]
        force = np.array(cell.rate(1.0, state)[n:]) - free
        velocity, height = state[n:], state[n - 1]
        assert force[-1] >= -1e-14
        assert math.hypot(*force[:-1]) <= cell.laws.friction_static * force[-1] + 1e-14
        # Power of the contact, without what its spring stores.
        stored = cell.laws.stiffness * min(height, 0.0) * velocity[-1]
        assert force @ velocity + stored <= 1e-13


def test_energy_is_kept_on_a_floor_without_loss():
    given = {**GROUPS["hop on a climb"], "friction_kinetic": 0.0, "friction_static": 0.0}
    law = laws(0.0, 0.0, 1.0, 1e-4, 1e4)
    cell = Cell(law, (0.0, 0.0), (0.0, given["gravity_number_normal"]))
    path = solve_ivp(
        cell.rate, (0, 20), [0, 1.0, 0.3, 0], "Radau", rtol=1e-9, atol=1e-11, jac=cell.jacobian
    )
    _, height, along, climb = path.y
    energy = climb**2 / 2 + cell.gravity[-1] * height + 1e4 * np.minimum(height, 0) ** 2 / 2
    # Seven impacts of some hundred steps of 1e-9, of forces a hundred times the weight.
    assert energy == pytest.approx(np.full(len(energy), energy[0]), rel=1e-5)
    assert np.all(along == 0.3)


@pytest.mark.night
def test_a_turned_drive_turns_the_motion():
    """Friction is a disc: across the line of the drive no impact occurs (theory 13.1)."""
    given = {**GROUPS["hop"]}
    straight = motion(given, planar=False, tolerance=1e-7)
    drive = given["drive_number_along"]
    given["drive_number_along"] = drive * 0.6
    given["drive_number_across"] = drive * 0.8
    turned = motion(given, planar=False, tolerance=1e-7)
    flat = worked("hop")
    # Integrators weigh the errors by component: equal within their tolerance only.
    assert turned.velocity == pytest.approx(0.6 * float(straight.velocity), rel=1e-4)
    assert flat.velocity == pytest.approx(float(straight.velocity), rel=1e-4)
    assert turned.flight == pytest.approx(float(straight.flight), abs=1e-4)


def test_the_problem_is_stiff():
    """An explicit integrator needs steps of slip_speed/friction, whatever it wants to resolve."""
    given = GROUPS["stick-slip"]
    slip = 1e-8
    drive = given["drive_number_along"], given["drive_number_normal"]
    cell = Cell(laws(0.25, 0.35, 0.0, slip, 1e4), drive, (0.0, 1.0))
    settings = {"rtol": 1e-6, "atol": 1e-6 * np.array([1, 1e-4, slip, 1])}
    span = 1e-4  # of phase, at rest
    explicit = solve_ivp(cell.rate, (0, span), cell.rest(), "RK45", **settings).nfev
    whole = (0, 2 * math.pi)
    implicit = solve_ivp(cell.rate, whole, cell.rest(), "Radau", jac=cell.jacobian, **settings)
    # RK45 is stable up to 3.3 over the rate of decay; at rest the force is weight x friction x
    # u/slip, with 0.25/slip at least, and a step takes 6 evaluations.
    assert explicit >= 6 * span * 0.25 / slip / 3.3
    # A period of Radau takes some ten thousand, so RK45 some 1e5 times as many.
    needed = explicit * 2 * math.pi / span
    assert needed > 1000 * implicit.nfev


def test_a_part_at_rest_creeps_in_proportion_to_the_slip_speed():
    given = {**GROUPS["stick-slip"], "drive_number_along": 0.1, "drive_number_normal": 0.1}
    given["gravity_number_along"] = 0.05
    slip = np.array([1e-3, 1e-4])
    found = motion(given, slip_speed=slip, tolerance=1e-8)
    assert np.all(found.status == STATUS["periodic"])
    assert np.all(found.stick == 1)
    assert np.all(np.abs(found.velocity) < slip)
    # A scale of the same quasi-static balance, up to the inertia, a further order of slip speed.
    assert found.velocity[0] == pytest.approx(10 * found.velocity[1], rel=0.01)
    # The estimate of the error is then the creep itself: the truth is 0.
    assert np.all(found.error >= np.abs(found.velocity))


def test_what_has_no_mean_says_so(monkeypatch):
    given = GROUPS["hop on a climb"]
    steep = motion(given, gravity_number_along=0.6, gravity_number_normal=0.8)
    assert steep.status == STATUS["runaway"]
    assert np.isnan(steep.velocity)
    assert motion(given, gravity_number_normal=-0.1).status == STATUS["runaway"]
    assert motion(given, friction_kinetic=math.nan).status == STATUS["no_solution"]
    assert motion(given, slip_speed=0.0).status == STATUS["no_solution"]
    smooth = motion(
        given | {"friction_kinetic": 0.0, "friction_static": 0.0, "gravity_number_along": 0.0}
    )
    assert smooth.status == STATUS["neutral"]
    # At rest on the track at phase 0: the mean is the amplitude of the drive's velocity.
    # No friction damps the errors of some hundred steps of 1e-6.
    assert smooth.velocity == pytest.approx(given["drive_number_along"], rel=1e-3)
    short = motion(given, max_periods=2)
    assert short.status == STATUS["limit_reached"]
    assert np.isfinite(short.velocity)
    for solver in SOLVERS:
        with monkeypatch.context() as patch:
            patch.setattr(regularised, "MAX_EVALUATIONS", 50)
            assert motion(given, solver=solver).status == STATUS["limit_reached"]


def test_arguments_broadcast_and_wrong_requests_are_refused():
    given = GROUPS["stick-slip"]
    soft = {"contact_stiffness": 1e4, "tolerance": 1e-4}  # it is no matter of accuracy
    found = motion(given, friction_kinetic=[[0.25], [0.3]], slip_speed=[1e-1, 1e-2], **soft)
    assert all(field.shape == (2, 2) for field in found)
    single = motion(given, friction_kinetic=0.3, slip_speed=1e-2, **soft)
    assert found.velocity[1, 1] == single.velocity
    with pytest.raises(ValueError, match="solver"):
        motion(given, solver="RK45")
    with pytest.raises(ValueError, match="across"):
        motion(given, drive_number_across=0.1)


def test_the_estimate_compares_with_twice_and_a_half():
    assert pytest.approx(SOFTER ** (1 / 3)) == COARSER ** (2 / 3)
    assert (COARSER**2 - 1) / (COARSER - 1) == TWICE_COARSER
