"""The nearest approach to limits that no choice keeps together, and changes that would keep them.

Each bound in turn becomes what is looked for, while the others are kept: that tells how far the
output goes, and so which limit would have to give way. Then the same limits with a wider choice.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.optimise.run import KIND
from vibrafeed.core.plan.pieces import carry_out
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.study.optimise_study import Maximise, Minimise, OptimiseStudy, OutputLimit
from vibrafeed.core.study.values import Between, Fixed

Section = TypeVar("Section", bound=BaseModel)

SOLVED = (STATUS["optimal"], STATUS["not_attained"])


@dataclass(frozen=True)
class Reach:
    """The nearest that an output comes to its bound while all other limits are kept.

    Attributes
    ----------
    output : str
        The output.
    bound, value : float
        What is asked, and the nearest that there is, in the unit of the quantity.
    upper : bool
        Whether the bound is the largest value; else the least.
    choice : dict of str to float
        The variables there, in the unit of the quantity.
    """

    output: str
    bound: float
    value: float
    upper: bool
    choice: dict[str, float]


Bound = tuple[OutputLimit, str]
"""A limit, and which of its ends."""


def nearest(study: Study) -> list[Reach]:
    """Return the nearest approach to each bound of an optimisation that cannot be met.

    For each bound that cannot be met while all others are kept it is the nearest value of the
    output. Bounds of absolute values are left out; empty for a study of another kind. Each has the
    output, the bound, the value and the variables there, in the units of studies.
    """
    if not isinstance(study, OptimiseStudy):
        return []
    reaches = [(one, _reach(study, one)) for one in _single(study) if not one[0].absolute]
    return [reach for one, reach in reaches if reach is not None and _is_beyond(reach.value, one)]


def _reach(study: OptimiseStudy, named_bound: Bound) -> Reach | None:
    limit, end = named_bound
    kept = []
    for other, side in _single(study):
        if (other, side) != named_bound:
            more = {"absolute": other.absolute, side: getattr(other, side)}
            kept.append(OutputLimit(output=other.output, **more))
    criterion = (Minimise if end == "upper" else Maximise)(output=limit.output)
    changes: dict[str, Any] = {
        "criterion": criterion,
        "constraints": tuple(kept),
        "sensitivities": False,
    }
    if study.robust is not None:  # a limit holds for all units, whatever the objective counts
        changes |= {"robust": "worst", "quantile": None}
    values = _solved(study.model_copy(update=changes))
    if values is None:
        return None
    choice = {name: float(values[f"best_{name}"]) for name in study.bounds()}
    bound = float(getattr(limit, end))
    return Reach(limit.output, bound, float(values["objective"]), end == "upper", choice)


def _solved(study: OptimiseStudy) -> dict[str, Any] | None:
    try:
        table = carry_out(prepare(study), KIND.compute, KIND.label)
    except VibrafeedError:  # such as an output that is none of this sort of study
        return None
    values = {name: variable.values for name, variable in table.variables.items()}
    if int(values["optimum_status"]) not in SOLVED or not np.isfinite(values["objective"]):
        return None
    return values


def _is_beyond(value: float, named_bound: Bound) -> bool:
    limit, end = named_bound
    bound = float(getattr(limit, end))
    return value > bound if end == "upper" else value < bound


def _single(study: OptimiseStudy) -> list[Bound]:
    return [
        (limit, end)
        for limit in study.constraints
        for end in ("lower", "upper")
        if getattr(limit, end) is not None
    ]


# --- what would do it


@dataclass(frozen=True)
class Way:
    """A change of a study that keeps all limits where its own variables do not.

    Attributes
    ----------
    change : str
        What it does that the study does not.
    output : str
        What the study looks for.
    value : float
        Its value then, in the unit of the quantity.
    choice : dict of str to float
        The variables there, in the unit of the quantity.
    """

    change: str
    output: str
    value: float
    choice: dict[str, float]


WIDER = 4.0
"""Times the frequency, either way, among which another one is looked for."""
MAX_FRICTION = 0.8
"""Of a track that is lined with rubber, about: `vibrafeed materials rubber`."""
OF_A_LINE = ("amplitude", "beta")
"""What a straight drive is chosen by."""


def ways(study: Study) -> list[Way]:
    """Return changes of a study by which all constraints would be kept, each with its best choice.

    Tried are another frequency, more friction and an elliptical drive; a user whose constraints
    cannot be kept is told. Empty for other studies, or if none of the changes helps.
    """
    if not isinstance(study, OptimiseStudy) or study.variables is None:
        return []
    reached = []
    for change, other in (
        ("another frequency", _with_frequency(study)),
        ("more friction", _with_friction(study)),
        ("an elliptical drive", _with_ellipse(study)),
    ):
        table = None if other is None else _solved(other)
        if table is not None and other is not None:
            choice = {name: float(table[f"best_{name}"]) for name in other.bounds()}
            wanted = study.criterion.output
            reached.append(Way(change, wanted, float(table["objective"]), choice))
    return reached


def _with_frequency(study: OptimiseStudy) -> OptimiseStudy | None:
    given = study.values().get("frequency")
    if not isinstance(given, Fixed):
        return None
    free = Between(lower=given.value / WIDER, upper=given.value * WIDER)
    return _freed(study, "frequency", free)


def _with_friction(study: OptimiseStudy) -> OptimiseStudy | None:
    given = study.values().get("friction")
    if not isinstance(given, Fixed) or given.value >= MAX_FRICTION:
        return None
    return _freed(study, "friction", Between(lower=given.value, upper=MAX_FRICTION))


def _freed(study: OptimiseStudy, name: str, bounds: Between) -> OptimiseStudy | None:
    if study.variables is None:
        return None
    return study.model_copy(
        update={
            "parameters": _changed(study.parameters, (name,), {}),
            "variables": _changed(study.variables, (), {name: bounds}),
        }
    )


def _with_ellipse(study: OptimiseStudy) -> OptimiseStudy | None:
    bounds, values = study.bounds(), study.values()
    line = [name for name in OF_A_LINE if name in bounds]
    size = bounds.get("amplitude") or values.get("amplitude")
    if not line or "alpha" in bounds or "alpha" in values or study.variables is None:
        return None
    largest = getattr(size, "upper", getattr(size, "value", None))
    if largest is None:
        return None
    of_axis = Between(lower=0.0, upper=largest)
    ellipse = {
        "amplitude_along_1": of_axis,
        "amplitude_normal_1": of_axis,
        "phase_normal_1": Between(lower=0.0, upper=360.0),
    }
    return study.model_copy(
        update={
            "parameters": _changed(study.parameters, OF_A_LINE, {}),
            "variables": _changed(study.variables, OF_A_LINE, ellipse),
        }
    )


def _changed(section: Section, left: Collection[str], more: Mapping[str, Any]) -> Section:
    kept = {n: getattr(section, n) for n in section.model_fields_set if n not in left}
    return section.model_construct(**kept, **more)
