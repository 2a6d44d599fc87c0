"""Closed-form sweeps: from a study to a plan, a grid, and a labelled dataset."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "KIND",
    "ReducedSweep",
    "Sweep",
]

if TYPE_CHECKING:
    from vibrafeed.core.sweep.kind import KIND, ReducedSweep, Sweep
else:
    __getattr__ = lazily(__name__, {"kind": ("KIND", "ReducedSweep", "Sweep")})
