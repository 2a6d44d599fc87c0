"""Sweeps: of every cell, with the derivatives of its outputs, or of statistics in their place."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import Problem
from vibrafeed.core.lazy.reduced import Reduced
from vibrafeed.core.plan.derived import Asked, asked_of
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.price import Price
from vibrafeed.core.study.sweep_study import SweepStudy
from vibrafeed.core.sweep.cells import attributes_of, compute, label, verified_alone
from vibrafeed.core.watch import Watch


class Sweep(Prepared):
    """A sweep that can be carried out."""

    study: SweepStudy
    can_stop: ClassVar[bool] = False
    keeps_some: ClassVar[bool] = False

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading: None."""
        return None

    @property
    def is_single(self) -> bool:
        """True if values are stored in 32 bits."""
        return self.study.precision == "single"

    def width(self, name: str) -> int:
        """Return the bytes of a stored value."""
        return min(super().width(name), 4) if self.is_single else super().width(name)

    def in_files(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of an output in the units of files, in 32 bits if the study asks.

        `name` is the output, `values` are in SI units and radians. What is too large for 32 bits is
        infinite.
        """
        values = super().in_files(name, values)
        if not self.is_single or values.dtype != np.float64:
            return values
        with np.errstate(over="ignore"):  # what is too large for 32 bits is infinite
            return values.astype(np.float32)

    def compute(self, watch: Watch) -> Computed:
        """Return outputs and verdicts in SI units."""
        return compute(self, watch)

    def label(self, computed: Computed, watch: Watch) -> Table:
        """Return the labelled results; `watch` may stop verifying."""
        return label(self, computed, watch)


class DerivedSweep(Prepared):
    """A sweep with the derivatives of its outputs, computed and kept as a whole."""

    study: SweepStudy
    keeps_some: ClassVar[bool] = False

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading: derivatives need the whole grid."""
        message = "derivatives are computed as a whole, not where read"
        return Problem("sensitivities", message, "Leave it out")

    @cached_property
    def derived(self) -> Asked | None:
        """The derivatives in the result."""
        return asked_of(self.plan, self.study.values(), self.study.sensitivities, self.cells)

    def _new_price(self) -> Price:
        passes = 1 if self.derived is None else self.derived.passes
        return Price(0.0, passes * super()._new_price().cell)

    def compute(self, watch: Watch) -> Computed:
        """Return outputs and verdicts in SI units."""
        return compute(self, watch)

    def label(self, computed: Computed, watch: Watch) -> Table:
        """Return the labelled results; `watch` may stop verifying."""
        return label(self, computed, watch)


class ReducedSweep(Reduced):
    """A sweep whose result holds statistics over some axes in place of all cells."""

    study: SweepStudy

    @property
    def whole(self) -> Sweep:
        """The sweep of all cells."""
        return Sweep(self.study, self.plan, self.grid)

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result that are known before computing."""
        return attributes_of(self)

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the verification of random cells as attributes; the cells are computed alone."""
        return verified_alone(self, watch)
