"""Fits of recordings, and speeds by them, state errors that are as large as the true ones."""

import numpy as np
import pytest
from scipy.stats import binom

from benchmarks.measured_speeds import PARTS, stated, true_speed
from night import count, spread
from recordings import AMPLITUDES, DRIVE, PHASES, noisy, signal_of, turned
from vibrafeed.core.measured import fit_signal


def errors_over_stated(fit):
    """Return errors over standard errors: the clock, amplitudes, free phases."""
    kept = [fit.orders.index(order) for order in (1, 2, 3)]
    amplitudes = (fit.amplitudes[:, kept] - AMPLITUDES) / fit.amplitude_errors[:, kept]
    phases = turned(fit.phases[:, kept] - PHASES).ravel()[1:]
    phases /= fit.phase_errors[:, kept].ravel()[1:]
    return [(fit.clock.error - 0.01) / fit.clock.standard_error, *amplitudes.ravel(), *phases]


@pytest.mark.parametrize("colour", [0.0, 0.9])
def test_stated_errors_are_as_large_as_true_ones(colour):
    """Of recordings with noise, drift and a clock 1 % wrong, 95 % lie within two errors.

    Each of the twelve numbers is within 2 standard errors with probability 0.9545 if the errors
    are right: the count is binomial, and leaves its bounds once in 10^5. The share of all of them
    has a standard deviation of 0.43 % over 200; its bounds are those of errors 10 % too small or
    too large, and by day, of fewer recordings, further apart in proportion.
    """
    draws = count(60, 200, "VIBRAFEED_RECORDINGS")
    rng, drift = np.random.default_rng(7), np.linspace(-0.5, 0.5, 500)
    found = []
    for _ in range(draws):
        signal = signal_of(DRIVE, rate=1000.0, count=500, start=rng.uniform(0, 0.02))
        signal = noisy(signal._replace(values=signal.values + drift), rng, colour)
        # The clock counts too few seconds.
        fit = fit_signal(signal._replace(times=signal.times / 1.01, line_frequency=50.0))
        found.append(errors_over_stated(fit))
    within = np.abs(found) < 2.0
    low, high = binom.ppf([5e-6, 1 - 5e-6], draws, 0.9545)
    held = within.sum(axis=0)
    assert ((low <= held) & (held <= high)).all()
    further = np.sqrt(200 / draws)
    assert 0.9545 - 0.0265 * further < within.mean() < 0.9545 + 0.0175 * further


@pytest.mark.parametrize("part", spread(PARTS, 1))
def test_a_known_drive_has_a_speed_within_the_stated_error(part):
    """Of 30 sound ones 95 % have 26 or more within, but for one time in 300."""
    true = true_speed(PARTS[part])
    told = [stated("white", seed, PARTS[part], draws=100) for seed in range(30)]
    assert sum(one.lower <= true <= one.upper for one in told) >= 26
    away = np.array([(one.velocity - true) / one.standard_deviation for one in told])
    assert 0.6 < away.std() < 1.5
