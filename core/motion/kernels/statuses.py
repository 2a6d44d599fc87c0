"""Statuses and modes as whole numbers, for compiled code, which cannot read a dict of flags."""

from __future__ import annotations

from typing import NamedTuple

from core.quantities.flags import MOTION_MODES, MOTION_STATUSES


class Status(NamedTuple):
    """The values of the statuses that a kernel may give."""

    not_computed: int
    periodic: int
    at_rest: int
    aperiodic: int
    runaway: int
    neutral: int
    limit_reached: int
    no_solution: int
    settled: int
    moving: int
    sensitive: int


class Mode(NamedTuple):
    """The values of the modes."""

    stick: int
    forward: int
    backward: int
    flight: int
    unknown: int


STATUS = Status(**{name: MOTION_STATUSES[name].value for name in Status._fields})
MODE = Mode(**{name: MOTION_MODES[name].value for name in Mode._fields})
MODES = 4  # in which time is spent: all but the unknown
