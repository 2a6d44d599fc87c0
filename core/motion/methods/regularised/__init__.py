"""Regularised friction on a stiff floor, by general integrators: a comparison for the exact laws.

Friction is a steep function of the sliding velocity and the floor is a spring with a damper. Both
laws are smooth where Coulomb's and Signorini's are set-valued (theory 13.1), so that any stiff
integrator applies; the price is a part that creeps where it should stick, and small steps. The
laws of theory 13.1 come back as `slip_speed` goes to 0 and `contact_stiffness` to infinity.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Contacts, Groups, cells_of, one_of
from vibrafeed.core.motion.method import Follow, Method
from vibrafeed.core.motion.methods.regularised.laws import Cell, laws
from vibrafeed.core.motion.methods.regularised.orbit import (
    Orbit,
    RegularisedRun,
    SpentError,
    measures_of,
    orbit_of,
)
from vibrafeed.core.motion.result import STATUS, Motion, with_whole_shares
from vibrafeed.core.watch import Watch

SOLVERS = ("Radau", "BDF", "LSODA")
"""The implicit integrators of scipy."""

MAX_EVALUATIONS = 1_000_000
"""Evaluations of the right-hand side after which a cell is given up: about ten seconds."""


TOLERANCE, SLIP_SPEED = 1e-7, 1e-4
"""Default settings: relative error of a step, and slip speed in g/w."""

COARSER, SOFTER = 4.0, 16.0
"""Factors of the slip speed and of the stiffness for the estimate of the error.

4^(2/3) and 16^(1/3) are 2.5: at the slowest orders the difference is 1.5 times the error.
"""

TWICE_COARSER = 5.0
"""Over this the difference is divided where both factors are applied twice.

(16 - 1)/(4 - 1): at order 1 it then says the same. Friction errs by terms of several orders and
either sign; where they cross, the first difference is as good as 0, and the second is not.
"""

SAFETY = 3.0
"""The estimate is so many times the differences, as that of time stepping is.

Where a slip stops near the peak of friction, the error falls more slowly than the orders say. Of
68 random studies the true error was larger than the differences once taken in 5, by up to 14.
"""

LOOSER = 10.0
"""Factor of the tolerance for the estimate of the integrator's error."""


def follow_run(
    cell: Cell, solver: str, tolerance: float, max_periods: int, watch: Watch | None = None
) -> tuple[RegularisedRun, Orbit, float]:
    """Return the run, the repeating motion, and the distance at which states count as equal.

    `solver` is one of `SOLVERS`, `tolerance` its relative error of a step; `max_periods` bounds the
    run, which `watch` may stop.
    """
    # Closer than this the regularisation itself is not known: it moves velocities by shares of
    # the slip speed. The other bound is the integrator's own noise over hundreds of steps.
    closeness = max(0.1 * cell.laws.slip_speed, 100 * tolerance)
    run = RegularisedRun(cell, solver, tolerance, MAX_EVALUATIONS, watch or Watch())
    return run, orbit_of(run, cell.rest(), max_periods, closeness), closeness


def _cells(
    part: Groups, slip: float, stiffness: float, softer: float, kept: Sequence[int]
) -> list[Cell]:
    """Return a cell with the regularised laws asked for, and two with coarser laws, for the error.

    `part` holds the dimensionless groups of one cell, `slip` is the slip speed in g/(2 pi f),
    `stiffness` that of the floor over mass times (2 pi f)^2; coarser cells have 4 and 16 times the
    slip speed and 1/`softer` and 1/`softer`^2 of the stiffness. `kept` are the indices of the axes:
    (0, 2) in the plane, (0, 1, 2) in space.
    """
    kinetic, static, rebound = part.friction_kinetic, part.friction_static, part.restitution
    drive, gravity = (tuple(three[i] for i in kept) for three in (part.drive, part.gravity))
    coarser = [(COARSER**n * slip, stiffness / softer**n) for n in range(3)]
    return [
        Cell(laws(kinetic, static, rebound, *pair), drive, gravity, part.wave) for pair in coarser
    ]


def _cell_motion(
    cell: Cell,
    coarse: Sequence[Cell],
    solver: str,
    tolerance: float,
    max_periods: int,
    watch: Watch,
) -> dict[str, float | str]:
    """Return the fields of `Motion` for one cell by name, with the name of its status.

    `cell` is the part with steep friction and a stiff floor; `coarse` are the same cell with
    coarser laws, once and twice, whose velocities give the error. `solver`, `tolerance` and
    `max_periods` are those of `regularised_motion`; `watch` may stop the work. Velocities in g/w,
    heights in g/w^2 (w = 2 pi f); NaN where the motion does not repeat, but for the mean velocity
    of a run that came to a limit.
    """
    nothing: dict[str, float | str] = {**dict.fromkeys(Motion._fields, math.nan), "multiple": 0}
    if cell.gravity[-1] <= 0:  # the part falls off the floor
        return {**nothing, "status": "runaway"}
    frictionless = cell.laws.friction_static == 0
    if frictionless and any(cell.gravity[:-1]):
        return {**nothing, "status": "runaway"}

    run, orbit, closeness = follow_run(cell, solver, tolerance, max_periods, watch)
    unfinished = {**nothing, "velocity": orbit.velocity, "status": orbit.status}
    if orbit.status != "periodic":
        return unfinished
    try:
        measures = measures_of(run, orbit)
    except SpentError:
        return {**unfinished, "status": "limit_reached"}
    # From where the fine motion is, so that all are on one attractor where there are several.
    # Runs of their own, since the errors of the laws and of the integrator can cancel in one.
    once, twice, loose = (
        orbit_of(
            RegularisedRun(changed, solver, looser * tolerance, MAX_EVALUATIONS, watch),
            orbit.states[-1],
            max_periods,
            max(wider * closeness, 100 * looser * tolerance),
        ).velocity
        - orbit.velocity
        for changed, looser, wider in (
            (coarse[0], 1.0, COARSER),
            (coarse[1], 1.0, COARSER**2),
            (cell, LOOSER, COARSER),
        )
    )
    by_laws = np.fmax(abs(once), abs(twice) / TWICE_COARSER)
    return {
        **measures,
        "velocity": orbit.velocity,
        "spread": 0.0,
        "error": SAFETY * (float(by_laws) + abs(loose)),
        "multiple": orbit.multiple,
        "across": orbit.across(cell.coordinates),
        "status": "neutral" if frictionless else "periodic",
    }


def regularised_motion(
    groups: Groups,
    *,
    slip_speed: ArrayLike,
    contact_stiffness: ArrayLike,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    solver: str,
    planar: bool,
    softer: float = SOFTER,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion with regularised friction on a stiff floor, by a stiff integrator.

    Theory 13.1 without a wall and without curvature, 13.2 in the plane. A loop over the cells: a
    comparison for the methods that keep the exact laws, not a rival.

    Parameters
    ----------
    groups
        Dimensionless groups of the cells. A static friction below the kinetic one counts as equal
        to it. Values of the restitution below about (8/stiffness^(1/2))^(2/3)/4, 0 among them, all
        give this share; see `damping_ratio`.
    slip_speed
        Speed below which friction gives way, in g/(2 pi f); array_like.
    contact_stiffness
        Stiffness of the floor, over mass times w^2 with w = 2 pi f; array_like.
    tolerance
        Relative error of a step of the integrator; up to a thousandth of the slip speed, lest the
        integrator's scatter hide what the laws' errors are; array_like.
    max_periods
        Periods of the drive after which a cell is given up; array_like of int.
    solver
        One of `SOLVERS`. LSODA takes the least time, but may stay with its explicit formula after a
        landing until the evaluations are used up; Radau did not fail.
    planar
        True for motion along and normal to the track only; the groups across must then be 0.
    softer
        Factor of the stiffness for the estimate of the error; 1 where the stiffness is that of a
        lining, and no error.
    watch
        May stop the work; cells that are not finished have the status `not_computed`.

    Returns
    -------
    Motion
        Arrays of the arguments' common shape. The laws are approached at least as slip_speed^(2/3)
        (the delay at the peak of friction; the power is 1 without a peak) and stiffness^(-1/3) (the
        recovery of the damped floor). With 4 times the slip speed and a sixteenth of the stiffness
        either error is 2.5 times as large. `error` is three times the larger of the differences to
        that run and, divided by 5, to one where both are applied twice, plus three times that to a
        run with 10 times the tolerance: 4.5 times the error at those powers, 9 at order 1.

        A part at rest creeps: it is `periodic` with the mean velocity of the creep, of the order of
        the slip speed, and a stick of 1; the status `at_rest` is never given. Sticking means slower
        than 3 slip speeds, flight no force of the floor. Hops are counted as far as the integrator
        resolves them. The status is `limit_reached` where the motion has not repeated within 8
        periods of the drive when the periods or a million evaluations are used up, or where the
        integrator gives up: the velocity is then the mean of the later half, and the rest is NaN.
        It is `no_solution` where an argument is not a number or out of its range.
    """
    if solver not in SOLVERS:
        raise ValueError(f"solver is {solver!r}; it must be one of {', '.join(SOLVERS)}")
    if planar and not groups.planar:
        raise ValueError("planar motion has no drive and no gravity across the track")
    settings = {
        "slip_speed": slip_speed,
        "contact_stiffness": contact_stiffness,
        "tolerance": tolerance,
        "max_periods": max_periods,
    }
    rows, shape = cells_of(groups, **settings)
    fields = {name: np.full(shape, np.nan) for name in Motion._fields[:-1]}
    fields["multiple"][...] = 0
    status = np.full(shape, STATUS["not_computed"], dtype=np.int8)
    watch = watch or Watch()
    kept = [0, 2] if planar else [0, 1, 2]
    for index, row in zip(np.ndindex(shape), rows, strict=True):
        if watch.stopped():
            break
        part, numbers = one_of(row, groups.wave is not None, 4)
        usable = bool(np.isfinite(row).all()) and min(numbers) > 0
        if not (usable and part.friction_kinetic >= 0 and 0 <= part.restitution <= 1):
            status[index] = STATUS["no_solution"]
            continue
        slip, stiffness, error, periods = numbers
        cell, *coarse = _cells(part, slip, stiffness, softer, kept)
        try:
            means = _cell_motion(cell, coarse, solver, error, int(periods), watch)
        except StoppedError:
            break
        for name, values in fields.items():
            values[index] = means[name]
        status[index] = STATUS[str(means["status"])]
    return with_whole_shares(Motion(**fields, status=status))


def sprung(solver: str, softer: float = SOFTER) -> Follow:
    """Return the function of the motion equation for a sprung floor, by one of the integrators.

    `solver` names the integrator, one of `SOLVERS`. `softer` is the factor by which the stiffness
    is reduced to estimate the error; 1 if the stiffness is that of a lining, and no error.
    """

    def motion(
        *,
        groups: Groups,
        slip_speed: Array,
        contact_stiffness: Array,
        tolerance: Array,
        max_periods: Array,
        watch: Watch | None = None,
    ) -> Motion:
        """Return the motion with regularised friction on a stiff floor.

        A comparison for the methods that keep the exact laws: a cell takes seconds.
        """
        return regularised_motion(
            groups,
            slip_speed=slip_speed,
            contact_stiffness=contact_stiffness,
            tolerance=tolerance,
            max_periods=max_periods,
            solver=solver,
            planar=groups.planar,
            softer=softer,
            watch=watch,
        )

    return motion


def _by(name: str, solver: str, seconds_a_cell: float) -> Method:
    """Return the simulation method of this name that uses one of the integrators of scipy.

    `solver` is one of `SOLVERS`, `seconds_a_cell` is roughly the time of a cell [s].
    """

    def follow(contacts: Contacts) -> Follow:
        """Return the motion equation's function; all contacts are treated alike."""
        del contacts
        return sprung(solver)

    return Method(
        name=name,
        follow=follow,
        source="theory 13.1",
        accuracy="falls with slip_speed and with the inverse of contact_stiffness",
        seconds_a_cell=seconds_a_cell,
        defaults={
            "tolerance": TOLERANCE,
            "max_periods": 100.0,
            "slip_speed": SLIP_SPEED,
            "contact_stiffness": 1e8,
        },
        checked_by=("events", "reference"),
        # Regularised friction acts on the part itself, so that only a block has it in space.
        follows=lambda contacts: not contacts.wall and contacts.rolling == 0,
    )


RADAU = _by("regularised", "Radau", 1.2)
BDF = _by("regularised-BDF", "BDF", 1.0)
LSODA = _by("regularised-LSODA", "LSODA", 0.12)
