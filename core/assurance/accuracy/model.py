"""The closed forms themselves, against the true motion of the part over the user's range."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.cells import random_cells, sample_size
from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point, single
from vibrafeed.core.assurance.accuracy.motion import is_point_part
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.prepare import Simulation, prepare
from vibrafeed.core.motion.result import ANSWERED, STATUS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.equations import regimes, run_equations
from vibrafeed.core.plan.plan import plan_scene, scene_parameters
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.study.simulate_study import SimulateStudy
from vibrafeed.core.sweep.plain import Sweep
from vibrafeed.core.watch import Watch

CELLS = 2000
VELOCITY = "m s-1"
VELOCITIES = (
    "transport_velocity",
    "mean_velocity",
    "velocity_at_time",
    "terminal_velocity",
    "velocity_bound",
)
"""Outputs that stand for how fast a part travels."""

ACCELERATIONS = ("starting_acceleration", "acceleration_x")
"""Outputs by which drives are put in order."""
RESTING = 1e-9  # of the drive's speed
OUTPUTS = (
    "conveying_velocity",
    "conveying_velocity_error",
    "throw_number",
    "drive_number",
    "velocity_scale",
    "motion_status",
    "regime",
)


def motion_of_sweep(sweep: Sweep) -> Simulation | None:
    """Return a prepared simulation with the scene and parameters of a sweep; None if there is none.

    With it, the closed forms of a sweep, which take one instant, are compared with the mean
    velocity of the simulated motion. There is none for a scene that cannot be simulated or has no
    conveying velocity, or where the parameters of the sweep do not suffice (no friction, for
    example). Parameters that no method of simulation uses are left out.
    """
    content = sweep.study.content()
    scene = SYSTEMS.get(sweep.plan.scene.name)
    if scene is None or not is_point_part(scene):
        return None
    used = {name for method in scene.variants for name in scene_parameters(scene, method)}
    parameters = {name: value for name, value in content["parameters"].items() if name in used}
    study: Any = {"kind": "simulate", "scene": scene.name, "parameters": parameters}
    try:
        asked = parse_study(study)
        assert isinstance(asked, SimulateStudy)
        return prepare(asked)
    except StudyError:
        return None  # the parameters do not tell the motion: no friction, say


def measure(sweep: Sweep, motion: Simulation, watch: Watch, cells: int = CELLS) -> Measured:
    """Measure how far closed forms of a sweep are from the mean velocity of simulated motion.

    Parameters
    ----------
    sweep : Sweep
        The study of closed forms, whose velocities and accelerations are judged.
    motion : Simulation
        The simulation of the same scene and parameters (`motion_of_sweep`), taken as the truth.
    watch : Watch
        May stop the simulation; cells that were not reached are left out, and a note says so.
    cells : int
        Number of random cells of the sweep's grid.

    Returns
    -------
    Measured
        A curve for each output, with a point for all travelling cells and one for each regime;
        notes; and throw number, true velocity [m/s], regime and formulas of each travelling cell,
        for plots.
    """
    names = {*sweep.plan.parameters, *motion.grid.axes, *motion.grid.fixed}
    cells = sample_size(sweep.grid, cells)
    sample = random_cells(sweep.grid, cells, names)
    system = motion.plan.scene
    plan = plan_scene(system, motion.plan.variant, OUTPUTS, tuple(motion.study.values()))
    known = run_equations(plan, {n: sample[n] for n in plan.parameters}, watch)

    def spread(values: Any) -> NDArray[Any]:
        """Return values broadcast to the cells."""
        return np.broadcast_to(values, cells)

    true = spread(known["conveying_velocity"])
    drive = spread(known["drive_number"] * known["velocity_scale"])
    answered = np.isin(known["motion_status"], [STATUS[name] for name in ANSWERED])
    kept = spread(answered) & np.isfinite(true)
    reached = int(np.sum(spread(known["motion_status"]) != STATUS["not_computed"]))
    kind = spread(regimes(plan, known)[REGIME])
    with np.errstate(all="ignore"):  # where a form has no value, that is told
        closed = run_equations(sweep.plan, {n: sample[n] for n in sweep.plan.parameters})
    moves = kept & (np.abs(true) > RESTING * drive)
    outputs = [n for n in sweep.plan.outputs if n in (*VELOCITIES, *ACCELERATIONS)]
    curves = [_curve(name, spread(closed[name]), true, moves, kind) for name in outputs]
    estimate = spread(known["conveying_velocity_error"] / drive)[kept]
    notes = [
        f"{reached:,} different random cells of {sweep.cells:,} (seed 2004), each followed by the "
        f"method {plan.variant}; {kept.sum():,} have a mean velocity, {moves.sum():,} of them "
        f"travel. By its own estimate the motion's error is at most {_most(estimate):.1e} of the "
        f"drive's speed A w, and {_median(estimate):.1e} in half of the cells.",
        "Error: |formula - true| over the true mean velocity, for velocities. Rank correlation "
        "(Spearman): 1 where the formula orders the drives as the true motion does, whatever its "
        "size; the only comparison that an acceleration allows. A negative ratio: the part travels "
        "the other way.",
    ]
    if reached < cells:
        notes.append(f"The time given ran out: {reached:,} of {cells:,} cells were followed.")
    velocities = [name for name in outputs if name in VELOCITIES]
    possible = plan.verdicts[0].regimes
    singles = {
        "throw_number": single(_chosen(known["throw_number"], moves, cells), "throw number", "1"),
        "true_velocity": single(true[moves], "mean velocity of the true motion", VELOCITY),
        "regime": single(
            kind[moves],
            "regime of the true motion",
            "1",
            flag_values=np.array([REGIMES[n].value for n in possible], dtype=np.int8),
            flag_meanings=" ".join(possible),
        ),
    }
    for name in velocities:
        values = spread(closed[name])[moves]
        singles[name] = single(values, QUANTITIES[name].label, VELOCITY)
    return Measured("model", tuple(curves), tuple(notes), singles)


def _curve(
    output: str,
    formula: Array,
    true: Array,
    moves: NDArray[np.bool_],
    kind: NDArray[np.int8],
) -> Curve:
    """Return the deviations of one closed form from the simulated velocity, in all and by regime.

    For a velocity, the error is |formula/true - 1|. An acceleration has no such error (NaN): only
    the correlation of its ranks with those of the true velocity is measured.

    Parameters
    ----------
    output : str
        Name of the output.
    formula, true : ndarray, shape (cells,)
        Its values by the closed form, and the simulated mean velocity [m/s].
    moves : ndarray of bool, shape (cells,)
        Cells in which the part travels.
    kind : ndarray of int8, shape (cells,)
        Number of the simulated regime.
    """
    points = []
    is_velocity = output in VELOCITIES
    groups = {"all that travel": moves}
    groups |= {name.replace("_", " "): moves & (kind == r.value) for name, r in REGIMES.items()}
    for name, where in groups.items():
        here = where & np.isfinite(formula)
        if not here.any():
            continue
        ratio = formula[here] / true[here]
        more = {"rank_correlation": rank_correlation(formula[here], true[here])}
        error = np.abs(ratio - 1)
        if is_velocity:
            more |= {
                "ratio": float(np.median(ratio)),
                "within_tenth": float(np.mean(error <= 0.1)),
                "within_factor_two": float(np.mean((ratio >= 0.5) & (ratio <= 2))),
            }
        else:
            error = np.full(1, np.nan)
        points.append(
            Point(name, np.nan, float(np.median(error)), float(error.max()), np.nan,
                  int(here.sum()), more)
        )  # fmt: skip
    return Curve("model", output, "formula", tuple(points))


def rank_correlation(first: Array, second: Array) -> float:
    """Return Spearman's rank correlation of two samples, -1 to 1; NaN where one is constant.

    Both have the shape (n,). It judges whether a formula orders drives as the true motion does.
    """
    ranks = [_ranks(values) for values in (first, second)]
    if min(np.ptp(values) for values in ranks) == 0:
        return float("nan")
    return float(np.asarray(np.corrcoef(ranks))[0, 1])


def _ranks(values: Array) -> Array:
    """Return the rank of each value from 0 on, as floats; equal values share their mean rank."""
    _, where, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    ranks = np.asarray((2 * last - counts - 1) / 2)
    return ranks[where]


def _chosen(values: Any, where: NDArray[np.bool_], cells: int) -> Array:
    """Return the values of the chosen cells."""
    return np.asarray(np.broadcast_to(values, cells)[where], dtype=np.float64)


def _most(values: Array) -> float:
    """Return the largest value; NaN without values."""
    return float(values.max()) if values.size else float("nan")


def _median(values: Array) -> float:
    """Return the median; NaN without values."""
    return float(np.median(values)) if values.size else float("nan")
