"""What a study would do, before it does it: for a person, and as a document."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from app.cli.console import say, table, tell
from app.cli.units import DEFAULT_DIGITS, number, units_asked
from core.optimise import Optimisation
from core.optimise.run import criterion_in_words
from core.plan.grid import from_si
from core.quantities import QUANTITIES
from core.sweep import ReducedSweep

if TYPE_CHECKING:
    from core.plan.prepared import Prepared

RARELY = 2.0
"""Times what is likely from which on the most that a study may take is told, too."""


def plan_facts(path: Path, prepared: Prepared) -> dict[str, Any]:
    """Return what a study would do, as a document: cells, bytes, dimensions, equations."""
    plan = prepared.plan
    facts: dict[str, Any] = {
        "study": str(path),
        "kind": prepared.study.kind,
        "scene": plan.scene.name,
        plan.scene.choice: plan.variant,
        "cells": prepared.cells,
        "bytes": prepared.bytes,
        "seconds": _seconds(prepared),
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
    if isinstance(prepared, Optimisation):
        facts |= {
            "criterion": criterion_in_words(prepared.problem),
            "variables": [*prepared.problem.names],
            "method": prepared.method,
            "kept": [one.name for one in prepared.problem.kept],
        }
    return facts


def show_plan(path: Path, prepared: Prepared, asked: str | None) -> None:
    """Print what a study would do: cells, bytes, dimensions kept, equations planned."""
    plan, facts = prepared.plan, plan_facts(path, prepared)
    units = units_asked(asked, ",".join(prepared.study.units or ()))
    say(f"{path}: {plan.scene.name}, {plan.scene.choice} {plan.variant}")
    if isinstance(prepared, ReducedSweep):
        say(
            f"  {prepared.cells:,} cells reduced to {prepared.bytes // 8:,} values, "
            f"{prepared.bytes:,} bytes; some {_duration(facts['seconds'])} here, as a few "
            f"of {len(prepared.work):,} boxes tell"
        )
    else:
        seconds, most = prepared.seconds, prepared.most_seconds
        rarely = f" (at most some {_duration(most)})" if most > RARELY * seconds else ""
        say(
            f"  {prepared.cells:,} cells, {prepared.bytes:,} bytes before compression, "
            f"some {_duration(seconds)} on one core{rarely}, {seconds / 3600:.1g} core hours"
        )
    rows = []
    for name, one in facts["outputs"].items():
        sizes = one["dimensions"]
        shape = " x ".join(f"{dim} {size}" for dim, size in sizes.items()) or "none"
        unit = units.of(one["unit"], 0.0).unit
        rows.append((name, unit, f"{math.prod(sizes.values()):,}", shape))
    table(("output", "unit", "values", "dimensions kept"), rows)
    if isinstance(prepared, Optimisation):
        free = ", ".join(facts["variables"])
        say(f"  {facts['criterion']}, by the choice of {free}; method {facts['method']}")
        say(f"  kept: {', '.join(facts['kept']) or 'nothing'}")
    tell(f"  equations: {', '.join(facts['equations'])}")
    tell(f"  regimes: {', '.join(facts['regimes'])}")
    if facts["defaults"]:
        given = []
        for name, one in facts["defaults"].items():
            shown = units.of(one["unit"], abs(one["value"]))
            value = number(shown.factor * one["value"], DEFAULT_DIGITS)
            given.append(f"{name} = {value} {shown.unit}".rstrip())
        tell(f"  by default: {', '.join(given)}")


def more(prepared: Prepared, checked: float) -> Iterator[str]:
    """Yield what --verbose tells of a study besides its result.

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
    kept = sys.modules.get("core.kernel_cache")  # who needs no kernel does not load it
    yield f"  kernels: compiled, kept in {kept.root()}" if kept else "  kernels: none, all in numpy"


def _seconds(prepared: Prepared) -> float:
    """Return what a study takes, roughly: on one core, or here if it is reduced."""
    if isinstance(prepared, ReducedSweep):
        return float(prepared.work.seconds())
    return prepared.seconds


def _duration(seconds: float) -> str:
    """Return a time in words, two digits of it."""
    for unit, length in (("days", 86_400), ("hours", 3600), ("minutes", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"
