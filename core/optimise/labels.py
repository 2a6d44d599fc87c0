"""Labels of the optima: what was looked for in words, attributes of every variable, a message."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import (
    Table,
    TableVariable,
    flag_attributes,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.optimise.check import accuracy, verified
from vibrafeed.core.optimise.front import FLAT
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import Optimisation, criterion_in_words
from vibrafeed.core.optimise.problem import broken_names
from vibrafeed.core.optimise.slopes import sensitive
from vibrafeed.core.plan.labels import coordinates_of, global_attributes, link_to_verdict
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.statistics import INTERVAL, REPLICATES
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES, REGIMES, Flag
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.optimise_study import Pareto
from vibrafeed.core.watch import Watch

BINDS = {
    "free": Flag(0, "the constraint is not active"),
    "binds": Flag(1, "the constraint holds with equality"),
}
KNEE = {"point": Flag(0, "a point of the front"), "knee": Flag(1, "its knee")}


def label(prepared: Optimisation, computed: Computed, watch: Watch) -> Table:
    """Return the results of an optimisation as a table, verified if the study asks for it.

    `computed` has the arrays of all variables by name; `watch` may stop the verification.
    """
    arrays, dims = computed.arrays, tuple(prepared.grid.axes)
    attributes = _attributes(prepared, arrays)
    variables = {
        name: TableVariable(dims, arrays[name], attributes[name]) for name in prepared.units
    }
    dataset_attributes = {
        **_global_attributes(prepared),
        "message": _message(prepared, arrays),
        "accuracy": "; ".join((*_of_points(prepared), accuracy(arrays["optimum_gap"]))),
        "evaluations": float(arrays["evaluations"].sum()),
        **computed.notes,
        **verified(prepared, arrays, watch),
    }
    return Table(coordinates_of(prepared.plan, prepared.grid), variables, dataset_attributes)


def _attributes(
    prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]
) -> dict[str, dict[str, Any]]:
    """Return the attributes of every variable of an optimisation's result after CF, by name.

    They are units, long names, comments and meanings of codes; `arrays` has the values by name.
    """
    problem = prepared.problem
    sentence = criterion_in_words(problem)
    attributes: dict[str, dict[str, Any]] = {}
    for name in prepared.units:
        if name in QUANTITIES:
            attributes[name] = quantity_attributes(name, **link_to_verdict(prepared.plan, name))
    for name in problem.names:
        quantity = QUANTITIES[name]
        attributes[f"best_{name}"] = quantity_attributes(name) | {
            "long_name": f"Best {in_sentence(quantity.label)}"
        }
        for end, bound in (("lower", "lower"), ("upper", "upper")):
            attributes[f"binds_{name}_{end}"] = _binds(f"the {bound} bound of {name}")
    for kept in problem.kept:
        what = kept.name.replace("_", " ")
        attributes[f"margin_{kept.name}"] = {
            "units": QUANTITIES[kept.output].unit,
            "long_name": f"Margin of {what}",
            "comment": f"Distance of {kept.output} from its bound; 0 where it binds.",
        }
        attributes[f"binds_{kept.name}"] = _binds(what)
        if problem.uncertain is not None:
            attributes |= _broken(kept.name, what)
    output = problem.criterion.output
    attributes["objective"] |= {
        "units": QUANTITIES[output].unit,
        "comment": f"At the optimum: {sentence}.",
        "criterion": problem.criterion.kind,
        "output": output,
        **link_to_verdict(prepared.plan, output),
    }
    if "objective_error" in prepared.units:
        attributes["objective_error"] |= {"units": QUANTITIES[output].unit}
    if problem.is_sampled:
        attributes["objective"]["comment"] += " Over points that did not choose it."
        attributes["objective_error"]["comment"] = INTERVAL
    attributes["optimum_status"] = flag_attributes(
        "optimum_status", OPTIMUM_STATUSES, tuple(OPTIMUM_STATUSES)
    )
    if prepared.study.sensitivities:
        for name in sensitive(problem):
            label = QUANTITIES[name].label
            attributes[f"sensitivity_{name}"] = {
                "units": "1",
                "long_name": f"Sensitivity to {in_sentence(label)}",
                "comment": f"d ln({problem.criterion.output})/d ln({name}) at the optimum.",
            }
    if "knee" in prepared.units:
        attributes["knee"] = flag_attributes("knee", KNEE, tuple(KNEE))
    apart = len(prepared.plan.verdicts) > 1
    for verdict in prepared.plan.verdicts:
        names = {*verdict.regimes}
        if (arrays[verdict.name] == REGIMES["not_assessed"].value).any():
            names.add("not_assessed")
        judged = verdict.outputs if apart else ()
        attributes[verdict.name] = regime_attributes(tuple(names), judged)
    return attributes


def _of_points(prepared: Optimisation) -> Iterator[str]:
    """Yield at most one clause on the points at which optima under uncertainty are judged."""
    if prepared.problem.uncertain is not None:
        yield (
            "errors of mean, quantile and probabilities are half the widths of 95 % intervals, "
            f"from {REPLICATES} scramblings of Sobol points which the search did not use"
        )


def _broken(name: str, what: str) -> dict[str, dict[str, Any]]:
    """Return the attributes of the probability that a constraint is broken, and of its error.

    `name` is the constraint, `what` its name in words.
    """
    label = f"robability that {what} is broken"
    comments = (
        (f"P{label}", "Over all distributions; a unit without a value breaks it."),
        (f"Error of the p{label}", INTERVAL),
    )
    return {
        one: {"units": "1", "long_name": label, "comment": comment}
        for one, (label, comment) in zip(broken_names(name), comments, strict=True)
    }


def _binds(what: str) -> dict[str, Any]:
    """Return the attributes of the flag that says if a constraint binds."""
    return flag_attributes("optimum_status", BINDS, tuple(BINDS)) | {
        "long_name": f"Whether {what} binds"
    }


def _message(prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return the result of an optimisation in words, for the attribute `message` of the file.

    For one design these are its status, the best values and the constraints that bind; for several
    the number of designs of each status. `arrays` has the computed variables by name, among them
    ``optimum_status``, ``objective``, ``best_<variable>`` and ``binds_<constraint>``. `prepared` is
    the checked study.
    """
    by_value = {flag.value: (name, flag.description) for name, flag in OPTIMUM_STATUSES.items()}
    arrays = {name: values.ravel() for name, values in arrays.items()}
    if arrays["optimum_status"].size > 1:
        statuses, more = arrays["optimum_status"], ""
        if isinstance(prepared.study.criterion, Pareto):
            statuses, more = _of_fronts(prepared.study.criterion, arrays)
        counts = np.bincount(statuses, minlength=len(by_value))
        parts = [f"{by_value[v][0]} {n:,}" for v, n in enumerate(counts) if n]
        answers = "1 answer" if statuses.size == 1 else f"{statuses.size:,} answers"
        return f"of {answers}: {', '.join(parts)}{more}"
    name, description = by_value[int(arrays["optimum_status"][0])]
    text = f"{name}: {description}"
    if np.isnan(arrays["objective"][0]):
        return text
    clauses = [
        f"{n} = {arrays[f'best_{n}'][0]:.6g}{QUANTITIES[n].suffix}" for n in prepared.problem.names
    ]
    binding = [n.removeprefix("binds_") for n in arrays if n.startswith("binds_") and arrays[n][0]]
    tight = f"; binding: {', '.join(binding)}" if binding else "; nothing binds"
    return "; ".join((text, ", ".join(clauses) + tight, *_shares_broken(prepared, arrays)))


def _of_fronts(
    criterion: Pareto, arrays: Mapping[str, NDArray[Any]]
) -> tuple[NDArray[np.int8], str]:
    """Return the statuses of all distinct points of fronts, and a clause on designs without one.

    `arrays` has the computed variables by name, the points of a design one after the other.
    """
    known = {
        name: arrays[name].reshape(-1, criterion.points)
        for name in ("optimum_status", "front_points", criterion.output, criterion.against)
    }
    single = known["front_points"][:, 0] == 1
    status = known["optimum_status"]
    statuses = np.concatenate([status[single, 0], status[~single].ravel()])
    if not single.any():
        return statuses, ""
    other = np.abs(known[criterion.against][single, 0]).max()
    is_none = other <= FLAT * np.abs(known[criterion.output][single, 0]).max()
    reached = f"{criterion.against} = 0" if is_none else f"the least |{criterion.against}|"
    where = "" if single.size == 1 else f" in {single.sum():,} of {single.size:,} designs"
    return (
        statuses,
        f"; no trade-off{where}: {reached} is reached at the largest {criterion.output}",
    )


def _shares_broken(prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]) -> Iterator[str]:
    """Yield at most one clause on the shares of units that break limits, of one design."""
    if prepared.problem.uncertain is None or not prepared.problem.kept:
        return
    shares = {one.name: arrays[broken_names(one.name)[0]][0] for one in prepared.problem.kept}
    told = [f"{100 * share:.2g} % of units break {name}" for name, share in shares.items() if share]
    yield ", ".join(told) or "no unit of those drawn breaks a limit"


def _global_attributes(prepared: Optimisation) -> dict[str, str]:
    """Return the attributes of an optimisation's result: title, criterion in words, method.

    `prepared` is the checked study. The attributes head the file.
    """
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
