"""No collision of parts is missed, and none is made up: gaps that close, graze, and stay open."""

from __future__ import annotations

import numpy as np
import pytest

from many_digits import Functions, mpf, root_between
from night import count
from rows import TURN, cell, followed
from vibrafeed.core.motion.kernels.rows import path_of_row
from vibrafeed.core.motion.kernels.rows.row_sine import first_contact

mp = Functions()
DEPTHS = (1e-3, 1e-6, 1e-9, 1e-12)


def closing(gap, v, C, k, tau, span):
    return first_contact(gap, v, C, k, tau, np.sin(tau), np.cos(tau), span)


def opens_by(v, C, k, tau, d):
    """Return what a gap has grown by after a phase, of numbers of any kind."""
    sine, cosine = (np.sin, np.cos) if isinstance(d, float | np.ndarray) else (mp.sin, mp.cos)
    return v * d + C * (d * cosine(tau) - sine(tau + d) + sine(tau)) - k * d * d / 2


def velocity(v, C, k, tau, d):
    return v + C * (mp.cos(tau) - mp.cos(tau + d)) - k * d


def dip_of(v, C, k, tau, span):
    """Return where, inside a span, a gap is smallest, and what it has shrunk by; in 40 digits."""
    grid = np.linspace(0.0, span, 4001)
    at = int(np.argmin(opens_by(v, C, k, tau, grid)))
    if not 0 < at < grid.size - 1:
        return None
    v, C, k, tau, low, high = map(mpf, (v, C, k, tau, grid[at - 1], grid[at + 1]))
    if not velocity(v, C, k, tau, low) < 0 < velocity(v, C, k, tau, high):
        return None
    lowest = root_between(lambda d: velocity(v, C, k, tau, d), low, high)
    return lowest, -opens_by(v, C, k, tau, lowest)


def test_a_gap_that_grazes_closes_where_it_does_and_nowhere_else():
    random, dips = np.random.default_rng(38), 0
    with mp.workdps(40):
        for _ in range(count(40, 5000)):
            v, C, k = random.normal(size=3)
            v = -abs(v)
            tau, span = random.uniform(0.0, TURN, 2)
            dip = dip_of(v, C, k, tau, span)
            if dip is None:
                continue
            dips += 1
            lowest, depth = dip
            for beyond in DEPTHS:
                beyond *= 1.0 + abs(C) + abs(k) + abs(v)
                assert closing(float(depth + mpf(beyond)), v, C, k, tau, span) == np.inf
                gap = depth - mpf(beyond)
                if gap <= 0:
                    continue
                closes = closing(float(gap), v, C, k, tau, span)
                # The very gap, in many digits, is 0 there but for rounding, and it is its first 0.
                left = mpf(float(gap)) + opens_by(*map(mpf, (v, C, k, tau, closes)))
                assert abs(left) < 1e-14 * (1.0 + abs(C) + abs(k) + abs(v))
                assert closes < lowest
                before = np.linspace(0.0, closes, 2000)[:-1]
                assert float(gap) + opens_by(v, C, k, tau, before).min() > -1e-14
    assert dips > 10


@pytest.mark.parametrize("waves", [(1.0, 0.2), (2.5, 1.8)])
def test_parts_that_graze_strike_once_and_parts_that_come_near_do_not(waves):
    def smallest(gap):
        """Return the least gap of two parts over a period, by samples about its time."""
        low, high = 0.0, TURN
        for _ in range(12):
            phases = np.linspace(low, high, 401)
            gaps = np.empty((401, 1))
            row = cell(*waves, [0.2, 0.5], gap=[gap])
            path_of_row(row, phases, np.empty((401, 2)), gaps)
            at = int(np.argmin(gaps))
            low, high = phases[max(0, at - 1)], phases[min(400, at + 1)]
        return gaps[at, 0], phases[at]

    far = 100.0
    least, when = smallest(far)
    swing = far - least
    assert swing > 0.05
    assert 0.0 < when < TURN
    wide = np.empty((1, 2))
    path_of_row(cell(*waves, [0.2, 0.5], gap=[far]), np.array([TURN]), wide, np.empty((1, 1)))
    for depth in DEPTHS:
        for beyond in (-1, 1):
            row = cell(*waves, [0.2, 0.5], gap=[swing - beyond * depth], most=1)
            found, _ = followed(row)
            assert found["collisions"] == (beyond > 0)
            near = np.empty((1, 2))
            path_of_row(row, np.array([TURN]), near, np.empty((1, 1)))
            # A graze changes velocities by the root of its depth, and no more.
            assert near == pytest.approx(wide, abs=1e-9 + 20 * np.sqrt(depth) * (beyond > 0))
