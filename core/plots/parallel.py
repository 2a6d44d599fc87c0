"""Parallel coordinates: a line a design through all its parameters, coloured by an output."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import is_valid
from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.parts import padded
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.selection import held_fixed, outputs_of, study_of
from vibrafeed.core.plots.sliced import check_result
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import in_brackets, long_name, number, scaled, shown_in
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.suggestions import suggestion

MAX_DESIGNS = 1000  # lines; of more designs some are chosen by chance
MAX_COLUMNS = 10  # axes of the picture
SPREAD = 0.3  # of the distance of two values of an axis: how far lines are spread about each
FEW = 40  # values of an axis up to which lines are spread
TICKS = 5  # of an axis, roughly
FRONT = "front"
LETTERS = 72  # of the names above all columns, side by side
OPACITY = {100: 0.9, 300: 0.6, 1000: 0.4}
"""Opacity of a line, by the largest number of lines for which it holds."""
WEAK = 0.35
"""Share of that opacity for the smallest output, so that large ones stand out."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ParallelColumn:
    """One axis of the picture: its name, and the value of each design."""

    name: str
    unit: str
    values: Array
    low: float
    high: float
    spread: float = 0.0

    def shares(self, values: Array) -> Array:
        """Return values as heights between 0 and 1 on the axis."""
        return (values - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Designs:
    """The columns of a dataset that are drawn, the output last, and the best design's position."""

    columns: tuple[ParallelColumn, ...]
    best: int
    best_is: str
    total: int


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """Return False: this picture is drawn on request only."""
    return False


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of all designs of a dataset, each a line through parallel axes.

    Axes are the parameters with several values, optimised variables, further outputs that the study
    asks for, and last the output by which lines are coloured. Of more than 1,000 designs, 1,000 are
    drawn by chance, the best one among them.

    Raises
    ------
    PlotError
        If there is no such output, or if fewer than two designs have a value.
    """
    check_result(dataset)
    style, units, held = options.style, options.units, options.at
    places = fixed_positions(
        dataset, held, [n for n in held if n in dataset.dims], (), nearest=options.nearest
    )
    dataset = dataset.isel(places)
    designs = read_designs(dataset, units, options.variable)
    figure = style.sheet()
    sheet = figure.add_subplot()
    _draw_lines(sheet, designs, style)
    _draw_columns(sheet, designs, style)
    shown = designs.columns[0].values.size
    note = f"{shown:,} of {designs.total:,} designs, by chance, and the best one."
    if shown == designs.total:
        note = f"All {shown:,} designs."
    if any(column.spread for column in designs.columns):
        note += " Lines are spread about the values of the axes."
    last = designs.columns[-1]
    entries = [
        Line2D([], [], color=style.accent, linewidth=3.0, label=designs.best_is),
        Line2D([], [], color=style.single_sign(0.95), linewidth=2.0, label=f"large {last.name}"),
        Line2D([], [], color=style.single_sign(0.35), linewidth=2.0, label=f"small {last.name}"),
    ]
    finish(
        figure, sheet, style, name=options.title or f"Designs by {last.name}",
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip
    for spine in sheet.spines.values():
        spine.set_visible(False)
    return figure


def read_designs(dataset: xarray.Dataset, units: ShownUnits, variable: str | None) -> Designs:
    """Return the designs of a dataset as the lines of a picture: a value on each of its axes.

    A design is a cell of the dataset; its parameters are the axes and an output the last one.
    Designs without a valid value are left out, and of many some are taken at random, the best one
    always. `variable` is the output that ranks them, by default that of the study; `units` are
    those that the reader wants. Raises `PlotError` if fewer than two designs are left.
    """
    study = study_of(dataset)
    criterion = study.get("criterion") or {}
    output = _output(dataset, study, variable)
    dims = [str(d) for d in dataset.dims if dataset.sizes[d] > 1 and d in dataset.coords]
    axes = [name for name in dims if name != FRONT]
    names = _names(dataset, study, axes, output)

    def at_all(name: str) -> NDArray[Any]:
        """Return the values of a variable for all designs, shape (designs,)."""
        return _at_all(dataset[name], dims, tuple(dataset.sizes[dim] for dim in dims))

    values = np.asarray(at_all(output), dtype=float)
    good = np.isfinite(values) & _valid(dataset, at_all)
    designs = np.flatnonzero(good)
    if designs.size < 2:
        message = f"{output} holds in {designs.size} designs, lines need two"
        raise PlotError("dataset", message, "Draw another output")
    least = criterion.get("kind") == "minimise" and output == criterion.get("output")
    knees = designs[at_all("knee")[designs] == 1] if "knee" in dataset else designs[:0]
    best, best_is = _best(values, designs, knees, in_sentence(long_name(dataset[output])), least)
    if designs.size > MAX_DESIGNS:
        designs = np.random.default_rng(0).choice(designs, MAX_DESIGNS, replace=False)
        designs[0] = best if best not in designs else designs[0]
    designs = designs[np.argsort(values[designs], kind="stable")]
    if least:
        designs = designs[::-1]  # the best ones lie above
    columns = [
        _column(dataset[name], np.asarray(at_all(name), dtype=float)[designs], units, name in axes)
        for name in [*names, output]
    ]
    return Designs(
        columns=tuple(columns),
        best=int(np.flatnonzero(designs == best)[0]),
        best_is=best_is,
        total=int(good.sum()),
    )


def _best(
    values: Array, designs: NDArray[np.intp], knees: NDArray[np.intp], name: str, least: bool
) -> tuple[int, str]:
    """Return the index of the best design, and a text that says in what it is best.

    Parameters
    ----------
    values : ndarray, shape (designs,)
        The output of all designs.
    designs, knees : ndarray of int
        Indices of the valid designs, and of those at knees of fronts, which are preferred.
    name : str
        Name of the output.
    least : bool
        True if the smallest value is the best.
    """
    choice = knees if knees.size else designs
    best = int(choice[(np.argmin if least else np.argmax)(values[choice])])
    if knees.size == 1:
        return best, "knee of the front"
    of = "of the knees: " if knees.size else ""
    return best, f"{of}{'least' if least else 'largest'} {name}"


def _output(dataset: xarray.Dataset, study: Mapping[str, Any], variable: str | None) -> str:
    """Return the output by which the lines of designs are coloured, the name of a variable.

    It is `variable` if the user asks for one, else that of the study's criterion, else the study's
    first output; ``"objective"`` if the dataset does not have it. `study` is the study as plain
    data. Raises `PlotError` if `variable` is unknown.
    """
    outputs = outputs_of(dataset)
    if variable is not None and variable not in outputs:
        raise PlotError("variable", f"'{variable[:40]}' is unknown", suggestion(variable, outputs))
    criterion = study.get("criterion") or {}
    asked = [name for name in study.get("outputs") or () if name in outputs]
    output = variable or str(criterion.get("output") or (asked or outputs)[0])
    return output if output in outputs else "objective"


def _names(
    dataset: xarray.Dataset, study: Mapping[str, Any], axes: list[str], output: str
) -> list[str]:
    """Return the names of the vertical axes of a picture of designs, but for the output's.

    They are ranged parameters, optimised variables and other outputs, as far as they have more than
    one value; `axes` are the ranged parameters, `study` is the study as plain data. Raises
    `PlotError` if there is none.
    """
    outputs = outputs_of(dataset)
    chosen = [name for name in outputs if name.startswith("best_")]
    further = [(study.get("criterion") or {}).get("against"), *(study.get("outputs") or ())]
    names = [*axes, *chosen, *(name for name in further if name in outputs)]
    names = [n for n in dict.fromkeys(names) if n != output and dataset[n].size > 1]
    if not names:
        message = f"{output} has one value, there is one design only"
        raise PlotError(
            "dataset", message, "Draw a dataset in which a parameter has several values"
        )
    return names[: MAX_COLUMNS - 1]


def _at_all(array: xarray.DataArray, dims: list[str], shape: tuple[int, ...]) -> NDArray[Any]:
    """Return the values of an array for all designs in one row, shape (designs,).

    `dims` and `shape` are names and lengths of the dimensions over which designs range; the array
    is repeated along those that it lacks. Its other dimensions are taken at the middle.
    """
    middles = {d: array.sizes[d] // 2 for d in array.dims if d not in dims}
    array = array.isel(middles)
    wide = [size if d in array.dims else 1 for d, size in zip(dims, shape, strict=True)]
    ordered = array.transpose(*(d for d in dims if d in array.dims)).values.reshape(wide)
    return np.broadcast_to(ordered, shape).reshape(-1)


def _column(
    array: xarray.DataArray, values: Array, units: ShownUnits, gridded: bool
) -> ParallelColumn:
    """Return one vertical axis of a picture of designs: name, unit, limits and each design's value.

    `array` is the variable, `values` has its values at the designs. `gridded` is True for an axis
    of the dataset, on which many designs share a value: room is then left to spread them.
    """
    shown = shown_in(array, units)
    values = scaled(xarray.DataArray(values), shown.factor)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    spread = 0.0
    steps = np.unique(values)
    if gridded and 1 < steps.size <= FEW:
        spread = SPREAD * float(np.diff(steps).min())
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        low, high = padded(low, high)
    name = in_sentence(long_name(array))
    return ParallelColumn(name, shown.unit, values, low - spread, high + spread, spread)


def _draw_lines(axes: Axes, designs: Designs, style: Style) -> None:
    """Draw a line for each design through all axes, better ones above, the best one heavily.

    Lines are coloured by their height on the last axis, an output. On axes with few values they are
    spread a little at random, so that they do not hide each other. `designs` has the axes and their
    values.
    """
    random = np.random.default_rng(1)
    heights = []
    for column in designs.columns:
        values = column.values
        if column.spread:
            values = values + column.spread * random.uniform(-1.0, 1.0, values.size)
            values[designs.best] = column.values[designs.best]
        heights.append(column.shares(values))
    points = np.stack(heights, axis=1)
    count = points.shape[0]
    x = np.arange(points.shape[1], dtype=float)
    opacity = next((share for most, share in OPACITY.items() if count <= most), 0.4)
    lines = LineCollection(
        [np.column_stack([x, row]) for row in points],
        colors=[
            (*style.single_sign(0.2 + 0.8 * height)[:3], opacity * (WEAK + (1 - WEAK) * height**2))
            for height in points[:, -1]
        ],
        linewidths=style.width(0.9),
        rasterized=True,
        zorder=2,
    )
    axes.add_collection(lines)
    axes.plot(
        x, points[designs.best], color=style.accent, linewidth=style.width(3.0), marker="o",
        markersize=style.width(5), zorder=5,
        path_effects=[withStroke(linewidth=style.width(5.0), foreground=style.ground)],
    )  # fmt: skip


def _draw_columns(axes: Axes, designs: Designs, style: Style) -> None:
    """Draw the vertical axes of a picture of designs, with numbers and names.

    The value of the best design stands at each axis. `designs` has the axes with their values.
    """
    width = max(9, LETTERS // len(designs.columns))
    halo = [withStroke(linewidth=2.5, foreground=style.ground)]
    size = style.text(8.0)
    for x, column in enumerate(designs.columns):
        axes.axvline(x, 0.06 / 1.12, 1.06 / 1.12, color=style.ink, linewidth=1.0, zorder=4)
        best = float(column.values[designs.best])
        best_height = float(column.shares(np.array(best)))
        for value in _ticks(column):
            height = float(column.shares(np.array(value)))
            axes.plot([x - 0.02, x], [height] * 2, color=style.ink, lw=0.8, zorder=4)
            if abs(height - best_height) > 0.035:
                axes.text(
                    x - 0.03, height, number(value), ha="right", va="center", fontsize=size,
                    color=style.ink, path_effects=halo, zorder=6,
                )  # fmt: skip
        axes.text(
            x + 0.04, best_height, number(best, 3), ha="left", va="center", fontsize=size,
            color=style.accent, fontweight="bold", path_effects=halo, zorder=7,
        )  # fmt: skip
    names = [
        "\n".join(filter(None, [*_wrapped(column.name, width), in_brackets(column.unit)]))
        for column in designs.columns
    ]
    axes.set_xticks(range(len(names)), names)
    axes.tick_params(axis="x", length=0)
    axes.set(xlim=(-0.35, len(names) - 0.65), ylim=(-0.06, 1.06), yticks=[])


def _wrapped(name: str, width: int) -> list[str]:
    """Return a name in lines of a width."""
    return textwrap.wrap(name, width, break_long_words=False)


def _ticks(column: ParallelColumn) -> Sequence[float]:
    """Return the values at which a vertical axis of a picture of designs has ticks.

    Of few values on a ranged axis these are all of them.
    """
    values = np.unique(column.values)
    if column.spread and values.size <= TICKS:
        return [float(value) for value in values]
    whole = bool((values == np.round(values)).all())
    locator = MaxNLocator(TICKS, steps=[1, 2, 2.5, 5, 10], integer=whole)
    steps = locator.tick_values(column.low, column.high)
    return [float(value) for value in steps if column.low <= value <= column.high]


def _valid(dataset: xarray.Dataset, at_all: Any) -> NDArray[np.bool_]:
    """Return True for each design whose regime describes a real part, shape (designs,).

    `at_all` returns the values of a variable for all designs.
    """
    verdicts = [str(name) for name in dataset.data_vars if is_regime(str(name))]
    return np.all([is_valid(at_all(name).astype(np.int64)) for name in verdicts], axis=0)
