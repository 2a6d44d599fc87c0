"""Points and curves of error against cost, and the dataset that holds them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.mechanics.arrays import Array

FAMILIES: dict[str, str] = {
    "closed_forms": "closed forms in floats, against their own equations to 50 digits",
    "motion": "methods of motion, against a reference whose own error is bounded",
    "optimisers": "optimisers, against the exact or the best known answer",
    "storage": "files, against what was written to them",
    "model": "closed forms, against the true motion of the part",
}
"""Every family of measurements: what is compared with what."""

STEEP = -math.inf
"""The slope of a curve whose error falls while its cost hardly changes."""

STEEPEST = 10.0
"""Where the error falls by more than this power of the factor between the costs, these are noise.

No method here has such an order, and between two runs of one method a machine differs as much.
"""


@dataclass(frozen=True)
class Point:
    """One measurement: a method with one setting, over some cells.

    Attributes
    ----------
    setting : str
        The setting in words, such as ``800 steps``.
    value : float
        The number that is set; NaN if there is none.
    error, largest : float
        Median and largest error over the cells; what it is a share of, the family says.
    seconds : float
        Median wall time of one thread for one cell [s].
    cells : int
        Cells behind it.
    more : mapping of str to float
        What else was measured: evaluations, bytes, units in the last place.
    """

    setting: str
    value: float
    error: float
    largest: float
    seconds: float
    cells: int
    more: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Curve:
    """Measurements of one method over its settings, for one subject.

    Attributes
    ----------
    family : str
        A key of `FAMILIES`.
    subject : str
        What is computed: an output, or the group of cells.
    method : str
        By what.
    points : tuple of Point
        In the order of the setting.
    expected : str
        What slope the theory has, in words; empty if none.
    expected_slope : float
        The same as a number; NaN if there is none.
    floor : float
        Errors up to this are those of the reference: they are left out of the fit.
    cost, of : str
        Which numbers the slope relates: ``seconds``, or a key of `Point.more`; ``error`` or a key.
    """

    family: str
    subject: str
    method: str
    points: tuple[Point, ...]
    expected: str = ""
    expected_slope: float = math.nan
    floor: float = 0.0
    cost: str = "seconds"
    of: str = "error"

    @property
    def slope(self) -> float:
        """The slope of the logarithm of error over that of cost; NaN for fewer than two points."""
        pairs = [(numbers_of(p, self.cost), numbers_of(p, self.of)) for p in self.points]
        return fitted_slope(pairs, self.floor)


def numbers_of(point: Point, name: str) -> float:
    """Return a number of a point by its name; NaN if the point lacks it."""
    if name in point.more:
        return float(point.more[name])
    return float(getattr(point, name, math.nan))


def fitted_slope(pairs: Sequence[tuple[float, float]], floor: float = 0.0) -> float:
    """Return the slope of log error over log cost of a benchmark curve, by least squares.

    Parameters
    ----------
    pairs : sequence of (float, float)
        Cost, such as seconds or steps, and error of each point.
    floor : float
        Errors up to this are not fitted: they are those of the reference.

    Returns
    -------
    float
        `STEEP` (minus infinity) where the error falls by more than the tenth power of the ratio of
        the costs, which is then noise; NaN from fewer than two points above the floor, or for equal
        costs.
    """
    used = [(cost, error) for cost, error in pairs if cost > 0 and error > floor]
    used = [pair for pair in used if all(map(math.isfinite, pair))]
    if len(used) < 2:
        return math.nan
    costs, errors = np.array(used).T
    if math.log(errors[0] / errors[-1]) > STEEPEST * math.log(costs.max() / costs.min()):
        return STEEP
    if costs.max() == costs.min():
        return math.nan
    return float(np.polyfit(np.log(costs), np.log(errors), 1)[0])


@dataclass(frozen=True)
class Measured:
    """The measurements of one family for one study.

    Attributes
    ----------
    family : str
        A key of `FAMILIES`.
    curves : tuple of Curve
        The measurements.
    notes : tuple of str
        What a reader has to know: reference and its bound, cells, what was left out.
    cells : mapping of str to Variable
        Values of single cells, over the dimension ``cell``; for pictures.
    """

    family: str
    curves: tuple[Curve, ...]
    notes: tuple[str, ...] = ()
    cells: Mapping[str, TableVariable] = field(default_factory=dict)


MORE: dict[str, tuple[str, str]] = {
    "ulps": ("largest error in units in the last place", "1"),
    "conditioned_ulps": ("the same over the condition number", "1"),
    "condition": ("largest condition number", "1"),
    "unit_roundoff": ("distance of 1 to the next number of the type", "1"),
    "evaluations": ("median number of points at which the outputs were computed", "1"),
    "variable_error": ("median distance to the best variables, as a share of their range", "1"),
    "missed": ("share of the designs that were missed", "1"),
    "within_estimate": ("share of the cells whose error is within the method's own estimate", "1"),
    "steps": ("time steps in a period of the drive", "1"),
    "bytes_per_value": ("bytes of the file for one value", "byte"),
    "half_quantum": ("largest error that the stored precision allows", "1"),
    "ratio": ("median of formula over true velocity", "1"),
    "within_tenth": ("share of the cells within a tenth of the true velocity", "1"),
    "within_factor_two": ("share of the cells within a factor of two", "1"),
    "rank_correlation": ("correlation of the ranks of formula and true velocity", "1"),
}
"""Every further number of a point, and its unit."""


WORDS = {
    "family": ("family of measurements", FAMILIES),
    "subject": ("what is computed", None),
    "method": ("method", None),
}
"""Labels of the words of a curve, and their meanings where these are fixed."""

NUMBERS = {
    "setting_value": ("value", "number that is set", "1"),
    "error": ("error", "median error", "1"),
    "error_largest": ("largest", "largest error", "1"),
    "time_per_cell": ("seconds", "time of one cell", "s"),
}
"""Numbers of a point: attribute, label and unit."""

CURVE_NUMBERS = {
    "fitted_slope": ("slope", "slope of log error over log cost, of the curve", "1"),
    "reference_error": ("floor", "error of the reference", "1"),
    "expected_slope": ("expected_slope", "slope that the theory has, of the curve", "1"),
}
"""Numbers of the curve of a point, alike."""


def tabulate_curves(measured: Sequence[Measured], attributes: Mapping[str, str]) -> Table:
    """Return the benchmark curves of several families as one table over the dimension ``point``.

    Each row is a measurement: numbers as variables, and method, subject and setting as CF flags
    (`flag_values` with `flag_meanings`), which any NetCDF client reads. Values of single cells go
    over the dimension ``cell``.

    Parameters
    ----------
    measured : sequence of Measured
        The families of curves.
    attributes : mapping of str to str
        Global attributes of the table.
    """
    every = list(chain.from_iterable(family.curves for family in measured))
    curves = [curve for curve in every for _ in curve.points]
    points = [point for curve in every for point in curve.points]
    number = np.arange(len(points), dtype=np.int32)
    behind = np.array([point.cells for point in points], np.int32)
    coordinates = {
        "point": _numbers(number, "number of the measurement", "1"),
        **{
            name: _flags([getattr(curve, name) for curve in curves], label, known)
            for name, (label, known) in WORDS.items()
        },
        "setting": _flags([point.setting for point in points], "setting of the method"),
    }
    variables = {
        **_columns(points, NUMBERS),
        "cells": _numbers(behind, "cells measured", "1"),
        **_columns(curves, CURVE_NUMBERS),
        **_further(points),
    }
    of_cells = {
        f"cell_{name}": variable for family in measured for name, variable in family.cells.items()
    }
    cells = next((v.values.size for v in of_cells.values() if v.dims == ("cell",)), 0)
    if cells:  # none, if the time was too short to follow any
        variables |= of_cells
        count = np.arange(cells, dtype=np.int32)
        coordinates["cell"] = TableVariable(("cell",), count, {"long_name": "number of the cell"})
    return Table(coordinates, variables, attributes)


def _columns(
    rows: Sequence[Any], names: Mapping[str, tuple[str, str, str]]
) -> dict[str, TableVariable]:
    """Return numbers of benchmark points, or of the curves they lie on, as table columns by name.

    Parameters
    ----------
    rows : sequence of Point or Curve
        One for each row of the table.
    names : mapping of str to (str, str, str)
        By name of the column: attribute of the row that is read, label and unit.
    """
    return {
        name: _floats([getattr(row, attribute) for row in rows], label, unit)
        for name, (attribute, label, unit) in names.items()
    }


def _further(points: Sequence[Point]) -> dict[str, TableVariable]:
    """Return the optional measurements of a benchmark as table columns, by name.

    `points` are the rows of the table: one method with one setting each. A column, such as the
    number of evaluations, holds NaN for points without this measurement; one that is NaN everywhere
    is left out.
    """
    values = {name: [point.more.get(name, math.nan) for point in points] for name in MORE}
    return {
        name: _floats(values[name], label, unit)
        for name, (label, unit) in MORE.items()
        if not all(map(math.isnan, values[name]))
    }


def single(values: Array | NDArray[np.int8], label: str, unit: str, **extra: Any) -> TableVariable:
    """Return a variable of values for single cells."""
    return TableVariable(("cell",), values, {"long_name": label, "units": unit, **extra})


def _numbers(values: NDArray[Any], label: str, unit: str) -> TableVariable:
    """Return a variable over points."""
    return TableVariable(("point",), values, {"long_name": label, "units": unit})


def _floats(values: Sequence[float], label: str, unit: str) -> TableVariable:
    """Return a variable of reals over points."""
    return _numbers(np.array(values, dtype=np.float64), label, unit)


def _flags(
    words: Sequence[str], label: str, known: Mapping[str, str] | None = None
) -> TableVariable:
    """Return a word for each row of the benchmark table as a CF flag column.

    Parameters
    ----------
    words : sequence of str
        The words, whose spaces become underscores.
    label : str
        Label of the column.
    known : mapping of str to str, optional
        All words that may occur, with explanations that become a comment; else those that do occur.
    """
    plain = [_joined(word) for word in words]
    meanings = list(known or dict.fromkeys(plain))
    attributes = {
        "long_name": label,
        "flag_values": np.arange(len(meanings), dtype=np.int16),
        "flag_meanings": " ".join(meanings),
    }
    if known:
        attributes["comment"] = "; ".join(f"{name}: {says}" for name, says in known.items())
    values = np.array([meanings.index(word) for word in plain], dtype=np.int16)
    return TableVariable(("point",), values, attributes)


def _joined(words: str) -> str:
    """Return words joined by underscores, as a flag meaning."""
    return "_".join(words.replace(",", "").split())
