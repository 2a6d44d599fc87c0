"""The dual Euler equation (2.14) is Newton-Euler (2.2), for every point of every body."""

import numpy as np

from core.mechanics.rotations import body_to_reference
from core.mechanics.screws import (
    MomentumScrew,
    Twist,
    Wrench,
    cross,
    dot,
    dual_euler,
    inertia_about,
    momentum_screw,
    newton_euler,
    power,
)

RANDOM = np.random.default_rng(214)
POINTS = 20_000


def vectors(decades: float = 0.0) -> np.ndarray:
    size = 10 ** RANDOM.uniform(-decades, decades, (POINTS, 1))
    return RANDOM.normal(size=(POINTS, 3)) * size


def bodies() -> tuple[np.ndarray, np.ndarray]:
    """Return masses and central inertias of real bodies: point masses about their centre."""
    places = RANDOM.normal(size=(POINTS, 6, 3))
    masses = RANDOM.uniform(0.1, 1, (POINTS, 6))
    total = masses.sum(-1)
    places -= (np.einsum("pk,pki->pi", masses, places) / total[:, None])[:, None]
    inertia = sum(
        inertia_about(mass=masses[:, k], central_inertia=np.zeros((3, 3)), offset=places[:, k])
        for k in range(6)
    )
    return total, inertia


MASS, INERTIA = bodies()
# The point A of the body: anywhere, moving and accelerating as the body has it.
CENTRE = vectors(1.0)
TWIST = Twist(vectors(1.0), vectors(1.0))
RATE = Twist(vectors(1.0), vectors(1.0))


def required_about_a() -> Wrench:
    about_a = inertia_about(mass=MASS, central_inertia=INERTIA, offset=CENTRE)
    body = {"mass": MASS, "inertia": about_a, "mass_centre": CENTRE}
    # in body components the momentum is linear in the twist, with constant coefficients
    return dual_euler(
        momentum=momentum_screw(**body, twist=TWIST),
        momentum_rate=momentum_screw(**body, twist=RATE),
        twist=TWIST,
    )


def largest_error(one: np.ndarray, other: np.ndarray, scale: np.ndarray) -> float:
    return float(np.max(np.linalg.norm(one - other, axis=-1) / scale))


def scales() -> tuple[np.ndarray, np.ndarray]:
    """Return the sizes of what the force and the moment about A add up."""
    w, v, c = (np.linalg.norm(x, axis=-1) for x in (TWIST.angular, TWIST.linear, CENTRE))
    wdot, vdot = (np.linalg.norm(x, axis=-1) for x in (RATE.angular, RATE.linear))
    acceleration = vdot + wdot * c + w * (v + w * c)
    inertia = np.linalg.norm(INERTIA, axis=(-1, -2)) + MASS * c * c
    # V x q holds m V x V, which is nothing but leaves its rounding
    moment = MASS * (acceleration * c + v * v) + inertia * (wdot + w * w)
    return MASS * acceleration, moment


def test_dual_euler_about_any_point_of_the_body_is_newton_euler_about_its_centre():
    wrench = required_about_a()
    expected = newton_euler(
        mass=MASS,
        central_inertia=INERTIA,
        twist=TWIST.moved_to(CENTRE),
        twist_rate=RATE.moved_to(CENTRE),
    ).moved_to(-CENTRE)
    force_scale, moment_scale = scales()
    assert largest_error(wrench.force, expected.force, force_scale) < 1e-14
    assert largest_error(wrench.moment, expected.moment, moment_scale) < 1e-14
    # the bar: 1e-11 of the result itself, cancellation included
    norm = np.linalg.norm
    assert largest_error(wrench.force, expected.force, norm(expected.force, axis=-1)) < 1e-11
    assert largest_error(wrench.moment, expected.moment, norm(expected.moment, axis=-1)) < 1e-11


def test_dual_euler_is_the_sum_over_point_masses():
    # No inertia and no theorem about moving it: each point mass needs m a at its own place.
    places, masses = RANDOM.normal(size=(POINTS, 5, 3)), RANDOM.uniform(0.1, 1, (POINTS, 5))
    w, v, wdot, vdot = TWIST.angular, TWIST.linear, RATE.angular, RATE.linear
    force, moment, inertia = np.zeros((POINTS, 3)), np.zeros((POINTS, 3)), np.zeros((POINTS, 3, 3))
    for k in range(5):
        r, m = places[:, k], masses[:, k]
        a = vdot + cross(w, v) + cross(wdot, r) + cross(w, cross(w, r))
        force += m[:, None] * a
        moment += cross(r, m[:, None] * a)
        inertia += inertia_about(mass=m, central_inertia=np.zeros((3, 3)), offset=r)
    total = masses.sum(-1)
    centre = np.einsum("pk,pki->pi", masses, places) / total[:, None]
    body = {"mass": total, "inertia": inertia, "mass_centre": centre}
    wrench = dual_euler(
        momentum=momentum_screw(**body, twist=TWIST),
        momentum_rate=momentum_screw(**body, twist=RATE),
        twist=TWIST,
    )
    norm = np.linalg.norm
    assert largest_error(wrench.force, force, norm(force, axis=-1)) < 1e-11
    assert largest_error(wrench.moment, moment, norm(moment, axis=-1)) < 1e-11


def test_momentum_of_any_point_is_that_of_the_centre_moved_there():
    at_centre = momentum_screw(
        mass=MASS, inertia=INERTIA, mass_centre=np.zeros(3), twist=TWIST.moved_to(CENTRE)
    )
    about_a = inertia_about(mass=MASS, central_inertia=INERTIA, offset=CENTRE)
    at_a = momentum_screw(mass=MASS, inertia=about_a, mass_centre=CENTRE, twist=TWIST)
    moved = at_centre.moved_to(-CENTRE)
    size = MASS * (1 + np.linalg.norm(CENTRE, axis=-1)) * 1e3
    assert largest_error(at_a.linear, moved.linear, size) < 1e-14
    assert largest_error(at_a.angular, moved.angular, size * 1e3) < 1e-14


def test_power_is_the_rate_of_kinetic_energy():
    about_a = inertia_about(mass=MASS, central_inertia=INERTIA, offset=CENTRE)
    body = {"mass": MASS, "inertia": about_a, "mass_centre": CENTRE}
    # E = (q.V + H.w)/2 is quadratic in the twist: its rate is momentum times the twist's rate.
    momentum = momentum_screw(**body, twist=TWIST)
    rate = dot(momentum.linear, RATE.linear) + dot(momentum.angular, RATE.angular)
    force_scale, moment_scale = scales()
    size = force_scale * np.linalg.norm(TWIST.linear, axis=-1)
    size += moment_scale * np.linalg.norm(TWIST.angular, axis=-1)
    assert np.max(np.abs(power(required_about_a(), TWIST) - rate) / size) < 1e-14


def test_the_law_is_that_of_a_resting_observer():
    # Momentum seen in resting axes, through a finite turn, by central differences: no w x term.
    step = 1e-6
    turn = body_to_reference(
        about_x=TWIST.angular[:, 0] * step,
        about_y=TWIST.angular[:, 1] * step,
        about_z=TWIST.angular[:, 2] * step,
    )
    about_a = inertia_about(mass=MASS, central_inertia=INERTIA, offset=CENTRE)
    body = {"mass": MASS, "inertia": about_a, "mass_centre": CENTRE}

    def momentum(t: float) -> MomentumScrew:
        twist = Twist(TWIST.angular + t * RATE.angular, TWIST.linear + t * RATE.linear)
        seen = momentum_screw(**body, twist=twist)
        matrix = turn if t > 0 else np.swapaxes(turn, -1, -2)
        # the resting point lies behind the body's by the way that A has gone
        return seen.rotated(matrix).moved_to(-t * TWIST.linear)

    ahead, behind = momentum(step), momentum(-step)
    wrench = required_about_a()
    force_scale, moment_scale = scales()
    slow = np.linalg.norm(TWIST.angular, axis=-1) < 10
    force = (ahead.linear - behind.linear) / (2 * step)
    moment = (ahead.angular - behind.angular) / (2 * step)
    assert largest_error(force[slow], wrench.force[slow], force_scale[slow]) < 1e-4
    assert largest_error(moment[slow], wrench.moment[slow], moment_scale[slow]) < 1e-4
