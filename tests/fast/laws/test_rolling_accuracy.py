"""Every output of the rolling cylinder at 60 digits: errors of a few ulp times the condition.

The condition number of an output is the sum over its parameters of |x f'(x)/f(x)|: what an error of
one ulp in each parameter does to it. An output that is 0 by cancellation has none and is measured
against the sizes of its terms.
"""

import numpy as np
import pytest

from many_digits import mp, mpf
from plans import quantities_at
from vibrafeed.core.scenes import SCENES

POINTS = 60
EPS = np.finfo(float).eps
MAX_ULP = 8
SCENE = SCENES["cylinder-rolling"]
OUTPUTS = [name for name in SCENE.outputs("derived") if name != "regime"]
NO_VALUE_BUT_ROUNDING = {"force_pitch"}


def ordinary(random: np.random.Generator, points: int) -> dict[str, np.ndarray]:
    """Return parameters as people have them; angles in radians."""
    return {
        "frequency": random.uniform(5, 200, points),
        "amplitude": 10 ** random.uniform(-6, -3, points),
        "alpha": random.uniform(-np.pi, np.pi, points),
        "beta": random.uniform(-np.pi / 2, np.pi / 2, points),
        "axis_yaw": random.uniform(-np.pi, np.pi, points),
        "spin_rate": random.normal(size=points) * 100,
        "yaw_rate": random.normal(size=points) * 10,
        "drilling_moment": random.normal(size=points) * 1e-5,
        "diameter": 10 ** random.uniform(-3.5, -1, points),
        "length": 10 ** random.uniform(-3.5, -0.5, points),
        "mass": 10 ** random.uniform(-5, 1, points),
        "gravity": np.full(points, 9.8),
        "friction_static": random.uniform(0, 2, points),
    }


def extreme(random: np.random.Generator, points: int) -> dict[str, np.ndarray]:
    """Return parameters over many decades."""
    angles = {n: 10 ** random.uniform(-12, 0.19, points) for n in ("alpha", "beta", "axis_yaw")}
    return {
        **angles,
        "frequency": 10 ** random.uniform(-20, 8, points),
        "amplitude": 10 ** random.uniform(-30, 3, points),
        "spin_rate": random.choice([-1, 1], points) * 10 ** random.uniform(-30, 12, points),
        "yaw_rate": random.choice([-1, 1], points) * 10 ** random.uniform(-30, 12, points),
        "drilling_moment": random.choice([-1, 1], points) * 10 ** random.uniform(-30, 12, points),
        "diameter": 10 ** random.uniform(-15, 6, points),
        "length": 10 ** random.uniform(-15, 6, points),
        "mass": 10 ** random.uniform(-30, 12, points),
        "gravity": 10 ** random.uniform(-6, 4, points),
        "friction_static": 10 ** random.uniform(-12, 3, points),
    }


def exact(x: dict[str, mpf]) -> dict[str, mpf]:
    """Return the outputs by the formulas of theory 9, from the parameters alone."""
    m, r, L, g = x["mass"], x["diameter"] / 2, x["length"], x["gravity"]
    P = x["amplitude"] * (2 * mp.pi * x["frequency"]) ** 2
    turn, beta = x["alpha"] + x["axis_yaw"], x["beta"]
    eta, sigma = P * mp.cos(beta) * mp.sin(turn), P * mp.cos(beta) * mp.cos(turn)
    n0 = g - P * mp.sin(beta)
    spin, yaw, M_z = x["spin_rate"], x["yaw_rate"], x["drilling_moment"]
    u, I3 = r * spin * yaw, m * r**2 / 2
    F_eta, F_sigma, N = m * eta / 3, m * (sigma - u), m * n0
    friction = mp.hypot(F_eta, F_sigma)
    moment = (M_z, -I3 * yaw * spin, r * F_eta)
    results = {
        "vibration_acceleration": P,
        "drive_normal": P * mp.sin(beta),
        "rolling_drive": eta,
        "axial_drive": sigma,
        "gravity_normal": g,
        "normal_acceleration": n0,
        "throw_number": P * mp.sin(beta) / g,
        "floor_acceleration": n0,
        "floor_force": N,
        "axial_friction_acceleration": sigma - u,
        "rolling_friction": F_eta,
        "axial_friction": F_sigma,
        "spin_acceleration": 2 * eta / (3 * r),
        "yaw_acceleration": M_z / (m * (3 * r**2 + L**2) / 12),
        "printed_yaw_rate": 2 * sigma / (3 * r * spin),
        "pressure_offset_axial": r * (sigma - u * 3 / 2) / n0 if n0 > 0 else mp.nan,
        "required_friction": friction / N if n0 > 0 else mp.inf,
        "cone_margin": x["friction_static"] * N - friction,
    }
    for name, force in (
        ("floor", (N, -F_eta, -F_sigma)),
        ("force", (mpf(0), m * r * results["spin_acceleration"], m * u)),
    ):
        square = sum(f * f for f in force)
        pitch = sum(f * c for f, c in zip(force, moment, strict=True)) / square
        (a, b, c), (d, e, f) = force, moment
        axis = (b * f - c * e, c * d - a * f, a * e - b * d)
        results[f"{name}_pitch"] = pitch
        for direction, value in zip(("normal", "rolling", "axial"), axis, strict=True):
            results[f"{name}_axis_{direction}"] = value / square
    return results


def worst_ulp(points: dict[str, np.ndarray]) -> dict[str, float]:
    """Return the largest error of each output in ulp over its condition number, at least 1."""
    count = len(points["mass"])
    known = quantities_at("cylinder-rolling", "derived", OUTPUTS, points)
    values = {name: np.broadcast_to(known[name], count) for name in OUTPUTS}
    worst = dict.fromkeys(OUTPUTS, 0.0)
    with mp.workdps(90):
        step = mpf(10) ** -30
        for i in range(count):
            x = {name: mpf(float(value[i])) for name, value in points.items()}
            at = exact(x)
            moved = [exact({**x, name: value * (1 + step)}) for name, value in x.items()]
            for name in OUTPUTS:
                got, expected = float(values[name][i]), at[name]
                if not mp.isfinite(expected):
                    assert not np.isfinite(got), name
                    continue
                shifts = sum(abs((other[name] - expected) / step) for other in moved)
                allowed = max(abs(expected), shifts) * EPS
                if name in NO_VALUE_BUT_ROUNDING:
                    allowed = EPS * x["diameter"]
                # an output below the least normal float has fewer digits
                allowed = max(allowed, mpf(2) ** -1060)
                worst[name] = max(worst[name], float(abs(mpf(got) - expected) / allowed))
    return worst


@pytest.mark.parametrize("kind", [ordinary, extreme])
def test_outputs_are_right_to_a_few_ulp_times_their_condition(kind):
    worst = worst_ulp(kind(np.random.default_rng(9), POINTS))
    assert {name: ulp for name, ulp in worst.items() if ulp > MAX_ULP} == {}
