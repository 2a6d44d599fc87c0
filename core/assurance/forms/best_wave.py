"""O, the fastest level wave under a largest acceleration: what it reaches, and that none beats it.

The value is that of Umbanhowar and Lynch's three phases; it stands here as it is published, and in
`vibrafeed.core.motion.limits` as the program computes it.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from vibrafeed.core.assurance.case import Term
from vibrafeed.core.assurance.forms.formulas import GRAVITY, MM, Formula, Inputs, simulation, speed

EDGE = 1e-9
"""How much longer than the fastest wave ours carries the part.

The wave is a knife edge: the part is caught at the instant at which the track turns.
"""


def value(inputs: Inputs) -> float:
    """Return the largest mean velocity of a part on a level track that any drive reaches [mm/s].

    It is T a_s^2 (a_m^2 - a_k^2)/(4 a_m (a_s + a_k)^2), with the period T, the largest acceleration
    a_m of the track, and a_s = mu_s g, a_k = mu_k g (Umbanhowar and Lynch). `inputs` are
    `frequency` [Hz], `most` (a_m in g), `friction_static` and `friction_kinetic`.
    """
    most = inputs["most"]
    holding, braking = inputs["friction_static"], inputs["friction_kinetic"]
    share = holding**2 * (most**2 - braking**2) / (4 * most * (holding + braking) ** 2)
    return MM * GRAVITY / inputs["frequency"] * share


def wave(inputs: Inputs) -> dict[str, float]:
    """Return the parameters of the drive that conveys fastest under a largest acceleration.

    It has three phases: carry the part forwards at the limit of sticking, turn away from under it,
    and catch it. The carrying is longer by the share `EDGE`, and weaker by a tenth of that, so that
    the part is caught just after the track has turned. `inputs` are `frequency` [Hz], `most` (the
    largest acceleration in g), `friction_static` and `friction_kinetic`. The result has
    accelerations in m/s2 and durations as shares of the period.
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
    """Return the study of the output `fastest_velocity`, as the only term of an answer in mm/s.

    It checks the velocity that the program states for a largest acceleration. `inputs` are
    `frequency` [Hz], `most` (that acceleration in g), `friction_static` and `friction_kinetic`.
    """
    drive = {
        **{name: inputs[name] for name in ("frequency", "friction_static", "friction_kinetic")},
        "acceleration_along_1": inputs["most"] * GRAVITY,
        "acceleration_along_2": -inputs["most"] * GRAVITY,
    }
    return (Term(simulation("fastest_velocity", drive), "fastest_velocity", times=MM),)


def random_limits(random: Generator) -> dict[str, float]:
    """Return random inputs of a fastest wave: the largest acceleration makes the part slip.

    They are `frequency` [Hz], `most` (that acceleration in g) and both frictions.
    """
    kinetic = float(random.uniform(0.05, 0.6))
    static = kinetic * float(random.choice([1.0, random.uniform(1.0, 1.6)]))
    return {
        "frequency": float(random.uniform(10, 100)),
        "most": static * math.exp(float(random.uniform(0.05, 2.5))),
        "friction_static": static,
        "friction_kinetic": kinetic,
    }


def random_steps(random: Generator) -> dict[str, float]:
    """Return random inputs of a wave of two to six steps of acceleration along the track.

    Under it the part may not be faster than under the fastest wave, which a problem checks. Inputs
    are `frequency` [Hz], `most` (largest acceleration in g), `friction_static`, `friction_kinetic`,
    and for each step n `level_n` (its acceleration as a share of `most`, -1 to 1, with mean 0 over
    the period) and `duration_n` in any unit. `random` is numpy's generator.
    """
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
    """Return the simulation of a part under a wave of steps: mean velocity [mm/s] as a term.

    `inputs` are `frequency` [Hz], `most` (largest acceleration along the track in g),
    `friction_static`, `friction_kinetic`, and for each step n `level_n` (its acceleration as a
    share of `most`, -1 to 1) and `duration_n` in any unit. The last level is left out, as it
    follows from the others.
    """
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
