"""From a study to a sweep that can be carried out."""

from __future__ import annotations

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import plan_study
from vibrafeed.core.reduce.checks import problems_of, problems_of_names
from vibrafeed.core.study.sweep_study import SweepStudy
from vibrafeed.core.sweep.plain import DerivedSweep, Sweep
from vibrafeed.core.sweep.reduced import ReducedSweep


def prepare(study: SweepStudy) -> Sweep | DerivedSweep | ReducedSweep:
    """Return the sweep that a study describes, checked and planned, ready to be computed.

    Its result has every cell, with derivatives if the study asks for them, or statistics over some
    axes.

    Raises
    ------
    StudyError
        With every problem of scene, outputs, parameters, and of what is asked of them.
    """
    asked = study.reduce
    problems = [] if asked is None else problems_of_names(asked, study.outputs, study.values())
    if asked is not None and study.precision is not None:
        message = "it says how cells are stored, and reduce stores none"
        problems.append(Problem("precision", message, "Leave it out"))
    if study.sensitivities and (asked is not None or study.precision is not None):
        other = "reduce" if asked is not None else "precision"
        message = f"derivatives are given with all cells, in 64 bits; the study has {other} too"
        problems.append(
            Problem("sensitivities", message, f"Remove either sensitivities or {other}")
        )
    try:
        plan, grid = plan_study(study, study.outputs, choose_scene(study.scene, study.variant))
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if asked is None:
        if problems:
            raise StudyError(problems)
        if study.sensitivities:
            derived = DerivedSweep(study, plan, grid)
            _ = derived.derived  # which raises what is wrong with it
            return derived.check_verification()
        return Sweep(study, plan, grid).check_verification()
    problems += problems_of(asked, plan, grid)
    if problems:
        raise StudyError(problems)
    return ReducedSweep(study, plan, grid).check_verification()
