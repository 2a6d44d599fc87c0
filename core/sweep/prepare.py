"""From a study to what can be evaluated: the plan and the grid, checked together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from core.errors import LimitError, Problem, StudyError, suggestion
from core.scenes import SCENES, Scene
from core.study.load import parse_study
from core.study.models import PARAMETERS, SweepStudy
from core.sweep.grid import Grid
from core.sweep.plan import Plan, make_plan

BYTES = {"regime": 1}  # of one value; 8 for all others


@dataclass(frozen=True)
class Sweep:
    """A study that can be carried out: its plan and its grid."""

    study: SweepStudy
    plan: Plan
    grid: Grid

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The axes that each output keeps, `regime` last."""
        depends = self.plan.depends_on(self.grid.axes)
        return {name: self.grid.dims(depends[name]) for name in (*self.plan.outputs, "regime")}

    @property
    def cells(self) -> int:
        """Number of points of the grid."""
        return self.grid.cells

    @property
    def bytes(self) -> int:
        """Bytes that the outputs take, uncompressed."""
        return sum(self.grid.size(dims) * BYTES.get(name, 8) for name, dims in self.dims.items())

    def check_limits(self, *, cells: int, bytes_: int) -> None:
        """Raise `LimitError` if the sweep has more cells or bytes than allowed."""
        for limit, asked, allowed in (("cells", self.cells, cells), ("bytes", self.bytes, bytes_)):
            if asked > allowed:
                raise LimitError(limit, asked, allowed, self._what_fits(allowed / asked))

    def _what_fits(self, share: float) -> str:
        longest = max(self.grid.shape, key=lambda name: self.grid.shape[name])
        fitting = int(self.grid.shape[longest] * share)
        if fitting >= 2:
            points = self.grid.shape[longest]
            return f"It fits with {fitting:,} instead of {points:,} values of {longest}"
        axes = len(self.grid.shape)
        each = int((self.cells * share) ** (1 / axes))
        if each >= 2:
            return f"It fits with {each:,} values on each of the {axes} axes"
        return f"It fits with fewer than {axes} ranged parameters"


def prepare(study: SweepStudy) -> Sweep:
    """Return the sweep of a study.

    Raises
    ------
    StudyError
        With every problem of scene, outputs and parameters.
    """
    values = study.values()
    grid = Grid.of(values)
    problems: list[Problem] = []
    if study.scene in SCENES:
        problems += _broken_constraints(SCENES[study.scene], grid)
    try:
        plan = make_plan(study.scene, study.variant, study.outputs, values)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if problems:
        raise StudyError(problems)
    return Sweep(study, plan, grid)


def prepare_content(content: object) -> Sweep:
    """Return the sweep that the content of a file or request describes.

    Raises
    ------
    StudyError
        With every problem, those of single values and those of the study as a whole.
    """
    try:
        study = parse_study(content)
    except StudyError as error:
        places = {problem.place for problem in error.problems}
        more = (p for p in _plan_problems(content) if p.place not in places)
        raise StudyError([*error.problems, *more]) from None
    return prepare(study)


def _plan_problems(content: object) -> tuple[Problem, ...]:
    """Return what a plan of unsound content would object to, as far as it can be told."""
    if not isinstance(content, Mapping):
        return ()
    scene, variant = content.get("scene"), content.get("variant")
    outputs, parameters = content.get("outputs"), content.get("parameters")
    if not (
        isinstance(scene, str)
        and (variant is None or isinstance(variant, str))
        and isinstance(outputs, list | tuple)
        and all(isinstance(name, str) for name in outputs)
        and isinstance(parameters, Mapping)
    ):
        return ()
    given = [_meant(str(name)) for name in parameters]
    try:
        make_plan(scene, variant, outputs, [name for name in given if name])
    except StudyError as error:
        return error.problems
    return ()


def _meant(name: str) -> str:
    """Return the parameter that a key stands for, mistyped or not; empty if none is near."""
    if name in PARAMETERS:
        return name
    guess = suggestion(name, PARAMETERS, otherwise="")
    return guess.split("'")[1] if guess.startswith("Did you mean") else ""


def _broken_constraints(scene: Scene, grid: Grid) -> Iterable[Problem]:
    """Yield the relations between given parameters that do not hold."""
    given = {*grid.axes, *grid.fixed}
    for constraint in scene.constraints:
        if set(constraint.parameters) <= given:
            ends = [end for name in constraint.parameters for end in grid.bounds(name)]
            if not constraint.holds(*ends):
                place = f"parameters.{constraint.parameters[0]}"
                yield Problem(place, constraint.message, constraint.fix)
