"""The catalogue of hard cases: each a study as a user would write it, and what is right for it."""

from __future__ import annotations

from collections.abc import Callable

from vibrafeed.core.assurance.case import Case
from vibrafeed.core.assurance.hard_cases.borders import painleve, regime_borders
from vibrafeed.core.assurance.hard_cases.drives import (
    angles,
    slow_and_fast_drives,
    subnormal_amplitudes,
)
from vibrafeed.core.assurance.hard_cases.friction import (
    little_and_much_friction,
    met_thresholds,
)
from vibrafeed.core.assurance.hard_cases.rebounds import chatter, full_rebound, stiff_floor
from vibrafeed.core.assurance.hard_cases.scales import grids, masses_and_sizes
from vibrafeed.core.assurance.hard_cases.transport import (
    large_and_small_bowls,
    long_and_short_ways,
    start_within_ulps,
)

FAMILIES: tuple[Callable[[], list[Case]], ...] = (
    little_and_much_friction,
    large_and_small_bowls,
    start_within_ulps,
    long_and_short_ways,
    regime_borders,
    painleve,
    full_rebound,
    chatter,
    slow_and_fast_drives,
    subnormal_amplitudes,
    angles,
    met_thresholds,
    stiff_floor,
    masses_and_sizes,
    grids,
)
"""What gives the cases of each family, in the order of the report."""

HARD_CASES: tuple[Case, ...] = tuple(case for family in FAMILIES for case in family())
"""Every hard case; names are unique."""

__all__ = ["FAMILIES", "HARD_CASES"]
