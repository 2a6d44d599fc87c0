"""Prints how near and how fast the optimisers come: `python -m benchmarks.optimise`.

Four tables: every method on the same random designs, error against time, which is also drawn
(`docs/generated/optimise-methods.png`); a batch of 10,000 designs by `exact` and by `search`; a
whole front against one limit; and the thesis's own answer beside the physical one and the fastest
true motion, on the data of figure 5.1.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.timing import least, timed
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise import METHODS
from vibrafeed.core.optimise.methods import refusal
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import chosen_cells
from vibrafeed.core.optimise.run import designs_of
from vibrafeed.core.watch import Watch

PICTURE = Path(__file__).parents[1] / "docs" / "generated" / "optimise-methods.png"
DESIGNS = 10_000
MARKERS = dict(zip(METHODS, "os^", strict=True))
ROUNDING = 1e-16  # stands for no error at all on a logarithmic axis


# --- every method on the same designs


def studies() -> dict[str, dict[str, Any]]:
    """Return the problems on which methods are compared, each with a known optimum."""
    random = np.random.default_rng(3)
    amplitude = sorted((10 ** random.uniform(-4.3, -3.3, 5)).tolist())
    friction = sorted(random.uniform(0.1, 0.9, 4).tolist())
    parameters = {"frequency": 60, "gamma": 3, "amplitude": amplitude, "friction": friction}
    plane = {"kind": "optimise", "scene": "rectangle-on-plane", "parameters": parameters}
    limit = {"kind": "limit", "limit": 1.0}
    return {
        "printed plane, limit": {**plane, "variant": "thesis", "criterion": limit},
        "printed plane, weighted": {
            **plane,
            "variant": "thesis",
            "criterion": {"kind": "weighted", "weight": 0.5},
        },
        "block, friction disc": {
            **plane,
            "variant": "physical",
            "criterion": {"kind": "maximise"},
        },
        "track, both contacts": {
            **plane,
            "scene": "rectangle-on-track",
            "variant": "physical",
            "criterion": {"kind": "maximise"},
            "parameters": {**parameters, "delta": 15},
        },
    }


def compared(content: Mapping[str, Any]) -> dict[str, tuple[Array, float, Array]]:
    """Return error, time per design, and evaluations of every applicable method."""
    known = run_study(parse_study(dict(content)))
    moves = (known["optimum_status"] == 0).values.ravel()
    exact = known["objective"].values.ravel()
    results = {}
    for name in METHODS:
        prepared = prepare(parse_study(dict(content)))
        problem = prepared.problem
        if refusal(name, problem):
            continue
        design = chosen_cells(designs_of(problem, prepared.designs), moves)
        scales = problem.scales(design)
        found, seconds = timed(METHODS[name].solve, problem, design, scales, Watch())
        x = np.where(np.isnan(found.x), problem.lower[:, None], found.x)
        value = problem.judged(x, design, scales)[0]
        error = np.abs(exact[moves] - value) / problem.scale(scales)
        used = np.broadcast_to(np.asarray(found.evaluations, dtype=np.float64), error.shape)
        results[name] = error, seconds / error.size, used
    return results


def print_methods() -> dict[str, dict[str, tuple[Array, float, Array]]]:
    """Print the table of methods and return its content."""
    everything = {}
    for title, content in studies().items():
        everything[title] = compared(content)
        print(f"\n{title}: error of the objective, as a share of its scale")
        print(f"  {'method':24}{'median':>10}{'largest':>10}{'missed':>8}{'ms':>10}{'points':>9}")
        for name, (error, seconds, used) in everything[title].items():
            missed = int((error > 1e-4).sum())
            print(
                f"  {name:24}{np.median(error):10.1e}{error.max():10.1e}"
                f"{missed:5d}/{error.size:<3d}{seconds * 1e3:9.3f}{np.median(used):9.0f}"
            )
    return everything


def draw_methods(everything: Mapping[str, Mapping[str, tuple[Array, float, Array]]]) -> None:
    """Draw error against run time."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(10.0, 7.6), layout="constrained", facecolor="white")
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for panel, (title, results) in zip(panels.flat, everything.items(), strict=True):
        panel.set_title(title, loc="left", fontsize=10)
        for name, (error, seconds, _) in results.items():
            middle = max(float(np.median(error)), ROUNDING)
            worst = max(float(np.minimum(error.max(), 1.0)), ROUNDING)
            colour = "#b04a2f" if name == "scipy" else "#1f5a8a"
            panel.plot([seconds * 1e3] * 2, [middle, worst], color=colour, lw=1.2)
            panel.plot(seconds * 1e3, middle, MARKERS[name], color=colour, ms=6)
        panel.set(xscale="log", yscale="log")
        panel.grid(visible=True, color="#dddddd", lw=0.5)
    entries = [
        Line2D([], [], marker=MARKERS[name], ls="", ms=6, label=name,
               color="#b04a2f" if name == "scipy" else "#1f5a8a")
        for name in MARKERS if any(name in results for results in everything.values())
    ]  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    for panel in figure.axes[-2:]:
        panel.set_xlabel("Time of a design [ms]", fontsize=9)
    figure.supylabel("Error of the objective over its scale", fontsize=10)
    figure.suptitle(
        "Optimisers of the drive: median (mark) to largest error (line) against run time;"
        " scipy in red, a loop over designs",
        x=0.02,
        ha="left",
        fontsize=11,
        fontweight="bold",
    )
    figure.savefig(PICTURE, dpi=110)
    print(f"\ndrew {PICTURE.name}")


# --- a whole batch


def print_batch() -> None:
    """Print the time per design in a batch, with all outputs, checks and labels."""
    content: dict[str, Any] = {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "variant": "thesis",
        "criterion": {"kind": "limit", "limit": 1.0},
        "parameters": {
            "frequency": 60,
            "amplitude": {"start": 1e-4, "stop": 5e-4, "num": 100},
            "friction": {"start": 0.1, "stop": 0.8, "num": DESIGNS // 100},
        },
    }
    print(f"\nBatches of {DESIGNS:,} designs, through a study")
    for name in ("exact", "search"):
        study = parse_study({**content, "method": name})
        _, seconds = timed(run_study, study)
        print(f"  {name:8} {seconds / DESIGNS * 1e6:10.2f} us a design")


def print_front() -> None:
    """Print the time of a front of 200 points, solved point by point."""
    plane = {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "variant": "thesis",
        "parameters": {"frequency": 60, "amplitude": "0.1 mm", "friction": 0.5},
    }
    one = parse_study({**plane, "criterion": {"kind": "limit", "limit": 1.0}})
    many = parse_study({**plane, "criterion": {"kind": "pareto", "points": 200}})
    single, front = (least(20, partial(run_study, study)) for study in (one, many))
    print(f"\nA front of 200 points: {front * 1e3:.2f} ms, {front / single:.1f} single limits")


# --- the thesis's answer


def print_answers() -> None:
    """Print the best angles for figure 5.1: printed, physical, and simulated."""
    data = {"frequency": 60, "amplitude": "0.5 mm", "friction": 0.5, "gravity": 9.8}
    base = {"kind": "optimise", "scene": "cylinder-on-plane", "parameters": data}
    fastest_of = {"criterion": {"kind": "maximise"}, "outputs": ["throw_number", "acceleration_y"]}
    cases: dict[str, dict[str, Any]] = {
        "as printed, no contact asked": {"variant": "thesis", "floor_contact": False, **fastest_of},
        "as printed, on the floor": {"variant": "thesis", **fastest_of},
        "physical": {"variant": "physical", **fastest_of},
        "true mean velocity": {
            "criterion": {"kind": "maximise", "output": "conveying_velocity"},
            "outputs": ["throw_number"],
        },
    }
    print("\nData of figure 5.1 (60 Hz, 0.5 mm, friction 0.5)")
    for title, case in cases.items():
        dataset = run_study(parse_study({**base, **case}))
        alpha = float(dataset["best_alpha"]) if "best_alpha" in dataset else 0.0
        value = dataset["objective"]
        print(
            f"  {title:30} alpha {alpha:4.1f}, beta {float(dataset['best_beta']):6.2f} deg, "
            f"throw number {float(dataset['throw_number']):5.2f}: "
            f"{float(value):8.4f} {value.attrs['units']}"
        )


def main() -> None:
    """Print all tables and draw the picture."""
    everything = print_methods()
    print_batch()
    print_front()
    print_answers()
    draw_methods(everything)


if __name__ == "__main__":
    main()
