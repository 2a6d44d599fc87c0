"""Pictures of an optimisation: the objective over its variables, and a trade-off along a front.

The objective is computed again from the study that a dataset carries.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vibrafeed.core.dataset.table import quantity_attributes
from vibrafeed.core.intake import parse_json
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.optimisation import Optimisation, criterion_in_words
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS, OptimisationProblem, OutputBound, chosen_cells
from vibrafeed.core.optimise.uncertain import BLOCK, with_fresh_nodes
from vibrafeed.core.plan.grid import from_si, to_si
from vibrafeed.core.plots.parts import (
    add_colour_bar,
    finish,
    number_lines,
    padded,
    plain,
    scale_of,
    set_log,
    source_of,
)
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import (
    FEW,
    axis_of,
    fixed_positions,
    held_at,
    held_fixed,
    thin,
)
from vibrafeed.core.plots.style import (
    RGB,
    Array,
    Options,
    Style,
    axis_label,
    long_name,
    mix,
    name_in_words,
    number,
    scaled,
    shown_in,
    with_unit,
    words,
)
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.optimise_study import OptimiseStudy, Pareto
from vibrafeed.core.study.shown import ShownUnits

POINTS = {1: 721, 2: 181}  # points along each variable, by the number of variables
EXCLUDED = 0.55  # strength of the veil over what a constraint excludes
FRONT = "front"
WIDTH, PANEL = 8.0, 4.0  # inches: of a sheet, and of each panel of more than one


class Landscape(NamedTuple):
    """The objective over one variable or two, in the units in which it is drawn.

    The last variable is drawn across. `margins` say by its words how far each constraint is from
    being broken: below 0 where it is, and where its output has no value. `best` is the optimum, or
    the points of a front, shape (variables, k), none where there is no answer.
    """

    variables: tuple[Array, ...]
    labels: tuple[str, ...]
    value: Array
    label: str
    margins: dict[str, Array]
    best: Array


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset holds a front, or one optimum, and no output or axes are asked for."""
    return not options.asks and (options.kind == "front" or dataset["optimum_status"].size == 1)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of an objective with optimum and limits, or of a trade-off front.

    With one variable it is a curve, with two a filled map: those of `options.axes`, else the first
    two. Further variables are held at the optimum, or in the middle of their bounds if there is
    none.
    """
    text: Any = dataset.attrs.get("study", "")
    study = parse_json(text) if "optimum_status" in dataset else None
    if not isinstance(study, OptimiseStudy):
        raise PlotError(
            "dataset",
            "the dataset is not the result of an optimisation",
            "Draw the result of a study of kind 'optimise'",
        )
    prepared = prepare(study)
    painter = _draw_front if options.kind == "front" else _draw_objective
    return painter(dataset, prepared, options)


def _draw_objective(dataset: xarray.Dataset, prepared: Optimisation, options: Options) -> Figure:
    """Return the picture of the objective over one or two variables."""
    problem, style, units = prepared.problem, options.style, options.units
    names = options.axes[::-1] if options.axes else problem.names[:2]  # the last is across
    if len(names) > 2 or len({*names}) < len(names) or not {*names} <= {*problem.names}:
        raise PlotError(
            "axes",
            "a landscape is drawn over variables of the optimisation",
            f"Name one or two of {', '.join(problem.names)}",
        )
    axes = prepared.designs.axes
    for name in options.at:
        if name not in axes:
            raise PlotError(
                "at",
                f"{name} has no range in this result",
                f"Parameters with a range: {', '.join(axes) or 'none'}",
            )
    positions = fixed_positions(dataset, options.at, axes, (), nearest=options.nearest)
    at_variables = _held_values(problem, dataset.isel(positions))
    landscape = _compute_landscape(dataset, prepared, positions, units, names, at_variables)
    figure = style.sheet()
    panel = figure.add_subplot()
    entries = (_draw_curve if len(names) == 1 else _draw_plane)(panel, landscape, style)
    objective_problem = with_fresh_nodes(problem)
    facts = [
        criterion_in_words(problem),
        *([f"over {objective_problem.nodes:,} points"] if objective_problem.is_sampled else []),
        *held_fixed(dataset, units, positions),
        *(
            held_at(_array(name, from_si(name, np.asarray(value))), units)
            for name, value in zip(problem.names, at_variables, strict=True)
            if name not in names
        ),
    ]
    label = in_sentence(QUANTITIES[problem.criterion.output].label)
    name = f"Objective: {label}{', weighted' if problem.weight else ''}"
    return finish(
        figure, panel, style, name=options.title or name, facts=facts,
        source=source_of(dataset, criterion_in_words(problem)), entries=entries,
        note="" if landscape.best.size else "No choice within the bounds keeps all limits",
    )  # fmt: skip


def _limit_label(kept: OutputBound, units: ShownUnits) -> str:
    """Return the label of a constraint for the legend, such as "throw number <= 3"."""
    if kept.name not in (f"{kept.output}_lower", f"{kept.output}_upper") or kept.bound is None:
        return words(kept.name)
    shown = units.of(QUANTITIES[kept.output].unit, abs(kept.bound))
    bound = with_unit(number(shown.factor * kept.bound, 4), shown.unit)
    name = f"|{words(kept.output)}|" if kept.absolute else words(kept.output)
    sign = "\N{LESS-THAN OR EQUAL TO}" if kept.upper else "\N{GREATER-THAN OR EQUAL TO}"
    return f"{name} {sign} {bound}"


def _is_solved(best: xarray.Dataset) -> bool:
    return bool(
        np.isin(
            best["optimum_status"],
            [STATUS[name] for name in ("optimal", "not_attained", "target_missed")],
        ).all()
    )


def _held_values(problem: OptimisationProblem, best: xarray.Dataset) -> Array:
    """Return the values of all variables at a single optimum, else in the middle, SI units."""
    if _is_solved(best) and FRONT not in best.dims:
        return np.array([float(to_si(name, best[f"best_{name}"].values)) for name in problem.names])
    return (np.asarray(problem.lower) + np.asarray(problem.upper)) / 2


def _compute_landscape(
    dataset: xarray.Dataset,
    prepared: Optimisation,
    positions: Mapping[str, int],
    units: ShownUnits,
    names: tuple[str, ...],
    held: Array,
) -> Landscape:
    """Return the objective of one design on a grid of some variables, the others held.

    Under uncertain parameters it is the worst case, mean or quantile that the optimiser used.
    `positions` holds the index of each ranged parameter: together they choose the design. `held`
    has a value of each variable [SI].
    """
    problem, count = prepared.problem, POINTS[len(names)]
    bounds = dict(zip(problem.names, zip(problem.lower, problem.upper, strict=True), strict=True))
    sides = [np.linspace(*bounds[name], count) for name in names]
    meshes = dict(zip(names, np.meshgrid(*sides, indexing="ij"), strict=True))
    shape = (count,) * len(names)
    grid = np.stack(
        [
            meshes.get(name, np.full(shape, value))
            for name, value in zip(problem.names, held, strict=True)
        ]
    )
    flat_position = np.ravel_multi_index(
        tuple(positions.values()), tuple(prepared.designs.shape.values())
    )
    cell = int(flat_position) if positions else 0
    design = chosen_cells(designs_of(problem, prepared.designs), slice(cell, cell + 1))

    def on_grid(values: Array) -> Array:
        return np.array(np.broadcast_to(values, shape))

    best = dataset.isel(dict(positions))
    best_values, axes, labels = [], [], []
    for name, side in zip(names, sides, strict=True):
        variable = _array(name, from_si(name, side))
        unit = shown_in(variable, units)
        axes.append(scaled(variable, unit.factor))
        labels.append(axis_label(variable, unit.unit))
        best_values.append(unit.factor * np.atleast_1d(best[f"best_{name}"].values))
    objective = _objective(with_fresh_nodes(problem), grid, design)
    value = _array(problem.criterion.output, problem.sign * on_grid(objective))
    unit = shown_in(value, units)
    return Landscape(
        variables=tuple(axes),
        labels=tuple(labels),
        value=scaled(value, unit.factor),
        label=axis_label(value, unit.unit),
        margins={
            _limit_label(kept, units): _with_nan_broken(
                on_grid(problem.safe_margin(kept, grid, design))
            )
            for kept in problem.constraints
        },
        best=np.array(best_values) if _is_solved(best) else np.empty((len(best_values), 0)),
    )


def _objective(problem: OptimisationProblem, grid: Array, design: Mapping[str, Array]) -> Array:
    """Return the objective on a grid, shape (n, ...), in pieces that fit the memory."""
    flat = grid.reshape(len(grid), -1)
    step = BLOCK // problem.nodes
    pieces = [
        np.broadcast_to(problem.objective_statistic(part, design), part.shape[1])
        for part in (flat[:, start : start + step] for start in range(0, flat.shape[1], step))
    ]
    return np.concatenate(pieces).reshape(grid.shape[1:])


def _with_nan_broken(margin: Array) -> Array:
    # A limit is broken where its output has no value.
    finite = margin[np.isfinite(margin)]
    return np.nan_to_num(margin, nan=min(float(finite.min(initial=0.0)), -np.finfo(float).eps))


def _draw_plane(axes: Axes, landscape: Landscape, style: Style) -> list[Artist]:
    """Draw an objective over two variables as a filled map; return the entries of the legend."""
    (y, x), value = landscape.variables, np.ma.masked_invalid(landscape.value)
    # The scale is that of what may be chosen: what is excluded may be far larger.
    allowed = np.ones(landscape.value.shape, dtype=bool)
    for margin in landscape.margins.values():
        allowed &= margin >= 0
    choosable = np.where(allowed, landscape.value, np.nan)
    scale = scale_of(choosable if np.isfinite(choosable).any() else landscape.value, style)
    if scale is not None:
        filled = axes.contourf(
            x, y, value, levels=scale.levels, cmap=scale.colours, norm=scale.norm,
            extend=scale.extend if allowed.all() else "both",
        )  # fmt: skip
        add_colour_bar(axes, filled, scale, landscape.label, style)
        lines = axes.contour(
            x, y, value, levels=scale.levels, linewidths=style.width(0.5),
            colors=[style.on(scale.colour(level)) for level in scale.levels],
        )  # fmt: skip
        number_lines(axes, lines, style, 8, fmt=plain, colors=[style.ink])
    # The legend shows a colour that the picture has.
    face = scale.typical(np.where(allowed, np.nan, landscape.value)) if scale is not None else None
    entries = _shade_limits(axes, landscape, style, face)
    best = landscape.best
    if best.shape[1] > 1:
        look: Any = {"color": style.accent, "lw": style.width(3.0)}
        axes.plot(best[1], best[0], "-", clip_on=False, zorder=5, **look)
        entries.append(Line2D([], [], label="front", **look))
    elif best.size:
        entries.append(_star(axes, best[1], best[0], style))
    axes.set(xlabel=landscape.labels[1], ylabel=landscape.labels[0])
    return entries


def _draw_curve(axes: Axes, landscape: Landscape, style: Style) -> list[Artist]:
    """Draw an objective over one variable as a curve; return the entries of the legend."""
    (x,), value = landscape.variables, landscape.value
    axes.plot(x, value, color=style.curve, lw=style.width(2.0), zorder=4)
    entries: list[Artist] = []
    look: Any = {
        "facecolor": mix(style.quiet, style.ground, 0.75), "hatch": "///",
        "edgecolor": mix(style.quiet, style.ground, 0.5),
    }  # fmt: skip
    for name, margin in landscape.margins.items():
        if margin.min() < 0:
            axes.fill_between(
                x, 0, 1, where=(margin < 0).tolist(), transform=axes.get_xaxis_transform(),
                linewidth=0, zorder=1, **look,
            )  # fmt: skip
            entries.append(Patch(label=f"excluded by {name}", **look))
    if landscape.best.size:
        entries.append(
            _star(axes, landscape.best[0], np.interp(landscape.best[0], x, value), style)
        )
    finite = value[np.isfinite(value)]
    if finite.size:
        axes.set_ylim(*padded(float(finite.min()), float(finite.max())))
    axes.set(xlim=(x[0], x[-1]), xlabel=landscape.labels[0], ylabel=landscape.label)
    style.add_grid(axes)
    return entries


def _shade_limits(
    axes: Axes, landscape: Landscape, style: Style, colour_below: RGB | None
) -> list[Artist]:
    """Shade the area that constraints exclude, and draw the border of each; return legend entries.

    `colour_below` is a colour under the veil, for the legend; None takes a default.
    """
    (y, x), entries = landscape.variables, list[Artist]()
    colours = (style.series[1], style.series[2], style.series[3], style.series[5])
    for colour, (name, margin) in zip(colours, landscape.margins.items(), strict=False):
        if margin.min() < 0 < margin.max():
            axes.contour(x, y, margin, levels=[0.0], colors=[colour], linewidths=style.width(2.2))
            label = f"edge of {name}"
            entries.append(Line2D([], [], color=colour, lw=style.width(2.2), label=label))
        if margin.min() < 0:
            axes.contourf(
                x, y, margin, levels=[margin.min(), 0.0], colors=[style.ground], alpha=EXCLUDED
            )
    if any(
        margin.min() < 0 for _, margin in zip(colours, landscape.margins.values(), strict=False)
    ):
        pale = mix(
            style.single_sign(0.5)[:3] if colour_below is None else colour_below,
            style.ground,
            EXCLUDED,
        )
        entries.append(Patch(facecolor=pale, edgecolor=style.quiet, label="faint: excluded"))
    return entries


def _star(axes: Axes, x: Array, y: Array, style: Style) -> Artist:
    look: Any = {"marker": "*", "color": style.accent, "mec": style.ground, "ls": ""}
    axes.plot(x, y, ms=style.width(17), clip_on=False, zorder=6, **look)
    return Line2D([], [], ms=style.width(12), label="optimum", **look)


def _array(name: str, values: Any) -> xarray.DataArray:
    numbers = np.asarray(values, dtype=np.float64)
    dims = [f"axis_{k}" for k in range(numbers.ndim)]
    return xarray.DataArray(numbers, dims=dims, name=name, attrs=quantity_attributes(name))


class Fronts(NamedTuple):
    """The trade-off fronts that are drawn, at what is held, and their other dimensions."""

    dataset: xarray.Dataset
    criterion: Pareto
    others: tuple[str, ...]
    style: Style
    units: ShownUnits

    def name(self, design: xarray.Dataset, names: Sequence[str]) -> str:
        """Return names and values of some parameters of a design, as one text."""
        parts = []
        for name in names:
            shown = shown_in(design[name], self.units)
            value = number(float(scaled(design[name], shown.factor)), 4)
            label = name_in_words(name.removeprefix("best_"))
            parts.append(f"{label} {with_unit(value, shown.unit)}")
        return ", ".join(parts)


def _draw_front(dataset: xarray.Dataset, prepared: Optimisation, options: Options) -> Figure:
    """Draw one output over the other along fronts, with the knee marked.

    Of more than seven fronts seven are drawn, evenly chosen, and a note says so. Designs in which
    one choice is best in both outputs have no front: if none has one, the picture shows that choice
    over the ranged parameters.
    """
    problem, criterion = prepared.problem, prepared.problem.criterion
    if not isinstance(criterion, Pareto):
        raise PlotError(
            "dataset",
            "the result has no trade-off front",
            "Draw the result of a study with criterion kind 'pareto'",
        )
    units, style = options.units, options.style
    ranged = [name for name in options.at if name in dataset.dims]
    positions = fixed_positions(dataset, options.at, ranged, (FRONT,), nearest=options.nearest)
    at_held = dataset.isel(positions)
    others = tuple(str(name) for name in at_held["optimum_status"].dims if name != FRONT)
    fronts = Fronts(at_held.drop_vars(positions), criterion, others, style, units)
    designs = (
        fronts.dataset.stack(design=others) if others else fronts.dataset.expand_dims("design")
    )
    first_points = designs.isel(front=0)
    has_one_point = (
        first_points["front_points"].values == 1
        if "front_points" in first_points
        else np.zeros(0, bool)
    )
    is_single = bool(has_one_point.size) and bool(has_one_point.all())
    if others and is_single:
        figure, top, entries, note = _draw_choices(fronts)
    else:
        figure = style.sheet()
        top = figure.add_subplot()
        entries, note = _draw_fronts(top, fronts, designs, has_one_point)
    name = "Trade-off along a front"
    if is_single:
        output, against = (
            in_sentence(long_name(dataset[variable]))
            for variable in (criterion.output, criterion.against)
        )
        name = f"No trade-off: {against} least where {output} is largest"
    return finish(
        figure, top, style, name=options.title or name,
        facts=[criterion_in_words(problem), *held_fixed(dataset, units, positions)],
        source=source_of(dataset, criterion_in_words(problem)), entries=entries, note=note,
    )  # fmt: skip


def _draw_fronts(
    axes: Axes, fronts: Fronts, designs: xarray.Dataset, has_one_point: np.ndarray
) -> tuple[list[Artist], str]:
    """Draw the fronts of some designs; return the entries of the legend, and a note.

    `has_one_point` is True for a design without a trade-off; such designs are left out where others
    have a front.
    """
    style, units, criterion = fronts.style, fronts.units, fronts.criterion
    count = designs.sizes["design"]
    with_front = (
        np.flatnonzero(~has_one_point)
        if has_one_point.size and not has_one_point.all()
        else np.arange(count)
    )
    chosen = with_front[thin(with_front.size, FEW)]
    against, output = fronts.dataset[criterion.against], fronts.dataset[criterion.output]
    against_unit, output_unit = shown_in(against, units), shown_in(output, units)
    entries: list[Artist] = []
    dot: Any = {"marker": "o", "ms": style.width(8), "mec": style.ground}
    for colour, design in zip(style.series_over(len(chosen)), chosen, strict=True):
        front = designs.isel(design=int(design))
        across = np.abs(scaled(front[criterion.against], against_unit.factor))
        up = scaled(front[criterion.output], output_unit.factor)
        axes.plot(across, up, color=colour, lw=style.width(1.8))
        knee = np.flatnonzero(front["knee"].values)
        axes.plot(across[knee], up[knee], ls="", color=colour, zorder=5, **dot)
        design_name = fronts.name(front, fronts.others)
        entries.append(
            Line2D([], [], color=colour, lw=style.width(1.8), label=design_name or "front")
        )
    knee_label = "knee: where the front bends most"
    if has_one_point.size and has_one_point.all():
        front = designs.isel(design=0, front=0)
        names = [str(name) for name in front.data_vars if str(name).startswith("best_")]
        knee_label = f"best in both: {fronts.name(front, names)}"
        entries.clear()
    entries.append(Line2D([], [], ls="", color=style.quiet, label=knee_label, **dot))
    if not np.isfinite(output.values).any():
        axes.annotate(
            "No choice within the bounds keeps all limits", (0.5, 0.5), xycoords="axes fraction",
            ha="center", va="center", color=style.ink, fontsize=style.text(11),
        )  # fmt: skip
    axes.set_xlabel(f"Magnitude of the {in_sentence(axis_label(against, against_unit.unit))}")
    axes.set_ylabel(axis_label(output, output_unit.unit))
    style.add_grid(axes)
    notes = [f"{len(chosen)} of {count} designs"] if len(chosen) < count else []
    if with_front.size < count:
        notes.append(f"{count - with_front.size} without a trade-off")
    return entries, ", ".join(notes)


def _draw_choices(fronts: Fronts) -> tuple[Figure, Axes, list[Artist], str]:
    """Draw the best choice of designs without a trade-off over their ranged parameters.

    Each variable has a panel over the parameter with most values; the others make a family of at
    most seven curves. Designs in which nothing moves are left out. The result are figure, uppermost
    axes, entries of the legend, and a note.
    """
    style, units = fronts.style, fronts.units
    best = fronts.dataset.isel({FRONT: 0})
    across = max(fronts.others, key=lambda name: best.sizes[name])
    others = tuple(name for name in fronts.others if name != across)
    axis = axis_of(best[across], units)
    family = best.stack(design=others) if others else best.expand_dims("design")
    count = family.sizes["design"]
    chosen = thin(count, FEW)
    curves = [family.isel(design=int(design)) for design in chosen]
    colours = style.series_over(len(chosen))
    names = [str(name) for name in best.data_vars if str(name).startswith("best_")]
    figure = style.sheet(WIDTH, 6.4 if len(names) == 1 else PANEL * len(names))
    panels = np.ravel(figure.subplots(len(names), 1, sharex=True, squeeze=False))
    for panel, name in zip(panels, names, strict=True):
        shown = shown_in(best[name], units)
        for colour, curve in zip(colours, curves, strict=True):
            values = curve[name].where(curve["optimum_status"] != STATUS["no_motion"])
            panel.plot(axis.values, scaled(values, shown.factor), "o-", color=colour,
                       lw=style.width(1.8), ms=style.width(4))  # fmt: skip
        panel.set_ylabel(axis_label(best[name], shown.unit))
        panel.yaxis.set_major_formatter(plain)
        style.add_grid(panel)
    if axis.is_log:
        set_log(panels[-1].xaxis, axis.values)
    panels[-1].set_xlabel(axis.label)
    entries: list[Artist] = [
        Line2D([], [], color=colour, lw=style.width(1.8),
               label=fronts.name(curve, others) or "best choice")
        for colour, curve in zip(colours, curves, strict=True)
    ]  # fmt: skip
    notes = [f"{len(chosen)} of {count} curves"] if len(chosen) < count else []
    if motionless := int((best["optimum_status"] == STATUS["no_motion"]).sum()):
        notes.append(f"nothing moves in {motionless} of {best['optimum_status'].size} designs")
    return figure, panels[0], entries, ", ".join(notes)
