"""M, drives far above friction: the speed is where friction, weighted by the load, balances.

Then the part hardly changes its speed v over a period, and

    integral of N(t) sgn(v_track(t) - v) dt = T g sin(gamma)/mu,   N the load in g.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from vibrafeed.core.assurance.case import Term
from vibrafeed.core.assurance.forms.formulas import GRAVITY, Formula, Inputs, sine_cosine, speed

FREQUENCY = 50.0  # Hz; the answers are in scales in which it does not count
CIRCULAR = 2 * math.pi * FREQUENCY
FAST = 1e-5
"""mu g/(A w^2) of random members."""


def _along(inputs: Inputs) -> float:
    """Return the amplitude of the track along itself [m], from the inputs `friction` and `weak`.

    `weak` is mu g/(A w^2): friction over the largest force along the track.
    """
    return inputs["friction"] * GRAVITY / (inputs["weak"] * CIRCULAR**2)


def _share(inputs: Inputs, drive: dict[str, float]) -> tuple[Term, ...]:
    """Return the terms of the mean velocity over the largest speed of the track."""
    drive |= {"frequency": FREQUENCY, "friction": inputs["friction"]}
    return speed(drive, times=1 / (_along(inputs) * CIRCULAR))


# --- one frequency, along and normal


def ellipse_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the simulation of a part under an elliptic drive as a term: mean velocity over A_x w.

    A_x w is the largest speed of the track along itself. Inputs are `weak` (mu g/(A_x w^2)),
    `throw` (normal acceleration over g cos(gamma)), `phase` of the normal motion and `gamma`
    [degree], and `friction`.
    """
    normal = inputs["throw"] * GRAVITY * sine_cosine(inputs["gamma"])[1] / CIRCULAR**2
    return _share(
        inputs,
        {
            "amplitude_along_1": _along(inputs),
            "amplitude_normal_1": normal,
            "phase_normal_1": inputs["phase"],
            "gamma": inputs["gamma"],
        },
    )


def ellipse(inputs: Inputs) -> float:
    """Return the mean velocity over A_x w under a fast elliptic drive, c = cos(psi), by bisection.

    psi is the root of psi - Gamma sin(phi) sin(psi) = pi/2 (1 + tan(gamma)/mu), where friction
    weighted by the load balances over a period; Gamma is the input `throw`, phi the `phase`, mu the
    `friction`.
    """
    turned = inputs["throw"] * sine_cosine(inputs["phase"])[0]
    climb = math.tan(math.radians(inputs["gamma"])) / inputs["friction"]
    right = math.pi / 2 * (1 + climb)
    least, most = 0.0, math.pi  # of the angle acos(c), which the left side rises with
    for _ in range(100):
        angle = (least + most) / 2
        if angle - turned * math.sin(angle) < right:
            least = angle
        else:
            most = angle
    return math.cos((least + most) / 2)


def random_ellipse(random: Generator) -> dict[str, float]:
    """Return random inputs of a fast elliptic drive, on slopes less steep than the steepest climb.

    They are `weak` (mu g/(A_x w^2), with the amplitude A_x along the track), `throw` (normal
    acceleration over g cos(gamma)), `phase` of the normal motion [degree], `friction` (mu) and
    `gamma` [degree]. `random` is numpy's generator.
    """
    throw, phase = float(random.uniform(0.1, 1)), float(random.uniform(-180, 180))
    friction = float(random.uniform(0.1, 0.9))
    steepest = climb({"throw": throw, "phase": phase, "friction": friction})
    gamma = float(random.choice([0.0, random.uniform(-0.9, 0.9) * steepest]))
    return {"weak": FAST, "throw": throw, "phase": phase, "friction": friction, "gamma": gamma}


def climb(inputs: Inputs) -> float:
    """Return gamma of tan(gamma) = (2/pi) mu Gamma |sin(phi)| [degree], where v is 0."""
    turned = abs(sine_cosine(inputs["phase"])[0])
    return math.degrees(math.atan(2 / math.pi * inputs["friction"] * inputs["throw"] * turned))


def climb_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the mean velocity on the steepest climb, over A_x w."""
    return ellipse_terms({**inputs, "gamma": climb(inputs)})


def random_climb(random: Generator) -> dict[str, float]:
    """Return random inputs of an ellipse that conveys upwards."""
    inputs = random_ellipse(random)
    del inputs["gamma"]
    return inputs | {"phase": float(random.uniform(-170, -10))}


def at_rest(inputs: Inputs) -> float:
    """Return 0: on the steepest climb the part neither climbs nor falls back."""
    return 0.0


# --- in phase


def line_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the simulation of a part under a straight drive as a term: velocity over Gamma mu g/w.

    Inputs are `weak` (mu g/(A w^2) along the track), `throw` (Gamma, normal acceleration over g)
    and `friction` mu.
    """
    drive = {
        "frequency": FREQUENCY,
        "friction": inputs["friction"],
        "amplitude_along_1": _along(inputs),
        "amplitude_normal_1": inputs["throw"] * GRAVITY / CIRCULAR**2,
    }
    scale = inputs["throw"] * inputs["friction"] * GRAVITY / CIRCULAR
    return speed(drive, times=1 / scale)


def line(inputs: Inputs) -> float:
    """Return the velocity under a straight drive over Gamma mu g/w, pi/2 + 2/pi."""
    return math.pi / 2 + 2 / math.pi


def random_line(random: Generator) -> dict[str, float]:
    """Return random inputs of a straight drive whose normal acceleration is below gravity.

    They are `weak` (mu g/(A w^2), with the amplitude A along the track), `throw` (normal
    acceleration over g) and `friction` (mu). `random` is numpy's generator.
    """
    return {
        "weak": 1e-4,
        "throw": float(random.uniform(0.1, 1)),
        "friction": float(random.uniform(0.1, 0.9)),
    }


# --- two frequencies along the track


def second_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the simulation of a part under two harmonics as a term: mean velocity over A w.

    The speed of the track is A w (cos(wt) + e cos(2 wt)). Inputs are `weak` (mu g/(A w^2)),
    `second` (e) and `friction`.
    """
    along = _along(inputs)
    return _share(
        inputs,
        {"amplitude_along_1": along, "amplitude_along_2": inputs["second"] * along / 2},
    )


def second(inputs: Inputs) -> float:
    """Return the velocity over A w under the second harmonic, -e, to first order in e."""
    return -inputs["second"]


def random_second(random: Generator) -> dict[str, float]:
    """Return random inputs of a drive along the track with a weak second harmonic.

    They are `weak` (mu g/(A w^2), with the amplitude A of the first harmonic), `second` (speed of
    the second harmonic over that of the first, at most 1/4) and `friction` (mu). `random` is
    numpy's generator.
    """
    return {
        "weak": FAST,
        "second": float(random.uniform(0.01, 0.25)),
        "friction": float(random.uniform(0.1, 0.9)),
    }


FORMULAS = {
    "M-ellipse": Formula(ellipse_terms, ellipse, random_ellipse),
    "M-climb": Formula(climb_terms, at_rest, random_climb),
    "M-line": Formula(line_terms, line, random_line),
    "M-two-frequencies": Formula(second_terms, second, random_second),
}
