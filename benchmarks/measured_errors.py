"""Prints how often true drives lie within the errors that `vibrafeed.core.measured` states.

Each recording holds the same drive of three orders on two axes, noise of a colour, a drift, and a
clock 1 % slow: `python -m benchmarks.measured_errors --draws 400`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from benchmarks.options import options
from vibrafeed.core.errors import StudyError
from vibrafeed.core.measured import Fit, Signal, fit_signal

FREQUENCY, RATE, CLOCK = 50.0, 2000.0, 0.01
AMPLITUDES = np.array([[1e-4, 2e-5, 5e-6], [5e-5, 3e-5, 1e-5]])  # m
PHASES = np.array([[0.0, 0.5, -1.0], [2.0, -0.3, 1.0]])  # rad
ORDERS = np.array([1, 2, 3])
SETTLED = 200  # values of a coloured noise until it is what it will be
FAN = 61.3, 2.0  # Hz, m s-2
Case = tuple[int, float, float, float, bool]
CASES: dict[
    str, Case
] = {  # samples, share of the value before, rms [m s-2], of both axes in common, a fan beside
    "white": (2000, 0.0, 1.0, 0.0, False),
    "red": (2000, 0.9, 1.0, 0.0, False),
    "blue": (2000, -0.8, 1.0, 0.0, False),
    "in common": (2000, 0.0, 1.0, 0.8, False),
    "fan at 61 Hz": (2000, 0.0, 0.3, 0.0, True),
    "red, 11 periods": (450, 0.9, 1.0, 0.0, False),
}


def main() -> None:
    """Print a table row for each kind of noise."""
    draws = options(__doc__, draws=200).draws
    print("| noise | clock | amplitudes | phases | orders told that are not there | refused |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, case in CASES.items():
        print(f"| {name} | {row(case, draws)} |", flush=True)


def row(case: Case, draws: int) -> str:
    """Return the measurements for one kind of noise."""
    fits = [fit for seed in range(draws) if (fit := fitted(seed, case)) is not None]
    first = slice(ORDERS.size)
    clock = [(fit.clock.error - CLOCK) / fit.clock.standard_error for fit in fits if fit.clock]
    amplitudes = [
        (fit.amplitudes[:, first] - AMPLITUDES) / fit.amplitude_errors[:, first] for fit in fits
    ]
    phases = [away(fit) for fit in fits]
    false = sum(int(fit.significant[:, ORDERS.size :].sum()) for fit in fits)
    shares = " | ".join(within(errors) for errors in (clock, amplitudes, phases))
    absent = len(fits) * 2 * (10 - ORDERS.size)
    return f"{shares} | {false} of {absent:,} | {draws - len(fits)} of {draws:,}"


def fitted(seed: int, case: Case) -> Fit | None:
    """Return the fit of a random recording; None if it is refused."""
    try:
        return fit_signal(recorded(np.random.default_rng(seed), *case))
    except StudyError:
        return None


def recorded(
    rng: np.random.Generator, count: int, colour: float, size: float, common: float, fan: bool
) -> Signal:
    """Return a random recording that starts at any phase."""
    times = np.arange(count) / RATE
    turning = 2.0 * np.pi * FREQUENCY * ORDERS
    angles = np.multiply.outer(times + rng.uniform(0.0, 1.0 / FREQUENCY), turning)
    values = -np.einsum("jk,njk->jn", AMPLITUDES * turning**2, np.sin(angles[:, None] + PHASES))
    white = rng.standard_normal((2, count + SETTLED))
    noise = lfilter([np.sqrt(1.0 - colour**2)], [1.0, -colour], white)[:, SETTLED:]
    noise[1] = common * noise[0] + np.sqrt(1.0 - common**2) * noise[1]
    values += size * noise + np.linspace(-0.5, 0.5, count)
    if fan:
        values += FAN[1] * np.sin(2.0 * np.pi * (FAN[0] * times + rng.uniform()))
    return Signal(times / (1.0 + CLOCK), values, ("along", "normal"), np.zeros(2), FREQUENCY)


def away(fit: Fit) -> NDArray[np.float64]:
    """Return errors of phases over stated errors, without the first, which is 0 by choice."""
    turned = np.angle(np.exp(1j * (fit.phases[:, : ORDERS.size] - PHASES)))
    return turned.ravel()[1:] / fit.phase_errors[:, : ORDERS.size].ravel()[1:]


def within(errors: list[NDArray[np.float64]] | list[float]) -> str:
    """Return the share within two stated errors, and the spread, 1 for honest errors."""
    ratios = np.array(errors)
    return f"{100.0 * np.mean(np.abs(ratios) < 2.0):.1f} % ({ratios.std():.2f})"


if __name__ == "__main__":
    main()
