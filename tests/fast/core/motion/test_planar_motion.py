"""Planar motion against values from elsewhere: closed forms, worked values, published speeds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.motions import planar_motion, planar_path
from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.quantities import MOTION_STATUSES

STATUS = {name: flag.value for name, flag in MOTION_STATUSES.items()}
SETTINGS = {"tolerance": 1e-12, "max_periods": 1000.0}


def groups(
    *, beta, mu, gamma=0.0, throw=None, drive=None, mu_static=None, e=0.0
) -> dict[str, float]:
    """Return the groups of a part: angles in degrees, throw number or drive number."""
    beta, gamma = math.radians(beta), math.radians(gamma)
    p = throw * math.cos(gamma) / math.sin(beta) if drive is None else drive
    return {
        "drive_number_along": p * math.cos(beta),
        "drive_number_normal": p * math.sin(beta),
        "gravity_number_along": math.sin(gamma),
        "gravity_number_normal": math.cos(gamma),
        "friction_static": mu if mu_static is None else mu_static,
        "friction_kinetic": mu,
        "restitution": e,
    }


def motion(**case):
    return planar_motion(**{k: np.asarray(v) for k, v in {**groups(**case), **SETTINGS}.items()})


def velocity(frequency: float, gravity: float = 9.81, amplitude: float | None = None, **case):
    """Return the mean velocity [m/s]."""
    w = 2 * math.pi * frequency
    if amplitude is not None:
        case["drive"] = amplitude * w * w / gravity
    return float(motion(**case).velocity) * gravity / w


# --- closed forms


def two_sided_speed(q: float, beta: float, mu: float, drive: float) -> float:
    """Return the mean velocity of sliding without stick on the level, in g/w (theory 13.8)."""
    sine = math.pi * mu / (2 * drive * math.cos(beta) * math.cos(math.pi * q / 2))
    bracket = (1 + q * q) * math.sin(math.pi * q / 2) + 2 * q / math.pi * math.cos(math.pi * q / 2)
    return drive * math.cos(beta) * math.sqrt(1 - sine * sine) * bracket


@pytest.mark.parametrize("beta", [5, 15, 30])
@pytest.mark.parametrize("mu", [0.1, 0.3, 0.6])
def test_two_sided_sliding(beta, mu):
    drive = 0.95 / math.sin(math.radians(beta))  # below lift-off, and strong enough never to stick
    expected = two_sided_speed(mu * math.tan(math.radians(beta)), math.radians(beta), mu, drive)
    result = motion(beta=beta, mu=mu, drive=drive)
    assert result.stick == 0
    assert float(result.velocity) == pytest.approx(expected, rel=1e-12)


def test_the_iteration_finds_the_closed_form():
    # Where the closed form serves no events are followed; a path follows them.
    case = {**groups(beta=15, mu=0.3, gamma=1, throw=0.95), **SETTINGS}
    path, _ = planar_path(**case, phases=np.array([0.0, 2 * math.pi]))
    expected = float(motion(beta=15, mu=0.3, gamma=1, throw=0.95).velocity)
    assert path.position[-1, 0] / (2 * math.pi) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("gamma", [0.0, 0.5])
def test_forward_stick_slip(gamma):
    case = {"beta": 20, "mu": 0.25, "mu_static": 0.35, "gamma": gamma, "drive": 0.36 + 0.05 * gamma}
    g = groups(**case)
    c = g["drive_number_along"] + 0.25 * g["drive_number_normal"]
    k = g["gravity_number_along"] + 0.25 * g["gravity_number_normal"]
    start = math.asin(
        (g["gravity_number_along"] + 0.35 * g["gravity_number_normal"])
        / (g["drive_number_along"] + 0.35 * g["drive_number_normal"])
    )
    span = bisect(
        lambda d: c * (math.cos(start) - math.cos(start + d)) - k * d, 0.5, 2 * math.pi - start
    )
    way = c * (span * math.cos(start) - math.sin(start + span) + math.sin(start)) - k * span**2 / 2
    result = motion(**case)
    assert result.backward == 0
    assert float(result.velocity) == pytest.approx(way / (2 * math.pi), rel=1e-12)
    assert float(result.forward) == pytest.approx(span / (2 * math.pi), rel=1e-12)


def bisect(function, low: float, high: float) -> float:
    for _ in range(200):
        middle = (low + high) / 2
        if (function(middle) > 0) == (function(low) > 0):
            low = middle
        else:
            high = middle
    return (low + high) / 2


@pytest.mark.parametrize("throw", [3.3, 3.5, 3.72])
@pytest.mark.parametrize(("beta", "gamma", "mu"), [(28, 0, 0.5), (28, 0, 0.1), (60, 3, 0.8)])
def test_hop_after_hop(throw, beta, gamma, mu):
    b, c = math.radians(beta), math.radians(gamma)
    result = motion(beta=beta, mu=mu, gamma=gamma, throw=throw)
    expected = math.pi * math.cos(b + c) / math.sin(b)
    assert float(result.velocity) == pytest.approx(expected, rel=1e-12)
    assert float(result.flight) == pytest.approx(1, rel=1e-15)
    assert (result.impacts, result.multiple) == (1, 1)


@pytest.mark.parametrize(("periods", "throw"), [(1, 2.45), (1, 2.5), (2, 4.426)])
def test_periodic_bounce(periods, throw):
    e = 0.2
    # q < throw < sqrt(q^2 + [2 (1 + e^2)/(1 + e)^2]^2): one impact in so many periods is stable.
    q = math.pi * periods * (1 - e) / (1 + e)
    assert q < throw < math.hypot(q, 2 * (1 + e * e) / (1 + e) ** 2)
    result = motion(beta=30, mu=0.5, throw=throw, e=e)
    # The part falls into it from rest; at higher restitution it falls into shrinking hops instead.
    expected = q / math.tan(math.radians(30))
    assert float(result.velocity) == pytest.approx(expected, rel=1e-11)
    assert (result.multiple, result.impacts) == (periods, 1 / periods)


def test_no_motion_is_exactly_zero():
    threshold = 0.3 / (math.cos(math.radians(20)) + 0.3 * math.sin(math.radians(20)))
    result = motion(beta=20, mu=0.3, drive=threshold * (1 - 1e-12))
    assert result.velocity == 0
    assert result.stick == 1
    assert result.status == STATUS["at_rest"]
    moving = motion(beta=20, mu=0.3, drive=threshold * (1 + 1e-6))
    assert moving.velocity > 0
    assert moving.status == STATUS["periodic"]


@pytest.mark.parametrize("throw", [1.0001, 1.2, 2.0, 2.5, 3.2])
def test_hop_length(throw):
    # sqrt(throw^2 - 1) (D - sin D) + (1 - cos D) - D^2/2 = 0 (theory 13.6)
    span = float(motion(beta=45, mu=0.5, throw=throw).flight) * 2 * math.pi
    root = math.sqrt(throw * throw - 1)
    rest = root * (span - math.sin(span)) + (1 - math.cos(span)) - span * span / 2
    # A third power of the span cancels in the equation: the bar is that of its terms.
    assert abs(rest) <= 1e-14 * span * span
    if throw == 1.0001:
        assert span == pytest.approx(4 * root, rel=1e-3)


def test_thresholds_from_both_sides():
    first, second = math.sqrt(1 + math.pi**2), math.sqrt(4 + math.pi**2)
    for border, below, above in ((first, "contact", "hops"), (second, 1, 2)):
        under = motion(beta=30, mu=0.5, throw=border * (1 - 1e-7))
        over = motion(beta=30, mu=0.5, throw=border * (1 + 1e-7))
        if border == first:
            assert under.flight < 1 - 1e-9, below
            assert over.flight == pytest.approx(1, abs=1e-14), above
        else:
            assert (under.multiple, over.multiple) == (below, above)


def test_best_throw():
    # g cot(beta)/(2 f): hop after hop at its lowest throw number.
    speed = velocity(50, beta=30, mu=0.5, throw=3.5)
    assert 1e3 * speed == pytest.approx(169.914184, abs=5e-7)
    assert speed == pytest.approx(9.81 / math.tan(math.radians(30)) / 100, rel=1e-13)


# --- values from elsewhere


@pytest.mark.parametrize("name", MEAN_VELOCITIES)
def test_worked_means(name):
    case = MEAN_VELOCITIES[name]
    speed = velocity(
        case.frequency, 9.8, case.amplitude, beta=case.beta, gamma=case.gamma,
        mu=case.friction_kinetic, mu_static=case.friction_static, e=case.restitution,
    )  # fmt: skip
    # A run of ever smaller hops is cut at 1e-10 g/w; without one nothing but rounding is left.
    assert speed == pytest.approx(case.value, rel=1e-10 if case.restitution else 1e-13)


# --- another method: small steps, from rest, each event bisected


def stepped_mean(case: dict[str, float], periods: int) -> tuple[float, float]:
    """Return the mean velocities of the last two periods, from rest, by steps and bisection."""
    c, s = case["drive_number_along"], case["drive_number_normal"]
    gs, gn = case["gravity_number_along"], case["gravity_number_normal"]
    mu_s, mu = case["friction_static"], case["friction_kinetic"]
    step = 2 * math.pi / 500
    tau, x, u, z, w = 0.0, 0.0, 0.0, 0.0, 0.0
    marks = [0.0]

    def flow(C, k, tau, v, d):
        speed = v + C * (math.cos(tau) - math.cos(tau + d)) - k * d
        way = v * d + C * (d * math.cos(tau) - math.sin(tau + d) + math.sin(tau)) - k * d * d / 2
        return speed, way

    flying = False
    while len(marks) <= periods:
        end = min(tau + step, 2 * math.pi * len(marks))
        d = end - tau
        n = gn - s * math.sin(tau)
        if flying:
            if z + flow(s, gn, tau, w, d)[1] < 0:
                d = bisect(lambda d, a=(tau, w, z): a[2] + flow(s, gn, a[0], a[1], d)[1], 1e-9, d)
            speed, rise = flow(s, gn, tau, w, d)
            new_u, way = flow(c, gs, tau, u, d)
            landed = tau + d < end
            z, w = z + rise, speed
            if landed:
                push = mu * -speed
                new_u = math.copysign(max(0.0, abs(new_u) - push), new_u)
                z, w, flying = 0.0, 0.0, gn - s * math.sin(tau + d) < 0
        else:
            drive = c * math.sin(tau + 1e-9) - gs
            held = u == 0 and abs(drive) <= mu_s * (gn - s * math.sin(tau + 1e-9))
            sign = 0.0 if held else (math.copysign(1, u) if u else math.copysign(1, drive))
            C, k = (c + sign * mu * s, gs + sign * mu * gn) if sign else (0.0, 0.0)
            if gn - s * math.sin(tau + d) < 0 <= n:
                d = bisect(lambda d, a=tau: gn - s * math.sin(a + d), 0, d)
                flying = True
            if held:
                free = lambda d, a=tau: (  # noqa: E731
                    abs(c * math.sin(a + d) - gs) > mu_s * (gn - s * math.sin(a + d))
                )
                if free(d):
                    low, high = 0.0, d
                    for _ in range(60):
                        middle = (low + high) / 2
                        low, high = (low, middle) if free(middle) else (middle, high)
                    d, flying = high, False
                new_u, way = 0.0, 0.0
            else:
                if u and sign * flow(C, k, tau, u, d)[0] < 0:
                    d = bisect(lambda d, a=(tau, u): sign * flow(C, k, a[0], a[1], d)[0], 0, d)  # noqa: B023
                    new_u, way = 0.0, flow(C, k, tau, u, d)[1]
                    flying = False
                else:
                    new_u, way = flow(C, k, tau, u, d)
        tau, x, u = tau + d, x + way, new_u
        if abs(tau - 2 * math.pi * len(marks)) < 1e-12:
            tau = 2 * math.pi * len(marks)
            marks.append(x)
    turns = 2 * math.pi
    return (marks[-2] - marks[-3]) / turns, (marks[-1] - marks[-2]) / turns


def test_against_steps_and_bisection():
    random = np.random.default_rng(7)
    compared = 0
    for _ in range(40):
        beta, mu = random.uniform(8, 70), random.uniform(0.15, 1.2)
        case = {
            "beta": beta, "mu": mu, "gamma": random.uniform(-4, 4), "throw": random.uniform(0.5, 3),
            "mu_static": mu * random.choice([1.0, 1.0, 1.3]),
        }  # fmt: skip
        before, after = stepped_mean(groups(**case), 12)
        result = motion(**case)
        if abs(after - before) > 1e-11 or result.multiple != 1:
            continue  # the steps have not settled
        compared += 1
        # Each of some six events a period is bisected to 1e-9 of a phase at most, where the
        # velocity is at most the drive's: the distance is wrong by less than 1e-8 drives.
        scale = groups(**case)["drive_number_along"]
        assert abs(float(result.velocity) - after) <= 1e-8 * scale, case
    assert compared >= 15
