"""Closed forms in floats of two sizes, against the same equations to 50 digits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.accuracy.cells import REPEATS, median_seconds, random_cells
from core.accuracy.curves import Curve, Measured, Point
from core.accuracy.precise import CONTEXT, NotPreciseError, exact_values, sensitivities
from core.mechanics.arrays import Array
from core.motion.run import run_equations
from core.sweep.evaluate import BLOCK_CELLS
from core.sweep.plan import Plan
from core.sweep.prepare import Sweep
from core.watch import Watch

CELLS = 200
TYPES: dict[str, Any] = {"float32": np.float32, "float64": np.float64}
VANISHES = 1e-35  # SI units: what 50 digits leave of a value that is 0 by law


@dataclass(frozen=True)
class Errors:
    """Errors of one output over some cells; arrays of shape (cells,).

    NaN where the exact value is 0 and the float is not: rounding of 0 by law has no scale.

    Attributes
    ----------
    relative : ndarray
        Over the exact value.
    ulps : ndarray
        In units in the last place of the exact value.
    conditioned : ndarray
        In the same units times the condition number, which is at least 1.
    condition : ndarray
        Sum of |x dF/dx|/|F| over the parameters, at least 1.
    """

    relative: Array
    ulps: Array
    conditioned: Array
    condition: Array


def measure(sweep: Sweep, watch: Watch, cells: int = CELLS) -> Measured:
    """Return error and time of every output of a sweep, in each type of float."""
    curves, left_out, vanishing = [], [], []
    outputs = sweep.plan.outputs
    share = replace(watch, progress=lambda done: watch.advance(done / (3 * len(outputs))))
    for name in outputs:
        if watch.stopped():
            left_out.append(name)
            continue
        plan = sweep.plan.only(name)
        given = random_cells(sweep.grid, cells, plan.parameters)
        try:
            curve = _curve(plan, name, given, share)
        except NotPreciseError:
            left_out.append(name)
            continue
        if curve is None:
            vanishing.append(name)
        else:
            curves.append(curve)
    notes = [
        f"{cells} random cells of the grid (seed 2004); the reference is the plan's own equations "
        "to 50 digits, at the parameters as each type of float holds them.",
        "Error: share of the exact value. An ulp is a unit in the last place of the exact value; "
        "kappa is the sum of |x dF/dx| over |F| for the parameters, at least 1: what rounding of "
        "the parameters alone does to the value.",
        f"Time: wall time of one thread for one cell, blocks of {BLOCK_CELLS:,} cells in which "
        f"every parameter differs, with all that the output and its regime need; median of "
        f"{REPEATS} repeats after a warm-up.",
        "Slope: of log(error in ulps over kappa) over log(unit roundoff of the type); 0 is flat: "
        "the error is rounding, whatever the type.",
    ]
    if vanishing:
        notes.append(f"Zero by law, without a relative error: {', '.join(vanishing)}.")
    if left_out:
        notes.append(f"Not known to 50 digits, or out of time: {', '.join(left_out)}.")
    return Measured("closed_forms", tuple(curves), tuple(notes))


def errors_of(
    got: Array, exact: NDArray[np.object_], moved: NDArray[np.object_], dtype: Any
) -> Errors:
    """Return the errors of values in floats of a type.

    Parameters
    ----------
    got : ndarray, shape (n,)
        What the floats gave.
    exact : ndarray of object, shape (n,)
        Exact values, numbers of mpmath.
    moved : ndarray of object, shape (n,)
        Sum of |x dF/dx| over the parameters, likewise.
    """
    count = len(exact)
    relative, ulps, conditioned, condition = (np.full(count, np.nan) for _ in range(4))
    for cell in range(count):
        value, number = exact[cell], float(got[cell])
        if not CONTEXT.isfinite(value) or not np.isfinite(dtype(float(value))):
            # The right infinity, or no value where there is none, is no error.
            same = number == float(value) or (CONTEXT.isnan(value) and np.isnan(number))
            errors = (0.0, 0.0, 0.0) if same else (np.inf, np.inf, np.inf)
            relative[cell], ulps[cell], conditioned[cell] = errors
            continue
        if abs(value) < VANISHES:
            if number == 0:
                relative[cell] = ulps[cell] = conditioned[cell] = 0.0
            continue
        error = abs(CONTEXT.mpf(number) - value) if np.isfinite(number) else CONTEXT.inf
        unit = CONTEXT.mpf(float(np.spacing(np.abs(dtype(float(value))))))
        size = abs(value)
        kappa = CONTEXT.one
        if CONTEXT.isfinite(moved[cell]):
            kappa = max(kappa, moved[cell] / size)
        relative[cell] = float(error / size)
        ulps[cell] = float(error / unit)
        conditioned[cell] = float(error / unit / kappa)
        condition[cell] = float(kappa)
    return Errors(relative, ulps, conditioned, condition)


def _curve(plan: Plan, name: str, given: Mapping[str, Array], watch: Watch) -> Curve | None:
    moved = sensitivities(plan, given, watch=watch)[name]
    points = []
    for title, dtype in TYPES.items():
        held = {key: values.astype(dtype) for key, values in given.items()}
        wide = {key: values.astype(np.float64) for key, values in held.items()}
        rounded = _with_defaults(plan, dtype)
        exact = exact_values(rounded, wide, watch=watch)[name]
        errors = errors_of(_evaluate(plan, held, dtype)[name], exact, moved, dtype)
        if np.isnan(errors.relative).all():
            return None
        block = {key: np.resize(values, BLOCK_CELLS) for key, values in held.items()}
        seconds = median_seconds(lambda b=block, d=dtype: _evaluate(plan, b, d))  # type: ignore[misc]
        points.append(_point(title, dtype, errors, seconds / BLOCK_CELLS))
    return Curve(
        "closed_forms",
        name,
        "equations",
        tuple(points),
        "0: flat at rounding",
        0.0,
        cost="unit_roundoff",
        of="conditioned_ulps",
    )


def _point(title: str, dtype: Any, errors: Errors, seconds: float) -> Point:
    return Point(
        title,
        float(np.finfo(dtype).bits),
        float(np.nanmedian(errors.relative)),
        float(np.nanmax(errors.relative)),
        seconds,
        int(np.isfinite(errors.relative).sum()),
        {
            "ulps": float(np.nanmax(errors.ulps)),
            "conditioned_ulps": float(np.nanmax(errors.conditioned)),
            "condition": float(np.nanmax(errors.condition, initial=1.0)),
            "unit_roundoff": float(np.finfo(dtype).eps),
        },
    )


def _with_defaults(plan: Plan, dtype: Any) -> Plan:
    """Return the plan with its defaults as a type of float holds them."""
    return replace(plan, defaults={name: float(dtype(v)) for name, v in plan.defaults.items()})


def _evaluate(plan: Plan, cells: Mapping[str, Any], dtype: Any) -> dict[str, Any]:
    """Return every quantity at cells in floats of a type."""
    defaults = {name: np.asarray(value, dtype=dtype) for name, value in plan.defaults.items()}
    size = max((values.size for values in cells.values()), default=1)
    with np.errstate(all="ignore"):  # what overflows in a short float is told as an error
        known = run_equations(plan, {**defaults, **cells})
    return {name: np.broadcast_to(known[name], size) for name in plan.outputs}
