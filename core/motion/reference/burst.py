"""A drive that begins and ends: from rest, some periods long, until the part rests again.

The acceleration of the drive acts from phase 0 on, that of a plain sine from 90 degrees on, where
the track turns: so the track starts at rest and is at rest after whole periods. Part and events are
those of the reference; afterwards the same laws act on a track at rest.
"""

import math

import numpy as np

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Burst, Contacts, Groups, cells_of, each, groups_of
from vibrafeed.core.motion.reference.laws import UX, UY, UZ, Mode, ReferenceLaws, X
from vibrafeed.core.motion.reference.part import STOPPED, FailedError, Part
from vibrafeed.core.motion.waves import TURN
from vibrafeed.core.watch import Watch

MAX_COASTING = 1_000
"""Periods of the drive, as a time, within which the part has to come to rest."""


class _Stopping(Part):
    # A part that remembers the phase of its last event.
    last = 0.0

    def happen(self, event: str, mode: Mode) -> str:
        self.last = self.phase if event else self.last
        return super().happen(event, mode)

    def close(self, mode: Mode, end: float) -> bool:
        closed = super().close(mode, end)
        self.last = self.phase if closed else self.last
        return closed

    @property
    def rests(self) -> bool:
        """True where the part lies on the floor without any speed."""
        return self.on_floor and bool(np.all(np.abs(self.state[[UX, UY, UZ]]) <= STOPPED))


def follow_burst(
    groups: Groups, contacts: Contacts, periods: int, watch: Watch
) -> tuple[float, float]:
    """Return travel and coasting of one part, as in `Burst`."""
    start = math.pi / 2 if groups.wave is None else 0.0
    part = _Stopping(ReferenceLaws(groups, contacts), np.zeros(7), watch=watch)
    part.phase = start
    part.advance(start + periods * TURN)
    still = groups._replace(
        drive_number_along=0.0, drive_number_across=0.0, drive_number_normal=0.0, wave=None
    )
    part.laws, part.until, part.last = ReferenceLaws(still, contacts), math.inf, part.phase
    end = part.phase
    for turn in range(MAX_COASTING):
        if part.rests and held(still):
            return float(part.state[X]), part.last - end
        part.advance(end + (turn + 1) * TURN)
    return math.nan, math.nan


def held(groups: Groups) -> bool:
    """True where static friction holds a part on the track at rest."""
    return bool(
        abs(groups.gravity_number_along) <= groups.friction_static * groups.gravity_number_normal
    )


def burst_by_reference(
    groups: Groups, contacts: Contacts, *, burst_periods: Array, watch: Watch | None = None
) -> Burst:
    """Return the way of parts from rest under a drive of some periods, theory 13.9.

    For single points: a cell takes some milliseconds for a period.
    """
    watch = watch or Watch()
    rows, shape = cells_of(groups, periods=burst_periods)
    whole, (periods,) = groups_of(rows, groups.wave is not None, 1)
    table = np.full((len(rows), 2), np.nan)
    for cell, part in enumerate(each(whole)[0]):
        try:
            table[cell] = follow_burst(part, contacts, round(periods[cell]), watch)
        except FailedError:
            continue
        except StoppedError:
            break
        watch.advance(1 / len(rows))
    return Burst(*(column.reshape(shape) for column in table.T))
