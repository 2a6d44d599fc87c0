"""Closed-form sweeps: from a study to a plan, a grid, and a labelled dataset."""

from core.sweep.grid import Grid
from core.sweep.plan import Plan, make_plan
from core.sweep.prepare import Sweep, prepare, prepare_content
from core.sweep.run import compute, label, sweep, tabulate

__all__ = [
    "Grid",
    "Plan",
    "Sweep",
    "compute",
    "label",
    "make_plan",
    "prepare",
    "prepare_content",
    "sweep",
    "tabulate",
]
