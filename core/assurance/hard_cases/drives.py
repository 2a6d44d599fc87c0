"""Hard for the drive: its frequency, its amplitude, its angles."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    DRIVE,
    TRACK,
    G,
    W,
    from_study,
    hard_case,
    hopping,
    motion,
    sweep,
    track,
)
from vibrafeed.core.assurance.textbook import EPSILON


def slow_and_fast_drives() -> list[Case]:
    """Return hard cases with drive frequencies from 1e-9 to 1e12 Hz, and some beyond the limits.

    Motions are compared with the same dimensionless motion at 50 Hz.
    """
    family = "frequencies of 1e-3 and 1e5 Hz"
    cases = []
    for frequency in (1e-9, 1e-3, 1e5, 1e12):
        for throw, friction in ((0.9, 0.3), (1.5, 0.5), (3.5, 0.5)):
            base = motion(**hopping(throw, friction=friction))
            cases.append(hard_case(
                f"motion, {frequency:g} Hz, throw number {throw:g}", family,
                "amplitudes from 1e-25 m to 1e17 m",
                motion(**hopping(throw, friction=friction, frequency=frequency)),
                "conveying_velocity",
                from_study(base, "conveying_velocity", 1e-10, "the same groups at 50 Hz: v f is "
                           "one number (theory 13.8); roundings of the drive, 1e-15, times its "
                           "conditioning", 50 / frequency),
                ("periodic",),
            ))  # fmt: skip
    for frequency in (1e-3, 1e5):
        cases.append(hard_case(
            f"v(x), {frequency:g} Hz", family, "the drive is 4e-10 or 4e6 times the usual",
            **track("transport_velocity", textbook.velocity_after, frequency=frequency, gamma=-1.0,
                    delta=-2.0),
        ))  # fmt: skip
    for frequency in (0.0, 1e-10, 1e13):
        cases.append(hard_case(
            f"motion, {frequency:g} Hz", family, "no period to take a mean over",
            motion(frequency=frequency, amplitude=1e-4, beta=30.0, friction=0.3),
            refused="parameters.frequency",
        ))  # fmt: skip
    return cases


def subnormal_amplitudes() -> list[Case]:
    """Return hard cases with amplitudes so small that floats lose digits (subnormal), or 0."""
    family = "subnormal amplitudes"
    cases = []
    for amplitude in (5e-324, 1e-310, 2.3e-308):
        parameters = {"frequency": 50.0, "amplitude": amplitude, "beta": 0.0}
        P = amplitude * (W * W)  # A0 w would be rounded to a multiple of 5e-324
        cases += [
            hard_case(
                f"drive, A0 = {amplitude:g} m", family, "fewer digits than usual",
                sweep("rectangle-on-plane", "vibration_acceleration", frequency=50.0,
                      amplitude=amplitude),
                "vibration_acceleration",
                Truth(P, 8 * EPSILON * P + 5e-324 * W,
                      "A0 w^2; 8 ulp, and the rounding of A0 w to a multiple of 5e-324, times w"),
            ),
            hard_case(
                f"v(x), A0 = {amplitude:g} m", family, "K underflows with mu",
                sweep("rectangle-on-track", "transport_velocity", **parameters, friction=0.3,
                      radius=0.3, distance=1e-3),
                "transport_velocity",
                # v^2 = 2 K x, and K has the relative error of a subnormal product.
                Truth(math.sqrt(2 * 1e-3) * math.sqrt(P) * math.sqrt(math.exp(-1e-3)),
                      math.sqrt(2e-3) * math.sqrt(P) * (1e-6 + 5e-324 / amplitude / W),
                      "sqrt(2 K x phi), phi = 1 - 1e-3 to 1e-6; A0 w is a multiple of 5e-324"),
                ("faster_than_track",),
            ),
            hard_case(
                f"motion, A0 = {amplitude:g} m", family, "every group is subnormal",
                motion(**parameters, friction=0.3), "conveying_velocity",
                Truth(0.0, 0.0, "held"), ("at_rest",),
            ),
            hard_case(
                f"motion without friction, A0 = {amplitude:g} m", family, "speeds below 1e-300",
                motion(**parameters, friction=0.0), "conveying_velocity",
                Truth(amplitude * W, 1e-4 * amplitude * W + 5e-322, "A0 w, of few digits"),
                ("neutral",),
            ),
        ]  # fmt: skip
    cases.append(hard_case(
        "efficiency of a part that slides down, A0 = 1e-310 m", family,
        "a speed over next to nothing",
        {**motion("time-stepping", "efficiency", frequency=50.0, amplitude=1e-310, beta=0.0,
                  friction=0.1, gamma=0.0, steps_per_period=100, max_periods=20), },
        "efficiency", Truth(0.0, 0.0, "held"), ("at_rest",),
    ))  # fmt: skip
    for amplitude in (0.0, 1e-320):
        cases.append(hard_case(
            f"efficiency of a part that creeps, A0 = {amplitude:g} m", family,
            "regularised friction lets it creep, at a speed over next to nothing",
            motion("regularised", "efficiency", frequency=50.0, amplitude=amplitude, beta=0.0,
                   gamma=3.0, gravity=G, friction=0.3),
            "efficiency", Truth(-math.inf, 0.0, "v < 0, beyond the floats"), ("periodic",),
        ))  # fmt: skip
    return cases


def angles() -> list[Case]:
    """Return hard cases with angles of drive and track at their limits, and a rounding beyond.

    Beyond a limit the study has to be refused.
    """
    family = "angles at and beyond their limits"
    P = 4e-4 * W * W
    cases = []
    for name, value, sign in (("beta", 90.0, 0.0), ("beta", 180.0, -1.0), ("beta", -90.0, 0.0),
                              ("alpha", 90.0, 0.0), ("alpha", 180.0, -1.0),
                              ("alpha", -180.0, -1.0)):  # fmt: skip
        parameters = {"frequency": 50.0, "amplitude": 4e-4, "alpha": 0.0, "beta": 0.0, name: value}
        cases.append(hard_case(
            f"drive along, {name} = {value:g}", family, "a cosine that is 0 is 6e-17 in floats",
            sweep("rectangle-on-plane", "drive_along", **parameters), "drive_along",
            Truth(sign * P, 8 * EPSILON * P, "exact angle; 8 ulp of the drive"),
        ))  # fmt: skip
    for gamma, status in ((90.0, "runaway"), (-90.0, "runaway")):
        cases.append(hard_case(
            f"motion, gamma = {gamma:g}", family, "a wall: nothing presses on it",
            motion(**{**DRIVE, "friction": 0.3, "gamma": gamma}), "conveying_velocity",
            Truth(math.nan, 0.0, "it falls"), (status,),
        ))  # fmt: skip
    cases.append(hard_case(
        "throw number, gamma = 90", family, "gravity onto the floor is 6e-17 g",
        sweep("rectangle-on-plane", "throw_number", **DRIVE, gravity=G, gamma=90.0),
        "throw_number",
        Truth(math.inf, 0.0, "nothing presses on an upright floor"), ("flight",),
    ))  # fmt: skip
    for beta, throw in ((1e-300, "at_rest"), (90.0, "periodic"), (180.0, "periodic")):
        cases.append(hard_case(
            f"motion, beta = {beta:g}", family, "the drive is all along or all normal",
            motion(frequency=50.0, amplitude=1.5e-4, beta=beta, friction=2.0 if throw == "at_rest"
                   else 0.3, gravity=G), "conveying_velocity",
            Truth(0.0, 1e-9 if beta == 180.0 else 1e-17, "symmetry"), (throw, "at_rest"),
        ))  # fmt: skip
    for name, value in (("beta", 180.0), ("alpha", 180.0), ("gamma", 90.0), ("delta", 90.0)):
        for sign in (1, -1):
            beyond = sign * np.nextafter(value, np.inf)
            parameters = {**TRACK, name: float(beyond)}
            cases.append(hard_case(
                f"{name} an ulp beyond {sign * value:g}", family, "just out of bounds",
                sweep("rectangle-on-track", "transport_velocity", **parameters),
                refused=f"parameters.{name}",
            ))  # fmt: skip
    cases.append(hard_case(
        "beta = 1e300", family, "far out of bounds", sweep(
            "rectangle-on-plane", "drive_along", **{**DRIVE, "beta": 1e300}),
        refused="parameters.beta",
    ))  # fmt: skip
    return cases
