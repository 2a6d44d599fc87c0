"""A drive that begins and ends: from rest, some periods long, until the part rests again.

The acceleration of the drive acts from phase 0 on, that of a plain sine from 90 degrees on, where
the track turns: so the track starts at rest and is at rest after whole periods. A recording that is
followed as it is, is one such period. Part and events are those of the reference; afterwards the
same laws act on a track at rest.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import (
    Burst,
    Contacts,
    Groups,
    Path,
    Trajectory,
    TrajectoryRequest,
    cells_of,
    each,
    groups_of,
)
from vibrafeed.core.motion.record import Record
from vibrafeed.core.motion.reference.laws import SPIN, UX, UY, UZ, Mode, ReferenceLaws, X, Z
from vibrafeed.core.motion.reference.part import STOPPED, FailedError, Part
from vibrafeed.core.motion.waves import ALONG, NORMAL, TURN, position_at, velocity_at
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.watch import Watch

MAX_COASTING = 1_000
"""Periods of the drive, as a time, within which the part has to come to rest."""


NO_PHASES = np.empty(0)


class _Stopping(Part):
    # A part that remembers the phase of its last event.
    last = 0.0

    def apply_event(self, event: str, mode: Mode) -> str:
        self.last = self.phase if event else self.last
        return super().apply_event(event, mode)

    def stop_straight(self, mode: Mode, end: float) -> bool:
        stopped = super().stop_straight(mode, end)
        self.last = self.phase if stopped else self.last
        return stopped

    @property
    def rests(self) -> bool:
        """True where the part lies on the floor without any speed."""
        return self.on_floor and bool(np.all(np.abs(self.state[[UX, UY, UZ]]) <= STOPPED))


def follow_burst(
    groups: Groups,
    contacts: Contacts,
    periods: int,
    watch: Watch,
    record: Record | None,
    sample_phases: Array = NO_PHASES,
) -> tuple[float, float, Array]:
    """Return travel and coasting of one part, as in `Burst`, and its states.

    The states, shape (n, 7), are those at phases `sample_phases` since the start, shape (n,),
    ascending.
    """
    start = math.pi / 2 if groups.wave is None and record is None else 0.0
    part = _Stopping(ReferenceLaws(groups, contacts, record=record), np.zeros(7), watch=watch)
    part.phase = start
    rows, phases = np.full((sample_phases.size, 7), np.nan), start + sample_phases
    part.advance(start + periods * TURN, phases, rows)
    groups_at_rest = groups._replace(
        drive_number_along=0.0, drive_number_across=0.0, drive_number_normal=0.0, wave=None
    )
    part.laws, part.until, part.last = ReferenceLaws(groups_at_rest, contacts), math.inf, part.phase
    end = part.phase
    after_end = phases > end
    for turn in range(MAX_COASTING):
        if part.rests and static_friction_holds(groups_at_rest):
            rows[after_end & np.isnan(rows[:, X])] = part.state
            return float(part.state[X]), part.last - end, rows
        until = end + (turn + 1) * TURN
        in_turn = after_end & (phases > part.phase) & (phases <= until)
        states = rows[in_turn]
        part.advance(until, phases[in_turn], states)
        rows[in_turn] = states
    return math.nan, math.nan, rows


def static_friction_holds(groups: Groups) -> bool:
    """True where static friction holds a part on the track at rest."""
    return bool(
        abs(groups.gravity_number_along) <= groups.friction_static * groups.gravity_number_normal
    )


def burst_by_reference(
    groups: Groups,
    contacts: Contacts,
    *,
    burst_periods: Array,
    record: Record | None = None,
    watch: Watch | None = None,
) -> Burst:
    """Return the way of parts from rest under a drive of some periods, theory 13.9.

    For single points: a cell takes some milliseconds for a period, and for a sample of a `record`.
    """
    watch = watch or Watch()
    rows, shape = cells_of(groups, periods=burst_periods)
    whole, (periods,) = groups_of(rows, groups.wave is not None, 1)
    table = np.full((len(rows), 2), np.nan)
    for cell, part in enumerate(each(whole)[0]):
        try:
            table[cell] = follow_burst(part, contacts, round(periods[cell]), watch, record)[:2]
        except FailedError:
            continue
        except StoppedError:
            break
        watch.advance(1 / len(rows))
    return Burst(*(column.reshape(shape) for column in table.T))


def burst_trajectory(
    request: TrajectoryRequest, contacts: Contacts, *, record: Record | None = None
) -> Trajectory:
    """Return the trajectory of one part in a burst, until it rests or at the asked times."""
    groups, periods = request.groups, round(request.known["burst_periods"].item())
    length = request.scale("length_scale")
    time_scale = length / request.scale("velocity_scale")  # of time [s]
    if isinstance(request.samples, int):
        duration = periods * TURN + float(np.nan_to_num(request.known["burst"].coasting.item()))
        request = request._replace(
            samples=(*np.linspace(0.0, time_scale * duration, request.samples + 1),)
        )
    phases = request.times()[1]
    rows = follow_burst(groups, contacts, periods, request.watch, record, phases)[2]
    trajectory = request.trajectory(
        Path(phases, rows[:, :UX], rows[:, UX:SPIN]), _modes(rows), contacts.wall
    )
    ends = np.minimum(phases, periods * TURN)
    track = {
        name: length * _track(groups, record, axis, ends)
        for name, axis in (("track_along", ALONG), ("track_normal", NORMAL))
    }
    return {**trajectory, **track}


def _modes(rows: Array) -> NDArray[np.int8]:
    # The `MOTION_MODES` value of each state, NaN being unknown.
    slip = np.where(np.abs(rows[:, UX]) <= STOPPED, 0.0, rows[:, UX])
    names = np.select(
        [np.isnan(slip), rows[:, Z] > 0.0, slip > 0.0, slip < 0.0],
        [MOTION_MODES[name].value for name in ("unknown", "flight", "forward", "backward")],
        MOTION_MODES["stick"].value,
    )
    return names.astype(np.int8)


def _track(groups: Groups, record: Record | None, axis: int, phases: Array) -> Array:
    # Displacement of the track since it started from rest, in g/w^2.
    if record is not None:
        return groups.drive[axis] * record.moved(axis, phases, 2)
    if groups.wave is None:
        return np.asarray(groups.drive[axis] * (np.cos(phases) - 1.0))
    straight = position_at(groups.wave, axis, 0.0) + velocity_at(groups.wave, axis, 0.0) * phases
    return position_at(groups.wave, axis, phases) - straight
