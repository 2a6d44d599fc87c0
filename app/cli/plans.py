"""The plan of a study, printed before it runs: for a person, and as a document."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibrafeed.app.cli.console import say, table, tell
from vibrafeed.app.cli.targets import size_of
from vibrafeed.app.cli.units import DEFAULT_DIGITS, format_number, units_asked
from vibrafeed.core.dataset.formats import FORMATS, suffix_of
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.prepared import in_words
from vibrafeed.core.quantities import QUANTITIES

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared


def plan_facts(path: Path, prepared: "Prepared") -> dict[str, Any]:
    """Return the plan of a study as a JSON document: cells, bytes, dimensions, equations.

    It says what `vibrafeed run` would compute, without computing it. `path` is the study's file;
    values of defaults are in the units of files.
    """
    plan = prepared.plan
    facts: dict[str, Any] = {
        "study": str(path),
        "kind": prepared.study.kind,
        "scene": plan.scene.name,
        plan.scene.choice: plan.variant,
        "cells": prepared.cells,
        "bytes": prepared.bytes,
        "seconds": prepared.seconds_here,
        "outputs": {
            name: {
                "unit": prepared.units[name],
                "dimensions": {dim: prepared.sizes[dim] for dim in dims},
            }
            for name, dims in prepared.dims.items()
        },
        "equations": [equation.gives for equation in plan.equations],
        "regimes": [*plan.regimes],
        "defaults": {
            name: {"value": from_si(name, np.array(value)).item(), "unit": QUANTITIES[name].unit}
            for name, value in plan.defaults.items()
        },
    }
    return facts | prepared.facts()


def show_plan(
    path: Path, prepared: "Prepared", output: str | None, units_option: str | None
) -> None:
    """Print the plan of a study: cells, bytes, dimensions kept, equations to compute.

    `path` is the study's file; `output` and `units_option` are the texts of `-o` and `--units`, if
    given.
    """
    plan, facts = prepared.plan, plan_facts(path, prepared)
    units = units_asked(units_option, ",".join(prepared.study.units or ()))
    say(f"{path}: {plan.scene.name}, {plan.scene.choice} {plan.variant}")
    say(f"  {prepared.size_in_words}")
    size, form = size_of(prepared), FORMATS.get(suffix_of(output or ""))
    if form is not None and form.seconds_a_value:
        seconds = form.seconds_a_value * size.rows * size.columns
        say(f"  plus about {in_words(seconds)} to write the {form.name} file")
    rows = []
    for name, fact in facts["outputs"].items():
        sizes = fact["dimensions"]
        shape = " x ".join(f"{dim} {size}" for dim, size in sizes.items()) or "none"
        unit = units.of(fact["unit"], 0.0).unit
        rows.append((name, unit, f"{math.prod(sizes.values()):,}", shape))
    table(("output", "unit", "values", "dimensions kept"), rows)
    for sentence in prepared.sentences:
        say(f"  {sentence}")
    tell(f"  equations: {', '.join(facts['equations'])}")
    tell(f"  regimes: {', '.join(facts['regimes'])}")
    if facts["defaults"]:
        names = []
        for name, fact in facts["defaults"].items():
            shown = units.of(fact["unit"], abs(fact["value"]))
            value = format_number(shown.factor * fact["value"], DEFAULT_DIGITS)
            names.append(f"{name} = {value} {shown.unit}".rstrip())
        tell(f"  by default: {', '.join(names)}")
