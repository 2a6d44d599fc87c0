"""The reference: collocation between events, for single parts and other methods' errors.

Between events each mode of contact is a smooth differential equation, solved by collocation to
about 13 digits; the solution is a polynomial, and events are certain roots of it (theory 13.1, 13.3
to 13.5). Single parts, at the speed of plain Python: some milliseconds for a period. It shares
nothing with the kernels.
"""

import math
from collections.abc import Iterable

import numpy as np
import scipy

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import (
    BLOCK_ON_FLOOR,
    COLUMNS,
    STATUS,
    Contacts,
    Groups,
    Method,
    Motion,
    each,
    motion_of,
    with_whole_shares,
)
from vibrafeed.core.motion.reference.laws import ReferenceLaws, X, Y
from vibrafeed.core.motion.reference.part import FailedError
from vibrafeed.core.motion.reference.repeats import PERIOD, ReferenceRun
from vibrafeed.core.scenes import Constraint
from vibrafeed.core.watch import Watch

LARGEST = 1e140
"""Largest number of a part: it is squared, and multiplied by phases."""


def reference_motion(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    max_periods: int = 100,
    watch: Watch | None = None,
) -> Motion:
    """Return the repeating motion of one part with its error; arrays without dimensions.

    `error` covers what is left of the transient, what the cycle changes if it is followed more
    finely, and rounding at every event, each with what the cycle makes of it. A motion that was not
    shown to repeat, and to attract, is `aperiodic`: its means are over the second half of the
    periods run, its spread is that of the single periods, and its error comes from their scatter;
    whether it runs away is for the reader to see. One that was still on its way, to a cycle or from
    one that does not attract, has no mean yet: `limit_reached`. So has one under numbers whose
    squares are outside double precision. Raises `StoppedError` if the watch stops it.
    """
    if not np.isfinite(_numbers(groups)).all():
        return _nothing()
    if np.abs(_numbers(groups)).max() > LARGEST:
        return _nothing("limit_reached")
    run = ReferenceRun(ReferenceLaws(groups, contacts), watch or Watch())
    for _ in range(max_periods):
        try:
            run.follow()
            if run.rests:
                return _result(0.0, 0.0, 0.0, run, 1, 1, "at_rest")
            if multiple := run.cycle():
                velocity, error = run.mean(multiple)
                if math.isfinite(error):
                    status = "neutral" if run.slides_free else "periodic"
                    return _result(velocity, error, 0.0, run, multiple, multiple, status)
            run.approach_cycle()
        except FailedError:
            return _nothing()
    if run.is_on_its_way:
        return _nothing("limit_reached")
    half = len(run.tallies) // 2
    velocities = np.array([
        float(after[X] - before[X]) / PERIOD
        for before, after in zip(run.before[half:], run.after[half:], strict=True)
    ])  # fmt: skip
    velocity, spread = float(np.mean(velocities)), float(np.std(velocities))
    largest_error = abs(velocity) + run.scale  # as fast as the drive, either way
    unsettled = run.lingers or run.drifts(len(run.tallies) - half)
    error = largest_error if unsettled else _scatter_error(velocities, largest_error)
    return _result(velocity, error, spread, run, len(velocities), 0, "aperiodic")


def _numbers(groups: Groups) -> Array:
    return np.concatenate([np.ravel(part) for part in (*groups.numbers, *(groups.wave or ()))])


def _scatter_error(means: Array, largest_error: float) -> float:
    # The error of the mean of single periods: what 99.9 % of Student's distribution allow for the
    # mean of up to 8 stretches, the halves' difference, and the largest distance from a steady
    # travel; at least `largest_error` if the halves differ by more than the scatter explains.
    if means.size < 2:
        return largest_error
    stretches = np.array([np.mean(part) for part in np.array_split(means, min(8, means.size))])
    quantile = float(scipy.special.stdtrit(stretches.size - 1, 0.9995)) / math.sqrt(stretches.size)
    first, second = (float(np.mean(part)) for part in np.array_split(means, 2))
    largest_stray = float(np.abs(np.cumsum(means - np.mean(means))).max()) / means.size
    error = quantile * float(np.std(stretches, ddof=1)) + abs(second - first) + largest_stray
    neighbour_scatter = math.sqrt(0.5 * float(np.mean(np.diff(stretches) ** 2)))
    return (
        max(error, largest_error)
        if abs(second - first) > 2.0 * quantile * neighbour_scatter
        else error
    )


def _motion(values: Iterable[float], status: str) -> Motion:
    arrays = (np.asarray(value, dtype=np.float64) for value in values)
    return Motion._make((*arrays, np.asarray(STATUS[status], dtype=np.int8)))


def _nothing(status: str = "no_solution") -> Motion:
    return _motion([math.nan] * COLUMNS, status)


def _result(
    velocity: float,
    error: float,
    spread: float,
    run: ReferenceRun,
    periods: int,
    multiple: int,
    status: str,
) -> Motion:
    # The `Motion` of a run: means over its last `periods`, in the order of the fields.
    tallies = run.tallies[-periods:]
    phase = PERIOD * periods
    across = float(run.after[-1][Y] - run.before[-periods][Y]) / phase
    comes_back = not run.is_off_wall(periods) or run.laws.contacts.rolling

    def total(name: str) -> float:
        return sum(getattr(tally, name) for tally in tallies)

    def largest(name: str) -> float:
        return max((getattr(tally, name) for tally in tallies), default=math.nan)

    values = (
        velocity, spread, error,
        *(total(name) / phase for name in ("stick", "forward", "backward", "flight")),
        total("impacts") / periods, largest("landing_speed"), largest("hop_height"),
        float(multiple), 0.0 if comes_back else across,
    )  # fmt: skip
    return with_whole_shares(_motion(values, status))


def motion_by_reference(
    groups: Groups, contacts: Contacts, *, max_periods: Array, watch: Watch | None = None
) -> Motion:
    """Return the motion from rest by collocation between events, theory 13.9.

    For single points: a cell takes up to some seconds.
    """
    watch = watch or Watch()
    parts, shape = each(groups)
    rows = np.full((math.prod(shape), COLUMNS), np.nan)
    status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
    for cell, part in enumerate(parts):
        if watch.stopped():
            break
        static_limit = part.friction_static * part.gravity_number_normal
        # Not told at a wall, whose friction may hold the part (theory 13.8).
        if not contacts.wall and abs(part.gravity_number_along) > static_limit:
            status[cell] = STATUS["runaway"]
        else:
            try:
                *rows[cell], status[cell] = reference_motion(
                    part, contacts, max_periods=int(max_periods), watch=watch
                )
            except StoppedError:
                break
        watch.advance(1 / len(rows))
    return motion_of(rows, status, shape)


REFERENCE = Method(
    name="reference",
    follow=motion_by_reference,
    source="theory 13.1",
    accuracy="about twelve digits, where the motion repeats",
    seconds_a_cell=0.05,
    defaults={"max_periods": 100.0},
    checked_by=("events",),
    refuses=tuple(
        Constraint(
            (name,),
            lambda _, largest: largest <= 1000,
            "the reference method integrates friction, and loses its digits above 1000",
            "Give at most 1000, or set method = 'events'",
            variant="reference",
        )
        for name in ("friction", "friction_kinetic")
    ),
)
