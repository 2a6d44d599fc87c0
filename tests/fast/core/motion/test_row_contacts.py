"""No collision of parts is missed, and none is made up: gaps that close, graze, and stay open."""

import numpy as np

from many_digits import Functions, mpf
from night import count
from rows import TURN
from vibrafeed.core.motion.kernels.rows.row_sine import first_contact

mp = Functions()


def opens_by(v, C, k, tau, d, of=np):
    """Return what a gap has grown by after a phase, of numbers of any kind."""
    return v * d + C * (d * of.cos(tau) - of.sin(tau + d) + of.sin(tau)) - k * d * d / 2


def test_a_gap_that_grazes_closes_where_it_does_and_nowhere_else():
    random, dips = np.random.default_rng(38), 0
    for _ in range(count(60, 5000)):
        C, k = random.normal(size=2)
        tau, lowest = random.uniform(0.0, TURN, 2)
        v = k * lowest - C * (np.cos(tau) - np.cos(tau + lowest))  # the gap turns there
        span, before = 1.01 * lowest, np.linspace(0.0, lowest, 2000)
        turns_up = C * np.sin(tau + lowest) > k + 0.1
        if not (turns_up and v < 0 and np.argmin(opens_by(v, C, k, tau, before)) == 1999):
            continue
        dips += 1
        size = 1.0 + abs(C) + abs(k) + abs(v)
        with mp.workdps(40):
            depth = -opens_by(*map(mpf, (v, C, k, tau, lowest)), mp)
            for beyond in (1e-3 * size, 1e-6 * size, 1e-9 * size, 1e-12 * size):
                motion = v, C, k, tau, np.sin(tau), np.cos(tau), span
                assert first_contact(float(depth + mpf(beyond)), *motion) == np.inf
                gap = float(depth - mpf(beyond))
                if gap <= 0:
                    continue
                closes = first_contact(gap, *motion)
                # The very gap, in many digits, is 0 there but for rounding, and it is its first 0.
                left = mpf(gap) + opens_by(*map(mpf, (v, C, k, tau, closes)), mp)
                assert abs(left) < 1e-14 * size
                assert closes < lowest
                assert gap + opens_by(v, C, k, tau, closes * before[:-1] / lowest).min() > -1e-14
    assert dips > 5
