"""The kind `sweep`: from a study to a sweep that can be carried out, and its results."""

from __future__ import annotations

from typing import Final

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.lazy.checks import problems_of, problems_of_names
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import plan_study
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.sweep_study import SweepStudy
from vibrafeed.core.sweep.cells import verified_alone
from vibrafeed.core.sweep.plain import DerivedSweep, ReducedSweep, Sweep
from vibrafeed.core.watch import Watch

AnySweep = Sweep | DerivedSweep | ReducedSweep


def prepare(study: SweepStudy) -> AnySweep:
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


def compute(prepared: AnySweep, watch: Watch) -> Computed:
    """Return outputs and verdicts of a sweep in SI units, or its reduction."""
    return prepared.compute(watch)


def label(prepared: AnySweep, computed: Computed, watch: Watch) -> Table:
    """Return the labelled results of a sweep; `watch` may stop verifying."""
    return prepared.label(computed, watch)


KIND: Final = Kind(
    name="sweep",
    title="Sweep closed-form equations",
    description="Evaluates the closed-form equations of a scene over a grid of parameters.",
    model=SweepStudy,
    scenes=(SCENES,),
    example={
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {
            "frequency": "50 Hz",
            "amplitude": ["0.5 mm", "1 mm"],
            "beta": {"start": 0, "stop": 60, "num": 7},
        },
    },
    prepare=prepare,
    choose=lambda sketch: choose_scene(sketch.scene, sketch.variant),
    compute=compute,
    label=label,
    is_measured=True,
    verified=verified_alone,
)
