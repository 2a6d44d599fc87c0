"""Contacts that give: worked values, impacts step by step, the law's own limits."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibrafeed
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import soft_contact


def sweep(*outputs, **given):
    found = vibrafeed.sweep(scene="soft-contact", outputs=outputs, **given)
    return (*(found[name].values for name in outputs), found.regime.values)


@pytest.mark.parametrize(
    ("zeta", "restitution"),
    [
        (0.2, 0.57174003),
        (0.2552756, 0.5),
        (0.0743551, 0.8),
        (0.4972394, 0.3),
        (1, np.exp(-2)),
        (1.5, 0.0755883),
    ],
)
def test_a_damper_that_never_pulls_and_back(zeta, restitution):
    found, _ = sweep("restitution_of_damping", contact_damping_ratio=zeta)
    assert found == pytest.approx(restitution, abs=1e-7)
    back, _ = sweep("damping_of_restitution", restitution=float(found))
    assert back == pytest.approx(zeta, rel=1e-12)


def test_the_damping_of_any_restitution_to_many_digits():
    e = np.array([1.0, 0.999, 0.5, 0.1354, np.exp(-2), 0.135, 0.0755883, 1e-4, 1e-300, 0.0])
    zeta, regime = sweep("damping_of_restitution", restitution=e)
    assert (zeta[0], zeta[-1]) == (0, np.inf)
    assert (regime[:-1] == REGIMES["contact"].value).all()
    assert regime[-1] == REGIMES["unbounded"].value
    with mpmath.workdps(40):
        for one, known in zip(zeta[1:-1], e[1:-1], strict=True):
            ratio = mpmath.mpf(one) + mpmath.mpf("1e-30")  # at 1 the quotient is its limit
            root = mpmath.sqrt(1 - ratio * ratio)
            found = mpmath.re(mpmath.exp(-2 * ratio * mpmath.acos(ratio) / root))
            # The logarithm of e is rounded; at 1 the damping is the loss over pi.
            assert abs(mpmath.log(found / known)) < -1e-15 * mpmath.log(known)


def impact(force, speed):
    """Return the speed off a contact after an impact, followed step by step."""
    ended = lambda t, y: force(*y) if t > 0 else 1.0  # noqa: E731
    ended.terminal, ended.direction = True, -1
    found = solve_ivp(lambda t, y: (y[1], -force(*y)), (0, 50), (0.0, speed), events=ended,
                      rtol=1e-10, atol=1e-13)  # fmt: skip
    return -found.y[1, -1] / speed


@pytest.mark.parametrize(("power", "damping"), [(1.0, 0.3), (1.5, 0.5), (2.2, 2.0)])
def test_impacts_of_any_exponent_by_integration(power, damping):
    found = impact(lambda x, v: max(x, 0.0) ** power * (1 + damping * v), 1.0)
    assert found == pytest.approx(soft_contact.hunt_crossley(np.float64(damping)), abs=1e-6)


def test_the_law_to_many_digits():
    with mpmath.workdps(40):
        for d in (1e-9, 1e-6, 1e-3, 0.3, 3.0, 1e3, 1e9):
            given = mpmath.mpf(d) - mpmath.log1p(d)
            known = (1 + mpmath.lambertw(-mpmath.exp(-1 - given))) / d
            assert soft_contact.hunt_crossley(np.float64(d)) == pytest.approx(
                float(known), rel=4e-16
            )


def test_one_measured_value_gives_all_others():
    random = np.random.default_rng(1)
    e, speed = random.uniform(0.02, 0.99, 300), 10 ** random.uniform(-3, 1, 300)
    b = soft_contact.impact_damping(restitution=e, restitution_speed=speed)
    again = soft_contact.restitution_at(impact_damping=b, impact_speed=speed)
    assert again == pytest.approx(e, rel=1e-13)
    speeds = 10 ** np.linspace(-6, 6, 400)
    for one in b[:20]:
        found = soft_contact.restitution_at(impact_damping=one, impact_speed=speeds)
        assert np.all(np.diff(found) < 0)  # faster impacts rebound less
        # The rebound grows with the impact, up to 1/b but for rounding: no slow one is faster.
        assert np.all(np.diff(found * speeds) > -1e-15 / one)
    for full in (0, 1):
        found, _ = sweep("restitution_at_impact", restitution=full, restitution_speed=0.1,
                         impact_speed=1)  # fmt: skip
        assert found == full


def test_a_lining_that_is_too_soft_says_so():
    ratio, sag, regime = sweep(
        "stiffness_ratio", "lining_sag", mass="5 g", frequency=50.0,
        lining_stiffness=["5 N/mm", "20 N/mm"],
    )  # fmt: skip
    assert ratio == pytest.approx(np.sqrt([1e6, 4e6]) / (2 * np.pi * 50), rel=1e-14)
    assert sag == pytest.approx(0.005 * 9.80665 / np.array([5e3, 2e4]), rel=1e-14)
    assert regime.tolist() == [REGIMES[name].value for name in ("soft_contact", "contact")]


def test_the_time_of_a_hertz_contact():
    time, depth, _ = sweep("hertz_time", "hertz_depth", mass="5 g", contact_modulus="100 GPa",
                           contact_radius="4 mm", impact_speed="0.3 m/s")  # fmt: skip
    k = 4 / 3 * 1e11 * np.sqrt(0.004)
    assert 0.4 * k * depth**2.5 == pytest.approx(0.005 * 0.3**2 / 2, rel=1e-13)  # energy
    # 4 sqrt(pi) Gamma(0.4)/(5 Gamma(0.9))
    assert time == pytest.approx(2.9432751843 * depth / 0.3, rel=2e-11)
