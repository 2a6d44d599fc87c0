"""The processes that the service offers: one for each kind of study, and the accuracy of any."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, Field, RootModel

from core.errors import Problem, StudyError
from core.study import (
    CalibrateStudy,
    OptimiseStudy,
    SensitivityStudy,
    SimulateStudy,
    SweepStudy,
)

ACCURACY = "accuracy"


Measured = SweepStudy | SimulateStudy | OptimiseStudy


class AnyStudy(RootModel[Annotated[Measured, Field(discriminator="kind")]]):
    """A study of any kind whose accuracy can be measured."""


@dataclass(frozen=True)
class Process:
    """What the service carries out.

    Attributes
    ----------
    title, description : str
        What a list shows.
    study : type
        The model of its studies.
    example : mapping
        A short study.
    """

    title: str
    description: str
    study: type[BaseModel]
    example: Mapping[str, Any]


SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {
        "frequency": "50 Hz",
        "amplitude": ["0.5 mm", "1 mm"],
        "beta": {"start": 0, "stop": 60, "num": 7},
    },
}

PROCESSES: dict[str, Process] = {
    "sweep": Process(
        "Sweep closed-form equations",
        "Evaluates the closed-form equations of a scene over a grid of parameters.",
        SweepStudy,
        SWEEP,
    ),
    "simulate": Process(
        "Simulate the motion in time",
        "Follows parts in time, with stick, slide and hop, over a grid of parameters.",
        SimulateStudy,
        {
            "kind": "simulate",
            "scene": "rectangle-on-plane",
            "parameters": {
                "frequency": "50 Hz",
                "amplitude": "0.5 mm",
                "beta": 30,
                "friction": [0.2, 0.4],
            },
        },
    ),
    "optimise": Process(
        "Find the best drive",
        "Finds the best angles, or other parameters, of a drive for each of many designs.",
        OptimiseStudy,
        {
            "kind": "optimise",
            "scene": "rectangle-on-plane",
            "criterion": {"kind": "maximise", "output": "acceleration_x"},
            "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "friction": 0.3},
        },
    ),
    "sensitivity": Process(
        "Tell what uncertain parameters do",
        "Tells how outputs vary with parameters that are not known exactly: probabilities, "
        "quantiles, Sobol indices, tolerance budgets, for each of many designs.",
        SensitivityStudy,
        {
            "kind": "sensitivity",
            "scene": "rectangle-on-plane",
            "outputs": ["acceleration_x"],
            "uncertain": {"friction": {"mean": 0.3, "deviation": 0.03}},
            "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "beta": 30},
        },
    ),
    "calibrate": Process(
        "Find parameters from measured speeds",
        "Finds what measured speeds, or what was seen of parts, tell of friction and other "
        "parameters that nobody knows, and which run would tell most.",
        CalibrateStudy,
        {
            "kind": "calibrate",
            "scene": "rectangle-on-plane",
            "parameters": {"frequency": "50 Hz", "beta": 20},
            "observations": [
                {"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "1 mm/s"},
                {"amplitude": "0.3 mm", "conveying_velocity": "33 mm/s", "error": "1 mm/s"},
            ],
            "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
            "points": 1_000,
        },
    ),
    ACCURACY: Process(
        "Measure error against run time",
        "Measures for a study of any kind what each method costs and how wrong it is; takes up to "
        "some minutes, and is always a job.",
        AnyStudy,
        SWEEP,
    ),
}
"""Every process, by its identifier."""


@dataclass(frozen=True)
class Execution:
    """What an execute request asks for.

    Attributes
    ----------
    study : object
        What is to be the study.
    as_document : bool
        The reply is to name the output, as in ``{"dataset": {"value": ...}}``.
    """

    study: object
    as_document: bool


def read_execution(content: object, kind: str) -> Execution:
    """Return what the body of an execute request asks for.

    The body is the study itself, or an execute request with the study under ``inputs.study``. It
    is of the kind of the process whether it says so or not.

    Raises
    ------
    StudyError
        If it has no study, or one of another kind, or asks for what there is not.
    """
    as_document = False
    if isinstance(content, Mapping) and "inputs" in content:
        as_document = _read_wishes(content)
        inputs = content["inputs"]
        study = inputs.get("study") if isinstance(inputs, Mapping) else None
        if isinstance(study, Mapping) and set(study) <= {"value", "mediaType"}:
            study = study.get("value")
        if not isinstance(study, Mapping):
            fix = 'Send {"inputs": {"study": {...}}}'
            raise StudyError([Problem("inputs.study", "there is no study", fix)])
        content = study
    if not isinstance(content, Mapping):
        return Execution(content, as_document)
    if kind == ACCURACY:
        return Execution(content, as_document)
    named = content.get("kind", kind)
    if named != kind:
        problem = Problem(
            "kind", f"this process carries out kind '{kind}', not {str(named)[:60]!r}", "Fix kind"
        )
        raise StudyError([problem])
    return Execution({"kind": kind, **content}, as_document)


def _read_wishes(content: Mapping[str, Any]) -> bool:
    """Return whether the reply is to be a document; raise `StudyError` for other outputs."""
    problems = []
    response = content.get("response", "raw")
    if response not in ("raw", "document"):
        message = f"{str(response)[:60]!r} is not a form of reply"
        problems.append(Problem("response", message, "Write 'raw' or 'document'"))
    outputs = content.get("outputs") or {}
    if not isinstance(outputs, Mapping):
        problems.append(Problem("outputs", "it is not an object", "Leave it out"))
    else:
        problems += [
            Problem(f"outputs.{str(name)[:60]}", "there is no such output", "The output is dataset")
            for name in outputs
            if name != "dataset"
        ]
    if problems:
        raise StudyError(problems)
    return response == "document"
