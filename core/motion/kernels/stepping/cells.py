"""One cell from rest until it repeats, and many cells."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop, copy
from vibrafeed.core.motion.kernels.cells import GROUPS, Cell, cell_of
from vibrafeed.core.motion.kernels.means import fill_means
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS, TALLY
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.stepping.period import planar_period, spatial_period
from vibrafeed.core.motion.kernels.stepping.repeat import repeats, unsettled
from vibrafeed.core.motion.kernels.stepping.tables import DRIVE, PLANAR, STATE, WALL, WIDTHS

SAFETY = 3.0
LANDING_SHARE = 0.15
"""The estimate of the error: `SAFETY` times the largest difference of three runs and, with hops,
this share of what a step of the finest changes in the velocity.

The place of a landing within a step has the standard deviation 1/sqrt(12) of it; half of that is
left where several landings, and friction, have a say. Three runs differ too little by chance: with
a safety of 2 and nothing else the true error was larger in 3 % of random studies, up to 34 times;
`benchmarks.honest_estimates` tells what is left.
"""


@compiled
def run(
    scene: int, cell: Cell, rolling: float, absolute: bool, drive: Floats, steps: int,
    states: Floats, tallies: Floats, result: Floats, stop: Stop,
) -> int:  # fmt: skip
    """Follow one cell from rest until its motion repeats; fill the result and return the status.

    Period by period, by `planar_period` or `spatial_period`. The error in the result is that of the
    mean's limit only, not that of the step length.

    Parameters
    ----------
    scene
        `PLANAR`, `FLOOR` (in space without wall) or `WALL`.
    cell
        The cell's numbers.
    rolling
        m r^2/I of a cylinder (radius r, moment of inertia I), 0 for a block.
    absolute
        If the curve acts by the speed in space, not by that relative to the track.
    drive, steps
        The drive in each step (rows of `DRIVE`), and steps a period.
    states, tallies
        Filled with the states between periods (columns of `STATE`), and with the sums over each
        period (columns of `TALLY`).
    result
        One value a column of `COLUMN`.
    stop
        Flag that ends the work.
    """
    h = 2.0 * math.pi / steps
    # The largest acceleration: what a step can change in a velocity, by the place of an event.
    scale = (
        abs(cell.drive_number_along) + abs(cell.drive_number_across) + abs(cell.drive_number_normal)
    )
    scale = (
        scale
        + abs(cell.gravity_number_along)
        + abs(cell.gravity_number_across)
        + abs(cell.gravity_number_normal)
    )
    width = WIDTHS[scene]
    state = np.zeros(width)
    state[STATE.spare], state[STATE.pressed] = math.inf, 1.0
    if scene == WALL:
        state[STATE.leaning] = 1.0
    copy(state, states[0, :width])
    seen = states[:, :width]
    done = 0
    for period in range(int(cell.max_periods)):
        if raised(stop):
            return STATUS.not_computed
        tally = tallies[period]
        tally[:] = 0.0
        if scene == PLANAR:
            planar_period(state, tally, cell, drive, h)
        else:
            spatial_period(scene == WALL, rolling, absolute, state, tally, cell, drive, h)
        done = period + 1
        seen[done] = state
        if not math.isfinite(tally[TALLY.peak]) or tally[TALLY.failed] > 0.0:
            result[:] = np.nan
            return STATUS.no_solution
        if tally[TALLY.peak] <= 1e-9 * h:
            fill_means(tallies, period, done, steps * h, result)
            result[COLUMN.velocity], result[COLUMN.multiple] = 0.0, 1.0
            return STATUS.at_rest
        multiple = repeats(
            seen, tallies, done, 1e-12 * scale, cell.tolerance * h * scale, steps * h, result
        )
        if multiple > 0:
            result[COLUMN.multiple] = multiple
            return STATUS.periodic
    fill_means(tallies, done // 4, done, steps * h, result)
    return unsettled(scene, cell, seen, tallies, done, steps * h, result)


@compiled
def push_of(scene: int, cell: Cell) -> float:
    """Return the largest change of the velocity along the track per unit of phase, in g.

    p_x + sin(gamma) + mu_k (p_z + n), and mu_w (p_y + g_y) more at a wall, with the drive numbers p
    and gravity numbers of `cell`; `scene` is `PLANAR`, `FLOOR` or `WALL`. It bounds what a time
    step may change in a velocity, and so the tolerance for states that repeat (theory 13.9).
    """
    load = abs(cell.drive_number_normal) + cell.gravity_number_normal
    push = (
        abs(cell.drive_number_along) + abs(cell.gravity_number_along) + cell.friction_kinetic * load
    )
    if scene == WALL:
        push += cell.wall_friction * (
            abs(cell.drive_number_across) + abs(cell.gravity_number_across)
        )
    return push


@compiled
def buffer_of(waves: Floats) -> Floats:
    """Return a buffer for the sine drive of a cell, sampled at the time steps of a period.

    A row for each of `DRIVE`, a column a step, with the lengths of the steps filled in; the pushes
    depend on the cell, and are filled later. `waves` has shape (cells, rows, steps).
    """
    columns = waves.shape[2]
    buffer = np.zeros((len(DRIVE), columns))
    buffer[DRIVE.length] = 2.0 * math.pi / columns
    buffer[DRIVE.share] = 1.0
    return buffer


@compiled
def drive_of(scene: int, cell: Cell, waves: Floats, row: int, buffer: Floats) -> Floats:
    """Return the drive of a cell at each time step, as an array of a row for each of `DRIVE`.

    Of shape (rows, steps): (p_x, p_y, p_z) sin(tau) in g, and p_x cos(tau) as the speed of the
    track; it is the cell's own wave, or the plain sine, written into `buffer`.

    Parameters
    ----------
    scene
        The kind of motion; in the plane (`PLANAR`) the rows across and speed stay 0.
    cell
        The cell's numbers, of which the drive numbers p are read.
    waves
        A drive for each cell, or one row of sine and cosine at the middles of the steps, for all
        cells (theory 13.1).
    row
        The cell's index in `waves`.
    buffer
        Array to write into, of the shape of the result.
    """
    if waves.shape[1] == len(DRIVE):
        return waves[row]
    sines, cosines = waves[0]
    for k in range(sines.size):
        buffer[DRIVE.along, k] = cell.drive_number_along * sines[k]
        buffer[DRIVE.normal, k] = cell.drive_number_normal * sines[k]
    if scene != PLANAR:
        for k in range(sines.size):
            buffer[DRIVE.across, k] = cell.drive_number_across * sines[k]
            buffer[DRIVE.speed, k] = cell.drive_number_along * cosines[k]
    return buffer


@compiled
def step_cells(
    scene: int, rolling: float, absolute: bool, steps: int, waves: Floats, shifted_waves: Floats,
    fine_waves: Floats, groups: Floats, table: Floats, status: Statuses, stop: Stop,
) -> None:  # fmt: skip
    """Fill the table of results (columns of `COLUMN`) and statuses of cells by time stepping.

    Each cell is followed with up to three steppings. The results are those of the finest run, their
    error three times the largest of |v_fine - v_other| of the two others and of the error and
    spread that the finest run tells itself, and with hops 0.15 h `push_of` more, h the step in rad
    (theory 13.9).

    Parameters
    ----------
    scene, rolling, absolute
        `PLANAR`, `FLOOR` or `WALL`; m r^2/I of a cylinder or 0; True if the speed in space counts
        in a curve.
    steps
        Steps n a period of the coarser run.
    waves, shifted_waves, fine_waves
        The drives of that run, of one that starts half a step earlier, and of the finer one with 2
        n + 1 steps: rows of `DRIVE` for each cell or, for all cells at once, sine and cosine at the
        middles of the steps.
    groups
        A row with the fields of `Cell` for each cell.
    stop
        Flag that ends the work.
    """
    most = max(1, int(groups[:, GROUPS - 1].max()))
    states, tallies = np.zeros((most + 1, WIDTHS[scene])), np.zeros((most, len(TALLY)))
    coarse, shifted, fine = np.zeros(RESULTS), np.zeros(RESULTS), np.zeros(RESULTS)
    buffer, shifted_buffer, fine_buffer = (
        buffer_of(waves),
        buffer_of(shifted_waves),
        buffer_of(fine_waves),
    )
    finest = 2 * steps + 1
    for i in range(groups.shape[0]):
        cell = cell_of(groups[i])
        table[i] = np.nan
        if not np.all(np.isfinite(groups[i])) or cell.gravity_number_normal < 0.0:
            status[i] = STATUS.no_solution
            continue
        drive = drive_of(scene, cell, fine_waves, i, fine_buffer)
        outcome = run(scene, cell, rolling, absolute, drive, finest, states, tallies, fine, stop)
        frictionless = cell.friction_static == 0.0 and cell.friction_kinetic == 0.0
        if scene == WALL:
            frictionless = frictionless and cell.wall_friction == 0.0
        if frictionless and outcome != STATUS.no_solution and outcome != STATUS.at_rest:
            outcome = STATUS.neutral if cell.gravity_number_along == 0.0 else STATUS.runaway
        status[i] = STATUS.not_computed if raised(stop) else outcome
        if outcome in (STATUS.no_solution, STATUS.runaway):
            continue
        drive = drive_of(scene, cell, waves, i, buffer)
        run(scene, cell, rolling, absolute, drive, steps, states, tallies, coarse, stop)
        apart = abs(fine[COLUMN.velocity] - coarse[COLUMN.velocity])
        if not math.isfinite(apart):  # the coarser run found no solution in a step
            apart = abs(fine[COLUMN.velocity])
        error = max(apart, fine[COLUMN.error], fine[COLUMN.spread])
        if error > 1e-12:
            # Where in a step landings and stops fall is chance, and may hide the error of the step.
            drive = drive_of(scene, cell, shifted_waves, i, shifted_buffer)
            run(scene, cell, rolling, absolute, drive, steps, states, tallies, shifted, stop)
            apart = abs(fine[COLUMN.velocity] - shifted[COLUMN.velocity])
            error = SAFETY * max(error, apart if math.isfinite(apart) else 0.0)
        if fine[COLUMN.flight] > 0.0:
            # All three runs may agree by chance. A landing falls anywhere within a step.
            error += LANDING_SHARE * (2.0 * math.pi) / finest * push_of(scene, cell)
        if raised(stop):
            status[i] = STATUS.not_computed
            return
        table[i] = fine
        table[i, COLUMN.error] = error
