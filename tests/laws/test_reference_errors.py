"""The reference's errors: no impact is missed, and no error is stated smaller than it is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmarks.honest_estimates import by_events, random_groups
from benchmarks.motions import reference_motion, reference_path
from mean_velocities import GRAVITY, MEAN_VELOCITIES
from night import spread
from vibrafeed.core.motion.method import STATUS
from vibrafeed.core.motion.reference.stretch import TERMS, crossings, first_fall

REPEATS = (STATUS["periodic"], STATUS["at_rest"])


def on_track(
    *, frequency: float, amplitude: float, degrees: tuple[float, float, float, float],
    friction: float, restitution: float, radius: float, gravity: float = 9.80665,
) -> tuple[dict[str, Any], float]:  # fmt: skip
    """Return the groups of a part on the track, and the scale of its speed in m/s."""
    w = 2.0 * math.pi * frequency
    drive = amplitude * w * w / gravity
    alpha, beta, gamma, delta = (math.radians(angle) for angle in degrees)
    groups = {
        "drive_number_along": drive * math.cos(beta) * math.cos(alpha),
        "drive_number_across": drive * math.cos(beta) * math.sin(alpha),
        "drive_number_normal": drive * math.sin(beta),
        "gravity_number_along": math.sin(gamma),
        "gravity_number_across": math.cos(gamma) * math.sin(delta),
        "gravity_number_normal": math.cos(gamma) * math.cos(delta),
        "friction_static": friction, "friction_kinetic": friction, "wall_friction": friction,
        "restitution": restitution, "wall_restitution": restitution,
        "curvature_number": gravity / (w * w * radius), "wall": True,
    }  # fmt: skip
    return groups, gravity / w


def test_a_part_on_its_way_to_the_wall_does_not_repeat() -> None:
    # For some periods the part hops alike, while it nears the wall: 0.0827 m/s. It then bounces off
    # and does not repeat; the mean over 2000 periods is 0.0914 m/s.
    groups, scale = on_track(
        frequency=33.0, amplitude=1.32e-3, degrees=(18.0, 17.0, -1.0, 14.0), friction=0.6,
        restitution=0.2, radius=0.8,
    )  # fmt: skip
    found = reference_motion(**groups, max_periods=60)
    assert found.status == STATUS["aperiodic"]
    assert abs(float(found.velocity) * scale - 0.0914) < float(found.error) * scale < 0.05
    # Followed only until it hops alike, it is known not to be there yet.
    short = reference_motion(**groups, max_periods=11)
    assert short.status == STATUS["aperiodic"]
    assert abs(float(short.velocity) * scale - 0.0914) < float(short.error) * scale


FLIGHT: dict[str, Any] = {
    "drive_number_along": 0.0, "drive_number_normal": 0.0, "gravity_number_along": 0.0,
    "gravity_number_normal": 1.0, "friction_static": 0.3, "friction_kinetic": 0.3, "wall": True,
}  # fmt: skip


@pytest.mark.parametrize("depth", [1e-2, 4e-6, 1e-9, 1e-12])
def test_a_graze_of_the_wall_is_an_impact(depth: float) -> None:
    # Pulled from the wall with 1 g, the part nears it and would turn round at -depth, after 1: it
    # would be behind it for 2 sqrt(2 depth), down to 3e-6 of phase.
    restitution = 0.4
    groups = {**FLIGHT, "gravity_number_across": -1.0, "wall_friction": 0.2,
              "wall_restitution": restitution}  # fmt: skip
    behind = math.sqrt(2.0 * depth)
    phases = np.array([0.0, 1.0 - behind, 1.0, 1.5])
    found = reference_path(
        phases=phases, **groups, position=(0.0, 0.5 - depth, 50.0), velocity=(0.7, -1.0, 0.0)
    )
    since = phases[2:] - (1.0 - behind)
    # A rounding of the distance moves the impact by as much over the speed of approach.
    rounding = 1e-13 + 1e-15 / behind
    expected = restitution * behind * since + 0.5 * since**2
    np.testing.assert_allclose(found.position[2:, 1], expected, rtol=0.0, atol=rounding)
    # Friction of the wall takes 0.2 (1 + 0.4) of the approach, against the slip (u_x, u_z).
    assert found.velocity[3, 0] < 0.7
    slip = math.hypot(0.7, 1.0 - behind)
    lost = 0.2 * (1.0 + restitution) * behind
    np.testing.assert_allclose(
        found.velocity[3, 0], 0.7 * (1.0 - lost / slip), rtol=0.0, atol=rounding
    )


def test_a_part_that_turns_before_the_wall_has_no_impact() -> None:
    gap = 1e-12
    found = reference_path(
        phases=[0.0, 1.0, 1.5], **FLIGHT, gravity_number_across=-1.0, wall_friction=0.2,
        position=(0.0, 0.5 + gap, 50.0), velocity=(0.7, -1.0, 0.0),
    )  # fmt: skip
    np.testing.assert_array_equal(found.velocity[:, 0], 0.7)


def test_impulses_of_a_run_of_hops_add_up() -> None:
    # Falling from 1 and hopping until the run ends, the floor takes the momentum of the fall and
    # carries the weight from then on: friction times it is what the slip loses.
    restitution, friction = 0.5, 0.3
    landing = math.sqrt(2.0)
    end = landing * (1.0 + restitution) / (1.0 - restitution) + 0.5
    found = reference_path(
        phases=[0.0, end], drive_number_along=0.0, drive_number_normal=0.0,
        gravity_number_along=0.0, gravity_number_normal=1.0, friction_static=friction,
        friction_kinetic=friction, restitution=restitution, position=(0.0, 0.0, 1.0),
        velocity=(5.0, 0.0, 0.0),
    )  # fmt: skip
    assert found.velocity[1, 0] == pytest.approx(5.0 - friction * end, abs=1e-13)


def test_no_stated_error_is_too_small_in_the_plane() -> None:
    count = 30
    groups = random_groups(count, 3, throw=(0.1, 4.0), most_restitution=0.4)
    exact = by_events(groups)
    ratios, stated = [], []
    for cell in range(count):
        one = {name: float(values[cell]) for name, values in groups.items()}
        found = reference_motion(**one, max_periods=60)
        assert exact.status[cell] not in REPEATS or found.status in REPEATS
        if exact.status[cell] in REPEATS:
            assert found.multiple == exact.multiple[cell]
            assert found.status == exact.status[cell]
        both = float(found.error) + float(exact.error[cell])
        ratios.append(abs(float(found.velocity) - float(exact.velocity[cell])) / max(both, 1e-300))
        stated.append(float(found.error))
    assert max(ratios) < 1.0
    # Nor is it too large to be of use: most cells repeat, and are known to more than ten digits.
    assert np.median(stated) < 1e-11


@pytest.mark.parametrize("max_periods", [1, 2, 5])
@pytest.mark.parametrize("name", MEAN_VELOCITIES)
def test_what_was_not_shown_to_repeat_has_an_error(name: str, max_periods: int) -> None:
    case = MEAN_VELOCITIES[name]
    found = reference_motion(**case.groups(), max_periods=max_periods)
    off = float(found.velocity) - case.value * case.circular_frequency / GRAVITY
    assert float(found.error) > 0.0
    assert abs(off) <= float(found.error) + 1e-12  # the worked values have 13 digits
    assert found.status != STATUS["aperiodic"] or float(found.error) > 1e-6


@pytest.mark.parametrize("multiple", spread([2, 3, 7, 16], 2))
def test_multiples(multiple: int) -> None:
    groups = random_groups(3000, 21, throw=(2.5, 4.5), most_restitution=0.4)
    exact = by_events(groups)
    repeats = (exact.status == STATUS["periodic"]) & (exact.multiple == multiple)
    cell = int(np.flatnonzero(repeats)[0])
    found = reference_motion(**{name: float(values[cell]) for name, values in groups.items()})
    assert found.multiple == multiple
    off = abs(float(found.velocity) - float(exact.velocity[cell]))
    assert off <= float(found.error) + float(exact.error[cell])


def test_without_friction_the_speed_is_that_of_the_start() -> None:
    for normal in (0.3, 1.5):  # on the floor; hops
        found = reference_motion(
            drive_number_along=1.0, drive_number_normal=normal, gravity_number_along=0.0,
            gravity_number_normal=1.0, friction_static=0.0, friction_kinetic=0.0,
        )  # fmt: skip
        assert found.status == STATUS["neutral"]
        assert abs(float(found.velocity) - 1.0) <= float(found.error) < 1e-11


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
