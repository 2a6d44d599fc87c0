"""Harmonics of measured drives: known drives come back, with errors that are as large as stated."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from recordings import AMPLITUDES, DRIVE, PHASES, noisy, signal_of, turned
from refusals import words_of
from vibrafeed.core.measured import Recording, fit_drive, fit_ring_down, fit_signal
from vibrafeed.core.plots.measured import draw_fit

NEAR = 1e-9


def refusal(signal):
    return words_of(fit_signal, signal)


# --- known drives


@pytest.mark.parametrize("start", [0.0031, 0.0137])
def test_a_drive_without_noise_comes_back_to_nine_digits(start):
    signal = signal_of(DRIVE, frequency=49.87, start=start)
    drift = np.array([[0.8], [9.8]]) + 0.3 * np.linspace(-1, 1, 800)
    fit = fit_signal(signal._replace(values=signal.values + drift))
    assert fit.orders == (1, 2, 3)
    assert fit.significant.all()
    for found, known in (
        (fit.frequency, 49.87), (fit.amplitudes, AMPLITUDES), (fit.constant, [0.8, 9.8]),
        (fit.drift, 0.3), (fit.effective_samples, 800), (fit.left_over, 0),
        (turned(fit.phases - PHASES), 0),
    ):  # fmt: skip
        np.testing.assert_allclose(found, np.broadcast_to(known, np.shape(found)), NEAR, NEAR)


@pytest.mark.parametrize("order", [2, 7])
def test_an_overtone_may_be_fifty_times_as_strong_as_the_fundamental(order):
    orders = [(2e-6 * order**2, 0.3), *[(0.0, 0.0)] * (order - 2), (1e-4, -0.4)]
    signal = signal_of({"along": orders}, frequency=41.0)
    fit = fit_signal(noisy(signal, np.random.default_rng(1), size=0.02))
    assert fit.frequency == pytest.approx(41.0, rel=1e-5)
    assert fit.orders == (1, order)


def test_orders_of_an_absent_fundamental_are_found():
    fit = fit_signal(signal_of({"along": [(0.0, 0.0), (1e-4, 0.4), (6e-5, -0.9)]}, frequency=30.0))
    assert fit.orders == (2, 3)
    assert fit.frequency == pytest.approx(30.0, rel=NEAR)
    found = fit.parameters()
    names = {f"{what}_along_{order}" for what in ("amplitude", "phase") for order in (2, 3)}
    assert found.keys() == names | {"frequency"}
    assert found["phase_along_2"] == 0.0
    assert turned(fit.phases[0, 1] - (-0.9 - 1.5 * 0.4)) == pytest.approx(0, abs=NEAR)


def test_a_guess_chooses_among_whole_parts():
    plain = signal_of({"along": [(1e-4, 0.0)]}, frequency=60.0)
    assert fit_signal(plain).frequency == pytest.approx(60.0)
    halved = fit_signal(plain._replace(frequency=31.0))
    assert (halved.frequency, halved.orders) == (pytest.approx(30.0), (2,))


def test_a_line_frequency_settles_what_a_short_recording_leaves_open():
    signal = signal_of(DRIVE, count=450)
    foreign = signal_of({"along": [(1e-5, 0.0)]}, frequency=25.2, count=450).values
    signal = signal._replace(values=signal.values + foreign)
    signal = noisy(signal, np.random.default_rng(10), size=0.05)
    # In eleven periods 25.2 Hz could be the half of 50 Hz.
    assert "has only 5.62 periods of 25 Hz" in refusal(signal)
    assert fit_signal(signal._replace(line_frequency=50.0)).frequency == 50.0


# --- laws


@pytest.mark.parametrize("times", [1.01, 0.97])
def test_a_wrong_clock_is_told_and_undone(times):
    signal = signal_of(DRIVE)
    # A clock that counts too few seconds shows shorter times, thus a higher frequency.
    fit = fit_signal(signal._replace(times=signal.times / times, line_frequency=50.0))
    assert (fit.frequency, fit.frequency_error) == (50.0, 0.0)
    assert fit.clock.error == pytest.approx(times - 1, rel=1e-7)
    np.testing.assert_allclose(fit.amplitudes, AMPLITUDES, rtol=NEAR)
    np.testing.assert_allclose(turned(fit.phases - PHASES), 0, atol=NEAR)


# --- errors


def test_draws_have_the_stated_errors():
    fit = fit_signal(noisy(signal_of(DRIVE), np.random.default_rng(4)))
    drawn = fit.draw(np.random.default_rng(5), 4000)
    middle = fit.parameters()
    stated = {"frequency": fit.frequency_error}
    for axis, sizes, turns in zip(fit.axes, fit.amplitude_errors, fit.phase_errors, strict=True):
        stated |= {f"amplitude_{axis}_{k}": one for k, one in zip(fit.orders, sizes, strict=True)}
        degrees = np.degrees(turns)
        stated |= {f"phase_{axis}_{k}": one for k, one in zip(fit.orders, degrees, strict=True)}
    for name, error in stated.items():
        away = np.array([one[name] for one in drawn]) - middle[name]
        away = np.degrees(turned(np.radians(away))) if "phase" in name else away
        # The spread of 4000 draws is known to 1.1 %.
        assert np.std(away) == pytest.approx(error, rel=0.06, abs=1e-10), name


def test_what_the_data_do_not_tell_is_left_out():
    rng = np.random.default_rng(6)
    quiet = {"along": [(1e-4, 0.0), (1e-7, 0.0)], "across": [(0.0, 0.0)]}
    fit = fit_signal(noisy(signal_of(quiet), rng))
    assert sorted(fit.parameters()) == ["amplitude_along_1", "frequency", "phase_along_1"]
    asked = fit_signal(noisy(signal_of(quiet, harmonics=2), rng)).parameters()
    assert len(asked) == 1 + 2 * 2 * 2


def test_model_and_residual_make_up_the_samples_and_displacements_the_accelerations():
    signal = noisy(signal_of(DRIVE, count=500), np.random.default_rng(8))
    fit = fit_signal(signal._replace(times=signal.times + 3.7))
    fold = fit.fold()
    np.testing.assert_allclose(fit.model(fit.signal.times) + fold.residual, signal.values)
    assert np.sqrt(np.mean(fold.residual**2)) == pytest.approx(1.0, rel=0.1)
    assert 0 <= fold.phase.min() < fold.phase.max() <= 2 * np.pi
    phase, step = np.linspace(0, 2 * np.pi, 50), 1e-3
    before, here, after = (fit.displacement(phase + move) for move in (-step, 0, step))
    second = (before - 2 * here + after) / step**2 * (2 * np.pi * fit.frequency) ** 2
    np.testing.assert_allclose(second, fit.periodic(phase), atol=1e-4)


# --- what goes with a fit


def test_gravity_tells_how_the_track_stands():
    signal = signal_of({**DRIVE, "across": [(1e-6, 0.0)]})
    climb, gravity = np.radians(3.0), 9.81
    constant = gravity * np.array([[np.sin(climb)], [np.cos(climb)], [0.0]])
    tilt = fit_signal(signal._replace(values=signal.values + constant)).tilt
    assert [tilt.climb, tilt.lean, tilt.gravity] == pytest.approx([climb, 0, gravity], abs=NEAR)
    assert fit_signal(signal).tilt is None  # a sensor that does not show constants


PLAIN = {"along": [(1e-4, 0.0)]}


SIGNAL = signal_of(PLAIN)


BOTH = SIGNAL.values + signal_of({"along": [(5e-5, 0.0)]}, frequency=73.3).values


SLOW = signal_of({"along": [(0.1, 0.0)]}, frequency=1.0, rate=100.0, count=1500)


BROKEN = np.where(np.arange(800) == 3, np.nan, SIGNAL.values)


def times(signal, factors):
    return signal._replace(values=signal.values * factors)


@pytest.mark.parametrize(
    ("signal", "words"),
    [
        (noisy(times(SIGNAL, 0), np.random.default_rng(9)), ["the recording is not periodic"]),
        (SIGNAL._replace(values=BOTH), ["residual", "mostly at "]),
        (times(SIGNAL, np.linspace(1, 0.8, 800)),
         ["the drive is not steady: its rms along is 6.749 m/s2 in the first third"]),
        # As a shake table was recorded whose amplitude grew six times over 15 periods.
        (times(SLOW, np.geomspace(1, 6, 1500)),
         ["the recording is not periodic", "the drive is not steady"]),
        (signal_of(PLAIN, frequency=12.0),
         ["recording: the recording of 0.4 s has only 4.8 periods of 12 Hz. Record at least 10 "
          "periods, 0.833 s, or give the frequency if this one is wrong."]),
        (signal_of({"along": [(1e-4, 0.0)] * 2}, frequency=22.5), ["only 9 periods of 22.5 Hz"]),
        (signal_of(PLAIN, count=60), ["has only 60 samples"]),
        (signal_of(PLAIN, frequency=120.0, harmonics=10),
         ["needs 2,667 samples per second, and the recording has 2,000. Give harmonics = 7"]),
        # Frequencies out of reach are told together.
        (SIGNAL._replace(frequency=1200.0, line_frequency=5.0),
         ["2,000 samples per second, which cannot resolve 1200 Hz. Record at least 2,667",
          "has only 2 periods of 5 Hz"]),
        (SIGNAL._replace(line_frequency=60.0),
         ["line_frequency: the recorded drive has 50 Hz, but line_frequency is 60 Hz",
          "a recorder's clock is not off by more than 5 %"]),
        (SIGNAL._replace(line_frequency=100.0), ["such as 100 Hz on mains of 50 Hz"]),
        (times(SIGNAL, 0), ["all channels of the recording are constant"]),
        (SIGNAL._replace(values=BROKEN),
         ["the recording has values that are not finite"]),
    ],
)  # fmt: skip
def test_what_is_no_drive_is_refused(signal, words):
    text = refusal(signal)
    assert all(word in text for word in words), text


# --- refusals


EXAMPLES = Path(__file__).parents[4] / "examples"
RECORDING = EXAMPLES / "accelerometer.csv"


@pytest.fixture(scope="module")
def program():
    spec = importlib.util.spec_from_file_location("accelerometer", EXAMPLES / "accelerometer.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def fit():
    return fit_drive(RECORDING, Recording(sensor=("ax", "ay", "az"), line_frequency="50 Hz"))


def test_the_program_makes_the_recording(program, tmp_path):
    program.main(tmp_path / "made.csv")
    assert (tmp_path / "made.csv").read_text() == RECORDING.read_text()


def test_the_drive_is_the_one_that_was_put_in(program, fit):
    assert fit.orders == (1, 2, 3)
    known = np.array([program.DRIVE[axis] for axis in fit.axes])  # mm and degrees
    found = np.stack([1e3 * fit.amplitudes, np.degrees(fit.phases)], axis=-1)
    errors = np.stack([1e3 * fit.amplitude_errors, np.degrees(fit.phase_errors)], axis=-1)
    moves = known[..., 0] > 0
    np.testing.assert_array_equal(fit.significant, moves)
    assert (np.abs(found - known) <= 3 * errors + 1e-9)[moves].all()
    assert abs(fit.clock.error - program.CLOCK) < 3 * fit.clock.standard_error
    assert np.degrees(fit.tilt.climb) == pytest.approx(3.0, abs=0.5)


def test_a_picture_says_what_was_fitted(fit):
    figure = draw_fit(fit)
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == [
        "Along (m/s²)", "Across (m/s²)", "Normal (m/s²)", "Residual (m/s²)", "Amplitude (m/s²)",
        "Normal (µm)",
    ]  # fmt: skip
    assert figure.axes[0].get_title(loc="left").splitlines() == [
        "50 Hz · clock 0.3 % slow · 50 periods, 5,000 samples",
        "All axes together: not explained by the fit 4.4 %, drift 0.35 % of the drive",
    ]


# --- a knock


def test_the_four_strongest_modes_of_a_knock_are_told_apart():
    times, sizes = np.arange(600) / 1000, np.array([[30.0], [27.0], [24.0], [21.0], [18.0]])
    modes, after = np.array([[23.0], [53.0], [81.0], [117.0], [171.0]]), np.maximum(times - 0.1, 0)
    waves = np.exp(-0.04 * np.pi * modes * after) * np.cos(2 * np.pi * modes * after)
    values = (sizes * waves).sum(axis=0) * (times >= 0.1)
    rows = "\n".join(f"{t:.3f},{v:.4f}" for t, v in zip(times, values, strict=True))
    fit = fit_ring_down(f"time [s],ax [m/s2]\n{rows}", Recording(along="ax"))
    found = sorted([fit.natural_frequency, *fit.other_frequencies])
    assert found == pytest.approx(modes[:4, 0], rel=0.01)
