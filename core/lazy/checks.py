"""Checks of `[reduce]`: problems, each with its path in the study."""

from collections.abc import Collection, Iterator, Mapping

from vibrafeed.core.errors import Problem
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities import FLAGS
from vibrafeed.core.study.reduction import Reduction
from vibrafeed.core.study.values import Fixed, Values
from vibrafeed.core.suggestions import Suggestions


def problems_of_names(
    asked: Reduction, outputs: Collection[str], values: Mapping[str, Values]
) -> list[Problem]:
    """Return the problems of the names in a study's section `reduce`: axes, outputs, codes, shares.

    Parameters
    ----------
    asked : Reduction
        The section.
    outputs : collection of str
        The study's outputs.
    values : mapping of str to Values
        Its parameters, of which those with several values are axes.
    """
    axes = [name for name, value in values.items() if not isinstance(value, Fixed)]
    suggest = Suggestions()
    problems = [
        _no_axis(name, f"reduce.over.{k}", axes, values, suggest)
        for k, name in enumerate(asked.over)
    ]
    problems += [
        _no_output(name, f"reduce.of.{k}", outputs, suggest) for k, name in enumerate(asked.of)
    ]
    problems += _of_codes(asked, outputs)
    problems += _of_shares(asked, outputs, suggest)
    problems += _of_levels(asked, outputs, suggest)
    if not (asked.statistics or asked.quantiles or asked.regimes or asked.shares or asked.levels):
        fix = "Give statistics, quantiles, regimes, shares or levels"
        problems.append(Problem("reduce", "no statistic is requested", fix))
    if asked.of and not (asked.statistics or asked.quantiles):
        message = "outputs are given, but neither statistics nor quantiles"
        problems.append(Problem("reduce.of", message, "Leave it out"))
    return [problem for problem in problems if problem is not None]


def _of_codes(asked: Reduction, outputs: Collection[str]) -> Iterator[Problem]:
    """Yield the problems of statistics of outputs whose numbers are codes, such as a status.

    A mean of codes says nothing. `asked` is the section `reduce` of a study, `outputs` are the
    names of the study's outputs.
    """
    fix = "Ask for shares or regimes instead"
    named = [(f"reduce.of.{k}", name) for k, name in enumerate(asked.of)]
    named += [(f"reduce.levels.{key}.output", level.output) for key, level in asked.levels.items()]
    for place, name in named:
        if name in FLAGS:
            yield Problem(
                place,
                f"the output {name} has codes as values, not numbers, so statistics do not apply",
                fix,
            )
    if (asked.statistics or asked.quantiles) and not asked.of and set(outputs) <= set(FLAGS):
        yield Problem(
            "reduce", "statistics need an output of numbers, but all outputs are codes", fix
        )


def _of_shares(
    asked: Reduction, outputs: Collection[str], suggest: Suggestions
) -> Iterator[Problem | None]:
    """Yield the problems of the shares that a reduction asks for; None stands for no problem.

    A share is that of the cells that meet all its conditions, such as a velocity above a level. A
    problem is a share without conditions or a condition on an unknown output. `asked` is the
    section `reduce`, `outputs` are the study's outputs, `suggest` finds the name that was meant.
    """
    for share, conditions in asked.shares.items():
        path = f"reduce.shares.{share}"
        if not conditions:
            yield Problem(path, "it has no condition", "Give at least one")
        for k, condition in enumerate(conditions):
            if not condition.is_regime:
                yield _no_output(condition.name, f"{path}.{k}", outputs, suggest)


def _of_levels(
    asked: Reduction, outputs: Collection[str], suggest: Suggestions
) -> Iterator[Problem | None]:
    """Yield the problems of the levels that a reduction asks for; None stands for no problem.

    A level asks where along an axis an output crosses a value: the output must be one of the
    study's `outputs`, the axis one that is reduced. `asked` is the section `reduce`, `suggest`
    finds the name that was meant.
    """
    for name, level in asked.levels.items():
        path = f"reduce.levels.{name}"
        yield _no_output(level.output, f"{path}.output", outputs, suggest)
        if level.along not in asked.over:
            fix = suggest(level.along, asked.over)
            message = f"'{level.along[:60]}' is not among the axes that go (over)"
            yield Problem(f"{path}.along", message, fix)


def problems_of(asked: Reduction, plan: Plan, grid: Grid) -> list[Problem]:
    """Return the problems of a reduction that only the plan of its study can tell.

    They are regimes that no cell can have, and levels along axes that their output does not depend
    on.
    """
    return [*_regimes(asked, plan), *_levels(asked, plan, grid), *_quantiles(asked, plan, grid)]


MOST_FOR_QUANTILES = 1 << 26
"""Cells of one answer of which quantiles are taken: they are in memory together, 512 MiB."""


def _quantiles(asked: Reduction, plan: Plan, grid: Grid) -> Iterator[Problem]:
    depends = plan.depends_on(grid.axes)
    axes = set().union(*(depends[name] for name in plan.outputs if name in (asked.of or depends)))
    cells = grid.size(name for name in asked.over if name in axes)
    if asked.quantiles and cells > MOST_FOR_QUANTILES:
        message = f"quantiles need the {cells:,} cells of one answer in memory, and at most "
        message += f"{MOST_FOR_QUANTILES:,} are taken"
        yield Problem("reduce.quantiles", message, "Reduce fewer axes, or ask for shares instead")


def _regimes(asked: Reduction, plan: Plan) -> Iterator[Problem]:
    """Yield a problem for each condition of a share on a regime that no cell of the study can have.

    A share is that of the cells that meet conditions; `asked` is the section `reduce` of the study.
    """
    for share, conditions in asked.shares.items():
        for k, condition in enumerate(conditions):
            if not condition.is_regime:
                continue
            path = f"reduce.shares.{share}.{k}"
            known = next((v.regimes for v in plan.verdicts if v.name == condition.name), None)
            if known is None:
                fix = f"Name one of {', '.join(plan.verdict_names)}"
                yield Problem(path, f"the result of this study has no {condition.name}", fix)
            elif condition.value not in known:
                message = f"no cell of this study can be in the regime '{condition.value}'"
                yield Problem(path, message, f"It can be in {', '.join(known)}")


def _levels(asked: Reduction, plan: Plan, grid: Grid) -> Iterator[Problem]:
    """Yield problems of levels along axes on which their output does not depend.

    A level asks where along an axis an output crosses a value; `asked` is the section `reduce` of
    the study.
    """
    depends = plan.depends_on(grid.axes)
    for name, level in asked.levels.items():
        path = f"reduce.levels.{name}.along"
        if level.along not in grid.axes or level.output not in plan.outputs:
            continue
        if level.along not in depends[level.output]:
            message = f"{level.output} does not depend on {level.along}"
            needed = [dim for dim in grid.dims(depends[level.output]) if dim in asked.over]
            fix = f"It depends on {', '.join(needed)}" if needed else "Leave the level out"
            yield Problem(path, message, fix)
        elif grid.shape[level.along] == 1:
            yield Problem(
                path,
                f"{level.along} has only one value, so no level can be found along it",
                f"Give {level.along} two values or more",
            )


def _no_axis(
    name: str,
    path: str,
    axes: Collection[str],
    values: Mapping[str, Values],
    suggest: Suggestions,
) -> Problem | None:
    """Return the problem of a name that is no axis of the study; None if it is one.

    Parameters
    ----------
    name, path : str
        A name in the section `reduce`, and where it stands in the study, such as ``reduce.over.0``.
    axes : collection of str
        The parameters with several values.
    values : mapping of str to Values
        All parameters that the study gives.
    suggest : Suggestions
        Finds the name that was meant among those that there are.
    """
    if name in axes:
        return None
    if name in values:
        fix = f"Give {name} several values, or remove {name} here"
        return Problem(path, f"{name} has only one value, so it is not an axis", fix)
    fix = suggest(name, axes) if axes else "Give a parameter several values"
    return Problem(path, f"'{name[:60]}' is not an axis of this study", fix)


def _no_output(
    name: str, path: str, outputs: Collection[str], suggest: Suggestions
) -> Problem | None:
    """Return the problem of a name that is no output of the study; None if it is one.

    `name` stands at `path` in the section `reduce`; `outputs` are the study's outputs, `suggest`
    finds the one that was meant.
    """
    if name in outputs:
        return None
    fix = suggest(name, outputs).removesuffix("?") + "? If not, add it to outputs"
    message = f"'{name[:60]}' is not among the outputs of this study"
    if not fix.startswith("Did"):
        fix = f"Add it to outputs, or take one of them: {', '.join(outputs)}"
    return Problem(path, message, fix)
