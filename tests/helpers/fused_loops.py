"""A plan computed both ways: by compiled loops and by numpy."""

from typing import Any

import numpy as np

from vibrafeed.core.plan.evaluate import Fused, empty_results, evaluate_in_blocks
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.trace import traced


def check_same_bits(plan: Plan, grid: Grid, threads: int | None = None) -> Any:
    """Compare both ways; return what the loops gave."""
    expected, got = empty_results(plan, grid), empty_results(plan, grid)
    with np.errstate(all="ignore"):
        evaluate_in_blocks(plan, grid, expected)
    Fused(plan, traced(plan, grid.along), grid).run(got, threads)
    for name, values in expected.items():
        # Of two zeros of different sign numpy itself takes either, by the width of its registers.
        np.testing.assert_array_equal(got[name], values, err_msg=name)
    return got
