"""The nearest approach to limits that no choice keeps together, and changes that would keep them.

Each bound in turn becomes what is looked for, while the others are kept: that tells how far the
output goes, and so which limit would have to give way. Then the same limits with a wider choice.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.optimise.optima import KIND
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.plan.pieces import carry_out
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.study.optimise_study import (
    Maximise,
    Minimise,
    OptimiseStudy,
    OutputLimit,
    Pareto,
    Target,
)
from vibrafeed.core.study.values import Between, Fixed
from vibrafeed.core.watch import Watch

SOLVED = (STATUS["optimal"], STATUS["not_attained"])


@dataclass(frozen=True)
class Reach:
    """The nearest that an output comes to its bound while all other limits are kept.

    Attributes
    ----------
    name, output : str
        The limit, as of a constraint or ``floor_contact``, and its output.
    bound, value : float
        What is asked, and the nearest that there is, in the unit of the quantity.
    upper : bool
        Whether the bound is the largest value; else the least.
    choice : dict of str to float
        The variables there, in the unit of the quantity.
    """

    name: str
    output: str
    bound: float
    value: float
    upper: bool
    choice: dict[str, float]


def nearest(study: Study, watch: Watch | None = None) -> list[Reach]:
    """Return the nearest approach to each bound of an optimisation that cannot be met.

    For each bound that cannot be met while all others are kept it is the nearest value of the
    output. Bounds of absolute values are left out; empty for a study of another kind. Each has the
    output, the bound, the value and the variables there, in the units of studies.
    """
    reaches: list[Reach] = []
    if not isinstance(study, OptimiseStudy):
        return reaches
    limits = prepare(study).problem.constraints
    one_sided = [limit for limit in limits if not limit.absolute]
    watch = watch or Watch()
    for limit in one_sided:
        is_upper, bound = limit.upper, float(limit.bound or 0.0)
        others = [
            OutputLimit(
                output=other.output,
                absolute=other.absolute,
                **{"upper" if other.upper else "lower": other.bound},
            )
            for other in limits
            if other != limit
        ]
        changes: dict[str, Any] = {
            "criterion": (Minimise if is_upper else Maximise)(output=limit.output),
            "constraints": tuple(others),  # the contacts, too
            "floor_contact": False,
            "wall_contact": False,
            "outputs": (*study.outputs, *study.criterion_outputs()),  # each variable stays in use
            "sensitivities": False,
        }
        if study.robust is not None:  # a limit holds for all units, whatever the objective counts
            changes |= {"robust": "worst", "quantile": None}
        optimum = _best_value_and_choice(
            study.model_copy(update=changes), watch.part(1.0 / len(one_sided))
        )
        if optimum is not None and (optimum[0] > bound if is_upper else optimum[0] < bound):
            reaches.append(Reach(limit.name, limit.output, bound, optimum[0], is_upper, optimum[1]))
    return reaches


def _best_value_and_choice(
    study: OptimiseStudy, watch: Watch
) -> tuple[float, dict[str, float]] | None:
    # The best value and its choice; None without one, or if the study cannot be planned: it is one
    # that the program makes up to advise a user.
    try:
        table = carry_out(prepare(study), KIND.compute, KIND.label, watch)
    except VibrafeedError:  # such as an output that is none of this sort of study
        return None
    values = {name: variable.values for name, variable in table.variables.items()}
    # The objective of a target is the distance from it.
    wanted = study.criterion.output if isinstance(study.criterion, Target) else "objective"
    if int(values["optimum_status"]) not in SOLVED or not np.isfinite(values[wanted]):
        return None
    choice = {name: float(values[f"best_{name}"]) for name in study.bounds()}
    return float(values[wanted]), choice


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


def ways(study: Study, watch: Watch | None = None) -> list[Way]:
    """Return changes of a study by which all constraints would be kept, each with its best choice.

    Tried are another frequency, more friction and an elliptical drive, if constraints cannot be
    kept or a target is missed. Of a trade-off the output that is to be large counts. Empty for
    other studies, or if none of the changes helps.
    """
    if not isinstance(study, OptimiseStudy) or study.variables is None:
        return []
    if isinstance(study.criterion, Pareto):
        study = study.model_copy(update={"criterion": Maximise(output=study.criterion.output)})
    candidates = {
        "another frequency": _with_variable(study, "frequency", lambda f: (f / WIDER, f * WIDER)),
        "more friction": _with_variable(
            study, "friction", lambda friction: (friction, MAX_FRICTION)
        ),
        "an elliptical drive": _with_ellipse(study),
    }
    studies = {change: other for change, other in candidates.items() if other is not None}
    watch = (watch or Watch()).part(1.0 / max(len(studies), 1))
    optima = {change: _best_value_and_choice(other, watch) for change, other in studies.items()}
    output = study.criterion.output
    return [
        Way(change, output, *optimum) for change, optimum in optima.items() if optimum is not None
    ]


def _with_variable(
    study: OptimiseStudy, name: str, ends: Callable[[float], tuple[float, float]]
) -> OptimiseStudy | None:
    value = study.values().get(name)
    lower, upper = ends(value.value) if isinstance(value, Fixed) else (0.0, 0.0)
    if lower >= upper:
        return None
    return _with_variables(study, (name,), {name: Between(lower=lower, upper=upper)})


def _with_ellipse(study: OptimiseStudy) -> OptimiseStudy | None:
    bounds, values = study.bounds(), study.values()
    amplitude = bounds.get("amplitude") or values.get("amplitude")
    largest = getattr(amplitude, "upper", getattr(amplitude, "value", None))
    azimuth = {"alpha"} & {*bounds, *values}  # such a drive has no azimuth
    if largest is None or azimuth or not {*OF_A_LINE} & {*bounds}:
        return None
    half_axis = Between(lower=0.0, upper=largest)
    ellipse = {
        "amplitude_along_1": half_axis,
        "amplitude_normal_1": half_axis,
        "phase_normal_1": Between(lower=0.0, upper=360.0),
    }
    return _with_variables(study, OF_A_LINE, ellipse)


def _with_variables(
    study: OptimiseStudy, removed: Collection[str], added: Mapping[str, Between]
) -> OptimiseStudy:
    def without(section: Any) -> dict[str, Any]:
        return {
            name: getattr(section, name) for name in section.model_fields_set if name not in removed
        }

    parameters, variables = study.parameters, study.variables
    assert variables is not None
    changes = {
        "parameters": parameters.model_construct(**without(parameters)),
        "variables": variables.model_construct(**without(variables) | dict(added)),
    }
    return study.model_copy(update=changes)
