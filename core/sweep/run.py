"""Carrying out a sweep."""

from __future__ import annotations

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.sweep.plain import DerivedSweep, Sweep
from vibrafeed.core.sweep.reduced import ReducedSweep
from vibrafeed.core.watch import Watch

AnySweep = Sweep | DerivedSweep | ReducedSweep


def compute(prepared: AnySweep, watch: Watch) -> Computed:
    """Return outputs and verdicts of a sweep in SI units, or its reduction."""
    return prepared.compute(watch)


def label(prepared: AnySweep, computed: Computed, watch: Watch) -> Table:
    """Return the labelled results of a sweep; `watch` may stop verifying."""
    return prepared.label(computed, watch)
