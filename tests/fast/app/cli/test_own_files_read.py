"""Tables that the command line writes are read again as measured runs."""

from __future__ import annotations

import csv

import openpyxl
import pytest
import xarray

import vibrafeed.accessor  # noqa: F401 - gives datasets their `.vibrafeed`
from commands import run, saved
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
observations = "runs.csv"
[parameters]
frequency = "50 Hz"
beta = "20 deg"
[unknowns]
friction = { lower = 0.1, upper = 0.6 }
"""
NAMES = ("amplitude", "conveying_velocity")


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    """A folder with one result in several formats, and as workbooks in units for reading."""
    folder = tmp_path_factory.mktemp("own")
    saved(MOTION, f"{folder}/motion.toml")
    for suffix in ("nc", "csv", "xlsx"):
        run(f"run {folder}/motion.toml -o {folder}/x.{suffix}")
    with xarray.open_dataset(folder / "x.nc") as dataset:
        for units in SYSTEMS:
            dataset.vibrafeed.shown(units).vibrafeed.to_excel(folder / f"{units}.xlsx")
    return folder


def rows_of(path):
    """Return the cells of a CSV file, or of the first sheet of a workbook."""
    if path.suffix == ".csv":
        return list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    book = openpyxl.load_workbook(path)
    return [list(row) for row in book.worksheets[0].iter_rows(values_only=True)]


@pytest.mark.parametrize("name", ["x.csv", "x.xlsx", "trade.xlsx", "si.xlsx"])
def test_columns_of_a_result_are_observations(motion, here, name):
    heading, *rows = rows_of(motion / name)
    kept = [k for k, cell in enumerate(heading) if cell.split()[0] in NAMES]
    with (here / "runs.csv").open("w", newline="", encoding="utf-8") as file:
        for line, error in ((heading, "error"), *((row, "5 %") for row in rows)):
            csv.writer(file).writerow([*(line[k] for k in kept), error])
    study = load_study(saved(CALIBRATION))
    # Of values for reading: the factor, the product with it, and the reading are rounded.
    tolerance = 4 * 2.0**-53 if name == "trade.xlsx" else 0
    with xarray.open_dataset(motion / "x.nc") as dataset:
        for column in NAMES:
            read = [getattr(run, column) for run in study.observations]
            assert read == pytest.approx(dataset[column].values.tolist(), rel=tolerance, abs=0)
