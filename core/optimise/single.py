"""One design in the terms of scipy's optimisers: a unit box, numbers of order 1, slopes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.problem import OptimisationProblem, columns
from vibrafeed.core.optimise.reliable import most_reliable
from vibrafeed.core.plan.differences import jacobian
from vibrafeed.core.watch import Watch

STEP = 1e-6  # of a variable's range, for central differences: 1e-10 of the slope is left
NO_VALUE = 1e6  # stands for a missing value where an optimiser needs a number
MAX_SHARE = 0.98  # progress of a design before its end: the number of evaluations is a guess
PENALTY = 100.0  # factor of a violation, for optimisers without constraints


class Single:
    """One design; points are shares of the bounds, outputs are over their scales.

    Points have the shape (variables,) or (variables, n).

    Parameters
    ----------
    problem : OptimisationProblem
        The problem.
    design, scales : mapping of str to ndarray
        Fixed parameters and scales of the outputs, shape (1,).
    watch : Watch, optional
        Takes the progress, and may stop the search.
    about : int
        Approximate number of evaluations of the design, for the progress.
    """

    def __init__(
        self,
        problem: OptimisationProblem,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
        watch: Watch | None = None,
        about: int = 1,
    ):
        """Take one design of a problem; `about` evaluations are expected."""
        self.problem = problem
        self.watch = watch and replace(watch, progress=None)  # evaluations are the progress
        self._progress, self._about, self._reported = watch or Watch(), about, 0.0
        self.design, self.scales = columns(design), columns(scales)
        self.size = float(problem.scale(scales)[0])
        self.evaluations = 0
        self._at: bytes | None = None
        self._rows = np.empty((0, 0))

    def _count(self, points: int) -> None:
        """Count evaluations, and report progress by those before."""
        self._tell(min(self.evaluations / self._about, MAX_SHARE))
        self.evaluations += points

    def end(self) -> None:
        """Report that the design is finished."""
        self._tell(1.0)

    def _tell(self, share: float) -> None:
        """Report progress up to a share."""
        if share > self._reported:
            self._progress.advance(share - self._reported)
            self._reported = share

    @property
    def variables(self) -> int:
        """The number of variables."""
        return len(self.problem.names)

    def points_in_box(self, unit: Array) -> Array:
        """Return points of the unit box in SI units, shape (variables, n); both ends are exact."""
        lower, upper = self.problem.lower[:, None], self.problem.upper[:, None]
        unit = np.reshape(unit, (self.variables, -1))
        return np.where(unit == 1, upper, lower + unit * (upper - lower))

    def judged(self, unit: Array) -> tuple[Array, Array]:
        """Return objective and violation of points, each over its scale, shape (n,)."""
        return self.judged_with_error(unit)[:2]

    def judged_with_error(self, unit: Array) -> tuple[Array, Array, Array]:
        """Return objective, violation of constraints, and error of the objective, shape (n,).

        Each is divided by the size of the output. `unit` are points as shares of the bounds, shape
        (variables, n). The standard error is that of motions which do not repeat, else 0.
        """
        x = self.points_in_box(unit)
        self._count(x.shape[1])
        value, beyond, chance_error = self.problem.judged_with_error(
            x[:, None, :], self.design, self.scales, self.watch
        )
        return value[0] / self.size, beyond[0], chance_error[0] / self.size

    def most_reliable(self, unit: Array, value: Array, beyond: Array, chance_error: Array) -> int:
        """Return the index of the best of evaluated points of a motion, after longer runs.

        `unit` are the points as shares of the bounds, shape (variables, n); objective, violation
        and error, shape (n,), are what `judged_with_error` returned for them.
        """
        design = {name: values[:, 0] for name, values in self.design.items()}
        scales = {name: values[:, 0] for name, values in self.scales.items()}
        value, chance_error = value * self.size, chance_error * self.size
        return most_reliable(self.problem, unit, (value, beyond, chance_error), design, scales)[0]

    def lost(self, unit: Array) -> Array:
        """Return the value to minimise, (n,) or a number; inf where an output has no value."""
        value = -self.judged(unit)[0]
        return value if np.ndim(unit) > 1 else value[0]

    def penalised(self, unit: Array) -> Array:
        """Return the value to minimise with a penalty for violations, always finite."""
        value, beyond = self.judged(unit)
        value = np.where(np.isfinite(value), -value + PENALTY * beyond, NO_VALUE)
        return value if np.ndim(unit) > 1 else value[0]

    def rows(self, unit: Array) -> Array:
        """Return outputs and smooth margins at points, over their sizes, shape (2 + margins, n).

        A margin is the distance to the bound of a constraint. The first row is the output to
        maximise, the second the other output of the criterion or 0. Methods that follow slopes ask
        for both at the same points: the last call is cached. `unit` are the points as shares of the
        bounds, shape (variables, n); missing values are replaced by -1e6.
        """
        key = unit.tobytes()
        if key == self._at:
            return self._rows
        x = self.points_in_box(unit)[:, None, :]
        self._count(x.shape[2])
        problem = self.problem
        known = problem.known(x, self.design, self.watch)
        shape = (1, x.shape[2])
        first = problem.sign * problem.output(problem.criterion.output, known) / self.size
        second = np.zeros(shape)
        if problem.against:
            second = problem.output(problem.against, known) / self.size
        parts = [first, second]
        margins = problem.smooth_margins(known, self.design)
        outputs = [
            kept.output
            for kept in problem.kept
            for _ in range(2 if kept.absolute and kept.upper else 1)
        ]
        parts += [margin / self.scales[name] for name, margin in zip(outputs, margins, strict=True)]
        rows = np.stack([np.broadcast_to(part, shape)[0] for part in parts])
        self._rows = np.where(np.isfinite(rows), rows, -NO_VALUE)
        self._at = key
        return self._rows

    def slopes(self, unit: Array) -> Array:
        """Return the derivatives of `rows` at a point, shape (2 + margins, variables).

        Rows are outputs and margins of constraints. Derivatives are differences, per share of the
        bounds, that stay within the bounds, beyond which an output may have no value. `unit` is the
        point as shares of the bounds, shape (variables,).
        """
        inside = np.clip(unit, 0.0, 1.0)
        return jacobian(lambda points: self.rows(points.T).T, inside, STEP).T


def spread(points: int, variables: int) -> Array:
    """Return evenly spread points of the unit box as starts of a search, shape (variables, points).

    The k-th point has the coordinates (1/2 + k r^-j) mod 1, j = 1 ... d, where d is the number of
    variables and r the root of r^(d + 1) = r + 1 (Roberts 2018). It is the same for each run.
    """
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / (variables + 1))
    steps = root ** -np.arange(1.0, variables + 1)
    return (0.5 + steps[:, None] * np.arange(1, points + 1)) % 1.0
