"""Hard for the closed forms of travel on the track: radius, start, distance and time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from mpmath import mp

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    K_INPUTS,
    TRACK,
    W,
    from_study,
    hard_case,
    hopping,
    motion,
    sweep,
    track,
)
from vibrafeed.core.assurance.textbook import EPSILON, exact, exact_of_floats


def large_and_small_bowls() -> list[Case]:
    """Return hard cases with bowl radii up to infinity and down to half the part's length.

    At the latter the part no longer fits into the bowl.
    """
    family = "radius to infinity, and just above h/2"
    h = 0.05
    cases = [
        hard_case(
            f"{output}, R = {R:g} m", family, "R/mu times 1 - exp(-2 mu x/R) cancels",
            status=("slip",), **track(output, formula, radius=R),
        )
        for output, formula in (("transport_velocity", textbook.velocity_after),
                                ("travel_time", textbook.time_over))
        for R in (1e-9, 1e9, 1e15, 1e300)
    ]  # fmt: skip
    for ulps in (0, 1, 10, 1000):
        R = h / 2 * (1 + ulps * EPSILON)
        cases.append(hard_case(
            f"R = h/2 and {ulps} ulp", family, "cos(sigma) goes to 0 as a root",
            sweep("rectangle-on-track", "chord_cosine", length=h, radius=R), "chord_cosine",
            # (R - h/2)(R + h/2): the difference is exact, five roundings follow.
            exact_of_floats(textbook.chord_cosine, length=h, radius=R),
            ("contact", "invalid_geometry", "not_assessed"),
        ))  # fmt: skip
    cases.append(hard_case(
        "R = h/2 less 4 ulp", family, "no corner fits", sweep(
            "rectangle-on-track", "chord_cosine", length=h, radius=h / 2 * (1 - 4 * EPSILON)),
        refused="parameters.length",
    ))  # fmt: skip
    forces = {**TRACK, "radius": h / 2 * (1 + 1e-12), "length": h, "width": 1e-3, "mass": 0.01}
    del forces["distance"]
    cases.append(hard_case(
        "corner forces at R = h/2 (1 + 1e-12)", family, "a force over cos(sigma) = 1e-6",
        sweep("rectangle-on-track", "wall_force_front", **forces), "wall_force_front",
        _corner_force(forces),
    ))  # fmt: skip
    straight = {**hopping(1.5), "delta": 5.0}
    cases.append(hard_case(
        "motion, R = 1e15 m", family, "a curve that is none",
        {**motion("time-stepping", **straight, radius=1e15, steps_per_period=200),
         "scene": "rectangle-on-track"},
        "conveying_velocity",
        from_study(
            {**motion("time-stepping", **straight, steps_per_period=200),
             "scene": "rectangle-on-track"},
            "conveying_velocity", 1e-9, "straight track; a curvature number of 1e-19 changes no "
            "digit but by chance of an event"),
        ("periodic",),
    ))  # fmt: skip
    return cases


def _corner_force(parameters: Mapping[str, float]) -> Callable[[], Truth]:
    """Return a function for the true force of the wall on the front corner of a part at rest [N].

    lambda2 = S (h + mu a)/(2 h c), with S = m max(0, g_y - W), length h and width a of the part, c
    the cosine of half the angle of its chord, and W and g_y drive and gravity across the track
    (theory 4.4). `parameters` are those of the study.
    """
    names = ("mass", "length", "width", "radius", *K_INPUTS)

    def force(*, mass: Any, length: Any, width: Any, radius: Any, friction: Any, **p: Any) -> Any:
        """Return the force at the corner [N]."""
        rad = {name: p[name] * mp.pi / 180 for name in ("alpha", "beta", "gamma", "delta")}
        P = textbook.drive(frequency=p["frequency"], amplitude=p["amplitude"])
        across = p["gravity"] * mp.cos(rad["gamma"]) * mp.sin(rad["delta"])
        load = across - P * mp.cos(rad["beta"]) * mp.sin(rad["alpha"])
        S = mass * max(mp.zero, load)
        cosine = textbook.chord_cosine(length=length, radius=radius)
        return S * (length + friction * width) / (2 * length * cosine)

    return exact(force, **{name: parameters[name] for name in names})


def start_within_ulps() -> list[Case]:
    """Return hard cases whose starting acceleration K is 0 or a few roundings away from 0.

    Its sign decides between motion and none (theory 4.5).
    """
    family = "K within ulps of 0"
    amplitude = 1e-4
    P = amplitude * W * W
    steep = {"frequency": 50.0, "amplitude": amplitude, "alpha": 0.0, "beta": 0.0, "gamma": 90.0,
             "delta": 0.0, "friction": 0.3}  # fmt: skip
    cases = []
    for ulps in (-3, -1, 0, 1, 3):
        g = P * (1 + ulps * EPSILON)
        cases.append(hard_case(
            f"K, gravity {ulps:+d} ulp from the drive", family, "two accelerations cancel",
            sweep("rectangle-on-track", "starting_acceleration", **steep, gravity=g),
            "starting_acceleration", exact(textbook.starting_acceleration, **steep, gravity=g),
            ("flight",),  # the floor is upright: nothing presses on it
        ))  # fmt: skip
        # |K| is at most the roundings of P and g: 64 ulp of P.
        cases.append(hard_case(
            f"v(x), gravity {ulps:+d} ulp from the drive", family,
            "the sign of K decides between motion and none", sweep(
                "rectangle-on-track", "transport_velocity", **steep, gravity=g, radius=0.3,
                distance=1e-3),
            "transport_velocity", Truth(0.0, math.sqrt(2 * 64 * EPSILON * P * 1e-3),
                                        "limit: v^2 = 2 K x with K up to 64 ulp of P"),
            ("flight",),
        ))  # fmt: skip
    # Without a drive, every speed is faster than the track.
    level = {"frequency": 50.0, "amplitude": 0.0, "beta": 0.0, "friction": 0.3, "radius": 0.3,
             "speed": 0.1}  # fmt: skip
    s = 2 * 0.3 * 0.01 / 0.3
    cases += [
        hard_case(
            "v(x) at K = 0", family, "between the branches for K > 0 and K < 0", sweep(
                "rectangle-on-track", "transport_velocity", **level, distance=0.01),
            "transport_velocity",
            Truth(0.1 * math.exp(-s / 2), 8 * EPSILON * 0.1, "v0 exp(-s/2); 8 ulp"),
            ("faster_than_track",),
        ),
        hard_case(
            "t(x) at K = 0", family, "between atanh and atan", sweep(
                "rectangle-on-track", "travel_time", **level, distance=0.01),
            "travel_time", Truth(math.expm1(s / 2) / 0.1, 16 * EPSILON * s,
                                 "(R/(mu v0)) (exp(s/2) - 1); 16 ulp"), ("slip",),
        ),
        hard_case(
            "t(x) at K = 0, beyond the floats", family, "the time grows as exp(s/2), s = 4e9",
            sweep("rectangle-on-track", "travel_time", **{**level, "radius": 1e-7},
                  distance=1e3),
            "travel_time", Truth(math.inf, 0.0, "exp(1e9) is not a double"), ("unbounded",),
        ),
        hard_case(
            "stopping distance at K = 0", family, "never stops", sweep(
                "rectangle-on-track", "stopping_distance", **level),
            "stopping_distance", Truth(math.inf, 0.0, "limit of R/(2 mu) log1p(mu v0^2/(|K| R))"),
            ("unbounded",),
        ),
    ]  # fmt: skip
    return cases


def long_and_short_ways() -> list[Case]:
    """Return hard cases with distances and times of travel from 1e-30 to 1e9 m or s.

    There the exponential and hyperbolic functions of the closed forms cancel or overflow.
    """
    family = "distance and time from 1e-30 to 1e9"
    lengths = [
        hard_case(
            f"{output}, x = {x:g} m", family, "1 - exp(-s) cancels at one end, saturates at the "
            "other", status=("slip", "faster_than_track"), **track(output, formula, distance=x),
        )
        for output, formula in (("transport_velocity", textbook.velocity_after),
                                ("travel_time", textbook.time_over))
        for x in (1e-30, 1e-9, 1.0, 1e9)
    ]  # fmt: skip
    times = [
        hard_case(
            f"{output}, t = {t:g} s", family, "cosh overflows at one end, ln cosh vanishes at the "
            "other", status=("slip", "faster_than_track"), **track(output, formula, time=t),
        )
        for output, formula in (("velocity_at_time", textbook.velocity_at),
                                ("distance_at_time", textbook.distance_at))
        for t in (1e-30, 1e-9, 1.0, 1e9)
    ]  # fmt: skip
    return lengths + times
