"""`vibrafeed drive`, as a user runs it, and studies with a recording from file to dataset."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from recordings import csv_of, signal_of
from vibrafeed.app.cli import app
from vibrafeed.core.intake import parse_study
from vibrafeed.core.measured import Recording, fit_drive

RECORDING = Path(__file__).parents[3] / "examples" / "accelerometer.csv"
AXES = ("--sensor", "ax,ay,az", "--line-frequency", "50 Hz")


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_the_table_tells_numbers_and_errors():
    result = run("drive", RECORDING, *AXES)
    assert result.exit_code == 0, result.output
    for words in (
        "5,000 samples, 50.1 periods", "frequency: 50 Hz, as given", "% slow",
        "not explained by the fit: along 2.5 %, across 2.5 %, normal 2.6 % of the drive; 0.4",
        "peak to peak along the line of vibration", "along by",
        "climbs by 3.38 degrees",
        "0.200072", "amplitude (mm)", "phase (°)", "-74.70", "not distinguishable from zero",
    ):  # fmt: skip
        assert words in result.output


def test_without_a_column_the_options_and_the_columns_are_named():
    result = run("drive", RECORDING)
    assert result.exit_code == 2
    assert (
        "no acceleration column; the recording has the columns time, ax, ay, az. Give"
        in result.output
    )


def test_the_stroke_has_a_line_and_unusual_numbers_a_question(tmp_path):
    """The drive along is 0.2 mm and normal 0.1 mm in phase: 0.1 sqrt(5) mm at atan(1/2)."""
    text = csv_of(signal_of({"along": [(2e-4, 0.0)], "normal": [(1e-4, 0.0)]}))
    file = tmp_path / "part.csv"
    file.write_text(text)
    axes = ("--along", "ax", "--normal", "az")
    usual = run("drive", file, *axes)
    assert "stroke: 0.44721" in usual.output
    assert "line of vibration, at 26.56" in usual.output
    assert "unusual" not in usual.output
    file.write_text(text.replace("time [s]", "number"))
    told = run("drive", file, *axes)
    assert "Give --rate=the samples per second, or --time=the name of the column" in told.output
    unusual = run("drive", file, *axes, "--rate", "2")
    assert unusual.exit_code == 0
    assert f"{file}: warning: frequency = 0.05 Hz, fitted to part.csv, is unus" in unusual.stderr


@pytest.mark.parametrize("heading", ["Zeit [s]", "Messzeit [s]", "Zeit in s", "Zeit", "Uhr (s)"])
def test_a_column_of_times_is_found_by_its_unit_or_name(heading, tmp_path):
    text = csv_of(signal_of({"along": [(2e-4, 0.0)], "normal": [(1e-4, 0.0)]}))
    file = tmp_path / "part.csv"
    rows = text.replace("time [s]", heading).replace(",", ";").replace(".", ",")
    file.write_text(rows, encoding="utf-8")
    found = run("drive", file, "--along", "ax", "--normal", "az")
    assert found.exit_code == 0, found.output
    assert "stroke: 0.44721" in found.output


def test_the_toml_is_the_parameters_of_a_study(tmp_path):
    part = tmp_path / "part.toml"
    result = run("drive", RECORDING, *AXES, "--toml", "-o", part)
    assert result.exit_code == 0, result.output
    assert result.stdout == part.read_text()
    parameters = tomllib.loads(result.stdout)["parameters"]
    content = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    values = parse_study(content).values()
    fit = fit_drive(RECORDING, Recording(sensor=("ax", "ay", "az"), line_frequency=50))
    assert values.keys() == fit.parameters().keys()
    for name, number in fit.parameters().items():
        assert values[name].value == pytest.approx(number, rel=1e-3), name


@pytest.mark.by_day(1)
@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_picture_is_drawn(kind, tmp_path):
    target = tmp_path / f"fit.{kind}"
    result = run("drive", RECORDING, "--along", "-ax", "--normal", "az", "--plot", target)
    assert result.exit_code == 0, result.output
    assert target.stat().st_size > 10_000


def test_every_problem_is_told_at_once(tmp_path):
    result = run(
        "drive", RECORDING, "--along", "bx", "--normal", "az", "--rate", "3 x", "--unit", "kg",
        "--mounting", "1,2,3", "--harmonics", 12, "--plot", tmp_path / "fit.bmp",
    )  # fmt: skip
    assert result.exit_code == 2
    assert result.output.splitlines() == [
        f"{RECORDING}: error: 6 problems",
        "  --plot: '.bmp': unknown picture format. End the name of the picture in .png, .svg "
        "or .pdf.",
        "  --rate: 'x' is not a unit. Write --rate=\"5 kHz\" (a bare number is in Hz).",
        "  --mounting: the mounting is that of a sensor of three columns, which are not given. "
        "Give --sensor=three columns, instead of a column for each axis.",
        "  --along: the table has no column 'bx'. Known: ax, ay, az, time.",
        "  --unit: 'kg' is not a unit of acceleration. Known: m s-2, mm s-2, cm/s2, g, mg, mm/s, "
        "mm.",
        "  --harmonics: 12 orders cannot be fitted. Give a whole number from 1 to 10, or leave it "
        "out.",
    ]
    both = run("drive", RECORDING, "--along", "ax", "--sensor", "ax,ay,az", "--rate", "5 kHz",
               "--time", "time")  # fmt: skip
    assert both.output.splitlines()[1:] == [
        "  --rate: the recording has both a sampling rate (--rate) and a time column (--time). "
        "Give only the one that the recorder measures more accurately.",
        "  --sensor: the drive names the columns of a sensor, and single ones (--along). "
        "Give either --sensor=three columns, or a column for each axis.",
    ]
    absent = run("drive", tmp_path / "absent.csv", "--along", "ax")
    assert absent.exit_code == 2
    assert "recording: it cannot be read: No such file or directory." in absent.output


def test_what_cannot_be_written_is_told(tmp_path):
    result = run("drive", RECORDING, "--along", "ax", "-o", tmp_path / "no" / "part.toml")
    assert result.exit_code == 1
    assert "No such file or directory" in result.output


def test_a_study_finds_its_recording_beside_itself(tmp_path):
    (tmp_path / "recording.csv").write_bytes(RECORDING.read_bytes())
    study = tmp_path / "study.toml"
    study.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfriction = 0.3\n'
        '[drive]\nfile = "recording.csv"\nalong = "ax"\nnormal = "az"\n'
    )
    result = run("run", study)
    assert result.exit_code == 0, result.output
    with xarray.open_dataset(study.with_suffix(".nc"), engine="netcdf4") as dataset:
        assert dataset.attrs["drive"].startswith("fitted to recording.csv (SHA-256 ")
        assert str(tmp_path) not in str(dataset.attrs)
    named = tmp_path / "named.toml"
    named.write_text(study.read_text().replace("file = ", "recording = "))
    wrong = run("run", named)
    assert "'recording' is not a key of the section drive. Did you mean 'file'?" in wrong.output
    (tmp_path / "recording.csv").unlink()
    gone = run("run", study)
    assert gone.exit_code == 2
    assert "drive.file: it cannot be read: No such file or directory." in gone.output
