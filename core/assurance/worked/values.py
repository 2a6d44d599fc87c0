"""V, F and H: problems whose numbers stand elsewhere: worked values, the thesis, hard cases."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

from vibrafeed.core.assurance.case import Case, Term, Truth
from vibrafeed.core.assurance.hard_cases import HARD_CASES
from vibrafeed.core.quantities import QUANTITIES

WORKED_GRAVITY, SPEED_GRAVITY = 9.8, 9.81  # m s-2, of the tables
EXACT = 1e-13
"""Of a value that is given to the digits of a float."""

INPUTS = ("frequency", "amplitude", "beta", "gamma", "friction_static", "friction_kinetic",
          "restitution")  # fmt: skip


@cache
def worked_values() -> Mapping[str, Any]:
    """Return the tables of worked values."""
    text = (files("vibrafeed.core.assurance.worked") / "values.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def _motion(output: str, parameters: Mapping[str, Any]) -> Term:
    """Return a term of an answer: one output of a simulated part on a plane.

    `parameters` are those of the study, in its units.
    """
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": [output],
             "parameters": parameters}  # fmt: skip
    return Term(study, output)


def _sweep(scene: str, output: str, parameters: Mapping[str, Any], pick: str = "value",
           variant: str = "derived") -> Term:  # fmt: skip
    """Return a term of an answer: one output of a sweep of closed forms.

    Parameters
    ----------
    scene, output, variant : str
        As in the study.
    parameters : mapping
        Values or ranges, in the units of studies.
    pick : str
        What is taken of several cells: their `value`, or the `least` or `largest`.
    """
    study = {"kind": "sweep", "scene": scene, "variant": variant, "outputs": [output],
             "parameters": parameters}  # fmt: skip
    return Term(study, output, pick)


def _case(
    name: str,
    title: str,
    source: str,
    terms: tuple[Term, ...],
    value: float,
    *,
    tolerance: float | None = None,
    why: str = "13 digits: rounding of both",
    **more: Any,
) -> Case:
    """Return a validation case of one number, by default with a tolerance of 13 digits.

    Parameters
    ----------
    name, title, source : str
        Its id, whose first letter is the family, what it is, and where the number is from.
    terms : tuple of Term
        The studies that compute it.
    value : float
        The right value, in the unit of the first output or in `more["unit"]`.
    tolerance, why : float, str
        The largest error that is right, and why it is so large.
    **more
        Further fields of `Case`.
    """
    allowed = EXACT * abs(value) if tolerance is None else tolerance
    unit = more.pop("unit", QUANTITIES[terms[0].output].unit)
    known = Truth(value, allowed, source)
    return Case(name, name[0], title, terms, known, unit=unit, why=why, **more)


# --- worked values


def mean_velocities() -> Iterator[Case]:
    """Yield a case for each tabulated mean velocity, computed independently of this program.

    Rows of the table have drive, friction and restitution of a part on a plane, and the velocity
    [m/s].
    """
    for number, row in enumerate(worked_values()["mean_velocities"], 1):
        parameters = {name: row[name] for name in INPUTS} | {"gravity": WORKED_GRAVITY}
        rebounds = row["restitution"] > 0
        yield _case(
            f"V-mean-velocity-{number}",
            f"{row['name']}: mean velocity of a part that starts at rest",
            row["source"],
            (_motion("conveying_velocity", parameters),),
            row["value"],
            tolerance=(1e-10 if rebounds else EXACT) * row["value"],
            why="a run of ever smaller hops is cut short" if rebounds else "13 digits: rounding",
        )


def reference_speeds() -> Iterator[Case]:
    """Yield a case for each tabulated mean velocity over throw number and restitution [mm/s].

    The amplitude of the drive follows from the throw number Gamma: A0 = Gamma g cos(gamma)/(w^2
    sin(beta)).
    """
    number = 0
    for row in worked_values()["reference_speeds"]:
        w, beta = 2 * math.pi * row["frequency"], math.radians(row["beta"])
        push = row["throw_number"] * SPEED_GRAVITY * math.cos(math.radians(row["gamma"]))
        for restitution in row["restitutions"]:
            number += 1
            parameters = {
                "frequency": row["frequency"], "beta": row["beta"], "gamma": row["gamma"],
                "friction": row["friction"], "restitution": restitution,
                "amplitude": push / (w * w * math.sin(beta)), "gravity": SPEED_GRAVITY,
            }  # fmt: skip
            term = _motion("conveying_velocity", parameters)
            yield _case(
                f"V-speed-{number}",
                f"{row['name']}: throw number {row['throw_number']:g}, restitution {restitution:g}",
                row["source"],
                (Term(term.study, term.output, times=1e3),),
                row["value"],
                unit="mm/s",
                tolerance=5e-7,
                why="half a unit of the last digit",
                digits=f"{row['value']:.6f}",
            )


def hops() -> Iterator[Case]:
    """Yield two cases for each tabulated throw number: length of a hop and speed of landing.

    The track is level and the part does not rebound; the length is in rad of the drive, the speed
    in g/w.
    """
    frequency, beta = 50.0, math.radians(30.0)
    w = 2 * math.pi * frequency
    for number, row in enumerate(worked_values()["hops"], 1):
        amplitude = row["throw_number"] * WORKED_GRAVITY / (w * w * math.sin(beta))
        parameters = {"frequency": frequency, "beta": 30.0, "friction": 0.5, "amplitude": amplitude,
                 "gravity": WORKED_GRAVITY}  # fmt: skip
        flight, landing = (
            _motion(name, parameters) for name in ("flight_fraction", "landing_speed")
        )
        for name, term, what in (
            ("length", Term(flight.study, flight.output, times=2 * math.pi), "length of the hop"),
            ("landing_speed", Term(landing.study, landing.output, times=w / WORKED_GRAVITY),
             "speed of landing"),
        ):  # fmt: skip
            yield _case(
                f"V-hop-{name.replace('_', '-')}-{number}",
                f"Throw number {row['throw_number']:g}: {what}",
                row["source"],
                (term,),
                row[name],
                unit="rad" if name == "length" else "g/w",
                tolerance=1e-11,
                why="twelve digits, and the condition of throw number 1.2",
            )


def closed_forms() -> Iterator[Case]:
    """Yield a case for each tabulated output of closed forms, as printed or corrected."""
    for number, row in enumerate(worked_values()["closed_forms"], 1):
        few = row.get("half_unit")
        term = _sweep(row["scene"], row["output"], row["given"], variant=row["variant"])
        yield _case(
            f"V-closed-form-{number}",
            f"{row['output']} of {row['scene']}, variant {row['variant']}",
            row["source"],
            (term,),
            row["value"],
            **({"tolerance": few, "why": "half a unit of the last digit"} if few else {}),
        )


# --- the thesis


def limiting_friction() -> Iterator[Case]:
    """Yield cases of the friction up to which a corner's contact force is unique (Painleve).

    They are two worked values (family V), and what figures 3.3 and 3.15 of the thesis are said to
    show (family F).
    """
    worked = {row["name"]: row for row in worked_values()["limiting_friction"]}
    square = {"height": 0.01, "length": 0.01}
    half = {"why": "half a unit of the last digit"}
    row = worked["rectangle"]
    yield _case(
        "V-limiting-friction-1", "Limiting friction of a rectangle at a corner angle of 60 degrees",
        row["source"],
        (_sweep("rectangle-isolated", "limiting_friction_right", {**square, "pitch": 15}),),
        row["value"], tolerance=row["half_unit"], **half,
    )  # fmt: skip
    row = worked["least of a cylinder"]
    yield _case(
        "V-limiting-friction-2", "Least limiting friction of a cylinder, diameter over length 2",
        row["source"],
        (_sweep("cylinder-isolated", "least_limiting_friction",
                {"diameter": 0.02, "length": 0.01}),),
        row["value"], tolerance=row["half_unit"], **half,
    )  # fmt: skip
    turned = {"pitch": {"start": "0 deg", "stop": "80 deg", "num": 161}}
    lengths = ["2.5 mm", "5 mm", "10 mm", "20 mm", "40 mm"]
    yield _case(
        "F-3.3-1", "Figure 3.3: the contact of a rectangle is unique below 4/3, whatever its shape",
        "J. Díaz González, 2004, figure 3.3",
        (_sweep("rectangle-isolated", "limiting_friction_right",
                {"height": "10 mm", "length": lengths, **turned}, "least", "thesis"),),
        4 / 3, evidence="thesis figure", relation="at least", tolerance=1e-12,
        why="rounding; the bound is 2 sqrt(1 + k)/k with k = 3",
    )  # fmt: skip
    for number, (ratio, expected, words) in enumerate(
        (
            (1.29846, 1.2, "unique below 1.2, which holds up to a diameter of 1.29846 lengths"),
            (1e9, math.sqrt(5) / 2, "of a thin disc the bound is lower, sqrt(5)/2 = 1.118"),
            (1e-9, 4 / 3, "of a needle it is higher, 4/3"),
        ),
        1,
    ):
        yield _case(
            f"F-3.15-{number}", f"Figure 3.15: the contact of a cylinder is {words}"
            if number == 1 else f"Figure 3.15: {words}",
            "J. Díaz González, 2004, figure 3.15" if number == 1 else "derived by us, theory 2.5",
            (_sweep("cylinder-isolated", "least_limiting_friction",
                    {"diameter": ratio, "length": 1.0}),),
            expected, evidence="thesis figure" if number == 1 else "derived",
            tolerance=5e-7 if number == 1 else 1e-12,
            why="half a unit of the last digit of the diameter" if number == 1 else "rounding",
        )  # fmt: skip


# --- hard cases


@cache
def hard_cases() -> tuple[Case, ...]:
    """Return the hard cases with closed-form values; computing them takes a second."""
    members = map(of_hard_case, HARD_CASES)
    return tuple(case for case in members if case is not None)


def of_hard_case(case: Case) -> Case | None:
    """Return a hard case as a validation case of family H; None if it is not one number.

    Left out are cases that are judged by status, over an axis of values, against the error that a
    method states, or by stiff integrators: another program could not answer them.
    """
    if case.known is None or case.compute or case.states_error:
        return None
    study = case.terms[0].study
    if any(isinstance(value, list | tuple | dict) for value in study["parameters"].values()):
        return None  # an axis
    if "slip_speed" in study or "contact_stiffness" in study:
        return None  # what a stiff integrator gives is within its own error
    value, tolerance, source = case.right
    if not isinstance(value, float | int) or not math.isfinite(value + tolerance):
        return None
    return replace(
        case,
        id=f"H-{'-'.join(re.findall('[a-z0-9.+-]+', case.id.lower()))}",
        family="H",
        title=f"{case.id}: {case.title}",
        known=Truth(float(value), float(tolerance), source),
        unit=QUANTITIES[case.terms[0].output].unit,
        why="what one rounding of each input does, times 8, unless the source says otherwise",
    )
