"""Hard for impacts: full rebound, chatter, a stiff floor."""

from __future__ import annotations

import math
from collections.abc import Callable

from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    WORKED,
    Content,
    G,
    W,
    by_reference,
    hard_case,
    hopping,
    motion,
    sweep,
)
from vibrafeed.core.assurance.judge import results_of
from vibrafeed.core.assurance.textbook import EPSILON


def full_rebound() -> list[Case]:
    """Return hard cases of impacts that lose almost no energy: restitution 0.999 and 1.

    Parts fall and bounce, hop on a vibrating track, or hit each other.
    """
    family = "restitution 0.999 and 1"
    drop = {"length": 0.02, "height": 0.01, "friction": 0.3, "gravity": G, "drop_height": 1e-3}
    first = math.sqrt(2 * 1e-3 / G)

    def falls(restitution: float, output: str, **more: float) -> Content:
        """Return the study of a falling part."""
        return {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
                "outputs": [output],
                "parameters": {**drop, "restitution": restitution, **more}}  # fmt: skip

    cases = [
        hard_case(
            "a part that bounces for ever", family, "no impact takes energy",
            falls(1.0, "impact_count", duration=200.5 * first), "impact_count",
            Truth(100.0, 0.0, "one impact each 2 sqrt(2 h/g)"), ("moving",),
        ),
        hard_case(
            "energy after 100 full rebounds", family, "roundings add up",
            falls(1.0, "specific_energy_lost", duration=200.5 * first), "specific_energy_lost",
            Truth(0.0, 100 * 8 * EPSILON * G * 1e-3, "none; 8 ulp an impact"), ("moving",),
        ),
        hard_case(
            "the last height at restitution 0.999", family, "a thousand rebounds to halve it",
            falls(0.999, "largest_bounce", duration=50.0 * first), "largest_bounce",
            Truth(0.999**2 * 1e-3, 64 * EPSILON * 1e-3, "eps^2 h; 64 ulp"), ("moving",),
        ),
    ]  # fmt: skip
    for restitution in (0.999, 1.0):
        cases.append(hard_case(
            f"motion, restitution {restitution:g}", family, "the motion does not repeat, and what "
            "it means over a run is chance; each hop is a parabola all the same",
            motion("events", "landing_speed", **hopping(2.0, restitution=restitution)),
            "landing_speed", _fall_of_the_highest_hop(hopping(2.0, restitution=restitution)),
            ("aperiodic",),
        ))  # fmt: skip
        cases.append(hard_case(
            f"motion in contact, restitution {restitution:g}", family,
            "nothing lands, so nothing rebounds", motion(**hopping(0.9, restitution=restitution)),
            "conveying_velocity", by_reference(hopping(0.9)), ("periodic",), states_error=True,
        ))  # fmt: skip
    cases.append(hard_case(
        "motion, restitution 0.999, hops that die out", family, "8,000 impacts a period",
        motion(**hopping(1 + 1e-5, restitution=0.999)), "conveying_velocity",
        by_reference(hopping(1 + 1e-5)), ("periodic",), states_error=True,
    ))  # fmt: skip
    cases.append(hard_case(
        "restitution 1 + 1 ulp", family, "just out of bounds",
        motion(**hopping(2.0, restitution=1 + EPSILON)), refused="parameters.restitution",
    ))  # fmt: skip
    collision = {
        "position_x_1": 0.0, "position_y_1": 0.01, "angle_1": 0.0, "velocity_x_1": 0.0,
        "velocity_y_1": -1.0, "spin_1": 0.0, "length_1": 0.02, "width_1": 0.01, "mass_1": 0.01,
        "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.0, "velocity_x_2": 0.0,
        "velocity_y_2": 0.0, "spin_2": 0.0, "length_2": 0.02, "width_2": 0.01, "mass_2": 0.01,
        "restitution": 1.0,
    }  # fmt: skip
    cases.append(hard_case(
        "equal parts face to face", family, "two impulses at once, no loss",
        {**sweep("rectangle-pair-impact", "velocity_y_2_after", **collision),
         "variant": "frictionless"},
        "velocity_y_2_after", Truth(-1.0, 8 * EPSILON, "they change their velocities; 8 ulp"),
        ("impact",),
    ))  # fmt: skip
    return cases


def _fall_of_the_highest_hop(parameters: Content) -> Callable[[], Truth]:
    """Return a function that computes the largest landing speed from the height of the highest hop.

    `parameters` are those of a simulated drive, in the units of studies. The speed lies between
    sqrt(2 g (H - 2a)) - a w and sqrt(2 g (H + 2a)) + a w, with the simulated height H and the
    normal amplitude a of the track: the truth is the middle, with half the width as tolerance
    [m/s].
    """

    def truth() -> Truth:
        """Return the largest landing speed with its uncertainty by the phase."""
        table = results_of(motion("events", "hop_height", **parameters)).variables
        height = float(table["hop_height"].values)
        a = parameters["amplitude"] * math.sin(math.radians(parameters["beta"]))
        least, most = (
            math.sqrt(2 * parameters["gravity"] * max(0.0, height + 2 * way * a)) + way * a * W
            for way in (-1, 1)
        )
        source = "free fall from the largest height H: sqrt(2 g (H +- 2a)) +- a w"
        return Truth((least + most) / 2, (most - least) / 2, source)

    return truth


def _other_phase(parameters: Content) -> Callable[[], Truth]:
    """Return a function that computes the mean velocity by time stepping, with its own error [m/s].

    It is the truth for cases simulated by the method "events"; `parameters` are those of the study.
    """

    def truth() -> Truth:
        """Return the mean velocity by time stepping."""
        content = motion("time-stepping", **parameters, steps_per_period=500)
        table = results_of(content).variables
        value, error = (
            float(table[name].values) for name in ("conveying_velocity", "conveying_velocity_error")
        )
        return Truth(value, error, "time stepping, another method, with its own error")

    return truth


def chatter() -> list[Case]:
    """Return hard cases of chatter: infinitely many impacts in a finite time."""
    family = "chatter"
    cases = []
    for restitution in (0.5, 0.9, 0.99, 0.999):
        height = 1e-5
        first = math.sqrt(2 * height / G)
        rest = first * (1 + restitution) / (1 - restitution)
        # Impacts end at 1e-6 of sqrt(g rho): what is left lasts 2 w/(g (1 - eps)).
        left = 2 * 1e-6 * math.sqrt(G * 0.0112) / (G * (1 - restitution))
        cases.append(hard_case(
            f"bounces to rest, restitution {restitution:g}", family,
            "infinitely many impacts in a finite time",
            {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
             "outputs": ["settling_time"],
             "parameters": {"length": 0.02, "height": 0.01, "friction": 0.3, "gravity": G,
                            "drop_height": height, "restitution": restitution,
                            "duration": 2 * rest}},
            "settling_time",
            Truth(rest, 1.5 * left + 1e-12 * rest, "t1 (1 + eps)/(1 - eps), less what falls below "
                  "the speed at which a run of hops ends; that speed is one of late landings too"),
            ("settled",),
        ))  # fmt: skip
    chatter = {"frequency": 60.0, "amplitude": 2e-4, "beta": 32.0, "friction": 0.4,
               "gravity": 9.8, "restitution": 0.2}  # fmt: skip
    cases.append(hard_case(
        "motion with shrinking hops", family, "infinitely many hops a period",
        motion(**chatter), "conveying_velocity",
        Truth(0.034566932320251, 1e-14, WORKED), ("periodic",), states_error=True,
    ))  # fmt: skip
    for restitution in (0.6, 0.8):
        cases.append(hard_case(
            f"motion, throw number 1.05, restitution {restitution:g}", family,
            "hops shrink slowly, to be cut off where they no longer count",
            motion(**hopping(1.05, restitution=restitution)), "conveying_velocity",
            _other_phase(hopping(1.05, restitution=restitution)),
            ("periodic", "aperiodic"), states_error=True,
        ))  # fmt: skip
    return cases


def stiff_floor() -> list[Case]:
    """Return hard cases of a sprung floor (regularised contact), with stiffness up to 1e14."""
    family = "contact stiffness to 1e14"
    hop = {"frequency": 60.0, "amplitude": 4e-4, "beta": 25.0, "gravity": 9.8, "friction": 0.4}
    cases = [
        hard_case(
            f"regularised, stiffness {stiffness:g}", family, "an impact lasts 1e-7 of a period",
            motion("regularised", **hop, contact_stiffness=stiffness, slip_speed=1e-4),
            "conveying_velocity", Truth(0.12799649244377, 1e-14, WORKED),
            ("periodic",), states_error=True,
        )
        for stiffness in (1e6, 1e10, 1e14)
    ]  # fmt: skip
    cases.append(hard_case(
        "stiffness 1e17", family, "just out of bounds",
        motion("regularised", **hop, contact_stiffness=1e17), refused="contact_stiffness",
    ))  # fmt: skip
    return cases
