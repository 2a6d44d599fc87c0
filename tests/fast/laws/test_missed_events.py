"""No event is missed: where sums of sines pass a level, by eigenvalues and by a finer search."""

from types import FunctionType

import numpy as np
import pytest

from benchmarks.missed_events import (
    Sum,
    found_by_kernel,
    one_in_each,
    passages_by_signs,
    random_sum,
)
from benchmarks.waves import PLANAR, harmonics, parts
from vibrafeed.core.motion.events import waves_of
from vibrafeed.core.motion.kernels import sine_sums as kernels
from vibrafeed.core.motion.kernels.inputs import cell_of
from vibrafeed.core.motion.kernels.planar.flow import AIR
from vibrafeed.core.motion.kernels.planar.wave import KINDS, PULLS, ROOTS, wave_of
from vibrafeed.core.motion.method import cells_of

ROUNDED = 1e-12
"""Of a sum of some 20 terms of size 1: that of a phase, 4e-16, times a slope of some 100, and a
few roundings in each power of exp(i tau)."""


def search(points: int, bound: float):
    """Return `passages` in plain Python, with so many points and so many times the bound."""
    names = dict(vars(kernels))
    for name, function in vars(kernels).items():
        if hasattr(function, "py_func"):
            names[name] = FunctionType(function.py_func.__code__, names)
    turns = np.arange(points + points // 4) / points
    names |= {"POINTS": points, "SINES": np.sin(kernels.TURN * turns)}
    plain = names["bend_bound"]
    names["bend_bound"] = lambda *given: bound * plain(*given)
    return names["passages"]


@pytest.mark.parametrize("orders", [1, 2, 5, 6, 10])
def test_no_passage_of_a_sum_is_missed(orders):
    """Every other level barely touches a crest; half the pieces, twice the bound find the same."""
    pick, finer = np.random.default_rng(orders), search(2 * kernels.POINTS, 2.0)
    for _ in range(12):
        one = random_sum(pick, orders)
        found, again = found_by_kernel(one), found_by_kernel(one, finer)
        pairs = passages_by_signs(one)
        for passages in (found, again):
            assert one_in_each(pairs, passages)
            assert np.all(np.abs(one.at(passages)) < ROUNDED)


@pytest.mark.parametrize("orders", [2, 5, 8])
def test_no_change_of_sign_of_an_acceleration_is_missed(orders):
    """All that a random drive of a random part can change at: lift-offs, and slips of each way."""
    pick = np.random.default_rng(orders)
    groups = parts(pick, harmonics(pick, 20, orders))
    rows, _ = cells_of(groups, **PLANAR)
    for row in rows:
        wave, _, _ = wave_of(cell_of(row), row, waves_of(row))
        for kind in set(range(KINDS if wave.mu_s != wave.mu_k else KINDS - 2)) - {AIR}:
            sines, cosines = wave.table[2 * kind : 2 * kind + 2, 1 : orders + 1]
            one = Sum(sines, cosines, wave.table[PULLS, kind])
            count = int(wave.table[ROOTS + kind, 0])
            found = wave.table[ROOTS + kind, 1 : 1 + count]
            assert one_in_each(passages_by_signs(one), found)
