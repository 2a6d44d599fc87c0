"""Points and curves of error against cost, and the dataset that holds them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.dataset.table import Table, TableVariable
from core.mechanics.arrays import Array

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
        """Slope of the logarithms of error over cost; NaN from fewer than two points."""
        pairs = [(numbers_of(p, self.cost), numbers_of(p, self.of)) for p in self.points]
        return fitted_slope(pairs, self.floor)


def numbers_of(point: Point, name: str) -> float:
    """Return one of the numbers of a point by its name; NaN if it has none of that name."""
    if name in point.more:
        return float(point.more[name])
    return float(getattr(point, name, math.nan))


def fitted_slope(pairs: Sequence[tuple[float, float]], floor: float = 0.0) -> float:
    """Return the slope of log error over log cost by least squares.

    `STEEP` where the error falls at what is one cost but for noise; NaN from fewer than two points
    above the floor, or where neither changes.
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
    """What one family gives for one study.

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


def tabulate_curves(measured: Sequence[Measured], attributes: Mapping[str, str]) -> Table:
    """Return the dataset of curves: one dimension, ``point``, labelled by flags.

    Words stand as CF flags (`flag_values` and `flag_meanings`), so that any client reads them.
    """
    rows = [(curve, point) for one in measured for curve in one.curves for point in curve.points]
    coordinates = {
        "point": _numbers(np.arange(len(rows), dtype=np.int32), "number of the measurement", "1"),
        "family": _flags([curve.family for curve, _ in rows], "family of measurements", FAMILIES),
        "subject": _flags([curve.subject for curve, _ in rows], "what is computed"),
        "method": _flags([curve.method for curve, _ in rows], "method"),
        "setting": _flags([point.setting for _, point in rows], "setting of the method"),
    }
    variables = {
        "setting_value": _floats([p.value for _, p in rows], "number that is set", "1"),
        "error": _floats([p.error for _, p in rows], "median error", "1"),
        "error_largest": _floats([p.largest for _, p in rows], "largest error", "1"),
        "time_per_cell": _floats([p.seconds for _, p in rows], "time of one cell", "s"),
        "cells": _numbers(np.array([p.cells for _, p in rows], np.int32), "cells measured", "1"),
        "fitted_slope": _floats(
            [c.slope for c, _ in rows], "slope of log error over log cost, of the curve", "1"
        ),
        "reference_error": _floats([c.floor for c, _ in rows], "error of the reference", "1"),
        "expected_slope": _floats(
            [c.expected_slope for c, _ in rows], "slope that the theory has, of the curve", "1"
        ),
    }
    for name, (label, unit) in MORE.items():
        values = [point.more.get(name, math.nan) for _, point in rows]
        if not all(map(math.isnan, values)):
            variables[name] = _floats(values, label, unit)
    for one in measured:
        variables |= {f"cell_{name}": variable for name, variable in one.cells.items()}
    singles = [v for v in variables.values() if v.dims == ("cell",)]
    if singles:
        count = np.arange(singles[0].values.size, dtype=np.int32)
        coordinates["cell"] = TableVariable(("cell",), count, {"long_name": "number of the cell"})
    return Table(coordinates, variables, attributes)


def single(values: Array | NDArray[np.int8], label: str, unit: str, **extra: Any) -> TableVariable:
    """Return values of single cells, labelled."""
    return TableVariable(("cell",), values, {"long_name": label, "units": unit, **extra})


def _numbers(values: NDArray[Any], label: str, unit: str) -> TableVariable:
    return TableVariable(("point",), values, {"long_name": label, "units": unit})


def _floats(values: Sequence[float], label: str, unit: str) -> TableVariable:
    return _numbers(np.array(values, dtype=np.float64), label, unit)


def _flags(
    words: Sequence[str], label: str, known: Mapping[str, str] | None = None
) -> TableVariable:
    """Return words as numbers, with their meanings; a meaning has no blanks."""
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
    return "_".join(words.replace(",", "").split())
