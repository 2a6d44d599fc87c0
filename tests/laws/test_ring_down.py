"""The free vibration of struck feeders that are known: 200 recordings of 16 bits at 1 kHz."""

import numpy as np
import pytest
from scipy.stats import binom

from night import count
from vibrafeed.core.errors import StudyError
from vibrafeed.core.measured import Recording, fit_ring_down, moving_mass

RATE, COUNT, KNOCK = 1000.0, 2000, 200
STEP = 16 * 9.80665 / 2**16  # m s-2, of 16 bits over 8 g both ways
TIMES = np.arange(COUNT) / RATE
CHANNELS = Recording(along="ax", normal="az")
LATER = count(40, 200)


def struck(rng, modes, noise=0.02):
    """Return the recording of a knock as text; each mode is frequency, damping ratio, sizes."""
    values = np.zeros((2, COUNT))
    after = np.maximum(TIMES - TIMES[KNOCK], 0.0)
    for frequency, ratio, *sizes in modes:
        turn = 2.0 * np.pi * frequency
        for row, size in zip(values, sizes, strict=True):
            wave = np.cos(turn * np.sqrt(1.0 - ratio**2) * after + rng.uniform(0.0, 2.0 * np.pi))
            row[KNOCK:] += (size * np.exp(-ratio * turn * after) * wave)[KNOCK:]
    values += noise * np.abs(values).max() * rng.standard_normal(values.shape)
    values[1] += 9.80665
    rounded = np.round(values / STEP) * STEP
    rows = "\n".join(f"{t:.3f},{a:.7g},{n:.7g}" for t, (a, n) in zip(TIMES, rounded.T, strict=True))
    return "time [s],ax [m/s2],az [m/s2]\n" + rows


@pytest.mark.parametrize(
    ("least", "most", "tries", "exactly"), [(-2.5, -1.5, 200, True), (-1.2, -0.6, LATER, False)]
)
def test_frequency_damping_and_their_errors_are_right(least, most, tries, exactly):
    """Up to 3 % of damping; a ring-down of a few periods tells less, and its errors say so."""
    rng = np.random.default_rng(20261128)
    truths, found = [], []
    for _ in range(tries):
        frequency, ratio = rng.uniform(15.0, 120.0), 10.0 ** rng.uniform(least, most)
        sizes = rng.uniform(0.3, 1.0, 2) * [30.0, 10.0]
        fit = fit_ring_down(struck(rng, [(frequency, ratio, *sizes)]), CHANNELS)
        truths.append((frequency, ratio))
        found.append((fit.natural_frequency, fit.damping_ratio,
                      fit.natural_frequency_error, fit.damping_ratio_error))  # fmt: skip
    found, truths = np.array(found), np.array(truths)
    relative = np.abs(found[:, :2] / truths - 1.0).max(axis=0)
    assert (relative < ([1e-3, 0.03] if exactly else [0.05, 0.25])).all()
    within = (np.abs(found[:, :2] - truths) <= 1.96 * found[:, 2:]).sum(axis=0)
    # With 95 % each, fewer hit once in a hundred thousand experiments.
    assert (within >= binom.ppf(1e-5, tries, 0.95)).all()


def test_a_second_mode_does_not_move_the_first():
    rng = np.random.default_rng(1)
    text = struck(rng, [(53.0, 0.02, 30.0, 10.0), (131.0, 0.01, 3.0, 6.0)], noise=0.005)
    fit = fit_ring_down(text, CHANNELS)
    assert fit.natural_frequency == pytest.approx(53.0, rel=5e-4)
    assert fit.damping_ratio == pytest.approx(0.02, rel=0.02)
    assert fit.other_frequencies == pytest.approx((131.0,), rel=2e-3)


def test_an_added_mass_gives_the_moving_mass():
    rng = np.random.default_rng(2)
    masses = 10.0, 12.0
    empty, loaded = (
        fit_ring_down(struck(rng, [(53.0 * np.sqrt(10.0 / m), 0.02, 30.0, 10.0)]), CHANNELS)
        for m in masses
    )
    mass, error = moving_mass(empty, loaded, 2.0)
    assert abs(mass - 10.0) < 4.0 * error < 0.5
    with pytest.raises(StudyError, match="Give the recording without the mass first"):
        moving_mass(loaded, empty, 2.0)


def test_what_is_no_ring_down_is_refused():
    rng = np.random.default_rng(3)
    steady = np.sin(314.0 * TIMES)
    noise = rng.standard_normal(COUNT)
    for values in (noise, np.where(TIMES > 0.3, noise, 0.0) * steady):
        text = "time [s],ax [g]\n" + "\n".join(
            f"{t:.3f},{v:.7g}" for t, v in zip(TIMES, values, strict=True)
        )
        with pytest.raises(StudyError, match=r"does not decay as a struck feeder|follow the knock"):
            fit_ring_down(text, Recording(along="ax"))
    late = text.replace("\n1.990,", "\n1.990,9")
    with pytest.raises(StudyError, match="samples follow the knock, which is too few"):
        fit_ring_down(late, Recording(along="ax"))
