"""The tables and texts that public sources hold, each read right or refused with its reason.

Every recording shows 50 Hz, 0.3 mm along, 0.1 mm normal that lags by 34.4 degrees, and +1 g in its
normal channel; a part with friction 0.3 then travels with +56.6 mm/s. Requests, files of MATLAB
and arrays with units are in test_interface, test_formats and test_arrays_with_units.
"""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.intake.forms import read_toml
from vibrafeed.core.intake.sections import read_rows

TIMES = np.arange(800) / 2000.0
TURN = 100.0 * np.pi
ALONG = -3e-4 * TURN**2 * np.sin(TURN * TIMES)
NORMAL = 9.80665 - 1e-4 * TURN**2 * np.sin(TURN * TIMES - 0.6)
G = 9.80665
KLIPPER = "#time,accel_x,accel_y,accel_z"
LVM = """LabVIEW Measurement\t
Separator\tTab\t
X_Columns\tOne\t
***End_of_Header***\t
\t
Samples\t800\t800\t800\t
Y_Unit_Label\tg\tg\tg\t
Delta_X\t0.000500\t0.000500\t0.000500\t
***End_of_Header***\t\t\t\t
X_Value\tax\tay\taz\tComment"""


def iso(seconds):
    """Return a time of the day after ISO 8601."""
    return f"2024-01-02T03:04:{5 + seconds:09.6f}"


# Head, separator, factor of the times, factor of the channels, and keys of [drive].
RIGHT = {
    "in SI": ("time [s],ax [m/s2],ay [m/s2],az [m/s2]", ",", 1, 1, {}),
    "behind a sign": (KLIPPER, ",", 1, 1e3, {"along": "accel_x", "normal": "accel_z",
                                             "unit": "mm/s2"}),
    "of ISO 8601": ("time,ax [g],ay [g],az [g]", ",", iso, 1 / G, {}),
    "of LabVIEW": (LVM, "\t", 1, 1 / G, {}),
    "of spreadsheets": ("sep=;\nTime (s);ax (g);ay (g);az (g)", ";,", 1, 1 / G, {}),
    "in milliseconds": ("time_ms,acc_x_g,acc_y_g,acc_z_g", ",", 1e3, 1 / G,
                        {"along": "acc_x_g", "normal": "acc_z_g"}),
    "with a G": ("time (sec),ax (G),ay (G),az (G)", ",", 1, 1 / G, {}),
    "with superscripts": ("time [s];ax [m·s⁻²];ay [m·s⁻²];az [m·s⁻²]", ";", 1, 1, {}),
}  # fmt: skip


def recording(head, separator, of_time=1, factor=1.0, normal=NORMAL):
    """Return a recording as text, with times that a number multiplies or a function writes."""
    write = of_time if callable(of_time) else lambda t: f"{of_time * t:.6f}"
    rows = [
        separator[0].join([write(t), f"{a * factor:.6f}", "0.0", f"{n * factor:.6f}"])
        for t, a, n in zip(TIMES.tolist(), ALONG.tolist(), normal.tolist(), strict=True)
    ]
    text = "\n".join(rows)
    return head + "\n" + (text.replace(".", ",") if separator[1:] else text) + "\n"


def study(text, **drive):
    """Return the content of a study of a recording."""
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "drive": {"data": text, "along": "ax", "normal": "az", **drive},
        "parameters": {"friction": 0.3},
    }  # fmt: skip


def numbers(text, **drive):
    """Return the parameters of a study of a recording."""
    return prepare_content(study(text, **drive)).study.content()["parameters"]


def is_true(found):
    """Check the drive."""
    assert found["frequency"] == pytest.approx(50.0, rel=1e-6)
    assert found["amplitude_along_1"] == pytest.approx(3e-4, rel=1e-4)
    assert found["amplitude_normal_1"] == pytest.approx(1e-4, rel=1e-4)
    lag = found["phase_normal_1"] - found["phase_along_1"]
    assert lag == pytest.approx(-np.degrees(0.6), abs=0.01)


@pytest.mark.parametrize("name", RIGHT)
def test_recordings_that_are_right(name):
    head, separator, of_time, factor, drive = RIGHT[name]
    is_true(numbers(recording(head, separator, of_time, factor), **drive))


def test_a_lost_sample_moves_nothing():
    lines = recording("time [s],ax [g],ay [g],az [g]", ",", 1, 1 / G).splitlines()
    is_true(numbers("\n".join([*lines[:400], *lines[401:]])))


def test_the_speed_is_the_one_of_the_drive():
    found = vibrafeed.simulate(study(recording(RIGHT["in SI"][0], ",")))
    assert float(found.conveying_velocity) == pytest.approx(0.0566, abs=5e-5)


REVERSED = recording(RIGHT["in SI"][0], ",", normal=-NORMAL)
UNNAMED = recording("time,ax,ay,az", ",", 1e3, 1 / G)


def test_recordings_that_are_wrong_are_refused_and_their_advice_makes_them_right():
    with pytest.raises(StudyError, match="the channel points downwards") as caught:
        numbers(REVERSED)
    assert "a minus sign in front of the column's name" in str(caught.value)
    is_true(numbers(REVERSED, normal="-az"))
    with pytest.raises(StudyError, match="is probably ms. Write the unit in the heading, as in "
                       r"'time \[ms\]', or give rate = the samples per second"):  # fmt: skip
        numbers(UNNAMED, unit="g")
    is_true(numbers(UNNAMED.replace("time", "time [ms]", 1), unit="g"))
    is_true(numbers(UNNAMED, unit="g", rate=2000))


def test_thousands_are_refused_and_right_without_their_commas():
    rows = [f"{t:.6f};{1e3 * n:,.0f}" for t, n in zip(TIMES, NORMAL, strict=True)]
    text = "\n".join(["Time [s];az [mm/s2]", *rows])
    with pytest.raises(StudyError, match="Export it without separators of thousands") as caught:
        numbers(text, along=None)
    assert "drive.normal: column 'Time' has '0.000000' and column 'az' has" in str(caught.value)
    found = numbers(text.replace(",", ""), along=None)
    assert found["amplitude_normal_1"] == pytest.approx(1e-4, rel=1e-3)


@pytest.mark.parametrize("heading", ["amplitude [µm],conveying_velocity [mm/s],error",
                                     "amplitude [m],conveying_velocity [m s-1],error"])  # fmt: skip
@pytest.mark.parametrize("encoding", ["cp1252", "utf-8"])
def test_runs_of_spreadsheets_and_of_our_own_files(tmp_path, heading, encoding):
    rows = "100,3.5,5 %\n150,5.5,5 %\n" if "µ" in heading else "1e-4,3.5e-3,5 %\n15e-5,5.5e-3,5 %\n"
    (tmp_path / "runs.csv").write_bytes(f"{heading}\n{rows}".encode(encoding))
    runs = parse_study({
        "kind": "calibrate", "scene": "rectangle-on-plane",
        "observations": read_rows(tmp_path / "runs.csv"),
        "parameters": {"frequency": 50, "beta": 20},
        "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
    }).observations  # fmt: skip
    assert [run.amplitude for run in runs] == pytest.approx([1e-4, 1.5e-4], rel=1e-15)
    assert [run.conveying_velocity for run in runs] == pytest.approx([3.5e-3, 5.5e-3], rel=1e-15)
    assert [run.error for run in runs] == pytest.approx([1.75e-4, 2.75e-4], rel=1e-12)


SWEEP = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["throw_number"]
parameters = { frequency = "50 Hz", amplitude = "0.3 mm", beta = "20 deg", gamma = "{minus}5 deg" }
"""


def test_a_minus_of_a_book_is_a_minus():
    content = read_toml(SWEEP.replace("{minus}", "\N{MINUS SIGN}"))
    assert prepare_content(content).study.content()["parameters"]["gamma"] == -5.0
