"""Judges every status of motion on the track; `python -m benchmarks.every_status`.

Random cells of six families, as clean numbers that people write, and as any. Each is judged by its own course from
rest, followed without any jump for many periods: the mean that is told has to be that of the course within both errors,
whatever the status. Errors of `aperiodic` are statistical, at 99 %; those of the other statuses are bounds.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.options import options
from vibrafeed.core.motion.kernels import means
from vibrafeed.core.motion.kernels.constants import COLUMN, RESULTS, STATUS, TALLY
from vibrafeed.core.motion.kernels.inputs import NEVER, Flags, Floats, cell_of
from vibrafeed.core.motion.kernels.track import push, solve_cells
from vibrafeed.core.motion.kernels.track.push import TURN, at_rest, new_work
from vibrafeed.core.motion.kernels.track.settling import (
    follow_within_limits,
    new_history,
    state_distance,
)
from vibrafeed.core.motion.kernels.track.space_cells import FINE
from vibrafeed.core.motion.method import Contacts, Groups, cells_of
from vibrafeed.core.quantities import MOTION_STATUSES

GRAVITY = 9.80665
TRACK = Contacts(wall=True)
ROUNDING = 1e-9
"""Of the drive's speed: what a course is known to at best."""


def groups_of(
    *, frequency: Floats, amplitude: Floats, alpha: Floats, beta: Floats, gamma: Floats | float,
    delta: Floats, friction: Floats, restitution: Floats | float = 0.0,
) -> Groups:  # fmt: skip
    """Return the groups of parts on a straight track; lengths in metres, angles in degrees."""
    alpha, beta, gamma, delta = (np.radians(angle) for angle in (alpha, beta, gamma, delta))
    number = amplitude * np.square(2 * np.pi * frequency) / GRAVITY
    return Groups(
        drive_number_along=number * np.cos(beta) * np.cos(alpha),
        drive_number_across=number * np.cos(beta) * np.sin(alpha),
        drive_number_normal=number * np.sin(beta),
        gravity_number_along=np.sin(gamma),
        gravity_number_across=np.cos(gamma) * np.sin(delta),
        gravity_number_normal=np.cos(gamma) * np.cos(delta),
        friction_static=friction,
        friction_kinetic=friction,
        wall_friction=friction,
        restitution=restitution,
        wall_restitution=restitution,
    )


def clean(random: Generator, count: int) -> Groups:
    """Return random cells with round numbers, as people write them."""
    angles = np.array([5.0, 10.0, 15.0, 20.0])
    return groups_of(
        frequency=random.choice([50.0, 60.0, 100.0], count),
        amplitude=1e-3 * random.choice(np.arange(0.1, 0.45, 0.05), count),
        alpha=random.choice([*-angles, *angles], count),
        beta=random.choice(np.arange(10.0, 31.0, 5.0), count),
        gamma=0.0,
        delta=random.choice([0.0, 2.0, 5.0, 8.0, 10.0], count),
        friction=random.choice(np.arange(0.2, 0.51, 0.05), count),
    )


def anywhere(random: Generator, count: int, friction: Floats, rebounds: float = 0.0) -> Groups:
    """Return random cells with this friction and restitution up to a limit."""
    pick = random.uniform
    climb = pick(-1.0, 1.0, count) * (pick(size=count) < 0.5)  # degrees; half are level
    return groups_of(
        frequency=pick(30.0, 100.0, count),
        amplitude=1e-3 * pick(0.05, 0.4, count),
        alpha=pick(-25.0, 25.0, count),
        beta=pick(8.0, 40.0, count),
        gamma=climb * np.minimum(1.0, 40.0 * friction),
        delta=pick(0.0, 12.0, count),
        friction=friction,
        restitution=pick(0.1 * rebounds, rebounds, count),
    )


FAMILIES: dict[str, Callable[[Generator, int], Groups]] = {
    "clean": clean,
    "friction 0.2 to 0.6": lambda r, n: anywhere(r, n, r.uniform(0.2, 0.6, n)),
    "friction 0.05 to 0.2": lambda r, n: anywhere(r, n, r.uniform(0.05, 0.2, n)),
    "friction 0.01 to 0.05": lambda r, n: anywhere(r, n, r.uniform(0.01, 0.05, n)),
    "friction 1e-9 to 1e-2": lambda r, n: anywhere(r, n, 10 ** r.uniform(-9.0, -2.0, n)),
    "rebounds": lambda r, n: anywhere(r, n, r.uniform(0.1, 0.6, n), rebounds=0.6),
}


class Judged(NamedTuple):
    """What is told of cells, and what their own course comes to.

    Attributes
    ----------
    table, status : ndarray
        Of the method; a row a cell, columns as in `COLUMN`.
    course : ndarray
        Mean velocity of the course; NaN where it still drifts.
    doubt : ndarray
        What the course does not know of that.
    multiple : ndarray
        Periods after which the course repeats; 0 where it does not.
    speed : ndarray
        The drive's speed.
    """

    table: Floats
    status: Flags
    course: Floats
    doubt: Floats
    multiple: Flags
    speed: Floats

    @property
    def off(self) -> Floats:
        """The deviation of the mean beyond the stated errors of method and long run."""
        return np.abs(self.table[:, COLUMN.velocity] - self.course) - (
            self.table[:, COLUMN.error] + self.doubt
        )


def course_of(row: Floats, periods: int, contacts: Contacts = TRACK) -> tuple[float, float, int]:
    """Return mean, uncertainty and period multiple of a long run from rest."""
    wall, rolling = contacts.wall, float(contacts.rolling)
    cell, work, (state, hold) = cell_of(row), new_work(), at_rest()
    push.set_drive(cell, row, work)
    speed = float(push.drive_speed(work))
    history = new_history(periods, NEVER)
    found, _ = follow_within_limits(
        cell, wall, rolling, FINE, periods, 0, state, hold, history, work
    )
    if found.status == STATUS.limit_reached:
        return np.nan, np.nan, 0
    travel = history.tallies[: found.periods, TALLY.travel] / TURN
    if found.multiple == 0:
        batches = means.batch_means(travel)
        if not means.is_steady(batches, ROUNDING * speed):
            return np.nan, np.nan, 0
        return float(np.mean(batches)), means.mean_error(batches) + ROUNDING * speed, 0
    left, cycles = found.transient, found.periods // 4 // found.multiple
    if cycles > 4:  # the ratio of a cycle, from many: those at the end are rounding
        last = found.periods - 1 - cycles * found.multiple
        before = state_distance(wall, rolling, history, last, last - found.multiple + 1)
        change = state_distance(
            wall, rolling, history, found.periods - 1, found.periods - found.multiple
        )
        if 0.0 < change < before:
            ratio = (change / before) ** (1.0 / cycles)
            left = max(left, change * ratio / (1.0 - ratio))
    mean = float(np.mean(travel[-found.multiple :]))
    return mean, left + ROUNDING * speed, found.multiple


def judged(groups: Groups, *, max_periods: int, periods: int, threads: int = 1) -> Judged:
    """Return results of cells by the method, and by long runs."""
    settings = {"tolerance": 1e-12, "max_periods": float(max_periods)}
    rows, _ = cells_of(groups, **settings)
    table, status = np.empty((len(rows), RESULTS)), np.zeros(len(rows), dtype=np.int8)

    def one(number: int) -> tuple[float, float, int]:
        """Return mean, uncertainty and multiple of one cell by a long run."""
        piece = slice(number, number + 1)
        solve_cells(True, 0.0, rows[piece], table[piece], status[piece], NEVER)
        if np.isnan(table[number, COLUMN.velocity]):
            return np.nan, np.nan, 0  # nothing is told
        return course_of(rows[number], periods)

    with ThreadPoolExecutor(threads) as pool:
        courses = np.array(list(pool.map(one, range(len(rows)))))
    speed = np.sqrt(np.square(rows[:, :3]).sum(axis=1))
    multiple = courses[:, 2].astype(np.int64)
    return Judged(table, status, courses[:, 0], courses[:, 1], multiple, speed)


def lines(name: str, found: Judged) -> Iterator[str]:
    """Return a table row for each status."""
    for status, flag in MOTION_STATUSES.items():
        here = found.status == flag.value
        if not here.any():
            continue
        known = here & np.isfinite(found.off)
        wrong = known & (found.off > 0.0)
        gross = wrong & (found.off > 0.01 * found.speed)
        stated = (found.table[:, COLUMN.error] / found.speed)[here]
        told = found.table[:, COLUMN.multiple]
        other = known & (told > 0) & (found.multiple > 0) & (told != found.multiple)
        share = f"{100 * wrong.sum() / known.sum():.2f} %" if known.any() else "-"
        yield (
            f"| {name} | {status} | {here.sum()} | {known.sum()} | {wrong.sum()} | {share} | "
            f"{gross.sum()} | {np.median(stated):.1e} | {other.sum()} |"
        )


def main() -> None:
    """Print a table row for each family and status, and for all."""
    arguments = options(
        __doc__,
        cells=(1000, "of each family"),
        seed=28,
        most=(1000, "periods of the method"),
        periods=(10_000, "of a course"),
        threads=2,
        worst=(0, "cells to show of each family"),
    )
    print(
        "| cells | status | number | judged | error exceeded | share | by more than 0.01 A w | "
        "stated/A w: median | other multiple |"
    )
    print("| --- " * 9 + "|")
    every = []
    for place, (name, family) in enumerate(FAMILIES.items()):
        random = np.random.default_rng([arguments.seed, place])
        groups = family(random, arguments.cells)
        found = judged(
            groups, max_periods=arguments.most, periods=arguments.periods,
            threads=arguments.threads,
        )  # fmt: skip
        every.append(found)
        print(*lines(name, found), sep="\n", flush=True)
        wrong = np.flatnonzero(found.off > 0.0)
        for cell in wrong[np.argsort(-found.off[wrong])][: arguments.worst]:
            numbers = [float(np.broadcast_to(n, found.speed.shape)[cell]) for n in groups.numbers]
            print("#", cell, *(column[cell].tolist() for column in found), numbers)
    print(*lines("all", Judged(*map(np.concatenate, zip(*every, strict=True)))), sep="\n")


if __name__ == "__main__":
    main()
