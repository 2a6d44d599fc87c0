"""O, the fastest level wave under a largest acceleration: what it reaches, and that none beats it.

The value is that of Umbanhowar and Lynch's three phases; it stands here as it is published, and in
`core.motion.best_wave` as the program computes it.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from core.assurance.case import Term
from core.assurance.forms.formulas import GRAVITY, MM, Formula, Inputs, simulation, speed

EDGE = 1e-9
"""How much longer than the fastest wave ours carries the part.

The wave is a knife edge: the part is caught at the instant at which the track turns.
"""


def value(inputs: Inputs) -> float:
    """Return the largest mean velocity, T a_s^2 (a_m^2 - a_k^2)/(4 a_m (a_s + a_k)^2) [mm/s]."""
    most = inputs["most"]
    holding, braking = inputs["friction_static"], inputs["friction_kinetic"]
    share = holding**2 * (most**2 - braking**2) / (4 * most * (holding + braking) ** 2)
    return MM * GRAVITY / inputs["frequency"] * share


def wave(inputs: Inputs) -> dict[str, float]:
    """Return the fastest drive in its three phases: carry, away, catch.

    It carries the part for `EDGE` longer, less a tenth of that in strength, so that the part is
    caught just after the track has turned.
    """
    most = inputs["most"]
    holding, braking = inputs["friction_static"], inputs["friction_kinetic"]
    carry = braking / (holding + braking) * (1 + EDGE)
    held = holding * (1 - EDGE / 10)
    away = ((1 - carry) + held * carry / most) / 2
    return {
        **{name: inputs[name] for name in ("frequency", "friction_static", "friction_kinetic")},
        "acceleration_along_1": held * GRAVITY,
        "acceleration_along_2": -most * GRAVITY,
        "duration_1": carry,
        "duration_2": away,
        "duration_3": 1 - carry - away,
    }


def reached_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the mean velocity under the fastest wave."""
    return speed(wave(inputs))


def stated_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the largest velocity that the program states for the acceleration."""
    drive = {
        **{name: inputs[name] for name in ("frequency", "friction_static", "friction_kinetic")},
        "acceleration_along_1": inputs["most"] * GRAVITY,
        "acceleration_along_2": -inputs["most"] * GRAVITY,
    }
    return (Term(simulation("fastest_velocity", drive), "fastest_velocity", times=MM),)


def random_limits(random: Generator) -> dict[str, float]:
    """Return random inputs whose largest acceleration makes the part slip."""
    kinetic = float(random.uniform(0.05, 0.6))
    static = kinetic * float(random.choice([1.0, random.uniform(1.0, 1.6)]))
    return {
        "frequency": float(random.uniform(10, 100)),
        "most": static * math.exp(float(random.uniform(0.05, 2.5))),
        "friction_static": static,
        "friction_kinetic": kinetic,
    }


def random_steps(random: Generator) -> dict[str, float]:
    """Return random inputs of a wave with two to six steps; the largest is the limit."""
    inputs = random_limits(random)
    count = int(random.integers(2, 7))
    levels = random.uniform(-1, 1, count)
    shares = random.exponential(size=count)
    levels -= (levels @ shares) / shares.sum()  # the speed of the track repeats
    levels /= abs(levels).max()
    for number, (level, share) in enumerate(zip(levels, shares, strict=True), 1):
        inputs[f"level_{number}"] = float(level)
        inputs[f"duration_{number}"] = float(share)
    return inputs


def steps_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the mean velocity under a wave of steps."""
    drive = {name: inputs[name] for name in ("frequency", "friction_static", "friction_kinetic")}
    count = sum(name.startswith("level_") for name in inputs)
    for number in range(1, count + 1):
        if number < count:  # the last level closes the wave
            level = inputs[f"level_{number}"] * inputs["most"] * GRAVITY
            drive[f"acceleration_along_{number}"] = level
        drive[f"duration_{number}"] = inputs[f"duration_{number}"]
    return speed(drive)


FORMULAS = {
    "O-fastest": Formula(stated_terms, value, random_limits),
    "O-reached": Formula(reached_terms, value, random_limits),
    "O-bound": Formula(steps_terms, value, random_steps),
}
