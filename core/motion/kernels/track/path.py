"""The course of one part."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, raised
from core.motion.kernels.arrays import Floats, Stop
from core.motion.kernels.cells import cell_of
from core.motion.kernels.statuses import MODE, STATUS
from core.motion.kernels.track import drive
from core.motion.kernels.track.advance import advance
from core.motion.kernels.track.cycle import new_history, settle
from core.motion.kernels.track.solve import FINE
from core.motion.kernels.track.tables import STATE, TALLY, TURN, at_rest, new_work

SAMPLE = 7
"""Columns of a sample: place (3), velocity (3), mode."""


@compiled
def follow(wall: bool, rolling: float, group: Floats, phases: Floats, stop: Stop) -> Floats:
    """Return place, velocity and mode at ascending phases from the start of a cycle.

    Of a motion that does not repeat, from the end of the periods that it is followed for.
    """
    cell = cell_of(group)
    samples = np.full((phases.size, SAMPLE), math.nan)
    samples[:, SAMPLE - 1] = MODE.unknown
    most = int(cell.most_periods)
    history, work = new_history(most, stop), new_work()
    drive.set_drive(cell, group, work)
    state, hold = at_rest()
    found = settle(cell, wall, rolling, FINE, most, state, hold, history, work)
    if found.status == STATUS.limit_reached:
        return samples
    if found.multiple > 0:
        first = found.done - found.multiple
        state, hold = history.starts[first].copy(), history.holds[first].copy()
    state[STATE.x] = 0.0
    tally, given, turns = np.zeros(len(TALLY)), 0, 0
    while given < phases.size and not raised(stop):
        before = turns * TURN
        end = given
        while end < phases.size and phases[end] < before + TURN:
            end += 1
        fine = advance(
            cell, wall, rolling, FINE.order, FINE.tolerance * drive.size(work), state, hold,
            tally, work, phases[given:end] - before, samples[given:end], tally[:0],
        )  # fmt: skip
        if not fine:
            return samples
        given, turns = end, turns + 1
    return samples
