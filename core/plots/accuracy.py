"""Pictures of an accuracy report: error against cost, both logarithmic."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from core.plots.text import words

COLOURS = (
    "#1f5a8a", "#c2572b", "#3f7d3a", "#7a4f9a", "#8a6d1f", "#b0366b", "#2b8a8a", "#555555",
    "#a33c3c", "#5a8ad0", "#7d7d2b",
)  # fmt: skip
MARKERS = "osD^vPX*ph<"
NOTHING = 1e-18  # stands for no error at all
NO_ANSWER = 10.0  # stands for an answer that was not found
QUIET = "#777777"
MOST_RATIO = 30.0
LEAST_ULPS, MOST_ULPS = 1e-2, 1e16  # no error, and no digit right

Values = NDArray[np.float64]


def draw_accuracy(dataset: xarray.Dataset, family: str) -> Figure | None:
    """Return the picture of one family of an accuracy report, None if it has nothing to show.

    Parameters
    ----------
    dataset : xarray.Dataset
        The report, as `core.accuracy` makes it or as its file is read.
    family : str
        One of its families.
    """
    points = dataset.isel(point=_flag(dataset, "family") == family)
    if not points.sizes["point"]:
        return None
    return PAINTERS[family](points, str(dataset.attrs.get("title", "")))


def _closed_forms(points: xarray.Dataset, title: str) -> Figure | None:
    figure, (left, right) = _sheet("Rounding of the closed forms", title, 2)
    subjects, settings = _flag(points, "subject"), _flag(points, "setting")
    for number, subject in enumerate(dict.fromkeys(subjects)):
        here = points.isel(point=subjects == subject)
        cost = here["time_per_cell"].values * 1e9
        colour = COLOURS[number % len(COLOURS)]
        _line(left, cost, here["error"].values, here["error_largest"].values, colour, subject)
        whole, kappa = (
            np.clip(np.nan_to_num(here[key].values, posinf=MOST_ULPS), LEAST_ULPS, MOST_ULPS)
            for key in ("ulps", "conditioned_ulps")
        )
        right.plot(cost, whole, "o", color=colour, mfc="white", ms=6)
        right.plot(cost, kappa, "o-", color=colour, ms=6, lw=1)
        right.vlines(cost, kappa, whole, color=colour, lw=1, ls=":")
    for name in dict.fromkeys(settings):
        half = float(points["unit_roundoff"].values[settings == name][0]) / 2
        left.axhline(half, color=QUIET, lw=0.8, ls="--", zorder=1)
        # On the line, away from both ends: the cheapest and the dearest output stand there.
        left.text(0.33, half, f" half an ulp, {name} ", transform=left.get_yaxis_transform(),
                  ha="center", va="center", fontsize=8, color=QUIET,
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 1},
                  zorder=1.5)  # fmt: skip
    left.set_ylabel("Error, share of the value")
    right.set_ylabel("Largest error, ulps")
    left.set_title("median (mark) to largest (bar)", loc="left", fontsize=9)
    right.set_title("open: as it is; full: over the condition number", loc="left", fontsize=9)
    for axes in (left, right):
        axes.set_xlabel("Time of a cell [ns]")
    _finish(figure, left, (left, right))
    return figure


def _motion(points: xarray.Dataset, title: str) -> Figure | None:
    subjects, methods = _flag(points, "subject"), _flag(points, "method")
    panels = [s for s in ("sliding_cells", "hopping_cells") if s in subjects]
    if not panels:
        return None
    figure, sheets = _sheet("Methods of motion", title, len(panels))
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
                COLOURS[number % len(COLOURS)],
                method,
                MARKERS[number % len(MARKERS)],
                floor=1e-14,
            )
        floor = max(points["reference_error"].values[subjects == subject].max(), 1e-14)
        axes.axhspan(1e-14, floor, color="#dddddd", alpha=0.6, lw=0)
        axes.text(0.99, floor, "the reference's own error", ha="right", va="bottom",
                  fontsize=8, transform=axes.get_yaxis_transform(), color=QUIET)  # fmt: skip
        axes.set_yscale("log")
        axes.set_xlabel("Time of a cell [ms]")
        axes.set_title(f"{words(subject)}: median (mark) to largest (bar)", loc="left", fontsize=9)
    low, high = (end(axes.get_ylim()[k] for axes in sheets) for k, end in ((0, min), (1, max)))
    for axes in sheets:
        axes.set_ylim(max(low, 1e-14), high)
    sheets[0].set_ylabel("Error of the mean velocity over A w")
    _finish(figure, sheets[0], sheets)
    return figure


def _optimisers(points: xarray.Dataset, title: str) -> Figure | None:
    figure, sheets = _sheet("Optimisers", title, 2)
    methods = _flag(points, "method")
    costs = (points["time_per_cell"].values * 1e3, points["evaluations"].values)
    labels = ("Time of a design [ms]", "Points at which the outputs are computed")
    for axes, cost, label in zip(sheets, costs, labels, strict=True):
        for number, method in enumerate(methods):
            here = methods == method
            _line(
                axes, cost[here], points["error"].values[here],
                points["error_largest"].values[here],
                COLOURS[number % len(COLOURS)], method, MARKERS[number % len(MARKERS)],
            )  # fmt: skip
        axes.set_xlabel(label)
        axes.set_title("median (mark) to largest (bar)", loc="left", fontsize=9)
    sheets[0].set_ylabel("Gap of the objective over its scale")
    _finish(figure, sheets[0], sheets)
    return figure


def _storage(points: xarray.Dataset, title: str) -> Figure | None:
    figure, sheets = _sheet("Files", title, 2)
    methods = _flag(points, "method")
    costs = (points["bytes_per_value"].values, points["time_per_cell"].values * 1e9)
    labels = ("Bytes of the file for a value", "Time to write a value [ns]")
    for axes, cost, label in zip(sheets, costs, labels, strict=True):
        for number, method in enumerate(dict.fromkeys(methods)):
            here = methods == method
            _line(
                axes, cost[here], points["error"].values[here],
                points["error_largest"].values[here],
                COLOURS[number], method, MARKERS[number],
            )  # fmt: skip
        axes.set_xscale("linear")
        axes.set_xlim(0, None)
        axes.set_xlabel(label)
        axes.set_title("median (mark) to largest (bar)", loc="left", fontsize=9)
    sheets[0].set_ylabel("Error, share of the value")
    _finish(figure, sheets[0], sheets, log_cost=False)
    return figure


def _model(points: xarray.Dataset, title: str) -> Figure | None:
    if "cell_true_velocity" not in points:
        return None
    true = points["cell_true_velocity"].values
    apart = ("cell_true_velocity", "cell_throw_number", "cell_regime")
    names = [str(n) for n in points.data_vars if str(n).startswith("cell_") and n not in apart]
    if not names or not true.size:
        return None
    names = names[:3]
    figure, sheets = _sheet("Formula over true mean velocity", title, len(names))
    regimes, meanings = _flags_of(points["cell_regime"])
    throw = points["cell_throw_number"].values
    for axes, name in zip(sheets, names, strict=True):
        ratio = np.clip(points[name].values / true, -MOST_RATIO, MOST_RATIO)
        shown = [meaning for meaning in meanings if (regimes == meaning).any()]
        for number, meaning in enumerate(shown):
            here = regimes == meaning
            axes.plot(throw[here], ratio[here], ".", ms=3, alpha=0.6, color=COLOURS[number],
                      label=words(meaning))  # fmt: skip
        axes.axhspan(0.9, 1.1, color="#000000", alpha=0.15, lw=0)
        axes.axhline(0.0, color=QUIET, lw=0.8)
        axes.set_yscale("symlog", linthresh=2.0)
        axes.set_ylim(-MOST_RATIO * 1.1, MOST_RATIO * 1.1)
        axes.set_yticks([-30, -10, -3, -1, 0, 1, 3, 10, 30])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_xlabel("Throw number")
        axes.set_title(
            f"{words(name.removeprefix('cell_'))}; grey: within 10 %", loc="left", fontsize=9
        )
    sheets[0].set_ylabel("Formula over true mean velocity")
    _finish(figure, sheets[0], sheets, log_cost=False)
    return figure


PAINTERS: dict[str, Callable[[xarray.Dataset, str], Figure | None]] = {
    "closed_forms": _closed_forms,
    "motion": _motion,
    "optimisers": _optimisers,
    "storage": _storage,
    "model": _model,
}
"""What draws each family."""


def _flags_of(variable: xarray.DataArray) -> tuple[NDArray[np.str_], list[str]]:
    """Return the words of a flag variable, and all words that it can have."""
    meanings = str(variable.attrs["flag_meanings"]).split()
    values = np.atleast_1d(variable.attrs["flag_values"])
    table = dict(zip(values.tolist(), meanings, strict=True))
    return np.array([table[value] for value in variable.values.tolist()]), meanings


def _flag(dataset: xarray.Dataset, name: str) -> NDArray[np.str_]:
    return _flags_of(dataset[name])[0]


def _sheet(what: str, title: str, panels: int) -> tuple[Figure, Sequence[Any]]:
    figure = Figure(figsize=(5.0 * max(panels, 1) + 1.0, 5.2), layout="constrained",
                    facecolor="white")  # fmt: skip
    FigureCanvasAgg(figure)
    sheets = figure.subplots(1, panels, squeeze=False, sharey=False)[0]
    figure.suptitle(f"{what}\n{title}" if title else what, x=0.02, ha="left", fontsize=11,
                    fontweight="bold", wrap=True)  # fmt: skip
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
    """Draw a curve: a mark at each median, a stroke up to each largest error."""
    low = np.clip(np.where(np.isfinite(median), median, NO_ANSWER), floor, NO_ANSWER)
    high = np.clip(np.where(np.isfinite(largest), largest, NO_ANSWER), floor, NO_ANSWER)
    axes.vlines(cost, low, high, color=colour, lw=1.0)
    axes.plot(cost, high, "_", color=colour, ms=7)
    axes.plot(cost, low, marker + "-", color=colour, ms=5, lw=1.2, label=words(label))


def _finish(figure: Figure, first: Axes, sheets: Sequence[Axes], *, log_cost: bool = True) -> None:
    for axes in sheets:
        if axes.get_yscale() != "symlog":
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(_tick))
        if log_cost:
            axes.set_xscale("log")
        axes.grid(visible=True, color="#000000", alpha=0.12, linewidth=0.6)
        axes.set_axisbelow(True)
    handles, labels = first.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=min(5, len(labels) or 1),
                  frameon=False, fontsize=9)  # fmt: skip


def _tick(value: float, _: object = None) -> str:
    """Return the label of a tick; the lowest stands for no error."""
    if value <= NOTHING * 1.01:
        return "0" if value >= NOTHING * 0.99 else ""
    return f"$10^{{{round(np.log10(value))}}}$"
