"""Limits of a drive, the plain sine or a wave, against dense looks and exact cases."""

from typing import Any

import numpy as np
import pytest

from vibrafeed.core.motion import waves
from vibrafeed.core.motion.drives import problems_of_wave, shape_of
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.plan import plan_scene, run_equations

CELLS = 21
LIMITS = ("largest_acceleration", "stroke", "largest_jerk")
AXES = ("along", "across", "normal")
W = 2 * np.pi * 50.0


def outputs_of(outputs: tuple[str, ...], given: dict[str, Any]) -> dict[str, Any]:
    system, method, _ = choose_system("rectangle-on-plane", None, given)
    return run_equations(plan_scene(system, method, outputs, given), given)


def densely(wave: waves.Wave, of: str) -> np.ndarray:
    """Return the largest of many looks, closed in on."""
    function, _ = waves.COURSES[of]
    phase = np.linspace(0.0, 2 * np.pi, 20_001)[:, np.newaxis]
    values = function(wave, waves.ALONG, phase)
    best, at = values.max(axis=0), phase[values.argmax(axis=0), 0]
    for width in (3e-4, 2e-6, 2e-8):
        near = at + width * np.linspace(-1, 1, 401)[:, np.newaxis]
        values = function(wave, waves.ALONG, near)
        at = near[values.argmax(axis=0), np.arange(at.size)]
        best = np.maximum(best, values.max(axis=0))
    return best


@pytest.mark.parametrize("of", waves.COURSES)
@pytest.mark.parametrize("orders", [1, 3, 10])
def test_no_look_at_a_sum_of_sines_is_larger(orders: int, of: str) -> None:
    random = np.random.default_rng(orders)
    harmonics = random.normal(size=(3, 2, orders, CELLS))
    harmonics[:, :, orders - 1, ::5] *= 1e-9
    harmonics[:, :, orders - 1, ::7] = 0.0
    wave = waves.Wave(harmonics, np.zeros((4, 0, CELLS)))
    found, looked = waves.largest_over_period(wave, waves.ALONG, of), densely(wave, of)
    np.testing.assert_allclose(found, looked, rtol=1e-12, atol=1e-12 * np.abs(looked).max())


@pytest.mark.parametrize("of", ["push", "push size", "speed", "place", "place back"])
def test_no_look_at_steps_is_larger(of: str) -> None:
    random = np.random.default_rng(3)
    steps = random.normal(size=(4, 5, CELLS))
    ends = np.cumsum(random.exponential(size=(5, CELLS)), axis=0)
    steps[waves.ENDS] = 2 * np.pi * ends / ends[-1]
    last = np.diff(steps[waves.ENDS], axis=0, prepend=0.0)
    steps[:3] -= (steps[:3] * last).sum(axis=1, keepdims=True) / (2 * np.pi)
    wave = waves.Wave(np.zeros((3, 2, 0, CELLS)), steps)
    found, looked = waves.largest_over_period(wave, waves.ALONG, of), densely(wave, of)
    np.testing.assert_allclose(found, looked, rtol=1e-9)  # a corner is met to the width of looks
    assert (found >= looked * (1 - 1e-12)).all()


def test_one_harmonic_has_the_limits_of_the_sine() -> None:
    amplitude, alpha, beta = 2e-4, 0.3, 0.4
    shared = {"frequency": 50.0, "gravity": 9.81}
    sizes = np.array([np.cos(alpha), np.sin(alpha), np.tan(beta)]) * np.cos(beta) * amplitude
    asked = tuple(f"{limit}_{axis}" for limit in LIMITS for axis in AXES)
    sine = outputs_of(asked, {**shared, "amplitude": amplitude, "alpha": alpha, "beta": beta})
    wave = outputs_of(asked, {**shared, **{f"amplitude_{axis}_1": size for axis, size in
                                           zip(AXES, sizes, strict=True)}})  # fmt: skip
    expected = np.outer([W**2, 2.0, W**3], sizes).ravel()
    for found in (sine, wave):
        assert [float(found[name]) for name in asked] == pytest.approx(expected, rel=1e-13)


def test_two_levels_have_the_stroke_of_a_throw() -> None:
    given = {"frequency": 50.0, "gravity": 9.81, "acceleration_along_1": 4.0}
    given |= {"duration_1": 1.0, "duration_2": 1.0, "drive_factor": 1.5}
    asked = tuple(f"{limit}_{axis}" for limit in LIMITS for axis in ("along", "normal"))
    found = outputs_of(asked, given)
    assert found["largest_acceleration_along"] == pytest.approx(6.0, rel=1e-14)
    assert found["stroke_along"] == pytest.approx(6.0 / 50.0**2 / 16, rel=1e-13)
    assert found["largest_jerk_along"] == np.inf
    assert [found[f"{limit}_normal"] for limit in LIMITS] == [0.0, 0.0, 0.0]
    still = outputs_of(asked, given | {"acceleration_along_1": 0.0})
    assert [still[f"{limit}_along"] for limit in LIMITS[:2]] == [0.0, 0.0]


@pytest.mark.parametrize("size", [0.0, 1e-13])
@pytest.mark.parametrize("place", [1, 2, 3])
def test_a_step_of_no_length_is_none(place: int, size: float) -> None:
    levels, last = [4.0, -20.0], [1.0, 0.2]
    levels.insert(place - 1, 30.0)
    last.insert(place - 1, size)
    shared = {"frequency": 50.0, "gravity": 9.81, "friction": 0.5}
    steps = {f"acceleration_along_{n}": a for n, a in enumerate(levels, 1)}
    steps |= {f"duration_{n}": d for n, d in enumerate(last, 1)}
    plain = {"acceleration_along_1": 4.0, "duration_1": 1.0, "duration_2": 0.2}
    asked = ("conveying_velocity", "largest_acceleration_along", "stroke_along")
    found, expected = outputs_of(asked, shared | steps), outputs_of(asked, shared | plain)
    for name in asked:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-11)


def test_each_axis_whose_steps_run_away_is_named() -> None:
    designs = {"along": [1.0, 2.0], "normal": [4.0, 3.0]}  # another axis is at fault in each
    values = {f"acceleration_{axis}_1": np.array(first) for axis, first in designs.items()}
    values |= {"acceleration_along_2": np.array(-1.0), "acceleration_normal_2": np.array(-3.0)}
    shape, _ = shape_of([*values, "duration_1", "duration_2"])
    problems = problems_of_wave(shape, values)
    assert [problem.place for problem in problems] == [f"parameters.{name}" for name in values][:2]
