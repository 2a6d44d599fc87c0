"""Do prices tell what studies take? Random studies of all kinds and methods; `python -m benchmarks.prices`.

For each kind and method: how many studies were run, the median and the ends of stated over measured
time, and in which share of them the two are within a factor of 3. Stated is the price after a trial;
the last lines are for what `vibrafeed run --dry-run` says, which tries from 5 s on, for prices by
formula alone, and for what a trial takes. All times are of the processor, so that others on the
machine do not count. What takes less than `NOTHING` is the same for whoever decides between a reply and a
job.
"""  # noqa: E501

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.options import options
from benchmarks.timing import least
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS, methods_of
from vibrafeed.core.watch import Watch

NOTHING = 0.01  # s: shorter times are those of labels and of looking things up
WITHIN = 3.0
MOST = 30.0  # s of one study; what takes longer is stopped, and counts as if it took that

Random = np.random.Generator
Content = dict[str, Any]

CONFIGS = Path(__file__).resolve().parent.parent / "configs"


def log_uniform(random: Random, low: float, high: float) -> float:
    """Return a random number with uniform logarithm."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def drive(random: Random) -> dict[str, Any]:
    """Return a random drive: mostly a sine, else harmonics or steps."""
    frequency = log_uniform(random, 20, 120)
    gravity, beta = 9.81, random.uniform(5, 60)
    lift = random.uniform(0.1, 4.0) * gravity / (2 * np.pi * frequency) ** 2  # throw number 0.1-4
    kind = random.choice(["sine", "sine", "sine", "harmonics", "steps"])
    if kind == "sine":
        return {"frequency": frequency, "amplitude": lift / np.sin(np.radians(beta)), "beta": beta}
    if kind == "harmonics":
        order = int(random.integers(2, 6))
        return {
            "frequency": frequency,
            "amplitude_along_1": 2 * lift,
            f"amplitude_along_{order}": 0.5 * lift / order,
            f"phase_along_{order}": random.uniform(-180, 180),
            "amplitude_normal_1": lift,
        }
    return {
        "frequency": frequency,
        "acceleration_along_1": random.uniform(2, 30),
        "acceleration_along_2": -random.uniform(2, 30),
        "duration_1": random.uniform(1, 4),
        "duration_2": random.uniform(1, 4),
        "duration_3": random.uniform(1, 4),
    }


def conveying(random: Random) -> Content:
    """Return a random study of a conveyed part."""
    scene = str(random.choice(list(CONTACTS)))
    method = str(random.choice(list(SYSTEMS[scene].variants)))
    given = drive(random)
    friction = random.uniform(0.1, 0.9)
    given |= (
        {"friction": friction}
        if random.random() < 2 / 3
        else {"friction_kinetic": friction, "friction_static": friction * random.uniform(1, 1.5)}
    )
    if random.random() < 0.6:
        given["restitution"] = random.uniform(0, 0.8)
    if random.random() < 0.5:
        given["gamma"] = random.uniform(-4, 4)
    if "beta" in given and random.random() < 0.4:
        given["alpha"] = random.uniform(1, 20)
    if scene == "rectangle-on-track" and random.random() < 0.6:
        given["delta"] = random.uniform(0, 15)
        given["radius"] = random.uniform(0.1, 1)
    slow = method.startswith(("reference", "regularised"))
    most = 60 if slow else 5000
    settings = {
        "max_periods": lambda: int(log_uniform(random, 8, most)),
        "steps_per_period": lambda: int(log_uniform(random, 20, 3000)),
        "tolerance": lambda: (
            log_uniform(random, 1e-9, 1e-5) if slow else log_uniform(random, 1e-13, 1e-6)
        ),
        "slip_speed": lambda: log_uniform(random, 1e-4, 1e-2),
        "contact_stiffness": lambda: log_uniform(random, 1e5, 1e8),
    }
    known = methods_of(scene)[method].defaults
    chosen = {n: draw() for n, draw in settings.items() if n in known and random.random() < 0.7}
    if not slow and random.random() < 0.7:
        name = "friction_kinetic" if "friction_kinetic" in given else "friction"
        ends = {"start": 0.5 * given[name], "stop": given[name]}
        given[name] = {**ends, "num": int(log_uniform(random, 2, 300))}
    return {
        "kind": "simulate", "scene": scene, "method": method, **chosen, "parameters": given,
    }  # fmt: skip


def tumbling(random: Random) -> Content:
    """Return a random study of a tumbling part."""
    scene = str(random.choice([name for name in SYSTEMS if name not in CONTACTS]))
    other = "diameter" if scene.startswith("cylinder") else "height"
    given: dict[str, Any] = {
        "length": log_uniform(random, 0.003, 0.1),
        other: log_uniform(random, 0.003, 0.05),
        "drop_height": log_uniform(random, 0.001, 0.1),
        "pitch": {"start": 0, "stop": 90, "num": int(log_uniform(random, 2, 200))},
        "friction": random.uniform(0.05, 0.8),
        "restitution": random.uniform(0, 0.8),
        "duration": log_uniform(random, 0.1, 20),
    }
    if random.random() < 0.5:
        frequency = log_uniform(random, 10, 100)
        lift = random.uniform(0.2, 3) * 9.81 / (2 * np.pi * frequency) ** 2
        given |= {"frequency": frequency, "amplitude": 2 * lift, "beta": 30}
    method = str(random.choice(list(SYSTEMS[scene].variants)))
    return {
        "kind": "simulate", "scene": scene, "method": method, "parameters": given,
        "outputs": ["settling_time"],
    }  # fmt: skip


def example(random: Random, pattern: str) -> Content:
    """Return an example study with other numbers of values on its axes."""
    paths = sorted(CONFIGS.glob(pattern))
    content = load_study(paths[random.integers(len(paths))]).content()
    for values in content["parameters"].values():
        if isinstance(values, dict) and "num" in values:
            values["num"] = max(2, int(values["num"] * log_uniform(random, 0.02, 2)))
    return dict(content)


def sweeping(random: Random) -> Content:
    """Return a random sweep of closed forms."""
    return example(random, "figures/*.toml")


def optimising(random: Random) -> Content:
    """Return a random optimisation."""
    return example(random, "optimise-*.toml")


FAMILIES: tuple[tuple[float, Callable[[Random], Content]], ...] = (
    (0.7, conveying),
    (0.15, tumbling),
    (0.1, sweeping),
    (0.05, optimising),
)
"""What studies there are, and the share of each."""


def studies(seed: int) -> Iterator[Content]:
    """Yield random valid studies."""
    random = np.random.default_rng(seed)
    shares = [share for share, _ in FAMILIES]
    while True:
        content = FAMILIES[random.choice(len(FAMILIES), p=shares)][1](random)
        try:
            prepare_content(content)
        except StudyError:
            continue
        yield content


class Measured(NamedTuple):
    """What a study is said to take: tried, by formula, as told; what it and the trial take [s]."""

    said: float
    by_formula: float
    stated: float
    took: float
    trial: float


def measured(content: Content) -> Measured:
    """Return what a study is said to take, and what it takes, on one core."""
    prepared = prepare_content(content)
    started = time.process_time()
    said = prepared.tried_seconds
    trial = time.process_time() - started
    since = time.process_time()
    watch = Watch(threads=1, stop=lambda: time.process_time() - since > MOST)
    took = least(1, partial(tabulate, prepared, watch=watch), time.process_time)
    return Measured(said, prepared.seconds, prepared.stated_seconds, took, trial)


def name_of(content: Content) -> str:
    """Return kind and method of a study."""
    prepared = prepare_content(content)
    return f"{content['kind']} {getattr(prepared, 'method_name', prepared.plan.variant)}"


def main() -> None:
    """Print how well predicted times agree with measured ones."""
    asked = options(__doc__, studies=200, seed=0)
    found: dict[str, list[Measured]] = defaultdict(list)
    for number, content in enumerate(studies(asked.seed)):
        if number == asked.studies:
            break
        name = name_of(content)
        if name not in found:
            measured(content)  # what is compiled or loaded is no price of a study
        found[name].append(measured(content))
    everything = [one for some in found.values() for one in some]
    for name, some in [*sorted(found.items()), ("all", everything)]:
        print(line(name, [_ratio(one.said, one.took) for one in some]))
    print(line("all, as stated", [_ratio(one.stated, one.took) for one in everything]))
    print(line("all, by formula", [_ratio(one.by_formula, one.took) for one in everything]))
    trials = np.array([one.trial for one in everything])
    print(
        f"a trial takes {1e3 * np.median(trials):.0f} ms, in 95 % at most "
        f"{1e3 * np.quantile(trials, 0.95):.0f} ms, once {1e3 * trials.max():.0f} ms"
    )


def line(name: str, ratios: list[float]) -> str:
    """Return the line for some ratios of stated and measured times."""
    values = np.array(ratios)
    near = np.mean((values <= WITHIN) & (values >= 1 / WITHIN))
    return (
        f"{name:40} {values.size:5} studies  stated/measured: median {np.median(values):6.2f}, "
        f"from {values.min():8.3g} to {values.max():8.3g}; within 3: {near:6.1%}"
    )


def _ratio(said: float, took: float) -> float:
    return max(min(said, MOST), NOTHING) / max(took, NOTHING)


if __name__ == "__main__":
    main()
