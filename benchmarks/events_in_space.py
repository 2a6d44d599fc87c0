"""Prints error, time and status of exact motion in space; `python -m benchmarks.events_in_space`.

Random cells of ten kinds, each judged by a run of the same events with series of order 24 and terms of 1e-13, whose
own error the reference bounds (`tests/laws/test_spatial_events.py`).
"""  # noqa: E501

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from benchmarks.options import options
from benchmarks.timing import least
from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.groups import SOLID_CYLINDER, Contacts, Groups, cells_of
from vibrafeed.core.motion.kernels.arrays import NEVER, Floats
from vibrafeed.core.motion.kernels.cells import cell_of
from vibrafeed.core.motion.kernels.means import mean_velocity
from vibrafeed.core.motion.kernels.results import RESULTS, TALLY
from vibrafeed.core.motion.kernels.track import drive, solve_cells
from vibrafeed.core.motion.kernels.track.cycle import Series, new_history, settle
from vibrafeed.core.motion.kernels.track.tables import TURN, at_rest, new_work
from vibrafeed.core.motion.result import STATUS, Motion, motion_of

WITNESS = Series(24, 1e-13)
SETTINGS = {"tolerance": 1e-12, "max_periods": 1000.0}
REPEATS = [STATUS[name] for name in ("at_rest", "periodic", "neutral")]


class Kind(NamedTuple):
    """What the cells of a kind have in common."""

    throw: tuple[float, float]
    wall: bool = False
    rolling: float = 0.0
    curved: bool = False
    static: tuple[float, float] = (1.0, 1.0)
    restitution: tuple[float, float] = (0.0, 0.0)

    @property
    def contacts(self) -> Contacts:
        """The surfaces that the part can touch."""
        return Contacts(self.wall, self.rolling)


RESTS, HOPS, ANY = (0.2, 0.97), (1.05, 3.0), (0.2, 3.0)
KINDS = {
    "plane, no hops": Kind(RESTS),
    "plane, hops": Kind(HOPS),
    "plane, static above kinetic": Kind(ANY, static=(1.05, 1.4)),
    "cylinder": Kind(ANY, rolling=SOLID_CYLINDER),
    "wall, no hops": Kind(RESTS, wall=True),
    "wall, hops": Kind(HOPS, wall=True),
    "wall, curved, no hops": Kind(RESTS, wall=True, curved=True),
    "wall, curved, hops": Kind(HOPS, wall=True, curved=True),
    "wall, curved, static above kinetic": Kind(ANY, wall=True, curved=True, static=(1.05, 1.4)),
    "wall, curved, rebounds": Kind(HOPS, wall=True, curved=True, restitution=(0.05, 0.4)),
}


def random_groups(kind: Kind, count: int, seed: int) -> Groups:
    """Return random cells of one kind, as on a feeder's track."""
    pick = np.random.default_rng(seed).uniform
    beta, alpha = np.radians(pick(10, 50, count)), np.radians(pick(5, 35, count))
    if kind.wall:
        alpha *= np.where(pick(0, 1, count) < 0.7, 1.0, -1.0)
    gamma = np.radians(pick(0, 4, count))
    delta = np.radians(pick(2, 20, count)) if kind.wall else np.zeros(count)
    normal = np.cos(gamma) * np.cos(delta)
    size = pick(*kind.throw, count) * normal / np.sin(beta)
    kinetic, bounce = pick(0.15, 0.8, count), pick(*kind.restitution, count)
    return Groups(
        drive_number_along=size * np.cos(beta) * np.cos(alpha),
        drive_number_across=size * np.cos(beta) * np.sin(alpha),
        drive_number_normal=size * np.sin(beta),
        gravity_number_along=np.sin(gamma),
        gravity_number_across=np.cos(gamma) * np.sin(delta),
        gravity_number_normal=normal,
        curvature_number=10 ** pick(-3, -1, count) if kind.curved else 0.0,
        friction_static=kinetic * pick(*kind.static, count),
        friction_kinetic=kinetic,
        wall_friction=kinetic,
        restitution=bounce,
        wall_restitution=bounce,
    )


def speed_of(groups: Groups) -> Floats:
    """Return the drive's speed A w of cells, in g/w."""
    numbers = groups.drive_number_along, groups.drive_number_across, groups.drive_number_normal
    return np.sqrt(sum(np.square(number) for number in numbers))


@compiled
def witnessed(wall: bool, rolling: float, series: Series, rows: Floats, found: Floats) -> None:
    """Fill mean velocity and period multiple of cells from runs with other series."""
    history = new_history(int(rows[0, -1]), np.zeros(1, dtype=np.int8))
    for number in range(rows.shape[0]):
        cell = cell_of(rows[number])
        state, hold = at_rest()
        work = new_work()
        drive.set_drive(cell, rows[number], work)
        end = settle(cell, wall, rolling, series, int(cell.max_periods), state, hold, history, work)
        found[number, 0], found[number, 1] = np.nan, end.multiple
        if end.multiple > 0:
            travel = history.tallies[:, TALLY.travel]
            found[number, 0] = mean_velocity(travel, end.done - end.multiple, end.done, TURN)


def timed(kind: Kind, rows: Floats, repeats: int) -> tuple[Motion, Floats]:
    """Return the motion of cells, computed one by one, and the least time of each [s]."""
    seconds = np.empty(len(rows))
    table, status = np.empty((len(rows), RESULTS)), np.zeros(len(rows), dtype=np.int8)
    for number in range(len(rows)):
        piece = slice(number, number + 1)
        cell = rows[piece], table[piece], status[piece], NEVER
        seconds[number] = least(repeats, partial(solve_cells, kind.wall, kind.rolling, *cell))
    return motion_of(table, status, (len(rows),)), seconds


def main() -> None:
    """Print a table row for each kind of cell and one for all."""
    arguments = options(
        __doc__,
        cells=(1000, "of each kind"),
        seed=14,
        repeats=(2, "of each timing"),
        worst=(0, "cells to show of each kind"),
    )
    every: dict[str, list[Floats]] = {}
    print(
        "| cells | repeat | error/A w: median | 99 % | worst | stated: median | exceeded | "
        "multiple differs | found by one | us: median | mean | 99 % | us a period that does not |"
    )
    print("| --- " * 13 + "|")

    def show(name: str, of: dict[str, Floats]) -> None:
        """Print the table row of some cells."""
        both = of["repeats"] & np.isfinite(of["truth"])
        error, stated = of["error"][both], of["stated"][both]
        took = 1e6 * of["seconds"]
        other = ~of["repeats"] & (of["status"] == STATUS["aperiodic"])
        periods = np.median(took[other]) / SETTINGS["max_periods"] if other.any() else np.nan
        print(
            f"| {name} | {both.sum()} of {both.size} | {np.median(error):.1e} | "
            f"{np.quantile(error, 0.99):.1e} | {error.max():.1e} | {np.median(stated):.1e} | "
            f"{np.count_nonzero(error > stated)} | "
            f"{np.count_nonzero((of['multiple'] != of['cycle'])[both])} | "
            f"{np.count_nonzero(of['repeats'] != np.isfinite(of['truth']))} | "
            f"{np.median(took[both]):.0f} | {took[both].mean():.0f} | "
            f"{np.quantile(took[both], 0.99):.0f} | "
            f"{periods:.1f} ({other.sum()}) |",
            flush=True,
        )

    for place, (name, kind) in enumerate(KINDS.items()):
        groups = random_groups(kind, arguments.cells, arguments.seed + place)
        rows, _ = cells_of(groups, **SETTINGS)
        solve_cells(
            kind.wall,
            kind.rolling,
            rows[:1],
            np.empty((1, RESULTS)),
            np.zeros(1, dtype=np.int8),
            NEVER,
        )
        motion, seconds = timed(kind, rows, arguments.repeats)
        truth = np.empty((len(rows), 2))
        witnessed(kind.wall, kind.rolling, WITNESS, rows, truth)
        speed = speed_of(groups)
        of = {
            "status": motion.status,
            "repeats": np.isin(motion.status, REPEATS),
            "truth": truth[:, 0],
            "cycle": truth[:, 1],
            "multiple": motion.multiple,
            "error": np.abs(motion.velocity - truth[:, 0]) / speed,
            "stated": motion.error / speed,
            "seconds": seconds,
        }
        show(name, of)
        for key, value in of.items():
            every.setdefault(key, []).append(value)
        for number in np.argsort(-np.nan_to_num(of["error"]))[: arguments.worst]:
            print(number, {key: value[number] for key, value in of.items()}, rows[number].tolist())
        if arguments.worst:
            for number in np.flatnonzero(of["repeats"] != np.isfinite(of["truth"])):
                print("one", number, {key: value[number] for key, value in of.items()})
            for number in np.flatnonzero((of["multiple"] != of["cycle"]) & of["repeats"]):
                print("multiple", number, {key: value[number] for key, value in of.items()})
    joined = {key: np.concatenate(values) for key, values in every.items()}
    show("all", joined)
    print()
    names = {value: name for name, value in STATUS.items()}
    values, counts = np.unique(joined["status"], return_counts=True)
    print(", ".join(f"{names[v]}: {c}" for v, c in zip(values, counts, strict=True)))


if __name__ == "__main__":
    main()
