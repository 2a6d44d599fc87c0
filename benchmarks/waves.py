"""Prints how exact motion under any drive agrees and what it costs; `python -m benchmarks.waves`.

Random drives of one to eight harmonics on each axis, and of two to twelve steps, with random parts: closed forms in the
plane against series in space, and some of them against the reference. Bouncing parts under a plain sine against the same
as one harmonic, and under random drives against series in space: which of them repeat. Then the time of a cell under
more and more harmonics as a ratio to the plain sine, both measured in turns in one run, on one thread.
"""  # noqa: E501

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.options import options
from core.motion import planar, waves
from core.motion.groups import Contacts, Groups, cells_of, each
from core.motion.kernels import track
from core.motion.kernels.arrays import NEVER
from core.motion.methods.events import planar_motion
from core.motion.methods.reference import reference_motion
from core.motion.methods.spatial_events import spatial_motion
from core.motion.result import COLUMNS, STATUS, Motion
from core.motion.waves import ENDS, TURN, Wave

PLANAR = {"tolerance": 1e-12, "most_periods": 1000.0}
SPATIAL = {"tolerance": 1e-10, "most_periods": 400.0}
REPEATS = [STATUS["periodic"], STATUS["at_rest"]]
NAMES = {value: name for name, value in STATUS.items()}
CLOSE = 1e-9
"""Of the drive's speed: the issue's bar."""

Pick = np.random.Generator


def sizes(pick: Pick, cells: int) -> NDArray[np.float64]:
    """Return pushes from 0.3 to 3 g, along and normal."""
    return np.exp(pick.uniform(np.log(0.3), np.log(3.0), (2, cells)))


def harmonics(pick: Pick, cells: int, orders: int) -> Wave:
    """Return waves of sines with phases, along and normal."""
    found = np.zeros((3, 2, orders, cells))
    for axis, size in zip((0, 2), sizes(pick, cells), strict=True):
        share = pick.dirichlet(np.ones(orders), cells).T * size
        phase = pick.uniform(0.0, TURN, (orders, cells))
        found[axis] = share * np.cos(phase), share * np.sin(phase)
    return Wave(found, np.zeros((4, 0, cells)))


def steps(pick: Pick, cells: int, count: int) -> Wave:
    """Return waves of steps, along and normal."""
    last = pick.dirichlet(np.full(count, 2.0), cells).T
    found = np.zeros((4, count, cells))
    for axis, size in zip((0, 2), sizes(pick, cells), strict=True):
        levels = size * pick.normal(size=(count, cells))
        found[axis] = levels - (levels * last).sum(axis=0)
    found[ENDS] = TURN * np.cumsum(last, axis=0)
    found[ENDS, -1] = TURN
    return Wave(np.zeros((3, 2, 0, cells)), found)


def parts(pick: Pick, wave: Wave) -> Groups:
    """Return random parts; of some static friction is the larger, some rebound."""
    cells = wave.cells[0]
    gamma, kinetic = np.radians(pick.uniform(-5, 5, cells)), pick.uniform(0.1, 0.8, cells)
    more = np.where(pick.random(cells) < 0.4, pick.uniform(1, 1.5, cells), 1.0)
    bounce = np.where(pick.random(cells) < 0.3, pick.uniform(0, 0.7, cells), 0.0)
    along, _, normal = (waves.bound(wave, axis) for axis in range(3))
    return Groups(
        along, normal, np.sin(gamma), np.cos(gamma), more * kinetic, kinetic, bounce, wave=wave
    )


def bouncing(pick: Pick, cells: int, *, clean: bool) -> Groups:
    """Return hopping parts under a plain sine, two in three with rebounds, on numbers as typed or not.

    Throw numbers from 1 to 9; of some static friction is the larger.
    """  # noqa: E501
    if clean:
        throw, beta = pick.integers(11, 81, cells) / 10, pick.integers(2, 16, cells) * 5.0
        gamma = pick.choice([0.0, 0.0, 2.0, 5.0, -3.0], cells)
        kinetic, more = pick.integers(1, 10, cells) / 10, pick.choice([1.0, 1.0, 1.2, 1.5], cells)
        bounce = pick.choice([0.0, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5], cells)
    else:
        throw, beta = (
            np.exp(pick.uniform(np.log(1.02), np.log(9), cells)),
            pick.uniform(8, 75, cells),
        )
        gamma, kinetic = pick.uniform(-5, 5, cells), pick.uniform(0.1, 0.9, cells)
        more = np.where(pick.random(cells) < 0.4, pick.uniform(1, 1.5, cells), 1.0)
        bounce = np.where(pick.random(cells) < 0.65, pick.uniform(0, 0.7, cells), 0.0)
    beta, gamma = np.radians(beta), np.radians(gamma)
    normal = throw * np.cos(gamma)
    return Groups(
        normal / np.tan(beta), normal, np.sin(gamma), np.cos(gamma), more * kinetic, kinetic, bounce
    )


def as_harmonic(sine: Groups) -> Groups:
    """Return the same parts under the same drive, told as one harmonic."""
    pushes = np.broadcast_arrays(sine.drive_number_along, sine.drive_number_normal)
    found = np.zeros((3, 2, 1, pushes[0].size))
    found[0, 0, 0], found[2, 0, 0] = (np.ravel(push) for push in pushes)
    wave = Wave(found, np.zeros((4, 0, pushes[0].size)))
    return sine._replace(wave=wave)


def lifting(pick: Pick, wave: Wave, *, clean: bool) -> Groups:
    """Return random parts, two in three with rebounds, under a wave that lifts them 1.5 to 5 g."""
    size, cells = pick.uniform(1.5, 5.0, wave.cells), wave.cells[0]
    size = np.round(size, 1) if clean else size
    found, steps_of = wave.harmonics.copy(), wave.steps.copy()
    scale = size / waves.bound(wave, 2)
    found[2] *= scale
    steps_of[2] *= scale
    groups = parts(pick, Wave(found, steps_of))
    bounce = np.where(pick.random(cells) < 0.65, pick.uniform(0.0, 0.7, cells), 0.0)
    if not clean:
        return groups._replace(restitution=bounce)
    kinetic = pick.integers(1, 10, cells) / 10
    level = {"gravity_number_along": 0.0, "gravity_number_normal": 1.0}
    more = pick.choice([1.0, 1.0, 1.2, 1.5], cells)
    return groups._replace(
        **level, friction_static=more * kinetic, friction_kinetic=kinetic,
        restitution=np.round(bounce, 1),
    )  # fmt: skip


def repetition(cells: int, seed: int) -> None:
    """Print how often a motion that repeats is said not to, and whose means differ."""
    pick = np.random.default_rng(seed)
    decided = [STATUS["aperiodic"], STATUS["sensitive"]]
    for clean in (True, False):
        kind = "clean" if clean else "random"
        groups = bouncing(pick, cells, clean=clean)
        sine, wave = (planar_motion(one, **PLANAR) for one in (groups, as_harmonic(groups)))
        drive = np.hypot(groups.drive_number_along, groups.drive_number_normal)
        compare(f"{kind} sines and the same as one harmonic", sine, wave, drive)
        lost = np.isin(wave.status, decided) & np.isin(sine.status, REPEATS)
        print(f"   one harmonic said not to repeat where the sine does: {lost.sum()}")
        for name, one in (("sine", sine), ("harmonic", wave)):
            wild = one.status == STATUS["aperiodic"]
            print(
                f"   aperiodic under the {name}: {wild.sum()}, stated error of the median "
                f"{np.median((one.error / drive)[wild]):.1%} of the drive's speed"
            )
    for clean in (True, False):
        for make in (harmonics, steps):
            total, lost, apart = 0, 0, 0
            for orders in range(1, 9):
                count = orders if make is harmonics else orders + 1
                groups = lifting(pick, make(pick, cells // 16, count), clean=clean)
                flat, spatial = planar_motion(groups, **PLANAR), spatial_motion(
                    groups, Contacts(), **SPATIAL
                )  # fmt: skip
                both = np.isin(spatial.status, REPEATS)
                wild = np.isin(flat.status, decided) & both
                far = np.abs(flat.velocity - spatial.velocity) > flat.error + spatial.error
                total, lost = total + both.sum(), lost + wild.sum()
                apart += (far & wild).sum()
            kind = "clean" if clean else "random"
            print(
                f"{kind} {make.__name__}, lifting: of {total:,} that repeat in space {lost} "
                f"({lost / total:.2%}) do not in the plane, the means of {apart} of them apart by "
                f"more than both errors"
            )


def compare(name: str, one: Motion, other: Motion, speed: NDArray[np.float64]) -> None:
    """Print how far two ways of following the same parts are apart."""
    both = np.isin(one.status, REPEATS) & np.isin(other.status, REPEATS)
    apart = np.abs(one.velocity - other.velocity)
    share = (apart / speed)[both]
    beyond = (apart > one.error + other.error) & both
    print(
        f"{name}: {both.sum():,} of {both.size:,} repeat by both; apart median "
        f"{np.median(share):.1e}, 99 % {np.quantile(share, 0.99):.1e}, largest {share.max():.1e} "
        f"of the drive's speed; within {CLOSE:g}: {np.mean(share <= CLOSE):.2%}; beyond both "
        f"stated errors: {beyond.sum()}; other multiple: "
        f"{np.sum(one.multiple[both] != other.multiple[both])}"
    )
    differ = Counter(
        f"{NAMES[a]}/{NAMES[b]}"
        for a, b in zip(one.status.tolist(), other.status.tolist(), strict=True)
        if a != b
    )
    if differ:
        print("   other status:", ", ".join(f"{who} {count}" for who, count in differ.items()))


def joined(motions: list[Motion]) -> Motion:
    """Return motions one after another."""
    return Motion._make(np.concatenate(fields) for fields in zip(*motions, strict=True))


def agreement(cells: int, judged: int, seed: int) -> None:
    """Print agreement over drives of every size."""
    pick = np.random.default_rng(seed)
    flat, spatial, speeds, by_reference, asked = [], [], [], [], []
    each_kind = cells // 16
    for orders in range(1, 9):
        for make in (harmonics, steps):
            count = orders if make is harmonics else int(pick.integers(2, 13))
            groups = parts(pick, make(pick, each_kind, count))
            flat.append(planar_motion(groups, **PLANAR))
            spatial.append(spatial_motion(groups, Contacts(), **SPATIAL))
            speeds.append(waves.size(groups.wave))
            singles, _ = each(groups)
            chosen = [part for part, _ in zip(singles, range(judged // 16), strict=False)]
            found = [reference_motion(part, most_periods=100) for part in chosen]
            by_reference.append(Motion._make(np.array(field) for field in zip(*found, strict=True)))
            asked.append(Motion._make(field[: len(chosen)] for field in flat[-1]))
    compare("plane and space", joined(flat), joined(spatial), np.concatenate(speeds))
    some = np.concatenate([speed[: judged // 16] for speed in speeds])
    compare("plane and reference", joined(asked), joined(by_reference), some)


def more_orders(pick: Pick, sine: Groups, orders: int) -> Groups:
    """Return the parts with so many harmonics on each axis in the place of the sine."""
    pushes = (sine.drive_number_along, sine.drive_number_across, sine.drive_number_normal)
    cells = np.size(sine.drive_number_along)
    found = np.zeros((3, 2, orders, cells))
    for axis, push in enumerate(np.broadcast_to(push, cells) for push in pushes):
        share = np.ones((orders, cells))
        share[1:] = pick.uniform(0, 0.5, (orders - 1, cells))
        share[1:] /= np.sqrt(np.arange(2, orders + 1))[:, np.newaxis]
        phase = pick.uniform(0, TURN, (orders, cells))
        phase[0] = 0.0
        share *= push / share.sum(axis=0)
        found[axis] = share * np.cos(phase), share * np.sin(phase)
    return sine._replace(wave=Wave(found, np.zeros((4, 0, cells))))


def times(name: str, sine: Groups, run: Callable, rounds: int) -> None:
    """Print the time of a cell by orders, over that of the sine; the best of some rounds."""
    pick = np.random.default_rng(1)
    sets = {"sine": sine} | {k: more_orders(pick, sine, k) for k in (1, 2, 5, 10)}
    settings = PLANAR if run is planar.solve_cells else SPATIAL
    rows = {k: np.ascontiguousarray(cells_of(g, **settings)[0]) for k, g in sets.items()}
    cells = len(rows["sine"])
    table, status = np.empty((cells, COLUMNS)), np.empty(cells, dtype=np.int8)
    best = np.full((len(sets), cells), np.inf)
    for _ in range(rounds):
        for number, one in enumerate(rows.values()):
            for cell in range(cells):
                piece = slice(cell, cell + 1)
                begin = time.perf_counter()
                run(one[piece], table[piece], status[piece], NEVER)
                best[number, cell] = min(best[number, cell], time.perf_counter() - begin)
    print(f"{name}, {cells} cells, microseconds with the call; ratio to the sine cell by cell:")
    for number, key in enumerate(sets):
        ratio = np.median(best[number] / best[0])
        median, mean = np.median(best[number]), best[number].mean()
        label = key if key == "sine" else f"{key} orders"
        print(
            f"   {label:9}: median {1e6 * median:8.1f}, mean {1e6 * mean:8.1f}; median ratio "
            f"{ratio:.2f}, ratio of means {mean / best[0].mean():.2f}"
        )


def feeder_parts(cells: int, seed: int, across: float) -> Groups:
    """Return parts of a feeder's track under a plain sine; `across` is its largest azimuth."""
    pick = np.random.default_rng(seed)
    beta, alpha = np.radians(pick.uniform(10, 50, cells)), np.radians(pick.uniform(5, 35, cells))
    gamma, friction = np.radians(pick.uniform(0, 4, cells)), pick.uniform(0.15, 0.8, cells)
    drive = pick.uniform(0.2, 2.5, cells) / np.sin(beta)
    return Groups(
        drive * np.cos(beta) * np.cos(across * alpha), drive * np.sin(beta), np.sin(gamma),
        np.cos(gamma), friction, friction, wall_friction=friction,
        drive_number_across=across * drive * np.cos(beta) * np.sin(alpha),
        gravity_number_across=0.1 * across,
    )  # fmt: skip


def main() -> None:
    """Print all of it."""
    given = options(
        __doc__,
        cells=2000,
        judged=(160, "cells of them by the reference"),
        bouncing=(4000, "of each kind of bouncing parts"),
        timed=300,
        rounds=15,
        seed=7,
    )
    agreement(given.cells, given.judged, given.seed)
    repetition(given.bouncing, given.seed)
    flat = feeder_parts(given.timed, given.seed, 0.0)
    times("In the plane", flat, planar.solve_cells, given.rounds)

    def in_space(rows: NDArray, table: NDArray, status: NDArray, stop: NDArray) -> None:
        track.solve_cells(True, 0.0, rows, table, status, stop)

    aslant = feeder_parts(given.timed, given.seed, 1.0)
    times("On the track", aslant, in_space, max(3, given.rounds // 4))


if __name__ == "__main__":
    main()
