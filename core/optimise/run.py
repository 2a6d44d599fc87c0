"""Carrying out an optimisation: solve every design, check the answers, label them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.dataset.table import (
    Table,
    Variable,
    flag_attributes,
    quantity_attributes,
    regime_attributes,
)
from core.mechanics.arrays import Array
from core.optimise import known_answers
from core.optimise.codes import STATUS
from core.optimise.conditions import residual
from core.optimise.found import Found
from core.optimise.front import find_front, knee
from core.optimise.grid import dense_grid
from core.optimise.methods import METHODS
from core.optimise.prepare import Optimisation, prepare
from core.optimise.problem import LIMIT, ROUNDING, Problem, cells_of, chosen_cells
from core.optimise.single import spread
from core.optimise.slopes import sensitive, slopes
from core.optimise.verify import accuracy, verified
from core.plan.grid import Grid, from_si
from core.plan.labels import coordinates_of, global_attributes
from core.plan.pieces import Computed, carry_out
from core.quantities import OPTIMUM_STATUSES, QUANTITIES, REGIMES, Flag
from core.study.models import Limited, Pareto, Weighted
from core.watch import Watch

if TYPE_CHECKING:
    import xarray

    from core.study import OptimiseStudy

FORWARD = ("acceleration_x", "starting_acceleration", "conveying_velocity")
"""Outputs that are forward motion where they are positive."""

BLOCK_CELLS = 65_536  # answers at a time: bounds the memory
GAP_POINTS = 40_000  # of the grid that a design is compared with
GAP_POINTS_MOTION = 1_600
FLAT = 1e-14  # of the scale: what all choices differ by is rounding
MISSED = 1e-6  # a gap above this is more than a method leaves
AT_BOUND = 1e-9  # of a variable's range: it lies on its bound

BINDS = {
    "free": Flag(0, "the constraint leaves room"),
    "binds": Flag(1, "the constraint holds with equality"),
}
KNEE = {"point": Flag(0, "a point of the front"), "knee": Flag(1, "its knee")}


def optimise(study: OptimiseStudy, *, watch: Watch | None = None) -> xarray.Dataset:
    """Return the dataset of the optima of a study.

    Examples
    --------
    >>> from pathlib import Path
    >>> from core.optimise import optimise
    >>> from core.study import load_study
    >>> dataset = optimise(load_study(Path("configs/optimise-limit.toml")))
    """
    return tabulate(prepare(study), watch=watch).to_xarray()


def tabulate(prepared: Optimisation, *, watch: Watch | None = None) -> Table:
    """Return the labelled optima of a prepared study; `watch` may stop it early.

    Designs that are not finished then are NaN, with the status `not_computed`.
    """
    return carry_out(prepared, compute, label, watch)


def compute(prepared: Optimisation, watch: Watch) -> Computed:
    """Return every variable of the optima of a prepared study, in the units of studies."""
    everything = designs_of(prepared.problem, prepared.designs)
    cells = prepared.designs.cells
    step = max(1, BLOCK_CELLS * cells // prepared.cells)
    blocks, says = [], ""
    for start in range(0, cells, step):
        design = chosen_cells(everything, slice(start, start + step))
        block, says = _solved(prepared, design, watch.part(cells_of(design) / cells))
        blocks.append(block)
    shape = tuple(prepared.grid.shape.values())
    arrays = {
        name: np.concatenate([block[name] for block in blocks]).reshape(shape)
        for name in prepared.units
    }
    return Computed(arrays, {"method_message": says} if says else {})


def label(prepared: Optimisation, computed: Computed, watch: Watch) -> Table:
    """Return what was computed of an optimisation, labelled; `watch` may stop verifying it."""
    arrays, dims = computed.arrays, tuple(prepared.grid.axes)
    attributes = _attributes(prepared, arrays["regime"])
    variables = {name: Variable(dims, arrays[name], attributes[name]) for name in prepared.units}
    words = {
        **_global_attributes(prepared),
        "message": _message(prepared, arrays),
        "accuracy": accuracy(arrays["optimum_gap"]),
        "evaluations": float(arrays["evaluations"].sum()),
        **computed.notes,
        **verified(prepared, arrays, watch),
    }
    return Table(coordinates_of(prepared.plan, prepared.grid), variables, words)


def _solved(
    prepared: Optimisation, design: Mapping[str, Array], watch: Watch
) -> tuple[dict[str, NDArray[Any]], str]:
    """Return every variable of the result for some designs, and what the method says."""
    problem, method = prepared.problem, prepared.method
    scales = problem.scales(design)
    if isinstance(problem.criterion, Pareto):
        found = find_front(problem, design, scales, method, watch)
        points = problem.criterion.points
        design = {name: np.repeat(values, points) for name, values in design.items()}
        scales = {name: np.repeat(values, points) for name, values in scales.items()}
    else:
        found = METHODS[method].solve(problem, design, scales, watch)
    return _checked(prepared, found, design, scales), found.says


def designs_of(problem: Problem, grid: Grid) -> dict[str, Array]:
    """Return the fixed parameters of every design, and the limit; arrays of shape (cells,)."""
    shape = tuple(grid.shape.values())
    design = {
        name: np.broadcast_to(values, shape).reshape(-1) for name, values in grid.si().items()
    }
    return with_limit(problem, design, grid.cells)


def with_limit(problem: Problem, design: Mapping[str, Array], cells: int) -> dict[str, Array]:
    """Return designs, arrays of shape (cells,), with the limit that the study sets."""
    criterion = problem.criterion
    limit = criterion.limit if isinstance(criterion, Limited) else np.inf
    return {**design, LIMIT: np.full(cells, limit)}


def _checked(
    prepared: Optimisation,
    found: Found,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> dict[str, NDArray[Any]]:
    """Return every variable of the result, in the units of studies; arrays of shape (cells,)."""
    problem, tolerance = prepared.problem, METHODS[prepared.method].tolerance
    cells = found.status.shape
    lost: NDArray[np.bool_] = np.asarray(np.isnan(found.x).any(axis=0))
    # Without an optimum the outputs are those of the lower bounds, and left out below.
    x = np.where(lost, problem.lower[:, None], found.x)
    known = problem.known(x, design)
    size = problem.scale(scales)

    def whole(values: Array) -> Array:
        return np.where(lost, np.nan, np.broadcast_to(values, cells))

    value = whole(problem.objective(known))
    if problem.uncertain is not None:
        value = whole(problem.judged(x, design, scales)[0])
    if found.value is not None:
        # At the edge of stick the outputs are those of a part at rest.
        held = found.status == STATUS["not_attained"]
        value = np.where(held, found.value, value)
    status = _status(problem, found.status, known, design, scales)
    arrays: dict[str, NDArray[Any]] = {
        f"best_{name}": from_si(name, found.x[i]) for i, name in enumerate(problem.names)
    }
    arrays["objective"] = problem.sign * value
    for name in prepared.units:
        if name in known:
            arrays[name] = whole(problem.output(name, known))
    for kept in problem.kept:
        margin = whole(problem.safe_margin(kept, x, design))
        binds = np.abs(margin) <= tolerance * scales[kept.output]
        arrays[f"margin_{kept.name}"] = np.where(binds, 0.0, margin)
        arrays[f"binds_{kept.name}"] = binds.astype(np.int8)
    span = problem.upper - problem.lower
    for i, name in enumerate(problem.names):
        for end, bound in (("lower", problem.lower[i]), ("upper", problem.upper[i])):
            at = (np.abs(x[i] - bound) <= max(tolerance, AT_BOUND) * span[i]) & ~lost
            arrays[f"binds_{name}_{end}"] = at.astype(np.int8)
    here, near = _of_each_point(problem, known, design)
    left = found.residual
    if left is None:
        left = residual(here, x, near, scales, max(tolerance, AT_BOUND))
    else:
        left = left / size
    # A worst case has kinks of its own: first-order conditions of one value do not speak of it.
    no_slope = lost | (problem.uncertain is not None)
    arrays["optimality_residual"] = np.where(no_slope, np.nan, left)
    gap = _gap(prepared.method, here, value, lost, near, scales) / size
    arrays["optimum_gap"] = gap
    missed = (status == STATUS["optimal"]) & (gap > max(tolerance, MISSED))
    status = np.where(missed, np.int8(STATUS["suboptimal"]), status)
    arrays["evaluations"] = np.broadcast_to(np.asarray(found.evaluations, np.float64), cells)
    if isinstance(problem.criterion, Pareto):
        points = problem.criterion.points
        pair = (arrays[problem.criterion.output], arrays[problem.criterion.against])
        arrays["knee"] = knee(*(part.reshape(-1, points) for part in pair)).ravel()
    if prepared.study.sensitivities:
        told = slopes(problem, x, design, lost)
        arrays |= {f"sensitivity_{name}": values for name, values in told.items()}
    arrays["optimum_status"] = status
    regime = np.broadcast_to(problem.regime(known, scales, tolerance), cells)
    none = np.int8(REGIMES["not_assessed"].value)
    arrays["regime"] = np.where(lost, none, regime)
    return arrays


def _status(
    problem: Problem,
    status: NDArray[np.int8],
    known: Mapping[str, Any],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> NDArray[np.int8]:
    """Return the statuses, with what a method that knows no physics cannot tell."""
    optimal = status == STATUS["optimal"]
    output = problem.criterion.output
    if problem.sign > 0 and output in FORWARD:
        rests = ~(np.broadcast_to(problem.output(output, dict(known)), status.shape) > 0)
        status = np.where(optimal & rests, STATUS["no_motion"], status)
    if np.any(optimal) and not problem.is_motion:
        lower, upper = problem.lower[:, None, None], problem.upper[:, None, None]
        x = lower + (upper - lower) * spread(16, len(problem.names))[:, None, :]
        column = {name: values[:, None] for name, values in design.items()}
        values = problem.objective(problem.known(x, column))
        values = np.broadcast_to(values, (status.size, 16))
        best = np.broadcast_to(problem.objective(dict(known)), status.shape)
        apart = np.maximum(values.max(axis=1), best) - np.minimum(values.min(axis=1), best)
        flat = apart <= FLAT * problem.scale(scales)
        status = np.where(optimal & flat & (status == STATUS["optimal"]), STATUS["flat"], status)
    return np.asarray(status, dtype=np.int8)


def _of_each_point(
    problem: Problem, known: Mapping[str, Any], design: Mapping[str, Array]
) -> tuple[Problem, Mapping[str, Array]]:
    """Return the problem that each answer solves: on a front, with the limit at its own value."""
    if not isinstance(problem.criterion, Pareto):
        return problem, design
    other = np.abs(problem.output(problem.criterion.against, dict(known)))
    return problem.limited(), {**design, LIMIT: np.broadcast_to(other, design[LIMIT].shape)}


def _gap(
    method: str,
    problem: Problem,
    value: Array,
    lost: NDArray[np.bool_],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> Array:
    """Return the objective of another answer less the one found; NaN without either."""
    if LIMIT in (kept.name for kept in problem.kept) and problem.against:
        # A limit of nothing, which rounding may just break, would leave no answer.
        design = {**design, LIMIT: design[LIMIT] + ROUNDING * scales[problem.against]}
    reference = np.full(lost.shape, np.nan)
    if method != "exact" and known_answers.is_closed(problem):
        answer = known_answers.by_closed_form(problem, design)
        reference = np.asarray(answer.value)
    elif method != "newton" and known_answers.is_compiled(problem):
        answer = known_answers.by_newton(problem, design)
        reference = np.asarray(answer.value)
    rest = np.flatnonzero(np.isnan(reference) & ~lost)
    if rest.size:
        points = GAP_POINTS_MOTION if problem.is_motion else GAP_POINTS
        best = dense_grid(problem, chosen_cells(design, rest), chosen_cells(scales, rest), points)
        reference[rest] = np.where(np.isfinite(best), best, np.nan)
    return np.where(lost, np.nan, reference - value)


# --- labels


def criterion_in_words(problem: Problem) -> str:
    """Return what is looked for, in a few words."""
    return _looked_for(problem) + _over_interval(problem)


def _over_interval(problem: Problem) -> str:
    if problem.uncertain is None:
        return ""
    name = problem.uncertain.name
    ends = (problem.uncertain.lower, problem.uncertain.upper)
    lower, upper = (float(from_si(name, np.asarray(end))) for end in ends)
    how = "in the worst case" if problem.robust == "worst" else "on average"
    unit = QUANTITIES[name].unit
    return f", {how} over {name} from {lower:g} to {upper:g}{'' if unit == '1' else f' {unit}'}"


def _looked_for(problem: Problem) -> str:
    criterion = problem.criterion
    output, against = criterion.output, problem.against
    if isinstance(criterion, Weighted):
        return f"largest {output} - {criterion.weight:g} |{against}|"
    if isinstance(criterion, Limited):
        unit = QUANTITIES[criterion.against].unit
        return f"largest {output} with |{against}| <= {criterion.limit:g} {unit}"
    if isinstance(criterion, Pareto):
        return f"{output} high, |{against}| low: the whole front"
    return f"{'least' if problem.sign < 0 else 'largest'} {output}"


def _attributes(prepared: Optimisation, regimes: NDArray[np.int8]) -> dict[str, dict[str, Any]]:
    """Return the CF attributes of every variable."""
    problem = prepared.problem
    words = criterion_in_words(problem)
    attributes: dict[str, dict[str, Any]] = {}
    for name in prepared.units:
        if name in QUANTITIES:
            attributes[name] = quantity_attributes(name)
    for name in problem.names:
        quantity = QUANTITIES[name]
        attributes[f"best_{name}"] = quantity_attributes(name) | {
            "long_name": f"Best {quantity.label[0].lower()}{quantity.label[1:]}"
        }
        for end, bound in (("lower", "lower"), ("upper", "upper")):
            attributes[f"binds_{name}_{end}"] = _binds(f"the {bound} bound of {name}")
    for kept in problem.kept:
        what = kept.name.replace("_", " ")
        attributes[f"margin_{kept.name}"] = {
            "units": QUANTITIES[kept.output].unit,
            "long_name": f"Margin of {what}",
            "comment": f"How far {kept.output} is from its bound; 0 where it binds.",
        }
        attributes[f"binds_{kept.name}"] = _binds(what)
    output = problem.criterion.output
    attributes["objective"] |= {
        "units": QUANTITIES[output].unit,
        "comment": f"At the optimum: {words}.",
        "criterion": problem.criterion.kind,
        "output": output,
    }
    attributes["optimum_status"] = flag_attributes(
        "optimum_status", OPTIMUM_STATUSES, tuple(OPTIMUM_STATUSES)
    )
    if prepared.study.sensitivities:
        for name in sensitive(problem):
            label = QUANTITIES[name].label
            attributes[f"sensitivity_{name}"] = {
                "units": "1",
                "long_name": f"Sensitivity to {label[0].lower()}{label[1:]}",
                "comment": f"d ln({problem.criterion.output})/d ln({name}) at the optimum.",
            }
    if "knee" in prepared.units:
        attributes["knee"] = flag_attributes("knee", KNEE, tuple(KNEE))
    names = set(prepared.plan.regimes)
    if (regimes == REGIMES["not_assessed"].value).any():
        names.add("not_assessed")
    attributes["regime"] = regime_attributes(tuple(names))
    return attributes


def _binds(what: str) -> dict[str, Any]:
    return flag_attributes("optimum_status", BINDS, tuple(BINDS)) | {
        "long_name": f"Whether {what} binds"
    }


def _message(prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return what came out, in plain words."""
    by_value = {flag.value: (name, flag.description) for name, flag in OPTIMUM_STATUSES.items()}
    arrays = {name: values.ravel() for name, values in arrays.items()}
    counts = np.bincount(arrays["optimum_status"], minlength=len(by_value))
    if arrays["optimum_status"].size > 1:
        parts = [f"{by_value[v][0]} {n:,}" for v, n in enumerate(counts) if n]
        return f"of {arrays['optimum_status'].size:,} answers: {', '.join(parts)}"
    name, description = by_value[int(arrays["optimum_status"][0])]
    text = f"{name}: {description}"
    if np.isnan(arrays["objective"][0]):
        return text
    found = [
        f"{n} = {arrays[f'best_{n}'][0]:.6g} {QUANTITIES[n].unit}" for n in prepared.problem.names
    ]
    binding = [n.removeprefix("binds_") for n in arrays if n.startswith("binds_") and arrays[n][0]]
    tight = f"; binding: {', '.join(binding)}" if binding else "; nothing binds"
    return f"{text}; {', '.join(found)}{tight}"


def _global_attributes(prepared: Optimisation) -> dict[str, str]:
    study, plan = prepared.study, prepared.plan
    method, words = METHODS[prepared.method], criterion_in_words(prepared.problem)
    attributes = {
        **global_attributes(prepared, f"optimisation, {method.says}"),
        "title": study.title or f"{plan.scene.title}: {words}",
        "criterion": words,
        "method": prepared.method,
    }
    if plan.scene.choice == "method":  # that of the motion; `method` is the optimiser's
        attributes["motion_method"] = plan.variant
    return attributes


__all__ = ["optimise", "tabulate"]
