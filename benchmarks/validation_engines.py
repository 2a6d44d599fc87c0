"""General physics engines on known answers: error against run time.

`python -m benchmarks.validation_engines` runs those that are installed beside this project;
`--python siconos=/usr/bin/python3` names the Python in which another one is. It writes
docs/generated/validation-engines.json and .png, for `python -m benchmarks.known_answers_page`.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.best_wave import motions
from benchmarks.engine_drivers import BLOCKS
from benchmarks.known_answers import Known, found
from benchmarks.known_answers import answer as known_answer
from benchmarks.options import options
from benchmarks.timing import least
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.motion.waves import ALONG, NORMAL, speed
from vibrafeed.core.plan.plan import plan_scene, run_equations
from vibrafeed.core.quantities import QUANTITIES

GENERATED = Path(__file__).parents[1] / "docs" / "generated"
RESULTS, PICTURE = GENERATED / "validation-engines.json", GENERATED / "validation-engines.png"
DRIVERS = Path(__file__).with_name("engine_drivers.py")
STEPS = (20, 100, 500, 2000)  # a period
DURING = 20  # periods that are averaged
GRAVITY = 9.81  # m s-2, of these answers
NAMES = {
    "mujoco": "MuJoCo", "pybullet": "PyBullet", "pymunk": "pymunk", "dart": "DART",
    "siconos": "Siconos",
}  # fmt: skip


ASKED = {
    "Q-two-levels-3": ("Two-level wave", 10),
    "W-winkler-1": ("Winkler's wave", 10),
    "W-winkler-2": ("Winkler's wave, load near 0", 10),
    "M-ellipse-4": ("Fast ellipse", 40),
    "Z-turn-1": ("Level sine: where slip turns", 10),
    "V-speed-7": ("Short hops", 30),
}
"""Known answers that engines can find, with one coefficient of friction: title, and periods until
the motion repeats."""


@cache
def asked_cases() -> Mapping[str, tuple[Known, float]]:
    """Return each known answer with the full-precision result of `events`."""
    cases = {}
    for name in ASKED:
        case = known_answer(name)
        value = float(found(case, {}).value)
        assert case.holds(value)
        cases[name] = (case, value)
    return cases


def jobs(case: Known) -> list[dict[str, Any]]:
    """Return the inputs of a case for the engines, one job per number of steps."""
    given = _parameters(case)
    frequency = given["frequency"]
    work = []
    for steps in STEPS:
        phases = np.linspace(0.0, 2 * math.pi, steps + 1)
        step = 1 / (frequency * steps)
        gravity = -np.diff(_track(given, phases)).T / step
        gravity[:, 1] -= GRAVITY
        work.append(
            {
                "step": step,
                "friction": given.get("friction", given.get("friction_kinetic")),
                "gravities": gravity.tolist(),
                "before": ASKED[case.name][1],
                "during": DURING,
            }
        )
    return work


def _parameters(case: Known) -> dict[str, float]:
    """Return a case's parameters in SI units and radians."""
    given = case.study["parameters"]
    return {
        name: math.radians(value) if QUANTITIES[name].is_angle else value
        for name, value in given.items()
    }


def _track(given: Mapping[str, float], phases: np.ndarray) -> np.ndarray:
    """Return the velocity of a level track along and normal, at phases of the drive."""
    w = 2 * math.pi * given["frequency"]
    if "amplitude" in given:
        line = np.array([[math.cos(given["beta"])], [math.sin(given["beta"])]])
        return line * given["amplitude"] * w * np.cos(phases)
    numbers = {name: np.asarray(value) for name, value in given.items()}
    known = motions(("conveying_velocity",), numbers)
    scale = GRAVITY / w
    found = []
    for axis in (ALONG, NORMAL):
        velocity = np.asarray(speed(known["wave"], axis, phases)) * scale
        velocity[-1] = velocity[0]  # the phase is 0 again
        found.append(velocity)
    return np.array(found)


def answer(case: Known, steps: int, told: Mapping[str, Any]) -> float:
    """Return an engine's result of a case, in the case's unit."""
    (term,) = case.terms
    times = float(term.get("times", 1.0))
    if term["output"] == "conveying_velocity":
        return times * float(told["mean"])
    (time,) = case.study["trajectory"]
    at = time * case.study["parameters"]["frequency"] * steps  # speeds are at ends of steps
    return times * float(np.interp(at, range(1, steps + 1), told["speeds"]))


def ours(case: Known) -> float:
    """Return the processor time of `events` per cell, of 2,000 cells at once [s]."""
    given, cells = _parameters(case), 2000
    arrays = {name: np.full(cells, value) for name, value in given.items()}
    arrays["gravity"] = GRAVITY * (1 + 1e-9 * np.arange(cells))  # equal cells are computed once
    outputs = ("conveying_velocity",)

    def run() -> None:
        """Compute 2,000 cells at once."""
        if "amplitude" in given:
            plan = plan_scene(SYSTEMS["rectangle-on-plane"], "events", outputs, tuple(arrays))
            run_equations(plan, {name: arrays[name] for name in plan.parameters if name in arrays}
                          | {n: np.asarray(v) for n, v in plan.defaults.items()})  # fmt: skip
        else:
            motions(outputs, arrays)

    run()
    return least(1, run, time.process_time) / cells


def rows(pythons: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield a row for each engine, problem and step."""
    for name, (case, truth) in asked_cases().items():
        yield {
            "engine": "vibrafeed", "version": "", "problem": name, "steps": 0,
            "found": truth, "error": 0.0, "seconds": ours(case),
        }  # fmt: skip
    for name in BLOCKS:
        told = _run(name, pythons.get(name, sys.executable))
        if told is None:
            continue
        results = iter(told["answers"])
        for case, truth in asked_cases().values():
            for steps in STEPS:
                result = next(results)
                value = answer(case, steps, result)
                periods = (ASKED[case.name][1] + DURING) / DURING
                yield {
                    "engine": name, "version": told["version"], "problem": case.name,
                    "steps": steps, "found": value, "error": abs(value / truth - 1),
                    "seconds": result["seconds"] * DURING * periods,
                }  # fmt: skip


def _run(name: str, python: str) -> dict[str, Any] | None:
    """Return the results of an engine; print a line and return None if it is missing."""
    work = [job for case, _ in asked_cases().values() for job in jobs(case)]
    done = subprocess.run(
        [python, DRIVERS, name], input=json.dumps(work), capture_output=True, text=True, check=False
    )
    if done.returncode:
        print(f"{name}: {done.stderr[-300:]}")
        return None
    told = json.loads(done.stdout[done.stdout.index('{"') :])  # engines may greet before
    if "missing" in told:
        print(f"{name} is not installed: {told['missing']}")
        return None
    print(f"{name} {told['version']}", flush=True)
    return told


def draw(found: list[dict[str, Any]]) -> None:
    """Draw the error of each engine over its run time, a panel per problem."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 6.6), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True).ravel()
    looks = dict(zip(NAMES, ("osD^v"), strict=True))
    for panel, (name, (title, _)) in zip(panels, ASKED.items(), strict=False):
        mine = [row for row in found if row["problem"] == name]
        for number, (engine, look) in enumerate(looks.items()):
            line = [row for row in mine if row["engine"] == engine]
            panel.loglog(
                [row["seconds"] for row in line], [max(row["error"], 1e-6) for row in line],
                f"{look}-", color=f"C{number}", label=NAMES[engine], markersize=4, linewidth=1.2,
            )  # fmt: skip
        (own,) = [row for row in mine if row["engine"] == "vibrafeed"]
        panel.axvline(own["seconds"], color="k", linewidth=1.0, label="vibrafeed, exact")
        panel.set_title(f"{title} ({name})", fontsize=9)
        panel.grid(visible=True, which="major", linewidth=0.4, color="0.85")
        panel.xaxis.set_tick_params(labelbottom=True)
    handles = panels[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=len(NAMES) + 1, frameon=False)
    for panel in panels[[0, 3]]:
        panel.set_ylabel("error of the answer, as a share of it")
    for panel in panels[3:]:
        panel.set_xlabel("seconds for the answer")
    panels[2].set_ylim(5e-7, 3)
    figure.savefig(PICTURE, dpi=100)


def main() -> None:
    """Run the engines, then write and draw their results."""
    given = options(
        __doc__, python=([str], "ENGINE=PYTHON"), draw=(False, "draw what is there already")
    )
    if not given.draw:
        found = list(rows(dict(text.split("=", 1) for text in given.python)))
        RESULTS.write_text(
            "[\n" + ",\n".join(json.dumps(row) for row in found) + "\n]\n", encoding="utf-8"
        )
    draw(json.loads(RESULTS.read_text(encoding="utf-8")))


if __name__ == "__main__":
    main()
