"""Files that the command line writes are read again, and no text that is typed is cut."""

from __future__ import annotations

import csv
import json

import pytest
import xarray
from typer.testing import CliRunner

import vibrafeed.accessor  # noqa: F401 - gives datasets their `.vibrafeed`
from vibrafeed.app.cli import app
from vibrafeed.core.intake import load_study
from vibrafeed.core.study.shown import SYSTEMS

MOTION = """\
kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity"]
[parameters]
frequency = "3000 rpm"
amplitude = ["0.1 mm", "0.2 mm", "0.3 mm"]
beta = "20 deg"
friction = 0.3
"""
CALIBRATION = """\
kind = "calibrate"
scene = "rectangle-on-plane"
observations = "{table}"
[parameters]
frequency = "50 Hz"
beta = "20 deg"
[unknowns]
friction = {{ lower = 0.1, upper = 0.6 }}
"""
NAMES = ("amplitude", "conveying_velocity")
LONG = "0.3" + "0" * 250 + " mm"


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    """A folder with one result in several formats, and as workbooks in units for reading."""
    pytest.importorskip("openpyxl")
    folder = tmp_path_factory.mktemp("own")
    (folder / "motion.toml").write_text(MOTION)
    for suffix in ("nc", "csv", "xlsx"):
        result = run("run", folder / "motion.toml", "-o", folder / f"x.{suffix}")
        assert result.exit_code == 0, result.output
    with xarray.open_dataset(folder / "x.nc") as dataset:
        for units in SYSTEMS:
            dataset.vibrafeed.shown(units).vibrafeed.to_excel(folder / f"{units}.xlsx")
    return folder


def rows_of(path):
    """Return the cells of a CSV file, or of the first sheet of a workbook."""
    if path.suffix == ".csv":
        with path.open(newline="", encoding="utf-8") as file:
            return list(csv.reader(file))
    book = pytest.importorskip("openpyxl").load_workbook(path)
    return [list(row) for row in book.worksheets[0].iter_rows(values_only=True)]


@pytest.mark.parametrize("name", ["x.csv", "x.xlsx", "trade.xlsx", "si.xlsx"])
def test_columns_of_a_result_are_observations(motion, tmp_path, name):
    heading, *rows = rows_of(motion / name)
    kept = [k for k, cell in enumerate(heading) if cell.split()[0] in NAMES]
    with (tmp_path / "runs.csv").open("w", newline="", encoding="utf-8") as file:
        for line, error in ((heading, "error"), *((row, "5 %") for row in rows)):
            csv.writer(file).writerow([*(line[k] for k in kept), error])
    (tmp_path / "study.toml").write_text(CALIBRATION.format(table="runs.csv"))
    study = load_study(tmp_path / "study.toml")
    # Of values for reading: the factor, the product with it, and the reading are rounded.
    tolerance = 4 * 2.0**-53 if name == "trade.xlsx" else 0
    with xarray.open_dataset(motion / "x.nc") as dataset:
        for column in NAMES:
            read = [getattr(run, column) for run in study.observations]
            assert read == pytest.approx(dataset[column].values.tolist(), rel=tolerance, abs=0)


def test_a_value_to_look_at_is_not_cut(motion):
    result = run("plot", motion / "x.nc", "--at", f"amplitude={LONG}", "-o", motion / "x.png")
    assert result.exit_code == 2
    assert "has 256 characters. A value has at most 200 characters" in " ".join(
        result.output.split()
    )


def test_a_study_with_a_number_of_900_000_digits_is_refused(tmp_path):
    content = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"]}
    text = json.dumps({**content, "parameters": {"frequency": 7}}).replace("7", "7" * 900_000)
    (tmp_path / "study.json").write_text(text)
    (tmp_path / "study.toml").write_text(f"frequency = {'7' * 900_000}\n")
    for name in ("study.json", "study.toml"):
        result = run("run", tmp_path / name)
        assert result.exit_code == 2
        assert "it is a number larger than 1.8e308. Fix the value" in result.output
