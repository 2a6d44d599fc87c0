"""What the command line shows of studies, results and scenes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.cli.console import fail, new_grid, say, stdout
from core.dataset.regimes import regime_shares
from core.kinds import is_whole, not_verified, share_left_out
from core.motion.feeding import travel_in_words
from core.optimise import Optimisation
from core.optimise.run import criterion_in_words
from core.quantities import REGIMES
from core.sweep import ReducedSweep

if TYPE_CHECKING:
    from core.dataset import Table
    from core.plan.prepared import Prepared
    from core.sweep.stream import Passed

RARELY = 2.0
"""Times what is likely from which on the most that a study may take is told, too."""


def show_plan(path: Path, prepared: Prepared) -> None:
    """Print what a study would do: cells, bytes, dimensions kept, equations planned."""
    plan = prepared.plan
    say(f"{path}: {plan.scene.name}, {plan.scene.choice} {plan.variant}")
    if isinstance(prepared, ReducedSweep):
        say(
            f"  {prepared.cells:,} cells reduced to {prepared.bytes // 8:,} values, "
            f"{prepared.bytes:,} bytes; some {_duration(prepared.work.seconds())} here, as a few "
            f"of {len(prepared.work):,} boxes tell"
        )
    else:
        seconds, most = prepared.seconds, prepared.most_seconds
        rarely = f" (at most some {_duration(most)})" if most > RARELY * seconds else ""
        say(
            f"  {prepared.cells:,} cells, {prepared.bytes:,} bytes before compression, "
            f"some {_duration(seconds)} on one core{rarely}, {seconds / 3600:.1g} core hours"
        )
    grid = new_grid("output", "unit", "values", "dimensions kept")
    for name, dims in prepared.dims.items():
        sizes = [prepared.sizes[dim] for dim in dims]
        pairs = zip(dims, sizes, strict=True)
        shape = " x ".join(f"{dim} {size}" for dim, size in pairs) or "none"
        grid.add_row(name, prepared.units[name], f"{math.prod(sizes):,}", shape)
    stdout.print(grid)
    if isinstance(prepared, Optimisation):
        what = criterion_in_words(prepared.problem)
        free = ", ".join(prepared.problem.names)
        say(f"  {what}, by the choice of {free}; method {prepared.method}")
        kept = ", ".join(one.name for one in prepared.problem.kept) or "nothing"
        say(f"  kept: {kept}")
    say(f"  equations: {', '.join(equation.gives for equation in plan.equations)}")
    say(f"  regimes: {', '.join(plan.regimes)}")
    if plan.defaults:
        given = ", ".join(f"{name} = {value:g}" for name, value in plan.defaults.items())
        say(f"  by default: {given}")


def _duration(seconds: float) -> str:
    """Return a time in words, two digits of it."""
    for unit, length in (("days", 86_400), ("hours", 3600), ("minutes", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"


def show_table(
    path: Path, target: Path | str, table: Table, cells: int, evaluating: float, writing: float
) -> None:
    """Print a short table of a result: ranges, regimes, timings."""
    say(f"{path} -> {target}")
    ends = {
        name: _finite_ends(variable.values)
        for name, variable in table.variables.items()
        if "flag_values" not in variable.attributes
    }
    _show_ends(table, ends)
    if "regime" in table.variables:
        _show_regimes(table, regime_shares(table.variables["regime"].values))
    if "message" in table.attributes:
        say(f"  {table.attributes['criterion']}, method {table.attributes['method']}")
        say(f"  {table.attributes['message']}")
    if backwards := travel_in_words(table):
        say(f"  {backwards}")
    _show_verified(table)
    left = share_left_out(table)
    if left:
        fail(f"  It was stopped: {left:.1%} of the cells are not computed, and marked so.")
    elif not is_whole(table):
        fail("  It was stopped: all cells are computed, and not all verified that should be.")
    say(f"  {cells:,} cells evaluated in {evaluating:.3f} s, written in {writing:.3f} s")


def show_streamed(
    path: Path, target: Path | str, table: Table, passed: Passed, share: float, told: str
) -> None:
    """Print a short table of a sweep that was computed tile by tile.

    `passed` is what was computed of it, `share` how much of the whole that is, and `told` what it
    took.
    """
    say(f"{path} -> {target}")
    if share < 1:
        say(f"  of the {share:.1%} that this run has computed:")
    ends = {name: (f"{a:.6g}", f"{b:.6g}") for name, (a, b) in passed.ends.items()}
    ends |= {
        name: _finite_ends(one.values) for name, one in table.variables.items() if not one.dims
    }
    _show_ends(table, ends)
    counted = sum(passed.regimes.values())
    by_value = {entry.value: name for name, entry in REGIMES.items()}
    shares = {by_value[v]: n / counted for v, n in passed.regimes.items() if n}
    if not table.variables["regime"].dims:
        shares = regime_shares(table.variables["regime"].values)
    if shares:
        _show_regimes(table, shares)
    _show_verified(table)
    say(f"  {told}")


def _show_ends(table: Table, ends: Mapping[str, tuple[str, str]]) -> None:
    grid = new_grid("output", "unit", "least", "largest", "dimensions")
    for name, variable in table.variables.items():
        if "flag_values" not in variable.attributes:
            unit = str(variable.attributes["units"])
            least, largest = ends.get(name, ("-", "-"))
            grid.add_row(name, unit, least, largest, ", ".join(variable.dims) or "none")
    stdout.print(grid)


def _show_regimes(table: Table, shares: Mapping[str, float]) -> None:
    say("  regimes: " + ", ".join(f"{name} {share:.1%}" for name, share in shares.items()))
    beyond = sum(share for name, share in shares.items() if not REGIMES[name].valid)
    if beyond and "variant" not in table.attributes:
        say(f"  {beyond:.1%} of the cells have no mean velocity.")
    elif beyond:
        say(f"  {beyond:.1%} of the cells lie where the closed forms do not describe a real part.")


def _show_verified(table: Table) -> None:
    if "verified_worst" in table.attributes:
        against, count = (table.attributes[f"verified_{name}"] for name in ("against", "cells"))
        worst = "worst: " if count else ""
        worst += str(table.attributes["verified_worst"])
        say(f"  {count:,} cells verified by {against}; {worst}")
    if beyond_error := not_verified(table):
        fail(
            f"  Not verified: {beyond_error:,} of the cells verified are further off than what is "
            "known of their errors allows."
        )


def show_scenes(lines: list[dict[str, Any]]) -> None:
    """Print one line for each scene."""
    grid = new_grid("scene", "variants", "methods in time", "title")
    for line in lines:
        names = (f"{v}*" if v == line["default_variant"] else v for v in line["variants"])
        methods = "\n".join(line["methods"]) or "-"
        grid.add_row(line["name"], "\n".join(names), methods, line["title"])
    for column in grid.columns[:3]:
        column.no_wrap, column.min_width = True, None
    stdout.print(grid)
    say("  * default; `vibrafeed scenes NAME` tells more, with --method about its motion in time")


def show_scene(scene: dict[str, Any]) -> None:
    """Print everything about one scene."""
    say(f"{scene['name']}: {scene['title']} (source: {scene['source']})")
    if "method" in scene:
        say(f"motion in time, method {scene['method']} of {', '.join(scene['methods'])}")
    else:
        say(f"variant {scene['variant']} of {', '.join(scene['variants'])}")
    say(scene["validity"])
    grid = new_grid("parameter", "symbol", "unit", "bounds", "default", "meaning")
    for p in scene["parameters"]:
        least = (
            "" if p["lower"] is None else f"{'>' if p['lower_excluded'] else '>='} {p['lower']:g}"
        )
        most = "" if p["upper"] is None else f"<= {p['upper']:g}"
        default = "" if p["default"] is None else f"{p['default']:g}"
        grid.add_row(
            p["name"], p["symbol"], p["unit"], f"{least} {most}".strip(), default, p["description"]
        )
    stdout.print(grid)
    for drive in scene.get("other_drives", ()):
        first = [name for name in drive["parameters"] if name.endswith(("_1", "factor"))]
        say(f"  or a drive of {drive['kind']}: {', '.join(first)} and so on (docs/drives.md)")
    grid = new_grid("output", "symbol", "unit", "source", "needs", "equation")
    for o in scene["outputs"]:
        grid.add_row(
            o["name"],
            o["symbol"],
            o["unit"],
            o["source"],
            ", ".join(o["parameters"]),
            o["equation"],
        )
    stdout.print(grid)
    grid = new_grid("regime", "value", "meaning")
    for r in scene["regimes"]:
        grid.add_row(r["name"], str(r["value"]), r["description"])
    stdout.print(grid)


def _finite_ends(values: NDArray[np.float64]) -> tuple[str, str]:
    """Return the least and the largest finite value as text."""
    least, largest = values.min(), values.max()
    if not (np.isfinite(least) and np.isfinite(largest)):
        finite = values[np.isfinite(values)]
        if not finite.size:
            return "-", "-"
        least, largest = finite.min(), finite.max()
    return f"{least:.6g}", f"{largest:.6g}"
