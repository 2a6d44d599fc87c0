"""Prints whether exact motion misses an event; `python -m benchmarks.missed_events`.

Where random sums of sines pass a level, against the eigenvalues of a companion matrix, which know nothing of
bounds; some levels barely touch a crest. Then the random drives of `benchmarks.waves`, in the plane and in space, a
second time with every search made twice as fine: pieces halved and the bound of the second derivative doubled, steps of
the series and the longest step halved. The events of both runs are compared one by one. The second run is of a copy of
this code with other constants, which it compiles: some minutes.
"""  # noqa: E501

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.options import options
from benchmarks.waves import PLANAR, SPATIAL, harmonics, parts, steps
from vibrafeed.core.motion import events, waves
from vibrafeed.core.motion.events import planar_motion, spatial_motion
from vibrafeed.core.motion.kernels.constants import MODE, PIECE, TALLY
from vibrafeed.core.motion.kernels.inputs import NEVER, cell_of
from vibrafeed.core.motion.kernels.sine_sums import SineSum, passages
from vibrafeed.core.motion.kernels.track import push
from vibrafeed.core.motion.kernels.track.push import at_rest, new_work
from vibrafeed.core.motion.kernels.track.settling import follow_until_repeating, new_history
from vibrafeed.core.motion.kernels.track.space_cells import FINE
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, cells_of
from vibrafeed.core.motion.waves import TURN

ROOT = Path(__file__).parents[1]
REPEATS = [STATUS["periodic"], STATUS["at_rest"]]
NAMES = {value: name for name, value in STATUS.items()}
CLOSE = 1e-9  # of the drive's speed: means no further apart are the same
FINER = (
    ("core/motion/kernels/sine_sums.py", "POINTS = 128\n", "POINTS = 256\n"),
    ("core/motion/kernels/sine_sums.py", "    return total\n", "    return 2.0 * total\n"),
    ("core/motion/kernels/track/modes.py", "LONGEST = 1.5\n", "LONGEST = 0.75\n"),
    ("core/motion/kernels/track/modes.py", "0.95 * math.exp", "0.475 * math.exp"),
)
"""What a finer search has in another way: file, text, and the text instead."""

Array = NDArray[np.float64]


# --- where a sum passes a level


class Sum(NamedTuple):
    """Coefficients of sin(k tau) and cos(k tau) for k from 1 on, and a level."""

    sines: Array
    cosines: Array
    level: float

    def at(self, tau: Array) -> Array:
        """Return the value of the sum above the level."""
        turned = np.arange(1, self.sines.size + 1)[:, np.newaxis] * tau
        return self.sines @ np.sin(turned) + self.cosines @ np.cos(turned) - self.level


def phases_of(one: Sum) -> Array:
    """Return the ascending phases of all roots of a sum, as a polynomial in exp(i tau).

    Of the roots on the unit circle these are the passages; the others are of no harm.
    """
    upper = 0.5 * (one.cosines - 1j * one.sines)
    roots = np.roots([*upper[::-1], -one.level, *upper.conj()])
    return np.sort(np.angle(roots) % TURN)


def passages_by_signs(one: Sum) -> Array:
    """Return pairs of phases around each crossing, by the signs between the roots.

    The sum changes its sign nowhere but at its roots. Midway between neighbours it is off the level
    by far more than its rounding, unless two roots are as near as eigenvalues are known, some 1e-7.
    """
    phases = phases_of(one)
    between = np.sort(0.5 * (phases + np.append(phases[1:], phases[0] + TURN)) % TURN)
    above = one.at(between) > 0.0
    changes = above != np.roll(above, -1)
    return np.stack([between, np.append(between[1:], between[0] + TURN)], axis=-1)[changes]


def random_sum(pick: np.random.Generator, orders: int) -> Sum:
    """Return a random sum; every other level is just below a crest."""
    sines, cosines = pick.normal(size=(2, orders))
    one = Sum(sines, cosines, 0.5 * pick.normal())
    if pick.random() < 0.5:
        return one
    k = np.arange(1, orders + 1)
    crests = phases_of(Sum(-k * cosines, k * sines, 0.0))
    height = pick.choice(one._replace(level=0.0).at(crests))
    return one._replace(level=height + pick.choice([-1, 1]) * 10.0 ** pick.uniform(-12, -1))


def found_by_kernel(one: Sum, search=passages) -> Array:
    """Return the ascending crossings that a kernel finds."""
    orders = one.sines.size
    table = np.zeros((3, 26))
    table[0, 1 : orders + 1], table[1, 1 : orders + 1] = one.sines, one.cosines
    return table[2, 1 : 1 + search(SineSum(table, 0, 1, orders), one.level, 2, 24)]


def sums_agree(count: int, seed: int) -> None:
    """Print how many crossings of random sums the kernel misses or invents."""
    pick = np.random.default_rng(seed)
    total, wrong, nearest = 0, 0, TURN
    for number in range(count):
        one = random_sum(pick, 1 + number % 10)
        expected, found = passages_by_signs(one), found_by_kernel(one)
        total += len(expected)
        wrong += not one_in_each(expected, found)
        if found.size > 1:
            nearest = min(nearest, np.diff(found).min())
    print(
        f"{count:,} sums of 1 to 10 orders, {total:,} passages, the nearest two {nearest:.1e} "
        f"apart: sums with a passage missed or invented: {wrong}"
    )


def one_in_each(pairs: Array, found: Array) -> bool:
    """True if there is exactly one phase between each pair."""
    if len(pairs) != found.size:
        return False
    return all(np.sum((found - low) % TURN < high - low) == 1 for low, high in pairs)


# --- whole motions


def parts_of_all_kinds(cells: int, seed: int) -> Iterator[Groups]:
    """Yield random parts under harmonics and steps of every number."""
    pick = np.random.default_rng(seed)
    for orders in range(1, 9):
        for make in (harmonics, steps):
            count = orders if make is harmonics else int(pick.integers(2, 13))
            yield parts(pick, make(pick, cells // 16, count))


def events_in_plane(groups: Groups) -> list[str]:
    """Return the sequence of modes of each cell over its cycle.

    A cycle that starts where a part begins to slip may have a stick of no length before it.
    """
    rows, _ = cells_of(groups, **PLANAR)
    found = []
    for row in rows:
        pieces, *_ = events.follow(row, NEVER)
        modes = pieces[:, PIECE.mode].astype(int).tolist()
        if len(modes) > 1 and modes[0] == modes[-1] == MODE.stick:
            del modes[0]
        found.append("".join(map(str, modes)))
    return found


def events_in_space(groups: Groups, multiples: Array) -> list[str]:
    """Return the event signatures of each period of every cell's cycle."""
    rows, _ = cells_of(groups, **SPATIAL)
    most, found = int(SPATIAL["max_periods"]), []
    history, work = new_history(most, NEVER), new_work()
    for row, multiple in zip(rows, multiples, strict=True):
        if not multiple > 0:
            found.append("")
            continue
        cell = cell_of(row)
        push.set_drive(cell, row, work)
        state, hold = at_rest()
        done = follow_until_repeating(cell, False, 0.0, FINE, most, state, hold, history, work)
        last = history.tallies[done.periods - done.multiple : done.periods]
        pairs = last[:, [TALLY.impacts, TALLY.signature]].astype(int)
        found.append(" ".join(f"{impacts}:{mark}" for impacts, mark in pairs.tolist()))
    return found


def motions(cells: int, seed: int, file: Path) -> None:
    """Write the motions of random parts, computed by the imported code."""
    found: dict[str, list] = {}
    for groups in parts_of_all_kinds(cells, seed):
        ways = {"plane": planar_motion(groups, **PLANAR)}
        ways["space"] = spatial_motion(groups, Contacts(), **SPATIAL)
        for name, motion in ways.items():
            in_space = name == "space"
            told = events_in_space(groups, motion.multiple) if in_space else events_in_plane(groups)
            found.setdefault(f"{name} events", []).extend(told)
            for field in ("status", "velocity", "error", "multiple", "impacts"):
                found.setdefault(f"{name} {field}", []).extend(getattr(motion, field).tolist())
        found.setdefault("speed", []).extend(waves.size(groups.wave).tolist())
        found.setdefault("restitution", []).extend(groups.restitution.tolist())
    np.savez(file, **{name: np.array(values) for name, values in found.items()})


def finer_copy(folder: Path) -> Path:
    """Return a copy of the code whose searches are twice as fine."""
    for name in ("core", "app", "vibrafeed", "benchmarks"):
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=ignore)
    for name, text, instead in FINER:
        file = folder / name
        content = file.read_text()
        if content.count(text) != 1:
            raise ValueError(f"{name} has not one '{text.strip()}'")
        file.write_text(content.replace(text, instead))
    return folder


def motions_agree(cells: int, seed: int) -> None:
    """Print the differences between motions of both searches."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        motions(cells, seed, folder / "usual.npz")
        tree = finer_copy(folder / "finer")
        command = [sys.executable, "-m", "benchmarks.missed_events", "--write", "finer.npz"]
        command += ["--cells", str(cells), "--seed", str(seed)]
        environment = {**os.environ, "PYTHONPATH": str(tree)}
        environment["NUMBA_CACHE_DIR"] = str(folder / "compiled")
        subprocess.run(command, cwd=tree, env=environment, check=True)
        with np.load(folder / "usual.npz") as usual, np.load(tree / "finer.npz") as finer:
            for way in ("plane", "space"):
                compare(way, dict(usual), dict(finer))


def compare(way: str, usual: dict[str, NDArray], finer: dict[str, NDArray]) -> None:
    """Print the differences between two runs of one kind."""
    one, other = (
        {name: run[f"{way} {name}"] for name in ("status", "velocity", "error", "events")}
        for run in (usual, finer)
    )
    repeats = np.isin(one["status"], REPEATS) & np.isin(other["status"], REPEATS)
    apart = np.abs(one["velocity"] - other["velocity"])
    share = (apart / usual["speed"])[repeats]
    events = (one["events"] != other["events"]) & repeats
    beyond = (apart > one["error"] + other["error"]) & repeats
    print(
        f"{way}: {repeats.sum():,} of {repeats.size:,} repeat by both; other events: "
        f"{events.sum()}; speed apart by more than {CLOSE:g} of the drive's: "
        f"{np.sum(share > CLOSE)}, largest {share.max():.1e}; beyond both stated errors: "
        f"{beyond.sum()}; other status: {np.sum(one['status'] != other['status'])}"
    )
    for cell in np.flatnonzero((one["status"] != other["status"]) | beyond | events):
        names = "/".join(NAMES[run["status"][cell]] for run in (one, other))
        print(
            f"   cell {cell}: {names}, {apart[cell] / usual['speed'][cell]:.1e} apart, stated "
            f"{(one['error'] + other['error'])[cell] / usual['speed'][cell]:.1e}, rebound "
            f"{usual['restitution'][cell]:.2f}"
        )


def main() -> None:
    """Print all comparisons."""
    given = options(
        __doc__, sums=2000, cells=2000, seed=7, write=(Path, "only write the motions to this file")
    )
    if given.write:
        motions(given.cells, given.seed, given.write)
        return
    sums_agree(given.sums, given.seed)
    motions_agree(given.cells, given.seed)


if __name__ == "__main__":
    main()
