"""The objective of an optimisation over its variables, with optimum and limits.

It is computed again from the study that a dataset carries. Best values over a swept parameter are
plain lines: `draw` shows them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import quantity_attributes
from vibrafeed.core.intake import parse_json
from vibrafeed.core.optimise import Optimisation
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.optimisation import criterion_in_words
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS, Kept, OptimisationProblem, chosen_cells
from vibrafeed.core.optimise.uncertain import BLOCK, pictured
from vibrafeed.core.plan.grid import from_si, to_si
from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, number_lines, source_of
from vibrafeed.core.plots.parts import padded, plain, scale_of
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import held_at, held_fixed
from vibrafeed.core.plots.style import RGB, Options, Style, mix
from vibrafeed.core.plots.text import axis_label, number, scaled, shown_in, with_unit, words
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study import OptimiseStudy
from vibrafeed.core.study.shown import ShownUnits

POINTS = {1: 721, 2: 181}  # points along each variable, by the number of variables
LESS, MORE = "\N{LESS-THAN OR EQUAL TO}", "\N{GREATER-THAN OR EQUAL TO}"
EXCLUDED = 0.55  # strength of the veil over what a constraint excludes
SOLVED = (STATUS["optimal"], STATUS["not_attained"])

Array = NDArray[np.float64]


class Landscape(NamedTuple):
    """The objective over one variable or two, in the units in which it is drawn.

    Attributes
    ----------
    variables : tuple of Axis
        The variables; the last is drawn across.
    labels : tuple of str
        Their labels.
    value : ndarray, shape (n,) or (n, n)
        The objective.
    margins : dict of str to ndarray
        By its words, how far each constraint is from being broken: below 0 where it is, and where
        its output has no value.
    best : ndarray, shape (variables, k)
        The optimum, or the points of a front; none where there is no answer.
    """

    variables: tuple[Array, ...]
    labels: tuple[str, ...]
    value: Array
    label: str
    margins: dict[str, Array]
    best: Array


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one optimum, and no output or axes are asked for."""
    asked = (options.variable, options.axes) != (None, None)
    return not asked and dataset["optimum_status"].size == 1


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of an objective over one or two variables, with optimum and limits.

    With one variable it is a curve, with two a filled map: those of `options.axes`, else the first
    two. Further variables are held at the optimum, or in the middle of their bounds if there is
    none. Ranged parameters are held at `options.at`, by default at their middle values.

    Raises
    ------
    PlotError
        If the dataset is no optimisation, or does not have a variable or a value that is asked for.
    """
    style, units = options.style, options.units
    prepared = prepared_of(dataset)
    problem = prepared.problem
    names = options.axes[::-1] if options.axes else problem.names[:2]  # the last is across
    if len(names) > 2 or len({*names}) < len(names) or not {*names} <= {*problem.names}:
        fix = f"Name one or two of {', '.join(problem.names)}"
        raise PlotError("axes", "a landscape is drawn over variables of the optimisation", fix)
    positions = design_positions(dataset, prepared, options)
    best = dataset.isel({str(name): position for name, position in positions.items()})
    held = _held(problem, best)
    shown = _computed(dataset, prepared, positions, units, names, held)
    figure = style.sheet()
    axes = figure.add_subplot()
    entries = (draw_curve if len(names) == 1 else _draw_plane)(axes, shown, style)
    none = "" if shown.best.size else "No choice within the bounds keeps all limits"
    others = [
        _fact(name, value, units)
        for name, value in zip(problem.names, held, strict=True)
        if name not in names
    ]
    return finish(
        figure, axes, style, name=options.title or f"Objective: {name_of(problem)}",
        facts=[*held_of(dataset, prepared, positions, units), *others],
        source=source_of(dataset, criterion_in_words(problem)),
        entries=entries, note=none,
    )  # fmt: skip


def prepared_of(dataset: xarray.Dataset) -> Optimisation:
    """Return the optimisation, checked and planned again, of which a dataset is the result.

    The study is read from the dataset's attributes.

    Raises
    ------
    PlotError
        If the dataset is not the result of an optimisation.
    """
    text: Any = dataset.attrs.get("study", "")
    study = parse_json(text) if "optimum_status" in dataset else None
    if not isinstance(study, OptimiseStudy):
        fix = "Draw what `vibrafeed run` wrote of a study of kind 'optimise'"
        raise PlotError("dataset", "the dataset is not the result of an optimisation", fix)
    return prepare(study)


def design_positions(
    dataset: xarray.Dataset, prepared: Optimisation, options: Options
) -> dict[str, int]:
    """Return the index at which each ranged parameter of an optimisation is held.

    `prepared` is the study that the dataset carries.

    Raises
    ------
    PlotError
        If `at` names another parameter, or a value that the dataset does not have.
    """
    for name in options.at:
        if name not in prepared.designs.axes:
            known = ", ".join(prepared.designs.axes) or "none"
            raise PlotError("at", f"{name} is not ranged", f"Ranged parameters: {known}")
    axes = prepared.designs.axes
    return fixed_positions(dataset, options.at, axes, (), nearest=options.nearest)


def held_of(
    dataset: xarray.Dataset, prepared: Optimisation, positions: Mapping[str, int], units: ShownUnits
) -> list[str]:
    """Return the criterion and the values of fixed and held parameters in words.

    `positions` holds the index of each ranged parameter; `units` are those for reading.
    """
    held = [held_at(dataset[name], units, position) for name, position in positions.items()]
    counted = pictured(prepared.problem)
    over = [f"over {counted.nodes:,} points"] if counted.is_sampled else []
    return [criterion_in_words(prepared.problem), *over, *held, *held_fixed(dataset, units)]


def name_of(problem: OptimisationProblem) -> str:
    """Return the name of the objective."""
    label = QUANTITIES[problem.criterion.output].label
    return f"{in_sentence(label)}{', weighted' if problem.weight else ''}"


def _limit(kept: Kept, units: ShownUnits) -> str:
    """Return the label of an optimisation's constraint for the legend, such as "throw number < 3".

    Parameters
    ----------
    kept : Kept
        The constraint: the name of an output and its bound in the unit of studies, or the name of a
        condition that the contact must meet, which has no bound.
    units : ShownUnits
        The units in which the reader wants to see values.
    """
    if kept.name not in (f"{kept.output}_lower", f"{kept.output}_upper") or kept.bound is None:
        return words(kept.name)
    shown = units.of(QUANTITIES[kept.output].unit, abs(kept.bound))
    bound = with_unit(number(shown.factor * kept.bound, 4), shown.unit)
    name = f"|{words(kept.output)}|" if kept.absolute else words(kept.output)
    return f"{name} {LESS if kept.upper else MORE} {bound}"


def _held(problem: OptimisationProblem, best: xarray.Dataset) -> Array:
    """Return the values of all variables at a single optimum, else in the middle, SI units."""
    if bool(np.all(np.isin(best["optimum_status"], SOLVED))) and "front" not in best.dims:
        chosen = {name: best[f"best_{name}"].values for name in problem.names}
        return np.array([float(to_si(name, value)) for name, value in chosen.items()])
    return (np.asarray(problem.lower) + np.asarray(problem.upper)) / 2


def _fact(name: str, value: float, units: ShownUnits) -> str:
    written = np.asarray(from_si(name, np.asarray(value)), dtype=np.float64)
    return held_at(_array(name, written), units)


def _computed(
    dataset: xarray.Dataset,
    prepared: Optimisation,
    positions: Mapping[str, int],
    units: ShownUnits,
    names: tuple[str, ...],
    held: Array,
) -> Landscape:
    """Return the objective of one design on a grid of some variables, the others held.

    Under uncertain parameters it is the worst case, mean or quantile that the optimiser used.
    `positions` holds the index of each ranged parameter, `held` a value of each variable [SI].
    """
    problem, count = prepared.problem, POINTS[len(names)]
    sides = dict(zip(problem.names, _sides(problem, count), strict=True))
    moved = dict(
        zip(names, np.meshgrid(*(sides[name] for name in names), indexing="ij"), strict=True)
    )
    grid = np.stack(
        [
            moved.get(name, np.full((count,) * len(names), value))
            for name, value in zip(problem.names, held, strict=True)
        ]
    )
    return _over(dataset, prepared, positions, units, names, grid)


def _sides(problem: OptimisationProblem, count: int) -> list[Array]:
    """Return `count` evenly spaced values between the bounds of each variable, SI units."""
    return [
        np.linspace(low, high, count)
        for low, high in zip(problem.lower, problem.upper, strict=True)
    ]


def _over(
    dataset: xarray.Dataset,
    prepared: Optimisation,
    positions: Mapping[str, int],
    units: ShownUnits,
    names: tuple[str, ...],
    grid: Array,
) -> Landscape:
    """Return the objective of one design on a grid of its variables, with constraints and optimum.

    Parameters
    ----------
    dataset, prepared : xarray.Dataset, Optimisation
        The result, and its study.
    positions : mapping of str to int
        Index of each ranged parameter: together they choose the design.
    names : tuple of str
        The variables that change along the grid's axes.
    grid : ndarray, shape (variables, n) or (variables, n, n)
        Values of all variables, in SI units.
    """
    problem = prepared.problem
    flat = np.ravel_multi_index(tuple(positions.values()), tuple(prepared.designs.shape.values()))
    cell = int(flat) if positions else 0
    design = chosen_cells(designs_of(problem, prepared.designs), slice(cell, cell + 1))

    def over(values: Array) -> Array:
        """Return values in the shape of the grid."""
        return np.array(np.broadcast_to(values, grid.shape[1:]))

    best = dataset.isel({str(name): position for name, position in positions.items()})
    solved = bool(np.all(np.isin(best["optimum_status"], SOLVED)))
    tops, scaled_values, labels = [], [], []
    for along, name in enumerate(names):
        side = np.moveaxis(grid[problem.names.index(name)], along, 0)
        side = side.reshape(len(side), -1)[:, 0]
        variable = _array(name, np.asarray(from_si(name, side), dtype=np.float64))
        unit = shown_in(variable, units)
        scaled_values.append(scaled(variable, unit.factor))
        labels.append(axis_label(variable, unit.unit))
        tops.append(unit.factor * np.atleast_1d(best[f"best_{name}"].values))
    output = problem.criterion.output
    value = _array(output, problem.sign * over(_objective(pictured(problem), grid, design)))
    unit = shown_in(value, units)
    label = axis_label(value, unit.unit)
    return Landscape(
        variables=tuple(scaled_values),
        labels=tuple(labels),
        value=scaled(value, unit.factor),
        label=label,
        margins={
            _limit(kept, units): _excluding(over(problem.safe_margin(kept, grid, design)))
            for kept in problem.kept
        },
        best=np.array(tops) if solved else np.empty((len(tops), 0)),
    )


def _objective(problem: OptimisationProblem, grid: Array, design: Mapping[str, Array]) -> Array:
    """Return the objective on a grid, shape (n, ...), in pieces that fit the memory."""
    flat = grid.reshape(len(grid), -1)
    step = BLOCK // problem.nodes
    starts = range(0, flat.shape[1], step)
    parts = [problem.counted(flat[:, start : start + step], design) for start in starts]
    shape = [min(step, flat.shape[1] - start) for start in starts]
    pieces = [np.broadcast_to(one, n) for one, n in zip(parts, shape, strict=True)]
    return np.concatenate(pieces).reshape(grid.shape[1:])


def _excluding(margin: Array) -> Array:
    """Return the margin of a constraint with NaN replaced by a negative margin.

    A point without a value then counts as excluded.
    """
    finite = margin[np.isfinite(margin)]
    return np.nan_to_num(margin, nan=min(float(finite.min(initial=0.0)), -np.finfo(float).eps))


def _draw_plane(axes: Axes, shown: Landscape, style: Style) -> list[Artist]:
    """Draw an objective over two variables as a filled map; return the entries of the legend.

    Constraints are drawn as borders with the excluded side shaded, the optimum as a star, and the
    points of a trade-off front as a line. `shown` has all values in the units of the picture.
    """
    (y, x), value = shown.variables, np.ma.masked_invalid(shown.value)
    # The scale is that of what may be chosen: what is excluded may be far larger.
    allowed = np.ones(shown.value.shape, dtype=bool)
    for margin in shown.margins.values():
        allowed &= margin >= 0
    some = np.where(allowed, shown.value, np.nan)
    scale = scale_of(some if np.isfinite(some).any() else shown.value, style)
    if scale is not None:
        filled = axes.contourf(
            x, y, value, levels=scale.levels, cmap=scale.colours, norm=scale.norm,
            extend=scale.extend if allowed.all() else "both",
        )  # fmt: skip
        figure = axes.get_figure()
        bar = figure.colorbar(  # type: ignore[union-attr]
            filled, ax=axes, pad=0.02, aspect=28,
            ticks=scale.levels[:: 2 if style.small else 1].tolist(),
        )  # fmt: skip
        bar.ax.yaxis.set_major_formatter(FuncFormatter(plain))
        bar.set_label(shown.label)
        lines = axes.contour(
            x,
            y,
            value,
            levels=scale.levels,
            colors=[style.on(scale.colour(v)) for v in scale.levels],
            linewidths=style.width(0.5),
        )
        number_lines(axes, lines, style, 8, fmt=plain, colors=[style.ink])
    # The legend shows a colour that the picture has.
    face = scale.typical(np.where(allowed, np.nan, shown.value)) if scale is not None else None
    entries = _limits(axes, shown, style, face)
    tops = shown.best
    if tops.shape[1] > 1:
        axes.plot(tops[1], tops[0], "-", color=style.accent, lw=style.width(3.0), clip_on=False,
                  zorder=5)  # fmt: skip
        entries.append(Line2D([], [], color=style.accent, lw=style.width(3.0), label="front"))
    elif tops.size:
        entries.append(_star(axes, tops[1], tops[0], style))
    axes.set_xlabel(shown.labels[1])
    axes.set_ylabel(shown.labels[0])
    return entries


def draw_curve(axes: Axes, shown: Landscape, style: Style) -> list[Artist]:
    """Draw an objective over one variable as a curve; return the entries of the legend.

    Ranges that constraints exclude are shaded, and the optimum is a star. `shown` has all values in
    the units of the picture.
    """
    (x,), value = shown.variables, shown.value
    axes.plot(x, value, color=style.curve, lw=style.width(2.0), zorder=4)
    entries: list[Artist] = []
    for name, margin in shown.margins.items():
        if margin.min() < 0:
            axes.fill_between(
                x, 0, 1, where=(margin < 0).tolist(), transform=axes.get_xaxis_transform(),
                facecolor=mix(style.quiet, style.ground, 0.75), hatch="///",
                edgecolor=mix(style.quiet, style.ground, 0.5), linewidth=0, zorder=1,
            )  # fmt: skip
            patch = Patch(facecolor=mix(style.quiet, style.ground, 0.75), hatch="///",
                          edgecolor=mix(style.quiet, style.ground, 0.5),
                          label=f"excluded by {name}")  # fmt: skip
            entries.append(patch)
    if shown.best.size:
        entries.append(_star(axes, shown.best[0], np.interp(shown.best[0], x, value), style))
    finite = value[np.isfinite(value)]
    if finite.size:
        axes.set_ylim(*padded(float(finite.min()), float(finite.max())))
    axes.set_xlim(x[0], x[-1])
    axes.set_xlabel(shown.labels[0])
    axes.set_ylabel(shown.label)
    style.add_grid(axes)
    return entries


def _limits(axes: Axes, shown: Landscape, style: Style, face: RGB | None) -> list[Artist]:
    """Shade the area that constraints exclude, and draw the border of each; return legend entries.

    `shown` has for each constraint its margin over the two variables, negative where it is broken.
    `face` is a colour of the excluded area for the legend; a default is taken if it is None.
    """
    (y, x), entries = shown.variables, list[Artist]()
    colours = (style.series[1], style.series[2], style.series[3], style.series[5])
    excluded = False
    for colour, (name, margin) in zip(colours, shown.margins.items(), strict=False):
        if margin.min() < 0 < margin.max():
            axes.contour(x, y, margin, levels=[0.0], colors=[colour], linewidths=style.width(2.2))
            label = f"edge of {name}"
            entries.append(Line2D([], [], color=colour, lw=style.width(2.2), label=label))
        if margin.min() < 0:
            excluded = True
            axes.contourf(
                x, y, margin, levels=[margin.min(), 0.0], colors=[style.ground], alpha=EXCLUDED
            )
    if excluded:
        pale = mix(style.single_sign(0.5)[:3] if face is None else face, style.ground, EXCLUDED)
        patch = Patch(facecolor=pale, edgecolor=style.quiet, label="faint: excluded")
        entries.append(patch)
    return entries


def _star(axes: Axes, x: Array, y: Array, style: Style) -> Artist:
    """Mark the optimum at (x, y) with a star; return its legend entry."""
    look = {"marker": "*", "color": style.accent, "mec": style.ground, "ls": ""}
    axes.plot(x, y, ms=style.width(17), clip_on=False, zorder=6, **look)  # type: ignore[arg-type]
    return Line2D([], [], ms=style.width(12), label="optimum", **look)  # type: ignore[arg-type]


def _array(name: str, values: Array) -> xarray.DataArray:
    """Return values of a quantity as an array with attributes."""
    dims = [f"axis_{k}" for k in range(values.ndim)]
    return xarray.DataArray(values, dims=dims, name=name, attrs=quantity_attributes(name))
