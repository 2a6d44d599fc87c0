"""From a study to a sweep that can be carried out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.errors import Problem, StudyError
from core.plan.derived import Asked, asked_of
from core.plan.plan import choose_scene
from core.plan.prepared import Chosen, Prepared, further_problems, plan_study
from core.plan.price import evaluation_seconds, pace
from core.reduce.checks import problems_of, problems_of_names
from core.study.reduction import QUANTILE, Reduction
from core.study.sweep_study import SweepStudy
from core.sweep.answers import unit_of

if TYPE_CHECKING:
    from core.reduce.run import Units

SEEN_SECONDS = 1.5e-9
"""What it takes to see what a cell tells for an answer, beside evaluating it."""


class Sweep(Prepared):
    """A sweep that can be carried out."""

    study: SweepStudy

    @property
    def is_single(self) -> bool:
        """Whether values are stored in 32 bits."""
        return self.study.precision == "single"

    def width(self, name: str) -> int:
        """As in `Prepared`."""
        return min(super().width(name), 4) if self.is_single else super().width(name)

    def in_files(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """As in `Prepared`; rounded to 32 bits last, if the study says so."""
        values = super().in_files(name, values)
        if not self.is_single or values.dtype != np.float64:
            return values
        with np.errstate(over="ignore"):  # what is too large for 32 bits is infinite
            return values.astype(np.float32)

    @cached_property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`."""
        return evaluation_seconds(self.plan, self.grid) / self.cells


class DerivedSweep(Prepared):
    """A sweep with the derivatives of its outputs, computed and kept as a whole."""

    study: SweepStudy

    @cached_property
    def derived(self) -> Asked | None:
        """As in `Prepared`."""
        return asked_of(self.plan, self.study.values(), self.study.sensitivities, self.cells)

    @cached_property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`: each parameter takes a pass of its own, with two numbers for one."""
        passes = 1 + (2 * len(self.derived.parameters) if self.derived else 0)
        return passes * self.plan.scene.seconds_a_cell * pace()


class ReducedSweep(Prepared):
    """A sweep of which answers are told in place of its cells.

    Its `cells` are those that are evaluated; what is stored is `stored`.
    """

    study: SweepStudy

    @property
    def asked(self) -> Reduction:
        """What is asked."""
        assert self.study.reduce is not None
        return self.study.reduce

    @cached_property
    def work(self) -> Units:
        """The boxes that it is carried out in."""
        from core.reduce.run import Units  # numba, for those who reduce

        return Units(self.plan, self.grid, self.asked)

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The dimensions of each answer."""
        from core.reduce.answers import dims_of

        return dims_of(self.work, self.asked)

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each answer."""
        return {name: unit_of(name, self.asked, self.plan.outputs) for name in self.dims}

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension of the answers."""
        return {**self.grid.shape, QUANTILE: len(self.asked.quantiles)}

    @property
    def stored(self) -> int:
        """Number of points of the grid of answers."""
        return max(self._points.values())

    @cached_property
    def _points(self) -> dict[str, int]:
        sizes = self.sizes
        return {n: math.prod(sizes[dim] for dim in dims) for n, dims in self.dims.items()}

    @property
    def bytes(self) -> int:
        """Bytes that the answers take, uncompressed."""
        return 8 * sum(self._points.values())

    @property
    def computed_bytes(self) -> int:
        """As in `Prepared`: those of the answers."""
        return self.bytes

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes that stay: cut along another one, a piece would have no answer."""
        return tuple(axis for axis in self.grid.axes if axis not in self.asked.over)

    @cached_property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`."""
        return evaluation_seconds(self.plan, self.grid) / self.cells + SEEN_SECONDS * pace()

    def what_fits(self, share: float) -> str:
        """As in `Prepared`."""
        stays = ", ".join(self.cut_axes)
        return f"It fits over more axes, or with fewer values of {stays}"

    @property
    def whole(self) -> Sweep:
        """The sweep whose cells the answers are of."""
        return Sweep(self.study, self.plan, self.grid)


def prepare(study: SweepStudy) -> Sweep | DerivedSweep | ReducedSweep:
    """Return the sweep of a study.

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
        problems.append(Problem("sensitivities", message, "Leave out one of the two"))
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


def no_cells(fix: str) -> Problem:
    """Return what to tell of a reduced sweep where cells are wanted."""
    return Problem("reduce", "what is reduced has no cells to read", fix)


def as_a_whole(fix: str) -> Problem:
    """Return what to tell of a sweep with derivatives where it is read cell by cell."""
    return Problem("sensitivities", "derivatives are computed as a whole, not where read", fix)


def further(content: Mapping[str, Any], known: StudyError) -> list[Problem]:
    """Return what a plan of unsound content would object to, as far as it can be told."""
    return further_problems(content, known, _chosen)


def _chosen(content: Mapping[str, Any]) -> Chosen:
    variant = content.get("variant")
    return choose_scene(content["scene"], variant if isinstance(variant, str) else None)
