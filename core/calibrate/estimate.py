"""Carrying out a calibration: explore, sum up, polish."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations
from typing import Any, Final

import numpy as np
import scipy
from numpy.typing import NDArray

from vibrafeed.core.calibrate.boxes import Likelihood, Scatter, explore, log_sum
from vibrafeed.core.calibrate.calibration import (
    BANDS,
    CANDIDATE,
    DEVIATION_AFTER,
    ENSEMBLE,
    MODE,
    RUN,
    Calibration,
    information,
)
from vibrafeed.core.calibrate.findings import Findings
from vibrafeed.core.calibrate.posterior import (
    Posterior,
    axes_of,
    log_density,
    marginal_density,
    modes_of,
    pair_density,
    posterior_of,
)
from vibrafeed.core.calibrate.prepare import UNITS, choose, prepare
from vibrafeed.core.dataset.table import Table, TableVariable, quantity_attributes
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.differences import jacobian
from vibrafeed.core.plan.labels import global_attributes
from vibrafeed.core.plan.pieces import FOLLOWED, Computed, Kind
from vibrafeed.core.study.calibrate_study import FEWEST_POINTS, CalibrateStudy
from vibrafeed.core.study.values import DESIGN
from vibrafeed.core.watch import Watch

# --- The last digits of the best values: least squares by scipy from the best point of a mode.

STEP = 1e-5  # step of differences, as a share of the distance of the bounds
MAX_STEPS = 40  # evaluations of the residuals, beside those of their derivatives
FAR = 1e3  # residual over error where a motion has no speed


def _refined_best(likelihood: Likelihood, start: Array, size: float, watch: Watch) -> Array:
    # Least squares from `start`: residuals of the measured runs over their standard deviations,
    # that of the discrepancy being `size`, and distances from the prior means. Returns `start` if
    # that does not lower the sum. Points are values of the unknowns, in the units of studies.
    model = likelihood.model
    where, silent = model.runs.measured, Watch(stop=watch.stop, deadline=watch.deadline)
    if not where.any():
        return start

    def residuals(fractions: Array) -> Array:
        points = model.lower + fractions * model.width
        predicted = model.predict(points, silent)
        residual = predicted.value[:, where] - model.runs.value[where]
        variance = (
            predicted.variance[:, where] + np.square(model.runs.error[where]) + np.square(size)
        )
        variance = np.where(variance > 0, variance, 1.0)
        scaled = np.nan_to_num(residual / np.sqrt(variance), nan=FAR)
        scaled = np.copysign(np.sqrt(likelihood.penalty(np.square(scaled))), scaled)
        from_prior = [
            unknown.deviations_from_mean(points[:, k]) for k, unknown in enumerate(model.unknowns)
        ]
        return np.concatenate([scaled, np.stack(from_prior, axis=1)], axis=1)

    start_fractions = np.clip((start - model.lower) / model.width, 1e-9, 1.0 - 1e-9)
    start_residuals = residuals(start_fractions[np.newaxis])[0]
    optimum = scipy.optimize.least_squares(
        lambda fractions: residuals(fractions[np.newaxis])[0],
        start_fractions,
        jac=lambda fractions: jacobian(residuals, fractions, STEP).T,
        bounds=(0.0, 1.0),
        x_scale="jac",
        xtol=1e-12,
        ftol=1e-14,
        gtol=1e-14,
        max_nfev=MAX_STEPS,
    )
    # scipy's cost is half the sum of squares.
    if not 2.0 * optimum.cost < start_residuals @ start_residuals:
        return start
    return model.lower + optimum.x * model.width


SHARES = (0.16, 0.84, 0.025, 0.975)
"""Of the mass below the ends of the intervals of `BANDS`: both tails are equal."""


def compute(prepared: Calibration, watch: Watch) -> Computed:
    """Carry out a calibration and return every variable of its result, in the units of studies.

    It explores the posterior of the unknowns on an adaptive grid, refines the best values, and
    estimates what further runs would add if candidates are given. Raises `StoppedError` if `watch`
    stops it.
    """
    points = prepared.study.points
    fraction = points * len(prepared.model.runs) / prepared.cells  # of the motions
    likelihood = prepared.likelihood
    explored = explore(likelihood, points, watch.part(fraction))
    posterior = posterior_of(likelihood, explored)
    axes = axes_of(posterior)
    arrays = _summary_statistics(prepared, posterior)
    arrays |= _best_estimates(prepared, posterior, axes, watch)
    arrays |= _by_run(prepared, posterior, arrays)
    arrays |= _densities(prepared, posterior, axes)
    if prepared.candidates is not None:
        grid = prepared.candidates
        shape = tuple(grid.shape.values())
        names = ("information", "expected", "expected_deviation")
        *by_candidate, ratios = information(
            prepared.model, posterior, grid, watch.part(1.0 - fraction)
        )
        arrays |= {name: v.reshape(shape) for name, v in zip(names, by_candidate, strict=True)}
        for name, ratio in zip(prepared.model.names, ratios, strict=True):
            after = ratio * arrays[f"deviation_{name}"]
            arrays[f"{DEVIATION_AFTER}{name}"] = after.reshape(shape)
    coordinates = dict(zip(prepared.model.names, axes, strict=True))
    misfit = _worst_misfit(prepared, arrays, replace(watch, progress=None))
    notes = {
        "findings": Findings(prepared, posterior, arrays | coordinates, misfit).text(),
        FOLLOWED: f"{explored.points * len(prepared.model.runs) + prepared.candidate_motions}",
    }
    return Computed({name: np.asarray(v) for name, v in (arrays | coordinates).items()}, notes)


def label(prepared: Calibration, computed: Computed, _: Watch) -> Table:
    """Return the result of a calibration as a table: arrays with dimensions, units and attributes.

    `computed` has the arrays and notes that `compute` returned for the study `prepared`. Nothing is
    verified, so that the watch, which other kinds of study need here, is not used.
    """
    model, arrays = prepared.model, computed.arrays
    variables = {
        name: TableVariable(variable.dims, arrays[name], variable.attributes)
        for name, variable in prepared.variables.items()
    }
    dataset_attributes = {
        **global_attributes(prepared, f"calibration, method {prepared.plan.variant}"),
        "title": prepared.study.title
        or f"What {len(model.runs)} runs say about "
        + ", ".join(unknown.label.lower() for unknown in model.unknowns),
        "output": model.runs.output,
        "unknowns": " ".join(model.names),
        "findings": computed.notes["findings"],
        FOLLOWED: float(computed.notes[FOLLOWED]),
    }
    return Table(_coordinates(prepared, arrays), variables, dataset_attributes)


SUSPECT = 1.5
"""Errors from what all runs give: a run that lies farther is compared with the other runs."""
DISTANT = 3.5  # errors from what the other runs give: such a run does not fit
FEWER = 4  # the other runs alone are explored with this fraction (1/4) of the points


def _worst_misfit(
    prepared: Calibration, arrays: Mapping[str, Array], watch: Watch
) -> tuple[int, float, Posterior] | None:
    # The number of the run with the largest residual, its distance in standard deviations from the
    # value that the other runs predict, and the posterior without it; None if it fits.
    model, likelihood = prepared.model, prepared.likelihood
    relative_residuals = np.abs(np.nan_to_num(arrays["residual_over_error"]))
    run = int(relative_residuals.argmax())
    if relative_residuals[run] < SUSPECT or model.runs.measured.sum() < len(model.unknowns) + 2:
        return None
    others = replace(model, runs=model.runs.without(run))
    scatter = Scatter.of(others, wanted=prepared.study.discrepancy)
    likelihood = replace(likelihood, model=others, scatter=scatter)
    points = max(prepared.study.points // FEWER, FEWEST_POINTS)
    columns = {name: column[[run]] for name, column in model.runs.columns.items()}
    try:
        posterior = posterior_of(likelihood, explore(likelihood, points, watch))
        predicted = others.predict(posterior.ensemble(ENSEMBLE), watch, columns)
    except StoppedError:  # the estimates from all runs stand without this check
        return None
    values = predicted.value[np.isfinite(predicted.value)]
    if not values.size:
        return None
    scatter = posterior.likelihood.scatter
    variance = values.var() + predicted.variance.mean() + model.runs.error[run] ** 2
    variance += posterior.size_probabilities @ np.square(scatter.sizes)
    distance = float(np.abs(model.runs.value[run] - values.mean()) / np.sqrt(variance))
    return (run + 1, distance, posterior) if distance > DISTANT else None


def _summary_statistics(prepared: Calibration, posterior: Posterior) -> dict[str, Array]:
    model, arrays = prepared.model, dict[str, Array]()
    points = posterior.points
    quantiles = posterior.quantiles(points, (0.5, *SHARES))
    covariance = posterior.covariance()
    deviations = np.sqrt(np.diag(covariance))
    for position, unknown in enumerate(model.unknowns):
        arrays[f"mean_{unknown.name}"] = posterior.mean(points)[position]
        arrays[f"median_{unknown.name}"] = quantiles[0, position]
        arrays[f"deviation_{unknown.name}"] = deviations[position]
        arrays |= {
            f"{band}_{unknown.name}": quantiles[1 + column, position]
            for column, band in enumerate(BANDS)
        }
    for first, second in combinations(range(len(model.unknowns)), 2):
        product = deviations[first] * deviations[second]
        name = f"correlation_{model.names[first]}_{model.names[second]}"
        arrays[name] = np.asarray(covariance[first, second] / product if product > 0 else 0.0)
    sizes, probabilities = posterior.likelihood.scatter.sizes, posterior.size_probabilities
    cumulative = np.cumsum(probabilities) - 0.5 * probabilities
    # The mass of size 0 is a point mass: quantiles within it are 0, not interpolated.
    quantile_sizes = [
        0.0
        if sizes[0] == 0.0 and fraction <= probabilities[0]
        else np.interp(fraction, cumulative, sizes)
        for fraction in (0.5, *SHARES)
    ]
    arrays["discrepancy"] = np.asarray(quantile_sizes[0])
    arrays |= {
        f"discrepancy_{band}": np.asarray(size)
        for band, size in zip(BANDS, quantile_sizes[1:], strict=True)
    }
    arrays["discrepancy_probability"] = np.asarray(probabilities[sizes > 0].sum())
    return arrays


def _best_estimates(
    prepared: Calibration, posterior: Posterior, axes: list[Array], watch: Watch
) -> dict[str, Array]:
    model, sizes = prepared.model, posterior.likelihood.scatter.sizes
    size = float(np.sqrt(posterior.size_probabilities @ np.square(sizes)))
    # A discrepancy that is more probably absent does not count.
    if model.runs.errors_known and posterior.size_probabilities[0] > 0.5:
        size = 0.0
    modes = modes_of(posterior, axes)
    refined = np.array(
        [_refined_best(posterior.likelihood, mode.best, size, watch) for mode in modes]
    )
    likelihood = posterior.likelihood
    predicted = likelihood.model.predict(refined, Watch())
    log = likelihood.log(
        predicted.value, predicted.variance, likelihood.seen_fraction(predicted), refined
    )
    most_probable = refined[np.argmax(log_sum(log))]
    arrays: dict[str, Array] = {"mode_share": np.array([mode.share for mode in modes])}
    arrays |= {f"mode_{name}": refined[:, k] for k, name in enumerate(model.names)}
    arrays |= {f"best_{name}": most_probable[k] for k, name in enumerate(model.names)}
    return arrays


def _by_run(
    prepared: Calibration, posterior: Posterior, arrays: Mapping[str, Array]
) -> dict[str, Array]:
    # Measured and predicted value of each run, and its residual over the standard deviation of
    # both.
    model = prepared.model
    runs = model.runs
    best = np.array([[float(arrays[f"best_{name}"]) for name in model.names]])
    predicted = model.predict(best, Watch())
    bands = posterior.quantiles(posterior.value, SHARES)
    spread = np.sqrt(predicted.variance[0])
    residual = runs.value - predicted.value[0]
    deviation = np.sqrt(
        np.square(runs.error) + predicted.variance[0] + np.square(arrays["discrepancy"])
    )
    by_run: dict[str, Array] = {
        runs.output: runs.value,
        "error": np.where(runs.measured & (runs.error > 0), runs.error, np.nan),
        "predicted": posterior.mean(posterior.value),
        "predicted_best": predicted.value[0],
        **{f"predicted_{band}": bands[number] for number, band in enumerate(BANDS)},
        "predicted_spread": spread,
        "residual": residual,
        "residual_over_error": np.divide(
            residual, deviation, out=np.full(len(runs), np.nan), where=deviation > 0
        ),
    }
    if runs.watched.any():
        probability = np.full(len(runs), np.nan)
        probability[runs.watched] = posterior.mean(posterior.seen_fraction)
        by_run["probability_of_seen"] = probability
    return by_run


def _densities(prepared: Calibration, posterior: Posterior, axes: list[Array]) -> dict[str, Array]:
    # The density of each unknown, of pairs of them, and the joint density on a grid.
    names = prepared.model.names
    densities = {
        f"density_{name}": marginal_density(posterior, axes[position], position)
        for position, name in enumerate(names)
    }
    for first, second in prepared.pairs:
        first_axis, second_axis = names.index(first), names.index(second)
        densities[f"density_{first}_{second}"] = pair_density(
            posterior, axes, first_axis, second_axis
        )
    densities["log_density"] = log_density(posterior, axes)
    return densities


def _coordinates(
    prepared: Calibration, arrays: Mapping[str, NDArray[Any]]
) -> dict[str, TableVariable]:
    # Axes of the densities, numbers of runs and modes, columns of the runs, candidates, parameters.
    model = prepared.model
    coordinates = {
        unknown.name: TableVariable(
            (unknown.name,),
            arrays[unknown.name],
            {"units": unknown.unit, "long_name": unknown.label},
        )
        for unknown in model.unknowns
    }
    numbers = np.arange(1.0, len(model.runs) + 1.0)
    coordinates[RUN] = TableVariable((RUN,), numbers, {"units": "1", "long_name": "Run"})
    modes = np.arange(1.0, arrays["mode_share"].size + 1.0)
    coordinates[MODE] = TableVariable((MODE,), modes, {"units": "1", "long_name": "Mode"})
    for name, column in model.runs.columns.items():
        coordinates[name] = TableVariable((RUN,), column, quantity_attributes(name))
    if prepared.candidates is not None:
        for name in prepared.candidates.axes:
            values = prepared.candidates.coordinate(name)
            candidate = CANDIDATE + name
            coordinates[candidate] = TableVariable((candidate,), values, quantity_attributes(name))
        for name, paired in prepared.candidates.paired.items():
            coordinates[CANDIDATE + name] = TableVariable(
                (CANDIDATE + DESIGN,), paired.array(), quantity_attributes(name)
            )
    fixed_parameters = {
        parameter: number
        for parameter, number in model.shared.items()
        if parameter not in {unknown.name for unknown in model.unknowns}
    }
    for name, value in fixed_parameters.items():
        coordinates[name] = TableVariable((), np.asarray(value), quantity_attributes(name))
    return coordinates


KIND: Final = Kind(
    name="calibrate",
    title="Find parameters from measured speeds",
    description="Finds friction and other unknown parameters from measured speeds or observed "
    "behaviour, and the run that would add most.",
    model=CalibrateStudy,
    scenes=(SYSTEMS, UNITS),
    example={
        "kind": "calibrate",
        "scene": "rectangle-on-plane",
        "parameters": {"frequency": "50 Hz", "beta": 20},
        "observations": [
            {"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "1 mm/s"},
            {"amplitude": "0.3 mm", "conveying_velocity": "33 mm/s", "error": "1 mm/s"},
        ],
        "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
        "points": 1_000,
    },
    prepare=prepare,
    choose=lambda sketch: choose(sketch.scene, sketch.method, sketch.names),
    compute=compute,
    label=label,
)
