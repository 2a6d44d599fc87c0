"""Checks of `[reduce]`: problems, each with its path in the study."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from vibrafeed.core.errors import Problem
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities import FLAGS
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.study.reduction import Reduction
from vibrafeed.core.study.values import DESIGN, Fixed, Paired, Values
from vibrafeed.core.suggestions import Suggestions

MOST_FOR_QUANTILES = 1 << 26
"""Cells of one answer of which quantiles are taken: they are in memory together, 512 MiB."""


def problems_of_names(
    reduction: Reduction, outputs: Collection[str], values: Mapping[str, Values]
) -> list[Problem]:
    """Return the problems of the names in a study's section `reduce`: axes, outputs, codes, shares.

    Parameters
    ----------
    reduction : Reduction
        The section.
    outputs : collection of str
        The study's outputs.
    values : mapping of str to Values
        Its parameters, of which those with several values are axes.
    """
    numbers = [name for name in outputs if name not in FLAGS]  # a mean of codes says nothing
    suggestions = Suggestions()
    problems = [
        Problem(f"reduce.{place}", f"'{name[:60]}' is not {expected}", suggestions(name, known))
        for place, name, expected, known in _names(reduction, numbers, outputs, values)
        if name not in known
    ]
    problems += [
        Problem(f"reduce.shares.{key}", "the share has no condition", "Give at least one")
        for key, conditions in reduction.shares.items()
        if not conditions
    ]
    has_statistics = numbers and (reduction.statistics or reduction.quantiles)
    if not (has_statistics or reduction.regimes or reduction.shares or reduction.levels):
        fix = "Give statistics, quantiles, regimes, shares or levels"
        problems.append(Problem("reduce", "no statistic is requested", fix))
    return problems


def _names(
    reduction: Reduction,
    numbers: Sequence[str],
    outputs: Collection[str],
    values: Mapping[str, Values],
) -> Iterator[tuple[str, str, str, Sequence[str]]]:
    """Yield each name with its place, what it has to be, and the names that are."""
    ranged = {name: value for name, value in values.items() if not isinstance(value, Fixed)}
    axes = [
        *dict.fromkeys(
            DESIGN if isinstance(value, Paired) else name for name, value in ranged.items()
        )
    ]
    for number, name in enumerate(reduction.over):
        yield f"over.{number}", name, "an axis of this study", axes
    for number, name in enumerate(reduction.of):
        yield f"of.{number}", name, "a numeric output of this study", numbers
    for key, level in reduction.levels.items():
        yield f"levels.{key}.output", level.output, "a numeric output of this study", numbers
        yield f"levels.{key}.along", level.along, "an axis in reduce.over", reduction.over
    for key, conditions in reduction.shares.items():
        for number, condition in enumerate(conditions):
            if not condition.is_regime:
                yield (
                    f"shares.{key}.{number}",
                    condition.name,
                    "an output of this study",
                    [*outputs],
                )


def problems_of(reduction: Reduction, plan: Plan, grid: Grid) -> list[Problem]:
    """Return the problems of a reduction that only the plan of its study can tell.

    They are axes that no output depends on, regimes that no cell can have, levels along axes that
    their output does not depend on, and quantiles of more cells than memory holds.
    """
    without_effect = [
        Problem(f"reduce.over.{number}", f"no requested output depends on {name}", f"Remove {name}")
        for number, name in enumerate(reduction.over)
        if name in PARAMETERS and name not in {*grid.along, *grid.fixed}
    ]
    if without_effect:
        return without_effect
    return [
        *_regimes(reduction, plan),
        *_levels(reduction, plan, grid),
        *_quantiles(reduction, grid),
    ]


def _quantiles(reduction: Reduction, grid: Grid) -> Iterator[Problem]:
    cells = grid.size(name for name in reduction.over if name in grid.axes)
    if reduction.quantiles and cells > MOST_FOR_QUANTILES:
        message = f"each quantile would be taken over {cells:,} cells, and at most "
        message += f"{MOST_FOR_QUANTILES:,} fit into memory"
        yield Problem("reduce.quantiles", message, "Reduce over fewer axes, or request shares")


def _regimes(reduction: Reduction, plan: Plan) -> Iterator[Problem]:
    # Conditions on regimes that no cell of the study can have.
    regimes_of_verdict = {verdict.name: verdict.regimes for verdict in plan.verdicts}
    for share, conditions in reduction.shares.items():
        for number, condition in enumerate(conditions):
            regimes = regimes_of_verdict.get(condition.name, ())
            if condition.is_regime and condition.value not in regimes:
                message = f"{condition.name} is never '{condition.value}' in this study"
                possible = ", ".join(regimes or regimes_of_verdict)
                fix = f"Possible values: {possible}" if regimes else f"Choose one of {possible}"
                yield Problem(f"reduce.shares.{share}.{number}", message, fix)


def _levels(reduction: Reduction, plan: Plan, grid: Grid) -> Iterator[Problem]:
    depends = plan.depends_on(grid.along)
    for name, level in reduction.levels.items():
        axes = depends.get(level.output, (level.along,))
        if level.along not in axes:
            message = f"{level.output} does not depend on {level.along}"
            yield Problem(f"reduce.levels.{name}.along", message, "Remove this level")
