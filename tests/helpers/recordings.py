"""Recordings of drives that are known: accelerations after the definition, and their CSV."""

from collections.abc import Mapping, Sequence

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.measured import Signal

Orders = Sequence[tuple[float, float]]  # amplitude [m] and phase [rad] of the orders 1, 2, ...

DRIVE: dict[str, Orders] = {
    "along": ((1e-4, 0.0), (2e-5, 0.5), (5e-6, -1.0)),
    "normal": ((5e-5, 2.0), (3e-5, -0.3), (1e-5, 1.0)),
}
AMPLITUDES = np.array([[amplitude for amplitude, _ in orders] for orders in DRIVE.values()])
PHASES = np.array([[phase for _, phase in orders] for orders in DRIVE.values()])


def signal_of(
    drive: Mapping[str, Orders],
    *,
    frequency: float = 50.0,
    rate: float = 2000.0,
    count: int = 800,
    start: float = 0.0,
    **known: float,
) -> Signal:
    """Return -sum A_k (k w)^2 sin(k w (t + start) + phi_k) at times t from 0."""
    times = np.arange(count) / rate
    values = np.zeros((len(drive), count))
    for row, orders in zip(values, drive.values(), strict=True):
        for order, (amplitude, phase) in enumerate(orders, start=1):
            turning = 2 * np.pi * frequency * order
            row -= amplitude * turning**2 * np.sin(turning * (times + start) + phase)
    return Signal(times, values, tuple(drive), np.zeros(len(drive)), **known)


def csv_of(signal: Signal, names: Sequence[str] = ("ax", "az"), unit: str = "m s-2") -> str:
    """Return a signal as text, with times."""
    header = ",".join(["time [s]", *(f"{name} [{unit}]" for name in names)])
    rows = np.vstack([signal.times, signal.values]).T
    return "\n".join([header, *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def noisy(
    signal: Signal, rng: np.random.Generator, colour: float = 0.0, size: float = 1.0
) -> Signal:
    """Return a signal with noise of variance size^2, each value `colour` times the one before."""
    white = rng.standard_normal((len(signal.axes), signal.times.size + 200))
    noise = scipy.signal.lfilter([np.sqrt(1 - colour**2)], [1, -colour], white)[:, 200:]
    return signal._replace(values=signal.values + size * noise)


def turned(angle: ArrayLike) -> NDArray[np.float64]:
    """Return an angle in [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % (2 * np.pi) - np.pi
