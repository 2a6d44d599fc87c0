"""The example recording: made by its program, fitted to what its program says, drawn."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from vibrafeed.core.measured import Recording, fit_drive
from vibrafeed.core.plots.measured import draw_fit

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
    assert abs(fit.clock.error - program.CLOCK) < 3 * fit.clock.standard_error
    assert fit.orders == (1, 2, 3)
    for axis, orders in program.DRIVE.items():
        row = fit.axes.index(axis)
        for place, (amplitude, phase) in enumerate(orders):
            error = fit.amplitude_errors[row, place]
            assert fit.significant[row, place] == (amplitude > 0)
            if amplitude > 0:
                assert abs(fit.amplitudes[row, place] - 1e-3 * amplitude) < 3 * error
                away = np.degrees(fit.phases[row, place]) - phase
                assert abs(away) < 3 * np.degrees(fit.phase_errors[row, place]) + 1e-9
    assert np.degrees(fit.tilt.climb) == pytest.approx(3.0, abs=0.5)


def test_what_is_left_over_is_noise_and_hum(program, fit):
    hum = program.FAN[1] / np.sqrt(2)
    rounding = program.GRAVITY * program.STEP / np.sqrt(12)
    expected = np.sqrt(program.NOISE**2 + hum**2 + rounding**2)
    rms = np.sqrt(np.mean(fit.fold().residual ** 2, axis=1))
    np.testing.assert_allclose(rms, expected, rtol=0.05)


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
