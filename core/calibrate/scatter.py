"""The likelihood of observations at points of the unknowns, and the unexplained scatter.

Speeds lie about those of the motions with variances that add: of the measurement, of a motion that
does not repeat, and of a discrepancy that is common to all runs. The last is an unknown number,
over which likelihoods are summed:

- Where errors are known it is 0 in nine of ten calibrations, before anything is measured, and in
  the others spread as half a Cauchy distribution about 0, as wide as the errors.
- Where none is known it is all the scatter there is, and each size of it is as likely as its
  double.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibrafeed.core.calibrate.model import Model, Predicted
from vibrafeed.core.mechanics.arrays import Array

NONE_BEFORE = 0.9
"""Prior probability that the errors explain all scatter."""
KNOWN_SIZES, UNKNOWN_SIZES = 18, 28
"""Number of sizes of the discrepancy that are tried, with known errors and without."""
FINER = 24  # number of sizes, once it is known which are likely
HARDLY = 1e-5  # of the largest probability of a size: less likely ones are left out
REACH = 3.0  # standard deviations about the centre of a box within which all its values lie
HOPELESS = 1e60  # a residual where a motion has no speed


@dataclass(frozen=True)
class Scatter:
    """Sizes that the discrepancy may have: the scatter of speeds that no unknown explains.

    Attributes
    ----------
    sizes : ndarray, shape (sizes,)
        Standard deviations, in the unit of what was measured.
    log_before : ndarray, shape (sizes,)
        Logarithms of their prior probabilities.
    """

    sizes: Array
    log_before: Array

    @classmethod
    def of(cls, model: Model, *, wanted: bool) -> Scatter:
        """Return the sizes that the discrepancy may have, and logs of their prior probabilities.

        The discrepancy is the scatter of the measured values beyond errors and unknowns; its sizes
        are standard deviations in the unit of the output. There is only size 0 if no value is
        measured, or if errors are known and a discrepancy is not `wanted`. `model` has the measured
        runs.
        """
        runs = model.runs
        if not runs.measured.any() or (runs.errors_known and not wanted):
            return cls(np.zeros(1), np.zeros(1))
        if not runs.errors_known:
            values = runs.value[runs.measured]
            size = max(float(np.sqrt(np.mean(np.square(values)))), 1e-12)
            sizes = size * np.logspace(-4.0, 0.5, UNKNOWN_SIZES)
            return cls(sizes, np.full(sizes.size, -np.log(sizes.size)))
        typical = float(np.median(runs.error[runs.measured]))
        shares = np.logspace(-1.5, 2.5, KNOWN_SIZES)
        # A size has the mass from halfway to its neighbours; the ends have all that lies beyond.
        below = np.arctan(np.sqrt(shares[1:] * shares[:-1])) * 2.0 / np.pi
        before = (1.0 - NONE_BEFORE) * np.diff(below, prepend=0.0, append=1.0)
        sizes = typical * shares
        return cls(np.concatenate([[0.0], sizes]), np.log(np.concatenate([[NONE_BEFORE], before])))

    def finer(self, likely: Array) -> Scatter:
        """Return sizes of the discrepancy that lie closer together where they are likely.

        `likely` are the probabilities of the present sizes given the runs, shape (sizes,). Size 0
        stays among them if it is one now; prior probabilities are interpolated.
        """
        sizes, before = self.sizes[self.sizes > 0], self.log_before[self.sizes > 0]
        likely = likely[self.sizes > 0]
        if not sizes.size or not likely.sum() > 0:
            return self
        held = np.flatnonzero(likely > HARDLY * likely.max())
        first, last = max(held[0] - 1, 0), min(held[-1] + 1, sizes.size - 1)
        logs = np.log(sizes)
        fine = np.linspace(logs[first], logs[last], FINER)
        step = np.log((fine[1] - fine[0]) / (logs[1] - logs[0]))
        scatter = Scatter(np.exp(fine), np.interp(fine, logs, before) + step)
        if sizes.size == self.sizes.size:
            return scatter
        return Scatter(
            np.concatenate([self.sizes[:1], scatter.sizes]),
            np.concatenate([self.log_before[:1], scatter.log_before]),
        )


@dataclass(frozen=True)
class Likelihood:
    """The likelihood of the observations of a calibration.

    Attributes
    ----------
    model : Model
        The motions.
    scatter : Scatter
        The sizes that the discrepancy may have.
    outlier_probability : float
        Probability that an observed behaviour is wrong.
    """

    model: Model
    scatter: Scatter
    outlier_probability: float

    def log(
        self,
        value: Array,
        variance: Array,
        shown: Array,
        points: Array,
        within: Array | float = 0.0,
    ) -> Array:
        """Return log(likelihood times prior) of points, for each assumed size of the discrepancy.

        The discrepancy is the scatter of measurements beyond their errors; its sizes and their
        prior are in `self.scatter`. A run with a behaviour that was seen ("hops") counts by its
        probability.
        """
        runs = self.model.runs
        where = runs.measured
        residual = value[:, where] - runs.value[where]
        square = np.square(np.where(np.isnan(residual), HOPELESS, residual))
        known = variance[:, where] + np.square(runs.error[where])
        around = np.broadcast_to(within, value.shape)[:, where]
        nearest = np.square(np.maximum(0.0, np.sqrt(square) - REACH * np.sqrt(around)))
        log = np.empty((len(points), self.scatter.sizes.size))
        for k, size in enumerate(self.scatter.sizes):
            own = known + size**2
            whole = own + around
            # A wide box would explain too much by its variance alone: it explains a run no better
            # than a point would at which its value comes nearest to the measured one.
            spent = square / whole + np.log(whole)
            log[:, k] = -0.5 * np.maximum(spent, nearest / own + np.log(own)).sum(axis=1)
        seen = np.log(
            self.outlier_probability + (1.0 - 2.0 * self.outlier_probability) * shown
        ).sum(axis=1)
        log += (seen + self.model.log_prior(points))[:, np.newaxis] + self.scatter.log_before
        return np.asarray(log)

    def shown(self, predicted: Predicted) -> Array:
        """Return 1 where a part shows the regime that was observed in a run, else 0.

        `predicted` are the motions at points of the unknowns. The result is an array of floats of
        shape (points, runs with an observed regime).
        """
        columns = [
            predicted.shows(word)[:, k] for k, word in enumerate(self.model.runs.seen) if word
        ]
        if not columns:
            return np.zeros((len(predicted.value), 0))
        return np.asarray(np.stack(columns, axis=1), dtype=np.float64)


def log_sum(log: Array) -> Array:
    """Return log(sum exp(log)) over the last axis, without overflow of the exponential.

    `log` holds logarithms of probabilities, minus infinity for 0; the result has its shape without
    the last axis. It sums probabilities that are too small to be represented.
    """
    top = log.max(axis=-1, keepdims=True)
    top = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total: Array = np.log(np.exp(log - top).sum(axis=-1)) + top[..., 0]
    return total
