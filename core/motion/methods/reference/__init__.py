"""The reference: integration of order 8 between events, for single parts and other methods' errors.

Between events each mode of contact is a smooth differential equation, solved to about 11 digits;
events are found on its dense output (theory 13.1, 13.3 to 13.5). Single parts, at the speed of
plain Python: some hundredths of a second for a period. It shares nothing with the kernels.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from core.mechanics.arrays import Array
from core.motion.groups import BLOCK_ON_FLOOR, Contacts, Groups, each
from core.motion.method import Follow, Method
from core.motion.methods.reference.laws import UX, UZ, Laws, X, Z
from core.motion.methods.reference.part import FailedError, Part, Tally
from core.motion.path import Path
from core.motion.result import STATUS, Motion, motion_of, with_whole_shares
from core.scenes import Constraint
from core.watch import Watch

MOST_MULTIPLE = 6


def reference_path(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    phases: ArrayLike,
    absolute_speed: bool = True,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: float = 0.0,
) -> Path:
    """Return where one part is at given phases, to about ten digits.

    Parameters
    ----------
    phases : array_like, shape (n,)
        Ascending; the given state is that at the first.
    position, velocity : sequence of 3 floats
        Along, across and normal, in g/w^2 and g/w.
    spin : float
        As in `core.motion.methods.stepping.stepped_path`.

    Other parameters are those of `reference_motion`.

    Returns
    -------
    Path
    """
    asked = np.atleast_1d(np.asarray(phases, dtype=np.float64))
    if not np.all(np.isfinite(asked)) or np.any(np.diff(asked) < 0.0):
        raise ValueError("phases must be finite and ascend")
    state = np.array([*position, *velocity, spin], dtype=np.float64)
    part = Part(Laws(groups, contacts, absolute_speed), state)
    part.phase = float(asked[0])
    rows = np.full((asked.size, 7), np.nan)
    with contextlib.suppress(FailedError):  # what was not reached stays NaN
        part.advance(float(asked[-1]), asked, rows)
    return Path(asked, rows[:, X : Z + 1], rows[:, UX : UZ + 1])


def reference_motion(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    absolute_speed: bool = True,
    most_periods: int = 100,
) -> Motion:
    """Return the motion of one part once it repeats, to about ten digits; arrays of no dimension.

    A transient that dies out as a power is extrapolated to its end; `error` is what the last
    extrapolations differed by. Motion that does not repeat to 1e-11 is `aperiodic`, its means are
    over the second half of the periods run, and its spread is that of the single periods; whether
    it runs away is for the reader to see.

    Parameters
    ----------
    groups : Groups
        Of one part.
    contacts : Contacts
        What it can touch.
    absolute_speed : bool
        Whether the centripetal acceleration is that of the speed in space; else of the speed
        relative to the track.
    most_periods : int
        Periods after which the motion counts as aperiodic.
    """
    part = Part(Laws(groups, contacts, absolute_speed), np.zeros(7))
    states, tallies = [part.state.copy()], []
    for period in range(most_periods):
        part.tally = Tally()
        try:
            part.advance(2.0 * math.pi * (period + 1))
        except FailedError:
            return _result(math.nan, math.nan, math.nan, [], 0, "no_solution")
        tallies.append(part.tally)
        states.append(part.state.copy())
        moved = part.tally.forward + part.tally.backward + part.tally.flight
        if moved == 0.0 and np.array_equal(states[-1], states[-2]):
            return _result(0.0, 0.0, 0.0, tallies[-1:], 1, "at_rest")
        for multiple in range(1, min(MOST_MULTIPLE, (period + 1) // 4) + 1):
            found = _limit(states, multiple)
            if found is not None:
                return _result(*found, 0.0, tallies[-multiple:], multiple, "periodic")
    half = len(tallies) // 2
    travels = np.diff([state[X] for state in states])[half:] / (2.0 * math.pi)
    spread = float(np.std(travels))
    return _result(float(np.mean(travels)), spread, spread, tallies[half:], 0, "aperiodic")


def _limit(states: list[Array], multiple: int) -> tuple[float, float] | None:
    """Return mean velocity and its error if the last periods converge with this multiple."""
    ends = np.array([states[-1 - k * multiple] for k in range(5)])
    velocity = (ends[:-1, X] - ends[1:, X]) / (2.0 * math.pi * multiple)
    apart = np.abs(ends[:-1, Z:] - ends[1:, Z:]).max(axis=1)
    if max(apart[0], apart[1], abs(velocity[0] - velocity[1])) < 1e-11:
        return float(velocity[0]), float(abs(velocity[0] - velocity[1]))
    if not (apart[0] < 0.999 * apart[1] < apart[2] and apart[0] < 1e-3):
        return None
    limits = []
    for new, middle, old in (velocity[:3], velocity[1:]):
        change = (new - middle) - (middle - old)
        if change == 0.0:
            return None
        limits.append(new - (new - middle) ** 2 / change)
    error = float(abs(limits[0] - limits[1]))
    return (float(limits[0]), error) if error < 1e-11 else None


def _result(
    velocity: float, error: float, spread: float, tallies: list[Tally], multiple: int, status: str
) -> Motion:
    """Return the counts of some periods as a result."""
    phase = 2.0 * math.pi * max(1, len(tallies))

    def total(name: str) -> float:
        return sum(getattr(tally, name) for tally in tallies)

    def most(name: str) -> float:
        return max((getattr(tally, name) for tally in tallies), default=math.nan)

    values = (
        velocity, spread, error,
        *(total(name) / phase for name in ("stick", "forward", "backward", "flight")),
        total("impacts") / max(1, len(tallies)), most("landing_speed"), most("hop_height"),
        float(multiple),
    )  # fmt: skip
    arrays = (np.asarray(value, dtype=np.float64) for value in values)
    found = Motion._make((*arrays, np.asarray(STATUS[status], dtype=np.int8)))
    return with_whole_shares(found)


def _follow(contacts: Contacts) -> Follow:
    """Return the equation: every cell of the groups broadcast, one after another."""

    def motion(*, groups: Groups, most_periods: Array, watch: Watch | None = None) -> Motion:
        """Return the motion from rest by integration of order 8 between events, theory 13.1.

        For single points: a cell takes up to some seconds.
        """
        watch = watch or Watch()
        parts, shape = each(groups)
        rows = np.full((math.prod(shape), len(Motion._fields) - 1), np.nan)
        status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
        for cell, part in enumerate(parts):
            if watch.stopped():
                break
            watch.advance(1 / len(rows))
            if _slides_away(part, contacts):
                status[cell] = STATUS["runaway"]
                continue
            *rows[cell], status[cell] = reference_motion(
                part, contacts, most_periods=int(most_periods)
            )
        return motion_of(rows, status, shape)

    return motion


def _slides_away(part: Groups, contacts: Contacts) -> bool:
    """Return whether no friction of the floor could balance gravity (theory 13.8)."""
    held = part.friction_static * part.gravity_number_normal
    return not contacts.wall and abs(part.gravity_number_along) > held


REFERENCE = Method(
    name="reference",
    follow=_follow,
    source="theory 13.1",
    accuracy="about ten digits, where the motion repeats",
    seconds_a_cell=0.5,
    defaults={"most_periods": 100.0},
    checked_by=("events", "time-stepping"),
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
