"""The dual Euler equation (2.14) is Newton-Euler (2.2), for every point of every body."""

import numpy as np

from plans import make_plan
from screws import (
    MomentumScrew,
    Twist,
    Wrench,
    body_to_reference,
    dual_euler,
    inertia_about,
    momentum_screw,
    newton_euler,
    power,
)
from vibrafeed.core.mechanics.screws import dot, vector

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
        a = vdot + np.cross(w, v) + np.cross(wdot, r) + np.cross(w, np.cross(w, r))
        force += m[:, None] * a
        moment += np.cross(r, m[:, None] * a)
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


# --- the rolling cylinder's closed forms, against balances that know nothing of them

RATES = {
    "spin_rate": RANDOM.normal(size=POINTS) * 100,
    "yaw_rate": RANDOM.normal(size=POINTS) * 10,
}
ROLLING = {
    **RATES,
    "frequency": RANDOM.uniform(5, 200, POINTS),
    "amplitude": 10 ** RANDOM.uniform(-6, -3, POINTS),
    "alpha": RANDOM.uniform(-np.pi, np.pi, POINTS),
    "beta": RANDOM.uniform(-0.5, 0.5, POINTS),
    "axis_yaw": RANDOM.uniform(-np.pi, np.pi, POINTS),
    "gravity": np.full(POINTS, 9.8),
    "diameter": 10 ** RANDOM.uniform(-3, -1, POINTS),
    "length": 10 ** RANDOM.uniform(-3, -1, POINTS),
    "mass": 10 ** RANDOM.uniform(-4, 0, POINTS),
    "friction": np.full(POINTS, 0.3),
    "drilling_moment": RANDOM.normal(size=POINTS) * 1e-4,
}
OUTPUTS = (
    "rolling_friction", "axial_friction", "floor_force", "spin_acceleration",
    "yaw_acceleration", "pressure_offset_axial", "floor_pitch", "force_pitch",
)  # fmt: skip


def rolling() -> dict:
    """Return every quantity of the plan of a rolling cylinder, at random points."""
    plan = make_plan("cylinder-rolling", "derived", list(OUTPUTS), list(ROLLING))
    known = dict(ROLLING)
    for equation in plan.equations:
        known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    return known


def test_the_rolling_cylinder_solves_newton_euler_in_resting_axes():
    at = rolling()
    m, r, L = ROLLING["mass"], ROLLING["diameter"] / 2, ROLLING["length"]
    spin, yaw = ROLLING["spin_rate"], ROLLING["yaw_rate"]
    # The triad n, eta, sigma anywhere in space.
    x, y, z = RANDOM.uniform(-np.pi, np.pi, (3, POINTS))
    triad = np.moveaxis(body_to_reference(about_x=x, about_y=y, about_z=z), -1, 0)
    n, eta, sigma = triad
    w = yaw[:, None] * n + spin[:, None] * sigma
    I1, I3 = m * (3 * r * r + L * L) / 12, m * r * r / 2
    inertia = I1[:, None, None] * np.eye(3)
    inertia = inertia + (I3 - I1)[:, None, None] * sigma[..., :, None] * sigma[..., None, :]
    H = np.einsum("pij,pj->pi", inertia, w)
    P = ROLLING["amplitude"] * (2 * np.pi * ROLLING["frequency"]) ** 2
    cb, turn = np.cos(ROLLING["beta"]), ROLLING["alpha"] + ROLLING["axis_yaw"]
    drive = (P * cb * np.sin(turn))[:, None] * eta + (P * cb * np.cos(turn))[:, None] * sigma
    drive = drive + (P * np.sin(ROLLING["beta"]) - 9.8)[:, None] * n
    # Unknowns: acceleration (3) and angular acceleration (3) of the body, normal force,
    # friction along eta and sigma at mid-length of the contact line, moment about eta there;
    # all times and lengths in units of the body's own, so that the matrix is well scaled.
    A, b = np.zeros((POINTS, 10, 10)), np.zeros((POINTS, 10))
    arm = -r[:, None] * n
    A[:, :3, :3] = np.eye(3)
    for column, direction in ((6, n), (7, -eta), (8, -sigma)):
        A[:, :3, column] = -direction
        A[:, 3:6, column] = -np.cross(arm, direction) / r[:, None]
    b[:, :3] = drive
    A[:, 3:6, 3:6] = inertia / (m * r * r)[:, None, None]
    A[:, 3:6, 9] = -eta
    gyroscopic = ROLLING["drilling_moment"][:, None] * n - np.cross(w, H)
    b[:, 3:6] = gyroscopic / (m * r)[:, None]
    # V = r (w.sigma) eta, differentiated: eta turns with yaw towards sigma.
    A[:, 6:9, :3] = np.eye(3)
    A[:, 6:9, 3:6] = -eta[..., :, None] * sigma[..., None, :]
    b[:, 6:9] = (r * spin * yaw)[:, None] * sigma
    # The axis stays level: w.eta = 0, differentiated.
    A[:, 9, 3:6] = eta
    b[:, 9] = -r * yaw * spin
    solution = np.linalg.solve(A, b[..., None])[..., 0]
    size = np.max(np.abs(b), -1) * np.maximum(1, (L / r) ** 2)
    pairs = {
        "spin_acceleration": (np.sum(solution[:, 3:6] * sigma, -1), r),
        "yaw_acceleration": (np.sum(solution[:, 3:6] * n, -1), r),
        "floor_force": (solution[:, 6], 1 / m),
        "rolling_friction": (solution[:, 7], 1 / m),
        "axial_friction": (solution[:, 8], 1 / m),
    }
    for name, (value, unit) in pairs.items():
        assert np.max(np.abs(value - at[name] * unit) / size) < 1e-13, name
    pressed = at["normal_acceleration"] > 1e-3
    moment = (at["pressure_offset_axial"] * at["floor_force"] / (m * r))[pressed]
    assert pressed.sum() > 1000
    assert np.max(np.abs(solution[:, 9][pressed] - moment) / size[pressed]) < 1e-12


def test_the_force_system_of_a_rolling_cylinder_is_the_rate_of_momentum_about_any_point():
    at = rolling()
    m, r, L = ROLLING["mass"], ROLLING["diameter"] / 2, ROLLING["length"]
    spin, yaw = ROLLING["spin_rate"], ROLLING["yaw_rate"]
    I1, I3, none = m * (3 * r * r + L * L) / 12, m * r * r / 2, np.zeros(POINTS)
    # Axes n, eta, sigma turn with the yaw only; the cylinder is the same in them at any spin.
    point = RANDOM.normal(size=(POINTS, 3)) * r[:, None]
    momentum = MomentumScrew(
        vector(none, m * r * spin, none), vector(I1 * yaw, none, I3 * spin)
    ).moved_to(point)
    phi, theta = at["spin_acceleration"], at["yaw_acceleration"]
    rate = MomentumScrew(
        vector(none, m * r * phi, none), vector(I1 * theta, none, I3 * phi)
    ).moved_to(point)
    axes = Twist(vector(yaw, none, none), vector(none, r * spin, none)).moved_to(point)
    required = dual_euler(momentum=momentum, momentum_rate=rate, twist=axes)
    expected = Wrench(at["force_wrench"].force, at["force_wrench"].moment).moved_to(point)
    norm = np.linalg.norm
    force, moment = norm(expected.force, axis=-1), norm(expected.moment, axis=-1)
    kinetic = m * (r * spin) ** 2  # V x m V, nothing but its rounding
    assert largest_error(required.force, expected.force, force) < 1e-14
    assert largest_error(required.moment, expected.moment, moment + kinetic) < 1e-14
    # The floor carries what drive and gravity do not.
    applied = vector(
        at["drive_normal"] - at["gravity_normal"], at["rolling_drive"], at["axial_drive"]
    )
    total = Wrench(m[:, None] * applied, np.zeros(3)) + at["floor_wrench"]
    size = m * (norm(applied, axis=-1) + np.abs(r * spin * yaw))
    assert largest_error(total.force, at["force_wrench"].force, size) < 1e-15
    np.testing.assert_array_equal(total.moment, at["force_wrench"].moment)


def test_pitches_of_a_rolling_cylinder_are_those_of_theory_9():
    at = rolling()
    pressed = at["normal_acceleration"] > 0
    F_eta, F_sigma, N = at["rolling_friction"], at["axial_friction"], at["floor_force"]
    square = F_eta**2 + F_sigma**2 + N**2
    e = np.where(pressed, at["pressure_offset_axial"], 0.0)
    expected = N * (ROLLING["drilling_moment"] - e * F_eta) / square
    size = np.abs(N) * np.abs(ROLLING["drilling_moment"]) / square
    size += ROLLING["diameter"]
    turning = ROLLING["mass"] * ROLLING["diameter"] * RATES["spin_rate"] * RATES["yaw_rate"]
    size *= 1 + np.abs(turning) / np.sqrt(square)
    error = np.abs(at["floor_pitch"] - expected)[pressed] / size[pressed]
    assert np.max(error) < 1e-14
    assert np.all(np.abs(at["force_pitch"]) <= 4e-16 * ROLLING["diameter"])
