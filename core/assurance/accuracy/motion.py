"""Methods of motion against each other: error of the mean velocity over time of a cell."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.assurance.accuracy.cells import random_cells
from core.assurance.accuracy.curves import STEEP, Curve, Measured, Point
from core.mechanics.arrays import Array
from core.motion.prepare import Simulation
from core.motion.result import STATUS
from core.plan.equations import run_equations
from core.plan.plan import plan_scene, scene_parameters
from core.scenes import Scene
from core.watch import Watch

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
    """Return the results of a method with settings at cells of shape (n,), SI units."""
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
    """Return the share of the time for each method of a scene."""
    named = [name for name in ("events", "regularised") if name in scene.variants]
    return SHARES["both"] + sum(SHARES[name] for name in named)


def _nothing_moves(count: int, watch: Watch) -> str:
    """Return the note for a study without measurable motions."""
    if watch.stopped():
        return "The time given ran out before a cell was found whose motion repeats."
    return f"No cell of {count} random ones moves and repeats its motion: nothing is measured."


def measure(simulation: Simulation, watch: Watch, cells: int = CELLS) -> Measured:
    """Return errors and times of all methods that simulate a study's motion."""
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
    """True where a cell occurs for the first time, as small grids repeat cells."""
    rows = np.stack(list(cells.values()), axis=-1)
    first = np.zeros(len(rows), dtype=np.bool_)
    first[np.unique(rows, axis=0, return_index=True)[1]] = True
    return first


def _both_kinds(chosen: NDArray[np.intp], hops: NDArray[np.bool_], count: int) -> NDArray[np.intp]:
    """Return the first cells, half of them hopping if there are enough."""
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
    """Run a method on one cell, to load and compile it, then on all."""
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
    """Return the results and median time of three runs, or one run if it is slow."""
    first = _warm(scene, method, cells, settings, watch)
    times = [first.seconds]
    while len(times) < 3 and times[0] * first.velocity.size < 0.5 and not watch.stopped():
        times.append(run_method(scene, method, cells, settings, Watch(stop=watch.stop)).seconds)
    return replace(first, seconds=float(np.median(times)))


def _groups(
    cells: Mapping[str, Array], truth: Array, hops: NDArray[np.bool_]
) -> Iterator[tuple[str, dict[str, Array], Array]]:
    """Yield the sliding and the hopping cells, with their true velocities."""
    for name, where in (("sliding", ~hops), ("hopping", hops)):
        if where.any():
            yield name, {key: values[where] for key, values in cells.items()}, truth[where]


def point_of(
    setting: str, value: float, run: Means, truth: Array, floor: float = ROUNDING
) -> Point | None:
    """Return the measured point of a run; None if a cell has no value."""
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
    """Return a curve of the measured points."""
    kept = tuple(point for point in points if point)
    return Curve("motion", f"{group} cells", method, kept, says, slope, floor, of="largest")


def _by_steps(
    method: str, group: str, points: Sequence[Point | None], says: str, slope: float, floor: float
) -> Curve:
    """Return a curve whose slope is over the number of steps, not over time."""
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
    """Yield the curves of event-driven simulation over its tolerance."""
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
    """Yield the curves of time stepping over its steps, with extrapolation."""
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
    """Return two runs extrapolated to step 0, for an error that is a power of the step."""
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
    """Yield the curves of stiff integrators over slip speed, with matching stiffness."""
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
