"""The midpoint rule of Moreau and Jean in the plane (theory 13.1).

A step h of the phase takes position q and velocity u to q + h (u + v)/2 and

    v = u + h a(t + h/2) + i,

where the impulses i of the floor, if its gap is closed at q + h u/2, obey impact and friction.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import (
    SHARES,
    STATUS,
    Contacts,
    Groups,
    Method,
    Motion,
    each,
    motion_of,
)  # fmt: skip
from vibrafeed.core.scenes import Constraint
from vibrafeed.core.watch import Watch

STEPS = 400  # of a period
MAX_MULTIPLE = 4


class State(NamedTuple):
    """Position and velocity, along and normal, in the scales of `Motion`, and the mode."""

    x: float = 0.0
    z: float = 0.0
    u: float = 0.0
    w: float = 0.0
    mode: str = "stick"


def step(part: Groups, state: State, h: float, wave: float) -> State:
    """Return the state a step later; `wave` is the sine of the drive in the middle of the step."""
    x, z, u, w, _ = state
    new_u = u + h * (part.drive_number_along * wave - part.gravity_number_along)
    new_w = w + h * (part.drive_number_normal * wave - part.gravity_number_normal)
    mode, rebound = "flight", -part.restitution * min(w, 0.0)
    if rebound < w - new_w:  # a hop of less than two steps
        rebound = 0.0
    if z + h / 2 * w <= 0 and new_w < rebound:
        impulse, new_w = rebound - new_w, rebound
        friction = part.friction_static if u == 0 else part.friction_kinetic
        if abs(new_u) <= friction * impulse:
            new_u, mode = 0.0, "stick"
        else:
            new_u -= math.copysign(part.friction_kinetic * impulse, new_u)
            mode = "forward" if new_u > 0 else "backward"
    return State(x + h / 2 * (u + new_u), max(0.0, z + h / 2 * (w + new_w)), new_u, new_w, mode)


def follow(part: Groups, steps: int, max_periods: int) -> tuple[list[float], str]:
    """Return the fields of a part's `Motion` from rest, and the name of its status."""
    h = 2 * math.pi / steps
    waves = [math.sin((k + 0.5) * h) for k in range(steps)]
    drive = math.hypot(part.drive_number_along, part.drive_number_normal)
    change = h * (1 + part.friction_kinetic) * (1 + drive)  # of the velocity in a step, gravity 1
    states, multiple = [State()], 0
    for period in range(1, max_periods + 1):
        for wave in waves:
            states.append(step(part, states[-1], h, wave))
        for multiple in range(1, min(period, MAX_MULTIPLE + 1)):
            now, then = states[-1], states[-1 - multiple * steps]
            if math.dist(now[1:4], then[1:4]) <= 1e-6 * change:
                return _summed(states[-1 - multiple * steps :], steps, change, multiple)
    return _summed(states[-1 - (max_periods + 1) // 2 * steps :], steps, change, 0)


def _summed(
    states: list[State], steps: int, change: float, multiple: int
) -> tuple[list[float], str]:
    """Return the motion over whole periods and its status; `multiple` is 0 without repeat."""
    modes = [state.mode for state in states[1:]]
    changes = sum(one != other for one, other in pairwise([modes[-1], *modes]))
    landings = [-one.w for one, other in pairwise(states) if one.mode == "flight" != other.mode]
    travels = np.diff([state.x for state in states[::steps]]) / (2 * math.pi)
    spread = 0.0 if multiple else float(np.std(travels))
    row = [
        float(np.mean(travels)),
        spread,
        change * changes / len(travels) + spread,  # each event falls anywhere within its step
        *(modes.count(mode) / len(modes) for mode in SHARES),
        len(landings) / len(travels),
        max(landings, default=0.0),
        max(state.z for state in states),
        float(multiple),
        0.0,  # across: it moves in the plane
    ]
    if modes.count("stick") == len(modes):
        return row, "at_rest"
    return row, "periodic" if multiple else "aperiodic"


def motion(
    groups: Groups, contacts: Contacts, *, max_periods: Array, watch: Watch | None = None
) -> Motion:
    """Return the motion from rest by the midpoint rule, one cell after another."""
    del contacts
    watch = watch or Watch()
    parts, shape = each(groups)
    rows = np.full((math.prod(shape), len(Motion._fields) - 1), np.nan)
    status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
    for cell, part in enumerate(parts):
        if watch.stopped():
            break
        name = "runaway"  # no friction of the floor could balance gravity
        if abs(part.gravity_number_along) <= part.friction_static * part.gravity_number_normal:
            rows[cell], name = follow(part, STEPS, int(max_periods))
        status[cell] = STATUS[name]
        watch.advance(1 / len(rows))
    return motion_of(rows, status, shape)


MIDPOINT = Method(
    name="midpoint",
    follow=motion,
    source="theory 13.1",
    accuracy="of first order in the step",
    seconds_a_cell=5e-3,
    defaults={"max_periods": 50.0},
    checked_by=("events", "reference"),
    refuses=(
        Constraint(
            ("alpha",),
            lambda least, largest: least == largest == 0.0,
            "the method midpoint follows motion in one vertical plane, with alpha = 0",
            "Leave alpha out, or set method = 'events'",
            variant="midpoint",
        ),
    ),
    follows=lambda contacts: not contacts.wall,
)
