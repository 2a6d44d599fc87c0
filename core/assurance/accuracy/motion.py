"""Methods of motion against each other: error of the mean velocity over time of a cell."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.cells import random_cells
from vibrafeed.core.assurance.accuracy.curves import STEEP, Curve, Measured, Point
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.prepare import Simulation
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.plan import plan_scene, scene_parameters
from vibrafeed.core.scenes import Scene
from vibrafeed.core.watch import Watch

CELLS = 24
STIFF_CELLS = 2
CANDIDATES = 8  # a cell wanted: those that do not repeat, or rest, are left out
STEPS = (100, 200, 400, 800, 1600, 3200, 6400)
TOLERANCES = tuple(10.0**-k for k in (1, 2, 3, 4, 6, 8, 10, 12))
SLIP_SPEEDS = (1e-2, 10**-2.5, 1e-3)
STIFF = ("regularised", "regularised-BDF", "regularised-LSODA")
OUTPUTS = (
    "conveying_velocity",
    "conveying_velocity_error",
    "flight_fraction",
    "drive_number",
    "velocity_scale",
    "motion_status",
)
SHARES = {"both": 0.59, "events": 0.06, "regularised": 0.35}
"""Of the progress: candidates, reference and time stepping; and what not every scene has."""

ROUNDING = 1e-15  # of the drive's speed: an error below this is rounding of either method
OTHER_MOTION = 1e-6  # of the drive's speed: two exact methods that differ by more fell into two
REFERENCE_ERROR = 1e-9  # of the drive's speed: more, and the reference is none


@dataclass(frozen=True)
class Means:
    """Mean velocities of some cells, as shares of the drive's speed; arrays of shape (cells,).

    Attributes
    ----------
    velocity, estimate : ndarray
        Mean velocity, and the method's own estimate of its error; NaN where there is none.
    periodic : ndarray of bool
        Where the motion repeats.
    hops : ndarray of bool
        Where the part is in the air for a part of the period.
    seconds : float
        Wall time of one thread for one cell.
    """

    velocity: Array
    estimate: Array
    periodic: NDArray[np.bool_]
    hops: NDArray[np.bool_]
    seconds: float


def is_point_part(scene: Scene) -> bool:
    """True if a system has a mean velocity; tumbling parts have none."""
    return "conveying_velocity" in scene.outputs(scene.default_variant)


def run_method(
    scene: Scene,
    method: str,
    cells: Mapping[str, Array],
    settings: Mapping[str, float],
    watch: Watch,
) -> Means:
    """Run a method of simulation at some cells, on one thread, and time it.

    Parameters
    ----------
    scene : Scene
        The system that moves.
    method : str
        One of its methods, such as "events" or "time-stepping".
    cells : mapping of str to ndarray, shape (n,)
        Parameters in SI units.
    settings : mapping of str to float
        Settings of the method, such as `tolerance`, in place of its defaults.
    watch : Watch
        Progress, and when to stop.

    Returns
    -------
    Means
        Mean velocities as shares of the drive's speed A0 w, with error estimates and time per cell.
    """
    plan = plan_scene(scene, method, OUTPUTS, tuple(cells))
    plan = replace(plan, defaults={**plan.defaults, **settings})
    inputs = {name: cells[name] for name in plan.parameters}
    single = Watch(watch.progress, watch.stop, watch.deadline, threads=1)
    started = time.perf_counter()
    known = run_equations(plan, inputs, single)
    seconds = time.perf_counter() - started
    count = next(iter(cells.values())).size
    drive = known["drive_number"] * known["velocity_scale"]  # the speed of the track, A w
    status = np.broadcast_to(known["motion_status"], count)
    with np.errstate(divide="ignore", invalid="ignore"):  # a drive at rest has no share
        velocity = known["conveying_velocity"] / drive
        estimate = known["conveying_velocity_error"] / drive
    return Means(
        np.broadcast_to(velocity, count),
        np.broadcast_to(estimate, count),
        (status == STATUS["periodic"]),
        np.broadcast_to(known["flight_fraction"] > 0, count),
        seconds / count,
    )


def _parts(scene: Scene) -> float:
    """Return the sum of the shares of progress (`SHARES`) of what is measured for a scene, 0 to 1.

    Progress is scaled by it, so that it ends at 1 for a scene without methods such as "events".
    """
    named = [name for name in ("events", "regularised") if name in scene.variants]
    return SHARES["both"] + sum(SHARES[name] for name in named)


def _nothing_moves(count: int, watch: Watch) -> str:
    """Return the note of a motion benchmark that found no cell to measure, as one sentence.

    `count` is the number of random cells tried. The sentence says whether `watch` ended the search.
    """
    if watch.stopped():
        return "The time given ran out before a cell was found whose motion repeats."
    return f"No cell of {count} random ones moves and repeats its motion: nothing is measured."


def measure(simulation: Simulation, watch: Watch, cells: int = CELLS) -> Measured:
    """Measure error against time of every method that simulates a study's motion.

    Random cells of the grid that move and repeat their motion are simulated by each method with a
    series of settings, such as tolerances or steps per period. The reference is the method
    `reference`, and for all but "events" the method "events" at a tolerance of 1e-12 where the
    scene has it. Cells on which the two disagree are left out.

    Parameters
    ----------
    simulation : Simulation
        The prepared study.
    watch : Watch
        May end the measurement early: settings that were not reached are left out.
    cells : int
        Number of cells wanted.

    Returns
    -------
    Measured
        A curve for each method and kind of motion; none, with a note, if no cell can be measured.
    """
    scene, grid = simulation.plan.scene, simulation.grid
    settings = {
        name: value for name, value in simulation.study.settings().items() if name == "max_periods"
    }
    exact = "events" if "events" in scene.variants else None
    watch = watch.part(1 / _parts(scene))
    sample = random_cells(grid, CANDIDATES * cells, [*grid.axes, *grid.fixed])
    sample = {name: values for name, values in sample.items() if _is_used(scene, name)}
    share = watch.part(0.04)
    quick = _warm(scene, exact or "time-stepping", sample, settings, share)
    moves = quick.periodic & (np.abs(quick.velocity) > ROUNDING)
    chosen = np.flatnonzero(moves & _first_of_its_kind(sample))
    # The first cells, and among them as many that slide as that hop, if there are.
    chosen = _both_kinds(chosen, quick.hops, cells)
    left = sample[next(iter(sample))].size
    picked = {name: values[chosen] for name, values in sample.items()}
    if not chosen.size:
        return Measured("motion", (), (_nothing_moves(left, share),))
    reference = run_method(scene, "reference", picked, {}, watch.part(0.3))
    trusted = reference.periodic & (reference.estimate < REFERENCE_ERROR)
    if exact:
        ours = _warm(scene, exact, picked, {**settings, "tolerance": 1e-12}, share)
        trusted &= np.abs(ours.velocity - reference.velocity) < OTHER_MOTION
    if not trusted.any():
        note = "The reference method did not find one of these motions in the time given."
        return Measured("motion", (), (note,))
    picked = {name: values[trusted] for name, values in picked.items()}
    truth, hops = reference.velocity[trusted], quick.hops[chosen][trusted]
    own = float(reference.estimate[trusted].max())
    notes = [
        f"{trusted.sum()} cells: the first of {left} different random ones of {grid.cells:,} (seed "
        "2004) whose "
        f"motion repeats, {hops.sum()} of them with hops. Error: of the mean velocity, as a share "
        "of the drive's speed A w. Time: wall time of one thread for one cell.",
    ]
    curves: list[Curve] = []
    floor = max(own, ROUNDING)
    if exact:
        apart = float(np.abs(ours.velocity[trusted] - truth).max())
        floor = max(apart, floor)
        notes.append(
            f"Reference: events at a tolerance of 1e-12, for all but events, and the method "
            f"'reference' (collocation between events, no code in common) for events. The two "
            f"differ by at most {apart:.1e}: what is smaller cannot be resolved."
        )
        curves += _events(scene, picked, truth, hops, floor, watch.part(0.02))
        truth = ours.velocity[trusted]
    else:
        notes.append(
            "Reference: the method 'reference' (collocation between events); its own estimate of "
            f"its error is at most {own:.1e}."
        )
    curves += _stepping(scene, picked, truth, hops, floor, watch.part(0.25))
    curves.append(
        Curve(
            "motion",
            f"{kinds_of(hops)} cells",
            "reference",
            (Point("reference", np.nan, own, floor, reference.seconds, int(trusted.sum())),),
        )
    )
    if "regularised" in scene.variants:
        curves += _regularised(scene, picked, truth, hops, watch.part(0.35))
    if watch.stopped():
        notes.append("The time given ran out: settings that were not reached are left out.")
    return Measured("motion", tuple(curves), tuple(notes))


def _is_used(scene: Scene, name: str) -> bool:
    """True if a parameter is used by any method of a scene."""
    return any(name in scene_parameters(scene, method) for method in scene.variants)


def _first_of_its_kind(cells: Mapping[str, Array]) -> NDArray[np.bool_]:
    """Return a mask, shape (cells,), True where a cell's parameters occur for the first time.

    Cells drawn at random from a small grid repeat; each should be measured only once. `cells` holds
    the parameters, shape (cells,) each, by name.
    """
    rows = np.stack(list(cells.values()), axis=-1)
    first = np.zeros(len(rows), dtype=np.bool_)
    first[np.unique(rows, axis=0, return_index=True)[1]] = True
    return first


def _both_kinds(chosen: NDArray[np.intp], hops: NDArray[np.bool_], count: int) -> NDArray[np.intp]:
    """Return up to `count` of the chosen cells in order, half of them hopping if there are enough.

    `chosen` are indices of candidate cells, `hops` is true for hopping cells, by index. Where one
    kind is short of cells the other fills up.
    """
    air, floor = chosen[hops[chosen]], chosen[~hops[chosen]]
    half = count // 2
    more = max(0, half - floor.size), max(0, half - air.size)
    return np.sort(np.concatenate([air[: half + more[0]], floor[: half + more[1]]]))


def _warm(
    scene: Scene,
    method: str,
    cells: Mapping[str, Array],
    settings: Mapping[str, float],
    watch: Watch,
) -> Means:
    """Run a method on one cell, so that it is loaded and compiled, then on all; return the latter.

    Arguments and result are those of `run_method`: the times that it measures then hold no
    compilation.
    """
    cell = {name: values[:1] for name, values in cells.items()}
    run_method(scene, method, cell, settings, Watch(stop=watch.stop))
    return run_method(scene, method, cells, settings, watch)


def _repeated(
    scene: Scene,
    method: str,
    cells: Mapping[str, Array],
    settings: Mapping[str, float],
    watch: Watch,
) -> Means:
    """Run a method of simulation; return its results with the median time of three runs.

    A run of half a second or more is not repeated, nor is any once the watch has stopped. The first
    run is preceded by one that warms up.

    Parameters
    ----------
    scene, method : Scene, str
        The system that moves, and one of its methods of simulation.
    cells : mapping of str to ndarray, shape (n,)
        Parameters in SI units.
    settings : mapping of str to float
        Settings of the method, such as `tolerance`, in place of its defaults.
    watch : Watch
        Progress, and when to stop.

    Returns
    -------
    Means
        Mean velocities as shares of the drive's speed, error estimates, and time per cell [s].
    """
    first = _warm(scene, method, cells, settings, watch)
    times = [first.seconds]
    while len(times) < 3 and times[0] * first.velocity.size < 0.5 and not watch.stopped():
        times.append(run_method(scene, method, cells, settings, Watch(stop=watch.stop)).seconds)
    return replace(first, seconds=float(np.median(times)))


def _groups(
    cells: Mapping[str, Array], truth: Array, hops: NDArray[np.bool_]
) -> Iterator[tuple[str, dict[str, Array], Array]]:
    """Yield the sliding cells and then the hopping ones, each with the name of the kind of motion.

    Both kinds are measured apart, as errors differ; a kind without cells is left out.

    Parameters
    ----------
    cells : mapping of str to ndarray, shape (cells,)
        Parameters in SI units.
    truth : ndarray, shape (cells,)
        True mean velocities, as shares of the drive's speed.
    hops : ndarray of bool, shape (cells,)
        Where the part hops.
    """
    for name, where in (("sliding", ~hops), ("hopping", hops)):
        if where.any():
            yield name, {key: values[where] for key, values in cells.items()}, truth[where]


def point_of(
    setting: str, value: float, run: Means, truth: Array, floor: float = ROUNDING
) -> Point | None:
    """Return a point of a benchmark curve: errors and time of one run; None if a cell has no value.

    Parameters
    ----------
    setting, value : str, float
        What was set, in words such as "800 steps", and as a number.
    run : Means
        Mean velocities of the run with the method's own error estimates, shape (cells,).
    truth : ndarray, shape (cells,)
        True velocities, as shares of the drive's speed.
    floor : float
        Error of the truth, by which an estimate may be exceeded and still count as kept.
    """
    error = np.abs(run.velocity - truth)
    if np.isnan(error).any():
        return None
    more = {}
    if np.isfinite(run.estimate).all():
        more["within_estimate"] = float(np.mean(error <= run.estimate + floor))
    return Point(
        setting, value, float(np.median(error)), float(error.max()), run.seconds, error.size, more
    )


def _curve(
    method: str, group: str, points: Sequence[Point | None], says: str, slope: float, floor: float
) -> Curve:
    """Return the benchmark curve of a method and kind of motion, by the largest errors.

    Parameters
    ----------
    method, group : str
        The method, and "sliding" or "hopping".
    points : sequence of Point or None
        In the order of the setting; None, where a run had no value, is left out.
    says, slope : str, float
        The slope of log error over log cost that theory expects, in words and as a number.
    floor : float
        Errors up to this are those of the reference, and are not fitted.
    """
    kept = tuple(point for point in points if point)
    return Curve("motion", f"{group} cells", method, kept, says, slope, floor, of="largest")


def _by_steps(
    method: str, group: str, points: Sequence[Point | None], says: str, slope: float, floor: float
) -> Curve:
    """Return a benchmark curve whose slope relates the error to the number of steps, not to time.

    Arguments are those of `_curve`; the value of each point is its number of steps per period.
    """
    kept = [replace(p, more={**p.more, "steps": p.value}) for p in points if p]
    return replace(_curve(method, group, kept, says, slope, floor), cost="steps")


def _events(
    scene: Scene,
    cells: Mapping[str, Array],
    truth: Array,
    hops: NDArray[np.bool_],
    floor: float,
    watch: Watch,
) -> Iterator[Curve]:
    """Yield the benchmark curves of event-driven simulation over its tolerance: sliding, hopping.

    Parameters
    ----------
    scene : Scene
        The system that moves.
    cells : mapping of str to ndarray, shape (cells,)
        Parameters in SI units.
    truth, hops : ndarray, shape (cells,)
        True mean velocities as shares of the drive's speed; where the part hops.
    floor : float
        Error of the truth.
    watch : Watch
        Progress, and when to stop.
    """
    each = watch.part(1 / (len(TOLERANCES) * len(set(hops.tolist()))))
    for group, here, true in _groups(cells, truth, hops):
        points = [
            point_of(
                f"tolerance {tolerance:.0e}",
                tolerance,
                _repeated(scene, "events", here, {"tolerance": tolerance}, each),
                true,
                floor,
            )
            for tolerance in TOLERANCES
        ]
        yield _curve("events", group, points, "steep", STEEP, floor)


def _stepping(
    scene: Scene,
    cells: Mapping[str, Array],
    truth: Array,
    hops: NDArray[np.bool_],
    floor: float,
    watch: Watch,
) -> Iterator[Curve]:
    """Yield the benchmark curves of time stepping over its steps, plain and with extrapolation.

    There is a pair of curves for the sliding and one for the hopping cells. The second of a pair is
    Richardson's extrapolation from n/2 and n steps per period to infinitely many.

    Parameters
    ----------
    scene, watch : Scene, Watch
        The system that moves; progress, and when to stop.
    cells : mapping of str to ndarray, shape (cells,)
        Parameters in SI units.
    truth, hops : ndarray, shape (cells,)
        True mean velocities as shares of the drive's speed; True where the part hops.
    floor : float
        Error of the truth, in the same unit.
    """
    each = watch.part(1 / (len(STEPS) * len(set(hops.tolist()))))
    is_planar = "alpha" not in cells or not np.any(cells["alpha"])
    is_planar &= "radius" not in cells and "delta" not in cells
    for group, here, true in _groups(cells, truth, hops):
        # Theory 13.9: of first order with hops, in space and in a curve; else of second.
        order = 2 if is_planar and group == "sliding" else 1
        runs: dict[int, Means] = {}
        for n in STEPS:
            if not watch.stopped():
                settings = {"steps_per_period": float(n)}
                runs[n] = _repeated(scene, "time-stepping", here, settings, each)
        plain = [point_of(f"{n} steps", n, run, true, floor) for n, run in runs.items()]
        yield _by_steps("time-stepping", group, plain, str(-order), -order, floor)
        limits = []
        for n, run in runs.items():
            if n // 2 in runs:
                limit = _extrapolated(runs[n // 2], run, n, order)
                limits.append(point_of(f"{n // 2} and {n} steps", n, limit, true))
        says = f"{-order - 1} if the error were smooth; events within steps make it irregular"
        yield _by_steps("Richardson", group, limits, says, -order - 1, floor)


def _extrapolated(coarse: Means, fine: Means, steps: int, order: int) -> Means:
    """Return two runs of time stepping extrapolated to step 0 (Richardson).

    The error is assumed to be a power of the step. `coarse` and `fine` are runs with n/2 and n
    steps per period, n being `steps`, and `order` is the power; the time is that of both runs, and
    there is no error estimate (NaN).
    """
    # A run with n steps tells what its finer part gave, with 2n + 1.
    factor = ((2 * steps + 1) / (steps + 1)) ** order - 1
    return replace(
        fine,
        velocity=fine.velocity + (fine.velocity - coarse.velocity) / factor,
        estimate=np.full(fine.velocity.size, np.nan),
        seconds=fine.seconds + coarse.seconds,
    )


def _regularised(
    scene: Scene,
    cells: Mapping[str, Array],
    truth: Array,
    hops: NDArray[np.bool_],
    watch: Watch,
) -> Iterator[Curve]:
    """Yield a benchmark curve over slip speed for each integrator of regularised friction.

    Friction there is a smooth function of the slip speed v [m/s], so that the error falls with a
    smaller v; the contact stiffness is set to 1/v^2. These methods are slow: they simulate one or
    two cells.

    Parameters
    ----------
    scene, watch : Scene, Watch
        The system that moves; progress, and when to stop.
    cells : mapping of str to ndarray, shape (cells,)
        Parameters in SI units.
    truth, hops : ndarray, shape (cells,)
        True mean velocities as shares of the drive's speed; True where the part hops.
    """
    first = representatives(hops)
    each = watch.part(1 / (len(SLIP_SPEEDS) * len(STIFF)))
    few = {name: values[first] for name, values in cells.items()}
    for method in (name for name in STIFF if name in scene.variants):
        points = []
        for slip in SLIP_SPEEDS:
            if watch.stopped():
                break
            settings = {"slip_speed": slip, "contact_stiffness": slip**-2}
            run = run_method(scene, method, few, settings, each)
            points.append(point_of(f"slip speed {slip:.1e}", slip, run, truth[first]))
        curve = _curve(method, kinds_of(hops), points, "2/3", 2 / 3, 0.0)
        if curve.points:
            yield replace(curve, cost="value")


def representatives(hops: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the indices of one hopping and one sliding cell, for slow methods."""
    return np.sort(
        np.concatenate([np.flatnonzero(hops)[: STIFF_CELLS - 1], np.flatnonzero(~hops)[:1]])
    )


def kinds_of(hops: NDArray[np.bool_]) -> str:
    """Return the kind of motion of each cell, hopping or sliding."""
    names = [name for name, there in (("sliding", ~hops), ("hopping", hops)) if there.any()]
    return " and ".join(names)
