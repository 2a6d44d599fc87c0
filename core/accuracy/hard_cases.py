"""The catalogue of hard cases: each a study as a user would write it, and what is right for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from core import kinds
from core.accuracy import textbook as forms
from core.accuracy.textbook import EPSILON, Answer, exact, exact_of_floats
from core.dataset.table import Table
from core.watch import Watch

Content = dict[str, Any]
Attempt = Callable[[], tuple[float, float, str]]


@dataclass(frozen=True)
class HardCase:
    """A study at the edge of what numbers or methods bear.

    Attributes
    ----------
    name, family : str
        What it is called, and what it is hard for.
    why : str
        Why it is hard.
    content : mapping
        The study.
    output : str
        The output that is judged.
    answer : callable, optional
        Returns the right value and the largest error; None where the study is to be refused, or
        where only status and finiteness are judged.
    status : tuple of str
        The statuses (of motion) or regimes (of a sweep) that may stand there; empty for any.
    refused : str
        The place that the `StudyError` has to name, if one is right.
    says : bool
        Whether the result states its own error, which is then added to that of the answer.
    blunt : str
        Why the error that the method states may be larger than what it is stated for; empty where
        it may not.
    attempt : callable, optional
        Runs in the place of the study; returns error, stated error and a note.
    """

    name: str
    family: str
    why: str
    content: Mapping[str, Any]
    output: str = ""
    answer: Callable[[], Answer] | None = None
    status: tuple[str, ...] = ()
    refused: str = ""
    says: bool = False
    blunt: str = ""
    attempt: Attempt | None = None


def result_of(content: Mapping[str, Any], watch: Watch | None = None) -> Table:
    """Return the results of a study given as a user writes it."""
    return kinds.tabulate(kinds.prepare_content(content), watch)


# --- how studies are written here

DRIVE = {"frequency": 50.0, "amplitude": 4e-4, "beta": 20.0}
# The part stays on floor and wall.
TRACK = {**DRIVE, "amplitude": 5e-5, "alpha": 1.0, "gamma": 1.0, "delta": 5.0, "gravity": 9.80665,
         "friction": 0.3, "radius": 0.3, "distance": 1e-5}  # fmt: skip
K_INPUTS = ("frequency", "amplitude", "alpha", "beta", "gamma", "delta", "gravity", "friction")
G = 9.80665
W = 2 * math.pi * 50
WORKED = "worked value, 14 digits (tests/laws/test_stepping.py)"


def sweep(scene: str, output: str, **parameters: Any) -> Content:
    """Return a sweep with one output."""
    return {"kind": "sweep", "scene": scene, "outputs": [output], "parameters": parameters}


def track(output: str, formula: forms.Formula, **changes: float) -> dict[str, Any]:
    """Return study, output and answer of a velocity law on the track."""
    given = {**TRACK, **changes}
    if "time" in given:
        del given["distance"]
    return {
        "content": sweep("rectangle-on-track", output, **given),
        "output": output,
        "answer": exact(formula, **given),
    }


def plane(output: str, formula: forms.Formula | None = None, **given: float) -> dict[str, Any]:
    """Return study, output and answer on the plane, of a formula of all that is given."""
    content = sweep("rectangle-on-plane", output, **given)
    return {
        "content": content,
        "output": output,
        "answer": exact(formula, **given) if formula else None,
    }


def corner(output: str, formula: forms.Formula, **changes: float) -> dict[str, Any]:
    """Return study, output and answer of a corner that slips to the right."""
    given = {"height": 0.03, "length": 0.02, "pitch": 5.0, "pitch_rate": 2.0, "gravity": G}
    given |= changes
    if output == "normal_response_right":
        del given["pitch_rate"], given["gravity"]
        content = sweep("rectangle-isolated", output, **given)
    else:
        content = sweep("rectangle-isolated", output, **given, velocity_along=1.0)
    return {"content": content, "output": output, "answer": exact(formula, **given)}


def motion(method: str = "events", output: str = "conveying_velocity", /, **given: Any) -> Content:
    """Return a simulation of a block on a plane; settings stand among the parameters."""
    settings: Content = {
        name: given.pop(name)
        for name in ("slip_speed", "contact_stiffness", "tolerance", "most_periods",
                     "steps_per_period")
        if name in given
    }  # fmt: skip
    outputs = list(dict.fromkeys((output, "conveying_velocity_error")))
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "method": method, "outputs": outputs,
        **settings, "parameters": given,
    }  # fmt: skip


def hopping(throw: float, **changes: Any) -> dict[str, Any]:
    """Return parameters of a drive of 50 Hz at 30 degrees with the given throw number."""
    given = {"frequency": 50.0, "beta": 30.0, "gravity": G, "friction": 0.5} | changes
    w, beta = 2 * math.pi * given["frequency"], math.radians(given["beta"])
    gamma = math.radians(given.get("gamma", 0.0))
    amplitude = throw * given["gravity"] * math.cos(gamma) / (w * w * math.sin(beta))
    return {**given, "amplitude": amplitude}


def known(value: Any, error: Any, source: str) -> Callable[[], Answer]:
    """Return what gives a value that stands here."""
    return lambda: Answer(value, error, source)


def from_study(
    content: Content, output: str, relative: float, source: str, factor: float = 1.0
) -> Callable[[], Answer]:
    """Return what gives the output of another study, times a factor, with a relative error."""

    def answer() -> Answer:
        value = factor * float(result_of(content).variables[output].values)
        return Answer(value, relative * abs(value), source)

    return answer


# --- cases by family


def _little_and_much_friction() -> list[HardCase]:
    family = "friction from 0 to far above 1"
    cases = [
        HardCase(
            f"{output}, mu = {mu:g}", family, "(3.18) divides by mu, and by mu/R in an exponent",
            status=("slip",) if mu < 1 else ("wall_lost",), **track(
                output, formula, friction=mu, alpha=alpha, delta=5.0 if mu < 1 else 2.0),
        )
        for output, formula in (("transport_velocity", forms.velocity_after),
                                ("travel_time", forms.time_over))
        for mu, alpha in ((0.0, 1.0), (5e-324, 1.0), (1e-300, 1.0), (1e-16, 1.0), (30.0, 15.0),
                          (1e6, 15.0), (1e100, 15.0))  # with much friction the lean would hold it
    ]  # fmt: skip
    no_friction = {**hopping(0.8), "friction": 0.0}
    speed = no_friction["amplitude"] * W * math.cos(math.radians(30))
    return [
        *cases,
        HardCase(
            "stick at mu = 1e9", family, "the force that could act exceeds the one that does 1e9 "
            "times", sweep("rectangle-on-plane", "acceleration_x", **{**DRIVE, "amplitude": 1e-5},
                           friction=1e9),
            "acceleration_x", known(0.0, 0.0, "stick: exactly 0"), ("stick",),
        ),
        HardCase(
            "motion, mu = 0", family, "no friction brings the part to the track's speed",
            motion(**no_friction), "conveying_velocity",
            known(speed, 1e-14 * speed, "A0 w cos(beta), theory 13.8; ten roundings"), ("neutral",),
        ),
        *(
            HardCase(
                f"motion, mu = {mu:g}", family, "a transient of 1/mu periods",
                motion(**{**no_friction, "friction": mu}), "conveying_velocity",
                _sliding_on_both_sides(mu), ("periodic",), says=True,
            )
            for mu in (1e-300, 1e-12, 1e-6)
        ),
        HardCase(
            "motion, mu = 1e9, on the floor", family, "slopes of 1e9 where the part breaks loose",
            motion(**{**no_friction, "friction": 1e9}), "conveying_velocity",
            known(0.0, 0.0, "held at every phase"), ("at_rest",),
        ),
        HardCase(
            "motion, mu = 1e9, hop after hop", family, "an impact that stops every slip",
            motion(**hopping(3.5, friction=1e9)), "conveying_velocity",
            exact(forms.hop_after_hop, frequency=50.0, beta=30.0, gamma=0.0, gravity=G),
            ("periodic",), says=True,
        ),
        HardCase(
            "motion, mu = 1001, reference method", family, "an integrator loses its digits there",
            motion("reference", **hopping(1.5, friction=1001.0)), refused="parameters.friction",
        ),
        HardCase(
            "mu = -1e-300", family, "just out of bounds",
            sweep("rectangle-on-plane", "acceleration_x", **DRIVE, friction=-1e-300),
            refused="parameters.friction",
        ),
    ]  # fmt: skip


def _sliding_on_both_sides(mu: float) -> Callable[[], Answer]:
    """Return what gives the mean velocity of a part that never sticks, for mu -> 0.

    At the mean velocity 0 it slides forward as long as backward, -cos(tau) being positive, and the
    normal force is even about pi/2, as friction's sign is odd: friction has no mean there.
    """
    drive = 0.8 * G / W / math.tan(math.radians(30))
    return known(
        0.0, 10 * mu * drive, "limit mu -> 0; the next term is of order mu times the drive"
    )


def _large_and_small_bowls() -> list[HardCase]:
    family = "radius to infinity, and just above h/2"
    h = 0.05
    cases = [
        HardCase(
            f"{output}, R = {R:g} m", family, "R/mu times 1 - exp(-2 mu x/R) cancels",
            status=("slip",), **track(output, formula, radius=R),
        )
        for output, formula in (("transport_velocity", forms.velocity_after),
                                ("travel_time", forms.time_over))
        for R in (1e-9, 1e9, 1e15, 1e300)
    ]  # fmt: skip
    for ulps in (0, 1, 10, 1000):
        R = h / 2 * (1 + ulps * EPSILON)
        cases.append(HardCase(
            f"R = h/2 and {ulps} ulp", family, "cos(sigma) goes to 0 as a root",
            sweep("rectangle-on-track", "chord_cosine", length=h, radius=R), "chord_cosine",
            # (R - h/2)(R + h/2): the difference is exact, five roundings follow.
            exact_of_floats(forms.chord_cosine, length=h, radius=R),
            ("contact", "invalid_geometry", "not_assessed"),
        ))  # fmt: skip
    cases.append(HardCase(
        "R = h/2 less 4 ulp", family, "no corner fits", sweep(
            "rectangle-on-track", "chord_cosine", length=h, radius=h / 2 * (1 - 4 * EPSILON)),
        refused="parameters.length",
    ))  # fmt: skip
    forces = {**TRACK, "radius": h / 2 * (1 + 1e-12), "length": h, "width": 1e-3, "mass": 0.01}
    del forces["distance"]
    cases.append(HardCase(
        "corner forces at R = h/2 (1 + 1e-12)", family, "a force over cos(sigma) = 1e-6",
        sweep("rectangle-on-track", "wall_force_front", **forces), "wall_force_front",
        _corner_force(forces),
    ))  # fmt: skip
    straight = {**hopping(1.5), "delta": 5.0}
    cases.append(HardCase(
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


def _corner_force(given: Mapping[str, float]) -> Callable[[], Answer]:
    """Return what gives lambda2 of theory 4.4 at rest: m s (h + mu a)/(2 h c)."""
    names = ("mass", "length", "width", "radius", *K_INPUTS)

    def force(*, mass: Any, length: Any, width: Any, radius: Any, friction: Any, **p: Any) -> Any:
        from mpmath import mp

        rad = {name: p[name] * mp.pi / 180 for name in ("alpha", "beta", "gamma", "delta")}
        P = forms.drive(frequency=p["frequency"], amplitude=p["amplitude"])
        across = p["gravity"] * mp.cos(rad["gamma"]) * mp.sin(rad["delta"])
        load = across - P * mp.cos(rad["beta"]) * mp.sin(rad["alpha"])
        S = mass * max(mp.zero, load)
        cosine = forms.chord_cosine(length=length, radius=radius)
        return S * (length + friction * width) / (2 * length * cosine)

    return exact(force, **{name: given[name] for name in names})


def _start_within_ulps() -> list[HardCase]:
    family = "K within ulps of 0"
    amplitude = 1e-4
    P = amplitude * W * W
    steep = {"frequency": 50.0, "amplitude": amplitude, "alpha": 0.0, "beta": 0.0, "gamma": 90.0,
             "delta": 0.0, "friction": 0.3}  # fmt: skip
    cases = []
    for ulps in (-3, -1, 0, 1, 3):
        g = P * (1 + ulps * EPSILON)
        cases.append(HardCase(
            f"K, gravity {ulps:+d} ulp from the drive", family, "two accelerations cancel",
            sweep("rectangle-on-track", "starting_acceleration", **steep, gravity=g),
            "starting_acceleration", exact(forms.starting_acceleration, **steep, gravity=g),
            ("flight",),  # the floor is upright: nothing presses on it
        ))  # fmt: skip
        # |K| is at most the roundings of P and g: 64 ulp of P.
        cases.append(HardCase(
            f"v(x), gravity {ulps:+d} ulp from the drive", family,
            "the sign of K decides between motion and none", sweep(
                "rectangle-on-track", "transport_velocity", **steep, gravity=g, radius=0.3,
                distance=1e-3),
            "transport_velocity", known(0.0, math.sqrt(2 * 64 * EPSILON * P * 1e-3),
                                        "limit: v^2 = 2 K x with K up to 64 ulp of P"),
            ("flight",),
        ))  # fmt: skip
    # Without a drive, every speed is faster than the track.
    level = {"frequency": 50.0, "amplitude": 0.0, "beta": 0.0, "friction": 0.3, "radius": 0.3,
             "speed": 0.1}  # fmt: skip
    s = 2 * 0.3 * 0.01 / 0.3
    cases += [
        HardCase(
            "v(x) at K = 0", family, "between the branches for K > 0 and K < 0", sweep(
                "rectangle-on-track", "transport_velocity", **level, distance=0.01),
            "transport_velocity",
            known(0.1 * math.exp(-s / 2), 8 * EPSILON * 0.1, "v0 exp(-s/2); 8 ulp"),
            ("faster_than_track",),
        ),
        HardCase(
            "t(x) at K = 0", family, "between atanh and atan", sweep(
                "rectangle-on-track", "travel_time", **level, distance=0.01),
            "travel_time", known(math.expm1(s / 2) / 0.1, 16 * EPSILON * s,
                                 "(R/(mu v0)) (exp(s/2) - 1); 16 ulp"), ("slip",),
        ),
        HardCase(
            "t(x) at K = 0, beyond the floats", family, "the time grows as exp(s/2), s = 4e9",
            sweep("rectangle-on-track", "travel_time", **{**level, "radius": 1e-7},
                  distance=1e3),
            "travel_time", known(math.inf, 0.0, "exp(1e9) is no float"), ("unbounded",),
        ),
        HardCase(
            "stopping distance at K = 0", family, "never stops", sweep(
                "rectangle-on-track", "stopping_distance", **level),
            "stopping_distance", known(math.inf, 0.0, "limit of R/(2 mu) log1p(mu v0^2/(|K| R))"),
            ("unbounded",),
        ),
    ]  # fmt: skip
    return cases


def _long_and_short_ways() -> list[HardCase]:
    family = "distance and time from 1e-30 to 1e9"
    lengths = [
        HardCase(
            f"{output}, x = {x:g} m", family, "1 - exp(-s) cancels at one end, saturates at the "
            "other", status=("slip", "faster_than_track"), **track(output, formula, distance=x),
        )
        for output, formula in (("transport_velocity", forms.velocity_after),
                                ("travel_time", forms.time_over))
        for x in (1e-30, 1e-9, 1.0, 1e9)
    ]  # fmt: skip
    times = [
        HardCase(
            f"{output}, t = {t:g} s", family, "cosh overflows at one end, ln cosh vanishes at the "
            "other", status=("slip", "faster_than_track"), **track(output, formula, time=t),
        )
        for output, formula in (("velocity_at_time", forms.velocity_at),
                                ("distance_at_time", forms.distance_at))
        for t in (1e-30, 1e-9, 1.0, 1e9)
    ]  # fmt: skip
    return lengths + times


def _regime_borders() -> list[HardCase]:
    family = "throw number 1, and regime borders"
    cases = []
    upright = {"frequency": 50.0, "amplitude": 1e-4, "beta": 90.0}
    P = 1e-4 * W * W
    for offset in (-1e-14, -1e-15, 0.0, 1e-15, 1e-14):
        case = plane("throw_number", forms.throw_number, **upright, gravity=P / (1 + offset))
        sure = ("contact",) if offset < -5e-15 else ("flight",) if offset > 5e-15 else ()
        cases.append(HardCase(
            f"throw number 1{offset:+g}", family, "drive and gravity cancel to the last digits",
            status=sure or ("contact", "flight"), **case,
        ))  # fmt: skip
        # Continuous: a hop of 4 sqrt(2 offset) moves the part by its cube, 3e-20 of the drive.
        cases.append(HardCase(
            f"motion, throw number 1{offset:+g}", family, "a hop that is as long as the root of "
            "the rounding", motion(**hopping(1 + offset)), "conveying_velocity",
            from_study(motion(**hopping(1.0)), "conveying_velocity", 1e-12,
                       "throw number 1; continuous in it, slope of order 1, 1e-14 away"),
            ("periodic",), blunt="a rounding over how far the throw number is above 1"
            if offset > 0 else "",
        ))  # fmt: skip
    first = math.sqrt(1 + math.pi**2)
    formula = exact(forms.hop_after_hop, frequency=50.0, beta=30.0, gamma=0.0, gravity=G)
    for name, throw in (("1e-12 above", first * (1 + 1e-12)), ("1e-15 above", first * (1 + 1e-15)),
                        ("at", first)):  # fmt: skip
        # A rest on the floor of a rounding's length is possible on either side.
        cases.append(HardCase(
            f"motion, {name} the start of hop after hop", family, "the hop ends where it begins",
            motion(**hopping(throw, friction=2.0)), "conveying_velocity", _near(formula, 1e-7),
            ("periodic",), says=True,
        ))  # fmt: skip
    cases.append(HardCase(
        "motion, just below period doubling", family, "a cycle whose multiplier is nearly -1",
        motion(**hopping(3.7241, friction=2.0)), "conveying_velocity", formula, ("periodic",),
        says=True,
    ))  # fmt: skip
    cases.append(HardCase(
        "motion, just above period doubling", family, "it repeats after two periods, by a hair",
        motion(**hopping(3.7243, friction=2.0)), "conveying_velocity",
        _near(formula, 0.02), ("periodic",), says=True,
    ))  # fmt: skip
    return cases


def _near(answer: Callable[[], Answer], relative: float) -> Callable[[], Answer]:
    """Return the same value with a larger error: a limit, not reached."""

    def near() -> Answer:
        value = answer().value
        return Answer(value, relative * abs(value), "closed form of the limit that it is near")

    return near


def _painleve() -> list[HardCase]:
    family = "m tau to 0 (Painleve)"
    s = math.atan2(0.03, 0.02) + math.radians(5.0)
    limit = (4 + math.tan(s) ** 2) / (3 * math.tan(s))
    cases = []
    for offset in (-1e-3, -1e-9, -1e-13, 0.0, 1e-13, 1e-9, 1e-3):
        mu = limit * (1 + offset)
        cases.append(HardCase(
            f"m tau, mu = mu_c (1{offset:+g})", family, "the response to a force vanishes",
            **corner("normal_response_right", forms.normal_response, friction=mu),
        ))  # fmt: skip
    for offset in (-1e-3, -1e-9, -1e-12):
        cases.append(HardCase(
            f"contact force, mu = mu_c (1{offset:+g})", family, "it grows as 1/tau",
            status=("sliding",), **corner(
                "floor_acceleration", forms.contact_acceleration,
                friction=limit * (1 + offset)),
        ))  # fmt: skip
    for offset, rate, status in ((1e-12, 2.0, "no_solution"), (1e-12, 60.0, "two_solutions"),
                                 (-1e-12, 60.0, "separation")):  # fmt: skip
        given = corner("floor_acceleration", forms.contact_acceleration,
                       friction=limit * (1 + offset), pitch_rate=rate)  # fmt: skip
        if status != "two_solutions":
            value = math.nan if status == "no_solution" else 0.0
            given["answer"] = known(value, 0.0, "table of theory 2.3")
        if rate == 60.0:
            given["content"]["parameters"]["velocity_along"] = 10.0
        cases.append(HardCase(
            f"{status.replace('_', ' ')}, mu = mu_c (1{offset:+g})", family,
            "the other side of tau = 0", status=(status,), **given,
        ))  # fmt: skip
    return cases


def _full_rebound() -> list[HardCase]:
    family = "restitution 0.999 and 1"
    drop = {"length": 0.02, "height": 0.01, "friction": 0.3, "gravity": G, "drop_height": 1e-3}
    first = math.sqrt(2 * 1e-3 / G)

    def falls(restitution: float, output: str, **more: float) -> Content:
        return {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
                "outputs": [output],
                "parameters": {**drop, "restitution": restitution, **more}}  # fmt: skip

    cases = [
        HardCase(
            "a part that bounces for ever", family, "no impact takes energy",
            falls(1.0, "impact_count", duration=200.5 * first), "impact_count",
            known(100.0, 0.0, "one impact each 2 sqrt(2 h/g)"), ("moving",),
        ),
        HardCase(
            "energy after 100 full rebounds", family, "roundings add up",
            falls(1.0, "specific_energy_lost", duration=200.5 * first), "specific_energy_lost",
            known(0.0, 100 * 8 * EPSILON * G * 1e-3, "none; 8 ulp an impact"), ("moving",),
        ),
        HardCase(
            "the last height at restitution 0.999", family, "a thousand rebounds to halve it",
            falls(0.999, "largest_bounce", duration=50.0 * first), "largest_bounce",
            known(0.999**2 * 1e-3, 64 * EPSILON * 1e-3, "eps^2 h; 64 ulp"), ("moving",),
        ),
    ]  # fmt: skip
    for restitution in (0.999, 1.0):
        cases.append(HardCase(
            f"motion, restitution {restitution:g}", family, "the motion does not repeat, and what "
            "it means over a run is chance; each hop is a parabola all the same",
            motion("events", "landing_speed", **hopping(2.0, restitution=restitution)),
            "landing_speed", _fall_of_the_highest_hop(hopping(2.0, restitution=restitution)),
            ("aperiodic",),
        ))  # fmt: skip
        cases.append(HardCase(
            f"motion in contact, restitution {restitution:g}", family,
            "nothing lands, so nothing rebounds", motion(**hopping(0.9, restitution=restitution)),
            "conveying_velocity", _by_reference(hopping(0.9)), ("periodic",), says=True,
        ))  # fmt: skip
    cases.append(HardCase(
        "motion, restitution 0.999, hops that die out", family, "8,000 impacts a period",
        motion(**hopping(1 + 1e-5, restitution=0.999)), "conveying_velocity",
        _by_reference(hopping(1 + 1e-5)), ("periodic",), says=True,
    ))  # fmt: skip
    cases.append(HardCase(
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
    cases.append(HardCase(
        "equal parts face to face", family, "two impulses at once, no loss",
        {**sweep("rectangle-pair-impact", "velocity_y_2_after", **collision),
         "variant": "frictionless"},
        "velocity_y_2_after", known(-1.0, 8 * EPSILON, "they change their velocities; 8 ulp"),
        ("impact",),
    ))  # fmt: skip
    return cases


def _fall_of_the_highest_hop(given: Content) -> Callable[[], Answer]:
    """Return what gives the largest landing speed, from how high above the floor the part came.

    The floor moves by +-a, so the apex of that hop is within H +- 2a of where the part lands, and
    the floor comes to meet it or flees at up to a w; no other hop falls further than H + 2a.
    """

    def answer() -> Answer:
        table = result_of(motion("events", "hop_height", **given)).variables
        height = float(table["hop_height"].values)
        a = given["amplitude"] * math.sin(math.radians(given["beta"]))
        least, most = (
            math.sqrt(2 * given["gravity"] * max(0.0, height + 2 * way * a)) + way * a * W
            for way in (-1, 1)
        )
        source = "free fall from the largest height H: sqrt(2 g (H +- 2a)) +- a w"
        return Answer((least + most) / 2, (most - least) / 2, source)

    return answer


def _by_reference(given: Content) -> Callable[[], Answer]:
    """Return what gives the mean without rebound, integrated at high order.

    Hops that die out while the part slides leave the mean as it is (theory 13.5).
    """

    def answer() -> Answer:
        table = result_of(motion("reference", **given)).variables
        value = float(table["conveying_velocity"].values)
        return Answer(value, 1e-9 * G / W, "restitution 0, reference method, to 1e-9 g/w")

    return answer


def _other_phase(given: Content) -> Callable[[], Answer]:
    """Return what gives the mean by time stepping, with its own spread."""

    def answer() -> Answer:
        content = motion("time-stepping", **given, steps_per_period=500)
        table = result_of(content).variables
        value, error = (
            float(table[name].values) for name in ("conveying_velocity", "conveying_velocity_error")
        )
        return Answer(value, error, "time stepping, another method, with its own error")

    return answer


def _chatter() -> list[HardCase]:
    family = "chatter"
    cases = []
    for restitution in (0.5, 0.9, 0.99, 0.999):
        height = 1e-5
        first = math.sqrt(2 * height / G)
        rest = first * (1 + restitution) / (1 - restitution)
        # Impacts end at 1e-6 of sqrt(g rho): what is left lasts 2 w/(g (1 - eps)).
        left = 2 * 1e-6 * math.sqrt(G * 0.0112) / (G * (1 - restitution))
        cases.append(HardCase(
            f"bounces to rest, restitution {restitution:g}", family,
            "infinitely many impacts in a finite time",
            {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
             "outputs": ["settling_time"],
             "parameters": {"length": 0.02, "height": 0.01, "friction": 0.3, "gravity": G,
                            "drop_height": height, "restitution": restitution,
                            "duration": 2 * rest}},
            "settling_time",
            known(rest, 1.5 * left + 1e-12 * rest, "t1 (1 + eps)/(1 - eps), less what falls below "
                  "the speed at which a run of hops ends; that speed is one of late landings too"),
            ("settled",),
        ))  # fmt: skip
    chatter = {"frequency": 60.0, "amplitude": 2e-4, "beta": 32.0, "friction": 0.4,
               "gravity": 9.8, "restitution": 0.2}  # fmt: skip
    cases.append(HardCase(
        "motion with shrinking hops", family, "infinitely many hops a period",
        motion(**chatter), "conveying_velocity",
        known(0.034566932320251, 1e-14, WORKED), ("periodic",), says=True,
    ))  # fmt: skip
    for restitution in (0.6, 0.8):
        cases.append(HardCase(
            f"motion, throw number 1.05, restitution {restitution:g}", family,
            "hops shrink slowly, to be cut off where they no longer count",
            motion(**hopping(1.05, restitution=restitution)), "conveying_velocity",
            _other_phase(hopping(1.05, restitution=restitution)),
            ("periodic", "aperiodic"), says=True,
        ))  # fmt: skip
    return cases


def _slow_and_fast_drives() -> list[HardCase]:
    family = "frequencies of 1e-3 and 1e5 Hz"
    cases = []
    for frequency in (1e-9, 1e-3, 1e5, 1e12):
        for throw, friction in ((0.9, 0.3), (1.5, 0.5), (3.5, 0.5)):
            base = motion(**hopping(throw, friction=friction))
            cases.append(HardCase(
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
        cases.append(HardCase(
            f"v(x), {frequency:g} Hz", family, "the drive is 4e-10 or 4e6 times the usual",
            **track("transport_velocity", forms.velocity_after, frequency=frequency, gamma=-1.0,
                    delta=-2.0),
        ))  # fmt: skip
    for frequency in (0.0, 1e-10, 1e13):
        cases.append(HardCase(
            f"motion, {frequency:g} Hz", family, "no period to take a mean over",
            motion(frequency=frequency, amplitude=1e-4, beta=30.0, friction=0.3),
            refused="parameters.frequency",
        ))  # fmt: skip
    return cases


def _subnormal_amplitudes() -> list[HardCase]:
    family = "subnormal amplitudes"
    cases = []
    for amplitude in (5e-324, 1e-310, 2.3e-308):
        given = {"frequency": 50.0, "amplitude": amplitude, "beta": 0.0}
        P = amplitude * (W * W)  # A0 w would be rounded to a multiple of 5e-324
        cases += [
            HardCase(
                f"drive, A0 = {amplitude:g} m", family, "fewer digits than usual",
                sweep("rectangle-on-plane", "vibration_acceleration", frequency=50.0,
                      amplitude=amplitude),
                "vibration_acceleration",
                known(P, 8 * EPSILON * P + 5e-324 * W,
                      "A0 w^2; 8 ulp, and the rounding of A0 w to a multiple of 5e-324, times w"),
            ),
            HardCase(
                f"v(x), A0 = {amplitude:g} m", family, "K underflows with mu",
                sweep("rectangle-on-track", "transport_velocity", **given, friction=0.3,
                      radius=0.3, distance=1e-3),
                "transport_velocity",
                # v^2 = 2 K x, and K has the relative error of a subnormal product.
                known(math.sqrt(2 * 1e-3) * math.sqrt(P) * math.sqrt(math.exp(-1e-3)),
                      math.sqrt(2e-3) * math.sqrt(P) * (1e-6 + 5e-324 / amplitude / W),
                      "sqrt(2 K x phi), phi = 1 - 1e-3 to 1e-6; A0 w is a multiple of 5e-324"),
                ("faster_than_track",),
            ),
            HardCase(
                f"motion, A0 = {amplitude:g} m", family, "every group is subnormal",
                motion(**given, friction=0.3), "conveying_velocity",
                known(0.0, 0.0, "held"), ("at_rest",),
            ),
            HardCase(
                f"motion without friction, A0 = {amplitude:g} m", family, "speeds below 1e-300",
                motion(**given, friction=0.0), "conveying_velocity",
                known(amplitude * W, 1e-4 * amplitude * W + 5e-322, "A0 w, of few digits"),
                ("neutral",),
            ),
        ]  # fmt: skip
    cases.append(HardCase(
        "efficiency of a part that slides down, A0 = 1e-310 m", family,
        "a speed over next to nothing",
        {**motion("time-stepping", "efficiency", frequency=50.0, amplitude=1e-310, beta=0.0,
                  friction=0.1, gamma=0.0, steps_per_period=100, most_periods=20), },
        "efficiency", known(0.0, 0.0, "held"), ("at_rest",),
    ))  # fmt: skip
    for amplitude in (0.0, 1e-320):
        cases.append(HardCase(
            f"efficiency of a part that creeps, A0 = {amplitude:g} m", family,
            "regularised friction lets it creep, at a speed over next to nothing",
            motion("regularised", "efficiency", frequency=50.0, amplitude=amplitude, beta=0.0,
                   gamma=3.0, gravity=G, friction=0.3),
            "efficiency", known(-math.inf, 0.0, "v < 0, beyond the floats"), ("periodic",),
        ))  # fmt: skip
    return cases


def _angles() -> list[HardCase]:
    family = "angles at and beyond their limits"
    P = 4e-4 * W * W
    cases = []
    for name, value, sign in (("beta", 90.0, 0.0), ("beta", 180.0, -1.0), ("beta", -90.0, 0.0),
                              ("alpha", 90.0, 0.0), ("alpha", 180.0, -1.0),
                              ("alpha", -180.0, -1.0)):  # fmt: skip
        given = {"frequency": 50.0, "amplitude": 4e-4, "alpha": 0.0, "beta": 0.0, name: value}
        cases.append(HardCase(
            f"drive along, {name} = {value:g}", family, "a cosine that is 0 is 6e-17 in floats",
            sweep("rectangle-on-plane", "drive_along", **given), "drive_along",
            known(sign * P, 8 * EPSILON * P, "exact angle; 8 ulp of the drive"),
        ))  # fmt: skip
    for gamma, status in ((90.0, "runaway"), (-90.0, "runaway")):
        cases.append(HardCase(
            f"motion, gamma = {gamma:g}", family, "a wall: nothing presses on it",
            motion(**{**DRIVE, "friction": 0.3, "gamma": gamma}), "conveying_velocity",
            known(math.nan, 0.0, "it falls"), (status,),
        ))  # fmt: skip
    cases.append(HardCase(
        "throw number, gamma = 90", family, "gravity onto the floor is 6e-17 g",
        sweep("rectangle-on-plane", "throw_number", **DRIVE, gravity=G, gamma=90.0),
        "throw_number",
        known(math.inf, 0.0, "nothing presses on an upright floor"), ("flight",),
    ))  # fmt: skip
    for beta, throw in ((1e-300, "at_rest"), (90.0, "periodic"), (180.0, "periodic")):
        cases.append(HardCase(
            f"motion, beta = {beta:g}", family, "the drive is all along or all normal",
            motion(frequency=50.0, amplitude=1.5e-4, beta=beta, friction=2.0 if throw == "at_rest"
                   else 0.3, gravity=G), "conveying_velocity",
            known(0.0, 1e-9 if beta == 180.0 else 1e-17, "symmetry"), (throw, "at_rest"),
        ))  # fmt: skip
    for name, value in (("beta", 180.0), ("alpha", 180.0), ("gamma", 90.0), ("delta", 90.0)):
        for sign in (1, -1):
            beyond = sign * np.nextafter(value, np.inf)
            given = {**TRACK, name: float(beyond)}
            cases.append(HardCase(
                f"{name} an ulp beyond {sign * value:g}", family, "just out of bounds",
                sweep("rectangle-on-track", "transport_velocity", **given),
                refused=f"parameters.{name}",
            ))  # fmt: skip
    cases.append(HardCase(
        "beta = 1e300", family, "far out of bounds", sweep(
            "rectangle-on-plane", "drive_along", **{**DRIVE, "beta": 1e300}),
        refused="parameters.beta",
    ))  # fmt: skip
    return cases


def _met_thresholds() -> list[HardCase]:
    family = "stick thresholds met with equality"
    P = 1e-4 * W * W
    level = {"frequency": 50.0, "amplitude": 1e-4, "beta": 0.0}
    slope = {**DRIVE, "gamma": 45.0, "friction": 1.0}
    cases = []
    for mu in (0.125, 0.5, 1.0, 2.0):
        for ulps in (-1, 0, 1):
            g = P / mu * (1 + ulps * EPSILON)  # a power of two: no rounding of mu g
            cases.append(HardCase(
                f"a_x, drive = mu g, mu = {mu:g}, {ulps:+d} ulp", family,
                "friction is as large as the drive", sweep(
                    "rectangle-on-plane", "acceleration_x", **level, friction=mu, gravity=g),
                "acceleration_x", known(0.0, 16 * EPSILON * P, "continuous: 0; 16 ulp of P"),
                ("stick", "slip"),
            ))  # fmt: skip
            # Slip lasts 2 sqrt(2 excess), and its speed is of the order of its cube.
            cases.append(HardCase(
                f"motion, drive = mu g, mu = {mu:g}, {ulps:+d} ulp", family,
                "it breaks loose for no time", motion(**level, friction=mu, gravity=g),
                "conveying_velocity",
                known(0.0, 1e-20 * P / W, "slip of a root of the rounding: its fourth power"),
                ("at_rest", "periodic"),
            ))  # fmt: skip
    cases.append(HardCase(
        "a_x, no drive on the slope of friction", family, "sin and cos of 45 degrees",
        sweep("rectangle-on-plane", "acceleration_x", frequency=50.0, amplitude=0.0, beta=0.0,
              gamma=45.0, friction=1.0),
        "acceleration_x", known(0.0, 8 * EPSILON * G, "tan(gamma) = mu; 8 ulp of g"),
        ("stick", "slip"),
    ))  # fmt: skip
    cases.append(HardCase(
        "motion on the slope of friction", family, "a part that slides downhill keeps its speed",
        motion(**slope), "conveying_velocity",
        known(math.nan, 0.0, "friction just balances gravity, theory 13.8"), ("limit_reached",),
    ))  # fmt: skip
    cases.append(HardCase(
        "motion 1e-9 degrees short of the slope of friction", family,
        "downhill it is slowed by 1e-11 of its weight",
        motion(**{**slope, "gamma": 45.0 - 1e-9}), "conveying_velocity", _by_reference(slope),
        ("periodic",), says=True,
    ))  # fmt: skip
    cases.append(HardCase(
        "no friction, no drive, level", family, "0 = 0",
        sweep("rectangle-on-plane", "acceleration_x", frequency=50.0, amplitude=0.0, beta=0.0,
              friction=0.0),
        "acceleration_x", known(0.0, 0.0, "nothing acts"), ("stick",),
    ))  # fmt: skip
    return cases


def _stiff_friction() -> list[HardCase]:
    family = "regularised friction down to 1e-12"
    slides = {"frequency": 60.0, "amplitude": 24e-6, "beta": 20.0, "gravity": 9.8,
              "friction_static": 0.35, "friction_kinetic": 0.25}  # fmt: skip
    exact_mean = known(4.3067566120832e-4, 1e-16, WORKED)
    soft = "friction so soft takes a third off the mean, and the estimate is 4 times that"
    cases = [HardCase(
        "regularised as regularised-BDF, slip speed 0.001", family,
        "a mean that is far from that of Coulomb's law",
        motion("regularised", **slides, slip_speed=1e-3, tolerance=1e-6), "conveying_velocity",
        from_study(motion("regularised-BDF", **slides, slip_speed=1e-3, tolerance=1e-6),
                   "conveying_velocity", 1e-4, "another integrator; a hundred steps a period, each "
                   "to 1e-6"),
        ("periodic",), blunt=soft,
    )]  # fmt: skip
    for slip in (1e-3, 1e-6, 1e-9, 1e-12):
        for solver in ("regularised", "regularised-BDF"):
            cases.append(HardCase(
                f"{solver}, slip speed {slip:g}", family, "decay rates of 1 over the slip speed",
                motion(solver, **slides, slip_speed=slip, tolerance=min(1e-6, slip / 10)
                       if slip >= 1e-6 else 1e-7),
                "conveying_velocity", exact_mean, ("periodic",), says=True,
                blunt=soft if slip == 1e-3 else "",
            ))  # fmt: skip
    cases.append(HardCase(
        "an explicit integrator crawls", family, "its steps are bound by stability",
        {}, attempt=_explicit_crawls,
    ))  # fmt: skip
    cases.append(HardCase(
        "slip speed 1e-13", family, "just out of bounds",
        motion("regularised", **slides, slip_speed=1e-13), refused="slip_speed",
    ))  # fmt: skip
    return cases


def _explicit_crawls() -> tuple[float, float, str]:
    """Return how far RK45 falls short of needing 1,000 times Radau's evaluations a period."""
    from scipy.integrate import solve_ivp

    from core.motion.methods.regularised.laws import Cell, laws

    slip, span = 1e-9, 1e-5
    drive = 24e-6 * (2 * math.pi * 60) ** 2 / 9.8
    angle = math.radians(20)
    cell = Cell(laws(0.25, 0.35, 0.0, slip, 1e4), (drive * math.cos(angle),
                drive * math.sin(angle)), (0.0, 1.0))  # fmt: skip
    settings = {"rtol": 1e-6, "atol": 1e-6 * np.array([1, 1e-4, slip, 1])}
    explicit = solve_ivp(cell.rate, (0, span), cell.rest(), "RK45", **settings).nfev
    whole = (0, 2 * math.pi)
    implicit = solve_ivp(cell.rate, whole, cell.rest(), "Radau", jac=cell.jacobian, **settings)
    ratio = explicit * 2 * math.pi / span / implicit.nfev
    note = f"RK45 needs {ratio:.3g} times the evaluations of Radau at a slip speed of 1e-9"
    return max(0.0, 1000 - ratio), 0.0, note


def _stiff_floor() -> list[HardCase]:
    family = "contact stiffness to 1e14"
    hop = {"frequency": 60.0, "amplitude": 4e-4, "beta": 25.0, "gravity": 9.8, "friction": 0.4}
    cases = [
        HardCase(
            f"regularised, stiffness {stiffness:g}", family, "an impact lasts 1e-7 of a period",
            motion("regularised", **hop, contact_stiffness=stiffness, slip_speed=1e-4),
            "conveying_velocity", known(0.12799649244377, 1e-14, WORKED),
            ("periodic",), says=True,
        )
        for stiffness in (1e6, 1e10, 1e14)
    ]  # fmt: skip
    cases.append(HardCase(
        "stiffness 1e17", family, "just out of bounds",
        motion("regularised", **hop, contact_stiffness=1e17), refused="contact_stiffness",
    ))  # fmt: skip
    return cases


def _masses_and_sizes() -> list[HardCase]:
    family = "masses and sizes over twelve decades"
    cases = []
    for mass in (1e-9, 1e-3, 1e3):
        given = {**DRIVE, "mass": mass, "gravity": G}
        P = 4e-4 * W * W * math.sin(math.radians(20))
        cases.append(HardCase(
            f"floor force of {mass:g} kg", family, "forces from 1e-8 N to 1e4 N",
            sweep("rectangle-on-plane", "floor_force", **{**given, "amplitude": 1e-5}),
            "floor_force", known(mass * (G - P / 40), 16 * EPSILON * mass * G,
                                 "m (g - P sin(beta)); 16 ulp"),
        ))  # fmt: skip
    for small, large in ((1e-9, 1e3), (1e3, 1e-9), (1e-9, 1e-9)):
        for size in (1e-6, 1.0, 1e6):
            given = {
                "position_x_1": 0.0, "position_y_1": size, "angle_1": 0.0, "velocity_x_1": 0.0,
                "velocity_y_1": -1.0, "spin_1": 0.0, "length_1": 2 * size, "width_1": size,
                "mass_1": small, "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.0,
                "velocity_x_2": 0.0, "velocity_y_2": 0.0, "spin_2": 0.0, "length_2": 2 * size,
                "width_2": size, "mass_2": large, "restitution": 0.5,
            }  # fmt: skip
            after = -1.0 + 1.5 * large / (small + large)
            cases.append(HardCase(
                f"impact of {small:g} kg on {large:g} kg, {size:g} m", family,
                "two Delassus numbers that differ by 1e12",
                {**sweep("rectangle-pair-impact", "velocity_y_1_after", **given),
                 "variant": "frictionless"},
                "velocity_y_1_after",
                known(after, 64 * EPSILON, "central impact; 64 ulp of the velocity"), ("impact",),
            ))  # fmt: skip
    oblique = {
        "angle_1": 20.0, "velocity_x_1": 0.3, "velocity_y_1": -1.0, "spin_1": 0.0, "angle_2": 0.0,
        "velocity_x_2": 0.0, "velocity_y_2": 0.0, "spin_2": 0.0, "friction": 0.3,
        "restitution": 0.5, "contact_tolerance": 1e-6, "position_x_2": 0.0, "position_y_2": 0.0,
    }  # fmt: skip

    def scaled(size: float, mass: float) -> Content:
        turn = math.radians(20.0)
        rise = size * (math.sin(turn) + 0.5 * math.cos(turn)) + 0.5 * size
        lengths = {"position_x_1": 0.1 * size, "position_y_1": rise, "length_1": 2 * size,
                   "width_1": size, "length_2": 4 * size, "width_2": size}  # fmt: skip
        return {**sweep("rectangle-pair-impact", "velocity_y_1_after", **oblique, **lengths,
                        mass_1=mass, mass_2=2 * mass), "variant": "pfeiffer_glocker"}  # fmt: skip

    for size, mass in ((1e-6, 1e-9), (1e6, 1e3), (1e-6, 1e3), (1e6, 1e-9)):
        cases.append(HardCase(
            f"oblique impact, {size:g} m, {mass:g} kg", family,
            "velocities do not depend on either",
            scaled(size, mass), "velocity_y_1_after",
            from_study(scaled(1.0, 1.0), "velocity_y_1_after", 1e-12,
                       "the same at 1 m, 1 kg; roundings of the placement, 1e-16, over 1e-4"),
            ("impact_slip", "impact_stick"),
        ))  # fmt: skip
    for size in (1e-6, 1e6):
        # Times grow as the root of the size.
        def falls(size: float) -> Content:
            return {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
                    "outputs": ["settling_time"],
                    "parameters": {"length": 2 * size, "height": size, "friction": 0.4,
                                   "restitution": 0.3, "drop_height": size, "pitch": 20.0,
                                   "gravity": G, "duration": 20 * math.sqrt(size)}}  # fmt: skip

        cases.append(HardCase(
            f"tumbling, {size:g} m", family, "times from 1e-3 s to 1e3 s",
            falls(size), "settling_time",
            from_study(falls(1.0), "settling_time", 1e-9, "the same at 1 m: times grow as the "
                       "root of the size; a dozen impacts amplify roundings", math.sqrt(size)),
            ("settled",),
        ))  # fmt: skip
    return cases


def _grids() -> list[HardCase]:
    family = "grids: one point, 10^7 on an axis, repeated values"
    given = {**DRIVE, "amplitude": 5e-5, "gravity": G}
    one = {name: [value] for name, value in given.items()}
    long_axis = {"start": 1.0, "stop": 100.0, "num": 10_000_000}

    def throws() -> Answer:
        frequencies = np.linspace(1.0, 100.0, 10_000_000)
        scale = 5e-5 * 4 * math.pi**2 * math.sin(math.radians(20)) / G
        values = scale * frequencies**2
        return Answer(values, 16 * EPSILON * values, "C f^2; 16 ulp")

    quarters = hopping(0.88)

    def equal() -> Answer:
        # A0 w^2 is that of (50 Hz, A0) and (100 Hz, A0/4): one motion, at half the speed.
        once = _by_reference(quarters)()
        hops = exact(forms.hop_after_hop, frequency=100.0, beta=30.0, gamma=0.0, gravity=G)()
        value = np.array([[0.0, once.value], [once.value / 2, hops.value]])
        error = np.array([[0.0, once.error], [once.error / 2, hops.error]])
        return Answer(value, error, "held, reference method, half of it, hop after hop")

    return [
        HardCase(
            "every axis of one value", family, "axes that are none",
            sweep("rectangle-on-plane", "throw_number", **one), "throw_number",
            exact(forms.throw_number, **given),
        ),
        HardCase(
            "10^7 values on one axis", family, "no list of cells may be made",
            sweep("rectangle-on-plane", "throw_number", **{**given, "frequency": long_axis}),
            "throw_number", throws,
        ),
        HardCase(
            "a value that stands twice", family, "a label that names two cells",
            sweep("rectangle-on-plane", "throw_number", **{**given, "frequency": [50, 50, 60]}),
            refused="parameters.frequency",
        ),
        HardCase(
            "a range from a value to itself", family, "a range of no length",
            sweep("rectangle-on-plane", "throw_number",
                  **{**given, "frequency": {"start": 50, "stop": 50, "num": 3}}),
            refused="parameters.frequency",
        ),
        HardCase(
            "values an ulp apart", family, "two labels that print alike",
            sweep("rectangle-on-plane", "throw_number",
                  **{**given, "frequency": [50.0, float(np.nextafter(50.0, 60.0))]}),
            "throw_number", lambda: Answer(
                np.full(2, exact(forms.throw_number, **given)().value),
                np.full(2, 2 * exact(forms.throw_number, **given)().error),
                "the first, and 2 ulp"),
        ),
        HardCase(
            "more values than an axis holds", family, "memory",
            sweep("rectangle-on-plane", "throw_number",
                  **{**given, "frequency": {"start": 1, "stop": 2, "num": 10**9}}),
            refused="parameters.frequency",
        ),
        HardCase(
            "equal cells of motion", family, "computed once, given twice",
            motion(**{**quarters, "frequency": [50.0, 100.0],
                      "amplitude": [quarters["amplitude"] / 4, quarters["amplitude"]]}),
            "conveying_velocity", equal, ("at_rest", "periodic"), says=True,
        ),
    ]  # fmt: skip


HARD_CASES: tuple[HardCase, ...] = (
    *_little_and_much_friction(),
    *_large_and_small_bowls(),
    *_start_within_ulps(),
    *_long_and_short_ways(),
    *_regime_borders(),
    *_painleve(),
    *_full_rebound(),
    *_chatter(),
    *_slow_and_fast_drives(),
    *_subnormal_amplitudes(),
    *_angles(),
    *_met_thresholds(),
    *_stiff_friction(),
    *_stiff_floor(),
    *_masses_and_sizes(),
    *_grids(),
)
"""Every hard case; names are unique."""
