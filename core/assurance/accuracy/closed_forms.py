"""Closed forms in floats of two sizes, against the same equations to 50 digits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.cells import (
    REPEATS,
    median_seconds,
    random_cells,
    sample_size,
)
from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.blocks import BLOCK_CELLS
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.sweep.plain import Sweep
from vibrafeed.core.sweep.precise import Errors, errors_of, exact_values, sensitivities
from vibrafeed.core.watch import Watch

CELLS = 200
PIECE = 20  # cells at a time, between two looks at the watch
TYPES: dict[str, Any] = {"float32": np.float32, "float64": np.float64}


def measure(sweep: Sweep, watch: Watch, cells: int = CELLS) -> Measured:
    """Measure error and time of the closed forms of a sweep in 32-bit and 64-bit floats.

    This is a benchmark of rounding: each output is compared with the same equations computed to 50
    digits, at random cells of the sweep's grid.

    Parameters
    ----------
    sweep : Sweep
        The prepared study.
    watch : Watch
        May end the measurement early, after at least one piece of cells; the notes then say so.
    cells : int
        Number of cells wanted.

    Returns
    -------
    Measured
        A curve for each output with errors, with a point for each type of float.
    """
    plan = sweep.plan
    cells = sample_size(sweep.grid, cells)
    sample = random_cells(sweep.grid, cells, plan.parameters)
    pieces: list[_Known] = []
    share = watch.part(0.9 / cells)
    for start in range(0, cells, PIECE):
        if pieces and watch.stopped():
            break
        piece = {name: values[start : start + PIECE] for name, values in sample.items()}
        pieces.append(_known(plan, piece, share))
    done = min(cells, len(pieces) * PIECE)
    sample = {name: values[:done] for name, values in sample.items()}
    curves, left_out, without = [], [], []
    for name in plan.outputs:
        if name not in pieces[0].moved:
            left_out.append(name)
            continue
        curve = _curve(plan, name, sample, _joined(pieces, name))
        if curve.points:
            curves.append(curve)
        else:
            without.append(name)
        watch.advance(0.1 / len(plan.outputs))
    notes = [
        f"{done} different random cells of {sweep.cells:,} (seed 2004); the column cells counts "
        "those with a value other than 0. The reference is the plan's own equations to 50 digits, "
        "at the parameters as each type of float holds them.",
        "Error: share of the exact value. An ulp is a unit in the last place of the exact value; "
        "kappa is the sum of |x dF/dx| over |F| for the parameters, at least 1: what rounding of "
        "the parameters alone does to the value.",
        f"Time: wall time of one thread for one cell, blocks of {BLOCK_CELLS:,} cells in which "
        f"every parameter differs, with all that the output and its regime need; median of "
        f"{REPEATS} repeats after a warm-up.",
        "Slope: of log(error in ulps over kappa) over log(unit roundoff of the type); 0 is flat: "
        "the error is rounding, whatever the type.",
    ]
    if done < cells:
        notes.append(f"The time given ran out: {done} of {cells} cells were reached.")
    if without:
        notes.append(f"0 or without a value in all these cells: {', '.join(without)}.")
    fits = _fits(sample, np.float32)
    if not fits.all():
        notes.append(
            "Left out of the rows of float32 are cells with a parameter that it cannot hold: "
            f"{np.sum(~fits)} of {done}."
        )
    if left_out:
        notes.append(f"Not known to 50 digits, since an equation rounds: {', '.join(left_out)}.")
    return Measured("closed_forms", tuple(curves), tuple(notes))


@dataclass(frozen=True)
class _Known:
    """Exact values of some cells by type of float, and how the parameters move them."""

    exact: Mapping[str, Mapping[str, NDArray[np.object_]]]
    moved: Mapping[str, NDArray[np.object_]]


def _known(plan: Plan, cells: Mapping[str, Array], watch: Watch) -> _Known:
    """Return outputs at some cells to 50 digits, and the effect of rounding the parameters.

    They are the reference of the rounding benchmark.

    Parameters
    ----------
    plan : Plan
        The equations.
    cells : mapping of str to ndarray, shape (n,)
        Parameters in SI units. Each type of float has a reference at its own rounded parameters.
    watch : Watch
        Progress counts the cells.

    Returns
    -------
    _Known
        Exact outputs by type of float and name, and the sensitivities to the parameters by name.
    """
    count = max((values.size for values in cells.values()), default=1)
    share = watch.part(count / (len(TYPES) + 1))
    exact = {
        title: exact_values(
            _with_defaults(plan, dtype),
            _held(cells, dtype),
            partial=True,
            watch=share,
        )
        for title, dtype in TYPES.items()
    }
    return _Known(exact, sensitivities(plan, cells, partial=True, watch=share))


def _joined(pieces: Sequence[_Known], name: str) -> _Known:
    """Return the values of one output at the cells of all pieces."""
    exact = {t: {name: np.concatenate([p.exact[t][name] for p in pieces])} for t in TYPES}
    return _Known(exact, {name: np.concatenate([p.moved[name] for p in pieces])})


def _curve(plan: Plan, name: str, sample: Mapping[str, Array], known: _Known) -> Curve:
    """Return error and time of one output as a curve with a point for each type of float.

    The curve has no points where all cells are 0 or without a value, as relative errors are
    undefined there.

    Parameters
    ----------
    plan : Plan
        The equations, of which only those that `name` needs are run.
    name : str
        The output.
    sample : mapping of str to ndarray, shape (cells,)
        Parameters of the cells in SI units.
    known : _Known
        Exact values of the output at these cells.
    """
    plan = plan.only(name)
    sample = {key: sample[key] for key in plan.parameters}
    points = []
    for title, dtype in TYPES.items():
        held = _held(sample, dtype)
        exact, moved = known.exact[title][name], known.moved[name]
        got = np.broadcast_to(_evaluate(plan, held, dtype)[name], moved.size)
        errors = errors_of(got, exact, moved, dtype)
        # What has no value, or is 0, is right or wrong: it has no error that a median could count.
        alike = ~np.isfinite(got) | (got == 0)
        judged = _fits(sample, dtype) & ~(alike & (errors.relative == 0))
        judged &= ~np.isnan(errors.relative)
        if not judged.any():
            continue
        block = {key: np.resize(values, BLOCK_CELLS) for key, values in held.items()}
        seconds = median_seconds(lambda b=block, d=dtype: _evaluate(plan, b, d))  # type: ignore[misc]
        points.append(_point(title, dtype, errors, judged, seconds / BLOCK_CELLS))
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


def _point(
    title: str, dtype: Any, errors: Errors, judged: NDArray[np.bool_], seconds: float
) -> Point:
    """Return a point of the rounding benchmark: errors and time of an output in a type of float.

    Parameters
    ----------
    title, dtype : str, type
        Name and type of the float, such as "float32" and `np.float32`.
    errors : Errors
        Of each cell, relative, in ulps (units in the last place), in ulps over the condition
        number, and this number; arrays of shape (cells,).
    judged : ndarray of bool, shape (cells,)
        Cells that count; at least one.
    seconds : float
        Computing time of one cell [s].
    """
    return Point(
        title,
        float(np.finfo(dtype).bits),
        float(np.median(errors.relative[judged])),
        float(errors.relative[judged].max()),
        seconds,
        int(judged.sum()),
        {
            "ulps": float(errors.ulps[judged].max()),
            "conditioned_ulps": float(errors.conditioned[judged].max()),
            "condition": float(np.nanmax(errors.condition[judged], initial=1.0)),
            "unit_roundoff": float(np.finfo(dtype).eps),
        },
    )


def _held(cells: Mapping[str, Array], dtype: Any) -> dict[str, NDArray[Any]]:
    """Return parameters rounded to a floating-point type."""
    with np.errstate(over="ignore"):  # `_fits` tells
        return {name: values.astype(dtype) for name, values in cells.items()}


def _fits(cells: Mapping[str, Array], dtype: Any) -> NDArray[np.bool_]:
    """Return a mask, shape (n,): True for cells whose parameters a type of float can represent.

    Others would over- or underflow, and are left out of the benchmark of rounding errors. `cells`
    holds the parameters by name, arrays of shape (n,) in SI units; `dtype` is the type, such as
    `float32`.
    """
    fits = np.ones(max((values.size for values in cells.values()), default=1), dtype=np.bool_)
    for name, held in _held(cells, dtype).items():
        fits &= np.isfinite(held) & ((held != 0) | (cells[name] == 0))
    return fits


def _with_defaults(plan: Plan, dtype: Any) -> Plan:
    """Return the plan with its default values rounded to a floating-point type."""
    return replace(plan, defaults={name: float(dtype(v)) for name, v in plan.defaults.items()})


def _evaluate(plan: Plan, cells: Mapping[str, Any], dtype: Any) -> dict[str, Any]:
    """Return the outputs of a plan at some cells, computed throughout in one type of float.

    `cells` has the parameters by name, arrays of shape (n,) of type `dtype` in SI units; the
    defaults of the plan are converted to it. The result has an array of shape (n,) for each output.
    """
    defaults = {name: np.asarray(value, dtype=dtype) for name, value in plan.defaults.items()}
    size = max((values.size for values in cells.values()), default=1)
    with np.errstate(all="ignore"):  # what overflows in a short float is told as an error
        known = run_equations(plan, {**defaults, **cells})
    return {name: np.broadcast_to(known[name], size) for name in plan.outputs}
