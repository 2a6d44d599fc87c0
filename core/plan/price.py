"""The time that evaluating a plan takes on this machine, estimated before it is done.

The steps of a compiled loop are counted, and what a step takes is measured: once a process, by some
sums of numpy that last a millisecond, beside what they took on the machine on which the rates below
were found. What goes by numpy has the price of its scene.
"""

from __future__ import annotations

import time
from functools import cache

import numpy as np

from vibrafeed.core.plan.evaluate import COMPILE_SECONDS
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loops.fused import Values, groups_of
from vibrafeed.core.plan.loops.program import edge_of, program_of
from vibrafeed.core.plan.loops.trace import traced
from vibrafeed.core.plan.plan import Plan

STEP_SECONDS, BYTE_SECONDS, CALL_SECONDS = 2.0e-11, 7e-11, 2.8e-9
"""Seconds of an addition in a loop, of a byte written, and of a function that numpy computes
between loops, on the reference machine."""
SUM_SECONDS = 2.0e-10
"""Seconds of an addition in the sums by which `pace` measures a machine, on the reference."""
VALUES = 3  # values of each axis that are looked at, to find what is the same all over a grid


def evaluation_seconds(plan: Plan, grid: Grid) -> float:
    """Return the time to evaluate a plan on one core, within a factor of 2 [s].

    It is the less of numpy's and that of a compiled loop with its compiling; the grid may be of any
    size.
    """
    plain = grid.cells * plan.scene.seconds_a_cell * pace()
    graph = traced(plan, grid.axes) if plain > COMPILE_SECONDS else None
    if graph is None:
        return plain
    few = grid.within({name: (0, min(VALUES, size)) for name, size in grid.shape.items()})
    seconds = 0.0
    with np.errstate(all="ignore"):
        values = Values(graph, plan, few)
        for dims, names in groups_of(plan, grid).items():
            shape = tuple((name, grid.shape[name]) for name in dims)
            special = values.special(edge_of(graph, names, shape))
            program = program_of(graph, names, shape, special)
            cells = grid.size(dims)
            width = sum(1 if name in plan.verdict_names else 8 for name in names)
            each = width * BYTE_SECONDS + program.calls * CALL_SECONDS
            seconds += program.work * STEP_SECONDS + cells * each
    return min(plain, COMPILE_SECONDS + seconds * pace())


@cache
def pace() -> float:
    """Return the time of an addition on this machine over that on the reference machine [1].

    Above 1 this machine is slower. The best of 40 trials, at most 20 and at least 0.2.
    """
    first, second = np.linspace(1.0, 2.0, 4096), np.linspace(2.0, 3.0, 4096)
    best = np.inf
    for _ in range(40):
        started = time.perf_counter()
        for _ in range(8):
            np.add(first, second, out=second)
        best = min(best, time.perf_counter() - started)
    return float(np.clip(best / (8 * first.size) / SUM_SECONDS, 0.2, 20.0))


def in_words(seconds: float) -> str:
    """Return a time [s] in words with two digits, as users see it: ``3.2 minutes``."""
    for unit, length in (("days", 86_400), ("hours", 3600), ("minutes", 60)):
        if seconds >= 2 * length:
            return f"{float(f'{seconds / length:.2g}'):,g} {unit}"
    return f"{float(f'{seconds:.2g}'):g} s"
