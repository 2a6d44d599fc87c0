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
