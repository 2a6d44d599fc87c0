"""Hard for friction: none, far too much, met with equality."""

from __future__ import annotations

import math

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    DRIVE,
    G,
    W,
    by_reference,
    hard_case,
    hopping,
    motion,
    sweep,
    track,
)
from vibrafeed.core.assurance.textbook import EPSILON, exact


def little_and_much_friction() -> list[Case]:
    """Return hard cases without friction and with friction far above 1, up to 1e100.

    They test the closed forms of travel along a curved track, and simulated motions.
    """
    family = "friction from 0 to far above 1"
    cases = [
        hard_case(
            f"{output}, mu = {mu:g}", family, "(3.18) divides by mu, and by mu/R in an exponent",
            status=("slip",) if mu < 1 else ("wall_lost",), **track(
                output, formula, friction=mu, alpha=alpha, delta=5.0 if mu < 1 else 2.0),
        )
        for output, formula in (("transport_velocity", textbook.velocity_after),
                                ("travel_time", textbook.time_over))
        for mu, alpha in ((0.0, 1.0), (5e-324, 1.0), (1e-300, 1.0), (1e-16, 1.0), (30.0, 15.0),
                          (1e6, 15.0), (1e100, 15.0))  # with much friction the lean would hold it
    ]  # fmt: skip
    no_friction = {**hopping(0.8), "friction": 0.0}
    speed = no_friction["amplitude"] * W * math.cos(math.radians(30))
    return [
        *cases,
        hard_case(
            "stick at mu = 1e9", family, "the force that could act exceeds the one that does 1e9 "
            "times", sweep("rectangle-on-plane", "acceleration_x", **{**DRIVE, "amplitude": 1e-5},
                           friction=1e9),
            "acceleration_x", Truth(0.0, 0.0, "stick: exactly 0"), ("stick",),
        ),
        hard_case(
            "motion, mu = 0", family, "no friction brings the part to the track's speed",
            motion(**no_friction), "conveying_velocity",
            Truth(speed, 1e-14 * speed, "A0 w cos(beta), theory 13.8; ten roundings"), ("neutral",),
        ),
        *(
            hard_case(
                f"motion, mu = {mu:g}", family, "a transient of 1/mu periods",
                motion(**{**no_friction, "friction": mu}), "conveying_velocity",
                _sliding_on_both_sides(mu), ("periodic",), states_error=True,
            )
            for mu in (1e-300, 1e-12, 1e-6)
        ),
        hard_case(
            "motion, mu = 1e9, on the floor", family, "slopes of 1e9 where the part breaks loose",
            motion(**{**no_friction, "friction": 1e9}), "conveying_velocity",
            Truth(0.0, 0.0, "held at every phase"), ("at_rest",),
        ),
        hard_case(
            "motion, mu = 1e9, hop after hop", family, "an impact that stops every slip",
            motion(**hopping(3.5, friction=1e9)), "conveying_velocity",
            exact(textbook.hop_after_hop, frequency=50.0, beta=30.0, gamma=0.0, gravity=G),
            ("periodic",), states_error=True,
        ),
        hard_case(
            "motion, mu = 1001, reference method", family, "an integrator loses its digits there",
            motion("reference", **hopping(1.5, friction=1001.0)), refused="parameters.friction",
        ),
        hard_case(
            "mu = -1e-300", family, "just out of bounds",
            sweep("rectangle-on-plane", "acceleration_x", **DRIVE, friction=-1e-300),
            refused="parameters.friction",
        ),
    ]  # fmt: skip


def _sliding_on_both_sides(mu: float) -> Truth:
    """Return the true mean velocity of a part that never sticks, in the limit mu -> 0: it is 0.

    At the mean velocity 0 the part slides forwards as long as backwards, and the load is the same
    in both halves of the period, so that friction has no mean. The tolerance is 10 mu times the
    drive's speed along the track, at throw number 0.8 and 30 degrees.
    """
    drive = 0.8 * G / W / math.tan(math.radians(30))
    return Truth(
        0.0, 10 * mu * drive, "limit mu -> 0; the next term is of order mu times the drive"
    )


def met_thresholds() -> list[Case]:
    """Return hard cases in which friction is exactly as large as the force that it has to hold.

    A rounding then decides between stick and slip: both are right, and outputs have to be
    continuous.
    """
    family = "stick thresholds met with equality"
    P = 1e-4 * W * W
    level = {"frequency": 50.0, "amplitude": 1e-4, "beta": 0.0}
    slope = {**DRIVE, "gamma": 45.0, "friction": 1.0}
    cases = []
    for mu in (0.125, 0.5, 1.0, 2.0):
        for ulps in (-1, 0, 1):
            g = P / mu * (1 + ulps * EPSILON)  # a power of two: no rounding of mu g
            cases.append(hard_case(
                f"a_x, drive = mu g, mu = {mu:g}, {ulps:+d} ulp", family,
                "friction is as large as the drive", sweep(
                    "rectangle-on-plane", "acceleration_x", **level, friction=mu, gravity=g),
                "acceleration_x", Truth(0.0, 16 * EPSILON * P, "continuous: 0; 16 ulp of P"),
                ("stick", "slip"),
            ))  # fmt: skip
            # Slip lasts 2 sqrt(2 excess), and its speed is of the order of its cube.
            cases.append(hard_case(
                f"motion, drive = mu g, mu = {mu:g}, {ulps:+d} ulp", family,
                "it breaks loose for no time", motion(**level, friction=mu, gravity=g),
                "conveying_velocity",
                Truth(0.0, 1e-20 * P / W, "slip of a root of the rounding: its fourth power"),
                ("at_rest", "periodic"),
            ))  # fmt: skip
    cases.append(hard_case(
        "a_x, no drive on the slope of friction", family, "sin and cos of 45 degrees",
        sweep("rectangle-on-plane", "acceleration_x", frequency=50.0, amplitude=0.0, beta=0.0,
              gamma=45.0, friction=1.0),
        "acceleration_x", Truth(0.0, 8 * EPSILON * G, "tan(gamma) = mu; 8 ulp of g"),
        ("stick", "slip"),
    ))  # fmt: skip
    cases.append(hard_case(
        "motion on the slope of friction", family, "a part that slides downhill keeps its speed",
        motion(**slope), "conveying_velocity",
        Truth(math.nan, 0.0, "friction just balances gravity, theory 13.8"), ("limit_reached",),
    ))  # fmt: skip
    cases.append(hard_case(
        "motion 1e-9 degrees short of the slope of friction", family,
        "downhill it is slowed by 1e-11 of its weight",
        motion(**{**slope, "gamma": 45.0 - 1e-9}), "conveying_velocity", by_reference(slope),
        ("periodic",), states_error=True,
    ))  # fmt: skip
    cases.append(hard_case(
        "no friction, no drive, level", family, "0 = 0",
        sweep("rectangle-on-plane", "acceleration_x", frequency=50.0, amplitude=0.0, beta=0.0,
              friction=0.0),
        "acceleration_x", Truth(0.0, 0.0, "nothing acts"), ("stick",),
    ))  # fmt: skip
    return cases
