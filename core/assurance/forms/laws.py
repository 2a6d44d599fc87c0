"""S, B and Z: symmetries, balances, and the level sine. Any drive keeps the first two.

Speeds are over the sum of A w of the track's harmonics along itself, so that a tolerance is a share
of the drive.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from numpy.random import Generator

from vibrafeed.core.assurance.case import Term
from vibrafeed.core.assurance.forms.formulas import (
    GRAVITY,
    Formula,
    Inputs,
    simulation,
    sine_cosine,
    speed,
)

SHIFT = 1.234
"""Radian of the first harmonic by which a drive starts later."""

LATER = 0.1
"""Radian after the slip turns at which it is asked for: at the turn itself it is 0."""


# --- waves of harmonics


def random_harmonics(random: Generator) -> dict[str, float]:
    """Return random inputs of a part in contact, under up to three harmonics along and normal.

    There is one coefficient of friction, so that all starts lead to one motion. They are
    `frequency` [Hz], `friction`, `gamma` [degree], and `amplitude_along_1` [m], `phase_along_1`
    [degree] and so on.
    """
    inputs = {
        "frequency": float(random.uniform(10, 120)),
        "friction": float(random.uniform(0.1, 0.8)),
        "gamma": float(random.uniform(-4, 4)),
    }
    unit = GRAVITY / (2 * math.pi * inputs["frequency"]) ** 2
    for axis, most in (("along", float(random.uniform(0.5, 3))), ("normal", 0.95)):
        count = int(random.integers(1, 4))
        pushes = random.exponential(size=count)
        pushes *= most / pushes.sum()
        for order, push in enumerate(pushes, 1):
            inputs[f"amplitude_{axis}_{order}"] = float(push) * unit / order**2
            inputs[f"phase_{axis}_{order}"] = float(random.uniform(-180, 180))
    return inputs


def _pace(inputs: Inputs) -> float:
    """Return an upper bound of the track's speed along itself [m s-1]: the sum of k w A_k.

    k is the order of a harmonic, A_k its amplitude along the track (`amplitude_along_k` of the
    inputs) and w the circular frequency. Velocities are compared as shares of it.
    """
    w = 2 * math.pi * inputs["frequency"]
    amplitudes = [
        int(name[-1]) * w * value
        for name, value in inputs.items()
        if name.startswith("amplitude_along_")
    ]
    return math.fsum(amplitudes)


def _compared(inputs: Inputs, other: Mapping[str, Any], sign: float) -> tuple[Term, ...]:
    """Return the terms of the speed under one drive, plus `sign` times that under another."""
    scale = 1 / _pace(inputs)
    return (*speed(inputs, times=scale), *speed(other, times=sign * scale))


def nothing(inputs: Inputs) -> float:
    """Return 0, the value of all differences of equal speeds."""
    return 0.0


def shifted_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the velocity under a drive less that under the same drive started later, as two terms.

    A validation problem: the answer is 0, as the start of a wave does not matter. `inputs` describe
    the drive: `frequency` [Hz], `friction`, `gamma` [degree], and for each harmonic n along and
    normal to the track `amplitude_along_n` [m], `phase_along_n` [degree] and so on. Velocities are
    shares of the largest possible speed of the track.
    """
    later = {
        name: value + math.degrees(int(name[-1]) * SHIFT) if name.startswith("phase_") else value
        for name, value in inputs.items()
    }
    return _compared(inputs, _turned(later), -1.0)


def mirrored_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the velocity under a drive plus that under its mirror image, as two terms.

    A validation problem: the image moves backwards where the drive moves forwards, on a slope of
    the opposite sign, so that the answer is 0. `inputs` describe the drive: `frequency` [Hz],
    `friction`, `gamma` [degree], and for each harmonic n along and normal to the track
    `amplitude_along_n` [m], `phase_along_n` [degree] and so on. Velocities are shares of the
    largest possible speed of the track.
    """
    image = {
        name: value + 180.0 if name.startswith("phase_along_") else value
        for name, value in inputs.items()
    }
    return _compared(inputs, _turned({**image, "gamma": -inputs["gamma"]}), 1.0)


def reversed_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the speed plus that with the second harmonic shifted by half a turn."""
    return _compared(
        inputs, _turned({**inputs, "phase_along_2": inputs["phase_along_2"] + 180}), 1.0
    )


def random_reversed(random: Generator) -> dict[str, float]:
    """Return random inputs of two harmonics along a level track with constant load.

    They are `frequency` [Hz], `friction`, `amplitude_along_1`, `amplitude_along_2` [m] and
    `phase_along_2` [degree]. Shifting the second by half a turn reverses the velocity.
    """
    inputs = random_harmonics(random)
    first, second = sorted(random.uniform(0.5, 3, 2), reverse=True)
    unit = GRAVITY / (2 * math.pi * inputs["frequency"]) ** 2
    return {
        "frequency": inputs["frequency"],
        "friction": inputs["friction"],
        "amplitude_along_1": float(first) * unit,
        "amplitude_along_2": float(second) * unit / 4,
        "phase_along_2": float(random.uniform(-180, 180)),
    }


def doubled_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the speed for a track that moves along at w and normal at 2 w."""
    return speed(inputs, times=1 / _pace(inputs))


def random_doubled(random: Generator) -> dict[str, float]:
    """Return random inputs of a part in contact, on a track moving along at w, normal at 2 w.

    Its mean velocity is 0 by symmetry. They are `frequency` [Hz], `friction`, `amplitude_along_1`
    and `amplitude_normal_2` [m], and `phase_normal_2` [degree].
    """
    inputs = random_harmonics(random)
    unit = GRAVITY / (2 * math.pi * inputs["frequency"]) ** 2
    return {
        "frequency": inputs["frequency"],
        "friction": inputs["friction"],
        "amplitude_along_1": float(random.uniform(0.5, 3)) * unit,
        "amplitude_normal_2": float(random.uniform(0.05, 0.95)) * unit / 4,
        "phase_normal_2": float(random.uniform(-180, 180)),
    }


def _turned(inputs: Mapping[str, float]) -> dict[str, float]:
    """Return the inputs of a drive with all phases (`phase_...`) reduced to -180 to 180 degrees."""
    return {
        name: math.remainder(value, 360.0) if name.startswith("phase_") else value
        for name, value in inputs.items()
    }


# --- balances over a cycle


def work_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the energy balance of a part over a cycle as terms, which add up to 0.

    They are the power of the drive less that of friction, of impacts and of lifting the part, per
    mass, over g times the track's largest speed along itself. `inputs` describe a straight drive:
    `frequency` [Hz], `friction`, `gamma` [degree], `amplitude_along_1`, `amplitude_normal_1` [m]
    and `phase_normal_1` [degree].
    """
    scale = 1 / (GRAVITY * _pace(inputs))
    lift = GRAVITY * sine_cosine(inputs["gamma"])[0]
    signs = {"drive_power": 1.0, "friction_power": -1.0, "impact_power": -1.0}
    signs["conveying_velocity"] = -lift
    return tuple(
        Term(simulation(output, inputs), output, times=sign * scale)
        for output, sign in signs.items()
    )


def random_hopping(random: Generator) -> dict[str, float]:
    """Return random inputs of a sliding or hopping part without rebound, under a straight drive.

    One harmonic along and normal: `frequency` [Hz], `friction`, `gamma` [degree],
    `amplitude_along_1`, `amplitude_normal_1` [m] and `phase_normal_1` [degree].
    """
    inputs = random_harmonics(random)
    unit = GRAVITY / (2 * math.pi * inputs["frequency"]) ** 2
    return {
        "frequency": inputs["frequency"],
        "friction": inputs["friction"],
        "gamma": inputs["gamma"],
        "amplitude_along_1": float(random.uniform(0.5, 4)) * unit,
        "amplitude_normal_1": float(random.uniform(0.2, 1.7)) * unit,
        "phase_normal_1": float(random.uniform(-60, 60)),
    }


def velocity_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the change of a part's relative velocity over a cycle of its motion as two terms.

    The velocity is relative to the track, as a share of the track's largest speed; the answer is 0,
    as the motion repeats. `inputs` describe a straight drive: `frequency` [Hz], `friction`, `gamma`
    [degree], `amplitude_along_1`, `amplitude_normal_1` [m] and `phase_normal_1` [degree].
    """
    output, scale = "relative_velocity_along", 1 / _pace(inputs)
    study = simulation("conveying_velocity", inputs, trajectory=2)
    return (
        Term(study, output, "last", times=scale),
        Term(study, output, "first", times=-scale),
    )


# --- a level track under one sine


def threshold(inputs: Inputs) -> float:
    """Return the largest acceleration above which a part never sticks [g]."""
    return math.hypot(inputs["friction_static"], math.pi * inputs["friction_kinetic"] / 2)


def stick_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the share of the period in which the part sticks."""
    return (Term(simulation("stick_fraction", _sine(inputs)), "stick_fraction"),)


def turning_phase(inputs: Inputs) -> float:
    """Return the phase at which the slip reverses, cos(theta) = pi mu g/(2 A w^2)."""
    return math.acos(math.pi * inputs["friction_kinetic"] / 2 / inputs["push"])


def turn_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the slip velocity shortly after it reverses, over A w, as the only term of an answer.

    The track is level under a sine along itself; it is asked for `LATER` (0.1 rad) after the slip
    is 0. Inputs are `frequency` [Hz], `push` (A w^2/g) and both frictions.
    """
    w = 2 * math.pi * inputs["frequency"]
    later = (turning_phase(inputs) + LATER) / w
    study = simulation("conveying_velocity", _sine(inputs), trajectory=[later])
    scale = w / (inputs["push"] * GRAVITY)
    return (Term(study, "relative_velocity_along", "first", times=scale),)


def turned(inputs: Inputs) -> float:
    """Return the slip velocity 0.1 rad after it reverses, over A w, on a level track under a sine.

    It is cos(theta) - mu_k g/(A w^2) d - cos(theta + d), with d = `LATER` and the phase theta at
    which the part has the track's speed; friction brakes the part from there. Inputs as of
    `turn_terms`.
    """
    theta = turning_phase(inputs)
    braked = math.cos(theta) - inputs["friction_kinetic"] / inputs["push"] * LATER
    return braked - math.cos(theta + LATER)


def _sine(inputs: Inputs) -> dict[str, float]:
    """Return the parameters of a sine drive along a level track, from its largest acceleration.

    Inputs are `frequency` [Hz], `push` (that acceleration in g) and both frictions.
    """
    frictions = {name: inputs[name] for name in ("friction_static", "friction_kinetic")}
    amplitude = inputs["push"] * GRAVITY / (2 * math.pi * inputs["frequency"]) ** 2
    return {"frequency": inputs["frequency"], "amplitude": amplitude, "beta": 0.0, **frictions}


def sticks(inputs: Inputs) -> float:
    """Return the least share of sticking that is more than rounding."""
    return 1e-8


def random_above(random: Generator, times: float = 1 + 1e-6) -> dict[str, float]:
    """Return random inputs of a level sine drive near the threshold above which no part sticks.

    Its largest acceleration, `push` in g, is `times` the threshold sqrt(mu_s^2 + (pi mu_k/2)^2);
    `frequency` is in Hz.
    """
    kinetic = float(random.uniform(0.05, 0.8))
    inputs = {
        "frequency": float(random.uniform(10, 120)),
        "friction_static": kinetic * float(random.choice([1.0, random.uniform(1.0, 1.5)])),
        "friction_kinetic": kinetic,
    }
    return inputs | {"push": threshold(inputs) * times}


def random_below(random: Generator) -> dict[str, float]:
    """Return random inputs just below the threshold."""
    return random_above(random, 1 - 1e-6)


def random_far_above(random: Generator) -> dict[str, float]:
    """Return random inputs of a part that never sticks."""
    return random_above(random, float(random.uniform(1.01, 4)))


FORMULAS = {
    "S-shift": Formula(shifted_terms, nothing, random_harmonics),
    "S-mirror": Formula(mirrored_terms, nothing, random_harmonics),
    "S-second-harmonic": Formula(reversed_terms, nothing, random_reversed),
    "S-double-frequency": Formula(doubled_terms, nothing, random_doubled),
    "B-work": Formula(work_terms, nothing, random_hopping),
    "B-velocity": Formula(velocity_terms, nothing, random_hopping),
    "Z-slides": Formula(stick_terms, nothing, random_above),
    "Z-sticks": Formula(stick_terms, sticks, random_below),
    "Z-turn": Formula(turn_terms, turned, random_far_above),
}
