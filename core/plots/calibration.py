"""Pictures of a calibration: the posterior, and speeds measured and predicted."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.pictures import PlotError, is_calibration
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import axis_label, number, scaled, shown_in, with_unit
from vibrafeed.core.study.shown import ShownUnits

Array = NDArray[np.float64]
SHARES = (0.95, 0.68)  # of the posterior, that are drawn as areas
PALE, DEEP = 0.2, 0.5  # share of the curve's colour in the areas of 95 % and 68 %
MAX_TICKS = 5
MAX_NUMBERED = 40  # runs of which each has its number
SIDE = {1: (8.0, 5.6), 2: (8.0, 7.2), 3: (9.0, 8.4), 4: (10.0, 9.6)}  # inches


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is a calibration, which is drawn as its posterior."""
    return options.kind == "posterior" and is_calibration(dataset)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a calibration, by `options.kind`: posterior or speeds.

    Raises
    ------
    PlotError
        If the dataset is no result of a calibration, or the kind is none of these.
    """
    kind = str(options.kind)
    if not is_calibration(dataset):
        fix = "Draw what `vibrafeed run` wrote of a study of kind 'calibrate'"
        raise PlotError("kind", f"the dataset has no {kind}", fix)
    if kind not in KINDS:
        fix = f"Choose among {', '.join(KINDS)}"
        raise PlotError("kind", f"the result of a calibration cannot be drawn as kind {kind}", fix)
    return KINDS[kind](dataset, options.style, options.units, options.title)


def _draw_posterior(
    dataset: xarray.Dataset, style: Style, units: ShownUnits, title: str | None
) -> Figure:
    """Return the picture of a calibration's posterior: densities of unknowns and of pairs.

    The density of each unknown is on the diagonal, that of each pair below, with the regions that
    hold 95 and 68 % and a cross at each mode. `units` are those that the reader wants, `title`
    replaces the name of the picture.
    """
    names = str(dataset.attrs["unknowns"]).split()
    count = len(names)
    figure = style.sheet(*SIDE[count])
    panels = figure.subplots(count, count, squeeze=False, sharex="col")
    shown = {name: shown_in(dataset[name], units) for name in names}
    for j, below in enumerate(names):
        for k, across in enumerate(names):
            panel = panels[j, k]
            if k > j:
                panel.set_visible(False)
                continue
            x = scaled(dataset[across], shown[across].factor)
            if j == k:
                _draw_marginal(panel, dataset, across, x, shown[across].factor, style)
            else:
                y = scaled(dataset[below], shown[below].factor)
                _draw_pair(panel, x, y, _pair_density(dataset, across, below), style)
                _draw_modes(panel, dataset, (across, below), (shown[across], shown[below]), style)
                if k == 0:
                    panel.set_ylabel(axis_label(dataset[below], shown[below].unit))
                else:
                    panel.tick_params(labelleft=False)
            panel.set_xlim(x[0], x[-1])
            panel.xaxis.set_major_locator(MaxNLocator(MAX_TICKS))
            if count == 1:
                panel.set_ylabel("Density")
            if j == count - 1:
                panel.set_xlabel(axis_label(dataset[across], shown[across].unit))
    facts = [_interval(dataset, name, units) for name in names]
    entries: list[Artist] = [
        Patch(color=mix(style.ground, style.curve, depth), label=f"{100 * share:.0f} %")
        for share, depth in zip(SHARES, (PALE, DEEP), strict=True)
    ]
    entries.append(Line2D([], [], color=style.ink, lw=style.width(1.2), label="best"))
    return finish(
        figure, panels[0, 0], style, name=title or "What the runs say", facts=facts,
        source=source_of(dataset), entries=entries,
    )  # fmt: skip


def _draw_marginal(
    panel: Axes, dataset: xarray.Dataset, name: str, x: Array, factor: float, style: Style
) -> None:
    """Draw the density of one unknown of a calibration, with intervals of 95 and 68 % and modes.

    `x` are the values of the unknown in the unit of the picture, shape (n,), and `factor` leads to
    that unit from the dataset's.
    """
    density = np.asarray(dataset[f"density_{name}"].values, dtype=np.float64)
    panel.plot(x, density, color=style.curve, lw=style.width(1.8))
    for share, depth in zip((95, 68), (PALE, DEEP), strict=True):
        low, high = (float(dataset[f"{end}_{share}_{name}"]) * factor for end in ("lower", "upper"))
        fine = np.linspace(max(low, x[0]), min(high, x[-1]), 200)
        panel.fill_between(
            fine, np.interp(fine, x, density), color=mix(style.ground, style.curve, depth), lw=0
        )
    for mode in np.atleast_1d(dataset[f"mode_{name}"].values):
        panel.axvline(float(mode) * factor, color=style.ink, lw=style.width(1.2), zorder=3)
    panel.set_ylim(bottom=0.0)
    panel.set_yticks([])


def _draw_pair(panel: Axes, x: Array, y: Array, density: Array, style: Style) -> None:
    """Fill the regions of highest density that hold 95 and 68 % of two unknowns of a calibration.

    `x` and `y` are the values across and up, shape (n,) and (m,); `density` has the shape (m, n).
    """
    ordered = np.sort(density.ravel())[::-1]
    below = np.cumsum(ordered) / ordered.sum()
    levels = [float(ordered[min(np.searchsorted(below, s), below.size - 1)]) for s in SHARES]
    top = float(ordered[0])
    edges = np.array([*levels, top * 1.001])
    if np.all(np.diff(edges) > 0):
        colours = [mix(style.ground, style.curve, depth) for depth in (PALE, DEEP)]
        panel.contourf(x, y, density, levels=edges, colors=colours)
    style.add_grid(panel)


def _draw_modes(
    panel: Axes,
    dataset: xarray.Dataset,
    names: tuple[str, str],
    shown: Sequence[object],
    style: Style,
) -> None:
    """Mark the modes of a posterior, regions that explain the runs, in a picture of two unknowns.

    `names` are the unknowns across and up, `shown` the units in which they are drawn, with factors.
    """
    values = [
        np.atleast_1d(dataset[f"mode_{name}"].values) * one.factor  # type: ignore[attr-defined]
        for name, one in zip(names, shown, strict=True)
    ]
    panel.plot(*values, "+", color=style.ink, ms=style.width(9), mew=style.width(1.4), zorder=4)


def _pair_density(dataset: xarray.Dataset, across: str, below: str) -> Array:
    """Return the posterior density of two unknowns of a calibration, shape (below, across).

    It is a variable of the dataset, or the exponential of one.
    """
    for name in (f"density_{across}_{below}", f"density_{below}_{across}"):
        if name in dataset:
            return np.asarray(dataset[name].transpose(below, across).values, dtype=np.float64)
    log = dataset["log_density"].transpose(below, across)
    return np.asarray(np.exp(log.values), dtype=np.float64)


def _interval(dataset: xarray.Dataset, name: str, units: ShownUnits) -> str:
    """Return name and 95 % interval of an unknown of a calibration as a text, in readable units.

    `name` is the unknown, `units` are those that the reader wants.
    """
    ends = [dataset[f"{end}_95_{name}"] for end in ("lower", "upper")]
    shown = shown_in(xarray.concat(ends, "end", combine_attrs="override"), units)
    low, high = (number(float(end) * shown.factor, 3) for end in ends)
    label = str(dataset[name].attrs["long_name"])
    return f"{label} {low} to {with_unit(high, shown.unit)}"


def _draw_speeds(
    dataset: xarray.Dataset, style: Style, units: ShownUnits, title: str | None
) -> Figure:
    """Return the picture of predicted over measured values of the runs of a calibration.

    Each run is a point with bars: 95 % of the posterior upwards, twice the error of the measurement
    across. `units` are those that the reader wants, `title` replaces the name of the picture.
    """
    measured, factor, unit = _measured(dataset, units)
    figure = style.sheet()
    axes = figure.add_subplot()
    predicted, low, high = (
        np.asarray(dataset[name].values) * factor
        for name in ("predicted_best", "predicted_lower_95", "predicted_upper_95")
    )
    known = np.isfinite(measured) & np.isfinite(predicted)
    error = _whole_error(dataset) * factor
    axes.errorbar(
        measured[known], predicted[known], xerr=2.0 * error[known], fmt="none",
        ecolor=style.quiet, elinewidth=style.width(1.0), zorder=2,
    )  # fmt: skip
    axes.vlines(
        measured[known], low[known], high[known], color=mix(style.ground, style.curve, DEEP),
        lw=style.width(5.0), zorder=3,
    )  # fmt: skip
    axes.plot(measured[known], predicted[known], "o", color=style.curve, ms=style.width(5),
              mec=style.ground, zorder=4)  # fmt: skip
    _number(axes, measured, predicted, known, style)
    ends = [*axes.get_xlim(), *axes.get_ylim()]
    axes.axline((min(ends), min(ends)), slope=1.0, color=style.ink, lw=style.width(1.0), zorder=1)
    axes.set_xlabel(f"Measured ({unit})")
    axes.set_ylabel(f"Predicted ({unit})")
    style.add_grid(axes)
    entries: list[Artist] = [
        Line2D([], [], color=style.curve, marker="o", lw=0, label="best values"),
        Patch(color=mix(style.ground, style.curve, DEEP), label="95 % of the posterior"),
        Line2D([], [], color=style.quiet, label="twice the error, discrepancy included"),
    ]
    return finish(
        figure, axes, style, name=title or "Speeds, measured and predicted",
        facts=_facts(dataset, factor, unit), source=source_of(dataset), entries=entries,
    )  # fmt: skip


def _measured(dataset: xarray.Dataset, units: ShownUnits) -> tuple[Array, float, str]:
    """Return the measured values of a calibration's runs, the factor to their unit, and the unit.

    They are in the unit that the reader wants, shape (runs,). Raises `PlotError` if only regimes
    were observed.
    """
    array = dataset[str(dataset.attrs["output"])]
    if not np.isfinite(array.values).any():
        fix = "Draw another kind, such as posterior"
        raise PlotError(
            "kind", "this picture needs measured speeds, but the runs observed only regimes", fix
        )
    shown = shown_in(array, units)
    return scaled(array, shown.factor), shown.factor, shown.unit


def _whole_error(dataset: xarray.Dataset) -> Array:
    """Return the standard deviation of each measured run of a calibration, shape (runs,).

    It is the root of the sum of squares of measuring error, predicted spread and discrepancy of the
    model, in the unit of the dataset; what is missing counts as 0.
    """
    parts = (dataset["error"], dataset["predicted_spread"], dataset["discrepancy"])
    squares = [
        np.square(np.nan_to_num(np.asarray(part.values, dtype=np.float64))) for part in parts
    ]
    error: Array = np.sqrt(squares[0] + squares[1] + squares[2])
    return error


def _facts(dataset: xarray.Dataset, factor: float, unit: str) -> list[str]:
    """Return the lines below the title of a calibration's picture: rms of residuals, discrepancy.

    `factor` leads from the unit of the dataset to `unit`, in which they are shown.
    """
    residual = np.asarray(dataset["residual"].values) * factor
    rms = float(np.sqrt(np.nanmean(np.square(residual))))
    facts = [f"residuals {with_unit(number(rms, 3), unit)} rms"]
    size = float(dataset["discrepancy"]) * factor
    if size > 0:
        facts.append(f"discrepancy {with_unit(number(size, 2), unit)}")
    return facts


def _number(axes: Axes, x: Array, y: Array, known: NDArray[np.bool_], style: Style) -> None:
    """Write the number of each measured run beside its point, if the runs are few.

    `x` and `y` are the points of all runs, shape (runs,); `known` is True for those that are drawn.
    """
    if known.sum() > MAX_NUMBERED:
        return
    for k in np.flatnonzero(known):
        axes.annotate(
            str(k + 1), (x[k], y[k]), xytext=(4, 4), textcoords="offset points",
            fontsize=style.text(7.5), color=style.quiet,
        )  # fmt: skip


KINDS: dict[str, Callable[[xarray.Dataset, Style, ShownUnits, str | None], Figure]] = {
    "posterior": _draw_posterior,
    "speeds": _draw_speeds,
}
"""Pictures of a calibration."""
