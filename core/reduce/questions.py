"""The fields of a reduction: outputs over the same axes, with everything that is asked of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan, Verdict
from vibrafeed.core.quantities import FLAGS, REGIMES
from vibrafeed.core.study.reduction import LevelSet, Reduction, ShareCondition

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
    regimes : tuple of str
        The verdicts by whose regimes cells are counted.
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
    regimes: tuple[str, ...] = ()
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
        judges = (judge_of(plan, asked, name) for name in names if name in plan.outputs)
        names = names | {judge.name for judge in judges if judge is not None}
        dims = grid.dims(frozenset().union(*(depends[name] for name in names)))
        key = (dims, () if at_once else question.along)
        known = fields.get(key, ReducedField(dims, plan))
        needed[key] = needed.get(key, set()) | names
        fields[key] = replace(
            known,
            outputs=tuple(dict.fromkeys((*known.outputs, *question.outputs))),
            regimes=(*known.regimes, *question.regimes),
            shares={**known.shares, **question.shares},
            levels={**known.levels, **question.levels},
            along=tuple(dict.fromkeys((*known.along, *question.along))),
        )
    order = (*plan.outputs, *plan.verdict_names)
    return tuple(
        replace(known, plan=plan.part([name for name in order if name in needed[key]]))
        for key, known in fields.items()
    )


def takes_long(plan: Plan) -> bool:
    """True if an equation of a plan simulates motion, which takes long."""
    return any(equation.takes_long for equation in plan.equations)


def judge_of(plan: Plan, asked: Reduction, output: str) -> Verdict | None:
    """Return the verdict that keeps cells of an output from counting; None if all count."""
    verdict = plan.verdict_on(output)
    return verdict if asked.cells == "valid" and verdict and verdict.doubts else None


VALID_REGIMES = sum(1 << flag.value for flag in REGIMES.values() if flag.valid)
"""The regimes of cells that count, as an integer with a bit for each number."""


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
    for name in plan.verdict_names if asked.regimes else ():
        yield {name}, ReducedField((), plan, regimes=(name,))
    for name, conditions in asked.shares.items():
        yield {one.name for one in conditions}, ReducedField((), plan, shares={name: conditions})
    for name, level in asked.levels.items():
        yield {level.output}, ReducedField((), plan, levels={name: level}, along=(level.along,))
