"""Harmonics of measured drives: known drives come back, with errors that are as large as stated."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter
from scipy.stats import binom

from night import count
from recordings import DRIVE, csv_of, signal_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.measured import Recording, fit_drive, fit_signal

NEAR = 1e-9
AMPLITUDES = np.array([[amplitude for amplitude, _ in orders] for orders in DRIVE.values()])
PHASES = np.array([[phase for _, phase in orders] for orders in DRIVE.values()])


def turned(angle):
    """Return an angle in [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % (2 * np.pi) - np.pi


def refusal(signal):
    with pytest.raises(StudyError) as caught:
        fit_signal(signal)
    return str(caught.value)


def noisy(signal, rng, colour=0.0, size=1.0):
    """Return a signal with noise of variance size^2, each value `colour` times the one before."""
    white = rng.standard_normal((len(signal.axes), signal.times.size + 200))
    noise = lfilter([np.sqrt(1 - colour**2)], [1, -colour], white)[:, 200:]
    return signal._replace(values=signal.values + size * noise)


# --- known drives


def test_a_drive_without_noise_comes_back_to_nine_digits():
    signal = signal_of(DRIVE, frequency=49.87, start=0.0031)
    drift = np.array([[0.8], [9.8]]) + 0.3 * np.linspace(-1, 1, 800)
    fit = fit_signal(signal._replace(values=signal.values + drift))
    assert fit.frequency == pytest.approx(49.87, rel=NEAR)
    assert fit.orders == (1, 2, 3)
    assert fit.significant.all()
    np.testing.assert_allclose(fit.amplitudes, AMPLITUDES, rtol=NEAR)
    np.testing.assert_allclose(turned(fit.phases - PHASES), 0, atol=NEAR)
    np.testing.assert_allclose(fit.constant, [0.8, 9.8], rtol=NEAR)
    np.testing.assert_allclose(fit.drift, 0.3, rtol=NEAR)
    assert fit.left_over.max() < NEAR
    np.testing.assert_array_equal(fit.effective_samples, 800)


@settings(max_examples=25, deadline=None)
@given(
    frequency=st.floats(20, 90),
    start=st.floats(0, 0.1),
    orders=st.lists(st.tuples(st.floats(1e-6, 1e-4), st.floats(-3.1, 3.1)), min_size=1, max_size=6),
)
def test_any_drive_without_noise_comes_back(frequency, start, orders):
    strength = [amplitude * order**2 for order, (amplitude, _) in enumerate(orders, start=1)]
    assume(strength[0] > 0.05 * max(strength))
    signal = signal_of({"normal": orders}, frequency=frequency, start=start, count=1200)
    fit = fit_signal(signal)
    assert fit.frequency == pytest.approx(frequency, rel=NEAR)
    expected = [amplitude for amplitude, _ in orders]
    np.testing.assert_allclose(fit.amplitudes[0], expected, rtol=1e-8)
    first = orders[0][1]
    phases = [phase - order * first for order, (_, phase) in enumerate(orders, start=1)]
    np.testing.assert_allclose(turned(fit.phases[0] - phases), 0, atol=1e-8)


@pytest.mark.parametrize("order", [2, 3, 7])
def test_an_overtone_may_be_fifty_times_as_strong_as_the_fundamental(order):
    orders = [(0.0, 0.0)] * order
    orders[0], orders[-1] = (2e-6 * order**2, 0.3), (1e-4, -0.4)
    signal = signal_of({"along": orders}, frequency=41.0)
    fit = fit_signal(noisy(signal, np.random.default_rng(1), size=0.02))
    assert fit.frequency == pytest.approx(41.0, rel=1e-5)
    assert fit.orders == (1, order)


def test_orders_of_an_absent_fundamental_are_found():
    fit = fit_signal(signal_of({"along": [(0.0, 0.0), (1e-4, 0.4), (6e-5, -0.9)]}, frequency=30.0))
    assert fit.orders == (2, 3)
    assert fit.frequency == pytest.approx(30.0, rel=NEAR)
    assert sorted(fit.parameters()) == [
        "amplitude_along_2", "amplitude_along_3", "frequency", "phase_along_2", "phase_along_3",
    ]  # fmt: skip
    assert fit.parameters()["phase_along_2"] == 0.0
    assert turned(fit.phases[0, 1] - (-0.9 - 1.5 * 0.4)) == pytest.approx(0, abs=NEAR)


def test_a_guess_chooses_among_whole_parts():
    plain = signal_of({"along": [(1e-4, 0.0)]}, frequency=60.0)
    assert fit_signal(plain).frequency == pytest.approx(60.0)
    halved = fit_signal(plain._replace(frequency=31.0))
    assert halved.frequency == pytest.approx(30.0)
    assert halved.orders == (2,)


def test_a_line_frequency_settles_what_a_short_recording_leaves_open():
    signal = signal_of(DRIVE, count=450)
    foreign = signal_of({"along": [(1e-5, 0.0)]}, frequency=25.2, count=450).values
    signal = signal._replace(values=signal.values + foreign)
    signal = noisy(signal, np.random.default_rng(10), size=0.05)
    # In eleven periods 25.2 Hz could be the half of 50 Hz.
    assert "hold 5.62 periods of 25 Hz" in refusal(signal)
    assert fit_signal(signal._replace(line_frequency=50.0)).frequency == 50.0


# --- laws


def test_when_the_recording_starts_does_not_matter():
    one, other = (fit_signal(signal_of(DRIVE, start=start)) for start in (0.0, 0.0137))
    np.testing.assert_allclose(one.amplitudes, other.amplitudes, rtol=NEAR)
    np.testing.assert_allclose(turned(one.phases - other.phases), 0, atol=NEAR)
    assert one.phases[0, 0] == other.phases[0, 0] == 0.0


def test_a_mirrored_axis_is_half_a_turn_behind():
    text = csv_of(signal_of(DRIVE))
    plain = fit_drive(text, Recording(along="ax", normal="az"))
    mirrored = fit_drive(text, Recording(along="ax", normal="-az"))
    np.testing.assert_allclose(plain.amplitudes, mirrored.amplitudes, rtol=NEAR)
    np.testing.assert_allclose(turned(plain.phases[0] - mirrored.phases[0]), 0, atol=NEAR)
    np.testing.assert_allclose(abs(turned(plain.phases[1] - mirrored.phases[1])), np.pi, atol=NEAR)


@pytest.mark.parametrize("times", [1.01, 0.97])
def test_a_wrong_clock_is_told_and_undone(times):
    signal = signal_of(DRIVE)
    plain = fit_signal(signal)
    # A clock that counts too few seconds shows shorter times, thus a higher frequency.
    fit = fit_signal(signal._replace(times=signal.times / times, line_frequency=50.0))
    assert fit.frequency == 50.0
    assert fit.frequency_error == 0.0
    assert fit.clock.error == pytest.approx(times - 1, rel=1e-7)
    np.testing.assert_allclose(fit.amplitudes, plain.amplitudes, rtol=NEAR)
    np.testing.assert_allclose(turned(fit.phases - plain.phases), 0, atol=NEAR)
    np.testing.assert_allclose(fit.fold().residual, 0, atol=1e-8)


def test_uneven_times_are_fitted_where_they_are():
    fine = signal_of(DRIVE, rate=1e6, count=500_000)
    places = np.arange(1000) * 500 + np.random.default_rng(2).integers(0, 150, 1000)
    times, values = fine.times[places], fine.values[:, places]
    fit = fit_signal(fine._replace(times=times, values=values))
    np.testing.assert_allclose(fit.amplitudes, AMPLITUDES, rtol=NEAR)


# --- errors


def counted(fits, line):
    """Return errors over standard errors: frequency or clock, amplitudes, free phases."""
    found = []
    for fit in fits:
        kept = [fit.orders.index(order) for order in (1, 2, 3)]
        off = fit.clock.error - line if line else fit.frequency - 50.0
        error = fit.clock.standard_error if line else fit.frequency_error
        amplitudes = (fit.amplitudes[:, kept] - AMPLITUDES) / fit.amplitude_errors[:, kept]
        phases = turned(fit.phases[:, kept] - PHASES).ravel()[1:]
        phases /= fit.phase_errors[:, kept].ravel()[1:]
        found.append([off / error, *amplitudes.ravel(), *phases])
    return np.array(found)


@pytest.mark.parametrize(
    ("colour", "draws"),
    [
        (0.0, count(60, 200, "VIBRAFEED_RECORDINGS")),
        pytest.param(0.9, 100, marks=pytest.mark.night),
    ],
)
def test_stated_errors_are_as_large_as_true_ones(colour, draws):
    """Of recordings with noise, drift and a clock 1 % wrong, 95 % lie within two errors.

    Each of the twelve numbers is within 2 standard errors with probability 0.9545 if the errors
    are right: the count is binomial, and leaves its bounds once in 10^5. The share of all of them
    has a standard deviation of 0.43 % over 200; its bounds are those of errors 10 % too small or
    too large, and by day, of fewer recordings, further apart in proportion.
    """
    rng = np.random.default_rng(7)
    drift = np.linspace(-0.5, 0.5, 500)
    fits = []
    for _ in range(draws):
        signal = signal_of(DRIVE, rate=1000.0, count=500, start=rng.uniform(0, 0.02))
        signal = noisy(signal._replace(values=signal.values + drift), rng, colour)
        # The clock counts too few seconds.
        fits.append(fit_signal(signal._replace(times=signal.times / 1.01, line_frequency=50.0)))
    within = np.abs(counted(fits, 0.01)) < 2.0
    low, high = binom.ppf([5e-6, 1 - 5e-6], draws, 0.9545)
    assert (within.sum(axis=0) >= low).all()
    assert (within.sum(axis=0) <= high).all()
    further = np.sqrt(200 / draws)
    assert 0.9545 - 0.0265 * further < within.mean() < 0.9545 + 0.0175 * further


def test_errors_that_took_coloured_noise_for_white_would_be_wrong():
    rng = np.random.default_rng(3)
    signal = signal_of({"along": [(1e-4, 0.0)]})
    white, red = (
        np.median([fit_signal(noisy(signal, rng, c)).amplitude_errors[0, 0] for _ in range(10)])
        for c in (0.0, 0.9)
    )
    # Density of noise with colour c at 50 Hz of 2000: (1 - c^2)/|1 - c exp(-i w)|^2.
    expected = np.sqrt((1 - 0.9**2) / abs(1 - 0.9 * np.exp(-0.05j * np.pi)) ** 2)
    assert red / white == pytest.approx(expected, rel=0.15)


def test_draws_have_the_stated_errors():
    fit = fit_signal(noisy(signal_of(DRIVE), np.random.default_rng(4)))
    drawn = fit.draw(np.random.default_rng(5), 4000)
    assert all(one.keys() == fit.parameters().keys() for one in drawn)
    for place, axis in enumerate(fit.axes):
        for order in fit.orders:
            amplitudes = [one[f"amplitude_{axis}_{order}"] for one in drawn]
            phases = np.radians([one[f"phase_{axis}_{order}"] for one in drawn])
            phases = turned(phases - fit.phases[place, order - 1])
            # The spread of 4000 draws is known to 1.1 %.
            assert np.std(amplitudes) == pytest.approx(
                fit.amplitude_errors[place, order - 1], rel=0.06
            )
            assert np.std(phases) == pytest.approx(
                fit.phase_errors[place, order - 1], rel=0.06, abs=1e-12
            )
    assert np.std([one["frequency"] for one in drawn]) == pytest.approx(
        fit.frequency_error, rel=0.06
    )


def test_what_the_data_do_not_tell_is_left_out():
    rng = np.random.default_rng(6)
    quiet = {"along": [(1e-4, 0.0), (1e-7, 0.0)], "across": [(0.0, 0.0)]}
    fit = fit_signal(noisy(signal_of(quiet), rng))
    assert sorted(fit.parameters()) == ["amplitude_along_1", "frequency", "phase_along_1"]
    asked = fit_signal(noisy(signal_of(quiet, harmonics=2), rng))
    assert len(asked.parameters()) == 1 + 2 * 2 * 2
    assert asked.parameters()["phase_along_1"] == 0.0


# --- what goes with a fit


def test_model_and_residual_make_up_the_samples():
    signal = noisy(signal_of(DRIVE, count=500), np.random.default_rng(8))
    fit = fit_signal(signal._replace(times=signal.times + 3.7))
    fold = fit.fold()
    np.testing.assert_allclose(fit.model(fit.signal.times) + fold.residual, signal.values)
    assert np.sqrt(np.mean(fold.residual**2)) == pytest.approx(1.0, rel=0.1)
    assert fold.phase.min() >= 0
    assert fold.phase.max() <= 2 * np.pi


def test_displacements_have_the_accelerations():
    fit = fit_signal(signal_of(DRIVE))
    phase, step = np.linspace(0, 2 * np.pi, 50), 1e-3
    before, here, after = (fit.displacement(phase + move) for move in (-step, 0, step))
    second = (before - 2 * here + after) / step**2 * (2 * np.pi * fit.frequency) ** 2
    np.testing.assert_allclose(second, fit.periodic(phase), atol=1e-4)


def test_gravity_tells_how_the_track_stands():
    three = {"along": DRIVE["along"], "across": [(1e-6, 0.0)], "normal": DRIVE["normal"]}
    signal = signal_of(three)
    climb, gravity = np.radians(3.0), 9.81
    constant = gravity * np.array([[np.sin(climb)], [0.0], [np.cos(climb)]])
    fit = fit_signal(signal._replace(values=signal.values + constant))
    assert fit.tilt.climb == pytest.approx(climb)
    assert fit.tilt.lean == pytest.approx(0, abs=NEAR)
    assert fit.tilt.gravity == pytest.approx(gravity)
    assert fit_signal(signal).tilt is None  # a sensor that does not show constants


# --- refusals


def test_noise_is_not_periodic():
    signal = signal_of({"along": [(0.0, 0.0)]})
    assert "the recording is not periodic" in refusal(noisy(signal, np.random.default_rng(9)))


def test_another_machine_is_named():
    both = signal_of({"along": [(1e-4, 0.0)]}).values
    other = signal_of({"along": [(5e-5, 0.0)]}, frequency=73.3)
    text = refusal(other._replace(values=both + other.values))
    assert "residual" in text
    assert "most at 50 Hz" in text or "most at 73.3 Hz" in text


def test_a_drive_that_fades_is_refused_and_one_that_hardly_does_is_not():
    signal = signal_of({"along": [(1e-4, 0.0)]})
    faded = [
        signal._replace(values=signal.values * np.linspace(1, end, 800)) for end in (0.8, 0.97)
    ]
    assert "the drive is not steady: its rms along is 6.749 m/s2 in the first third" in refusal(
        faded[0]
    )
    assert fit_signal(faded[1]).left_over[0] < 0.02


def test_a_drive_that_grows_so_much_that_it_is_not_periodic_is_told_to_grow():
    """As a shake table was recorded whose amplitude grew six times over 15 periods."""
    signal = signal_of({"along": [(0.1, 0.0)]}, frequency=1.0, rate=100.0, count=1500)
    text = refusal(signal._replace(values=signal.values * np.geomspace(1, 6, 1500)))
    assert "the recording is not periodic" in text
    assert "the drive is not steady" in text


def test_few_periods_and_few_samples_are_refused():
    slow = {"along": [(1e-4, 0.0)]}
    assert refusal(signal_of(slow, frequency=12.0)) == (
        "recording: 0.4 s hold 4.8 periods of 12 Hz. Record 10 periods at least, 0.833 s, or give "
        "frequency, if it is another."
    )
    double = {"along": [(1e-4, 0.0), (1e-4, 0.0)]}
    assert "0.4 s hold 9 periods of 22.5 Hz" in refusal(signal_of(double, frequency=22.5))
    assert "it has 60 samples" in refusal(signal_of(slow, count=60))
    assert (
        "order 10 of 120 Hz needs 2,667 samples a second, the recording has 2,000. Ask for 7"
        in (refusal(signal_of(slow, frequency=120.0, harmonics=10)))
    )


def test_frequencies_out_of_reach_are_refused_together():
    signal = signal_of(DRIVE)._replace(frequency=1200.0, line_frequency=5.0)
    text = refusal(signal)
    assert "2,000 samples per second, which cannot resolve 1200 Hz. Record at least 2,667" in text
    assert "line_frequency: 0.4 s hold 2 periods of 5 Hz" in text


@pytest.mark.parametrize(
    ("line", "fix"),
    [(60.0, "Clocks are trusted within 5 %"), (100.0, "such as 100 Hz on mains of 50 Hz")],
)
def test_a_clock_that_is_too_far_off_is_refused(line, fix):
    text = refusal(signal_of(DRIVE, line_frequency=line))
    assert f"line_frequency: the recording repeats with 50 Hz, the line has {line:g} Hz" in text
    assert fix in text


def test_channels_at_rest_and_numbers_that_are_none_are_refused():
    still = signal_of({"along": [(0.0, 0.0)]})
    assert "all channels of the recording are constant" in refusal(still)
    broken = signal_of(DRIVE)
    broken.values[0, 3] = np.nan
    assert "the recording holds values that are not finite" in refusal(broken)


def test_importing_loads_no_picture_and_no_table_library():
    code = "import vibrafeed.core.measured, sys; print(*sorted(sys.modules))"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    names = loaded.stdout.split()
    assert not {"matplotlib", "xarray", "pandas", "pint"} & set(names)
