"""The first page of the book of charts: how to read it, and an example worked out."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from vibrafeed import core
from vibrafeed.core.plots.book_page import (
    BETAS,
    LINES,
    Chart,
    draw_curves,
    followed,
    name_bands,
    sheet,
)
from vibrafeed.core.plots.style import LIGHT
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY

ABOUT: Final = """\
Each page is for one coefficient of friction and one angle of the track. Each curve is one angle
of the drive, β, between the vibration and the track. A is the amplitude from the middle to one
end (half the stroke), ω = 2π f, v is the mean speed of the part along the track.

Across: the throw number Γ = A ω² sin β / (g cos γ), the drive's acceleration normal to the
track over gravity's. Below 1 the part stays on the floor. From 1 to 3.30 it hops once a period.
From 3.30 it takes off where it lands; from 3.72 on its period doubles, and the charts end.

Above: v f / g, on the left on the floor, on the right with hops, on a scale of its own. It needs
no amplitude: read it, and v = (v f / g) · g / f.
Below: v / (A ω cos β), the share of the drive's own speed along the track that the part gets.

The lines say what the part does, without colours:
{lines}
The marks separate the curves. A value below 0 is a part that travels backwards or downhill.
The table beside the charts says from which Γ a part moves, and where it gets the largest share.

The curves are exact, not fitted: {steps} points each, from event to event (theory 13). They hold
for a part that does not rebound, does not tip, and meets no air. A frequency or a size does not
appear, since equal numbers move alike: the same chart serves 25 Hz and 100 Hz.
A track that is steeper than friction has no page: there a part gains speed for ever.
Static friction is kinetic friction here; the command vibrafeed lookup knows both."""


class Example(NamedTuple):
    """A part and a drive: SI units, degrees."""

    friction: float = 0.3
    beta: float = 25.0
    frequency: float = 50.0
    amplitude: float = 0.4e-3

    @property
    def throw(self) -> float:
        """The throw number on a level track."""
        acceleration = self.amplitude * (2 * np.pi * self.frequency) ** 2
        return float(acceleration * np.sin(np.deg2rad(self.beta)) / STANDARD_GRAVITY)

    @property
    def readings(self) -> tuple[float, float]:
        """The values to be read in both charts for the example: v f/g, v/(A0 w cos(beta)).

        v is the mean velocity, f the frequency, g gravity, A0 the amplitude, w = 2 pi f, and beta
        the angle of the drive.
        """
        speed, share, _ = followed(
            self.friction, 0.0, np.array([self.beta]), np.array([self.throw])
        )
        return float(speed[0, 0]), float(share[0, 0])


def draw_introduction() -> Figure:
    """Return the first page of the book of charts: how to read them, with an example."""
    figure = sheet()
    dashes = {
        "stick": "sparse dots", "stick_slip": "dashes", "slip": "dense dots",
        "hopping": "a line", "hop_after_hop": "a thick line",
    }  # fmt: skip
    lines = "\n".join(f"    {dashes[name]}: it {stroke.label}" for name, stroke in LINES.items())
    example = Example()
    chart = Chart.of(example.friction, 0.0)
    about = ABOUT.format(lines=lines, steps=chart.throw.size)
    figure.text(
        0.05, 0.93, "Charts of vibratory conveying", fontsize=20, weight="bold", va="center"
    )
    figure.text(
        0.05, 0.89, f"vibrafeed {core.__version__} · how to read them", fontsize=10,
        color=LIGHT.quiet, va="center",
    )  # fmt: skip
    figure.text(0.05, 0.85, about, fontsize=9.2, va="top", linespacing=1.45, color=LIGHT.ink)
    _draw_example(figure, chart, example)
    return figure


def _draw_example(figure: Figure, chart: Chart, example: Example) -> None:
    """Draw an example of how to read a chart: the chart with guide lines, and the steps in words.

    `chart` has the curves, `example` a drive and the two values that are read for it.
    """
    speed, share = example.readings
    axes = figure.add_axes((0.62, 0.50, 0.34, 0.36))
    draw_curves(axes, chart, chart.speed)
    top = 1.15 * float(np.nanmax(chart.speed[BETAS.index(20.0)]))
    axes.set_ylim(-0.02, top)
    axes.set_ylabel("v f / g")
    axes.set_xlabel("Γ")
    LIGHT.dress(figure)
    name_bands(axes)
    guide: dict[str, Any] = {"color": LIGHT.accent, "linewidth": 1.2, "zorder": 5}
    axes.plot([example.throw, example.throw, 0.0], [-0.02, speed, speed], **guide)
    axes.plot([example.throw], [speed], marker="o", markersize=6, markerfacecolor="none", **guide)
    axes.annotate(
        f"Γ = {example.throw:.2f}, β = {example.beta:g}°:\nv f / g = {speed:.3f}",
        (example.throw, speed), (0.15, 0.62 * top), fontsize=9, color=LIGHT.ink,
        arrowprops={"arrowstyle": "-", "color": LIGHT.quiet, "linewidth": 0.8},
    )  # fmt: skip
    velocity = speed * STANDARD_GRAVITY / example.frequency
    own = example.amplitude * 2 * np.pi * example.frequency * np.cos(np.deg2rad(example.beta))
    text = f"""\
An example, on the page "Friction {example.friction:g}, level track"

A bowl vibrates at {example.frequency:g} Hz with a stroke of {2e3 * example.amplitude:g} mm
from end to end, so A = {1e3 * example.amplitude:g} mm, at β = {example.beta:g}°.

1.  ω = 2π · {example.frequency:g} = {2 * np.pi * example.frequency:.1f} per second;  A ω² = \
{example.amplitude * (2 * np.pi * example.frequency) ** 2:.1f} m/s²
2.  Γ = {example.amplitude * (2 * np.pi * example.frequency) ** 2:.1f} · sin {example.beta:g}° / \
9.81 = {example.throw:.2f}: the part hops once a period
3.  The curve of {example.beta:g}° shows v f / g = {speed:.3f} there
4.  v = {speed:.3f} · 9.81 / {example.frequency:g} = {1e3 * velocity:.1f} mm/s

The lower chart agrees: {share:.3f} · A ω cos β
= {share:.3f} · {1e3 * own:.1f} mm/s = {1e3 * share * own:.1f} mm/s."""
    figure.text(0.60, 0.41, text, fontsize=9.2, va="top", linespacing=1.5, color=LIGHT.ink)
