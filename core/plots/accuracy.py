"""Pictures of an accuracy report: error against cost, both logarithmic."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import flags_of
from vibrafeed.core.plots.heading import finish
from vibrafeed.core.plots.style import LIGHT, Style, mix
from vibrafeed.core.plots.text import words

MARKERS = "osD^vPX*ph<"
NOTHING = 1e-18  # drawn in place of an error of 0, which a logarithmic axis cannot show
NOT_SOLVED = 10.0  # drawn in place of the error of a missing result
MAX_RATIO = 30.0  # largest ratio of formula to true velocity that is drawn
LEAST_ULPS, MAX_ULPS = 1e-2, 1e16  # drawn for no error, and for no correct digit

Values = NDArray[np.float64]


def draw_accuracy(dataset: xarray.Dataset, family: str, style: Style = LIGHT) -> Figure | None:
    """Return the picture of one family of an accuracy report, None if it has nothing to show.

    Parameters
    ----------
    dataset : xarray.Dataset
        The report, as `vibrafeed.core.assurance.accuracy` makes it or as its file is read.
    family : str
        One of its families, such as `motion`.
    style : Style
        Colours and sizes.
    """
    points = dataset.isel(point=_flag(dataset, "family") == family)
    if not points.sizes["point"]:
        return None
    return PAINTERS[family](points, str(dataset.attrs.get("title", "")), style)


def _closed_forms(points: xarray.Dataset, title: str, style: Style) -> Figure | None:
    """Draw rounding errors of closed formulas over their time, and in units of rounding.

    It is a picture of the accuracy report. `points` has one entry for each measurement, `title` is
    that of the report. Lines show half a unit in the last place of each kind of float.
    """
    figure, (left, right) = _sheet(style, 2)
    subjects, settings = _flag(points, "subject"), _flag(points, "setting")
    for number, subject in enumerate(dict.fromkeys(subjects)):
        here = points.isel(point=subjects == subject)
        cost = here["time_per_cell"].values * 1e9
        colour = style.series[number % len(style.series)]
        _line(left, cost, here["error"].values, here["error_largest"].values, colour, subject)
        whole, kappa = (
            np.clip(np.nan_to_num(here[key].values, posinf=MAX_ULPS), LEAST_ULPS, MAX_ULPS)
            for key in ("ulps", "conditioned_ulps")
        )
        right.plot(cost, whole, "o", color=colour, mfc=style.ground, ms=6)
        right.plot(cost, kappa, "o-", color=colour, ms=6, lw=1)
        right.vlines(cost, kappa, whole, color=colour, lw=1, ls=":")
    for name in dict.fromkeys(settings):
        half = float(points["unit_roundoff"].values[settings == name][0]) / 2
        left.axhline(half, color=style.quiet, lw=0.8, ls="--", zorder=1)
        # On the line, away from both ends: the cheapest and the dearest output stand there.
        left.text(0.33, half, f" half an ulp, {name} ", transform=left.get_yaxis_transform(),
                  ha="center", va="center", fontsize=style.text(8), color=style.quiet,
                  bbox={"facecolor": style.ground, "edgecolor": "none", "pad": 1},
                  zorder=1.5)  # fmt: skip
    left.set_ylabel("Error, share of the value")
    right.set_ylabel("Largest error, ulps")
    left.set_title(
        "median (mark) to largest (bar)", loc="left", fontsize=style.text(9), color=style.quiet
    )
    right.set_title(
        "open: as it is; full: over the condition number",
        loc="left",
        fontsize=style.text(9),
        color=style.quiet,
    )
    for axes in (left, right):
        axes.set_xlabel("Time of a cell (ns)")
    return _finish(figure, "Rounding of the closed forms", title, style, left, (left, right))


def _motion(points: xarray.Dataset, title: str, style: Style) -> Figure | None:
    """Draw the errors of methods of simulation over their time per cell, for sliding and hopping.

    It is a picture of the accuracy report; `points` has one entry for each measurement. None if
    there is none. `title` is that of the report.
    """
    subjects, methods = _flag(points, "subject"), _flag(points, "method")
    panels = [s for s in ("sliding_cells", "hopping_cells") if s in subjects]
    if not panels:
        return None
    figure, sheets = _sheet(style, len(panels))
    named = list(dict.fromkeys(methods))
    for axes, subject in zip(sheets, panels, strict=True):
        for method in named:
            both = "sliding_and_hopping_cells"
            here = points.isel(point=(methods == method) & np.isin(subjects, [subject, both]))
            number = named.index(method)
            _line(
                axes,
                here["time_per_cell"].values * 1e3,
                here["error"].values,
                here["error_largest"].values,
                style.series[number % len(style.series)],
                method,
                MARKERS[number % len(MARKERS)],
                floor=1e-14,
            )
        floor = max(points["reference_error"].values[subjects == subject].max(), 1e-14)
        axes.axhspan(1e-14, floor, color=mix(style.ground, style.ink, 0.12), lw=0)
        axes.text(0.99, floor, "the reference's own error", ha="right", va="bottom",
                  fontsize=style.text(8), transform=axes.get_yaxis_transform(),
                  color=style.quiet)  # fmt: skip
        axes.set_yscale("log")
        axes.set_xlabel("Time of a cell (ms)")
        axes.set_title(
            f"{words(subject)}: median (mark) to largest (bar)",
            loc="left",
            fontsize=style.text(9),
            color=style.quiet,
        )
    low, high = (end(axes.get_ylim()[k] for axes in sheets) for k, end in ((0, min), (1, max)))
    for axes in sheets:
        axes.set_ylim(max(low, 1e-14), high)
    sheets[0].set_ylabel("Error of the mean velocity over A w")
    return _finish(figure, "Methods of motion", title, style, sheets[0], sheets)


def _optimisers(points: xarray.Dataset, title: str, style: Style) -> Figure | None:
    """Draw how far optimisers end from the best known objective, over time and over evaluations.

    `points` has one entry for each measurement of a method. None if there is nothing to draw.
    `title` is that of the report.
    """
    costs = {
        "Time of a design (ms)": points["time_per_cell"].values * 1e3,
        "Points at which the outputs are computed": points["evaluations"].values,
    }
    figure, sheets = _by_method(points, costs, style)
    sheets[0].set_ylabel("Gap of the objective over its scale")
    return _finish(figure, "Optimisers", title, style, sheets[0], sheets)


def _storage(points: xarray.Dataset, title: str, style: Style) -> Figure | None:
    """Draw the errors of storage formats over the size of a file and over the time of writing.

    It is a picture of the accuracy report; `points` has one entry for each measurement of a format.
    `title` is that of the report.
    """
    costs = {
        "Bytes of the file for a value": points["bytes_per_value"].values,
        "Time to write a value (ns)": points["time_per_cell"].values * 1e9,
    }
    figure, sheets = _by_method(points, costs, style)
    for axes in sheets:
        axes.set_xscale("linear")
        axes.set_xlim(0, None)
    sheets[0].set_ylabel("Error, share of the value")
    return _finish(figure, "Files", title, style, sheets[0], sheets, log_cost=False)


def _by_method(
    points: xarray.Dataset, costs: Mapping[str, Values], style: Style
) -> tuple[Figure, Sequence[Any]]:
    """Return a figure of the errors of each method over each of some costs, and its axes.

    `points` has one entry for each measurement: method, median and largest error. `costs` has by
    label the cost of each measurement, such as the time of a cell; each has its own axes.
    """
    figure, sheets = _sheet(style, len(costs))
    methods = _flag(points, "method")
    for axes, (label, cost) in zip(sheets, costs.items(), strict=True):
        for number, method in enumerate(dict.fromkeys(methods)):
            here = methods == method
            _line(
                axes, cost[here], points["error"].values[here],
                points["error_largest"].values[here],
                style.series[number % len(style.series)], method, MARKERS[number % len(MARKERS)],
            )  # fmt: skip
        axes.set_xlabel(label)
        axes.set_title(
            "median (mark) to largest (bar)", loc="left", fontsize=style.text(9), color=style.quiet
        )
    return figure, sheets


def _model(points: xarray.Dataset, title: str, style: Style) -> Figure | None:
    """Draw closed formulas over the true mean velocity, by throw number, coloured by regime.

    It is a picture of the accuracy report: how far formulas without time are from a simulated
    motion. `points` has the values by cell. None if the report has none. `title` is that of the
    report.
    """
    if "cell_true_velocity" not in points:
        return None
    true = points["cell_true_velocity"].values
    apart = ("cell_true_velocity", "cell_throw_number", "cell_regime")
    names = [str(n) for n in points.data_vars if str(n).startswith("cell_") and n not in apart]
    if not names or not true.size:
        return None
    names = names[:3]
    figure, sheets = _sheet(style, len(names))
    regimes, meanings = _flags_of(points["cell_regime"])
    throw = points["cell_throw_number"].values
    for axes, name in zip(sheets, names, strict=True):
        ratio = np.clip(points[name].values / true, -MAX_RATIO, MAX_RATIO)
        shown = [meaning for meaning in meanings if (regimes == meaning).any()]
        for number, meaning in enumerate(shown):
            here = regimes == meaning
            axes.plot(throw[here], ratio[here], MARKERS[number % len(MARKERS)], ms=style.width(4.5),
                      alpha=0.7, mew=0, color=style.series[number % len(style.series)],
                      label=words(meaning))  # fmt: skip
        axes.axhspan(0.9, 1.1, color=mix(style.ground, style.ink, 0.2), lw=0)
        axes.axhline(0.0, color=style.quiet, lw=0.8)
        axes.set_yscale("symlog", linthresh=2.0)
        axes.set_ylim(-MAX_RATIO * 1.1, MAX_RATIO * 1.1)
        axes.set_yticks([-30, -10, -3, -1, 0, 1, 3, 10, 30])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_xlabel("Throw number")
        axes.set_title(
            f"{words(name.removeprefix('cell_'))}; grey: within 10 %", loc="left", fontsize=9
        )
    sheets[0].set_ylabel("Formula over true mean velocity")
    return _finish(
        figure, "Formula over true mean velocity", title, style, sheets[0], sheets, log_cost=False
    )


PAINTERS: dict[str, Callable[[xarray.Dataset, str, Style], Figure | None]] = {
    "closed_forms": _closed_forms,
    "motion": _motion,
    "optimisers": _optimisers,
    "storage": _storage,
    "model": _model,
}
"""What draws each family."""


def _flags_of(variable: xarray.DataArray) -> tuple[NDArray[np.str_], list[str]]:
    """Return the words of a flag variable, and all words that it can have."""
    table = flags_of(variable.attrs)
    return np.array([table[value] for value in variable.values.tolist()]), list(table.values())


def _flag(dataset: xarray.Dataset, name: str) -> NDArray[np.str_]:
    """Return the words of a flag variable."""
    return _flags_of(dataset[name])[0]


def _sheet(style: Style, panels: int) -> tuple[Figure, Sequence[Any]]:
    """Return an empty figure with `panels` axes side by side, and these axes."""
    figure = style.sheet(5.0 * max(panels, 1) + 1.0, 5.6)
    sheets = figure.subplots(1, panels, squeeze=False, sharey=False)[0]
    return figure, list(sheets)


def _line(
    axes: Axes,
    cost: Values,
    median: Values,
    largest: Values,
    colour: str,
    label: str,
    marker: str = "o",
    floor: float = NOTHING,
) -> None:
    """Draw a method's errors over its cost: a mark at each median, a bar up to each largest error.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    cost, median, largest : ndarray, shape (n,)
        Cost of each measurement, its median and its largest error; missing errors are drawn as 10.
    colour, label, marker : str
        Look of the curve, and its name in the legend.
    floor : float
        Smallest error that is drawn.
    """
    low = np.clip(np.where(np.isfinite(median), median, NOT_SOLVED), floor, NOT_SOLVED)
    high = np.clip(np.where(np.isfinite(largest), largest, NOT_SOLVED), floor, NOT_SOLVED)
    axes.vlines(cost, low, high, color=colour, lw=1.2)
    axes.plot(cost, high, "_", color=colour, ms=8)
    axes.plot(cost, low, marker + "-", color=colour, ms=6.5, lw=1.4, label=words(label))


def _finish(
    figure: Figure,
    what: str,
    title: str,
    style: Style,
    first: Axes,
    sheets: Sequence[Axes],
    *,
    log_cost: bool = True,
) -> Figure:
    """Add heading, labels and legend to a figure of an accuracy report, and return it.

    Parameters
    ----------
    figure : Figure
        The figure.
    what, title : str
        Name of the picture, and title of the report.
    style : Style
        Colours and sizes.
    first : Axes
        The axes whose curves make the legend.
    sheets : sequence of Axes
        All axes.
    log_cost : bool
        True for a logarithmic axis of cost.
    """
    for axes in sheets:
        if axes.get_yscale() != "symlog":
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(_tick))
        if log_cost:
            axes.set_xscale("log")
        style.add_grid(axes)
    entries, _ = first.get_legend_handles_labels()
    note = first.get_title(loc="left")
    name = f"{what}: {title}" if title else what
    return finish(figure, first, style, name=name, source=note, entries=entries)


def _tick(value: float, _: object = None) -> str:
    """Return the label of a tick as a power of ten; the lowest tick is labelled 0: no error."""
    if value <= NOTHING * 1.01:
        return "0" if value >= NOTHING * 0.99 else ""
    return f"$10^{{{round(np.log10(value))}}}$"
