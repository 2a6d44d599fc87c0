"""The motion of one part over a cycle: height over the track, velocity along it, progress."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import flags_of
from vibrafeed.core.motion.drives import Shape, shape_of
from vibrafeed.core.motion.waves import ALONG, NORMAL, TURN, Wave, position_at, speed
from vibrafeed.core.plots.parts import padded
from vibrafeed.core.plots.pictures import PlotError, unreadable
from vibrafeed.core.plots.regimes import HATCH_WIDTH
from vibrafeed.core.plots.selection import held_fixed
from vibrafeed.core.plots.style import RGB, Style, mix
from vibrafeed.core.plots.text import number, shown_in, with_unit, words
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.pictures import FILLS
from vibrafeed.core.study.shown import ShownUnits

TIME = "cycle_time"
WALL = "distance_from_wall"
NEEDED = (
    "position_along", "height_above_floor", "relative_velocity_along", "track_along",
    "track_normal", "motion_mode",
)  # fmt: skip
MILLI = 1000.0
PANELS = (3.0, 2.4, 1.8)  # relative heights of the panels
WALL_PANEL = 1.6  # relative height of the panel of the wall
WALL_HEIGHT = 0.8  # inches that it adds to a picture
PALE = 0.55  # share of the ground colour in the colour of a mode
AT_REST = 1e-9  # of the heights: a smaller position is rounding
MAX_PERIODS = 12  # periods up to which a line marks each
ORBIT_POINTS = 400
STRAIGHT = 1e-6  # of an orbit's length: one that is no wider is a line
ORBIT_AXES = (0.80, 0.60, 0.19, 0.30)  # of the upper panel
ORBIT_MARGIN = 0.7  # of the heights, above them

# Hatch and colour of the background while the part is in a mode; in flight it is the ground.
MODES = {
    "stick": ("..", FILLS["stick"]),
    "forward": ("", FILLS["slip"]),
    "backward": ("\\\\", FILLS["hop_after_hop"]),
}
LEGEND = {
    "stick": "sticking",
    "forward": "sliding forward",
    "backward": "sliding backward",
    "flight": "in flight",
}
UNKNOWN = ("", "#b0b0b0")


class Trajectory(NamedTuple):
    """The motion of one part in the units in which it is drawn.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times [ms].
    period : float
        Period of the drive [ms].
    track, part : ndarray, shape (n,)
        Heights of the track and of the part in the fixed frame, in `height_unit`.
    track_velocity, part_velocity : ndarray, shape (n,)
        Velocities along the track, in the fixed frame, in `velocity_unit`.
    position : ndarray, shape (n,)
        Position on the track, in `position_unit`.
    modes : list of str, length n
        Mode of the contact at each time.
    facts : list of str
        Mean velocity, regime, and every parameter, in words.
    orbit : ndarray, shape (2, k), or None
        How the track moves along and normal over a period, where that is no line.
    wall : ndarray, shape (n,), or None
        Distance of the part from the wall, in `wall_unit`; None where the track has no wall.
    """

    time: NDArray[np.float64]
    period: float
    track: NDArray[np.float64]
    part: NDArray[np.float64]
    height_unit: str
    track_velocity: NDArray[np.float64]
    part_velocity: NDArray[np.float64]
    velocity_unit: str
    position: NDArray[np.float64]
    position_unit: str
    modes: list[str]
    facts: list[str]
    orbit: NDArray[np.float64] | None = None
    wall: NDArray[np.float64] | None = None
    wall_unit: str = ""


def check_trajectory(dataset: xarray.Dataset) -> None:
    """Raise `PlotError` if a dataset has no motion over time."""
    if TIME not in dataset.dims:
        fix = "Set trajectory = 400 in a study of one point, and run it"
        raise PlotError(
            "kind", f"the dataset has no trajectory: the dimension {TIME} is missing", fix
        )
    if dataset.sizes[TIME] < 2:
        raise PlotError(
            "dataset",
            "the trajectory of the dataset has one time only",
            "Set trajectory to 2 or more in the study",
        )


def read_trajectory(dataset: xarray.Dataset, units: ShownUnits) -> Trajectory:
    """Return the motion of a dataset's part over time, in the units in which it is drawn.

    The dataset has the axis `time` and the positions, velocities and modes that `simulate` writes;
    `units` are the units that the reader wants.

    Raises
    ------
    PlotError
        If the dataset lacks a variable of the motion, or has no values since no cycle was found.
    """
    known = {**dataset.data_vars, **dataset.coords}
    shape, _ = shape_of(map(str, known))
    needed = (*NEEDED, "frequency", *(("gravity", *shape.inputs) if shape else ()))
    missing = [name for name in needed if name not in known]
    if missing:
        raise unreadable(f"its motion has no {missing[0]}")
    dataset = dataset.sortby(TIME)

    seconds = values_of(dataset[TIME])
    period = 1.0 / float(dataset["frequency"])
    track = values_of(dataset["track_normal"])
    part, orbit = track + values_of(dataset["height_above_floor"]), None
    if shape is None:
        swing = _swing(seconds, period, values_of(dataset["track_along"]))
    else:
        wave, scale = _wave(dataset, shape), float(dataset["gravity"]) * period / TURN
        swing = scale * speed(wave, ALONG, TURN * seconds / period)
        orbit = _orbit(wave)
    seen = part if part.any() else values_of(dataset["track_along"])  # a level drive
    height = shown_in(xarray.DataArray(seen, attrs={"units": "m"}), units)
    if not np.isfinite(part).any():
        raise PlotError(
            "dataset",
            "the dataset has no motion to draw, because the simulation found no cycle",
            "Draw another result",
        )
    horizontal = shown_in(dataset["position_along"], units)
    position = horizontal.factor * values_of(dataset["position_along"])
    if np.nanmax(np.abs(position)) <= AT_REST * horizontal.factor * np.nanmax(np.abs(part)):
        position, horizontal = np.zeros_like(position), height
    moved = swing + values_of(dataset["relative_velocity_along"])
    fastest = xarray.DataArray([swing, moved], attrs={"units": "m s-1"})
    speed_shown = shown_in(fastest, units)
    wall, wall_unit = None, ""
    if WALL in dataset:
        gap = shown_in(dataset[WALL], units)
        wall, wall_unit = gap.factor * values_of(dataset[WALL]), gap.unit
    return Trajectory(
        time=MILLI * seconds,
        period=MILLI * period,
        track=height.factor * track,
        part=height.factor * part,
        height_unit=height.unit,
        track_velocity=speed_shown.factor * swing,
        part_velocity=speed_shown.factor * moved,
        velocity_unit=speed_shown.unit,
        position=position,
        position_unit=horizontal.unit,
        modes=_modes(dataset["motion_mode"]),
        facts=_facts(dataset, units),
        orbit=orbit,
        wall=wall,
        wall_unit=wall_unit,
    )


def draw_trajectory(figure: Figure, shown: Trajectory, style: Style) -> tuple[Axes, list[Artist]]:
    """Draw the motion of a part over time; return the upper axes and the legend entries.

    Panels below each other show the height of track and part, their velocity along the track, the
    position of the part on it, and its distance from the wall if there is one. Backgrounds tell
    what the part does. `shown` has the values in the units of the picture.
    """
    walled = shown.wall is not None
    ratios = (*PANELS, WALL_PANEL) if walled else PANELS
    if walled:
        figure.set_figheight(figure.get_figheight() + style.text(WALL_HEIGHT))
    panels = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    heights, velocities, positions = panels[:3]
    for axes in panels:
        _shade_modes(axes, shown, style)
        _mark_periods(axes, shown, style)
        axes.grid(visible=True, axis="y", color=style.grid, linewidth=0.6)
        axes.set_axisbelow(True)
    part = {"color": style.curve, "linewidth": style.width(2.0), "zorder": 4}
    track = {"color": style.other, "linewidth": style.width(1.4), "zorder": 3}

    ends = _limits(shown.track, shown.part)
    body = mix(style.other, style.ground, 0.5)
    heights.fill_between(shown.time, shown.track, ends[0], facecolor=body, linewidth=0, zorder=2)
    heights.plot(shown.time, shown.track, **{**track, "linewidth": style.width(1.0)})
    heights.plot(shown.time, shown.part, **part)
    heights.set_ylim(*ends)
    if shown.orbit is not None:
        heights.set_ylim(ends[0], ends[1] + ORBIT_MARGIN * (ends[1] - ends[0]))
        _draw_orbit(heights, shown.orbit, style)
    heights.set_ylabel(f"Height{_under(style)}({shown.height_unit})")

    velocities.axhline(0.0, color=style.quiet, linewidth=0.7, zorder=1)
    velocities.plot(shown.time, shown.track_velocity, **track)
    velocities.plot(shown.time, shown.part_velocity, **part)
    velocities.set_ylim(*_limits(shown.track_velocity, shown.part_velocity))
    along = "" if style.small else " along\nthe track"
    velocities.set_ylabel(f"Velocity{along}{_under(style)}({shown.velocity_unit})")

    positions.plot(shown.time, shown.position, **part)
    positions.set_ylim(*(_limits(shown.position) if shown.position.any() else ends))
    on = "" if style.small else " on\nthe track"
    positions.set_ylabel(f"Position{on}{_under(style)}({shown.position_unit})")
    if shown.wall is not None:
        _draw_wall(panels[3], shown, shown.wall, style)
    panels[-1].set_xlabel("Time since the start of the cycle (ms)")
    positions.set_xlim(shown.time[0], shown.time[-1])
    figure.align_ylabels(panels)
    return heights, [*_lines(style), *_mode_entries(shown.modes, style)]


def _draw_wall(axes: Axes, shown: Trajectory, distance: NDArray[np.float64], style: Style) -> None:
    """Draw the distance of a part from the wall over time into a panel of its own.

    `distance` has a value for each time of `shown`, in its unit `wall_unit`; the wall is shaded
    below 0.
    """
    low, high = _limits(np.append(distance, 0.0))
    body = mix(style.other, style.ground, 0.5)
    axes.axhspan(low, 0.0, facecolor=body, linewidth=0, zorder=2)
    axes.axhline(0.0, color=style.other, linewidth=style.width(1.0), zorder=3)
    axes.plot(shown.time, distance, color=style.curve, linewidth=style.width(2.0), zorder=4)
    axes.set_ylim(low, high)
    to = "to wall" if style.small else "to\nthe wall"
    axes.set_ylabel(f"Gap {to}{_under(style)}({shown.wall_unit})")


def _under(style: Style) -> str:
    """Return the separator between label and unit, shorter in small pictures."""
    return "\n" if style.small else " "


def _facts(dataset: xarray.Dataset, units: ShownUnits) -> list[str]:
    """Return the lines below the title of a motion's picture: mean velocity, regime, parameters.

    Each is a text with non-breaking spaces; `units` are those that the reader wants.
    """
    facts = []
    mean = dataset.get("conveying_velocity")
    if mean is not None and not mean.ndim and np.isfinite(mean):
        shown = units.of("m s-1", abs(float(mean)))
        facts.append(
            f"mean velocity {with_unit(number(shown.factor * float(mean), 4), shown.unit)}"
        )
    if not dataset["regime"].ndim:
        facts.append("regime " + words(_flag(dataset["regime"], int(dataset["regime"]))))
    held = held_fixed(dataset, units)
    return [fact.replace(" ", "\N{NO-BREAK SPACE}") for fact in facts] + held


def values_of(array: xarray.DataArray) -> NDArray[np.float64]:
    """Return the values of an array as floats."""
    return np.asarray(array.values, dtype=np.float64)


def _limits(*curves: NDArray[np.float64]) -> tuple[float, float]:
    """Return the limits of an axis for curves."""
    values = np.concatenate(curves)
    finite = values[np.isfinite(values)]
    return padded(float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def _swing(
    seconds: NDArray[np.float64], period: float, track: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the velocity along itself of a track that moves as a sine, at any times [m/s].

    Its amplitude is fitted to the displacement.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Times [s].
    period : float
        Period of the drive [s].
    track : ndarray, shape (n,)
        Displacement of the track along itself [m], a multiple of sin(2 pi t/period).
    """
    rate = 2 * np.pi / period
    sine = np.sin(rate * seconds)
    weight = float(sine @ sine)
    amplitude = float(sine @ track) / weight if weight > 0 else 0.0
    return amplitude * rate * np.cos(rate * seconds)


def _wave(dataset: xarray.Dataset, shape: Shape) -> Wave:
    """Return the drive that a dataset's parameters define, for drives that are no plain sine.

    `shape` is its kind, such as harmonics or steps, and knows its parameters.
    """
    given = {name: values_of(dataset[name]) for name in shape.inputs}
    return shape.wave(
        **{n: np.deg2rad(v) if QUANTITIES[n].is_angle else v for n, v in given.items()}
    )


def _orbit(wave: Wave) -> NDArray[np.float64] | None:
    """Return the path of the track over a period, along and normal, shape (2, points), or None.

    None if it is a line. The unit is that of the drive's own dimensionless position, g/w^2 with w =
    2 pi f. `wave` has the push of the drive, minus the track's acceleration per weight, as sines
    and steps.
    """
    phases = np.linspace(0.0, TURN, ORBIT_POINTS + 1)
    orbit = np.stack([position_at(wave, axis, phases) for axis in (ALONG, NORMAL)])
    length, width = np.linalg.svd(orbit, compute_uv=False)
    return orbit if width > STRAIGHT * length else None


def _draw_orbit(axes: Axes, orbit: NDArray[np.float64], style: Style) -> None:
    """Draw the path of the track over a period as an inset, with a dot at the start and an arrow.

    `orbit` is its displacement along and normal, shape (2, points), in any one unit.
    """
    inset = axes.inset_axes(ORBIT_AXES, facecolor=style.ground, zorder=5)
    inset.plot(*orbit, color=style.other, linewidth=style.width(1.4))
    inset.plot(*orbit[:, :1], color=style.other, marker="o", markersize=style.width(3.5))
    ahead = orbit[:, ORBIT_POINTS // 12 : ORBIT_POINTS // 12 + 2].T
    arrow = {"arrowstyle": "-|>", "color": style.other, "lw": style.width(1.4)}
    inset.annotate("", ahead[1], ahead[0], arrowprops=arrow)
    inset.set_aspect("equal", adjustable="datalim")
    inset.margins(0.12)
    inset.set(xticks=[], yticks=[])
    inset.set_title("Orbit of the track", fontsize=style.text(7.5), pad=2, color=style.ink)


def _flag(array: xarray.DataArray, value: int) -> str:
    """Return the name that a code of an array stands for; raise `PlotError` if it has none.

    A code is a regime or a mode of the motion; the array has the names as attributes.
    """
    try:
        return flags_of(array.attrs)[value]
    except KeyError:
        raise unreadable(f"its {array.name} {value} has no name") from None


def _modes(array: xarray.DataArray) -> list[str]:
    """Return the names of the modes."""
    return [_flag(array, value) for value in array.values.astype(np.int64).tolist()]


def _look(mode: str, style: Style) -> tuple[str, RGB]:
    """Return hatch and background colour for what a part does, such as sticking or sliding.

    `mode` is a name of `MODES`, ``"flight"``, which has the colour of the ground, or unknown.
    """
    if mode == "flight":
        return "", mix(style.ground, style.ground, 0.0)
    hatch, colour = MODES.get(mode, UNKNOWN)
    return hatch, mix(colour, style.ground, PALE)


def _shade_modes(axes: Axes, shown: Trajectory, style: Style) -> None:
    """Colour the background by what the part does, with borders half-way between two times.

    `shown` has its mode, such as sticking or sliding, at each time.
    """
    time = shown.time
    edges = np.concatenate([time[:1], (time[:-1] + time[1:]) / 2, time[-1:]])
    changes = [i for i in range(1, len(shown.modes)) if shown.modes[i] != shown.modes[i - 1]]
    for start, stop in zip([0, *changes], [*changes, len(shown.modes)], strict=True):
        hatch, colour = _look(shown.modes[start], style)
        area = axes.axvspan(edges[start], edges[stop], facecolor=colour, linewidth=0, zorder=0)
        if hatch:
            ink = mix(colour, style.ink, 0.25)
            area.set(hatch=hatch, edgecolor=ink, hatch_linewidth=HATCH_WIDTH)


def _mark_periods(axes: Axes, shown: Trajectory, style: Style) -> None:
    """Draw a dotted line at the start of each period of the drive, unless they are too many."""
    first, last = np.ceil(shown.time[0] / shown.period), np.floor(shown.time[-1] / shown.period)
    if last - first > MAX_PERIODS:
        return
    for count in np.arange(first, last + 1):
        axes.axvline(
            count * shown.period, color=style.quiet, linewidth=0.8, linestyle=":", zorder=1
        )


def _lines(style: Style) -> list[Artist]:
    """Return the legend entries of the curves of part and track in a picture of a motion."""
    return [
        Line2D([], [], color=style.curve, linewidth=style.width(2.0), label="part"),
        Line2D([], [], color=style.other, linewidth=style.width(1.4), label="track"),
    ]


def _mode_entries(modes: list[str], style: Style) -> list[Artist]:
    """Return the legend entries of what a part does, such as sticking, for the modes that occur.

    `modes` are its modes over time.
    """
    entries: list[Artist] = []
    for name in dict.fromkeys((*MODES, "flight", *modes)):
        if name in modes:
            hatch, colour = _look(name, style)
            ink = mix(colour, style.ink, 0.3)
            patch = Patch(facecolor=colour, edgecolor=ink, label=LEGEND.get(name, words(name)))
            patch.set(hatch=hatch, linewidth=0.8, hatch_linewidth=HATCH_WIDTH)
            entries.append(patch)
    return entries
