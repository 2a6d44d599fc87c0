"""A calibration that can be carried out."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from vibrafeed.core.calibrate.boxes import Likelihood
from vibrafeed.core.calibrate.model import Model
from vibrafeed.core.calibrate.posterior import AXIS, MAX_MODES, Posterior
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.systems import methods_of
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.labels import ResultVariable
from vibrafeed.core.plan.prepared import MARGIN, Prepared, Price, price
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.calibrate_study import CalibrateStudy
from vibrafeed.core.watch import Watch

# --- The next measurement: how much each of some drives would add.

ENSEMBLE = 300  # points of the posterior at which candidates are predicted
MAX_CANDIDATES = 2_000  # candidate runs: each takes `ENSEMBLE` motions
SPEED_NODES = 240  # speeds at which a predicted density is summed
AROUND = 4.0
"""Standard deviations by which the speeds reach beyond the least and the largest."""
CANDIDATES_AT_A_TIME = 50  # a bound on memory
BIT = np.log(2.0)  # nats in a bit


def columns_of(grid: Grid) -> dict[str, Array]:
    """Return the parameters of every candidate run, by name, as arrays of shape (candidates,).

    Candidates are runs that could be measured next; the calibration ranks them. `grid` spans them:
    all combinations of its axes, with the fixed parameters repeated. Values are in the units of
    studies.
    """
    indices = np.unravel_index(np.arange(grid.cells), tuple(grid.shape.values()) or (1,))
    index_along = dict(zip(grid.axes, indices, strict=False))
    varied = {
        name: grid.values_of(name).array()[index_along[axis]] for name, axis in grid.along.items()
    }
    return varied | {name: np.full(grid.cells, value) for name, value in grid.fixed.items()}


def typical_error(posterior: Posterior) -> float:
    """Return the standard deviation expected of one more measurement, in the output's unit.

    It joins the median of the known errors of the runs and the discrepancy, the scatter that no
    unknown explains.
    """
    runs = posterior.likelihood.model.runs
    errors = runs.error[runs.measured]
    discrepancy_variance = float(
        posterior.size_probabilities @ np.square(posterior.likelihood.scatter.sizes)
    )
    median_error = float(np.median(errors)) if errors.size else 0.0
    return float(np.sqrt(median_error**2 + discrepancy_variance))


def information(
    model: Model, posterior: Posterior, grid: Grid, watch: Watch
) -> tuple[Array, Array, Array, Array]:
    """Return the information that measuring each candidate run would add [bit], and predictions.

    It is the entropy of the speed that would be measured, less that of its error: by so much the
    entropy of the unknowns is expected to fall (D. V. Lindley, Annals of Mathematical Statistics 27
    (1956) 986). `grid` spans the drives of the candidates; `watch` may stop the simulation
    (`StoppedError`).
    """
    points = posterior.ensemble(ENSEMBLE)
    predicted = model.predict(points, watch, columns_of(grid))
    values = np.where(np.isnan(predicted.value), np.nan, predicted.value)  # (points, candidates)
    spread = np.sqrt(predicted.variance + typical_error(posterior) ** 2)
    gain, deviation_ratio = np.empty(values.shape[1]), np.empty((points.shape[1], values.shape[1]))
    for start in range(0, values.shape[1], CANDIDATES_AT_A_TIME):
        chunk = slice(start, start + CANDIDATES_AT_A_TIME)
        gain[chunk], deviation_ratio[:, chunk] = _information_gain(
            values[:, chunk], spread[:, chunk], points
        )
    with np.errstate(all="ignore"):
        has_speed = ~np.isnan(values)
        count = np.maximum(has_speed.sum(axis=0), 1)
        mean = np.where(has_speed, values, 0.0).sum(axis=0) / count
        variance = np.square(np.where(has_speed, values - mean, 0.0)).sum(axis=0) / count
    without_speed = ~has_speed.any(axis=0)
    mean, deviation = (
        np.where(without_speed, np.nan, statistic) for statistic in (mean, np.sqrt(variance))
    )
    return gain, mean, deviation, deviation_ratio


def _information_gain(value: Array, spread: Array, points: Array) -> tuple[Array, Array]:
    # Per candidate: entropy of the predicted speed, H = -sum p log(p) dy, less that of its error,
    # log(s) + (log(2 pi) + 1)/2, as bits, times the fraction of points with a speed; and the ratio
    # of the deviations of the unknowns after and before.
    has_speed = ~np.isnan(value)
    count = has_speed.sum(axis=0)
    lowest = np.where(has_speed, value - AROUND * spread, np.inf).min(axis=0)
    highest = np.where(has_speed, value + AROUND * spread, -np.inf).max(axis=0)
    spanned = (count > 0) & (highest > lowest)
    gain, deviation_ratio = np.full(value.shape[1], 0.0), np.ones((points.shape[1], value.shape[1]))
    if not spanned.any():
        return gain, deviation_ratio
    value, spread, has_speed = value[:, spanned], spread[:, spanned], has_speed[:, spanned]
    steps = (highest - lowest)[spanned] / (SPEED_NODES - 1)
    speeds = lowest[spanned] + steps * np.arange(SPEED_NODES)[:, np.newaxis]
    distance = (speeds[np.newaxis] - np.where(has_speed, value, 0.0)[:, np.newaxis]) / spread[
        :, np.newaxis
    ]
    density = np.exp(-0.5 * np.square(distance)) / (np.sqrt(2.0 * np.pi) * spread[:, np.newaxis])
    density *= has_speed[:, np.newaxis]
    deviation_ratio[:, spanned] = _deviation_ratio(density, points, steps)
    density = density.sum(axis=0) / count[spanned]
    with np.errstate(divide="ignore", invalid="ignore"):
        entropy = -np.where(density > 0, density * np.log(density), 0.0).sum(axis=0) * steps
        error_entropy = np.log(spread) + 0.5 * (np.log(2.0 * np.pi) + 1.0)
    mean_error_entropy = np.where(has_speed, error_entropy, 0.0).sum(axis=0) / count[spanned]
    # Points without a speed add nothing: a run that may have none is not worth planning.
    gain[spanned] = (
        np.maximum(entropy - mean_error_entropy, 0.0) / BIT * (count[spanned] / len(value))
    )
    return gain, deviation_ratio


def _deviation_ratio(density: Array, points: Array, steps: Array) -> Array:
    # sqrt(E[Var(x|y)]/Var(x)), E[Var(x|y)] = 1/n sum_y dy (sum_i p_i(y) x_i^2 - (sum_i p_i(y)
    # x_i)^2/sum_i p_i(y)); p_i is `density`, its axes points, speeds y and candidates. Points
    # that predict no speed keep their part of the variance.
    deviations = points - points.mean(axis=0)
    variance_before = np.square(deviations).mean(axis=0)
    total = density.sum(axis=0)
    first_moment = np.einsum("ijk,iu->ujk", density, deviations)
    second_moment = np.einsum("ijk,iu->ujk", density, np.square(deviations))
    with np.errstate(divide="ignore", invalid="ignore"):
        within = np.where(total > 0, second_moment - np.square(first_moment) / total, 0.0)
        expected = within.sum(axis=1) * steps / len(points)
        without_speed = 1.0 - total.sum(axis=0) * steps / len(points)
        variance = expected + np.maximum(without_speed, 0.0) * variance_before[:, np.newaxis]
        ratio = np.where(
            variance_before[:, np.newaxis] > 0, variance / variance_before[:, np.newaxis], 1.0
        )
    return np.sqrt(np.clip(ratio, 0.0, 1.0))


RUN, MODE = "run", "mode"
BANDS = {
    "lower_68": "lower end of 68 %", "upper_68": "upper end of 68 %",
    "lower_95": "lower end of 95 %", "upper_95": "upper end of 95 %",
}  # fmt: skip
ESTIMATES = {
    "best": "best", "mean": "mean", "median": "median", "deviation": "standard deviation", **BANDS,
}  # fmt: skip
"""Estimates of each unknown, in words; the names of variables begin with the keys."""
CANDIDATE = "candidate_"
DEVIATION_AFTER = "deviation_after_"
POINT_SECONDS = 4e-6  # of a point and a run, beside following the motion
FEW_SECONDS = 1.5  # for densities, modes and the last digits


@dataclass(frozen=True)
class Calibration(Prepared):
    """A calibration that can be carried out; `grid` spans all that parameters may be.

    Attributes
    ----------
    likelihood : Likelihood
        Of the observations, with the motions of all runs.
    candidates : Grid or None
        Drives that could be run next.
    """

    study: CalibrateStudy
    likelihood: Likelihood
    candidates: Grid | None

    @property
    def model(self) -> Model:
        """The model that predicts all runs."""
        return self.likelihood.model

    @property
    def _seconds_a_cell(self) -> float | None:
        methods = methods_of(self.plan.scene.name)
        method = methods.get(self.plan.variant) if self.plan.scene.choice == "method" else None
        return method.seconds_a_cell if method else None

    @property
    def cells(self) -> int:
        """The largest number of motions that are simulated."""
        return self.study.points * len(self.model.runs) + self.candidate_motions

    @property
    def candidate_motions(self) -> int:
        """The number of motions simulated for candidates of further runs."""
        return ENSEMBLE * self.candidates.cells if self.candidates else 0

    @property
    def stored(self) -> int:
        """The number of points of the largest variable."""
        return AXIS[len(self.model.names)] ** len(self.model.names)

    @cached_property
    def variables(self) -> dict[str, ResultVariable]:
        """Every variable of the result by name, in the order in which they are stored."""
        return {variable.name: variable for variable in _variables(self)}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        return {name: variable.unit for name, variable in self.variables.items()}

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The names of the dimensions of each variable."""
        return {name: variable.dims for name, variable in self.variables.items()}

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """The pairs of unknowns with a density; none where `log_density` shows it."""
        names = self.model.names
        return [*combinations(names, 2)] if len(names) > 2 else []

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension of the calibration's result, by name.

        The dimensions are runs, modes, the grid of each unknown's posterior and the axes of
        candidate runs. The number of modes is only known after the computation; the most that are
        stored stand for it.
        """
        names = self.model.names
        sizes = {RUN: len(self.model.runs), MODE: MAX_MODES}
        sizes |= dict.fromkeys(names, AXIS[len(names)])
        if self.candidates:
            sizes |= {CANDIDATE + name: size for name, size in self.candidates.shape.items()}
        return sizes

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which a calibration can be cut into pieces: none."""
        return ()

    def _new_price(self) -> Price:
        motion = price(self.plan, self.grid, self._seconds_a_cell)
        return Price(motion.start + MARGIN * FEW_SECONDS, motion.cell + MARGIN * POINT_SECONDS)

    @property
    def verified_by(self) -> str:
        """The method that verifies results: none, so that studies asking for it are refused."""
        return ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """The time of verifying a cell: 0, as calibrations are not verified."""
        return 0.0

    def what_fits(self, fraction: float) -> str:
        """Return a sentence that says how to shrink the study to a share of its size."""
        return "Calibrate fewer unknowns, or fewer candidates"


def _variables(prepared: Calibration) -> Iterator[ResultVariable]:
    variable, model, runs = ResultVariable, prepared.model, (RUN,)
    output = QUANTITIES[model.runs.output]
    unit, labels = output.unit, {u.name: in_sentence(u.label) for u in model.unknowns}
    for unknown in model.unknowns:
        for estimate, words in ESTIMATES.items():
            label = f"{words.capitalize()} of the {labels[unknown.name]}"
            yield variable(f"{estimate}_{unknown.name}", (), unknown.unit, label)
    for first, second in combinations(model.names, 2):
        yield variable(
            f"correlation_{first}_{second}", (), "1", f"Correlation of {first} and {second}"
        )
    yield variable(
        "discrepancy",
        (),
        unit,
        "Discrepancy",
        "Standard deviation of what errors and "
        "unknowns do not explain: its median. All else is averaged over it.",
    )
    for band, words in BANDS.items():
        yield variable(f"discrepancy_{band}", (), unit, f"Discrepancy, {words}")
    yield variable(
        "discrepancy_probability",
        (),
        "1",
        "Probability of a discrepancy",
        "That there is any discrepancy; 0.1 before the runs.",
    )
    for unknown in model.unknowns:
        label = f"Best of each mode, {labels[unknown.name]}"
        yield variable(f"mode_{unknown.name}", (MODE,), unknown.unit, label)
    yield variable("mode_share", (MODE,), "1", "Share of the mode", "Of the mass of the posterior.")
    yield variable(model.runs.output, runs, unit, f"Measured {output.label.lower()}")
    yield variable("error", runs, unit, "Error", "Standard deviation of the measured value.")
    yield variable(
        "predicted", runs, unit, "Predicted", "Mean over the posterior of the predicted value."
    )
    yield variable(
        "predicted_best",
        runs,
        unit,
        "Predicted by the best values",
        "Value predicted with the best values.",
    )
    for band, words in BANDS.items():
        yield variable(f"predicted_{band}", runs, unit, f"Predicted, {words}")
    yield variable(
        "predicted_spread",
        runs,
        unit,
        "Spread",
        "Of a motion that does not repeat, at the best values.",
    )
    yield variable(
        "residual", runs, unit, "Residual", "Measured less predicted by the best values."
    )
    yield variable(
        "residual_over_error",
        runs,
        "1",
        "Residual over error",
        "With the error of the run, its spread and the discrepancy.",
    )
    if model.runs.watched.any():
        yield variable(
            "probability_of_seen",
            runs,
            "1",
            "Probability of the observation",
            "By the posterior, run by run.",
        )
    for unknown in model.unknowns:
        density_unit = "1" if unknown.unit == "1" else f"({unknown.unit})-1"
        label = f"Density of the {labels[unknown.name]}"
        yield variable(f"density_{unknown.name}", (unknown.name,), density_unit, label)
    for first, second in prepared.pairs:
        yield variable(
            f"density_{first}_{second}", (first, second), "1", f"Density of {first} and {second}"
        )
    yield variable(
        "log_density",
        model.names,
        "1",
        "Logarithm of the posterior density",
        "Natural, 0 where it is largest on this grid.",
    )
    if prepared.candidates:
        drive = tuple(CANDIDATE + name for name in prepared.candidates.axes)
        yield variable(
            "information", drive, "bit", "Expected information", "What a measurement there adds."
        )
        yield variable("expected", drive, unit, "Expected value", "Mean over the posterior.")
        yield variable(
            "expected_deviation",
            drive,
            unit,
            "Deviation of the expected value",
            "Over the posterior.",
        )
        for unknown in model.unknowns:
            label = f"Standard deviation of the {labels[unknown.name]} after the measurement"
            yield variable(
                f"{DEVIATION_AFTER}{unknown.name}",
                drive,
                unknown.unit,
                label,
                "Expected standard deviation after the measurement there.",
            )
