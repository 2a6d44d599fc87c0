"""Formulas of the forms: their studies, their values, and random inputs, one class of three each.

They share nothing with `vibrafeed.core.motion`: what is expected comes from the formula as it is
published. Lengths and times are in SI units, accelerations in g, angles in degrees; `GRAVITY` is g.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from numpy.random import Generator

from vibrafeed.core.assurance.case import Content, Term

GRAVITY = 9.81  # m s-2
MM = 1e3  # mm in a metre

Inputs = Mapping[str, float]


class Formula(NamedTuple):
    """The formula behind the problems of one form.

    Attributes
    ----------
    terms : callable
        Takes the inputs; returns the terms of the answer.
    value : callable
        Takes the inputs; returns the expected value, in the unit of the form.
    random : callable
        Takes a generator; returns random inputs.
    """

    terms: Callable[[Inputs], tuple[Term, ...]]
    value: Callable[[Inputs], float]
    random: Callable[[Generator], dict[str, float]]


def simulation(output: str, parameters: Mapping[str, Any], **more: Any) -> Content:
    """Return the content of a study that simulates a part on a plane, with one output.

    `parameters` are in the units of studies, and g is 9.81 m/s2 unless given; `more` are further
    keys of the study, such as `trajectory`.
    """
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": [output],
        **more,
        "parameters": {"gravity": GRAVITY, **parameters},
    }


def speed(parameters: Mapping[str, Any], times: float = MM, minus: float = 0.0) -> tuple[Term, ...]:
    """Return the mean velocity of a part on a plane as the only term of a result."""
    output = "conveying_velocity"
    return (Term(simulation(output, parameters), output, times=times, minus=minus),)


def sine_cosine(degrees: float) -> tuple[float, float]:
    """Return sine and cosine of an angle in degrees."""
    angle = math.radians(degrees)
    return math.sin(angle), math.cos(angle)


# --- Q: two levels of acceleration


def two_level_drive(inputs: Inputs) -> dict[str, float]:
    """Return the parameters of a drive along the track with two levels of acceleration.

    A long gentle one carries the part; a short sharp one, in the middle of the period, slips under
    it. `inputs` has `frequency` [Hz] and the levels `gentle` and `sharp` in g; the result is in
    m/s2, and durations are shares of the period for which the speed of the track repeats.
    """
    slow, fast = inputs["gentle"], inputs["sharp"]
    first = fast / (2 * (slow + fast))
    return {
        "frequency": inputs["frequency"],
        "acceleration_along_1": slow * GRAVITY,
        "acceleration_along_2": -fast * GRAVITY,
        "acceleration_along_3": slow * GRAVITY,
        "duration_1": first,
        "duration_2": 1 - 2 * first,
        "duration_3": first,
    }


def two_levels_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the simulation of a part under two levels of acceleration, as the only term [mm/s].

    A term is an output of a study; this is the mean velocity, to be compared with a formula.
    `inputs` are `frequency` [Hz], the accelerations `gentle` and `sharp` along the track in g,
    `friction_static` and `friction_kinetic`, and optionally `gamma` [degree] and `hold_down` (force
    per weight).
    """
    drive = two_level_drive(inputs)
    drive |= {name: inputs[name] for name in ("friction_static", "friction_kinetic")}
    drive |= {"gamma": inputs["gamma"]} if inputs.get("gamma") else {}
    drive |= {"hold_down": inputs["hold_down"] * GRAVITY} if inputs.get("hold_down") else {}
    return speed(drive)


def two_levels(inputs: Inputs) -> float:
    """Return the mean velocity of a part under two levels of acceleration along the track [mm/s].

    It is (T/2) a_s^2 (a_m - a_k)/((a_s + a_m)(a_s + a_k)) with the period T, the gentle level a_s,
    the sharp level a_m, and the deceleration of a part that slides forwards, a_k = mu_k (g
    cos(gamma) + F/m) + g sin(gamma). `inputs` are `frequency` [Hz], `gentle`, `sharp` and
    `hold_down` (F/m) in g, `gamma` [degree] and `friction_kinetic`.
    """
    slow, fast = inputs["gentle"], inputs["sharp"]
    down, onto = sine_cosine(inputs.get("gamma", 0.0))
    braking = inputs["friction_kinetic"] * (onto + inputs.get("hold_down", 0.0)) + down
    share = slow**2 * (fast - braking) / ((slow + fast) * (slow + braking))
    return MM * GRAVITY / (2 * inputs["frequency"]) * share


def random_two_levels(random: Generator) -> dict[str, float]:
    """Return random inputs of a part that sticks at the gentle level and slips at the sharp one.

    The levels are accelerations along the track, one after the other: `gentle` and `sharp` in g.
    Further inputs are `frequency` [Hz], `friction_static`, `friction_kinetic`, `gamma` [degree] and
    `hold_down` (force per weight). A third of the problems are on a level track, a third on a
    slope, a third held down on a slope or an upright rail. `random` is numpy's generator.
    """
    kinetic = float(random.uniform(0.05, 0.6))
    static = kinetic * float(random.choice([1.0, random.uniform(1.0, 1.6)]))
    inputs = {
        "frequency": float(random.uniform(5, 200)),
        "friction_static": static,
        "friction_kinetic": kinetic,
    }
    sort = int(random.integers(3))
    gamma = held = 0.0
    if sort == 1:  # not so steep that it slides off
        gamma = 0.7 * math.degrees(math.atan(kinetic)) * float(random.uniform(-1, 1))
    elif sort == 2:
        gamma = float(random.choice([90.0, random.uniform(-60, 60)]))
        held = float(random.uniform(1, 10)) / kinetic
    down, onto = sine_cosine(gamma)
    holds, frees = static * (onto + held) - down, static * (onto + held) + down
    inputs["gentle"] = holds * float(random.uniform(0.1, 0.99))
    inputs["sharp"] = max(frees, 0.0) + float(random.exponential()) + 0.01
    return inputs | {"gamma": gamma, "hold_down": held}


# --- W: in phase along and normal, half a period each


def winkler_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the simulation of a part under Winkler's wave: mean velocity [mm/s] as the only term.

    The track accelerates forwards and upwards for half a period, then backwards and downwards.
    `inputs` are `frequency` [Hz], `along` and `normal`, the accelerations in g, `friction_static`
    and `friction_kinetic`. The term, an output of a study, is compared with a formula.
    """
    along, normal = inputs["along"] * GRAVITY, inputs["normal"] * GRAVITY
    return speed(
        {
            "frequency": inputs["frequency"],
            "friction_static": inputs["friction_static"],
            "friction_kinetic": inputs["friction_kinetic"],
            "acceleration_along_1": along,
            "acceleration_along_2": -along,
            "acceleration_normal_1": normal,
            "acceleration_normal_2": -normal,
        }
    )


def winkler(inputs: Inputs) -> float:
    """Return the mean velocity of a part under Winkler's wave [mm/s].

    It is (T/8)(u - a_1)(2 u + a_2 - a_1)/(u + a_2), with the period T, the acceleration u along the
    track and a_1 = mu_k (g - q), a_2 = mu_k (g + q), q being that normal to it. `inputs` are
    `frequency` [Hz], `along` (u) and `normal` (q) in g, and `friction_kinetic`.
    """
    u, q, mu = inputs["along"], inputs["normal"], inputs["friction_kinetic"]
    less, more = mu * (1 - q), mu * (1 + q)
    share = (u - less) * (2 * u + more - less) / (u + more)
    return MM * GRAVITY / (8 * inputs["frequency"]) * share


def random_winkler(random: Generator) -> dict[str, float]:
    """Return random inputs of Winkler's wave for a part that sticks in one half of the period only.

    They are `frequency` [Hz], the accelerations `along` (u) and `normal` (q) of the track in g,
    `friction_static` (mu_s) and `friction_kinetic`, with mu_s (1 - q) < u <= mu_s (1 + q) and q <
    1. `random` is numpy's generator.
    """
    kinetic = float(random.uniform(0.05, 0.8))
    static = kinetic * float(random.choice([1.0, random.uniform(1.0, 1.3)]))
    q = float(random.uniform(0.15, 0.95))
    least = max(static * (1 - q), kinetic * (1 - q)) * 1.01
    return {
        "frequency": float(random.uniform(5, 200)),
        "along": float(random.uniform(least, static * (1 + q) * 0.99)),
        "normal": q,
        "friction_static": static,
        "friction_kinetic": kinetic,
    }


FORMULAS = {
    "Q-two-levels": Formula(two_levels_terms, two_levels, random_two_levels),
    "W-winkler": Formula(winkler_terms, winkler, random_winkler),
}
