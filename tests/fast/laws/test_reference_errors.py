"""The reference's errors: no impact is missed, and no error is stated smaller than it is."""

import math
from typing import Any

import numpy as np
import pytest

from benchmarks.honest_estimates import by_events, random_groups
from benchmarks.motions import reference_motion, reference_path
from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.motion.method import STATUS
from vibrafeed.core.motion.reference.stretch import TERMS, crossings, first_fall

REPEATS = (STATUS["periodic"], STATUS["at_rest"])


FLIGHT: dict[str, Any] = {
    "drive_number_along": 0.0, "drive_number_normal": 0.0, "gravity_number_along": 0.0,
    "gravity_number_normal": 1.0, "friction_static": 0.3, "friction_kinetic": 0.3, "wall": True,
    "gravity_number_across": -1.0, "wall_friction": 0.2,
}  # fmt: skip


@pytest.mark.parametrize("depth", [1e-2, 1e-9, 1e-12])
def test_a_graze_of_the_wall_is_an_impact(depth: float) -> None:
    # Pulled from the wall with 1 g, the part nears it and would turn round at -depth, after 1: it
    # would be behind it for 2 sqrt(2 depth), down to 3e-6 of phase.
    behind = math.sqrt(2.0 * depth)
    phases = np.array([0.0, 1.0 - behind, 1.0, 1.5])
    found = reference_path(
        phases=phases, **FLIGHT, wall_restitution=0.4, position=(0.0, 0.5 - depth, 50.0),
        velocity=(0.7, -1.0, 0.0),
    )  # fmt: skip
    since = phases[2:] - (1.0 - behind)
    # A rounding of the distance moves the impact by as much over the speed of approach.
    rounding = 1e-13 + 1e-15 / behind
    expected = 0.4 * behind * since + 0.5 * since**2
    np.testing.assert_allclose(found.position[2:, 1], expected, rtol=0.0, atol=rounding)
    # Friction of the wall takes 0.2 (1 + 0.4) of the approach, against the slip (u_x, u_z).
    lost = 0.2 * 1.4 * behind / math.hypot(0.7, 1.0 - behind)
    assert found.velocity[3, 0] == pytest.approx(0.7 * (1.0 - lost), rel=0, abs=rounding)


def test_a_part_that_turns_before_the_wall_has_no_impact() -> None:
    found = reference_path(
        phases=[0.0, 1.0, 1.5], **FLIGHT, position=(0.0, 0.5 + 1e-12, 50.0),
        velocity=(0.7, -1.0, 0.0),
    )  # fmt: skip
    np.testing.assert_array_equal(found.velocity[:, 0], 0.7)


def test_no_stated_error_is_too_small_in_the_plane() -> None:
    count = 8
    groups = random_groups(count, 3, throw=(0.1, 4.0), most_restitution=0.4)
    exact = by_events(groups)
    stated = []
    for cell in range(count):
        one = {name: float(values[cell]) for name, values in groups.items()}
        found = reference_motion(**one, max_periods=60)
        if exact.status[cell] in REPEATS:
            assert (found.multiple, found.status) == (exact.multiple[cell], exact.status[cell])
        off = abs(float(found.velocity) - float(exact.velocity[cell]))
        assert off <= float(found.error) + float(exact.error[cell])
        stated.append(float(found.error))
    # Nor is it too large to be of use: most cells repeat, and are known to more than ten digits.
    assert np.median(stated) < 1e-11


@pytest.mark.parametrize("max_periods", [1, 2, 5])
def test_what_was_not_shown_to_repeat_has_an_error(max_periods: int) -> None:
    for case in MEAN_VELOCITIES.values():
        found = reference_motion(**case.groups(), max_periods=max_periods)
        off = float(found.velocity) - case.scaled
        assert 0.0 < float(found.error) >= abs(off) - 1e-12  # the worked values have 13 digits
        assert found.status != STATUS["aperiodic"] or float(found.error) > 1e-6


@pytest.mark.parametrize("multiple", [2, 3])
def test_multiples(multiple: int) -> None:
    groups = random_groups(300, 21, throw=(2.5, 4.5), most_restitution=0.4)
    exact = by_events(groups)
    repeats = (exact.status == STATUS["periodic"]) & (exact.multiple == multiple)
    cell = int(np.flatnonzero(repeats)[0])
    found = reference_motion(**{name: float(values[cell]) for name, values in groups.items()})
    assert found.multiple == multiple
    off = abs(float(found.velocity) - float(exact.velocity[cell]))
    assert off <= float(found.error) + float(exact.error[cell])


def test_roots_are_certain() -> None:
    # Against the roots that polynomials are made of, pairs of them close together among them.
    random = np.random.default_rng(5)
    for _ in range(50):
        apart = 10.0 ** random.uniform(-6.0, -1.0)
        first = random.uniform(0.0, 0.8)
        made = np.array([first, first + apart, *random.uniform(1.1, 3.0, 4)])
        product = np.polynomial.Polynomial.fromroots(made)
        on_unit = np.polynomial.Chebyshev.cast(
            product(np.polynomial.Polynomial([0.5, 0.5]))  # s = (1 + x)/2
        )
        coefficients = np.zeros(TERMS)
        coefficients[: len(on_unit.coef)] = on_unit.coef
        falls, rises = sorted(crossings(coefficients), key=lambda one: one[1])
        assert (falls[1], rises[1]) == (-1, 1)
        np.testing.assert_allclose([falls[0], rises[0]], made[:2], rtol=0.0, atol=1e-13 / apart)
        assert first_fall(coefficients) == falls[0]
