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
        return np.array([tolerance(name, one) for name, one in self.distributions.items()]).T

    @cached_property
    def middle(self) -> Array:
        """The nominal values, shape (parameters,), in the units of studies."""
        return np.array([nominal(one) for one in self.distributions.values()])

    @cached_property
    def _steps(self) -> Array:
        return NEAR * (self.ends[1] - self.ends[0]) / 2

    @cached_property
    def _points(self) -> Array:
        count = len(self.middle)
        unit = np.eye(count)
        lower, upper, middle = self.ends[0], self.ends[1], self.middle
        # At an end of its tolerance a parameter steps inwards: differences stay within the box.
        centre = np.clip(middle, lower + self._steps, upper - self._steps)
        rows = [middle[None], middle + unit * (lower - middle), middle + unit * (upper - middle)]
        base = middle + unit * (centre - middle)
        rows += [base, *(base + unit * (step * self._steps) for step in (-1.0, -0.5, 0.5, 1.0))]
        inside = points(count, INSIDE, self.seed)[:, 0].T
        if count <= MAX_CORNERS:
            corners = np.array(list(product((0.0, 1.0), repeat=count)))
        else:
            corners = np.round(points(count, 1 << MAX_CORNERS, self.seed + 1)[:, 0].T)
        rows.append(lower + (upper - lower) * np.concatenate([corners, inside]))
        return np.ascontiguousarray(np.concatenate(rows).T)

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
        parts = values[1 : 1 + 7 * count].reshape(7, count, -1)
        at_lower, at_upper, base, far_below, below, above, far_above = parts
        steps = self._steps[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            quotients = slopes_of(np.stack([far_below, below, above, far_above, base]), steps)
            half = (self.ends[1] - self.ends[0])[:, None] / 2
            whole = np.maximum(np.abs(at_lower - values[0]), np.abs(at_upper - values[0])) / half
            near, far = np.abs(quotients.near), np.abs(quotients.apart)
            bends = (near <= SMOOTH * far) & (far <= BENT * whole)
            slope = np.where(bends | (near <= EVEN * quotients.largest), quotients.slope, np.nan)
            spread = np.array([deviation(name, one) for name, one in self.distributions.items()])
            variance = (slope * spread[:, None]) ** 2
            share = variance / variance.sum(axis=0)
        seen = np.where(np.isfinite(values), values, np.nan)
        lost = np.isnan(seen).all(axis=0)
        seen = np.where(lost, 0.0, seen)
        least, most = np.nanmin(seen, axis=0), np.nanmax(seen, axis=0)
        return BudgetValues(
            values[0], at_lower, at_upper, slope * half, share,
            np.where(lost, np.nan, least), np.where(lost, np.nan, most),
        )  # fmt: skip
