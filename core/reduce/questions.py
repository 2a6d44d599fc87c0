"""The fields of a reduction: outputs over the same axes, with everything that is asked of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from core.plan.grid import Grid
from core.plan.plan import Plan
from core.quantities import FLAGS, REGIMES
from core.study.reduction import LevelSet, Reduction, ShareCondition

EVERY_REGIME = (1 << 63) - 1  # a bit for each number of a regime
EXACT_CELLS = 1 << 22
"""Most cells of a slot whose quantiles are exact; for more cells they come from a histogram."""


@dataclass(frozen=True)
class ReducedField:
    """A field of a reduction: outputs over the same axes, and what is asked of them.

    Attributes
    ----------
    dims : tuple of str
        The axes, those that are reduced and those that stay.
    plan : Plan
        The plan that is evaluated for it.
    outputs : tuple of str
        Outputs with statistics or quantiles.
    regimes : bool
        True if cells are counted by regime.
    shares : mapping of str to tuple of ShareCondition
        Conditions of each share.
    levels : mapping of str to LevelSet
        Levels whose crossings are located.
    along : tuple of str
        Axes of the crossings, along which boxes hold one cell more.
    """

    dims: tuple[str, ...]
    plan: Plan
    outputs: tuple[str, ...] = ()
    regimes: bool = False
    shares: dict[str, tuple[ShareCondition, ...]] = field(default_factory=dict)
    levels: dict[str, LevelSet] = field(default_factory=dict)
    along: tuple[str, ...] = ()


def fields_of(plan: Plan, grid: Grid, asked: Reduction) -> tuple[ReducedField, ...]:
    """Return the fields of a reduction: groups of outputs over the same axes with their statistics.

    The cells of a field are computed once for all its statistics. Crossings of levels have fields
    of their own, unless cells take long: those are computed once for all. `asked` is the section
    `reduce`.
    """
    fields: dict[tuple[tuple[str, ...], tuple[str, ...]], ReducedField] = {}
    needed: dict[tuple[tuple[str, ...], tuple[str, ...]], set[str]] = {}
    at_once = takes_long(plan)
    depends = plan.depends_on(grid.axes)
    for names, question in _questions(plan, asked):
        if has_invalid(plan, asked) and names:
            names = {*names, "regime"}
        dims = grid.dims(frozenset().union(*(depends[name] for name in names)))
        key = (dims, () if at_once else question.along)
        known = fields.get(key, ReducedField(dims, plan))
        needed[key] = needed.get(key, set()) | names
        fields[key] = replace(
            known,
            outputs=tuple(dict.fromkeys((*known.outputs, *question.outputs))),
            regimes=known.regimes or question.regimes,
            shares={**known.shares, **question.shares},
            levels={**known.levels, **question.levels},
            along=tuple(dict.fromkeys((*known.along, *question.along))),
        )
    return tuple(replace(known, plan=_pulled(plan, needed[key])) for key, known in fields.items())


def takes_long(plan: Plan) -> bool:
    """True if an equation of a plan simulates motion, which takes long."""
    return any(equation.takes_long for equation in plan.equations)


def has_invalid(plan: Plan, asked: Reduction) -> bool:
    """True if some regime of the plan keeps cells from counting."""
    return asked.cells == "valid" and not all(REGIMES[name].valid for name in plan.regimes)


def valid_regimes(plan: Plan, asked: Reduction) -> int:
    """Return the regimes of cells that count, as an integer with a bit for each number."""
    if not has_invalid(plan, asked):
        return EVERY_REGIME
    return sum(1 << REGIMES[name].value for name in plan.regimes if REGIMES[name].valid)


def outputs_of(plan: Plan, asked: Reduction) -> tuple[str, ...]:
    """Return the outputs with statistics and quantiles: those that are no flags."""
    wanted = asked.of or plan.outputs
    return tuple(name for name in plan.outputs if name in wanted and name not in FLAGS)


def _questions(plan: Plan, asked: Reduction) -> Iterator[tuple[set[str], ReducedField]]:
    """Yield each question of a reduction: the arrays that it needs, and a field with it alone.

    A question is the statistics of an output, the count of regimes, a share of cells that meet
    conditions, or the crossing of a level. A field is a group of questions that are computed over
    the same axes; the caller joins these single ones. `asked` is the section `reduce` of the study.
    """
    if asked.statistics or asked.quantiles:
        for name in outputs_of(plan, asked):
            yield {name}, ReducedField((), plan, outputs=(name,))
    if asked.regimes:
        yield {"regime"}, ReducedField((), plan, regimes=True)
    for name, conditions in asked.shares.items():
        yield {one.name for one in conditions}, ReducedField((), plan, shares={name: conditions})
    for name, level in asked.levels.items():
        yield {level.output}, ReducedField((), plan, levels={name: level}, along=(level.along,))


def _pulled(plan: Plan, names: Iterable[str]) -> Plan:
    """Return the part of the plan that the arrays named (outputs, `regime`) need."""
    outputs = tuple(name for name in plan.outputs if name in set(names))
    return plan.part(outputs, plan.conditions if "regime" in names else ())
