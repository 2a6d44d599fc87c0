"""Planar motion against values from elsewhere: closed forms, worked values, published speeds."""

import math

import numpy as np
import pytest
from scipy import optimize

from benchmarks.motions import planar_motion, planar_path
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


# --- closed forms


def two_sided_speed(q: float, beta: float, mu: float, drive: float) -> float:
    """Return the mean velocity of sliding without stick on the level, in g/w (theory 13.8)."""
    sine = math.pi * mu / (2 * drive * math.cos(beta) * math.cos(math.pi * q / 2))
    bracket = (1 + q * q) * math.sin(math.pi * q / 2) + 2 * q / math.pi * math.cos(math.pi * q / 2)
    return drive * math.cos(beta) * math.sqrt(1 - sine * sine) * bracket


@pytest.mark.parametrize("beta", [5, 15, 30])
@pytest.mark.parametrize("mu", [0.1, 0.6])
def test_two_sided_sliding(beta, mu):
    drive = 0.95 / math.sin(math.radians(beta))  # below lift-off, and strong enough never to stick
    expected = two_sided_speed(mu * math.tan(math.radians(beta)), math.radians(beta), mu, drive)
    result = motion(beta=beta, mu=mu, drive=drive)
    assert result.stick == 0
    assert float(result.velocity) == pytest.approx(expected, rel=1e-12)
    # Where the closed form serves no events are followed; a path follows them.
    case = {**groups(beta=beta, mu=mu, drive=drive), **SETTINGS}
    path, _ = planar_path(**case, phases=np.array([0.0, 2 * math.pi]))
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
    span = optimize.brentq(
        lambda d: c * (math.cos(start) - math.cos(start + d)) - k * d,
        0.5, 2 * math.pi - start, xtol=1e-15,
    )  # fmt: skip
    way = c * (span * math.cos(start) - math.sin(start + span) + math.sin(start)) - k * span**2 / 2
    result = motion(**case)
    assert result.backward == 0
    assert float(result.velocity) == pytest.approx(way / (2 * math.pi), rel=1e-12)
    assert float(result.forward) == pytest.approx(span / (2 * math.pi), rel=1e-12)


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


@pytest.mark.parametrize("periods", [1, 2])
def test_thresholds_from_both_sides(periods):
    border = math.sqrt(periods**2 + math.pi**2)
    under, over = (motion(beta=30, mu=0.5, throw=border * (1 + off)) for off in (-1e-7, 1e-7))
    if periods == 1:  # from contact to hop after hop
        assert under.flight < 1 - 1e-9
        assert over.flight == pytest.approx(1, abs=1e-14)
    assert (under.multiple, over.multiple) == (1, periods)


# --- values from elsewhere
