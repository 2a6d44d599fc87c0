"""Hard because a regime begins or ends there: lift-off, hop after hop, Painleve."""

from __future__ import annotations

import math

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    G,
    W,
    corner,
    from_study,
    hard_case,
    hopping,
    motion,
    near,
    plane,
)
from vibrafeed.core.assurance.textbook import exact


def regime_borders() -> list[Case]:
    """Return hard cases at borders of regimes, where a rounding may change the kind of motion.

    The borders are throw number 1 (lift-off), the start of hop after hop, and the first period
    doubling.
    """
    family = "throw number 1, and regime borders"
    cases = []
    upright = {"frequency": 50.0, "amplitude": 1e-4, "beta": 90.0}
    P = 1e-4 * W * W
    for offset in (-1e-14, -1e-15, 0.0, 1e-15, 1e-14):
        case = plane("throw_number", textbook.throw_number, **upright, gravity=P / (1 + offset))
        sure = ("contact",) if offset < -5e-15 else ("flight",) if offset > 5e-15 else ()
        cases.append(hard_case(
            f"throw number 1{offset:+g}", family, "drive and gravity cancel to the last digits",
            status=sure or ("contact", "flight"), **case,
        ))  # fmt: skip
        # Continuous: a hop of 4 sqrt(2 offset) moves the part by its cube, 3e-20 of the drive.
        cases.append(hard_case(
            f"motion, throw number 1{offset:+g}", family, "a hop that is as long as the root of "
            "the rounding", motion(**hopping(1 + offset)), "conveying_velocity",
            from_study(motion(**hopping(1.0)), "conveying_velocity", 1e-12,
                       "throw number 1; continuous in it, slope of order 1, 1e-14 away"),
            ("periodic",),
        ))  # fmt: skip
    first = math.sqrt(1 + math.pi**2)
    formula = exact(textbook.hop_after_hop, frequency=50.0, beta=30.0, gamma=0.0, gravity=G)
    for name, throw in (("1e-12 above", first * (1 + 1e-12)), ("1e-15 above", first * (1 + 1e-15)),
                        ("at", first)):  # fmt: skip
        # A rest on the floor of a rounding's length is possible on either side.
        cases.append(hard_case(
            f"motion, {name} the start of hop after hop", family, "the hop ends where it begins",
            motion(**hopping(throw, friction=2.0)), "conveying_velocity", near(formula, 1e-7),
            ("periodic",), states_error=True,
        ))  # fmt: skip
    cases.append(hard_case(
        "motion, just below period doubling", family, "a cycle whose multiplier is nearly -1",
        motion(**hopping(3.7241, friction=2.0)), "conveying_velocity", formula, ("periodic",),
        states_error=True,
    ))  # fmt: skip
    cases.append(hard_case(
        "motion, just above period doubling", family, "it repeats after two periods, by a hair",
        motion(**hopping(3.7243, friction=2.0)), "conveying_velocity",
        near(formula, 0.02), ("periodic",), states_error=True,
    ))  # fmt: skip
    return cases


def painleve() -> list[Case]:
    """Return hard cases of a corner in contact whose response to a force vanishes (Painleve).

    There m tau = 0 at the friction mu_c (theory 2.2, 2.5): the contact force grows without bound,
    and beyond it has no solution or two.
    """
    family = "m tau to 0 (Painleve)"
    s = math.atan2(0.03, 0.02) + math.radians(5.0)
    limit = (4 + math.tan(s) ** 2) / (3 * math.tan(s))
    cases = []
    for offset in (-1e-3, -1e-9, -1e-13, 0.0, 1e-13, 1e-9, 1e-3):
        mu = limit * (1 + offset)
        cases.append(hard_case(
            f"m tau, mu = mu_c (1{offset:+g})", family, "the response to a force vanishes",
            **corner("normal_response_right", textbook.normal_response, friction=mu),
        ))  # fmt: skip
    for offset in (-1e-3, -1e-9, -1e-12):
        cases.append(hard_case(
            f"contact force, mu = mu_c (1{offset:+g})", family, "it grows as 1/tau",
            status=("sliding",), **corner(
                "floor_acceleration", textbook.contact_acceleration,
                friction=limit * (1 + offset)),
        ))  # fmt: skip
    for offset, rate, status in ((1e-12, 2.0, "no_solution"), (1e-12, 60.0, "two_solutions"),
                                 (-1e-12, 60.0, "separation")):  # fmt: skip
        corner_case = corner("floor_acceleration", textbook.contact_acceleration,
                             friction=limit * (1 + offset), pitch_rate=rate)  # fmt: skip
        if status != "two_solutions":
            value = math.nan if status == "no_solution" else 0.0
            corner_case["known"] = Truth(value, 0.0, "table of theory 2.3")
        if rate == 60.0:
            corner_case["content"]["parameters"]["velocity_along"] = 10.0
        cases.append(hard_case(
            f"{status.replace('_', ' ')}, mu = mu_c (1{offset:+g})", family,
            "the other side of tau = 0", status=(status,), **corner_case,
        ))  # fmt: skip
    return cases
