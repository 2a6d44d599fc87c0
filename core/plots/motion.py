"""The picture of one motion: of a part on the moving track, or of one that tumbles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import parse_json
from vibrafeed.core.kinds.results import prepare, tabulate
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.parts import padded
from vibrafeed.core.plots.pictures import PlotError, unreadable
from vibrafeed.core.plots.selection import check_result, held_fixed
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import number, shown_in, with_unit
from vibrafeed.core.plots.trajectory import TIME, check_trajectory, draw_trajectory, read_trajectory
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study import SimulateStudy
from vibrafeed.core.study.shown import ShownUnits

TIMES = 400  # points of a trajectory that is computed for a picture
NEEDED = ("path_along", "path_height", "path_pitch", "path_gap", "path_corners", "length")
HEIGHTS = ("height", "diameter")  # of a part, whichever it has
PANELS = (2.6, 1.2, 1.2)  # relative heights of the panels
OUTLINES = 14  # of the part, drawn between start and end
QUIET_TAIL = 0.12  # of the time shown, after the last change
STILL = 1e-3  # of the part's size, and of a turn

Array = NDArray[np.float64]


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one simulated part, or a motion over a cycle."""
    asked = (options.variable, options.axes) != (None, None)
    return not asked and (TIME in dataset.dims or followed(dataset) is not None)


def followed(dataset: xarray.Dataset) -> Prepared | None:
    """Return the study of a dataset's single cell, prepared to be followed over a cycle, or None.

    So a result without a trajectory can be drawn as a motion. None if there are several cells, no
    study of a motion, or a method that gives no trajectory.
    """
    text = str(dataset.attrs.get("study", ""))
    if "motion_status" not in dataset or any(one.size > 1 for one in dataset.values()) or not text:
        return None
    try:
        study = parse_json(text)
        if not isinstance(study, SimulateStudy):
            return None
        return prepare(study.model_copy(update={"trajectory": TIMES}))
    except VibrafeedError:
        return None


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of the motion of a dataset's single part over time.

    A dataset without a time axis but with one cell is followed in time first. The picture of a
    tumbling part shows its path, that of any other how it moves on the track.

    Raises
    ------
    PlotError
        If the dataset has no single motion, or an option does not apply to it.
    """
    check_result(dataset)
    style = options.style
    if TIME not in dataset.dims and options.is_natural and (one := followed(dataset)) is not None:
        dataset = tabulate(one).to_xarray()
    figure = style.sheet()
    check_trajectory(dataset)
    if "path_gap" in dataset:
        course = read_tumbling(dataset, options.units)
        top, entries = draw_tumbling(figure, course, style)
        name, facts = "Trajectory of the part as it falls and tumbles", course.facts
    else:
        trajectory = read_trajectory(dataset, options.units)
        top, entries = draw_trajectory(figure, trajectory, style)
        name, facts = "Motion of the part on the moving track", trajectory.facts
    return finish(
        figure, top, style, name=options.title or name, facts=facts, source=source_of(dataset),
        entries=entries,
    )  # fmt: skip


class TumblingTrajectory(NamedTuple):
    """The trajectory of one tumbling part, in the units in which it is drawn.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times, in `time_unit`.
    along, upward, gap : ndarray, shape (n,)
        Position of the part's middle, and height of its lowest corner, in `length_unit`.
    pitch : ndarray, shape (n,)
        Pitch, clockwise, in `pitch_unit`.
    outlines : ndarray, shape (n, 4, 2)
        The corners of the part, in `length_unit`.
    touches : ndarray of bool, shape (n,)
        True while a corner is on the plane.
    facts : list of str
        The final state, and every parameter, in words.
    """

    time: Array
    time_unit: str
    along: Array
    upward: Array
    gap: Array
    length_unit: str
    pitch: Array
    pitch_unit: str
    outlines: Array
    touches: NDArray[np.bool_]
    facts: list[str]


def read_tumbling(dataset: xarray.Dataset, units: ShownUnits) -> TumblingTrajectory:
    """Return the trajectory of a dataset's tumbling part, a rectangle, in the units that are drawn.

    The dataset has position, pitch and gap to the plane over the axis `time`; the outline of the
    part at each time is made from them and its length and height. It ends where the caller's
    picture would show no more motion. `units` are those that the reader wants.

    Raises
    ------
    PlotError
        If the dataset lacks a variable of the motion, or holds no values.
    """
    known = {**dataset.data_vars, **dataset.coords}
    heights = [name for name in HEIGHTS if name in known]
    missing = [*(name for name in NEEDED if name not in known), *(() if heights else HEIGHTS)]
    if missing:
        raise unreadable(f"its motion has no {missing[0]}")
    dataset = dataset.sortby(TIME)
    along, upward, pitch, gap = (
        np.asarray(dataset[name].values, dtype=np.float64) for name in NEEDED[:4]
    )
    if not np.isfinite(upward).all():
        raise PlotError("dataset", "the dataset has no values of the motion", "Draw another result")
    corners = (
        0.5
        * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        * np.array([float(dataset["length"]), float(dataset[heights[0]])])
    )
    turned = np.deg2rad(pitch)[:, np.newaxis]
    middle = np.stack([along, upward], axis=-1)[:, np.newaxis, :]
    x, y = corners.T
    # Clockwise: a corner in front goes down.
    outlines = middle + np.stack(
        [x * np.cos(turned) + y * np.sin(turned), y * np.cos(turned) - x * np.sin(turned)], axis=-1
    )
    length = shown_in(xarray.DataArray(outlines, attrs={"units": "m"}), units)
    time, angle = shown_in(dataset[TIME], units), shown_in(dataset["path_pitch"], units)
    shown = slice(0, _end(outlines, pitch, float(np.hypot(*corners[0]))))
    return TumblingTrajectory(
        time=(time.factor * dataset[TIME].values)[shown],
        time_unit=time.unit,
        along=length.factor * along[shown],
        upward=length.factor * upward[shown],
        gap=length.factor * gap[shown],
        length_unit=length.unit,
        pitch=angle.factor * pitch[shown],
        pitch_unit=angle.unit,
        outlines=length.factor * outlines[shown],
        touches=dataset["path_corners"].values[shown] > 0,
        facts=_facts(dataset, units),
    )


def draw_tumbling(
    figure: Figure, shown: TumblingTrajectory, style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw the trajectory of a tumbling part; return the upper axes and legend entries.

    Panels show the part from the side, the height of its lowest corner over the plane, and its
    pitch over time; times at which it touches the plane are shaded. `shown` has the values in the
    units of the picture.
    """
    side, gaps, pitches = figure.subplots(3, 1, height_ratios=PANELS)
    gaps.sharex(pitches)
    gaps.tick_params(labelbottom=False)
    _draw_side(side, shown, style)
    gaps.plot(shown.time, shown.gap, color=style.curve, linewidth=style.width(1.8), zorder=4)
    gaps.set_ylim(*padded(0.0, float(shown.gap.max())))
    gaps.set_ylabel(f"Lowest corner\n({shown.length_unit})")
    pitches.plot(shown.time, shown.pitch, color=style.curve, linewidth=style.width(1.8), zorder=4)
    pitches.set_ylim(*padded(float(shown.pitch.min()), float(shown.pitch.max())))
    pitches.set_ylabel(f"Pitch\n({shown.pitch_unit})")
    pitches.set_xlabel(f"Time since the start ({shown.time_unit})")
    pitches.set_xlim(shown.time[0], shown.time[-1])
    for axes in (gaps, pitches):
        style.add_grid(axes)
        axes.fill_between(
            shown.time, 0, 1, where=shown.touches.tolist(), transform=axes.get_xaxis_transform(),
            facecolor=mix(style.other, style.ground, 0.75), linewidth=0, zorder=0,
        )  # fmt: skip
    figure.align_ylabels([side, gaps, pitches])
    return side, _entries(style)


def _draw_side(axes: Axes, shown: TumblingTrajectory, style: Style) -> None:
    """Draw a tumbling part from the side: outlines equally far apart, and the path of its middle.

    The first and the last outline are filled; the plane on which the part falls is at height 0.
    `shown` has the outlines, shape (times, 4, 2), and the path in the units of the picture.
    """
    moved = np.abs(np.diff(shown.outlines, axis=0)).sum(axis=(1, 2))
    passed = np.concatenate([[0.0], np.cumsum(moved)])
    chosen = np.unique(np.searchsorted(passed, np.linspace(0.0, passed[-1], OUTLINES)))
    shades = np.linspace(0.75, 0.15, len(chosen))
    outlines = [shown.outlines[k] for k in chosen]
    axes.add_collection(
        LineCollection(
            [np.vstack([corners, corners[:1]]) for corners in outlines],
            colors=[mix(style.curve, style.ground, float(shade)) for shade in shades],
            linewidths=style.width(0.9), zorder=3,
        )
    )  # fmt: skip
    for place, weight, face in ((0, 1.2, 0.9), (-1, 2.0, 0.55)):
        axes.add_patch(
            Polygon(
                shown.outlines[place], closed=True, edgecolor=style.curve,
                facecolor=mix(style.curve, style.ground, face), linewidth=style.width(weight),
                zorder=4,
            )
        )  # fmt: skip
    axes.plot(shown.along, shown.upward, color=style.accent, linewidth=style.width(1.0), zorder=5)
    axes.axhline(0.0, color=style.other, linewidth=style.width(1.6), zorder=2)
    x, y = shown.outlines[..., 0], shown.outlines[..., 1]
    low, high = padded(min(0.0, float(y.min())), float(y.max()))
    axes.axhspan(low, 0.0, facecolor=mix(style.other, style.ground, 0.5), linewidth=0, zorder=1)
    axes.set_xlim(*padded(float(x.min()), float(x.max())))
    axes.set_ylim(low, high)
    axes.set_aspect("equal", adjustable="box", anchor="W")
    axes.set_xlabel(f"Along the plane ({shown.length_unit})")
    axes.set_ylabel(f"Height\n({shown.length_unit})")


def _end(outlines: Array, pitch: Array, size: float) -> int:
    """Return the number of times to show of a trajectory: until shortly after the part rests.

    `outlines` are the part's corners, shape (times, 4, 2), `size` the length by which rest is
    judged, in the same unit; `pitch` is in degrees, shape (times,).
    """
    still = np.abs(outlines - outlines[-1]).max(axis=(1, 2)) < STILL * size
    still &= np.abs(pitch - pitch[-1]) < STILL * 360
    moving = np.flatnonzero(~still)
    last = int(moving[-1]) + 1 if moving.size else len(pitch)
    return min(len(pitch), max(2, int(np.ceil(last * (1 + QUIET_TAIL)))))


def _facts(dataset: xarray.Dataset, units: ShownUnits) -> list[str]:
    """Return the lines below the title of a tumbling part's picture: how it rests, parameters.

    Each is a text with non-breaking spaces; `units` are those that the reader wants.
    """
    facts = []
    side, settled = dataset.get("resting_side"), dataset.get("settling_time")
    if side is not None and not side.ndim and np.isfinite(side):
        facts.append(f"rests on {QUANTITIES['resting_side'].words.get(int(side), 'a side')}")
    if settled is not None and not settled.ndim and np.isfinite(settled):
        shown = units.of("s", float(settled))
        after = with_unit(number(shown.factor * float(settled), 3), shown.unit)
        facts.append(f"after {after}")
    words = [" ".join(facts)] if facts else []
    return [word.replace(" ", "\N{NO-BREAK SPACE}") for word in words] + held_fixed(dataset, units)


def _entries(style: Style) -> list[Artist]:
    """Return the legend entries for a tumbling part: part, path of its middle, contact.

    The contact is the time at which the part touches the plane.
    """
    patch = Polygon([(0, 0), (1, 0), (1, 1)], facecolor=mix(style.curve, style.ground, 0.55))
    patch.set(edgecolor=style.curve, label="the part, drawn strongest at the end")
    touch = Polygon([(0, 0), (1, 0), (1, 1)], facecolor=mix(style.other, style.ground, 0.75))
    touch.set(edgecolor=mix(style.other, style.ground, 0.4), label="on the plane")
    return [patch, Line2D([], [], color=style.accent, label="its middle"), touch]
