"""A sweep of which answers are told in place of its cells."""

from __future__ import annotations

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.sample import Sample
from vibrafeed.core.plan.tiles import Tiled
from vibrafeed.core.reduce.reduced import Reduced
from vibrafeed.core.study.sweep_study import SweepStudy
from vibrafeed.core.sweep.cells import attributes_of
from vibrafeed.core.sweep.plain import Sweep
from vibrafeed.core.sweep.verify import verified
from vibrafeed.core.watch import Watch


class ReducedSweep(Reduced):
    """A sweep whose result holds statistics over some axes in place of all cells."""

    study: SweepStudy

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result that are known before computing."""
        return attributes_of(self)

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the result of verifying some cells as attributes; they are computed one by one.

        The result of a reduced sweep does not have its cells. `watch` may stop it.
        """
        whole = Sweep(self.study, self.plan, self.grid)
        tiled = Tiled(whole)

        def values_at(sample: Sample) -> dict[str, Array]:
            """Return the outputs at sampled cells."""
            return tiled.at(sample.positions, sample.count)

        return {**verified(whole, values_at, watch)}
