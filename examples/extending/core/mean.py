"""The mean of closed forms over all cells of a grid, (1/N) sum_k y_k."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

from pydantic import Field

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.labels import global_attributes, outputs_of
from vibrafeed.core.plan.pieces import Computed, Kind
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import Prepared, plan_study
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.grid_study import MAX_OUTPUTS, OutputNames, Study
from vibrafeed.core.watch import Watch


class MeanStudy(Study):
    """The mean of closed forms over a grid of parameters."""

    kind: Literal["mean"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None, description="Variant of the scene; its default where left out.", max_length=100
    )
    outputs: OutputNames = Field(
        description="Names of the outputs.", min_length=1, max_length=MAX_OUTPUTS
    )


@dataclass(frozen=True)
class Mean(Prepared):
    """A mean that can be computed: no axis is left, and no piece has a mean of its own."""

    study: MeanStudy

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """As in `Prepared`."""
        return dict.fromkeys(self.plan.outputs, ())

    @property
    def stored(self) -> int:
        """As in `Prepared`."""
        return 1

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """As in `Prepared`."""
        return ()


def prepare(study: MeanStudy) -> Mean:
    """Return the mean of a study; raise `StudyError` with every problem."""
    problems = []
    if study.verify is not None:
        message = "a mean is not verified cell by cell"
        problems.append(Problem("verify", message, "Leave it out, and verify a sweep"))
    try:
        chosen = choose_scene(study.scene, study.variant)
        plan, grid = plan_study(study, study.outputs, chosen)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if problems:
        raise StudyError(problems)
    return Mean(study, plan, grid)


def compute(prepared: Mean, watch: Watch) -> Computed:
    """Return the mean of each output, SI units."""
    cells = evaluate(prepared.plan, prepared.grid, threads=watch.threads, progress=watch.advance)
    return Computed({name: cells[name].mean() for name in prepared.plan.outputs})


def label(prepared: Mean, computed: Computed, watch: Watch) -> Table:
    """Return the means, labelled."""
    del watch  # nothing is verified
    means = outputs_of(prepared, computed.arrays)
    variables = {
        name: replace(one, attributes={**one.attributes, "cell_methods": "area: mean"})
        for name, one in means.items()
    }
    return Table({}, variables, global_attributes(prepared, "mean of closed-form equations"))


KIND: Final = Kind(
    name="mean",
    title="Average closed-form equations",
    description="Evaluates the closed-form equations of a scene over a grid and gives their means.",
    model=MeanStudy,
    scenes=(SCENES,),
    example={
        "kind": "mean",
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {"frequency": "50 Hz", "amplitude": ["0.5 mm", "1 mm"], "beta": 30},
    },
    prepare=prepare,
    choose=lambda sketch: choose_scene(sketch.scene, sketch.variant),
    compute=compute,
    label=label,
)
