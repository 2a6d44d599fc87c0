"""Tolerance budgets: what the tolerance of each parameter does to an output.

The ends: each parameter at either end of its tolerance, the others at their nominal values. The
linear budget: the derivative of the output times the tolerance, and the shares of the variance that
follow; both hold for small tolerances. The worst case: the least and the largest value over the
whole box, of its corners and of points inside.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.differences import slopes_of
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.statistics import points
from vibrafeed.core.study.distributions import Distribution, deviation, nominal, tolerance

NEAR = 0.01
"""Step of the differences to either side, as a share of half the tolerance; a second one is half
that."""
MAX_CORNERS = 10
"""Most parameters for which all corners of the box are evaluated, 1,024 of them."""
INSIDE = 256
"""Number of points inside the box that are evaluated."""
SMOOTH = 0.7
"""Share of the difference of both slopes that is left at half the step: a half at a smooth point,
all of it at a kink, twice as much at a jump."""
EVEN = 1e-6
"""Difference of the slopes on both sides, as a share of the larger slope, that counts as none."""
BENT = 0.1
"""Difference of both slopes, over the steepness of the whole tolerance, that no bend explains."""


@dataclass(frozen=True)
class BudgetValues:
    """The budget of an output; arrays of shape (cells,), or (parameters, cells).

    Attributes
    ----------
    nominal : ndarray
        Its value where all parameters are at their nominal values.
    at_lower, at_upper : ndarray
        Its values where one parameter is at an end of its tolerance.
    linear : ndarray
        The derivative times half the tolerance; NaN at a kink or a jump.
    variance_share : ndarray
        The share of a parameter in the variance of the linear budget.
    least, largest : ndarray
        The worst cases seen.
    """

    nominal: Array
    at_lower: Array
    at_upper: Array
    linear: Array
    variance_share: Array
    least: Array
    largest: Array


@dataclass(frozen=True)
class Budget:
    """The points from which a tolerance budget is computed.

    Attributes
    ----------
    distributions : mapping of str to Distribution
        Distributions of the uncertain parameters.
    seed : int
        Seed of the points inside the box.
    """

    distributions: Mapping[str, Distribution]
    seed: int = 0

    @cached_property
    def ends(self) -> Array:
        """The ends of the tolerances, shape (2, parameters), in the units of studies."""
        return np.array(
            [tolerance(name, distribution) for name, distribution in self.distributions.items()]
        ).T

    @cached_property
    def middle(self) -> Array:
        """The nominal values, shape (parameters,), in the units of studies."""
        return np.array([nominal(distribution) for distribution in self.distributions.values()])

    @cached_property
    def _steps(self) -> Array:
        return NEAR * (self.ends[1] - self.ends[0]) / 2

    @cached_property
    def _points(self) -> Array:
        count = len(self.middle)
        unit_vectors = np.eye(count)
        lower, upper, middle = self.ends[0], self.ends[1], self.middle
        # Rows are points of the parameters; one parameter at a time leaves its nominal value, and
        # near an end of its tolerance its differences are taken further inside.
        centre = np.clip(middle, lower + self._steps, upper - self._steps)
        blocks = [
            middle[None],
            middle + unit_vectors * (lower - middle),
            middle + unit_vectors * (upper - middle),
        ]
        inner_centres = middle + unit_vectors * (centre - middle)
        blocks += [
            inner_centres,
            *(
                inner_centres + unit_vectors * (step * self._steps)
                for step in (-1.0, -0.5, 0.5, 1.0)
            ),
        ]
        inside = points(count, INSIDE, self.seed)[:, 0].T
        if count <= MAX_CORNERS:
            corners = np.array(list(product((0.0, 1.0), repeat=count)))
        else:
            corners = np.round(points(count, 1 << MAX_CORNERS, self.seed + 1)[:, 0].T)
        blocks.append(lower + (upper - lower) * np.concatenate([corners, inside]))
        return np.ascontiguousarray(np.concatenate(blocks).T)

    @property
    def size(self) -> int:
        """The number of points."""
        return int(self._points.shape[1])

    def values(self) -> dict[str, Array]:
        """Return the parameters at every point of a tolerance budget, SI units, (points,) each.

        They are by name of the parameter; outputs are computed there.
        """
        return {
            name: parameter_to_si(name, values)
            for name, values in zip(self.distributions, self._points, strict=True)
        }

    def budget_of(self, values: Array) -> BudgetValues:
        """Return the tolerance budget of an output from its values at the points of the budget.

        `values` has the shape (cells, points), in the order of the method `values`. The budget has
        the output at both ends of each tolerance, linear changes and shares of the variance, shape
        (parameters, cells), and nominal, least and largest values, shape (cells,). A linear change
        is the derivative times half the tolerance, NaN where differences at two steps tell of a
        kink or a jump.
        """
        count = len(self.middle)
        values = values.T
        by_kind = values[1 : 1 + 7 * count].reshape(7, count, -1)
        at_lower, at_upper, centre, far_below, below, above, far_above = by_kind
        steps = self._steps[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            quotients = slopes_of(np.stack([far_below, below, above, far_above, centre]), steps)
            half_widths = (self.ends[1] - self.ends[0])[:, None] / 2
            end_slopes = (
                np.maximum(np.abs(at_lower - values[0]), np.abs(at_upper - values[0])) / half_widths
            )
            half_step_jump, step_jump = np.abs(quotients.near), np.abs(quotients.apart)
            # The jump of slopes halves with the step where the output is smooth.
            is_smooth = (half_step_jump <= SMOOTH * step_jump) & (step_jump <= BENT * end_slopes)
            slope = np.where(
                is_smooth | (half_step_jump <= EVEN * quotients.largest), quotients.slope, np.nan
            )
            deviations = np.array(
                [deviation(name, distribution) for name, distribution in self.distributions.items()]
            )
            variance = (slope * deviations[:, None]) ** 2
            variance_shares = variance / variance.sum(axis=0)
        finite_values = np.where(np.isfinite(values), values, np.nan)
        without_value = np.isnan(finite_values).all(axis=0)
        finite_values = np.where(without_value, 0.0, finite_values)
        smallest, largest = np.nanmin(finite_values, axis=0), np.nanmax(finite_values, axis=0)
        return BudgetValues(
            values[0], at_lower, at_upper, slope * half_widths, variance_shares,
            np.where(without_value, np.nan, smallest), np.where(without_value, np.nan, largest),
        )  # fmt: skip
