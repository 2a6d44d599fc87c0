"""Pictures of measurements: the drive of a recording, error over run time of a report."""

from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibrafeed.core.dataset.table import flags_of
from vibrafeed.core.measured.fit import Fit
from vibrafeed.core.plots.parts import finish
from vibrafeed.core.plots.style import LIGHT, Style, words

AXES = ("along", "across", "normal")  # in the order of the colours of a series
MAX_POINTS = 3000  # of one axis; more hide one another
FINE = 721  # points of a smooth curve
UNITS = "m", "m/s", "m/s²"  # of displacements, velocities and accelerations


def draw_fit(fit: Fit) -> Figure:
    """Return the picture of a drive that was fitted to a recording of accelerations.

    On the left are the samples of one period with the fitted drive, axis by axis, and the residual;
    on the right the spectrum, in which dots mark the fitted harmonics, and the path of the track.
    """
    style = LIGHT
    figure = style.sheet(10.0, 7.0)
    left_half, right_half = figure.subfigures(1, 2, width_ratios=(1.25, 1.0), squeeze=False)[0]
    count = len(fit.axes)
    periods = left_half.subplots(count + 1, 1, sharex=True, height_ratios=(*(1.0,) * count, 0.8))
    _draw_period(periods, fit, style)
    spectrum, path = right_half.subplots(2, 1, height_ratios=(1.0, 1.2))
    _draw_spectrum(spectrum, fit, style)
    _draw_path(path, fit, style)
    for axes in (*periods, spectrum, path):
        style.add_grid(axes)
    for part in (left_half, right_half):
        part.set_facecolor(style.ground)
    left_half.align_ylabels(periods)
    facts, source = _facts(fit)
    return finish(
        figure, periods[0], style, name="Drive of a recording", facts=facts, source=source
    )


def _facts(fit: Fit) -> tuple[list[str], str]:
    frequency = f"{fit.frequency:.8g} Hz"
    if fit.frequency_error > 1e-9 * fit.frequency:  # a smaller one is not printed
        digits = max(0, 1 - int(np.floor(np.log10(fit.frequency_error))))
        frequency = f"{fit.frequency:.{digits}f} ± {fit.frequency_error:.{digits}f} Hz"
    facts = [frequency]
    if fit.clock is not None:
        pace = "slow" if fit.clock.error > 0.0 else "fast"
        facts.append(f"clock {100 * abs(fit.clock.error):.2g} % {pace}")
    facts.append(f"{fit.periods:.0f} periods, {fit.samples:,} samples")
    unexplained, drift = (
        f"{100 * np.linalg.norm(fractions):.2g} %" for fractions in (fit.left_over, fit.drifting)
    )
    return facts, (
        f"All axes together: not explained by the fit {unexplained}, drift {drift} of the drive"
    )


def _draw_period(panels: list[Axes], fit: Fit, style: Style) -> None:
    """Draw the samples of each axis within one period, the fit, and the residuals."""
    fold = fit.fold()
    milliseconds = 1e3 / (2.0 * np.pi * fit.frequency)
    smooth = np.linspace(0.0, 2.0 * np.pi, FINE)
    curves = fit.periodic(smooth)
    thinned = slice(None, None, -(-fit.samples // MAX_POINTS))
    times = milliseconds * fold.phase[thinned]
    last, unit = panels[-1], UNITS[fit.signal.derivative]
    for panel, axis, values, curve, residual in zip(
        panels[:-1], fit.axes, fold.values, curves, fold.residual, strict=True
    ):
        colour = style.series[AXES.index(axis)]
        dots: Any = {"color": colour, "markersize": style.width(3.0), "alpha": 0.35}
        panel.plot(times, values[thinned], ".", zorder=2, **dots)
        panel.plot(milliseconds * smooth, curve, color=style.ink, linewidth=1.2, zorder=3)
        panel.set_ylabel(f"{axis.capitalize()} ({unit})")
        last.plot(times, residual[thinned], ".", **dots)
    last.axhline(0.0, color=style.ink, linewidth=0.8)
    last.set(
        ylabel=f"Residual ({unit})",
        xlabel="Time in the period (ms)",
        xlim=(0.0, 1e3 / fit.frequency),
    )


def _draw_spectrum(axes: Axes, fit: Fit, style: Style) -> None:
    """Draw the spectrum of each axis, with a dot at each fitted harmonic."""
    fold = fit.fold()
    window = np.hanning(fit.samples)
    amplitude = 2.0 * np.abs(np.fft.rfft(fold.values * window)) / window.sum()
    # k/(n dt), with n samples of the spacing dt = periods/(frequency (n - 1)).
    frequencies = (
        np.arange(amplitude.shape[1]) * fit.frequency / fit.periods * (1 - 1 / fit.samples)
    )
    shown = frequencies <= max(1.3 * fit.orders[-1], fit.orders[-1] + 1) * fit.frequency
    orders = np.array(fit.orders)
    peaks = fit.amplitudes * (2.0 * np.pi * fit.frequency * orders) ** fit.signal.derivative
    for axis, curve, row, significant in zip(
        fit.axes, amplitude, peaks, fit.significant, strict=True
    ):
        colour = style.series[AXES.index(axis)]
        axes.plot(frequencies[shown], curve[shown], color=colour, linewidth=0.7, alpha=0.8)
        axes.plot(
            fit.frequency * orders[significant], row[significant], "o", color=colour, markersize=5.0
        )
    axes.set_yscale("log")
    axes.set_ylim(bottom=max(float(np.median(amplitude[:, shown])) / 10.0, 1e-9 * peaks.max()))
    axes.set(
        xlim=(0.0, float(frequencies[shown][-1])),
        xlabel="Frequency (Hz)",
        ylabel=f"Amplitude ({UNITS[fit.signal.derivative]})",
    )
    handles = [
        Line2D([], [], color=style.series[AXES.index(axis)], label=axis) for axis in fit.axes
    ]
    handles.append(Line2D([], [], color=style.ink, marker="o", linewidth=0.0, label="fitted"))
    axes.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=len(handles),
        frameon=False,
        handlelength=1.2,
    )


def _draw_path(axes: Axes, fit: Fit, style: Style) -> None:
    """Draw the path of the track, along and normal; without both, each axis over time."""
    phase = np.linspace(0.0, 2.0 * np.pi, FINE)
    moved = dict(zip(fit.axes, 1e6 * fit.displacement(phase), strict=True))
    if "along" not in moved or "normal" not in moved:
        for axis, curve in moved.items():
            axes.plot(
                1e3 * phase / (2.0 * np.pi * fit.frequency),
                curve,
                color=style.series[AXES.index(axis)],
            )
        axes.set(xlabel="Time in the period (ms)", ylabel="Displacement (µm)")
        return
    along, normal = moved["along"], moved["normal"]
    axes.plot(along, normal, color=style.ink, linewidth=1.6)
    axes.plot(along[0], normal[0], "o", color=style.ink, markersize=5.0)
    quarter = FINE // 8
    axes.annotate(
        "",
        xy=(along[quarter + 4], normal[quarter + 4]),
        xytext=(along[quarter], normal[quarter]),
        arrowprops={"arrowstyle": "-|>", "color": style.ink, "mutation_scale": 16},
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="Along (µm); the dot is at t = 0", ylabel="Normal (µm)")


def draw_report(dataset: xarray.Dataset) -> Figure | None:
    """Return the picture of a report; None if nothing was measured.

    The dataset is the table of `vibrafeed.core.report.Report`, as it is or as its file is read.
    """
    if not np.isfinite(dataset["error"].values).any():
        return None
    figure = LIGHT.sheet(7.0, 5.6)
    axes = figure.subplots()
    for index, curve in enumerate(flags_of(dataset["curve"].attrs).values()):
        of_curve = dataset.isel(curve=index)
        seconds = of_curve["time_per_cell"].values * 1e6
        # Errors of 0 have no place on a logarithmic axis.
        low, high = (np.fmax(of_curve[name].values, 1e-18) for name in ("error", "error_largest"))
        colour, marker = (
            choices[index % len(choices)] for choices in (LIGHT.series, "osD^vPX*ph<")
        )
        axes.vlines(seconds, low, high, color=colour, lw=1.2)
        axes.plot(seconds, high, "_", color=colour, ms=8)
        axes.plot(seconds, low, f"{marker}-", color=colour, ms=6.5, lw=1.4, label=words(curve))
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="Time of a cell (us)",
        ylabel="Error: median (mark) to largest (bar)",
    )
    LIGHT.add_grid(axes)
    entries, _ = axes.get_legend_handles_labels()
    name = f"Error against run time: {dataset.attrs.get('title', '')}"
    return finish(figure, axes, LIGHT, name=name, entries=entries)
