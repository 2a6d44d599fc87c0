"""The form of hard cases: studies by their numbers, and truths from elsewhere."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Term, Truth
from vibrafeed.core.assurance.judge import results_of
from vibrafeed.core.assurance.textbook import exact

Content = dict[str, Any]

DRIVE = {"frequency": 50.0, "amplitude": 4e-4, "beta": 20.0}
# The part stays on floor and wall.
TRACK = {**DRIVE, "amplitude": 5e-5, "alpha": 1.0, "gamma": 1.0, "delta": 5.0, "gravity": 9.80665,
         "friction": 0.3, "radius": 0.3, "distance": 1e-5}  # fmt: skip
K_INPUTS = ("frequency", "amplitude", "alpha", "beta", "gamma", "delta", "gravity", "friction")
G = 9.80665
W = 2 * math.pi * 50
WORKED = "worked value, 14 digits (core/assurance/worked/values.toml)"


def hard_case(
    name: str,
    family: str,
    why: str,
    content: Content,
    output: str = "",
    known: Truth | Callable[[], Truth] | None = None,
    status: tuple[str, ...] = (),
    **more: Any,
) -> Case:
    """Return a hard case: a study at the limits of numbers or methods, judged by one output.

    Parameters
    ----------
    name, family, why : str
        What it is called, what it is hard for, and why.
    content, output : mapping, str
        The content of the study, and the output that is judged.
    known : Truth or callable, optional
        The right value with its tolerance, or a function that computes it; None to judge the
        status.
    status : tuple of str
        Statuses or regimes that are right; any if empty.
    **more
        Further fields of `Case`.
    """
    return Case(name, family, why, (Term(content, output),), known, status=status, **more)


def sweep(scene: str, output: str, **parameters: Any) -> Content:
    """Return a sweep with one output."""
    return {"kind": "sweep", "scene": scene, "outputs": [output], "parameters": parameters}


def track(output: str, formula: textbook.Formula, **changes: float) -> dict[str, Any]:
    """Return study, output and truth of a closed form on the track, as keywords of `hard_case`.

    `formula` gives the true value from the parameters, which are those of `TRACK` with `changes`,
    in the units of studies. A `time` among the changes takes the place of the distance.
    """
    parameters = {**TRACK, **changes}
    if "time" in parameters:
        del parameters["distance"]
    return {
        "content": sweep("rectangle-on-track", output, **parameters),
        "output": output,
        "known": exact(formula, **parameters),
    }


def plane(
    output: str, formula: textbook.Formula | None = None, **parameters: float
) -> dict[str, Any]:
    """Return study, output and truth of a closed form on a plane, as keywords of `hard_case`.

    `formula` gives the true value from all `parameters`, in the units of studies; without it there
    is no truth.
    """
    content = sweep("rectangle-on-plane", output, **parameters)
    return {
        "content": content,
        "output": output,
        "known": exact(formula, **parameters) if formula else None,
    }


def corner(output: str, formula: textbook.Formula, **changes: float) -> dict[str, Any]:
    """Return study, output and truth of a corner slipping right, as keywords of `hard_case`.

    `formula` gives the true value from the parameters: a part of 20 x 30 mm at 5 degrees, turning
    at 2 rad/s, with `changes` in the units of studies.
    """
    parameters = {"height": 0.03, "length": 0.02, "pitch": 5.0, "pitch_rate": 2.0, "gravity": G}
    parameters |= changes
    if output == "normal_response_right":
        del parameters["pitch_rate"], parameters["gravity"]
        content = sweep("rectangle-isolated", output, **parameters)
    else:
        content = sweep("rectangle-isolated", output, **parameters, velocity_along=1.0)
    return {"content": content, "output": output, "known": exact(formula, **parameters)}


def motion(
    method: str = "events", output: str = "conveying_velocity", /, **parameters: Any
) -> Content:
    """Return the content of a study that simulates a block on a plane, with one output.

    `method` is that of simulation. Settings of the method, such as `tolerance`, are taken from
    among `parameters`; the others are parameters in the units of studies. The error of the mean
    velocity is an output besides.
    """
    settings: Content = {
        name: parameters.pop(name)
        for name in ("slip_speed", "contact_stiffness", "tolerance", "max_periods",
                     "steps_per_period")
        if name in parameters
    }  # fmt: skip
    outputs = list(dict.fromkeys((output, "conveying_velocity_error")))
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "method": method, "outputs": outputs,
        **settings, "parameters": parameters,
    }  # fmt: skip


def hopping(throw: float, **changes: Any) -> dict[str, Any]:
    """Return the parameters of a drive that reaches a throw number, with the amplitude for it.

    The drive has 50 Hz and 30 degrees, friction 0.5, unless `changes` say otherwise. The amplitude
    is A0 = `throw` g cos(gamma)/(w^2 sin(beta)) [m]; all are in the units of studies.
    """
    parameters = {"frequency": 50.0, "beta": 30.0, "gravity": G, "friction": 0.5} | changes
    w, beta = 2 * math.pi * parameters["frequency"], math.radians(parameters["beta"])
    gamma = math.radians(parameters.get("gamma", 0.0))
    amplitude = throw * parameters["gravity"] * math.cos(gamma) / (w * w * math.sin(beta))
    return {**parameters, "amplitude": amplitude}


def from_study(
    content: Content, output: str, relative: float, source: str, factor: float = 1.0
) -> Callable[[], Truth]:
    """Return a function that computes a true value by another study, known to be right.

    Parameters
    ----------
    content, output : mapping, str
        The other study, and the output with a single value.
    relative : float
        Tolerance, as a share of the value.
    source : str
        Why the value is right.
    factor : float
        By which the output is multiplied.
    """

    def truth() -> Truth:
        """Return the other study's output times the factor."""
        value = factor * float(results_of(content).variables[output].values)
        return Truth(value, relative * abs(value), source)

    return truth


def near(truth: Callable[[], Truth], relative: float) -> Callable[[], Truth]:
    """Return a function for a value that the case only approaches: the limit with a tolerance.

    `truth` computes the limit, and `relative` is the tolerance as a share of it.
    """

    def near() -> Truth:
        """Return the limiting value with its relative error."""
        value = truth().value
        return Truth(value, relative * abs(value), "closed form of the limit that it is near")

    return near


def by_reference(parameters: Content) -> Callable[[], Truth]:
    """Return a function for the true mean velocity [m/s]: without rebound, reference method.

    `parameters` are those of the study. It is the truth also for rebounds that die out while the
    part slides: they leave the mean as it is (theory 13.5).
    """

    def truth() -> Truth:
        """Return the mean velocity by the reference method."""
        table = results_of(motion("reference", **parameters)).variables
        value = float(table["conveying_velocity"].values)
        return Truth(value, 1e-9 * G / W, "restitution 0, reference method, to 1e-9 g/w")

    return truth
