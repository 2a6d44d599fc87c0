"""An output over one parameter, with the values marked at which the motion becomes another one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibrafeed.core.plots.heading import finish, source_of, text_width
from vibrafeed.core.plots.line import draw_line
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.regimes import looks_of
from vibrafeed.core.plots.selection import Selection, select
from vibrafeed.core.plots.sliced import check_result
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import long_name, number, with_unit, words

SPEED = "conveying_velocity"
MULTIPLE = "period_multiple"
TOUCHING = ("stick", "slip", "stick_slip", "no_motion", "sliding", "roll")
REPEATING = ("hopping", "hop_after_hop")
STILL = 0.01  # of the largest speed: slower parts count as having no direction
TEXT = 8.5  # points: size of a label's letters
ROW = 1.7  # height of a row of labels, in lines of text
GAP = 5.0  # dots between a line and its label

INTO = {
    "period_doubled": "period doubles",
    "aperiodic": "stops repeating",
    "runaway": "runs away",
    "flight": "lifts off",
}
BETWEEN = {
    ("slip", "stick_slip"): "sticks in between",
    ("stick_slip", "slip"): "slides all the time",
    ("hopping", "hop_after_hop"): "hops without a rest",
    ("hop_after_hop", "hopping"): "rests between hops",
}


@dataclass(frozen=True)
class Threshold:
    """A value of the axis, what happens there, and whether it is the best one."""

    position: float
    says: str
    best: bool = False


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """Return False: this picture is drawn on request only."""
    return False


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of an output over one parameter, with its thresholds marked.

    At thresholds the motion changes, such as from sliding to hopping. Each kind is marked where it
    comes first; the best value is that of the largest size, positive or negative.

    Raises
    ------
    PlotError
        If the dataset does not have what is asked for.
    """
    check_result(dataset)
    style, units, axes, at = options.style, options.units, options.axes, options.at
    nearest = options.nearest
    if axes is not None and len(axes) != 1:
        raise PlotError(
            "axes",
            f"a picture of kind thresholds takes one axis, not {len(axes)}",
            "Name one axis, such as amplitude",
        )
    variable = options.variable or (SPEED if SPEED in dataset.data_vars else None)
    selection = select(dataset, variable, axes, at, "line", units, nearest=nearest)
    if selection.categories:
        message = f"{selection.variable.name} has a name in each cell, not a number"
        raise PlotError("variable", message, "Choose another output, or leave out kind")
    looks = looks_of(selection.regime, selection.regimes, style, exact=selection.exact)
    figure = style.sheet()
    top, entries = draw_line(figure, selection, looks, style)
    names = {look.value: look.name for look in looks}
    states = [names[value] for value in selection.regimes.tolist()]
    valid = np.array([look.valid for look in looks])[
        np.searchsorted([look.value for look in looks], selection.regimes)
    ]
    multiples = None
    if MULTIPLE in dataset and selection.axes[0].name in dataset[MULTIPLE].dims:
        chosen = (selection.axes[0].name,)
        multiples = select(dataset, MULTIPLE, chosen, at, "line", units, nearest=nearest)
    thresholds, left = find_thresholds(
        selection.axes[0].values,
        np.where(valid, selection.values, np.nan),
        states,
        None if multiples is None else multiples.values,
        selection.unit,
    )
    _mark(figure, top, thresholds, selection, style)
    note = f"Thresholds are known to half a step of {_step(selection)}."
    if left:
        note += f" {left} later changes of these kinds are not marked."
    name = options.title or f"{long_name(selection.variable)} and its thresholds"
    return finish(
        figure, top, style, name=name,
        facts=selection.fixed, source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip


def find_thresholds(
    axis: NDArray[np.float64],
    values: NDArray[np.float64],
    states: Sequence[str],
    multiples: NDArray[np.float64] | None,
    unit: str,
) -> tuple[list[Threshold], int]:
    """Return the first threshold of each kind along an axis, and the number of later ones.

    Thresholds are changes of the regime or of the number of periods after which the motion repeats,
    the point where parts reverse, and the best value. They lie half-way between two points.

    Parameters
    ----------
    axis, values : ndarray, shape (n,)
        Values of the parameter, ascending, and of the output; NaN where it is not valid.
    states : sequence of str, length n
        Names of the regimes.
    multiples : ndarray, shape (n,), or None
        Number of periods after which the motion repeats; 0 where it does not.
    unit : str
        Unit of the output.
    """
    thresholds: list[Threshold] = []
    changes = 0
    between = (axis[:-1] + axis[1:]) / 2
    limit = STILL * np.nanmax(np.abs(values)) if np.isfinite(values).any() else np.nan
    for i, value in enumerate(between):
        says = []
        if states[i] != states[i + 1]:
            says.append(_change(states[i], states[i + 1]))
        elif multiples is not None and _multiple(multiples[i]) != _multiple(multiples[i + 1]):
            says.append(_repeats(_multiple(multiples[i + 1])))
        changes += len(says)
        known = {threshold.says for threshold in thresholds}
        thresholds += [Threshold(float(value), text) for text in says if text not in known]
    left = changes - len(thresholds)
    turns = _turn(axis, values, limit)
    thresholds += [] if turns is None else [turns]
    if np.isfinite(limit) and limit > 0:
        best = int(np.nanargmax(np.abs(values)))
        text = f"best, {with_unit(number(float(values[best]), 3), unit)}"
        thresholds.append(Threshold(float(axis[best]), text, best=True))
    return sorted(thresholds, key=lambda threshold: threshold.position), left


def _change(before: str, after: str) -> str:
    """Return the change from one regime to the next in words; both are names of regimes.

    It is the label of a threshold in a picture, such as "lifts off".
    """
    if before in ("stick", "no_motion"):
        return "starts to move"
    if after in ("stick", "no_motion"):
        return "sticks"
    if (before, after) in BETWEEN:
        return BETWEEN[before, after]
    if before in TOUCHING and after not in TOUCHING:
        return "lifts off"
    if after in REPEATING and before not in TOUCHING:
        return "one period again"
    if after in TOUCHING and before not in TOUCHING:
        return "stays on the track"
    return INTO.get(after, words(after))


def _multiple(value: float) -> int:
    """Return a period multiple as an integer, 0 for NaN."""
    return int(value) if np.isfinite(value) else 0


def _repeats(multiple: int) -> str:
    """Return the period multiple in words."""
    return f"repeats after {multiple} periods" if multiple else "stops repeating"


def _turn(axis: NDArray[np.float64], values: NDArray[np.float64], limit: float) -> Threshold | None:
    """Return the first threshold at which parts reverse their direction; None if they do not.

    `axis` are the values of the parameter, ascending, and `values` the velocities there, both of
    shape (n,); the position of the threshold is interpolated. `limit` is the speed below which a
    part counts as having no direction, in the unit of `values`.
    """
    moving = np.flatnonzero(np.abs(np.nan_to_num(values)) > limit)
    for before, after in pairwise(moving):
        if values[before] * values[after] < 0:
            share = values[before] / (values[before] - values[after])
            position = float(axis[before] + share * (axis[after] - axis[before]))
            return Threshold(position, "turns backward" if values[after] < 0 else "turns forward")
    return None


def _mark(
    figure: Figure,
    axes: Axes,
    thresholds: Sequence[Threshold],
    selection: Selection,
    style: Style,
) -> None:
    """Mark thresholds on a curve: a vertical line and a label for each, a star at the best value.

    The labels are stacked in rows above the curve so that none hides another; the upper limit of
    the vertical axis is raised to make room for them.

    Parameters
    ----------
    thresholds : sequence of Threshold
        Position on the horizontal axis, text, and whether it is that of the best value.
    selection : Selection
        The curve: its axis and its values, in the units that the picture shows.
    """
    size = style.text(TEXT)
    low, high = axes.get_ylim()
    figure.draw_without_rendering()
    frame = axes.get_window_extent()
    line = size * figure.dpi / 72 * ROW
    rows = _rows(
        [
            _Label(
                threshold,
                text := _label(threshold, selection),
                float(axes.transData.transform((threshold.position, low))[0]),
                text_width(figure, text, size, "bold" if threshold.best else "normal") + 2 * GAP,
            )
            for threshold in thresholds
        ],
        float(frame.x0),
        float(frame.x1),
    )
    count = 1 + max((row for _, row, _ in rows), default=-1)
    share = min(0.6, (count + 0.6) * line / frame.height)
    top = low + (high - low) / (1 - share)
    axes.set_ylim(low, top)
    height = (top - low) * line / frame.height
    for (threshold, text, _, _), row, leftward in rows:
        colour = style.accent if threshold.best else style.ink
        level = high + (row + 0.55) * height
        axes.vlines(
            threshold.position, low, level, color=colour, linewidth=style.width(1.1),
            linestyle="solid" if threshold.best else (0, (4, 2)), zorder=4,
        )  # fmt: skip
        axes.annotate(
            text, (threshold.position, level), (-GAP if leftward else GAP, 0),
            textcoords="offset pixels", ha="right" if leftward else "left", va="center",
            fontsize=size, color=colour, fontweight="bold" if threshold.best else "normal",
            zorder=7, path_effects=[withStroke(linewidth=2.5, foreground=style.ground)],
        )  # fmt: skip
        if threshold.best:
            value = selection.values[np.abs(selection.axes[0].values - threshold.position).argmin()]
            axes.plot(
                [threshold.position], [value], "*", color=colour, markersize=style.width(12),
                markeredgecolor=style.ground, zorder=8,
            )  # fmt: skip


class _Label(NamedTuple):
    """A threshold, what is written at its line, where that line is and how wide the text [dots]."""

    threshold: Threshold
    text: str
    x: float
    width: float


def _rows(labels: Sequence[_Label], left: float, right: float) -> list[tuple[_Label, int, bool]]:
    """Return each label with its row above the curve, and True if it is left of its line.

    Labels name thresholds, marked by vertical lines; no line runs through a label. `labels` have a
    position and a width, ascending; `left` and `right` are the ends of the frame, all in dots.
    Labels that find no room to the right of their lines stand to the left. Of labels on the right,
    those further to the left lie higher; of labels on the left, those further to the right.
    """
    limit, leftward = right, []
    for label in reversed(labels):
        turned = label.x + label.width > limit and label.x - label.width > left
        leftward.append(turned)
        limit = min(limit, label.x) if turned else limit
    sides = leftward[::-1]
    first = [i for i in reversed(range(len(labels))) if not sides[i]]
    rows: dict[int, int] = {}
    for i in [*first, *(i for i in range(len(labels)) if sides[i])]:
        mine = _span(labels[i], sides[i])
        met = [
            rows[j]
            for j in rows
            if (other := _span(labels[j], sides[j]))[0] < mine[1] and mine[0] < other[1]
        ]
        rows[i] = max(met, default=-1) + 1
    return [(labels[i], rows[i], sides[i]) for i in range(len(labels))]


def _span(label: _Label, leftward: bool) -> tuple[float, float]:
    """Return left and right end of a label [dots]."""
    return (label.x - label.width, label.x) if leftward else (label.x, label.x + label.width)


def _label(threshold: Threshold, selection: Selection) -> str:
    """Return the label of a threshold in a picture: what happens, and at which value of the axis.

    `selection` has the axis; the value has as many digits as its step allows.
    """
    axis = selection.axes[0]
    step = float(np.diff(axis.values).max())
    digits = 3
    if threshold.position:
        digits = max(2, int(np.ceil(np.log10(abs(threshold.position) / step) + 1)))
    value = with_unit(number(threshold.position, min(digits, 6)), axis.unit)
    if not threshold.best:
        return f"{threshold.says} {value}"
    ends = axis.values[[0, -1]]
    return f"{threshold.says} at {value}" + (", an end" if threshold.position in ends else "")


def _step(selection: Selection) -> str:
    """Return the largest step of the axis with its unit."""
    axis = selection.axes[0]
    return with_unit(number(float(np.diff(axis.values).max()), 2), axis.unit)
