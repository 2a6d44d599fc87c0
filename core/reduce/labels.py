"""Names and CF attributes of the variables of a reduction."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.study.reduction import LevelSet, Reduction

METHODS = {"max": "maximum", "min": "minimum", "mean": "mean"}
_WORDS = {"max": "Largest", "min": "Least", "mean": "Mean of"}


@dataclass(frozen=True)
class ReducedVariable:
    """The parts of a variable's name in a reduction: the statistic, its output, its axis.

    Attributes
    ----------
    what : str
        A statistic, or ``count``, ``quantile``, ``regime``, ``share`` or ``level``.
    of : str
        The output, regime, or name of a share or level.
    axis : str
        The axis whose values it has; empty if it has those of the output, or numbers.
    """

    what: str
    of: str
    axis: str = ""


def variable_of(name: str, asked: Reduction, outputs: Collection[str]) -> ReducedVariable:
    """Return statistic, output and axis of a variable of a reduction, read from its name.

    Names are ``share_<name>``, ``level_<name>``, ``<verdict>_<regime>_count``, or output, statistic
    and, if any, axis, such as ``conveying_velocity_mean``. `asked` is the section `reduce` of the
    study, which defines shares and levels, `outputs` are the study's outputs. Raises `KeyError` for
    other names.
    """
    for what, named in (("share", asked.shares), ("level", asked.levels)):
        rest = name.removeprefix(f"{what}_")
        if name != rest and rest in named:
            along = asked.levels[rest].along if what == "level" else ""
            return ReducedVariable(what, rest, along)
    if name.startswith("regime_") and name.endswith("_count"):
        told = (one for one in REGIMES if name.endswith(f"_{one}_count"))
        return ReducedVariable("regime", max(told, key=len))
    for output in sorted(outputs, key=len, reverse=True):
        what, _, axis = name.removeprefix(f"{output}_").partition("_")
        if name.startswith(f"{output}_") and what in ("count", "quantile", *asked.statistics):
            return ReducedVariable(what, output, axis)
    raise KeyError(name)


def unit_of(name: str, asked: Reduction, outputs: Collection[str]) -> str:
    """Return the unit of a variable of a reduced result, as files write it.

    `name` is the variable; `asked` is the section `reduce` and `outputs` are the study's outputs,
    from which its name is read. A place of an extreme has the unit of its axis, counts and shares
    have "1".
    """
    one = variable_of(name, asked, outputs)
    if one.axis:
        return QUANTITIES[one.axis].unit
    return "1" if one.what in ("count", "regime", "share") else QUANTITIES[one.of].unit


def attributes_of(
    name: str, asked: Reduction, outputs: Collection[str], *, is_exact: bool
) -> dict[str, Any]:
    """Return the attributes of a variable of a reduced result after the CF conventions.

    They are unit, long name, method of the statistic, comment, and the name of the variable that
    counts cells. `name` is the variable, `asked` the section `reduce`, `outputs` the study's
    outputs; `is_exact` is true if quantiles come from all cells, false if from a histogram.
    """
    parts = variable_of(name, asked, outputs)
    attributes: dict[str, Any] = {"units": unit_of(name, asked, outputs)}
    label = QUANTITIES[parts.of].label if parts.of in QUANTITIES else parts.of
    over = "".join(f"{axis}: " for axis in asked.over)
    if parts.what in METHODS:
        attributes["long_name"] = f"{_WORDS[parts.what]} {label.lower()}"
        attributes["cell_methods"] = over + METHODS[parts.what]
    elif parts.what in ("argmax", "argmin"):
        where = "largest" if parts.what == "argmax" else "least"
        axis = QUANTITIES[parts.axis].label
        attributes["long_name"] = f"{axis} where {label.lower()} is {where}"
        attributes["comment"] = "of equal values that of the first cell, the last axis fastest"
    elif parts.what == "quantile":
        attributes["long_name"] = f"Quantiles of {label.lower()}"
        attributes["comment"] = EXACT if is_exact else BINNED
    elif parts.what == "count":
        attributes["long_name"] = f"Cells that count for {label.lower()}"
        attributes["standard_name"] = "number_of_observations"
    elif parts.what == "regime":
        attributes["long_name"] = f"Cells in the regime {parts.of}"
        attributes["comment"] = REGIMES[parts.of].description
    elif parts.what == "share":
        attributes["long_name"] = f"Share of cells: {parts.of}"
        attributes["comment"] = " and ".join(map(str, asked.shares[parts.of]))
    else:
        level = asked.levels[parts.of]
        attributes["long_name"] = f"{QUANTITIES[parts.axis].label} of {parts.of}"
        attributes["comment"] = _crossing(level)
    counted = f"{parts.of}_count"
    if parts.what in (*METHODS, "argmax", "argmin", "quantile"):
        attributes["ancillary_variables"] = counted
    return attributes


EXACT = "exact, of all cells that count; linear between neighbouring values"
BINNED = "from a histogram whose bins are 1/512 of a value wide at most: the error is no larger"


def _crossing(level: LevelSet) -> str:
    """Return a comment on a level's variable in a file: which crossing it is, and how interpolated.

    An example is "the smallest value at which throw_number is 1".
    """
    unit = QUANTITIES[level.output].unit
    return (
        f"the {level.take} value at which {level.output} is {level.level:g}"
        f"{'' if unit == '1' else f' {unit}'}, by a straight line between neighbours that count"
    )
