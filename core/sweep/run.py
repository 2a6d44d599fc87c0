"""Carrying out a sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.dataset.table import Table
from core.plan.pieces import Computed, carry_out
from core.sweep.plain import DerivedSweep, Sweep
from core.sweep.prepare import prepare
from core.sweep.reduced import ReducedSweep
from core.watch import Watch

if TYPE_CHECKING:
    import xarray

    from core.study import SweepStudy

AnySweep = Sweep | DerivedSweep | ReducedSweep


def sweep(study: SweepStudy) -> xarray.Dataset:
    """Return the dataset of a sweep study.

    Examples
    --------
    >>> from pathlib import Path
    >>> from core.intake import load_study
    >>> from core.sweep import sweep
    >>> dataset = sweep(load_study(Path("configs/figures/fig-5-1.toml")))
    """
    prepared = prepare(study)
    return tabulate(prepared).to_xarray()


def tabulate(prepared: AnySweep, *, watch: Watch | None = None) -> Table:
    """Return the labelled outputs of a prepared sweep."""
    return carry_out(prepared, compute, label, watch)


def compute(prepared: AnySweep, watch: Watch) -> Computed:
    """Return outputs and `regime` of a prepared sweep, SI units; or what it asks for besides."""
    return prepared.compute(watch)


def label(prepared: AnySweep, computed: Computed, watch: Watch) -> Table:
    """Return what was computed of a sweep, labelled; `watch` may stop verifying it."""
    return prepared.label(computed, watch)
