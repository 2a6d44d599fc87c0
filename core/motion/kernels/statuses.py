"""Statuses and modes as whole numbers, for compiled code, which cannot read a dict of flags."""

from __future__ import annotations

from core.quantities.flags import MOTION_MODES, MOTION_STATUSES

PERIODIC = MOTION_STATUSES["periodic"].value
AT_REST = MOTION_STATUSES["at_rest"].value
APERIODIC = MOTION_STATUSES["aperiodic"].value
RUNAWAY = MOTION_STATUSES["runaway"].value
NEUTRAL = MOTION_STATUSES["neutral"].value
LIMIT_REACHED = MOTION_STATUSES["limit_reached"].value
NO_SOLUTION = MOTION_STATUSES["no_solution"].value
SETTLED = MOTION_STATUSES["settled"].value
MOVING = MOTION_STATUSES["moving"].value

STICK = MOTION_MODES["stick"].value
FORWARD = MOTION_MODES["forward"].value
BACKWARD = MOTION_MODES["backward"].value
FLYING = MOTION_MODES["flight"].value
UNKNOWN = MOTION_MODES["unknown"].value
