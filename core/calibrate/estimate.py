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
    ENSEMBLE,
    LEFT,
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
    marginal,
    modes_of,
    pair,
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


def _polished(likelihood: Likelihood, start: Array, size: float, watch: Watch) -> Array:
    # The best point near `start`, or `start`, by the sum of squares of the residuals of the
    # measured runs over their standard deviations, `size` that of the discrepancy, and of the
    # distances from the prior means. Points are values of the unknowns, in the units of studies.
    model = likelihood.model
    where, quiet = model.runs.measured, Watch(stop=watch.stop, deadline=watch.deadline)
    if not where.any():
        return start

    def residuals(shares: Array) -> Array:
        points = model.lower + shares * model.width
        found = model.predict(points, quiet)
        residual = found.value[:, where] - model.runs.value[where]
        variance = found.variance[:, where] + np.square(model.runs.error[where]) + np.square(size)
        variance = np.where(variance > 0, variance, 1.0)
        over = np.nan_to_num(residual / np.sqrt(variance), nan=FAR)
        over = np.copysign(np.sqrt(likelihood.penalty(np.square(over))), over)
        before = [one.deviations_from_mean(points[:, k]) for k, one in enumerate(model.unknowns)]
        return np.concatenate([over, np.stack(before, axis=1)], axis=1)

    share = np.clip((start - model.lower) / model.width, 1e-9, 1.0 - 1e-9)
    before = residuals(share[np.newaxis])[0]
    optimum = scipy.optimize.least_squares(
        lambda x: residuals(x[np.newaxis])[0],
        share,
        jac=lambda share: jacobian(residuals, share, STEP).T,
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


SHARES = (0.16, 0.84, 0.025, 0.975)
"""Of the mass below the ends of the intervals of `BANDS`: both tails are equal."""


def compute(prepared: Calibration, watch: Watch) -> Computed:
    """Carry out a calibration and return every variable of its result, in the units of studies.

    It explores the posterior of the unknowns on an adaptive grid, refines the best values, and
    estimates what further runs would add if candidates are given. Raises `StoppedError` if `watch`
    stops it.
    """
    points = prepared.study.points
    share = points * len(prepared.model.runs) / prepared.cells
    likelihood = prepared.likelihood
    explored = explore(likelihood, points, watch.part(share))
    posterior = posterior_of(likelihood, explored)
    axes = axes_of(posterior)
    arrays = _summary_statistics(prepared, posterior)
    arrays |= _best(prepared, posterior, axes, watch)
    arrays |= _by_run(prepared, posterior, arrays)
    arrays |= _densities(prepared, posterior, axes)
    if prepared.candidates is not None:
        grid = prepared.candidates
        found = information(prepared.model, posterior, grid, watch.part(1.0 - share))
        shape = tuple(grid.shape.values())
        names = ("information", "expected", "expected_deviation")
        *densities, left = found
        arrays |= {name: v.reshape(shape) for name, v in zip(names, densities, strict=True)}
        for name, share in zip(prepared.model.names, left, strict=True):
            arrays[f"{LEFT}{name}"] = (share * arrays[f"deviation_{name}"]).reshape(shape)
    axis = dict(zip(prepared.model.names, axes, strict=True))
    misfit = _misfit(prepared, arrays, replace(watch, progress=None))
    notes = {
        "findings": Findings(prepared, posterior, arrays | axis, misfit).text(),
        FOLLOWED: f"{explored.points * len(prepared.model.runs) + prepared.asked}",
    }
    return Computed({name: np.asarray(v) for name, v in (arrays | axis).items()}, notes)


def label(prepared: Calibration, computed: Computed, _: Watch) -> Table:
    """Return the result of a calibration as a table: arrays with dimensions, units and attributes.

    `computed` has the arrays and notes that `compute` returned for the study `prepared`. Nothing is
    verified, so that the watch, which other kinds of study need here, is not used.
    """
    model, arrays = prepared.model, computed.arrays
    variables = {
        name: TableVariable(one.dims, arrays[name], one.attributes)
        for name, one in prepared.variables.items()
    }
    dataset_attributes = {
        **global_attributes(prepared, f"calibration, method {prepared.plan.variant}"),
        "title": prepared.study.title
        or f"What {len(model.runs)} runs say about "
        + ", ".join(one.label.lower() for one in model.unknowns),
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


def _misfit(
    prepared: Calibration, arrays: Mapping[str, Array], watch: Watch
) -> tuple[int, float, Posterior] | None:
    # The number of the run with the largest residual, its distance from the value that the other
    # runs give, and the posterior without it; None if it fits.
    model, likelihood = prepared.model, prepared.likelihood
    over = np.abs(np.nan_to_num(arrays["residual_over_error"]))
    run = int(over.argmax())
    if over[run] < SUSPECT or model.runs.measured.sum() < len(model.unknowns) + 2:
        return None
    others = replace(model, runs=model.runs.without(run))
    scatter = Scatter.of(others, wanted=prepared.study.discrepancy)
    likelihood = replace(likelihood, model=others, scatter=scatter)
    points = max(prepared.study.points // FEWER, FEWEST_POINTS)
    columns = {name: column[[run]] for name, column in model.runs.columns.items()}
    try:
        posterior = posterior_of(likelihood, explore(likelihood, points, watch))
        found = others.predict(posterior.ensemble(ENSEMBLE), watch, columns)
    except StoppedError:  # the estimates of all runs are there
        return None
    values = found.value[np.isfinite(found.value)]
    if not values.size:
        return None
    scatter = posterior.likelihood.scatter
    spread = values.var() + found.variance.mean() + model.runs.error[run] ** 2
    spread += posterior.sizes @ np.square(scatter.sizes)
    away = float(np.abs(model.runs.value[run] - values.mean()) / np.sqrt(spread))
    return (run + 1, away, posterior) if away > DISTANT else None


def _summary_statistics(prepared: Calibration, posterior: Posterior) -> dict[str, Array]:
    model, arrays = prepared.model, dict[str, Array]()
    points = posterior.points
    quantiles = posterior.quantiles(points, (0.5, *SHARES))
    covariance = posterior.covariance()
    deviations = np.sqrt(np.diag(covariance))
    for k, one in enumerate(model.unknowns):
        arrays[f"mean_{one.name}"] = posterior.mean(points)[k]
        arrays[f"median_{one.name}"] = quantiles[0, k]
        arrays[f"deviation_{one.name}"] = deviations[k]
        arrays |= {f"{b}_{one.name}": quantiles[1 + n, k] for n, b in enumerate(BANDS)}
    for j, k in combinations(range(len(model.unknowns)), 2):
        both = deviations[j] * deviations[k]
        name = f"correlation_{model.names[j]}_{model.names[k]}"
        arrays[name] = np.asarray(covariance[j, k] / both if both > 0 else 0.0)
    sizes, likely = posterior.likelihood.scatter.sizes, posterior.sizes
    below = np.cumsum(likely) - 0.5 * likely
    # All the mass that lies on 0 does so, and none of it just above.
    ends = [
        0.0 if sizes[0] == 0.0 and share <= likely[0] else np.interp(share, below, sizes)
        for share in (0.5, *SHARES)
    ]
    arrays["discrepancy"] = np.asarray(ends[0])
    arrays |= {f"discrepancy_{b}": np.asarray(end) for b, end in zip(BANDS, ends[1:], strict=True)}
    arrays["discrepancy_probability"] = np.asarray(likely[sizes > 0].sum())
    return arrays


def _best(
    prepared: Calibration, posterior: Posterior, axes: list[Array], watch: Watch
) -> dict[str, Array]:
    model, sizes = prepared.model, posterior.likelihood.scatter.sizes
    size = float(np.sqrt(posterior.sizes @ np.square(sizes)))
    if model.runs.errors_known and posterior.sizes[0] > 0.5:
        size = 0.0
    modes = modes_of(posterior, axes)
    polished = np.array([_polished(posterior.likelihood, mode.best, size, watch) for mode in modes])
    likelihood = posterior.likelihood
    found = likelihood.model.predict(polished, Watch())
    log = likelihood.log(found.value, found.variance, likelihood.shown(found), polished)
    likely = polished[np.argmax(log_sum(log))]
    arrays: dict[str, Array] = {"mode_share": np.array([mode.share for mode in modes])}
    arrays |= {f"mode_{name}": polished[:, k] for k, name in enumerate(model.names)}
    arrays |= {f"best_{name}": likely[k] for k, name in enumerate(model.names)}
    return arrays


def _by_run(
    prepared: Calibration, posterior: Posterior, arrays: Mapping[str, Array]
) -> dict[str, Array]:
    model = prepared.model
    runs = model.runs
    best = np.array([[float(arrays[f"best_{name}"]) for name in model.names]])
    predicted = model.predict(best, Watch())
    bands = posterior.quantiles(posterior.value, SHARES)
    spread = np.sqrt(predicted.variance[0])
    residual = runs.value - predicted.value[0]
    whole = np.sqrt(
        np.square(runs.error) + predicted.variance[0] + np.square(arrays["discrepancy"])
    )
    by_run: dict[str, Array] = {
        runs.output: runs.value,
        "error": np.where(runs.measured & (runs.error > 0), runs.error, np.nan),
        "predicted": posterior.mean(posterior.value),
        "predicted_best": predicted.value[0],
        **{f"predicted_{band}": bands[n] for n, band in enumerate(BANDS)},
        "predicted_spread": spread,
        "residual": residual,
        "residual_over_error": np.divide(
            residual, whole, out=np.full(len(runs), np.nan), where=whole > 0
        ),
    }
    if runs.watched.any():
        seen = np.full(len(runs), np.nan)
        seen[runs.watched] = posterior.mean(posterior.shown)
        by_run["probability_of_seen"] = seen
    return by_run


def _densities(prepared: Calibration, posterior: Posterior, axes: list[Array]) -> dict[str, Array]:
    names = prepared.model.names
    densities = {f"density_{name}": marginal(posterior, axes[k], k) for k, name in enumerate(names)}
    for one, other in prepared.pairs:
        j, k = names.index(one), names.index(other)
        densities[f"density_{one}_{other}"] = pair(posterior, axes, j, k)
    densities["log_density"] = log_density(posterior, axes)
    return densities


def _coordinates(
    prepared: Calibration, arrays: Mapping[str, NDArray[Any]]
) -> dict[str, TableVariable]:
    model = prepared.model
    coordinates = {
        one.name: TableVariable(
            (one.name,), arrays[one.name], {"units": one.unit, "long_name": one.label}
        )
        for one in model.unknowns
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
            key = CANDIDATE + name
            coordinates[key] = TableVariable((key,), values, quantity_attributes(name))
        for name, paired in prepared.candidates.paired.items():
            coordinates[CANDIDATE + name] = TableVariable(
                (CANDIDATE + DESIGN,), paired.array(), quantity_attributes(name)
            )
    known = {n: v for n, v in model.shared.items() if n not in {u.name for u in model.unknowns}}
    for name, value in known.items():
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
