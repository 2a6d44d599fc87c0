"""Studies of every kind at random: those of `configs`, with other values, axes and outputs."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from vibrafeed.core.intake import load_study
from vibrafeed.core.study.grid_study import Study

ROOT = Path(__file__).parents[2]
KINDS = ("sweep", "simulate", "optimise", "sensitivity")
FILES = sorted(ROOT.glob("configs/*.toml")) + sorted(ROOT.glob("configs/*/*.toml"))
FROM_FILES = ("measured-drive", "resting-bracket")  # drive and part stand in files beside them
MAX_AXES = {"sweep": 3, "simulate": 2, "optimise": 1, "sensitivity": 1}
COUNTS = {"sweep": (1, 3, 13), "simulate": (1, 3, 11), "optimise": (1, 3), "sensitivity": (1, 3)}
Content = dict[str, Any]


@cache
def shipped(kind: str) -> list[Content]:
    """Return the shipped studies of a kind, in their canonical form; to be read only."""
    return [json.loads(study.canonical()) for study in _every() if study.kind == kind]


@cache
def _every() -> list[Study]:
    return [load_study(file) for file in FILES if file.stem not in FROM_FILES]


def random_study(random: np.random.Generator, kind: str, known: list[Content]) -> Content:
    """Return a study of a kind, drawn from shipped ones."""
    if kind == "sensitivity":
        return _uncertain(random)
    content = json.loads(json.dumps(known[random.integers(len(known))]))
    if "outputs" in content:
        content["outputs"] = random.permutation(content["outputs"]).tolist()
    ranged = [name for name, raw in content["parameters"].items() if isinstance(raw, list | dict)]
    random.shuffle(ranged)
    alone = random.random() < 0.15
    for place, name in enumerate(ranged):
        count = 1 if alone or place >= MAX_AXES[kind] else int(random.choice(COUNTS[kind]))
        values = _values(random, content["parameters"][name], count)
        content["parameters"][name] = values if len(values) > 1 else values[0]
    if kind == "optimise" and random.random() < 0.25:
        unreachable = {"output": content["criterion"]["output"], "lower": 1e6}
        content["constraints"] = [*content.get("constraints", []), unreachable]
    return content


def _values(random: np.random.Generator, raw: Any, count: int) -> list[float]:
    """Return values within a range, ascending, of so few digits that a title shows them all."""
    if isinstance(raw, list):
        chosen = random.choice(len(raw), min(count, len(raw)), replace=False)
        return [raw[k] for k in sorted(chosen)]
    ends = raw["start"], raw["stop"]
    drawn = {float(f"{value:.3g}") for value in random.uniform(min(ends), max(ends), count)}
    return sorted(drawn)


def _uncertain(random: np.random.Generator) -> Content:
    """Return a study of one uncertain parameter, of closed forms or of motion."""
    middle = {"friction": 0.35, "amplitude": 2.5e-4, "beta": 30.0}
    name = str(random.choice([*middle]))
    parameters: Content = {"frequency": 50.0, **middle}
    nominal = parameters.pop(name)
    width = float(f"{nominal * random.uniform(0.05, 0.2):.3g}")
    known = random.choice(["interval", "normal"])
    uncertain = {"lower": nominal - width, "upper": nominal + width}
    if known == "normal":
        uncertain = {"mean": nominal, "deviation": width / 2}
    output = str(random.choice(["conveying_velocity", "acceleration_x"]))
    if output == "acceleration_x" and name != "amplitude":
        # Closed forms hold below lift-off; above it a picture has nothing to show, and draws.
        parameters["amplitude"] = float(random.choice([5e-5, 5e-5, 5e-4]))
    if name != "beta" and random.random() < 0.5:
        parameters["beta"] = _values(random, {"start": 15.0, "stop": 45.0}, 3)
    return {
        "kind": "sensitivity",
        "scene": "rectangle-on-plane",
        "outputs": [output],
        "parameters": parameters,
        "uncertain": {name: uncertain},
    }


def is_reduced(content: Content) -> bool:
    """True of a sweep that keeps statistics in place of cells."""
    return content["kind"] == "sweep" and "reduce" in content
