"""The nearest designs of an optimisation without a solution, in words: for a person."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from vibrafeed.app.cli.console import is_muted, tell
from vibrafeed.app.cli.units import format_number
from vibrafeed.core import optimise
from vibrafeed.core.intake import parse_json
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES

if TYPE_CHECKING:
    from vibrafeed.core.dataset import Table
    from vibrafeed.core.study.shown import ShownUnits


def format_value(name: str, value: float, units: ShownUnits) -> str:
    """Return a value with its unit as readable text."""
    shown = units.of(QUANTITIES[name].unit, abs(value))
    gap = "" if shown.unit in ("", "°") else " "
    return f"{format_number(shown.factor * value)}{gap}{shown.unit}"


def nearest(result: Table, units: ShownUnits) -> list[str]:
    """Return lines on an optimisation without solution: the nearest designs, and possible changes.

    Each says by how much a limit is missed while all others are kept, or which change would let all
    be kept. The search takes a while; the result is empty if it is skipped by Ctrl-C, or not
    needed. `result` is the table of the optimisation, `units` are those for printing.
    """
    if is_muted() or not is_infeasible(result) or result.variables["optimum_status"].values.ndim:
        return []
    tell("  Searching for the nearest designs; Ctrl-C skips the search ...")
    started = time.perf_counter()
    try:
        study = parse_json(str(result.attributes["study"]))
        reaches, others = optimise.nearest(study), optimise.ways(study)
    except KeyboardInterrupt:
        return []
    lines = []
    for reach in reaches:
        side = "at most" if reach.upper else "at least"
        asked = f"{side} {format_value(reach.output, reach.bound, units)} is asked"
        lines.append(
            f"Nearest: {reach.output} {format_value(reach.output, reach.value, units)} ({asked}) "
            f"with all other limits kept, at {list_choice(reach.choice, units)}."
        )
    for way in others:
        value = format_value(way.output, way.value, units)
        lines.append(
            f"With {way.change}: {way.output} {value} and all limits kept, at "
            f"{list_choice(way.choice, units)}."
        )
    spent = time.perf_counter() - started
    return [*lines, f"The search for the nearest designs took {spent:.1f} s."]


def list_choice(choice: Mapping[str, float], units: ShownUnits) -> str:
    """Return `name value unit` of each chosen variable, separated by commas."""
    return ", ".join(f"{name} {format_value(name, value, units)}" for name, value in choice.items())


def is_infeasible(result: Table) -> bool:
    """True if a table is the result of an optimisation in which no design meets all limits.

    `result` is the table of any study; its flag variable `optimum_status` says for every design if
    and how an optimum was found. A table without this variable, of another kind of study, gives
    False.
    """
    status = result.variables.get("optimum_status")
    return status is not None and bool(
        np.all(status.values == OPTIMUM_STATUSES["infeasible"].value)
    )
