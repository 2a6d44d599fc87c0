"""Carrying out a sweep."""

from __future__ import annotations

from core.dataset.table import Table
from core.plan.pieces import Computed
from core.sweep.plain import DerivedSweep, Sweep
from core.sweep.reduced import ReducedSweep
from core.watch import Watch

AnySweep = Sweep | DerivedSweep | ReducedSweep


def compute(prepared: AnySweep, watch: Watch) -> Computed:
    """Return outputs and `regime` of a prepared sweep, SI units; or what it asks for besides."""
    return prepared.compute(watch)


def label(prepared: AnySweep, computed: Computed, watch: Watch) -> Table:
    """Return the arrays of a sweep, labelled; `watch` may stop verifying it."""
    return prepared.label(computed, watch)
