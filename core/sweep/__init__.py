"""Closed-form sweeps: from a study to a plan, a grid, and a labelled dataset."""

from core.sweep.prepare import (
    DerivedSweep,
    ReducedSweep,
    Sweep,
    as_a_whole,
    further,
    no_cells,
    prepare,
)
from core.sweep.run import compute, label, sweep, tabulate

__all__ = [
    "DerivedSweep",
    "ReducedSweep",
    "Sweep",
    "as_a_whole",
    "compute",
    "further",
    "label",
    "no_cells",
    "prepare",
    "sweep",
    "tabulate",
]
