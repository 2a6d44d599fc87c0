"""Tables that the command line writes are read again as measured runs."""

import pandas
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


@pytest.mark.parametrize("name", ["x.csv", "x.xlsx", "trade.xlsx", "si.xlsx"])
def test_columns_of_a_result_are_observations(motion, name):
    table = (pandas.read_csv if name == "x.csv" else pandas.read_excel)(motion / name)
    kept = [heading for heading in table if heading.split()[0] in NAMES]
    table[kept].assign(error="5 %").to_csv("runs.csv", index=False)
    study = load_study(saved(CALIBRATION))
    # Of values for reading: the factor, the product with it, and the reading are rounded.
    tolerance = 4 * 2.0**-53 if name == "trade.xlsx" else 0
    with xarray.open_dataset(motion / "x.nc") as dataset:
        for column in NAMES:
            read = [getattr(run, column) for run in study.observations]
            assert read == pytest.approx(dataset[column].values.tolist(), rel=tolerance, abs=0)
