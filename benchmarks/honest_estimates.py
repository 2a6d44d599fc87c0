"""Are stated errors honest? Random studies with a better reference; `python -m benchmarks.honest_estimates`.

For each estimate: how many studies could be judged, in which share the true error exceeds the stated
one, and the largest ratio of the two. The aim: less than 1 %, and no ratio above 10.
"""  # noqa: E501

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.motion.motion import STATUS, Motion
from core.motion.planar import planar_motion
from core.motion.regularised import regularised_motion
from core.motion.stepping import planar_stepped_motion, stepped_motion

Groups = dict[str, Any]
Array = np.ndarray
STEPS = (50, 100, 200, 500)
REPEATS = (STATUS["periodic"], STATUS["at_rest"])
SHARE, RATIO = 0.01, 10.0
"""Largest share of studies whose error exceeds the stated one, and largest excess."""


@dataclass(frozen=True)
class Measured:
    """How honest an estimate is.

    Attributes
    ----------
    name : str
        The estimate, and the reference.
    studies, judged : int
        Studies run, and those with a reference that is good enough.
    exceeded : float
        Share of the judged in which the true error is larger than stated.
    worst : float
        Largest ratio of true to stated error.
    median : float
        Median ratio: far below 1 the estimate exaggerates.
    seconds : float
        Run time.
    elsewhere : bool
        Whether studies are among them that end in another motion than the reference. With
        restitution several lie beside each other; how far apart they are no estimate tells.
    """

    name: str
    studies: int
    judged: int
    exceeded: float
    worst: float
    median: float
    seconds: float
    elsewhere: bool = False

    @property
    def honest(self) -> bool:
        """Whether the aim is met."""
        return self.exceeded < SHARE and (self.elsewhere or self.worst <= RATIO)


def random_groups(
    count: int, seed: int, *, throw: tuple[float, float] = (0.1, 4.0), most_restitution: float = 0.9
) -> Groups:
    """Return planar groups: every mode of motion, a third without restitution, a third mu_s > mu_k.

    A quarter lies on the level, where much is symmetric.
    """
    random = np.random.default_rng(seed)
    beta = np.radians(random.uniform(5, 85, count))
    gamma = np.radians(random.uniform(-8, 8, count)) * (random.random(count) > 0.25)
    drive = random.uniform(*throw, count) * np.cos(gamma) / np.sin(beta)
    kinetic = random.uniform(0.05, 1.2, count)
    static = kinetic * np.where(random.random(count) < 1 / 3, random.uniform(1, 1.5, count), 1.0)
    restitution = random.uniform(0, most_restitution, count) * (random.random(count) > 1 / 3)
    return {
        "drive_number_along": drive * np.cos(beta),
        "drive_number_normal": drive * np.sin(beta),
        "gravity_number_along": np.sin(gamma),
        "gravity_number_normal": np.cos(gamma),
        "friction_static": static,
        "friction_kinetic": kinetic,
        "restitution": restitution,
    }


def by_events(groups: Groups, most_periods: float = 1000.0) -> Motion:
    """Return the motion from event to event."""
    return planar_motion(**groups, tolerance=np.array(1e-12), most_periods=np.array(most_periods))


def judge(
    name: str,
    found: Motion,
    value: Array,
    error: Array,
    good: Array,
    took: float,
    *,
    elsewhere: bool = False,
) -> Measured:
    """Return how honest the errors of `found` are, against values that are known to `error`.

    Both errors count: the reference may be wrong by its own.
    """
    answered = good & np.isfinite(found.velocity) & np.isfinite(value)
    true = np.abs(found.velocity - value)[answered]
    stated = (found.error + error)[answered]
    ratio = np.where(true > 0, true / np.maximum(stated, 1e-300), 0.0)
    return Measured(
        name, found.velocity.size, ratio.size, float(np.mean(ratio > 1)), float(ratio.max()),
        float(np.median(ratio)), took, elsewhere,
    )  # fmt: skip


def _pieces(groups: Groups, parts: int) -> list[Groups]:
    return [{name: values[i::parts] for name, values in groups.items()} for i in range(parts)]


def _joined(motions: list[Motion]) -> Motion:
    return Motion._make([np.concatenate(fields) for fields in zip(*motions, strict=True)])


def stepping_against_events(count: int) -> list[Measured]:
    """Return the time stepping's estimate in the plane; those that repeat, and all others."""
    groups = random_groups(count, 1)
    pieces = _pieces(groups, len(STEPS))
    exact = _joined([by_events(piece) for piece in pieces])
    started = time.perf_counter()
    found = _joined([
        planar_stepped_motion(**piece, steps_per_period=steps)
        for piece, steps in zip(pieces, STEPS, strict=True)
    ])  # fmt: skip
    took = time.perf_counter() - started
    both = np.isin(exact.status, REPEATS) & np.isin(found.status, REPEATS)
    either = np.isin(exact.status, (*REPEATS, STATUS["aperiodic"]))
    return _same_and_all("time stepping", found, exact, both, either, took)


def spatial_against_events(count: int) -> list[Measured]:
    """Return the time stepping's estimate in space: a level plane, the drive turned."""
    groups = random_groups(count, 2)
    groups["gravity_number_along"] = np.zeros(count)
    turn = np.random.default_rng(3).uniform(0.1, 1.4, count)
    exact = by_events(groups)
    started = time.perf_counter()
    along = groups.pop("drive_number_along")
    found = stepped_motion(
        **groups, drive_number_along=along * np.cos(turn), drive_number_across=along * np.sin(turn),
        gravity_number_across=0.0, steps_per_period=100,
    )  # fmt: skip
    took = time.perf_counter() - started
    both = np.isin(exact.status, REPEATS) & np.isin(found.status, REPEATS)
    either = np.isin(exact.status, (*REPEATS, STATUS["aperiodic"]))
    share = np.cos(turn)
    exact = exact._replace(velocity=exact.velocity * share, error=exact.error * share)
    return _same_and_all("time stepping in space", found, exact, both, either, took)


def _same_and_all(
    name: str, found: Motion, exact: Motion, both: Array, either: Array, took: float
) -> list[Measured]:
    """Return one row for studies that repeat with as many impacts, and one for all."""
    same = both & (np.abs(found.impacts - exact.impacts) < 0.5)
    return [
        judge(f"{name}, same motion", found, exact.velocity, exact.error, same, took),
        judge(f"{name}, all", found, exact.velocity, exact.error, either, took, elsewhere=True),
    ]


def events_against_closed_form(count: int) -> list[Measured]:
    """Return the events' estimate where one hop lasts n periods, theory 13.8."""
    random = np.random.default_rng(4)
    groups = random_groups(count, 5)
    restitution = random.uniform(0, 0.8, count) * (random.random(count) > 0.3)
    loss = (1 - restitution) / (1 + restitution)
    hops = random.integers(1, 4, count)
    # One impact in n periods of the drive: between s = pi n loss and where it doubles.
    least = np.pi * hops * loss
    beta = np.arctan2(groups["drive_number_normal"], groups["drive_number_along"])
    gn = groups["gravity_number_normal"]
    drive = np.hypot(least, random.uniform(1.01, 2, count)) * gn
    groups["drive_number_normal"] = drive
    groups["drive_number_along"] = drive / np.tan(beta)
    groups["restitution"] = restitution
    groups["friction_kinetic"] = groups["friction_static"] = random.uniform(0.5, 3, count)
    started = time.perf_counter()
    found = by_events(groups)
    took = time.perf_counter() - started
    value = np.pi * hops * (loss * gn / np.tan(beta) - groups["gravity_number_along"])
    one = (found.multiple == hops) & (found.impacts * hops == 1) & (found.flight > 1 - 1e-9)
    rounding = 8 * 2.0**-52 * np.pi * hops * (gn / np.tan(beta) + 1)
    return [judge("events, one hop in n periods", found, value, rounding, one, took)]


def chaos_against_longer(count: int) -> list[Measured]:
    """Return the events' estimate of motions that do not repeat, against 40 times the periods."""
    groups = random_groups(4 * count, 6, throw=(1.5, 6.0))
    started = time.perf_counter()
    found = by_events(groups)
    took = time.perf_counter() - started
    chaotic = np.flatnonzero(found.status == STATUS["aperiodic"])[:count]
    found = Motion._make([field[chaotic] for field in found])
    longer = by_events({name: values[chaotic] for name, values in groups.items()}, 40_000.0)
    good = longer.status == STATUS["aperiodic"]
    # The reference's own scatter is a sixth of what is judged: it is not added.
    none = np.zeros(chaotic.size)
    return [judge("events, no repetition", found, longer.velocity, none, good, took)]


def regularised_against_events(count: int) -> list[Measured]:
    """Return the estimate of regularised friction; a second a study."""
    groups = random_groups(4 * count, 7, throw=(0.3, 3.0), most_restitution=0.5)
    # What does not repeat uses up all evaluations, and states no error.
    some = np.flatnonzero(np.isin(by_events(groups).status, REPEATS))[:count]
    groups = {name: values[some] for name, values in groups.items()}
    exact = by_events(groups)
    started = time.perf_counter()
    found = regularised_motion(
        **groups, drive_number_across=0.0, gravity_number_across=0.0, slip_speed=1e-4,
        contact_stiffness=1e8, tolerance=1e-7, most_periods=100, solver="Radau", planar=True,
    )  # fmt: skip
    took = time.perf_counter() - started
    both = np.isin(exact.status, REPEATS) & np.isin(found.status, REPEATS)
    return [judge("regularised", found, exact.velocity, exact.error, both, took)]


ESTIMATES: dict[str, tuple[Callable[[int], list[Measured]], int]] = {
    "stepping": (stepping_against_events, 1),
    "spatial": (spatial_against_events, 1),
    "events": (events_against_closed_form, 1),
    "chaos": (chaos_against_longer, 1),
    "regularised": (regularised_against_events, 100),  # as many times fewer studies
}


def main() -> None:
    """Print a row for each estimate; end with 1 if one is not honest."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="estimate", help=", ".join(ESTIMATES))
    parser.add_argument("--studies", type=int, default=10_000)
    arguments = parser.parse_args()
    print("| estimate | studies | judged | exceeded | worst ratio | median ratio | s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    honest = True
    for name in arguments.names or ESTIMATES:
        measure, fewer = ESTIMATES[name]
        for row in measure(max(10, arguments.studies // fewer)):
            honest &= row.honest
            print(
                f"| {row.name} | {row.studies:,} | {row.judged:,} | {row.exceeded:.2%} | "
                f"{row.worst:.3g} | {row.median:.2g} | {row.seconds:.0f} |",
                flush=True,
            )
    sys.exit(not honest)


if __name__ == "__main__":
    main()
