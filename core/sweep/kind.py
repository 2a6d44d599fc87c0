"""The kind `sweep`: from a study to closed forms over a grid, and their labelled results."""

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar, Final

import numpy as np

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import Problem, StudyError, raise_any
from vibrafeed.core.lazy.checks import problems_of, problems_of_names
from vibrafeed.core.lazy.reduced import Reduced
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.bands import Bands, bands_of, problem_of_added, problems_of_bands
from vibrafeed.core.plan.differences import Asked, asked_of, cells_of, derivatives
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.labels import (
    Sample,
    coordinates_of,
    global_attributes,
    outputs_of,
    verdict_variables,
)
from vibrafeed.core.plan.pieces import Computed, Kind
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import Prepared, plan_study
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.sweep_and_simulate import SweepStudy
from vibrafeed.core.sweep.verify import accuracy, verified
from vibrafeed.core.watch import Watch


class Sweep(Prepared):
    """A sweep of every cell, with the derivatives of its outputs if the study asks for them."""

    study: SweepStudy
    can_stop: ClassVar[bool] = False
    keeps_some: ClassVar[bool] = False

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading: what is added needs the whole grid."""
        return problem_of_added(self.study.sensitivities, self.grid)

    @cached_property
    def derived(self) -> Asked | None:
        """The derivatives in the result; None without any."""
        asked = self.study.sensitivities
        return asked_of(self.plan, self.study.values(), asked, self.cells) if asked else None

    @cached_property
    def bands(self) -> Bands | None:
        """The bands of speeds in the result; None without any."""
        return bands_of(self.plan, self.grid)


class ReducedSweep(Reduced):
    """A sweep whose result holds statistics over some axes in place of all cells."""

    study: SweepStudy

    @property
    def whole(self) -> Sweep:
        """The sweep of all cells."""
        return Sweep(self.study, self.plan, self.grid)

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result that are known before computing."""
        return attributes_of(self)

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the verification of random cells as attributes; the cells are computed alone."""
        return verified_alone(self, watch)


def prepare(study: SweepStudy) -> Sweep | ReducedSweep:
    """Return the sweep that a study describes, checked and planned, ready to be computed.

    Its result has every cell, with derivatives if the study asks for them, or statistics over some
    axes.

    Raises
    ------
    StudyError
        With every problem of scene, outputs, parameters, and of what is asked of them.
    """
    reduction = study.reduce
    problems = [*_problems_of_form(study)]
    try:
        plan, grid = plan_study(study, study.outputs, choose_scene(study.scene, study.variant))
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if reduction is None:
        raise_any(problems)
        sweep = Sweep(study, plan, grid)
        _ = sweep.added  # raises the problems of derivatives and bands
        return sweep.check_verification()
    problems += problems_of(reduction, plan, grid)
    raise_any(problems)
    return ReducedSweep(study, plan, grid).check_verification()


def _problems_of_form(study: SweepStudy) -> Iterable[Problem]:
    reduction = study.reduce
    if reduction is not None:
        yield from problems_of_names(reduction, study.outputs, study.values())
        yield from problems_of_bands(study.values())
    if reduction is not None and study.sensitivities:
        yield Problem(
            "sensitivities",
            "derivatives cannot be combined with reduce",
            "Remove either sensitivities or reduce",
        )


def compute(prepared: Sweep | ReducedSweep, watch: Watch) -> Computed:
    """Return the outputs and verdicts of a sweep in SI units, and derivatives; or its reduction."""
    if isinstance(prepared, ReducedSweep):
        return prepared.compute(watch)
    plan, grid, derived = prepared.plan, prepared.grid, prepared.derived
    arrays = evaluate(plan, grid, threads=watch.threads, progress=watch.advance)
    if derived is not None:
        derived_plan = plan.part(derived.outputs)
        slopes = derivatives(derived_plan, cells_of(derived_plan, grid), derived.parameters)
        arrays = {**arrays, **derived.arrays(plan, grid, prepared.dims, slopes)}
    if prepared.bands is not None:
        arrays = {**arrays, **prepared.bands.arrays(plan, grid, prepared.dims, watch)}
    return Computed(arrays)


def label(prepared: Sweep | ReducedSweep, computed: Computed, watch: Watch) -> Table:
    """Return the results of a sweep as a table; `watch` may stop its verification."""
    if isinstance(prepared, ReducedSweep):
        return prepared.label(computed, watch)
    plan, arrays, dims = prepared.plan, computed.arrays, prepared.dims

    def values_at(sample: Sample) -> dict[str, Array]:
        """Return the outputs at sampled cells."""
        return {name: sample.at(arrays[name], dims[name]) for name in plan.outputs}

    variables = outputs_of(prepared, arrays) | verdict_variables(plan, dims, arrays)
    for added in prepared.added:
        variables |= added.variables(prepared.dims, arrays)
    attributes = {**attributes_of(prepared), **verified(prepared, values_at, watch)}
    return Table(coordinates_of(plan, prepared.grid), variables, attributes)


def verified_alone(prepared: Prepared, watch: Watch) -> dict[str, str | int]:
    """Return the verification of random cells as attributes; the cells are computed alone."""

    def values_at(sample: Sample) -> dict[str, Array]:
        boxes = [
            {
                dim: (int(positions[number]), int(positions[number]) + 1)
                for dim, positions in sample.positions.items()
            }
            for number in range(sample.count)
        ]
        plan = prepared.plan
        cells = [evaluate(plan, prepared.grid.piece(box, plan.parameters)) for box in boxes]
        return {name: np.array([cell[name].item() for cell in cells]) for name in plan.outputs}

    return verified(prepared, values_at, watch)


def attributes_of(prepared: Prepared) -> dict[str, str]:
    """Return attributes of a sweep's result known before computing: study, source and accuracy."""
    form = "closed-form equations"
    return {**global_attributes(prepared, form), "accuracy": accuracy(prepared.plan.scene)}


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
