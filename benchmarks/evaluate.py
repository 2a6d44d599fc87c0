"""What a cell of a sweep costs: compiled, by numpy, as one writes it with xarray, and at best.

    python -m benchmarks.evaluate [--cells 3e7] [--runs 9] [--before FOLDER]
    python -m benchmarks.evaluate --bits [--cells 1e5]
    python -m benchmarks.evaluate --sizes

The first prints nanoseconds a cell over all cores, of seven axes and both arrays, in one run and in
turn: a plain parallel fill of the same arrays (the limit), the compiled loop into them, the
equations by numpy block by block, and the lines of xarray that a user would write, which tell no
regime. `--before` is a checkout of another version, whose own way is timed between. The second
compares the bits of both ways for every closed-form output of every scene. The third prints what a
cell costs on grids of 10^4 to 10^8 cells.
"""

from __future__ import annotations

import json
import math
import os
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.evaluate import Fused, empty_results, evaluate_in_blocks
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan, find_scene, plan_scene, scene_parameters
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.trace import traced
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.units import read_number
from vibrafeed.core.study.values import Fixed, Points

SPANS = {
    "frequency": (20, 120), "amplitude": (2e-4, 1e-3), "friction": (0.1, 0.8), "alpha": (0, 60),
    "beta": (5, 60), "gamma": (-5, 5), "delta": (0, 20),
}  # fmt: skip
TRACK = "rectangle-on-track"
WAY = {"radius": 0.8, "distance": 2e-4}
CASES: tuple[tuple[str, str, str, Mapping[str, float]], ...] = (
    (TRACK, "derived", "transport_velocity", WAY),
    (TRACK, "physical", "transport_velocity", WAY),
    (TRACK, "derived", "acceleration_x", {}),
    (TRACK, "physical", "acceleration_x", {}),
    (TRACK, "derived", "travel_time", WAY),
    (TRACK, "derived", "travel_time", {**WAY, "speed": 0.02}),
    ("rectangle-on-plane", "thesis", "acceleration_x", {}),
    ("rectangle-on-plane", "physical", "acceleration_x", {}),
    ("cylinder-on-plane", "derived", "acceleration_y", {}),
    ("cylinder-on-plane", "thesis", "acceleration_x", {}),
    ("cylinder-on-plane", "physical", "acceleration_x", {}),
)
"""Scene, variant, output, and parameters that are fixed."""

STANDS_FOR_OTHERS = (
    *("friction", "peak_to_peak", "vertical_amplitude", "vertical_peak_to_peak"),
    "centripetal_acceleration",
)

Arrays = Mapping[str, NDArray[Any]]


def study(
    scene: str, variant: str, output: str, fixed: Mapping[str, float], cells: float
) -> dict[str, Any]:
    """Return a sweep over all axes of an output, with about `cells` cells."""
    names = [name for name in SPANS if scene == TRACK or name != "delta"]
    content: dict[str, Any] = {
        "kind": "sweep", "scene": scene, "variant": variant, "outputs": [output],
        "parameters": fixed,
    }  # fmt: skip
    while True:
        each = max(2, round(cells ** (1 / len(names))))
        spans = {n: {"start": SPANS[n][0], "stop": SPANS[n][1], "num": each} for n in names}
        content["parameters"] = {**fixed, **spans}
        try:
            prepare_content(content)
        except StudyError as error:
            unused = {problem.place.removeprefix("parameters.") for problem in error.problems}
            names = [name for name in names if name not in unused]
        else:
            return content


def fill(arrays: Arrays, pool: ThreadPoolExecutor) -> None:
    """Write a number into all arrays, to measure the memory's speed."""
    parts = []
    for array in arrays.values():
        flat = array.reshape(-1)
        step = -(-flat.size // (os.cpu_count() or 1))
        parts += [flat[start : start + step] for start in range(0, flat.size, step)]
    list(pool.map(lambda part: np.copyto(part, 1), parts))


def idiom(grid: Grid) -> xarray.DataArray:
    """Compute the transport velocity with xarray, as a user would write it."""
    given = {n: xarray.DataArray(grid.coordinate(n), dims=n) for n in grid.axes}
    alpha, beta, gamma, delta = (np.deg2rad(given[n]) for n in ("alpha", "beta", "gamma", "delta"))
    mu, radius, distance, gravity = given["friction"], 0.8, 2e-4, 9.80665
    push = given["amplitude"] * (2 * np.pi * given["frequency"]) ** 2 * np.cos(beta)
    weight = gravity * (np.sin(gamma) + mu * np.cos(gamma) * np.sin(delta))
    start = push * (np.cos(alpha) + mu * np.sin(alpha)) - weight
    decay = -np.expm1(-2 * mu * distance / radius) * radius / mu
    return np.sqrt(start.clip(0) * decay)


BEFORE = """
import json, sys, time
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.evaluate import evaluate
prepared = prepare_content(json.loads(sys.argv[1]))
for _ in range(3):  # loops are compiled at first
    started = time.perf_counter()
    evaluate(prepared.plan, prepared.grid)
    seconds = time.perf_counter() - started
print(seconds)
"""


def before(folder: str, content: Mapping[str, Any]) -> float:
    """Return the seconds that another version of the program takes."""
    done = subprocess.run(
        [sys.executable, "-c", BEFORE, json.dumps(content)],
        cwd=folder, env={**os.environ, "PYTHONPATH": folder}, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    return float(done.stdout)


def compiled(prepared: Prepared) -> Fused:
    """Return the compiled form of a study's plan."""
    graph = traced(prepared.plan, prepared.grid.along)
    assert graph is not None
    return Fused(prepared.plan, graph, prepared.grid)


def times(cells: float, runs: int, other: str | None) -> None:
    """Print the time per cell of all ways of computing [ns]."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for scene, variant, output, fixed in CASES:
            content = study(scene, variant, output, fixed, cells)
            prepared = prepare_content(content)
            plan, grid = prepared.plan, prepared.grid
            arrays, fused = empty_results(plan, grid), compiled(prepared)
            ways: dict[str, Callable[[], object]] = {
                "fill": lambda a=arrays: fill(a, pool),
                "compiled": lambda f=fused, a=arrays: f.run(a),
            }
            seldom = {"numpy": lambda p=plan, g=grid, a=arrays: evaluate_in_blocks(p, g, a)}
            if output == "transport_velocity":
                seldom["xarray"] = lambda g=grid: idiom(g)
            took: dict[str, list[float]] = {name: [] for name in (*ways, *seldom, "before")}
            for run in ways.values():
                run()
            for turn in range(runs):
                for name, run in (ways if turn % 3 else {**ways, **seldom}).items():
                    took[name].append(timed(run)[1])
                if other and turn % 3 == 0:
                    took["before"].append(before(other, content))
            given = "".join(f", {name} {value:g}" for name, value in fixed.items())
            print(f"{scene}, {variant}, {output}{given}: {grid.cells:,} cells")
            limit = statistics.median(took["fill"])
            mine = statistics.median(took["compiled"])
            for name, seconds in took.items():
                if not seconds:
                    continue
                middle, each = statistics.median(seconds), 1e9 / grid.cells
                print(
                    f"  {name:9}{middle * each:8.2f} ns  ({min(seconds) * each:.2f} to "
                    f"{max(seconds) * each:.2f}){middle / limit:8.1f} times the fill"
                    f"{middle / mine:8.1f} times the compiled loop"
                )


def plan_of(name: str, variant: str, outputs: Sequence[str]) -> Plan:
    """Return the plan of some outputs that is given all parameters it can use."""
    given = [n for n in scene_parameters(SCENES[name], variant) if n not in STANDS_FOR_OTHERS]
    given += [] if {"friction_static", "friction_kinetic"} & set(given) else ["friction"]
    while True:
        try:
            return plan_scene(*find_scene(name, variant), outputs, given)
        except StudyError as error:
            unused = {problem.place.removeprefix("parameters.") for problem in error.problems}
            if not unused & set(given):
                raise
            given = [n for n in given if n not in unused]


def traceable(name: str, variant: str) -> dict[bool, list[str]]:
    """Return the closed-form outputs of a variant, by whether they can be compiled."""
    ways: dict[bool, list[str]] = {True: [], False: []}
    for output in SCENES[name].outputs(variant):
        plan = plan_of(name, variant, (output,)) if output != "regime" else None
        if plan is not None and not any(equation.takes_long for equation in plan.equations):
            ways[traced(plan, {name: name for name in plan.parameters}) is not None].append(output)
    return ways


def grid_of(plan: Plan, cells: int, seed: int) -> Grid:
    """Return a grid of random parameter values, and values where formulas change."""
    pick = np.random.default_rng(seed)
    names = list(plan.parameters)
    each = max(2, math.ceil(cells ** (1 / len(names))))
    values: dict[str, Points | Fixed] = {}
    total = 1
    for name in pick.permutation(names):
        quantity = QUANTITIES[name]
        if quantity.is_angle:
            found = {0.0, 90.0, *pick.uniform(-30, 90, each + 3)}
        else:
            typical = read_number(name, quantity, quantity.examples[0]) or 1.0
            found = {0.0, *(typical * pick.lognormal(0, 0.7, each + 3))}
        found = {v for v in found if quantity.lower <= v <= quantity.upper}
        found -= {0.0} if quantity.strict else set()
        found = found or {typical}
        chosen = sorted(pick.permutation(sorted(found))[: each if total < cells else 1])
        total *= len(chosen)
        values[name] = Points(tuple(chosen)) if len(chosen) > 1 else Fixed(chosen[0])
    return Grid.of({name: values[name] for name in names})


def different(plan: Plan, grid: Grid) -> Iterator[tuple[str, int]]:
    """Yield each array of a plan and the number of values that differ between both ways."""
    graph = traced(plan, grid.along)
    assert graph is not None
    expected, got = empty_results(plan, grid), empty_results(plan, grid)
    with np.errstate(all="ignore"):
        evaluate_in_blocks(plan, grid, expected)
    Fused(plan, graph, grid).run(got)
    for name, values in expected.items():
        # Of two zeros of different sign numpy itself takes either, by the width of its registers.
        same = (got[name] == values) | ((got[name] != got[name]) & (values != values))
        yield name, int(np.count_nonzero(~same))


def bits(cells: int) -> bool:
    """Print which outputs are compiled, and how many values differ; True if none does."""
    wrong = 0
    for name, scene in SCENES.items():
        for variant in scene.variants:
            ways = traceable(name, variant)
            for output in ways[True]:
                plan = plan_of(name, variant, (output,))
                if not plan.parameters:  # a constant
                    continue
                for array, count in different(plan, grid_of(plan, cells, seed=len(output))):
                    wrong += count
                    if count:
                        print(f"  {output}: {count} values of {array} differ")
            print(f"{name}, {variant}: {len(ways[True])} compiled, by numpy {ways[False]}")
    print(f"{wrong} values differ")
    return not wrong


def sizes(runs: int) -> None:
    """Print the time per cell on small and large grids."""
    for power in (4, 5, 6, 7, 8):
        prepared = prepare_content(study(*CASES[0], cells=10**power))
        arrays, fused = empty_results(prepared.plan, prepared.grid), compiled(prepared)
        fused.run(arrays)
        seconds = statistics.median(timed(fused.run, arrays)[1] for _ in range(runs))
        cells = prepared.grid.cells
        print(f"{cells:13,} cells {seconds / cells * 1e9:8.2f} ns a cell, {seconds:.4f} s")


def main() -> int:
    """Print all measurements."""
    asked = options(__doc__, cells=float, runs=9, before=str, bits=False, sizes=False)
    if asked.bits:
        return 0 if bits(int(asked.cells or 1e5)) else 1
    if asked.sizes:
        sizes(asked.runs)
    else:
        times(asked.cells or 3e7, asked.runs, asked.before)
    return 0


if __name__ == "__main__":
    sys.exit(main())
