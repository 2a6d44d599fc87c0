"""Pictures of optima: the trade-off, and the objective over both drive angles.

Best values over a swept parameter are plain lines: `draw` shows them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from core.optimise import Optimisation
from core.optimise.codes import STATUS
from core.optimise.labels import criterion_in_words
from core.optimise.prepare import prepare
from core.optimise.problem import chosen_cells
from core.optimise.run import designs_of
from core.plan.grid import from_si
from core.plots.problem import PlotError
from core.plots.text import UNITS, number, with_unit
from core.quantities import QUANTITIES
from core.study import OptimiseStudy, parse_json
from core.study.models import Pareto

SIZE = (8.0, 6.4)  # inches
POINTS = 181  # of each angle
MOST_FRONTS = 7
CURVES = ("#1f3b73", "#b04a2f", "#2f7d4f", "#7a4fa0", "#a07a1f", "#3f8f9f", "#555555")
BEST = "#c2185b"


def draw_front(dataset: xarray.Dataset) -> Figure:
    """Return the picture of a trade-off: both outputs along the front, with its knee.

    Of a dataset with several designs up to seven fronts are drawn, evenly taken.

    Raises
    ------
    PlotError
        If the dataset holds no front.
    """
    prepared = _prepared(dataset)
    criterion = prepared.problem.criterion
    if not isinstance(criterion, Pareto):
        fix = "Draw the result of a study with criterion kind 'pareto'"
        raise PlotError("dataset", "it holds no front", fix)
    figure, axes = _sheet()
    others = [name for name in dataset["regime"].dims if name != "front"]
    fronts = dataset.stack(design=others) if others else dataset.expand_dims("design")
    count = fronts.sizes["design"]
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST_FRONTS)).astype(int))
    for colour, place in zip(CURVES, chosen, strict=False):
        one = fronts.isel(design=int(place))
        across, along = np.abs(one[criterion.against].values), one[criterion.output].values
        named = ", ".join(_value(str(n), float(one[n])) for n in others)
        axes.plot(across, along, color=colour, lw=1.8, label=named or "front")
        knee = np.flatnonzero(one["knee"].values)
        axes.plot(across[knee], along[knee], "o", color=colour, ms=7, mec="white")
    axes.plot([], [], "o", color="#444444", ms=7, mec="white", label="knee")
    axes.set_xlabel(_label(criterion.against, "Absolute value of: "))
    axes.set_ylabel(_label(criterion.output))
    axes.legend(frameon=False, fontsize=9)
    return _finished(figure, dataset, criterion_in_words(prepared.problem))


def draw_landscape(dataset: xarray.Dataset, at: Mapping[str, float] | None = None) -> Figure:
    """Return the picture of the objective over two variables, with optimum and limits.

    The objective is computed again from the study that the dataset carries. What a constraint
    excludes is veiled; each constraint's edge is a line of its own.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result of a study with two variables.
    at : mapping of str to float, optional
        Values of the ranged parameters; the nearest design is shown, the first if left out.

    Raises
    ------
    PlotError
        If the study has not two variables.
    """
    prepared = _prepared(dataset)
    problem = prepared.problem
    if len(problem.names) != 2:
        message = f"the study has {len(problem.names)} variables, a landscape needs 2"
        raise PlotError("dataset", message, "Draw best values as lines instead")
    place = _place(dataset, prepared, at or {})
    flat = np.ravel_multi_index(tuple(place.values()), tuple(prepared.designs.shape.values()))
    cell = int(flat) if place else 0
    design = chosen_cells(designs_of(problem, prepared.designs), slice(cell, cell + 1))
    shares = np.linspace(0.0, 1.0, POINTS)
    up, across = (
        problem.lower[i] + (problem.upper[i] - problem.lower[i]) * shares for i in range(2)
    )
    grid = np.stack(np.broadcast_arrays(up[:, None], across[None, :]))
    known = problem.known(grid, design)

    def over(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array(np.broadcast_to(values, (POINTS, POINTS)))

    value = problem.sign * over(problem.objective(known))
    x, y = (
        np.asarray(from_si(name, part), dtype=np.float64)
        for name, part in zip((problem.names[1], problem.names[0]), (across, up), strict=True)
    )
    figure, axes = _sheet()
    filled = axes.contourf(x, y, np.ma.masked_invalid(value), levels=24, cmap="cividis")
    figure.colorbar(filled, ax=axes, pad=0.02, aspect=28).set_label(_objective_label(prepared))
    axes.contour(x, y, np.ma.masked_invalid(value), levels=12, colors="#1a1a1a", linewidths=0.5)
    for colour, kept in zip(CURVES[1:], problem.kept, strict=False):
        margin = over(problem.margin(kept, known, design))
        if margin.min() < 0 < margin.max():
            axes.contour(x, y, margin, levels=[0.0], colors=colour, linewidths=2.0)
            axes.plot([], [], color=colour, lw=2.0, label=f"edge of {kept.name.replace('_', ' ')}")
        if margin.min() < 0:
            axes.contourf(x, y, margin, levels=[margin.min(), 0.0], colors="white", alpha=0.55)
    best = dataset.isel({str(n): i for n, i in place.items()})
    if np.all(np.isin(best["optimum_status"], (STATUS["optimal"], STATUS["not_attained"]))):
        tops = [np.atleast_1d(best[f"best_{n}"].values) for n in problem.names]
        style = "-" if tops[0].size > 1 else "*"
        axes.plot(tops[1], tops[0], style, color=BEST, ms=16, mec="white", lw=3.0, clip_on=False,
                  label="front" if tops[0].size > 1 else "optimum", zorder=5)  # fmt: skip
    for name, put in ((problem.names[1], axes.set_xlabel), (problem.names[0], axes.set_ylabel)):
        put(_label(name))
    axes.legend(frameon=True, framealpha=0.9, edgecolor="none", fontsize=9, loc="upper right")
    fixed = ", ".join(_value(n, float(best[n])) for n in place)
    return _finished(figure, dataset, criterion_in_words(problem), fixed)


def _prepared(dataset: xarray.Dataset) -> Optimisation:
    text: Any = dataset.attrs.get("study", "")
    study = parse_json(text) if "optimum_status" in dataset else None
    if not isinstance(study, OptimiseStudy):
        fix = "Draw what `vibrafeed run` wrote of a study of kind 'optimise'"
        raise PlotError("dataset", "it is no optimisation", fix)
    return prepare(study)


def _place(
    dataset: xarray.Dataset, prepared: Optimisation, at: Mapping[str, float]
) -> dict[str, int]:
    """Return the position of the design on each axis."""
    for name in at:
        if name not in prepared.designs.axes:
            known = ", ".join(prepared.designs.axes) or "none"
            raise PlotError("at", f"{name} is not ranged", f"Ranged parameters: {known}")
    return {
        name: int(np.abs(dataset[name].values - at[name]).argmin()) if name in at else 0
        for name in prepared.designs.axes
    }


def _unit(name: str) -> str:
    return UNITS.get(QUANTITIES[name].unit, QUANTITIES[name].unit)


def _label(name: str, before: str = "") -> str:
    """Return the label of an axis."""
    unit = f" [{_unit(name)}]" if _unit(name) else ""
    label = QUANTITIES[name].label
    return f"{before}{label[0].lower() + label[1:] if before else label}{unit}"


def _objective_label(prepared: Optimisation) -> str:
    problem = prepared.problem
    label = _label(problem.criterion.output)
    return f"Objective: {label[0].lower()}{label[1:]}" if problem.weight else label


def _value(name: str, value: float) -> str:
    return f"{name} = {with_unit(number(value), _unit(name))}"


def _sheet() -> tuple[Figure, Any]:
    figure = Figure(figsize=SIZE, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure, figure.add_subplot()


def _finished(figure: Figure, dataset: xarray.Dataset, words: str, fixed: str = "") -> Figure:
    title = str(dataset.attrs.get("title", ""))
    figure.suptitle(title, x=0.02, ha="left", fontsize=12, fontweight="bold", wrap=True)
    origin = f"{dataset.attrs['scene']}, {dataset.attrs.get('variant', 'motion')}"
    lines = ", ".join(part for part in (words, origin, fixed) if part)
    figure.axes[0].set_title(lines, loc="left", fontsize=8.5, color="#444444")
    return figure
