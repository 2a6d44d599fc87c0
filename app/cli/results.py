"""The result of a study: for a person, and as a document for programs."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.app.cli.by_kind import (
    format_value,
    has_status,
    is_short,
    is_uncertain,
    list_choice,
    show_design,
    show_findings,
)
from vibrafeed.app.cli.console import fail, say, table, tell
from vibrafeed.app.cli.units import DIGITS, shown_range, units_asked
from vibrafeed.core.dataset.bands import (
    ENDS,
    band_widths,
    known_between,
    rounded,
    sentences_on_bands,
)
from vibrafeed.core.dataset.table import flags_of, judge_of, percent, regime_shares
from vibrafeed.core.intake import parse_json
from vibrafeed.core.kinds import is_whole, not_verified, share_left_out
from vibrafeed.core.motion.feeding import travel_in_words
from vibrafeed.core.quantities import QUANTITIES, REGIMES, STATUSES
from vibrafeed.core.quantities.flags import REGIME, is_regime
from vibrafeed.core.quantities.motion import OF_THE_SEARCH
from vibrafeed.core.study.distributions import nominal

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table, TableVariable
    from vibrafeed.core.plan.prepared import Prepared
    from vibrafeed.core.study.shown import ShownUnits

Ends = tuple[float, float] | None
_CHOICE = re.compile(r"\w+ = ")


def facts_of(path: Path, target: str, result: Table, cells: int) -> dict[str, Any]:
    """Return the result of a study as a JSON document; values in the units of files.

    Parameters
    ----------
    path : Path
        The study's file.
    target : str
        The path or URL of the result.
    result : Table
        The result.
    cells : int
        Number of cells of the study.
    """
    verdicts = (name for name in result.variables if is_regime(name))
    shares = {name: regime_shares(_regimes_computed(result, name)) for name in verdicts}
    facts: dict[str, Any] = {
        "study": str(path),
        "result": target,
        "scene": result.attributes["scene"],
        "cells": cells,
        "cells_computed": cells - round(cells * share_left_out(result)),
        "whole": is_whole(result),
        "outputs": {name: _output_facts(result, name) for name in _outputs(result)},
        "regimes": shares.get(REGIME, {}),
        "verdicts": shares,
        "states": _states(result),
    }
    for name in ("criterion", "method", "message", "findings"):
        if name in result.attributes:
            facts[name] = result.attributes[name]
    if "verified_worst" in result.attributes:
        facts["verified"] = {
            "cells": int(result.attributes["verified_cells"]),
            "against": str(result.attributes["verified_against"]),
            "worst": str(result.attributes["verified_worst"]),
            "not_verified": not_verified(result),
        }
    return facts


def _output_facts(result: Table, name: str) -> dict[str, Any]:
    variable = result.variables[name]
    facts = {"unit": str(variable.attributes["units"]), "dimensions": [*variable.dims]}
    verdict = judge_of(variable.attributes, result.variables)
    if verdict is not None:
        facts["verdict"] = verdict
    least, largest = _finite_ends(result, name) or (None, None)
    is_single = variable.values.size == 1
    return {**facts, **({"value": least} if is_single else {"least": least, "largest": largest})}


def show_result(
    facts: Mapping[str, Any], result: Table, units_option: str | None, *, everything: bool = False
) -> None:
    """Print a short table of a result: values or ranges, regimes, and what was verified.

    Parameters
    ----------
    facts : mapping
        The JSON document of the result.
    result : Table
        The result.
    units_option : str or None
        The text of `--units`, if given.
    everything : bool
        True to print the outputs that describe the search of an optimum, too.
    """
    units = units_asked(units_option, str(result.attributes.get("shown_units", "")))
    if "findings" in result.attributes:
        show_findings(result, units)
        return
    # Without a feasible cell it would be a table of dashes.
    if result.variables and not has_status(result, "infeasible"):
        _show_values(facts, result, units, everything=everything)
    if "message" in facts:
        say(f"  {facts['criterion']}, method {facts['method']}")
        # The choice itself stands in the table, in the units asked for.
        parts = [part for part in facts["message"].split("; ") if not _CHOICE.match(part)]
        tell(f"  {'; '.join(parts)}")
    if held_at := _intervals_held_at(result, units):
        say(f"  {held_at}")
    for line in sentences_on_bands(result):
        tell(f"  {line}")
    if backwards := travel_in_words(result):
        say(f"  {backwards}")
    if knee := _knee(result, units):
        tell(f"  {knee}")
    if fastest := _fastest(result, units):
        tell(f"  {fastest}")
    _show_verified(result)
    missing = facts["cells"] - facts["cells_computed"]
    if missing:
        fail(
            f"  The run was stopped: {facts['cells_computed']:,} of {facts['cells']:,} cells are "
            f"computed. In {facts['result']} the other {missing:,} are not computed, and marked so."
        )
    elif not facts["whole"]:
        fail("  The run was stopped: all cells are computed, but not all requested ones verified.")


def _show_values(
    facts: Mapping[str, Any], result: Table, units: ShownUnits, *, everything: bool
) -> None:
    """Print values or ranges of all outputs, and the shares of the statuses and regimes.

    Parameters
    ----------
    facts, result : mapping, Table
        The JSON document of the result, and the result.
    units : ShownUnits
        Units for printing.
    everything : bool
        True to print the outputs that describe the search of an optimum, too.
    """
    outputs = facts["outputs"]
    if not everything:
        hidden = set(OF_THE_SEARCH)
        if "objective_left_out" in outputs:  # a statistic over points, which has an error
            hidden.remove("objective_error")
        outputs = {name: output for name, output in outputs.items() if name not in hidden}
    if is_uncertain(result):
        outputs = {name: output for name, output in outputs.items() if is_short(name)}
    if is_uncertain(result) and facts["cells"] == 1:
        show_design(result, units)
    else:
        _show_outputs(outputs, result, units)
    banded = " speeds those that their band leaves;" if band_widths(result) else ""
    say(f"  Values have {DIGITS} digits, or as many as separate them;{banded} the file has all.")
    for name, states in facts["states"].items():
        if name != "knee":  # a share of points says nothing
            tell(f"  {name}: {_in_words(states, facts['cells'])}")
    for verdict, shares in facts["verdicts"].items():
        judged = [name for name, output in outputs.items() if output.get("verdict") == verdict]
        named = judged if len(facts["verdicts"]) > 1 else ()
        _show_regimes(shares, facts["cells"], "variant" in result.attributes, named)


def _intervals_held_at(result: Table, units: ShownUnits) -> str:
    """Return a sentence: the outputs of a robust optimum hold at the middles of the intervals.

    An optimisation with uncertain parameters, given as intervals, finds the design that is best
    over the whole range, while the outputs in the result are computed at the middle of each
    interval. Other results give an empty text.
    """
    if "optimum_status" not in result.variables:
        return ""
    from vibrafeed.core.study.optimise_study import OptimiseStudy

    study = parse_json(str(result.attributes["study"]))
    if not isinstance(study, OptimiseStudy) or not study.intervals():
        return ""
    middles = {name: nominal(interval) for name, interval in study.intervals().items()}
    return (
        f"Outputs are those at {list_choice(middles, units)}; the objective, the margins of limits "
        "and the shares of units that break them count all that is uncertain."
    )


def _knee(result: Table, units: ShownUnits) -> str:
    """Return a sentence on the knee of a trade-off front: outputs and choice; empty if none.

    The knee is the point of a Pareto front that is farthest from the chord between its ends.
    """
    knee = result.variables.get("knee")
    if knee is None or np.count_nonzero(knee.values) != 1:
        return ""
    from vibrafeed.core.study.optimise_study import OptimiseStudy, Pareto

    index = int(np.argmax(knee.values))
    study = parse_json(str(result.attributes["study"]))
    if not isinstance(study, OptimiseStudy) or not isinstance(study.criterion, Pareto):
        return ""
    values = {
        name: float(variable.values.ravel()[index])
        for name, variable in result.variables.items()
        if variable.dims == knee.dims
    }
    criteria = {name: values[name] for name in (study.criterion.output, study.criterion.against)}
    if not np.isfinite([*criteria.values()]).all():
        return ""
    choice = {  # also the angles that a study without variables leaves to the program
        name.removeprefix("best_"): value
        for name, value in values.items()
        if name.startswith("best_")
    }
    title = "No trade-off: the best" if values["front_points"] == 1 else "Knee of the front"
    return f"{title}: {list_choice(criteria, units)}, at {list_choice(choice, units)}."


def _fastest(result: Table, units: ShownUnits) -> str:
    """Return a sentence on the cell with the largest conveying velocity, and its parameters.

    It is empty for a single cell, for optimisations, and for results without a positive velocity.
    """
    speed = result.variables.get("conveying_velocity")
    if speed is None or speed.values.size < 2 or "motion_status" not in result.variables:
        return ""
    if "optimum_status" in result.variables or not (np.nan_to_num(speed.values) > 0).any():
        return ""
    index = np.unravel_index(np.nanargmax(speed.values), speed.values.shape)
    place = ", ".join(
        f"{name} {format_value(name, float(result.coordinates[name].values[position]), units)}"
        for name, position in zip(speed.dims, index, strict=True)
        if name in QUANTITIES and result.coordinates[name].values.ndim
    )
    fastest = speed.values[index]
    text = format_value("conveying_velocity", float(fastest), units)
    if width := band_widths(result).get("conveying_velocity"):
        shown = units.of("m s-1", float(abs(fastest)))
        text = f"{rounded(shown.factor * fastest, shown.factor * width)} {shown.unit}"
    return f"Fastest: {text} at {place}." if place else ""


def _regimes_computed(result: Table, verdict: str) -> NDArray[Any]:
    """Return the regimes (flag values) of the computed cells of a result, without the others.

    Cells that a stop has left out have a status that says so; their regime counts for nothing.
    """
    regime = result.variables[verdict]
    for name, not_computed in STATUSES.items():
        status = result.variables.get(name)
        if status is not None and status.dims == regime.dims:
            return regime.values[status.values != not_computed]
    return regime.values


def _outputs(result: Table) -> dict[str, TableVariable]:
    variables = result.variables.items()
    return {name: column for name, column in variables if "flag_values" not in column.attributes}


def _show_outputs(
    outputs: Mapping[str, Mapping[str, Any]], result: Table, units: ShownUnits
) -> None:
    """Print a table of outputs: one value each for a single design, else their ranges."""
    friction_range, widths = known_between(result.coordinates), band_widths(result)
    if all("value" in column for column in outputs.values()):
        _show_single(outputs, friction_range, units)
        return
    ranges = []
    for name, column in outputs.items():
        pair = (column["value"],) * 2 if "value" in column else (column["least"], column["largest"])
        unit, least, largest = shown_range(column["unit"], *pair, units)
        if name in widths and None not in pair:
            factor = units.of(column["unit"], max(map(abs, pair))).factor
            least, largest = (rounded(factor * end, factor * widths[name]) for end in pair)
        dimensions = ", ".join(column["dimensions"]) or "none"
        ranges.append((name, least, largest, unit, dimensions))
    table(("output", "least", "largest", "unit", "dimensions"), ranges)


def _show_single(
    outputs: Mapping[str, Mapping[str, Any]], friction_range: str, units: ShownUnits
) -> None:
    """Print a table of the outputs of a single design; with a range of friction, their bands."""
    rows, band_ends = [], {f"{name}_{end}" for name in outputs for end in ENDS}
    for name, column in outputs.items():
        if name in band_ends:  # it is printed beside its output
            continue
        band = [outputs[f"{name}_{end}"]["value"] for end in ENDS if f"{name}_{end}" in outputs]
        unit, value, _ = shown_range(column["unit"], column["value"], column["value"], units)
        band_text = ""
        if band and None not in band and column["value"] is not None:
            factor = units.of(column["unit"], max(map(abs, band))).factor
            width = factor * (band[1] - band[0])
            value = rounded(factor * column["value"], width)
            band_text = " to ".join(rounded(factor * end, width) for end in band)
        rows.append((name, value, band_text, unit) if friction_range else (name, value, unit))
    band_heading = (f"for {friction_range}",) if friction_range else ()
    table(("output", "value", *band_heading, "unit"), rows)


def _show_regimes(
    shares: Mapping[str, float], cells: int, closed_forms: bool, outputs: Sequence[str]
) -> None:
    """Print each regime that occurs with its share of the cells, and the share of invalid ones.

    Parameters
    ----------
    shares : mapping of str to float
        Share of the cells in each regime, 0 to 1, by name of the regime; nothing is printed if
        empty.
    cells : int
        Number of cells; for a single one the name is printed without a share.
    closed_forms : bool
        True for a result of formulas, which do not describe a real part in an invalid regime; False
        for a simulated motion, which has no mean velocity in one.
    outputs : sequence of str
        The outputs that they judge; none are named if they judge all.
    """
    if not shares:
        return
    noun = "regime" if cells == 1 else "regimes"
    names = ", ".join(outputs)
    tell(f"  {noun}{f' of {names}' if names else ''}: {_in_words(shares, cells)}")
    invalid = sum(share for name, share in shares.items() if not REGIMES[name].valid)
    if invalid and not closed_forms:
        subject = "This design has" if cells == 1 else f"{_percent(invalid)} of the cells have"
        say(f"  {subject} no mean velocity.")
    elif invalid:
        subject = "This design lies" if cells == 1 else f"{_percent(invalid)} of the cells lie"
        if names:
            subject = f"For {names}, {subject[:1].lower()}{subject[1:]}"
        say(f"  {subject} where the closed forms do not describe a real part.")


def _states(result: Table) -> dict[str, dict[str, float]]:
    """Return the share of cells in each state, 0 to 1, for every output that is a flag.

    The keys are the names of the output and of the state. The regime and the statuses of whole
    cells, which are printed elsewhere, are left out. `result` is the table of a study.
    """
    states = {}
    for name, column in result.variables.items():
        # Not a quantity is, for example, which bound binds.
        is_left_out = is_regime(name) or name in STATUSES or name not in QUANTITIES
        if "flag_values" not in column.attributes or is_left_out:
            continue
        state_names = flags_of(column.attributes)
        values, counts = np.unique(column.values, return_counts=True)
        states[name] = {
            state_names[value]: count / column.values.size
            for value, count in zip(values.tolist(), counts.tolist(), strict=True)
        }
    return states


def _in_words(shares: Mapping[str, float], cells: int) -> str:
    """Return the only name for a single cell, else each name with its share of the cells.

    `shares` holds the share of the cells with each name, 0 to 1.
    """
    if cells == 1:
        return ", ".join(shares)
    return ", ".join(f"{name} {_percent(share)}" for name, share in shares.items())


def _percent(share: float) -> str:
    return percent(share).replace("\N{NO-BREAK SPACE}", " ")


def _show_verified(result: Table) -> None:
    """Print the number of verified cells and the worst of them, and an error if some failed.

    Verified cells are a sample that was computed again by a reference method, to check the errors
    that the result states. `result` is the table; the verification is in its attributes
    `verified_...`, and nothing is printed if it has none.
    """
    if "verified_worst" in result.attributes:
        against, count = (result.attributes[f"verified_{name}"] for name in ("against", "cells"))
        worst = "worst: " if count else ""
        worst += str(result.attributes["verified_worst"])
        say(f"  {count:,} cells verified by {against}; {worst}")
    if beyond_error := not_verified(result):
        fail(
            f"  Not verified: {beyond_error:,} of the cells verified are further off than what is "
            "known of their errors allows."
        )


def _finite_ends(result: Table, name: str) -> Ends:
    """Return the least and the largest finite and valid value of an output; None if it has none.

    A single value counts whether it is valid or not.
    """
    values, valid = result.variables[name].values, result.valid(name)
    if values.size > 1 and valid is not None and not valid.all():
        values = values[valid]
        if not values.size:
            return None
    least, largest = values.min(), values.max()
    if not (np.isfinite(least) and np.isfinite(largest)):
        finite = values[np.isfinite(values)]
        if not finite.size:
            return None
        least, largest = finite.min(), finite.max()
    return float(least), float(largest)


def verbose_lines(prepared: Prepared, checked: float) -> Iterator[str]:
    """Yield the lines that `--verbose` prints about a study in addition to its result.

    Parameters
    ----------
    prepared : Prepared
        The study, once it is carried out.
    checked : float
        Seconds that reading and checking all studies took.
    """
    plan = prepared.plan
    yield f"  checked in {checked:.3f} s; {plan.scene.choice} {plan.variant}"
    yield f"  equations: {', '.join(equation.gives for equation in plan.equations)}"
    kept = sys.modules.get("vibrafeed.core.kernel_cache")  # who needs no kernel does not load it
    yield f"  kernels: compiled, kept in {kept.root()}" if kept else "  kernels: none, all in numpy"
