"""Cutting a sweep: one output over a few free axes, all others fixed at one of their values."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.dataset.table import (
    Table,
    TableVariable,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.errors import LimitError, Problem, raise_any
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.grid import Grid, from_si
from vibrafeed.core.plan.labels import link_to_verdict
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES, REGIMES, by_letters, letter_of
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.study.units import UnitError, problem, read_number
from vibrafeed.core.study.values import DESIGN, position_on_axis
from vibrafeed.core.suggestions import Suggestions
from vibrafeed.core.sweep.kind import attributes_of

MAX_AXES = 2  # free axes: a picture has no more


@dataclass(frozen=True)
class SliceCut:
    """A slice that can be taken: nothing of it is computed yet.

    Attributes
    ----------
    output : str
        The output.
    plan : Plan
        The equations that it needs.
    grid : Grid
        The points of the slice; its axes are free.
    """

    output: str
    plan: Plan
    grid: Grid


def prepare_cut(
    sweep: Prepared, *, output: str, axes: Sequence[str], at: Mapping[str, str], most: int
) -> SliceCut:
    """Return the slice of a sweep that a request names, checked and planned but not computed.

    Parameters
    ----------
    output : str
        The output to show.
    axes : sequence of str
        The one or two axes that stay.
    at : mapping of str to str
        Values of the other axes, as a user writes them.
    most : int
        The largest number of values.

    Raises
    ------
    StudyError, LimitError
        With every problem of the names; if the slice has more values.
    """
    axes = [*map(letter_of, axes)]
    at, problems_of_repeats = by_letters(at)
    problems = [*problems_of_repeats, *_problems(sweep, output, axes, at)]
    raise_any(problems)
    full_grid = sweep.grid
    plan = _plan_of(sweep, output)
    axes_used = {axis for name, axis in full_grid.along.items() if name in plan.parameters}
    free_axes = [name for name in dict.fromkeys(axes) if name in axes_used]
    problems = []
    box = {name: (0, full_grid.shape[name]) for name in free_axes}
    for name in full_grid.dims(axes_used - {*free_axes}):
        try:
            position = _position_of(full_grid, name, at)
            box[name] = (position, position + 1)
        except UnitError as error:
            problems.append(problem(name, error))
    raise_any(problems)
    sliced = full_grid.within(box)
    fixed = {
        name: float(sliced.values_of(name).array()[0])
        for name, axis in full_grid.along.items()
        if name in plan.parameters and axis not in free_axes
    }
    grid = Grid(
        {name: full_grid.axes[name] for name in free_axes},
        {
            **{name: value for name, value in full_grid.fixed.items() if name in plan.parameters},
            **fixed,
        },
        paired=full_grid.paired if DESIGN in free_axes else {},
    )
    if grid.cells > most:
        raise LimitError(
            "values",
            grid.cells,
            most,
            "Choose fewer free axes (axes=...), or download the sweep as NetCDF",
        )
    return SliceCut(output, plan, grid)


def compute_slice(prepared: SliceCut, threads: int | None = None) -> dict[str, Any]:
    """Compute a slice; return its values, axes, fixed parameters and regimes as a document.

    `threads` is the number of threads among which its cells are shared out; one a core if None.
    """
    output, plan, grid = prepared.output, prepared.plan, prepared.grid
    arrays = evaluate(plan, grid, threads=threads)
    depends = plan.depends_on(grid.along)
    verdict = plan.verdict_names[0]
    values = arrays[output] if output == verdict else from_si(output, arrays[output])
    return {
        "output": output,
        "unit": QUANTITIES[REGIME if output == verdict else output].unit,
        "judged": plan.verdict_on(output) is not None,
        "axes": [
            {"name": name, "unit": QUANTITIES[name].unit, "values": grid.coordinate(name)}
            for name in grid.axes
        ],
        "fixed": grid.fixed,
        "values": _labelled(values, grid.dims(depends[output])),
        "regime": _labelled(arrays[verdict], grid.dims(depends[verdict])),
        "regimes": {
            name: {
                "value": REGIMES[name].value,
                "valid": REGIMES[name].valid,
                "description": REGIMES[name].description,
            }
            for name in plan.regimes
        },
    }


def table_of(sweep: Prepared, piece: Mapping[str, Any]) -> Table:
    """Return a slice of a sweep as a table with the sweep's attributes, to write a file.

    `piece` is the document that `cut` returns: axes, fixed parameters, values of an output,
    regimes.
    """
    output = piece["output"]
    plan = _plan_of(sweep, output)
    axes = {axis["name"]: (axis["values"], (axis["name"],)) for axis in piece["axes"]}
    fixed = {name: (np.float64(value), ()) for name, value in piece["fixed"].items()}
    coordinates = {
        name: TableVariable(dims, np.asarray(values), quantity_attributes(name))
        for name, (values, dims) in (axes | fixed).items()
    }
    verdict = plan.verdicts[0]
    judged_outputs = verdict.outputs if verdict.name != REGIME else ()
    data_and_attributes = {
        verdict.name: (piece["regime"], regime_attributes(verdict.regimes, judged_outputs))
    }
    if output != verdict.name:
        attributes = quantity_attributes(output, **link_to_verdict(plan, output))
        data_and_attributes = {output: (piece["values"], attributes), **data_and_attributes}
    variables = {
        name: TableVariable(tuple(data["dims"]), data["data"], attributes)
        for name, (data, attributes) in data_and_attributes.items()
    }
    return Table(coordinates, variables, attributes_of(sweep))


def _plan_of(sweep: Prepared, output: str) -> Plan:
    """Return the plan of an output with the verdict on it alone, or of a verdict of the sweep."""
    plan = sweep.plan
    return plan.part((output,)) if output in plan.verdict_names else plan.only(output)


def _problems(
    sweep: Prepared, output: str, axes: Sequence[str], at: Mapping[str, str]
) -> Iterator[Problem]:
    """Yield the problems of the names in a request for a slice of a sweep.

    `output` and `axes` are to be shown; `at` has values of the other axes by name, as a user writes
    them.
    """
    axes_of_sweep, suggestions = sweep.grid.axes, Suggestions()
    outputs = (*sweep.plan.outputs, *sweep.plan.verdict_names)
    if output not in outputs:
        yield Problem(
            "output", f"'{output}' is not an output of this sweep", suggestions(output, outputs)
        )
    if not 1 <= len(axes) <= MAX_AXES:
        yield Problem(
            "axes",
            f"axes has {len(axes)} names, but a slice has one or two free axes",
            "Give one or two names, as in axes=beta,alpha",
        )
    for name in axes:
        if name not in axes_of_sweep:
            yield Problem(
                "axes", f"'{name}' is not an axis of this sweep", suggestions(name, axes_of_sweep)
            )
    if len(set(axes)) < len(axes):
        yield Problem("axes", "axes has the same name twice", "Give each axis once")
    for name in at:
        if name not in axes_of_sweep:
            yield Problem(
                name, f"'{name}' is not an axis of this sweep", suggestions(name, axes_of_sweep)
            )
        elif name in axes:
            yield Problem(
                name,
                f"{name} is given twice: as a free axis and with a value",
                f"Remove {name}=, or remove {name} from axes",
            )


def _position_of(grid: Grid, name: str, at: Mapping[str, str]) -> int:
    """Return the position on an axis of the value that the text `at[name]` names.

    Raises `UnitError` if the axis does not have that value, or the text is missing or no number
    with a known unit.
    """
    values = grid.coordinate(name)
    if name not in at:
        raise UnitError(
            f"the axis {name} is not free (in axes), and has no value",
            f"Add {name}=VALUE to the query, from {values[0]:g} to {values[-1]:g}"
            f"{QUANTITIES[name].suffix}",
        )
    return position_on_axis(name, values, read_number(name, QUANTITIES[name], at[name]))


def _labelled(values: Any, dims: tuple[str, ...]) -> dict[str, Any]:
    return {"dims": list(dims), "data": np.ascontiguousarray(values)}
