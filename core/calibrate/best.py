"""The last digits of the best values: least squares by scipy from the best point of a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from vibrafeed.core.calibrate.model import Model
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.differences import jacobian
from vibrafeed.core.watch import Watch

STEP = 1e-5  # step of differences, as a share of the distance of the bounds
MAX_STEPS = 40  # evaluations of the residuals, beside those of their derivatives
FAR = 1e3  # residual over error where a motion has no speed


@dataclass(frozen=True)
class LeastSquares:
    """The sum of squares of the runs' residuals over their errors, and of the priors' deviations.

    Attributes
    ----------
    model : Model
        The motions.
    size : float
        The discrepancy, a standard deviation in the unit of what was measured.
    watch : Watch
        May stop it.
    """

    model: Model
    size: float
    watch: Watch

    def polished(self, start: Array) -> Array:
        """Return the best point near `start`, refined by least squares; `start` if none is better.

        Points are values of the unknowns, shape (unknowns,), in the units of studies. The sum of
        squares is that of the residuals of the measured runs over their standard deviations, and of
        the distances from the prior means. Without measured runs `start` is returned.

        Raises
        ------
        StoppedError
            If the watch stops the simulation.
        """
        model = self.model
        if not model.runs.measured.any():
            return start
        margin = 1e-9
        share = np.clip((start - model.lower) / model.width, margin, 1.0 - margin)
        before = self._residuals(share[np.newaxis])[0]
        optimum = scipy.optimize.least_squares(
            lambda x: self._residuals(x[np.newaxis])[0],
            share,
            jac=lambda share: jacobian(self._residuals, share, STEP).T,
            bounds=(0.0, 1.0),
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=MAX_STEPS,
        )
        if not 2.0 * optimum.cost < before @ before:
            return start
        return model.lower + optimum.x * model.width

    def _residuals(self, shares: Array) -> Array:
        """Return the scaled residuals of which the least squares are sought.

        The first columns are (predicted - measured)/(standard deviation of both and of the
        discrepancy), the last ones (unknown - prior mean)/prior standard deviation. A motion
        without a speed counts as a large residual (`FAR`).

        Parameters
        ----------
        shares : ndarray, shape (points, unknowns)
            Points to evaluate: each unknown as (value - lower)/(upper - lower) of its bounds.

        Returns
        -------
        ndarray, shape (points, measured runs + unknowns)
        """
        model, where = self.model, self.model.runs.measured
        points = model.lower + shares * model.width
        found = model.predict(points, Watch(stop=self.watch.stop, deadline=self.watch.deadline))
        residual = found.value[:, where] - model.runs.value[where]
        variance = (
            found.variance[:, where] + np.square(model.runs.error[where]) + np.square(self.size)
        )
        variance = np.where(variance > 0, variance, 1.0)
        over = np.nan_to_num(residual / np.sqrt(variance), nan=FAR)
        before = [one.deviations_from_mean(points[:, k]) for k, one in enumerate(model.unknowns)]
        return np.concatenate([over, np.stack(before, axis=1)], axis=1)
