"""The model of a calibration: the motion of a part in each run, for values of the unknowns.

Points of the unknowns have shape (points, unknowns), in the units of studies. All that is told of
runs at points has shape (points, runs).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.feeding import feed_rate
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.plan import Plan, run_equations
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.scenes.scene import STATIC_ABOVE_KINETIC
from vibrafeed.core.study.calibrate_study import Prior, quantity_of
from vibrafeed.core.study.distributions import Normal
from vibrafeed.core.watch import Watch

CELLS_AT_A_TIME = 200_000  # motions that are predicted at a time: a bound on memory
SEEN = ("stick_fraction", "flight_fraction", "motion_status")
"""Outputs of a motion that say what a part is seen to do."""
SPEEDS = {
    "conveying_velocity": ("conveying_velocity_spread", "conveying_velocity_error"),
    "velocity_towards": ("velocity_error",),
}
"""The speed of a motion that is measured, along a track or on a plate, and its own errors."""
AMPLITUDE = "track_amplitude"
"""The output of a drive unit that a calibration reads."""


MAX_DEVIATIONS = 5.0
"""Standard deviations from the mean of a normal prior to either bound of its unknown."""
NEXT_TO = 1e-3
"""Distance from a bound that is no value, such as a friction of 0, in standard deviations."""


@dataclass(frozen=True)
class Unknown:
    """One number that is estimated.

    Attributes
    ----------
    name : str
        Its name in results, such as ``friction`` or ``offset_beta``.
    parameter : str
        The parameter that it is, shifts or multiplies.
    table : str
        Where the study has it: unknowns, offsets or factors.
    prior : Prior
        Its distribution before the measured runs.
    """

    name: str
    parameter: str
    table: str
    prior: Prior

    @property
    def unit(self) -> str:
        """The unit of the unknown."""
        return quantity_of(self.table, self.parameter).unit

    @property
    def label(self) -> str:
        """A short label of the unknown for plots and attributes, such as "Friction coefficient".

        An unknown that is added to a parameter or multiplied with it is labelled "Offset of the
        ..." or "Factor of the ...".
        """
        label = QUANTITIES[self.parameter].label
        lowered = in_sentence(label)
        return {"offsets": f"Offset of the {lowered}", "factors": f"Factor of the {lowered}"}.get(
            self.table, label
        )

    @property
    def width(self) -> float:
        """The distance between the bounds."""
        return self.upper - self.lower

    @property
    def lower(self) -> float:
        """The lower bound."""
        return self._ends[0]

    @property
    def upper(self) -> float:
        """The upper bound."""
        return self._ends[1]

    @cached_property
    def _ends(self) -> tuple[float, float]:
        # The bounds between which the unknown is sought.
        if not isinstance(self.prior, Normal):
            return self.prior.lower, self.prior.upper
        quantity = quantity_of(self.table, self.parameter)
        lower, upper = self.prior.within(quantity)
        mean, deviation = self.prior.mean, self.prior.deviation
        if quantity.strict and lower == quantity.lower:  # the bound itself is no value
            lower += NEXT_TO * deviation
        reach = MAX_DEVIATIONS * deviation
        return max(lower, mean - reach), min(upper, mean + reach)

    def deviations_from_mean(self, values: Array) -> Array:
        """Return the distance of values from the prior mean, in standard deviations.

        0 if the prior is not normal.
        """
        if not isinstance(self.prior, Normal):
            return np.zeros(np.shape(values))
        return np.asarray((np.asarray(values) - self.prior.mean) / self.prior.deviation)

    def log_prior(self, values: Array) -> Array:
        """Return the logarithm of the prior density, up to a constant."""
        return -0.5 * np.square(self.deviations_from_mean(values))


@dataclass(frozen=True)
class Runs:
    """The measured runs of a calibration.

    Attributes
    ----------
    columns : mapping of str to ndarray, shape (runs,)
        The parameters in which runs differ, in the units of studies.
    output : str
        The measured output: conveying_velocity, feed_rate, velocity_towards, or track_amplitude of
        a drive unit.
    value : ndarray, shape (runs,)
        Measured values, in the output's unit; NaN for a run without one.
    error : ndarray, shape (runs,)
        Standard deviations of the values; 0 in all runs if no error is known.
    seen : tuple of str
        What the part was seen to do in each run; empty for a run without observation.
    """

    columns: Mapping[str, Array]
    output: str
    value: Array
    error: Array
    seen: tuple[str, ...]

    @property
    def speed(self) -> str:
        """The speed from which the measured output follows."""
        return self.output if self.output in SPEEDS else "conveying_velocity"

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.seen)

    @property
    def measured(self) -> Mask:
        """A mask of the runs with a measured value, shape (runs,)."""
        return np.asarray(np.isfinite(self.value))

    def without(self, run: int) -> "Runs":
        """Return the other runs."""
        columns = {name: np.delete(column, run) for name, column in self.columns.items()}
        seen = self.seen[:run] + self.seen[run + 1 :]
        value, error = np.delete(self.value, run), np.delete(self.error, run)
        return Runs(columns, self.output, value, error, seen)

    @property
    def watched(self) -> Mask:
        """A mask of the runs with an observed regime, shape (runs,)."""
        return np.array([bool(word) for word in self.seen])

    @property
    def errors_known(self) -> bool:
        """True if the errors of the measured values are given."""
        return bool(np.any(self.error[self.measured] > 0))


class Predicted(NamedTuple):
    """Predictions of motions, shape (points, runs).

    Attributes
    ----------
    value : ndarray
        The measured output, in its unit; NaN where a motion has none.
    variance : ndarray
        Variance of the value: of a motion that does not repeat, and of the method.
    hops, rests : ndarray of bool
        True where the part leaves the floor; where friction holds the part all the time.
    """

    value: Array
    variance: Array
    hops: Mask
    rests: Mask

    def shows(self, seen: str) -> Mask:
        """Return a mask, shape (points, runs): True where a motion does what was seen.

        `seen` is the behaviour of the part that was observed in a run: "hops", "does not hop",
        "does not start", "moves forwards" or "moves backwards".
        """
        return {
            "hops": self.hops,
            "does not hop": ~self.hops & ~np.isnan(self.value),
            "does not start": self.rests,
            "moves forwards": ~self.rests & (self.value > 0),
            "moves backwards": ~self.rests & (self.value < 0),
        }[seen]


@dataclass(frozen=True)
class Model:
    """The motions of all runs, for any values of the unknowns.

    Attributes
    ----------
    plan : Plan
        Of the outputs of a motion.
    shared : mapping of str to float
        Parameters that all runs share, in the units of studies.
    unknowns : tuple of Unknown
        The numbers that are looked for.
    runs : Runs
        What was measured.
    """

    plan: Plan
    shared: Mapping[str, float]
    unknowns: tuple[Unknown, ...]
    runs: Runs

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def lower(self) -> Array:
        """The lower bounds of the unknowns, shape (unknowns,)."""
        return np.array([unknown.lower for unknown in self.unknowns])

    @property
    def width(self) -> Array:
        """The distance between the bounds of each unknown, shape (unknowns,)."""
        return np.array([unknown.width for unknown in self.unknowns])

    def predict(
        self, points: Array, watch: Watch, columns: Mapping[str, Array] | None = None
    ) -> Predicted:
        """Return the predicted values and behaviours of runs, for points of the unknowns.

        Points are simulated in groups of about `CELLS_AT_A_TIME` motions, as a bound on memory.
        """
        columns = self.runs.columns if columns is None else columns
        runs = max((values.size for values in columns.values()), default=1)
        points_at_a_time = max(1, CELLS_AT_A_TIME // runs)
        parts = []
        for start in range(0, len(points), points_at_a_time):
            chunk = points[start : start + points_at_a_time]
            parts.append(self._predict(chunk, runs, columns, watch.part(len(chunk) / len(points))))
            watch.check()
        return Predicted._make(np.concatenate(part) for part in zip(*parts, strict=True))

    def _predict(
        self, points: Array, runs: int, columns: Mapping[str, Array], watch: Watch
    ) -> Predicted:
        parameters = self._parameters(points, columns)
        with np.errstate(all="ignore"):
            results = run_equations(
                self.plan, {n: parameters[n] for n in self.plan.parameters}, watch
            )
            shape = (len(points), runs)
            if self.runs.output == AMPLITUDE:  # closed forms of the unit, without any part
                value = np.broadcast_to(results[AMPLITUDE], shape)
                nowhere = np.zeros(shape, np.bool_)
                return Predicted(value, np.zeros(shape), nowhere, nowhere)
            speed = self.runs.speed
            velocity = results[speed]
            variance = sum(np.square(results[name]) for name in SPEEDS[speed])
            scale: Array | float = 1.0
            if self.runs.output == "feed_rate":
                scale = feed_rate(
                    conveying_velocity=np.asarray(1.0),
                    length=results["length"],
                    occupancy=results["occupancy"],
                )
            value, variance = velocity * scale, variance * np.square(scale)
        return Predicted(
            *(
                np.broadcast_to(field, shape)
                for field in (
                    value,
                    np.where(np.isfinite(variance), variance, 0.0),
                    results["flight_fraction"] > 0,
                    results["stick_fraction"] == 1.0,
                )
            )
        )

    def _parameters(self, points: Array, columns: Mapping[str, Array]) -> dict[str, Array]:
        # All parameters, SI units, of shape (points, runs) or broadcastable to it.
        parameters: dict[str, Array] = {
            name: np.asarray(value) for name, value in self.shared.items()
        }
        parameters |= {name: values[np.newaxis] for name, values in columns.items()}
        for k, unknown in enumerate(self.unknowns):
            column = points[:, k : k + 1]
            if unknown.table == "unknowns":
                parameters[unknown.parameter] = column
            elif unknown.table == "offsets":
                parameters[unknown.parameter] = parameters[unknown.parameter] + column
            else:
                parameters[unknown.parameter] = parameters[unknown.parameter] * column
        return {
            name: parameter_to_si(name, np.asarray(value)) for name, value in parameters.items()
        }

    def log_prior(self, points: Array) -> Array:
        """Return the logarithm of the prior density at points, up to a constant, shape (points,).

        `points` are values of the unknowns in the units of studies, shape (points, unknowns). It is
        minus infinity where kinetic friction would exceed static friction.
        """
        log: Array = np.zeros(len(points))
        for k, unknown in enumerate(self.unknowns):
            log = log + unknown.log_prior(points[:, k])
        parameters = {**self.shared, **dict(zip(self.names, points.T, strict=True))}
        static, kinetic = map(parameters.get, STATIC_ABOVE_KINETIC.parameters)
        if static is not None and kinetic is not None:
            log = np.where(static >= kinetic, log, -np.inf)
        return log
