"""Motion of which statistics are reported instead of its cells."""

from __future__ import annotations

from typing import ClassVar

from vibrafeed.core.motion.prepare import Simulation, prepare
from vibrafeed.core.motion.verify import accuracy, verified_at
from vibrafeed.core.plan.labels import global_attributes
from vibrafeed.core.plan.sample import Sample, chosen_positions
from vibrafeed.core.reduce.reduced import Reduced
from vibrafeed.core.study.simulate_study import SimulateStudy
from vibrafeed.core.watch import Watch


class ReducedSimulation(Reduced, Simulation):
    """A study of motion of which statistics are reported instead of its cells."""

    study: SimulateStudy
    box_cells: ClassVar[int | None] = 1 << 13  # some tens of milliseconds in the plane, or longer
    share_cells: ClassVar[int] = 1 << 18

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result, known before computing."""
        plan = self.plan
        told = global_attributes(self, f"motion in time, method {plan.variant}")
        return {**told, "accuracy": accuracy(plan)}

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return attributes of the result on random cells that another method followed again.

        The attributes, by name, count the verified cells and report the largest difference; empty
        if the study does not ask to `verify`. `watch` may stop the work.
        """
        if self.study.verify is None:
            return {}
        places, count = chosen_positions(self)
        return verified_at(self, Sample(self.grid, places, count, count), None, watch)


def prepare_reduced(study: SimulateStudy) -> Simulation:
    """Return the prepared simulation of a study: of statistics in place of cells with `reduce`.

    Raises
    ------
    StudyError
        With every problem of scene, method, outputs, settings and parameters.
    """
    prepared = prepare(study)
    if study.reduce is None:
        return prepared
    return ReducedSimulation(prepared.study, prepared.plan, prepared.grid)
