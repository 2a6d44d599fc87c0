"""Motions to be drawn: the frames of an animation of one part, and a row of parts."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibrafeed.core.kinds.results import tabulate
from vibrafeed.core.motion.row_scene import ROW
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plots.parts import finish, padded, source_of
from vibrafeed.core.plots.pictures import PlotError, unreadable
from vibrafeed.core.plots.selection import check_result, held_fixed
from vibrafeed.core.plots.style import Array, Options, mix, number, scaled, shown_in, with_unit
from vibrafeed.core.plots.trajectory import (
    LEGEND,
    TIME,
    check_trajectory,
    mode_intervals,
    no_motion,
    read_trajectory,
    study_of_motion,
    values_of,
)
from vibrafeed.core.scenes import ALIASES
from vibrafeed.core.study.shown import Shown, ShownUnits

FRAMES_PER_SECOND = 25
MAX_FRAMES = 1000
TURN = 2 * np.pi

PERIOD_SHOWN = 1.0  # s of the animation for a period of the drive, roughly
FALL_SHOWN = 6.0  # s of the animation for a whole fall, roughly
AFTER_REST = 1.15  # of the time until a tumbling part rests: so long it is shown

PART_LENGTH = 1.3  # of the track's stroke: drawn length of a part, which the model does not know
PART_SHAPE = 0.45  # height over length
TRAVEL = 3.0  # in lengths of the part: travel for which cycles are repeated
MAX_CYCLES = 6  # repetitions at most
CLOSED = 1e-3  # of what the track covers: a course that ends no further from its start repeats
GAP_SEEN = 0.2  # of the part's height: a largest gap that is less is drawn larger

CORNERS = {"flight": "in flight", "corner": "on a corner", "side": "on a side"}
FIRST = "part_position_1"
PALE = 0.25


class Film(NamedTuple):
    """The frames of an animation; lengths in `unit`.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Times [s].
    track, part : ndarray, shape (2, n)
        Displacement of the track, and middle of the part in the fixed frame, along and upward.
    pitch : ndarray, shape (n,)
        How far the part has turned, clockwise [rad].
    outline : ndarray, shape (2, k)
        The part's outline about its middle, at pitch 0.
    modes : list of str, length n
        What the part does, keys of `mode_names`, which has the words.
    intervals : tuple of (str, float, float)
        What it does from when to when [s]; it may be shorter than a frame.
    slow : float
        How many times slower it is shown.
    facts, notes : tuple of str
        What is held fixed; how the picture differs from the truth.
    """

    times: Array
    track: Array
    part: Array
    pitch: Array
    outline: Array
    modes: list[str]
    mode_names: Mapping[str, str]
    intervals: tuple[tuple[str, float, float], ...]
    unit: str
    slow: float
    facts: tuple[str, ...]
    notes: tuple[str, ...] = ()


def read_film(dataset: xarray.Dataset, units: ShownUnits, slow: float | None = None) -> Film:
    """Return the frames of the trajectory in a dataset, a simulation of one part.

    `slow` is the slow-motion factor; by default a period takes about a second, a fall six.
    `PlotError` tells that there is no trajectory, or that the animation would be too long.
    """
    if slow is not None and not (np.isfinite(slow) and slow > 0):
        raise PlotError(
            "slow", f"the slow-motion factor '{slow:g}' is not above 0", "Give a number such as 50"
        )
    check_trajectory(dataset)
    return (_film_of_fall if "path_height" in dataset else _film_on_track)(dataset, units, slow)


def _film_on_track(dataset: xarray.Dataset, units: ShownUnits, slow: float | None) -> Film:
    """Return the frames of a part on a track, over enough cycles for the part to travel visibly.

    The part is drawn as a box, not to scale; its gap to the track is enlarged if it is too small to
    be seen, and notes say so.
    """
    trajectory = read_trajectory(dataset, units)
    dataset = dataset.sortby(TIME)
    time = values_of(dataset[TIME])
    position, height, along, normal = (
        values_of(dataset[name])
        for name in ("position_along", "height_above_floor", "track_along", "track_normal")
    )
    if not np.isfinite([position, height, along, normal]).all():
        raise no_motion(", because the simulation found no cycle")
    span = max(float(np.hypot(np.ptp(along), np.ptp(normal))), float(height.max()))
    if span == 0:
        raise no_motion(": neither the track nor the part moves")
    shown = units.of("m", span)
    length = PART_LENGTH * span
    cycles = _cycles(dataset, time, span, length)
    slow = slow or nice_number(PERIOD_SHOWN * float(dataset["frequency"]))
    duration = time[-1] - time[0]
    frames = frames_in(cycles * duration * slow)
    moments = np.arange(frames) * (cycles * duration / frames)
    periods, in_cycle = np.divmod(moments, duration)
    in_cycle += time[0]

    def at_frames(values: Array) -> Array:
        return np.asarray(shown.factor * np.interp(in_cycle, time, values))

    notes = [f"part not to scale ({_name_length(dataset, units)})"]
    gap, least_seen = float(height.max()), GAP_SEEN * (PART_SHAPE * length)
    exaggeration = nice_number(least_seen / gap) if 0 < gap < least_seen else 1.0
    if exaggeration > 1:
        notes.append(f"gap {number(exaggeration)} times as large")
    if cycles > 1:
        notes.append(f"cycle shown {cycles} times")
    climb = float(dataset["gamma"]) if "gamma" in dataset else 0.0  # degrees, as files hold angles
    if climb:
        verb = "climbs" if climb > 0 else "falls"
        notes.append(f"seen along the track, which {verb} by {number(abs(climb))}\N{DEGREE SIGN}")
    track = np.stack([at_frames(along), at_frames(normal)])
    travel = at_frames(position) + shown.factor * periods * (position[-1] - position[0])
    half_size = shown.factor * np.array([length, PART_SHAPE * length]) / 2
    modes = [mode if mode in LEGEND else "unknown" for mode in trajectory.modes]
    return Film(
        times=moments + time[0],
        track=track,
        part=track + np.stack([travel, half_size[1] + exaggeration * at_frames(height)]),
        pitch=np.zeros(frames),
        outline=_box(*half_size),
        modes=_modes_at(modes, time, in_cycle),
        mode_names={**LEGEND, "unknown": "unknown"},
        intervals=tuple(
            (mode, start + k * duration, stop + k * duration)
            for k in range(cycles)
            for mode, start, stop in mode_intervals(modes, time)
        ),
        unit=shown.unit,
        slow=slow,
        facts=tuple(trajectory.facts),
        notes=tuple(notes),
    )


def _name_length(dataset: xarray.Dataset, units: ShownUnits) -> str:
    if "length" not in dataset or dataset["length"].ndim:
        return "no size in the model"
    shown = shown_in(dataset["length"], units)
    return f"{with_unit(number(shown.factor * float(dataset['length'])), shown.unit)} long"


def _film_of_fall(dataset: xarray.Dataset, units: ShownUnits, slow: float | None) -> Film:
    """Return the frames of an animation of a tumbling part, until shortly after it rests."""
    dataset = dataset.sortby(TIME)
    time = values_of(dataset[TIME])
    along, upward, pitch = (
        values_of(dataset[f"path_{name}"]) for name in ("along", "height", "pitch")
    )
    is_known = np.isfinite(along) & np.isfinite(upward) & np.isfinite(pitch)
    if is_known.sum() < 2:
        raise PlotError("dataset", "the dataset has no values of the motion", "Draw another result")
    end = time[is_known][-1]
    settling_time = float(dataset["settling_time"]) if "settling_time" in dataset else np.nan
    if np.isfinite(settling_time):
        end = min(end, time[0] + AFTER_REST * settling_time)
    slow = slow or nice_number(FALL_SHOWN / (end - time[0]))
    moments = np.linspace(time[0], end, frames_in((end - time[0]) * slow))
    shown = units.of("m", float(upward[is_known].max()))
    frequency, beta = (
        float(dataset[name]) if name in dataset.coords else 0.0 for name in ("frequency", "beta")
    )
    amplitude = shown.factor * (amplitude_of(dataset) or 0.0)
    displacement = amplitude * np.sin(TURN * frequency * moments)
    track = np.stack(
        [displacement * np.cos(np.deg2rad(beta)), displacement * np.sin(np.deg2rad(beta))]
    )

    def at_frames(values: Array) -> Array:
        return np.asarray(np.interp(moments, time[is_known], values[is_known]))

    corners = np.nan_to_num(values_of(dataset["path_corners"]))
    modes = [[*CORNERS][int(min(count, 2))] for count in corners]
    return Film(
        times=moments,
        track=track,
        part=track + shown.factor * np.stack([at_frames(along), at_frames(upward)]),
        pitch=np.deg2rad(at_frames(pitch)),
        outline=shown.factor * _outline(dataset),
        modes=_modes_at(modes, time, moments),
        mode_names=CORNERS,
        intervals=tuple(
            (mode, start, min(stop, end))
            for mode, start, stop in mode_intervals(modes, time)
            if start < end
        ),
        unit=shown.unit,
        slow=slow,
        facts=tuple(held_fixed(dataset, units)),
    )


def _modes_at(modes: Sequence[str], time: Array, moments: Array) -> list[str]:
    """Return the mode at the last of some times that is not after each moment."""
    indices = np.searchsorted(time, moments, side="right") - 1
    return [modes[max(0, int(index))] for index in indices]


def _outline(dataset: xarray.Dataset) -> Array:
    """Return the outline of a tumbling part seen from the side, shape (2, k) [m]."""
    size = {
        name: float(dataset[name]) for name in ("length", "height", "diameter") if name in dataset
    }
    if "length" in size and len(size) > 1:
        across = size.get("height", size.get("diameter", 0.0))
        return _box(size["length"] / 2, across / 2)
    if "diameter" not in size:
        raise unreadable("it does not say how large the part is")
    around = np.linspace(0.0, TURN, 73)
    circle = np.stack([np.cos(around), np.sin(around)]) * size["diameter"] / 2
    return np.concatenate([np.zeros((2, 1)), circle], axis=1)  # a radius shows how it turns


def _box(half_length: float, half_height: float) -> Array:
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    return corners.T * np.array([[half_length], [half_height]])


def _cycles(dataset: xarray.Dataset, time: Array, span: float, length: float) -> int:
    """Return the number of times a film shows a trajectory: until travel is seen, if it repeats.

    It repeats if it ends as it began, within a share of the extent `span` [m] of the motion.
    `length` is that of the drawn part [m].
    """
    periods = (time[-1] - time[0]) * float(dataset["frequency"])
    repeats = all(
        abs(float(dataset[name][-1] - dataset[name][0])) <= CLOSED * span
        for name in ("height_above_floor", "track_along", "track_normal")
    )
    if not repeats or round(periods) < 1 or abs(periods - round(periods)) > CLOSED:
        return 1
    travel = abs(float(dataset["position_along"][-1] - dataset["position_along"][0]))
    # So often that the part travels some of its lengths.
    cycles = TRAVEL * length / travel if travel > 0 else 2.0
    return int(np.clip(round(min(cycles, MAX_CYCLES)), 1, max(1, MAX_CYCLES // round(periods))))


def amplitude_of(dataset: xarray.Dataset) -> float | None:
    """Return the amplitude of the sine of one design, zero to peak [m]; None if it has none.

    The study may give it, a stroke, or a vertical amplitude.
    """
    scalars = {
        str(name): coordinate for name, coordinate in dataset.coords.items() if coordinate.ndim == 0
    }
    if "amplitude" in scalars:
        return float(scalars["amplitude"])
    for alias in ALIASES:
        if alias.gives == "amplitude" and set(alias.inputs) <= set(scalars):
            values = {
                name: parameter_to_si(name, np.asarray(scalars[name].values))
                for name in alias.inputs
            }
            return float(alias.function(**values))
    return None


def frames_in(seconds: float) -> int:
    """Return the number of frames in a film of some seconds; `PlotError` if it is above 1,000."""
    frames = max(2, round(seconds * FRAMES_PER_SECOND))
    if frames > MAX_FRAMES:
        raise PlotError(
            "slow",
            f"the animation would have {frames:,} frames, at most {MAX_FRAMES:,} are drawn",
            "Give a smaller slow-motion factor, or a shorter trajectory",
        )
    return frames


def nice_number(value: float, *, below: bool = False) -> float:
    """Return the number of the form 1, 2 or 5 times a power of ten nearest to a value, or below."""
    power = 10.0 ** np.floor(np.log10(value))
    choices = [step * power for step in (1.0, 2.0, 5.0, 10.0)]
    if below:
        choices = [choice for choice in choices if choice <= value * (1 + 1e-9)]
    return float(min(choices, key=lambda choice: abs(np.log(choice / value))))


class RowPositions(NamedTuple):
    """The parts of a row over time, from the rear on, in the units in which they are drawn.

    `times` have the shape (n,), `centres` of the parts on the track (parts, n); `closed` tells
    where a part touches the one in front, shape (parts - 1, n). The length of a part is 0 if the
    study does not have it.
    """

    times: Array
    centres: Array
    length: float
    closed: NDArray[np.bool_]
    time: Shown
    along: Shown


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one row of parts in time, and no output or axes are asked for."""
    if options.asks or dataset.attrs.get("scene") != ROW:
        return False
    return FIRST in dataset or study_of_motion(dataset) is not None


def read_row(dataset: xarray.Dataset, units: ShownUnits) -> RowPositions:
    """Return the positions of a row of parts over time, in the units that are drawn.

    `PlotError` tells that the dataset has no row in time.
    """
    if FIRST not in dataset:
        raise PlotError(
            "dataset",
            "the dataset has no positions of a row of parts over time",
            "Set trajectory = 400 in the study, and run the study again",
        )
    names = [
        f"part_position_{n + 1}" for n in range(len(dataset)) if f"part_position_{n + 1}" in dataset
    ]
    time, along = shown_in(dataset[TIME], units), shown_in(dataset[FIRST], units)
    centres = np.array([scaled(dataset[name], along.factor) for name in names])
    length = scaled(dataset["length"], along.factor).item() if "length" in dataset else 0.0
    # Of the way that is shown: a smaller gap is none.
    closed = np.diff(centres, axis=0) - length <= 1e-9 * np.ptp(centres)
    return RowPositions(scaled(dataset[TIME], time.factor), centres, length, closed, time, along)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a row of parts: positions over time, shaded where parts touch.

    A row without positions over time is followed again to get them. `PlotError` tells that the
    dataset has no row in time.
    """
    check_result(dataset)
    if FIRST not in dataset and (study := study_of_motion(dataset)) is not None:
        dataset = tabulate(study).to_xarray()
    style, units = options.style, options.units
    row = read_row(dataset, units)
    figure = style.sheet()
    axes = figure.add_subplot()
    pale = mix(style.ground, style.curve, PALE)
    for below, above, touch in zip(row.centres, row.centres[1:], row.closed, strict=False):
        axes.fill_between(row.times, below, above, where=touch, color=pale, linewidth=0.0)
    for line in row.centres:
        axes.plot(row.times, line, color=style.curve, linewidth=style.width(1.4))
    axes.set(
        xlabel=f"Time since the start ({row.time.unit})",
        ylabel=f"Position on the track ({row.along.unit})",
        xlim=(row.times[0], row.times[-1]),
        ylim=padded(float(row.centres.min()), float(row.centres.max())),
    )
    entries = [
        Line2D([], [], color=style.curve, linewidth=style.width(1.4), label="centre of a part"),
        Patch(color=pale, label="neighbours that touch"),
    ]
    name = options.title or f"A row of {len(row.centres)} parts, from its start"
    return finish(
        figure, axes, style, name=name,
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries,
    )  # fmt: skip
