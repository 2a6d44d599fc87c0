"""Statuses and modes as whole numbers, for compiled code, which cannot read a dict of flags."""

from __future__ import annotations

from collections import namedtuple

from vibrafeed.core.quantities.flags import MOTION_MODES, MOTION_STATUSES

Status = namedtuple(
    "Status",
    "not_computed periodic at_rest aperiodic runaway neutral limit_reached no_solution "
    "settled moving sensitive",
)
"""The values of the statuses that a kernel may give."""

Mode = namedtuple("Mode", "stick forward backward flight unknown")
"""The values of the modes."""

STATUS = Status(**{name: MOTION_STATUSES[name].value for name in Status._fields})
MODE = Mode(**{name: MOTION_MODES[name].value for name in Mode._fields})
MODES = 4  # modes in which time is spent: all but the unknown
