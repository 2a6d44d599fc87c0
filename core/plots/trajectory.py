"""The motion of one part: of one on the moving track, or of one that tumbles."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from vibrafeed.core.dataset.bands import ENDS, known_between, rounded
from vibrafeed.core.dataset.table import Table, flags_of
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import parse_json
from vibrafeed.core.kinds.results import prepare, tabulate
from vibrafeed.core.motion.drives import shape_of
from vibrafeed.core.motion.waves import ALONG, NORMAL, TURN, Wave, position_at, speed
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plots.looks import HATCH_WIDTH
from vibrafeed.core.plots.parts import finish, padded, source_of
from vibrafeed.core.plots.pictures import PlotError, unreadable
from vibrafeed.core.plots.selection import SPACE, check_result, held_fixed
from vibrafeed.core.plots.style import (
    RGB,
    Array,
    Options,
    Style,
    mix,
    number,
    shown_in,
    with_unit,
    words,
)
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.pictures import FILLS
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy

TIME = "cycle_time"
WALL = "distance_from_wall"
NEEDED = (
    "position_along", "height_above_floor", "relative_velocity_along", "track_along",
    "track_normal", "motion_mode",
)  # fmt: skip
MILLI = 1000.0
PANELS = (3.0, 2.4, 1.8)  # relative heights of the panels
PALE = 0.55  # share of the ground colour in the colour of a mode
MAX_PERIODS = 12  # periods up to which a line marks each
ORBIT_POINTS = 400
# Hatch and colour of the background while the part is in a mode; in flight it is the ground.
MODES = {
    "stick": ("..", FILLS["stick"]),
    "forward": ("", FILLS["slip"]),
    "backward": ("\\\\", FILLS["hop_after_hop"]),
}
LEGEND = {
    "stick": "sticking", "forward": "sliding forward", "backward": "sliding backward",
    "flight": "in flight",
}  # fmt: skip
TIMES = 400  # points of a trajectory that is computed for a picture
FALL = ("path_along", "path_height", "path_pitch", "path_gap", "path_corners", "length")
HEIGHTS = ("height", "diameter")  # of a part, whichever it has
STILL = 1e-3  # of the part's size, and of a turn


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one simulated part, or a motion over a cycle."""
    return not options.asks and (TIME in dataset.dims or study_of_motion(dataset) is not None)


def study_of_motion(dataset: xarray.Dataset) -> Prepared | None:
    """Return the study of a dataset's single cell, prepared to be followed over a cycle, or None.

    None if there are several cells, no study of a motion, or a method that gives no trajectory.
    """
    text = str(dataset.attrs.get("study", ""))
    if (
        "motion_status" not in dataset
        or any(values.size > 1 for values in dataset.values())
        or not text
    ):
        return None
    try:
        study = parse_json(text)
        if not isinstance(study, SimulateStudy):
            return None
        return prepare(study.model_copy(update={"trajectory": TIMES}))
    except VibrafeedError:
        return None


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of the motion of a dataset's single part, on the track or tumbling.

    A dataset without a time axis but with one cell is followed in time first.
    """
    check_result(dataset)
    style = options.style
    if (
        TIME not in dataset.dims
        and options.is_natural
        and (study := study_of_motion(dataset)) is not None
    ):
        dataset = tabulate(study).to_xarray()
    figure = style.sheet()
    check_trajectory(dataset)
    if "path_gap" in dataset:
        top, facts, entries = _draw_fall(figure, dataset, options.units, style)
        name = "Trajectory of the part as it falls and tumbles"
    else:
        trajectory = read_trajectory(dataset, options.units)
        top, entries = _draw_trajectory(figure, trajectory, style)
        name, facts = "Motion of the part on the moving track", trajectory.facts
    return finish(
        figure, top, style, name=options.title or name, facts=facts, source=source_of(dataset),
        entries=entries,
    )  # fmt: skip


class Trajectory(NamedTuple):
    """The motion of one part in the units in which it is drawn, arrays of shape (n,).

    Times and the period of the drive are in ms, heights and velocities in the fixed frame, the
    position is that on the track. `modes` of the contact have one name a time, `facts` are mean
    velocity, regime and parameters in words. `orbit` is how the track moves along and normal, shape
    (2, k), unless that is a line; `wall` the distance from the wall of a track that has one.
    """

    time: Array
    period: float
    track: Array
    part: Array
    height_unit: str
    track_velocity: Array
    part_velocity: Array
    velocity_unit: str
    position: Array
    position_unit: str
    modes: list[str]
    facts: list[str]
    orbit: Array | None = None
    wall: Array | None = None
    wall_unit: str = ""


def no_motion(why: str) -> PlotError:
    """Return the error of a dataset without a motion to draw."""
    return PlotError("dataset", f"the dataset has no motion to draw{why}", "Draw another result")


def check_trajectory(dataset: xarray.Dataset) -> None:
    """Raise `PlotError` if a dataset has no motion over time."""
    if TIME not in dataset.dims:
        raise PlotError(
            "kind",
            f"the dataset has no trajectory: the dimension {TIME} is missing",
            "Set trajectory = 400 in a study of one point, and run it",
        )
    if dataset.sizes[TIME] < 2:
        raise PlotError(
            "dataset",
            "the trajectory of the dataset has one time only",
            "Set trajectory to 2 or more in the study",
        )


def read_trajectory(dataset: xarray.Dataset, units: ShownUnits) -> Trajectory:
    """Return the motion of a dataset's part over time, in the units in which it is drawn."""
    variables = {**dataset.data_vars, **dataset.coords}
    shape, _ = shape_of(map(str, variables))
    needed = (*NEEDED, "frequency", *(("gravity", *shape.inputs) if shape else ()))
    missing = [name for name in needed if name not in variables]
    if missing:
        raise unreadable(f"its motion has no {missing[0]}")
    dataset = dataset.sortby(TIME)

    seconds = values_of(dataset[TIME])
    period = 1.0 / float(dataset["frequency"])
    track = values_of(dataset["track_normal"])
    part, orbit = track + values_of(dataset["height_above_floor"]), None
    if "burst_periods" in variables:  # from rest to rest
        track_velocity = np.gradient(values_of(dataset["track_along"]), seconds)
    elif shape is None:
        track_velocity = _velocity_of_sine(seconds, period, values_of(dataset["track_along"]))
    else:
        parameters = {name: values_of(dataset[name]) for name in shape.inputs}
        wave = shape.wave(
            **{
                name: np.deg2rad(value) if QUANTITIES[name].is_angle else value
                for name, value in parameters.items()
            }
        )
        velocity_scale = float(dataset["gravity"]) * period / TURN
        track_velocity = velocity_scale * speed(wave, ALONG, TURN * seconds / period)
        orbit = _orbit(wave)
    shown_heights = part if part.any() else values_of(dataset["track_along"])  # a level drive
    height = shown_in(xarray.DataArray(shown_heights, attrs={"units": "m"}), units)
    if not np.isfinite(part).any():
        raise no_motion(", because the simulation found no cycle")
    horizontal = shown_in(dataset["position_along"], units)
    position = horizontal.factor * values_of(dataset["position_along"])
    # A smaller position is rounding.
    if np.nanmax(np.abs(position)) <= 1e-9 * horizontal.factor * np.nanmax(np.abs(part)):
        position, horizontal = np.zeros_like(position), height
    part_velocity = track_velocity + values_of(dataset["relative_velocity_along"])
    velocities = xarray.DataArray([track_velocity, part_velocity], attrs={"units": "m s-1"})
    velocity = shown_in(velocities, units)
    gap = shown_in(dataset[WALL], units) if WALL in dataset else None
    return Trajectory(
        time=MILLI * seconds,
        period=MILLI * period,
        track=height.factor * track,
        part=height.factor * part,
        height_unit=height.unit,
        track_velocity=velocity.factor * track_velocity,
        part_velocity=velocity.factor * part_velocity,
        velocity_unit=velocity.unit,
        position=position,
        position_unit=horizontal.unit,
        modes=[
            _flag(dataset["motion_mode"], value)
            for value in dataset["motion_mode"].values.astype(np.int64).tolist()
        ],
        facts=_facts(dataset, units),
        orbit=orbit,
        wall=None if gap is None else gap.factor * values_of(dataset[WALL]),
        wall_unit="" if gap is None else gap.unit,
    )


def _draw_trajectory(
    figure: Figure, trajectory: Trajectory, style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw heights, velocities, position and, beside a wall, the gap, over time."""
    has_wall = trajectory.wall is not None
    ratios = (*PANELS, 1.6) if has_wall else PANELS
    if has_wall:
        figure.set_figheight(figure.get_figheight() + style.text(0.8))
    panels = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    heights, velocities, positions = panels[:3]
    for axes in panels:
        _shade_modes(axes, trajectory, style)
        axes.grid(visible=True, axis="y", color=style.grid, linewidth=0.6)
        axes.set_axisbelow(True)
    part_look = {"color": style.curve, "linewidth": style.width(2.0), "zorder": 4}
    track_look = {"color": style.other, "linewidth": style.width(1.4), "zorder": 3}
    ground = mix(style.other, style.ground, 0.5)
    separator = "\n" if style.small else " "  # between label and unit

    limits = _limits(trajectory.track, trajectory.part)
    heights.fill_between(
        trajectory.time, trajectory.track, limits[0], facecolor=ground, linewidth=0, zorder=2
    )
    heights.plot(trajectory.time, trajectory.track, **{**track_look, "linewidth": style.width(1.0)})
    heights.plot(trajectory.time, trajectory.part, **part_look)
    heights.set_ylim(*limits)
    if trajectory.orbit is not None:
        heights.set_ylim(limits[0], limits[1] + 0.7 * (limits[1] - limits[0]))
        _draw_orbit(heights, trajectory.orbit, style)
    heights.set_ylabel(f"Height{separator}({trajectory.height_unit})")

    velocities.axhline(0.0, color=style.quiet, linewidth=0.7, zorder=1)
    velocities.plot(trajectory.time, trajectory.track_velocity, **track_look)
    velocities.plot(trajectory.time, trajectory.part_velocity, **part_look)
    velocities.set_ylim(*_limits(trajectory.track_velocity, trajectory.part_velocity))
    along = "" if style.small else " along\nthe track"
    velocities.set_ylabel(f"Velocity{along}{separator}({trajectory.velocity_unit})")

    positions.plot(trajectory.time, trajectory.position, **part_look)
    positions.set_ylim(*(_limits(trajectory.position) if trajectory.position.any() else limits))
    on = "" if style.small else " on\nthe track"
    positions.set_ylabel(f"Position{on}{separator}({trajectory.position_unit})")
    if trajectory.wall is not None:
        low, high = _limits(np.append(trajectory.wall, 0.0))
        panels[3].axhspan(low, 0.0, facecolor=ground, linewidth=0, zorder=2)
        panels[3].axhline(0.0, color=style.other, linewidth=style.width(1.0), zorder=3)
        panels[3].plot(trajectory.time, trajectory.wall, **part_look)
        panels[3].set_ylim(low, high)
        to = "to wall" if style.small else "to\nthe wall"
        panels[3].set_ylabel(f"Gap {to}{separator}({trajectory.wall_unit})")
    panels[-1].set_xlabel("Time since the start of the cycle (ms)")
    positions.set_xlim(trajectory.time[0], trajectory.time[-1])
    figure.align_ylabels(panels)
    lines = [
        Line2D([], [], color=style.curve, linewidth=style.width(2.0), label="part"),
        Line2D([], [], color=style.other, linewidth=style.width(1.4), label="track"),
    ]
    return heights, [*lines, *_mode_entries(trajectory.modes, style)]


def _facts(dataset: xarray.Dataset, units: ShownUnits) -> list[str]:
    facts = []
    mean = dataset.get("conveying_velocity")
    if mean is not None and not mean.ndim and np.isfinite(mean):
        shown = units.of("m s-1", abs(float(mean)))
        text = number(shown.factor * float(mean), 4)
        friction_range = known_between(Table.of_xarray(dataset).coordinates)
        if friction_range:
            low, high = (shown.factor * float(dataset[f"{mean.name}_{end}"]) for end in ENDS)
            values = (shown.factor * float(mean), low, high)
            text, *band = (rounded(value, high - low) for value in values)
            friction_range = f", {' to '.join(band)} for {friction_range}"
        fact = f"mean velocity {with_unit(text, shown.unit)}{friction_range}"
        facts.append(fact.replace("-", "\N{MINUS SIGN}"))
    if not dataset["regime"].ndim:
        facts.append("regime " + words(_flag(dataset["regime"], int(dataset["regime"]))))
    return [fact.replace(" ", SPACE) for fact in facts] + held_fixed(dataset, units)


def values_of(array: xarray.DataArray) -> Array:
    """Return the values of an array as floats."""
    return np.asarray(array.values, dtype=np.float64)


def _limits(*curves: Array) -> tuple[float, float]:
    values = np.concatenate(curves)
    finite = values[np.isfinite(values)]
    return padded(float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def _velocity_of_sine(seconds: Array, period: float, track: Array) -> Array:
    # Of the track [m/s]; its displacement is a multiple of a sine, whose amplitude is fitted.
    rate = 2 * np.pi / period
    sine = np.sin(rate * seconds)
    weight = float(sine @ sine)
    amplitude = float(sine @ track) / weight if weight > 0 else 0.0
    return amplitude * rate * np.cos(rate * seconds)


def _orbit(wave: Wave) -> Array | None:
    # Along and normal [g/w^2, w = 2 pi f], shape (2, points).
    phases = np.linspace(0.0, TURN, ORBIT_POINTS + 1)
    orbit = np.stack([position_at(wave, axis, phases) for axis in (ALONG, NORMAL)])
    length, width = np.linalg.svd(orbit, compute_uv=False)
    # One that is no wider is a line.
    return orbit if width > 1e-6 * length else None


def _draw_orbit(axes: Axes, orbit: Array, style: Style) -> None:
    """Draw the path of the track in an inset, with an arrow for its sense."""
    inset = axes.inset_axes((0.80, 0.60, 0.19, 0.30), facecolor=style.ground, zorder=5)
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
    """Return the name that a code of an array stands for; raise `PlotError` if it has none."""
    try:
        return flags_of(array.attrs)[value]
    except KeyError:
        raise unreadable(f"its {array.name} {value} has no name") from None


def mode_intervals(modes: Sequence[str], time: Array) -> list[tuple[str, float, float]]:
    """Return mode, start and stop of each interval of equal mode, half-way between two times."""
    edges = np.concatenate([time[:1], (time[:-1] + time[1:]) / 2, time[-1:]])
    starts = [0, *(i for i in range(1, len(modes)) if modes[i] != modes[i - 1]), len(modes)]
    return [(modes[i], float(edges[i]), float(edges[j])) for i, j in pairwise(starts)]


def _look(mode: str, style: Style) -> tuple[str, RGB]:
    hatch, colour = ("", style.ground) if mode == "flight" else MODES.get(mode, ("", "#b0b0b0"))
    return hatch, mix(colour, style.ground, PALE)


def _shade_modes(axes: Axes, shown: Trajectory, style: Style) -> None:
    """Shade the times of each mode of contact, and mark the periods of the drive."""
    for mode, start, stop in mode_intervals(shown.modes, shown.time):
        hatch, colour = _look(mode, style)
        area = axes.axvspan(start, stop, facecolor=colour, linewidth=0, zorder=0)
        if hatch:
            ink = mix(colour, style.ink, 0.25)
            area.set(hatch=hatch, edgecolor=ink, hatch_linewidth=HATCH_WIDTH)
    first, last = np.ceil(shown.time[0] / shown.period), np.floor(shown.time[-1] / shown.period)
    for count in np.arange(first, last + 1) if last - first <= MAX_PERIODS else ():
        axes.axvline(
            count * shown.period, color=style.quiet, linewidth=0.8, linestyle=":", zorder=1
        )


def _mode_entries(modes: list[str], style: Style) -> list[Artist]:
    entries: list[Artist] = []
    for name in dict.fromkeys((*MODES, "flight", *modes)):  # known modes first, each once
        if name in modes:
            hatch, colour = _look(name, style)
            patch = Patch(
                facecolor=colour, edgecolor=mix(colour, style.ink, 0.3), hatch=hatch, linewidth=0.8,
                hatch_linewidth=HATCH_WIDTH, label=LEGEND.get(name, words(name)),
            )  # fmt: skip
            entries.append(patch)
    return entries


def _draw_fall(
    figure: Figure, dataset: xarray.Dataset, units: ShownUnits, style: Style
) -> tuple[Axes, list[str], list[Artist]]:
    """Draw a tumbling part, a rectangle: from the side, its gap to the plane, and its pitch.

    Return the upper axes, the lines below the title, and the entries of the legend.
    """
    variables = {**dataset.data_vars, **dataset.coords}
    heights = [name for name in HEIGHTS if name in variables]
    missing = [*(name for name in FALL if name not in variables), *(() if heights else HEIGHTS)]
    if missing:
        raise unreadable(f"its motion has no {missing[0]}")
    dataset = dataset.sortby(TIME)
    along, upward, pitch, gap = (values_of(dataset[name]) for name in FALL[:4])
    if not np.isfinite(upward).all():
        raise PlotError("dataset", "the dataset has no values of the motion", "Draw another result")
    size = np.array([float(dataset["length"]), float(dataset[heights[0]])])
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    turned = np.deg2rad(pitch)[:, np.newaxis]
    middle = np.stack([along, upward], axis=-1)[:, np.newaxis, :]
    x, y = corners.T
    # Clockwise: a corner in front goes down.
    outlines = middle + np.stack(
        [x * np.cos(turned) + y * np.sin(turned), y * np.cos(turned) - x * np.sin(turned)], axis=-1
    )
    length = shown_in(xarray.DataArray(outlines, attrs={"units": "m"}), units)
    clock, angle = shown_in(dataset[TIME], units), shown_in(dataset["path_pitch"], units)
    until_rest = slice(0, _end_of_fall(outlines, pitch, float(np.hypot(*corners[0]))))
    time, gap = (clock.factor * dataset[TIME].values)[until_rest], length.factor * gap[until_rest]
    pitch = angle.factor * pitch[until_rest]
    touches = (dataset["path_corners"].values[until_rest] > 0).tolist()

    side, gaps, pitches = figure.subplots(3, 1, height_ratios=(2.6, 1.2, 1.2))
    gaps.sharex(pitches)
    gaps.tick_params(labelbottom=False)
    path = length.factor * np.stack([along, upward])[:, until_rest]
    _draw_side(side, length.factor * outlines[until_rest], path, length.unit, style)
    curve = {"color": style.curve, "linewidth": style.width(1.8), "zorder": 4}
    gaps.plot(time, gap, **curve)
    gaps.set(ylim=padded(0.0, float(gap.max())), ylabel=f"Lowest corner\n({length.unit})")
    pitches.plot(time, pitch, **curve)
    pitches.set(
        ylim=padded(float(pitch.min()), float(pitch.max())),
        ylabel=f"Pitch\n({angle.unit})",
        xlabel=f"Time since the start ({clock.unit})",
        xlim=(time[0], time[-1]),
    )
    for axes in (gaps, pitches):
        style.add_grid(axes)
        axes.fill_between(
            time, 0, 1, where=touches, transform=axes.get_xaxis_transform(),
            facecolor=mix(style.other, style.ground, 0.75), linewidth=0, zorder=0,
        )  # fmt: skip
    figure.align_ylabels([side, gaps, pitches])
    triangle = [(0, 0), (1, 0), (1, 1)]
    entries = [
        Polygon(
            triangle, facecolor=mix(style.curve, style.ground, 0.55), edgecolor=style.curve,
            label="the part, drawn strongest at the end",
        ),
        Line2D([], [], color=style.accent, label="its middle"),
        Polygon(
            triangle, facecolor=mix(style.other, style.ground, 0.75),
            edgecolor=mix(style.other, style.ground, 0.4), label="on the plane",
        ),
    ]  # fmt: skip
    return side, _facts_of_fall(dataset, units), entries


def _draw_side(axes: Axes, outlines: Array, path: Array, unit: str, style: Style) -> None:
    # Outlines, shape (times, 4, 2), equally far apart, and the path of the middle, (2, times).
    steps = np.abs(np.diff(outlines, axis=0)).sum(axis=(1, 2))
    path_length = np.concatenate([[0.0], np.cumsum(steps)])
    indices = np.unique(np.searchsorted(path_length, np.linspace(0.0, path_length[-1], 14)))
    shades = np.linspace(0.75, 0.15, len(indices))
    axes.add_collection(
        LineCollection(
            [np.vstack([outlines[index], outlines[index, :1]]) for index in indices],
            colors=[mix(style.curve, style.ground, float(shade)) for shade in shades],
            linewidths=style.width(0.9), zorder=3,
        )
    )  # fmt: skip
    for index_of_end, weight, paleness in ((0, 1.2, 0.9), (-1, 2.0, 0.55)):
        axes.add_patch(
            Polygon(
                outlines[index_of_end], closed=True, edgecolor=style.curve,
                facecolor=mix(style.curve, style.ground, paleness), linewidth=style.width(weight),
                zorder=4,
            )
        )  # fmt: skip
    axes.plot(*path, color=style.accent, linewidth=style.width(1.0), zorder=5)
    axes.axhline(0.0, color=style.other, linewidth=style.width(1.6), zorder=2)
    x, y = outlines[..., 0], outlines[..., 1]
    low, high = padded(min(0.0, float(y.min())), float(y.max()))
    axes.axhspan(low, 0.0, facecolor=mix(style.other, style.ground, 0.5), linewidth=0, zorder=1)
    axes.set(xlim=padded(float(x.min()), float(x.max())), ylim=(low, high))
    axes.set_aspect("equal", adjustable="box", anchor="W")
    axes.set(xlabel=f"Along the plane ({unit})", ylabel=f"Height\n({unit})")


def _end_of_fall(outlines: Array, pitch: Array, size: float) -> int:
    """Return the number of times to show of a trajectory: until shortly after the part rests."""
    still = np.abs(outlines - outlines[-1]).max(axis=(1, 2)) < STILL * size
    still &= np.abs(pitch - pitch[-1]) < STILL * 360
    moving = np.flatnonzero(~still)
    last = int(moving[-1]) + 1 if moving.size else len(pitch)
    return min(len(pitch), max(2, int(np.ceil(last * (1 + 0.12)))))


def _facts_of_fall(dataset: xarray.Dataset, units: ShownUnits) -> list[str]:
    facts = []
    side, settling_time = dataset.get("resting_side"), dataset.get("settling_time")
    if side is not None and not side.ndim and np.isfinite(side):
        facts.append(f"rests on {QUANTITIES['resting_side'].words.get(int(side), 'a side')}")
    if settling_time is not None and not settling_time.ndim and np.isfinite(settling_time):
        shown = units.of("s", float(settling_time))
        facts.append(
            f"after {with_unit(number(shown.factor * float(settling_time), 3), shown.unit)}"
        )
    sentence = [" ".join(facts).replace(" ", SPACE)] if facts else []
    return sentence + held_fixed(dataset, units)
