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
    places = np.unravel_index(np.arange(grid.cells), tuple(grid.shape.values()) or (1,))
    place = dict(zip(grid.axes, places, strict=False))
    found = {name: grid.values_of(name).array()[place[axis]] for name, axis in grid.along.items()}
    return found | {name: np.full(grid.cells, value) for name, value in grid.fixed.items()}


def typical_error(posterior: Posterior) -> float:
    """Return the standard deviation expected of one more measurement, in the output's unit.

    It joins the median of the known errors of the runs and the discrepancy, the scatter that no
    unknown explains.
    """
    runs = posterior.likelihood.model.runs
    known = runs.error[runs.measured]
    scatter = float(posterior.sizes @ np.square(posterior.likelihood.scatter.sizes))
    usual = float(np.median(known)) if known.size else 0.0
    return float(np.sqrt(usual**2 + scatter))


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
    found = model.predict(points, watch, columns_of(grid))
    value = np.where(np.isnan(found.value), np.nan, found.value)
    spread = np.sqrt(found.variance + typical_error(posterior) ** 2)
    gain, left = np.empty(value.shape[1]), np.empty((points.shape[1], value.shape[1]))
    for start in range(0, value.shape[1], CANDIDATES_AT_A_TIME):
        some = slice(start, start + CANDIDATES_AT_A_TIME)
        gain[some], left[:, some] = _gain(value[:, some], spread[:, some], points)
    with np.errstate(all="ignore"):
        known = ~np.isnan(value)
        count = np.maximum(known.sum(axis=0), 1)
        mean = np.where(known, value, 0.0).sum(axis=0) / count
        square = np.square(np.where(known, value - mean, 0.0)).sum(axis=0) / count
    nothing = ~known.any(axis=0)
    mean, deviation = (np.where(nothing, np.nan, one) for one in (mean, np.sqrt(square)))
    return gain, mean, deviation, left


def _gain(value: Array, spread: Array, points: Array) -> tuple[Array, Array]:
    # Entropy of the predicted speed less that of its error [bit], times the share of points with a
    # speed; and the deviations of the unknowns after over before.
    known = ~np.isnan(value)
    count = known.sum(axis=0)
    least = np.where(known, value - AROUND * spread, np.inf).min(axis=0)
    most = np.where(known, value + AROUND * spread, -np.inf).max(axis=0)
    some = (count > 0) & (most > least)
    gain, left = np.full(value.shape[1], 0.0), np.ones((points.shape[1], value.shape[1]))
    if not some.any():
        return gain, left
    value, spread, known = value[:, some], spread[:, some], known[:, some]
    steps = (most - least)[some] / (SPEED_NODES - 1)
    speeds = least[some] + steps * np.arange(SPEED_NODES)[:, np.newaxis]
    away = (speeds[np.newaxis] - np.where(known, value, 0.0)[:, np.newaxis]) / spread[:, np.newaxis]
    density = np.exp(-0.5 * np.square(away)) / (np.sqrt(2.0 * np.pi) * spread[:, np.newaxis])
    density *= known[:, np.newaxis]
    left[:, some] = _left(density, points, steps)
    density = density.sum(axis=0) / count[some]
    with np.errstate(divide="ignore", invalid="ignore"):
        entropy = -np.where(density > 0, density * np.log(density), 0.0).sum(axis=0) * steps
        own = np.log(spread) + 0.5 * (np.log(2.0 * np.pi) + 1.0)
    noise = np.where(known, own, 0.0).sum(axis=0) / count[some]
    # What motions of no speed tell is not counted: such a run is not one to plan.
    gain[some] = np.maximum(entropy - noise, 0.0) / BIT * (count[some] / len(value))
    return gain, left


def _left(density: Array, points: Array, steps: Array) -> Array:
    # sqrt(E[Var(x|y)]/Var(x)), E[Var(x|y)] = 1/n sum_y dy (sum_i p_i(y) x_i^2 - (sum_i p_i(y)
    # x_i)^2/sum_i p_i(y)). Points that predict no speed keep their share of the variance.
    away = points - points.mean(axis=0)
    before = np.square(away).mean(axis=0)
    whole = density.sum(axis=0)
    first = np.einsum("ijk,iu->ujk", density, away)
    second = np.einsum("ijk,iu->ujk", density, np.square(away))
    with np.errstate(divide="ignore", invalid="ignore"):
        within = np.where(whole > 0, second - np.square(first) / whole, 0.0)
        seen = within.sum(axis=1) * steps / len(points)
        silent = 1.0 - whole.sum(axis=0) * steps / len(points)
        variance = seen + np.maximum(silent, 0.0) * before[:, np.newaxis]
        share = np.where(before[:, np.newaxis] > 0, variance / before[:, np.newaxis], 1.0)
    return np.sqrt(np.clip(share, 0.0, 1.0))


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
LEFT = "deviation_after_"
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
        return self.study.points * len(self.model.runs) + self.asked

    @property
    def asked(self) -> int:
        """The number of motions simulated for candidates of further runs."""
        return ENSEMBLE * self.candidates.cells if self.candidates else 0

    @property
    def stored(self) -> int:
        """The number of points of the largest variable."""
        return AXIS[len(self.model.names)] ** len(self.model.names)

    @cached_property
    def variables(self) -> dict[str, ResultVariable]:
        """Every variable of the result by name, in the order in which they are stored."""
        return {one.name: one for one in _variables(self)}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        return {name: one.unit for name, one in self.variables.items()}

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The names of the dimensions of each variable."""
        return {name: one.dims for name, one in self.variables.items()}

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

    def what_fits(self, share: float) -> str:
        """Return a sentence that says how to shrink the study to a share of its size."""
        return "Calibrate fewer unknowns, or fewer candidates"


def _variables(prepared: Calibration) -> Iterator[ResultVariable]:
    made, model, over = ResultVariable, prepared.model, (RUN,)
    output = QUANTITIES[model.runs.output]
    unit, lowered = output.unit, {u.name: in_sentence(u.label) for u in model.unknowns}
    for unknown in model.unknowns:
        for what, says in ESTIMATES.items():
            label = f"{says.capitalize()} of the {lowered[unknown.name]}"
            yield made(f"{what}_{unknown.name}", (), unknown.unit, label)
    for a, b in combinations(model.names, 2):
        yield made(f"correlation_{a}_{b}", (), "1", f"Correlation of {a} and {b}")
    yield made("discrepancy", (), unit, "Discrepancy", "Standard deviation of what errors and "
              "unknowns do not explain: its median. All else is averaged over it.")  # fmt: skip
    for band, says in BANDS.items():
        yield made(f"discrepancy_{band}", (), unit, f"Discrepancy, {says}")
    yield made("discrepancy_probability", (), "1", "Probability of a discrepancy",
              "That there is any discrepancy; 0.1 before the runs.")  # fmt: skip
    for unknown in model.unknowns:
        label = f"Best of each mode, {lowered[unknown.name]}"
        yield made(f"mode_{unknown.name}", (MODE,), unknown.unit, label)
    yield made("mode_share", (MODE,), "1", "Share of the mode", "Of the mass of the posterior.")
    yield made(model.runs.output, over, unit, f"Measured {output.label.lower()}")
    yield made("error", over, unit, "Error", "Standard deviation of the measured value.")
    yield made("predicted", over, unit, "Predicted", "Mean over the posterior of the predicted "
              "value.")  # fmt: skip
    yield made("predicted_best", over, unit, "Predicted by the best values", "Value predicted with "
              "the best values.")  # fmt: skip
    for band, says in BANDS.items():
        yield made(f"predicted_{band}", over, unit, f"Predicted, {says}")
    yield made("predicted_spread", over, unit, "Spread", "Of a motion that does not repeat, at the "
              "best values.")  # fmt: skip
    yield made("residual", over, unit, "Residual", "Measured less predicted by the best values.")
    yield made("residual_over_error", over, "1", "Residual over error", "With the error of the "
              "run, its spread and the discrepancy.")  # fmt: skip
    if model.runs.watched.any():
        yield made("probability_of_seen", over, "1", "Probability of the observation", "By the "
                  "posterior, run by run.")  # fmt: skip
    for unknown in model.unknowns:
        per = "1" if unknown.unit == "1" else f"({unknown.unit})-1"
        label = f"Density of the {lowered[unknown.name]}"
        yield made(f"density_{unknown.name}", (unknown.name,), per, label)
    for a, b in prepared.pairs:
        yield made(f"density_{a}_{b}", (a, b), "1", f"Density of {a} and {b}")
    yield made("log_density", model.names, "1", "Logarithm of the posterior density", "Natural, 0 "
              "where it is largest on this grid.")  # fmt: skip
    if prepared.candidates:
        drive = tuple(CANDIDATE + name for name in prepared.candidates.axes)
        yield made("information", drive, "bit", "Expected information", "What a measurement "
                  "there adds.")  # fmt: skip
        yield made("expected", drive, unit, "Expected value", "Mean over the posterior.")
        yield made("expected_deviation", drive, unit, "Deviation of the expected value", "Over the "
                  "posterior.")  # fmt: skip
        for unknown in model.unknowns:
            label = f"Standard deviation of the {lowered[unknown.name]} after the measurement"
            yield made(f"{LEFT}{unknown.name}", drive, unknown.unit, label, "Expected standard "
                      "deviation after the measurement there.")  # fmt: skip
