"""Closed-form sweeps: from a study to a plan, a grid, and a labelled dataset."""

from core.sweep.prepare import Sweep, further, prepare
from core.sweep.run import compute, label, sweep, tabulate

__all__ = [
    "Sweep",
    "compute",
    "further",
    "label",
    "prepare",
    "sweep",
    "tabulate",
]
