"""Exact derivatives of planar motion against differences, at random cells, and what they cost.

Run `python -m benchmarks.derivatives`. The judge knows nothing of events: it asks the plain
kernel on both sides of a cell, at steps that halve, and extrapolates (Ridders). Only steps count
across which status, multiple, the impacts of a period and what the part does stay, and only where
the judge itself is sure to a tenth of the bar.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.options import options
from benchmarks.timing import in_turns
from vibrafeed.core.motion.groups import Groups, cells_of
from vibrafeed.core.motion.kernels.arrays import NEVER
from vibrafeed.core.motion.kernels.planar.derive import DERIVED_COLUMNS, KINK, MARGIN
from vibrafeed.core.motion.kernels.planar.slope_tables import DERIVED, DERIVED_BY
from vibrafeed.core.motion.kernels.planar.tables import PIECE
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS
from vibrafeed.core.motion.kernels.statuses import MODE, STATUS
from vibrafeed.core.motion.planar import derive_cells, follow, solve_cells

Floats = NDArray[np.float64]

NAMES = ("c", "s", "gs", "gn", "mu_s", "mu_k", "e")
FIELDS = ("velocity", "stick", "forward", "backward", "flight", "landing_speed", "hop_height")
SHARES = (COLUMN.stick, COLUMN.forward, COLUMN.backward, COLUMN.flight)
BAR = 1e-7
SURE = BAR / 10
STEPS = 16  # of a difference, halving
FIRST = 0.02  # the largest of them
NEGLIGIBLE = 1e-3  # of a slope: a smaller one is compared with this instead


class Derived(NamedTuple):
    """Results, derivatives, shape (cells, told, groups), margin and status of cells."""

    results: Floats
    slopes: Floats
    margin: Floats
    status: NDArray[np.int8]


def random_cells(count: int, seed: int) -> Floats:
    """Return rows of `Cell`: sliding, sticking and hopping parts, half of them with restitution."""
    rng = np.random.default_rng(seed)
    p, beta = rng.uniform(0.2, 4.0, count), np.deg2rad(rng.uniform(2.0, 60.0, count))
    gamma = np.deg2rad(rng.uniform(-5.0, 5.0, count))
    kinetic = rng.uniform(0.1, 0.8, count)
    static = kinetic * np.where(rng.random(count) < 0.5, 1.0, rng.uniform(1.01, 1.4, count))
    restitution = np.where(rng.random(count) < 0.5, 0.0, rng.uniform(0.01, 0.6, count))
    columns = (
        p * np.cos(beta), p * np.sin(beta), np.sin(gamma), np.cos(gamma), static, kinetic,
        restitution,
    )  # fmt: skip
    return cells_of(Groups(*columns), tolerance=1e-12, max_periods=1000.0)[0]


def plain(cells: Floats) -> tuple[Floats, NDArray[np.int8]]:
    """Return the results of cells without derivatives, and their status."""
    table, status = np.full((len(cells), RESULTS), np.nan), np.zeros(len(cells), np.int8)
    solve_cells(cells, table, status, np.zeros(1, np.int8))
    return table, status


def whole(cells: Floats) -> tuple[Floats, NDArray[np.int8]]:
    """Return the results of cells with omitted hops counted in the share of flight.

    They are those of 13.5, some 1e-7 of a period: the derivatives are those of the true shares.
    """
    table, status = plain(cells)
    on_floor = table[:, COLUMN.stick] + table[:, COLUMN.forward] + table[:, COLUMN.backward]
    shrinks = (status == STATUS.periodic) & (cells[:, 6] > 0) & (on_floor > 0)
    for number in np.flatnonzero(shrinks & (table[:, COLUMN.flight] > 0)):
        row, e, gn = cells[number], cells[number, 6], cells[number, 3]
        pieces, _, _, _ = follow(row, NEVER)
        s = abs(row[1])
        for piece, after in zip(pieces, np.roll(pieces, -1, axis=0), strict=True):
            if piece[PIECE.mode] != MODE.flight or after[PIECE.mode] == MODE.flight:
                continue
            start, end = piece[PIECE.phase], piece[PIECE.phase] + piece[PIECE.span]
            fall = piece[PIECE.normal] + s * (np.cos(start) - np.cos(end)) - gn * (end - start)
            time = -2 * e * fall / ((gn - s * np.sin(end)) * (1 - e))
            share = time / (2 * np.pi * table[number, COLUMN.multiple])
            table[number, COLUMN.flight] += share
            table[number, COLUMN.stick + int(after[PIECE.mode])] -= share
    return table, status


def derived(cells: Floats, energy: bool = True) -> Derived:
    """Return the results of cells with derivatives."""
    table, status = np.full((len(cells), DERIVED_COLUMNS), np.nan), np.zeros(len(cells), np.int8)
    derive_cells(energy, cells, table, status, np.zeros(1, np.int8))
    slopes = table[:, RESULTS:MARGIN].reshape(-1, len(DERIVED), DERIVED_BY)
    return Derived(table[:, :RESULTS], slopes, table[:, MARGIN], status)


def repeating(cells: Floats) -> Floats:
    """Return the cells whose motion repeats."""
    status = plain(cells)[1]
    return cells[(status == STATUS.periodic) | (status == STATUS.at_rest)]


def direction(cells: Floats, group: int) -> Floats:
    """Return the change of groups by a step of one; equal friction coefficients change together."""
    step = np.zeros_like(cells)
    step[:, group] = 1.0
    if group in (4, 5):
        alike = cells[:, 4] == cells[:, 5]
        step[alike, 4] = step[alike, 5] = 1.0
    return step


def judged(cells: Floats, group: int) -> tuple[Floats, Floats]:
    """Return reference derivatives by a group, shape (cells, fields), with their uncertainty."""
    columns = [getattr(COLUMN, name) for name in FIELDS]
    kinds = [COLUMN.multiple, COLUMN.impacts]
    here, status = plain(cells)
    step = direction(cells, group)
    best = np.full((len(cells), len(FIELDS)), np.nan)
    error = np.full_like(best, np.inf)
    above: list[Floats] = []
    for number in range(STEPS):
        h = FIRST * 0.5**number
        (low, low_status), (high, high_status) = whole(cells - h * step), whole(cells + h * step)
        same = (status == low_status) & (status == high_status)
        for kind in kinds:
            same &= np.isclose(here[:, kind], low[:, kind]) & np.isclose(
                here[:, kind], high[:, kind]
            )
        for kind in SHARES:
            modes = here[:, kind] > 0
            same &= (modes == (low[:, kind] > 0)) & (modes == (high[:, kind] > 0))
        if group == 6:
            same &= cells[:, 6] > h
        first = (high - low)[:, columns] / (2 * h)
        first[~same] = np.nan
        row = [first]
        for order, former in enumerate(above, 1):
            row.append(row[-1] + (row[-1] - former) / (4.0**order - 1))
            apart = np.fmax(np.abs(row[-1] - row[-2]), np.abs(row[-1] - former))
            apart += 4e-16 / h  # rounding of the values
            better = apart < error
            best, error = np.where(better, row[-1], best), np.where(better, apart, error)
        above = row
    return best, error


def errors(cells: Floats) -> dict[str, tuple[Floats, Floats, Floats, Derived]]:
    """Return relative errors by group, reference errors, and the number of compared values."""
    found = derived(cells)
    told = {}
    for group, name in enumerate(NAMES):
        exact, unsure = judged(cells, group)
        step = direction(cells, group)[:, :DERIVED_BY]
        slopes = np.einsum("ctg,cg->ct", found.slopes[:, : len(FIELDS)], step)
        size = np.maximum(np.abs(exact), NEGLIGIBLE)
        told[name] = (np.abs(slopes - exact) / size, unsure / size, slopes, found)
    return told


def main() -> None:
    """Print the errors and the cost of derivatives."""
    count = options(__doc__, cells=10_000).cells
    cells = random_cells(count, 2026)
    costs(cells)
    cells = repeating(cells)
    told = errors(cells)
    found = derived(cells)
    kinks = found.margin <= KINK
    print(f"{count:,} cells: {len(cells):,} repeat, of which {kinks.sum():,} are at a kink")
    for name, (error, unsure, _, _) in told.items():
        good = ~kinks[:, None] & (unsure < SURE)
        for field, title in enumerate(FIELDS):
            which = good[:, field]
            if not which.any():
                continue
            some = error[which, field]
            print(
                f"d {title:13s}/d {name:5s} {which.sum():6,} judged  median {np.median(some):.1e}  "
                f"99 % {np.quantile(some, 0.99):.1e}  worst {some.max():.1e} "
                f"beyond {BAR:g}: {(some > BAR).sum()}"
            )


def costs(cells: Floats) -> None:
    """Print the cost of derivatives relative to results alone."""
    found = derived(cells)
    r, periodic = found.results, found.status == STATUS.periodic
    sticks, flies = r[:, COLUMN.stick] > 0, r[:, COLUMN.flight] > 0
    kinds = {
        "all": found.status >= 0,
        "slip": periodic & ~sticks & ~flies,
        "stick and slip": periodic & sticks & ~flies,
        "hops": periodic & flies,
    }
    for name, which in kinds.items():
        some = cells[which]
        ways = partial(plain, some), partial(derived, some, False), partial(derived, some, True)
        alone, motion, energy = map(min, in_turns(5, *ways))
        print(
            f"{name:15s} {1e6 * alone / len(some):8.2f} us a cell; with derivatives "
            f"{motion / alone:.2f} times, those of the energies too {energy / alone:.2f}"
        )


if __name__ == "__main__":
    main()
