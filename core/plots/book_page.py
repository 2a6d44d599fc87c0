"""A page of the book of charts: one friction and one angle of the track, a curve for each beta."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from vibrafeed.core.atlas.cells import pattern_of, regime_of
from vibrafeed.core.atlas.numbers import HOP, HOP_AFTER_HOP
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.methods.events import EVENTS, planar_motion
from vibrafeed.core.plots.style import LIGHT, mix
from vibrafeed.core.plots.text import number
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.pictures import FILLS

BETAS: Final = (10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0)  # degrees
MARKERS: Final = "os^Dv<>ph"
LARGEST: Final = 3.7  # throw number: from 3.724 on the period doubles
STEPS: Final = 370  # throw numbers of a curve, each computed
WIDTH, HEIGHT = 11.69, 8.27  # inches: a sheet of A4 on its side
SMALLEST: Final = 1e-9  # of the drive's speed: less is rest


class Stroke(NamedTuple):
    """The stroke of the line of a way of moving, and its text in the legend."""

    style: Any
    width: float
    label: str


# Each way of moving has a line of its own, which is told without colours.
LINES: Final = {
    "stick": Stroke((0, (1, 3)), 0.8, "rests"),
    "stick_slip": Stroke((0, (4, 1.6)), 1.2, "sticks and slides"),
    "slip": Stroke((0, (1, 1.2)), 1.4, "slides to and fro, never sticks"),
    "hopping": Stroke("-", 1.2, "hops once a period"),
    "hop_after_hop": Stroke("-", 2.2, "hops again where it lands"),
}
BANDS: Final = (
    (0.0, HOP, "contact", "on the floor"),
    (HOP, HOP_AFTER_HOP, "hopping", "hops once a period"),
    (HOP_AFTER_HOP, LARGEST, "hop_after_hop", "hop after hop"),
)


@dataclass(frozen=True)
class Chart:
    """The values of a page.

    Attributes
    ----------
    friction, slope : float
        Coefficient of friction, static and kinetic, and angle of the track in degrees.
    throw : ndarray, shape (n,)
        Throw numbers.
    speed : ndarray, shape (betas, n)
        v f/g; NaN where there is no mean velocity.
    coefficient : ndarray, shape (betas, n)
        v over A0 w cos(beta).
    regime : ndarray of int8, shape (betas, n)
        Value of a `REGIMES` entry.
    """

    friction: float
    slope: float
    throw: Array
    speed: Array
    coefficient: Array
    regime: NDArray[np.int8]

    @classmethod
    def of(cls, friction: float, slope: float) -> Chart:
        """Return the values of a page of the book of charts, for a friction and a climb [degree].

        Motions are computed exactly at many throw numbers, with those just beside the limits of
        hopping.
        """
        throw = np.linspace(0.0, LARGEST, STEPS + 1)[1:]
        aside = 1e-9
        breaks = [HOP, HOP + aside, HOP_AFTER_HOP - aside, HOP_AFTER_HOP + aside]
        throw = np.unique(np.append(throw, breaks))
        return cls(friction, slope, throw, *followed(friction, slope, np.array(BETAS), throw))

    @property
    def name(self) -> str:
        """The heading of the page of charts: friction and climb in words."""
        track = "level track"
        if self.slope:
            track = f"track {'up' if self.slope > 0 else 'down'} {number(abs(self.slope))}°"
        return f"Friction {number(self.friction)}, {track}"


def followed(
    friction: float, slope: float, betas: Array, throw: Array
) -> tuple[Array, Array, NDArray[np.int8]]:
    """Return mean velocities and regimes over drive angles and throw numbers, computed exactly.

    Parameters
    ----------
    friction, slope : float
        Coefficient of friction, static and kinetic, and climb of the track in degrees.
    betas : ndarray, shape (b,)
        Angles of the drive above the track in degrees.
    throw : ndarray, shape (n,)
        Throw numbers.

    Returns
    -------
    tuple of ndarray, shape (b, n)
        v f/g and v/(A0 w cos(beta)), with mean velocity v, frequency f, gravity g, amplitude A0 and
        w = 2 pi f; regimes as flag values.
    """
    gamma, beta = np.deg2rad(slope), np.deg2rad(betas)[:, None]
    load = np.cos(gamma)
    along = throw * load / np.tan(beta)
    motion = planar_motion(
        Groups(
            drive_number_along=along,
            drive_number_normal=throw * load,
            gravity_number_along=np.sin(gamma),
            gravity_number_normal=load,
            friction_static=friction,
            friction_kinetic=friction,
        ),
        tolerance=EVENTS.defaults["tolerance"],
        max_periods=EVENTS.defaults["max_periods"],
    )
    return (
        motion.velocity / (2.0 * np.pi),
        motion.velocity / along,
        regime_of(pattern_of(motion)),
    )


def draw_page(chart: Chart) -> Figure:
    """Return a page of the book of charts: mean velocity of a part over the throw number.

    Two charts above show v f/g below and above the throw number at which parts begin to hop, the
    lower one the share of the drive's own speed, v/(A w cos(beta)). `chart` has the values of one
    friction and slope.
    """
    figure = sheet()
    floor = figure.add_axes((0.075, 0.52, 0.25, 0.38))
    above = figure.add_axes((0.375, 0.52, 0.38, 0.38))
    below = figure.add_axes((0.075, 0.075, 0.68, 0.38))
    draw_curves(floor, chart, chart.speed, (0.0, HOP))
    draw_curves(above, chart, chart.speed, (HOP, LARGEST))
    draw_curves(below, chart, chart.coefficient)
    floor.set_ylabel("speed times frequency over g,   v f / g")
    below.set_ylabel("share of the drive's speed,   v / (A ω cos β)")
    below.set_xlabel("throw number,   Γ = A ω² sin β / (g cos γ)")
    LIGHT.dress(figure)
    name_bands(floor)
    name_bands(above)
    figure.text(0.075, 0.955, chart.name, fontsize=15, weight="bold", color=LIGHT.ink, va="center")
    figure.text(
        0.985, 0.955, "no restitution, static friction = kinetic friction", fontsize=8.5,
        color=LIGHT.quiet, ha="right", va="center",
    )  # fmt: skip
    _legends(figure, chart)
    return figure


def sheet() -> Figure:
    """Return an empty page."""
    figure = LIGHT.sheet(WIDTH, HEIGHT)
    figure.set_layout_engine(None)
    return figure


def draw_curves(
    axes: Axes, chart: Chart, values: Array, ends: tuple[float, float] = (0.0, LARGEST)
) -> None:
    """Draw a curve for each drive angle over the throw number, with the line style of each regime.

    Parameters
    ----------
    chart : Chart
        Throw numbers, and the regime at each drive angle and throw number.
    values : ndarray, shape (angles, throw numbers)
        What is drawn upwards: speeds or shares of a speed, without a unit.
    ends : tuple of float
        The throw numbers at the left and the right of the axes.
    """
    seen = values[:, (chart.throw >= ends[0]) & (chart.throw <= ends[1])]
    finite = seen[np.isfinite(seen)]
    least, largest = min(0.0, float(finite.min())), max(0.0, float(finite.max()))
    margin = 0.05 * (largest - least or 1.0)
    for start, end, regime, _ in BANDS:
        colour = mix(FILLS[regime], LIGHT.ground, 0.72)
        axes.axvspan(start, end, facecolor=colour, edgecolor="none", zorder=0)
    for place in (HOP, HOP_AFTER_HOP):
        axes.axvline(place, color=LIGHT.quiet, linewidth=0.8, zorder=1)
    axes.axhline(0.0, color=LIGHT.quiet, linewidth=0.8, zorder=1)
    LIGHT.add_grid(axes)
    for k, (colour, marker) in enumerate(zip(LIGHT.series_over(len(BETAS)), MARKERS, strict=True)):
        for start, end, name in stretches(chart.regime[k], values[k]):
            style, width, _ = LINES[name]
            some = slice(start, end)
            axes.plot(
                chart.throw[some], values[k][some], color=colour, linestyle=style, linewidth=width,
                zorder=3,
            )  # fmt: skip
        at = _marked(chart, values[k], k)
        axes.plot(
            chart.throw[at], values[k][at], color=colour, linestyle="none", marker=marker,
            markersize=4.2, markeredgecolor=LIGHT.ground, markeredgewidth=0.5, zorder=4,
        )  # fmt: skip
    axes.set_xlim(*ends)
    axes.set_ylim(least - margin, largest + margin)
    step = 0.5 if ends[1] > HOP else 0.25
    axes.set_xticks(np.arange(ends[0], ends[1] + step / 2, step)[: int(ends[1] / step) + 1])


def stretches(regime: NDArray[np.int8], values: Array) -> list[tuple[int, int, str]]:
    """Return start, stop and regime of each stretch of a curve that is drawn in one line style.

    `regime` has the number of the regime at each point, `values` are the ordinates, both of shape
    (n,). A stretch ends with the first point of the next, so that the curve has no gaps. Those
    without value, or in a regime that has no line, are left out.
    """
    names = {REGIMES[name].value: name for name in LINES}
    ends = [0, *(np.flatnonzero(np.diff(regime)) + 1).tolist(), regime.size]
    stretches = []
    for start, end in pairwise(ends):
        name = names.get(int(regime[start]))
        if name is not None and np.isfinite(values[start]):
            stretches.append((start, min(end + 1, regime.size), name))
    return stretches


def _marked(chart: Chart, values: Array, k: int) -> list[int]:
    """Return the indices of a curve's points that get a mark, apart from those of other curves.

    `k` is the number of the curve, by which marks are shifted; points at rest get none.
    """
    places = np.arange(0.15 + 0.035 * k, LARGEST, 0.35)
    at = [int(np.argmin(np.abs(chart.throw - place))) for place in places]
    return [one for one in at if np.abs(chart.coefficient[k][one]) > SMALLEST]


def name_bands(axes: Axes) -> None:
    """Write the kinds of motion above a chart, each over the throw numbers for which it holds."""
    least, largest = axes.get_xlim()
    for start, end, _, name in BANDS:
        if start >= largest or end <= least:
            continue
        axes.text(
            (start + end) / 2, 1.02, name, transform=axes.get_xaxis_transform(), ha="center",
            va="bottom", fontsize=8.5, color=LIGHT.quiet,
        )  # fmt: skip


def _legends(figure: Figure, chart: Chart) -> None:
    """Add to a page of charts the legends of drive angles and regimes, and the table of each curve.

    The table says from which throw number parts move, and their best share of the drive's speed.
    `chart` has the values of the page.
    """
    curves: list[Artist] = [
        Line2D([], [], color=colour, marker=marker, markersize=5, label=f"{number(beta)}°",
               markeredgecolor=LIGHT.ground, markeredgewidth=0.5, linewidth=1.2)
        for colour, marker, beta in zip(
            LIGHT.series_over(len(BETAS)), MARKERS, BETAS, strict=True
        )
    ]  # fmt: skip
    anchor: dict[str, Any] = {
        "loc": "upper left",
        "frameon": False,
        "fontsize": 9.5,
        "alignment": "left",
    }
    figure.legend(
        handles=curves, title="β, angle of the drive", bbox_to_anchor=(0.77, 0.91), **anchor
    )
    figure.legend(handles=line_entries(), title="the part", bbox_to_anchor=(0.77, 0.565), **anchor)
    figure.text(
        0.778, 0.365, "\n".join(_facts(chart)), fontsize=8, color=LIGHT.ink, va="top",
        linespacing=1.5, family="monospace",
    )  # fmt: skip


def line_entries() -> list[Artist]:
    """Return the legend entries that explain the line styles of charts, one for each regime."""
    return [
        Line2D([], [], color=LIGHT.ink, linestyle=style, linewidth=width, label=label)
        for style, width, label in LINES.values()
    ]


def _facts(chart: Chart) -> list[str]:
    """Return the lines of a table beside a chart: from where parts move, and their best share.

    The first column is beta, the angle of the drive to the floor; the second the throw number Gamma
    from which a part moves; the third the best share v/(A0 w cos(beta)): v is the mean velocity, A0
    w cos(beta) the largest speed of the track along itself. `chart` has these shares, shape (betas,
    throw numbers).
    """
    lines = ["   β  moves    best share", "      from Γ   of the drive"]
    for k, beta in enumerate(BETAS):
        share = chart.coefficient[k]
        moves = np.flatnonzero(np.abs(share) > SMALLEST)
        if not moves.size:
            lines.append(f"{number(beta):>4}°  never")
            continue
        at = int(np.nanargmax(share))
        best = f"{share[at]:.2f} at Γ {chart.throw[at]:.2f}" if share[at] > 0 else "goes back"
        lines.append(f"{number(beta):>3}°  {chart.throw[moves[0]]:.2f}   {best}")
    return lines
