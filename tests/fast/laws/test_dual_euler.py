"""The dual Euler equation (2.14) is Newton-Euler (2.2), for every point of every body."""

import numpy as np

from plans import make_plan
from screws import (
    Twist,
    body_to_reference,
    dual_euler,
    inertia_about,
    momentum_screw,
    newton_euler,
)

RANDOM = np.random.default_rng(214)
POINTS = 5_000


def test_dual_euler_about_any_point_is_newton_euler_and_the_sum_over_point_masses():
    # No inertia and no theorem about moving it: each point mass needs m a at its own place.
    places, masses = RANDOM.normal(size=(5, POINTS, 3)), RANDOM.uniform(0.1, 1, (5, POINTS))
    w, v, wdot, vdot = RANDOM.normal(size=(4, POINTS, 3))
    twist, rate, total = Twist(w, v), Twist(wdot, vdot), masses.sum(0)
    centre = np.einsum("kp,kpi->pi", masses, places) / total[:, None]
    force, moment, central = np.zeros((POINTS, 3)), np.zeros((POINTS, 3)), np.zeros((POINTS, 3, 3))
    for r, m in zip(places, masses, strict=True):
        a = vdot + np.cross(w, v) + np.cross(wdot, r) + np.cross(w, np.cross(w, r))
        force += m[:, None] * a
        moment += np.cross(r, m[:, None] * a)
        central += inertia_about(mass=m, central_inertia=np.zeros((3, 3)), offset=r - centre)
    about_a = inertia_about(mass=total, central_inertia=central, offset=centre)
    body = {"mass": total, "inertia": about_a, "mass_centre": centre}
    # In body components the momentum is linear in the twist, with constant coefficients.
    by_screws = dual_euler(
        momentum=momentum_screw(**body, twist=twist),
        momentum_rate=momentum_screw(**body, twist=rate), twist=twist,
    )  # fmt: skip
    about_centre = newton_euler(
        mass=total, central_inertia=central, twist=twist.moved_to(centre),
        twist_rate=rate.moved_to(centre),
    )  # fmt: skip
    for wrench in (by_screws, about_centre.moved_to(-centre)):
        np.testing.assert_allclose(wrench.real, force, rtol=0, atol=1e-11)
        np.testing.assert_allclose(wrench.dual, moment, rtol=0, atol=1e-11)


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
    assert pressed.sum() > 250
    assert np.max(np.abs(solution[:, 9][pressed] - moment) / size[pressed]) < 1e-12


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
