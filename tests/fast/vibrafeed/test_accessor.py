"""`dataset.vibrafeed`: what a dataset of vibrafeed can do besides."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path

import matplotlib.figure
import numpy as np
import openpyxl
import pytest
import xarray

import vibrafeed

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def motion() -> xarray.Dataset:
    return vibrafeed.simulate(
        scene="rectangle-on-plane", frequency="50 Hz", beta=30, friction=0.5,
        amplitude=["0.01 mm", "0.1 mm", "0.2 mm", "0.4 mm"], units="m/min",
    )  # fmt: skip


def test_shares_of_regimes_are_those_of_the_cells(motion):
    shares = motion.vibrafeed.regime_shares()
    assert shares == {"stick": 0.25, "stick_slip": 0.25, "hopping": 0.5}
    assert motion.isel(amplitude=0).vibrafeed.regime_shares() == {"stick": 1.0}


def test_the_study_makes_the_dataset_again(motion):
    study = motion.vibrafeed.study
    assert isinstance(study, vibrafeed.SimulateStudy)
    assert study.key() == motion.attrs["study_sha256"]
    xarray.testing.assert_equal(vibrafeed.simulate(study), motion)


def test_values_are_shown_in_the_units_that_were_asked_for(motion):
    trade, own, si = (
        motion.vibrafeed.shown("trade"),
        motion.vibrafeed.shown(),
        motion.vibrafeed.shown("si"),
    )
    speed = motion.conveying_velocity.values
    np.testing.assert_allclose(trade.conveying_velocity, 1000 * speed, rtol=1e-15)
    np.testing.assert_allclose(own.conveying_velocity, 60 * speed, rtol=1e-15)
    np.testing.assert_array_equal(si.conveying_velocity, speed)
    units = [one.conveying_velocity.units for one in (trade, own, si)]
    assert units == ["mm/s", "m/min", "m/s"]
    assert trade.amplitude.values.tolist() == [0.01, 0.1, 0.2, 0.4]
    assert (trade.amplitude.units, trade.beta.units, trade.friction.units) == ("mm", "°", "")
    xarray.testing.assert_identical(trade.regime.variable, motion.regime.variable)
    assert motion.conveying_velocity.units == "m s-1"  # itself it stays as it was
    with pytest.raises(vibrafeed.StudyError, match="'kelvin' is not a unit that vibrafeed knows"):
        motion.vibrafeed.shown("kelvin")


def test_trade_gives_the_units_of_a_workshop():
    motion = vibrafeed.simulate(
        "rectangle-on-track", frequency="50 Hz", amplitude=["0.2 mm", "0.4 mm"], beta=25,
        friction=0.3, length="10 mm", radius="150 mm",
        outputs=["conveying_velocity", "feed_rate", "hop_height", "vibration_acceleration"],
    )  # fmt: skip
    trade = motion.vibrafeed.trade()
    units = {
        "conveying_velocity": "mm/s", "feed_rate": "1/min", "hop_height": "mm", "amplitude": "mm",
        "beta": "deg", "frequency": "Hz", "vibration_acceleration": "m/s²", "friction": "",
    }  # fmt: skip
    assert {name: trade[name].units for name in units} == units
    speed = motion.conveying_velocity.values
    np.testing.assert_allclose(trade.conveying_velocity, 1000 * speed, rtol=1e-15)
    np.testing.assert_allclose(trade.feed_rate, 60 * speed / 0.01, rtol=1e-12)
    assert trade.beta == 25
    assert motion.feed_rate.units == "min-1"
    xarray.testing.assert_identical(motion.vf.trade(), trade)  # the short name


def test_it_is_drawn(motion):
    takes = list(inspect.signature(vibrafeed.plot).parameters.values())[1:]
    assert list(inspect.signature(motion.vibrafeed.plot).parameters.values()) == takes
    figure = motion.vibrafeed.plot(axes="amplitude")
    assert isinstance(figure, matplotlib.figure.Figure)
    with pytest.raises(vibrafeed.VibrafeedError):
        motion.vibrafeed.plot(variable="throw_number")


def test_what_is_no_result_is_told_so():
    other = xarray.Dataset({"a": 1})
    for ask in (lambda: other.vibrafeed.study, other.vibrafeed.regime_shares):
        with pytest.raises(vibrafeed.VibrafeedError, match="not a result of vibrafeed"):
            ask()


def test_a_workbook_has_the_rows_of_the_dataset(motion, tmp_path):
    motion.vibrafeed.to_excel(tmp_path / "motion.xlsx")
    book = openpyxl.load_workbook(tmp_path / "motion.xlsx")
    headings, *rows = book["values"].iter_rows(values_only=True)
    assert len(rows) == 4
    speed = headings.index("conveying_velocity [m s-1]")
    assert [row[speed] for row in rows] == motion.conveying_velocity.values.tolist()
    assert [row[headings.index("regime")] for row in rows] == [
        "stick", "stick_slip", "hopping", "hopping",
    ]  # fmt: skip
    study = dict(row[:2] for row in book["study"].iter_rows(values_only=True))
    assert study["study_sha256"] == motion.attrs["study_sha256"]


def test_a_workbook_has_the_name_of_one(motion, tmp_path):
    with pytest.raises(vibrafeed.VibrafeedError, match=r"does not end in \.xlsx"):
        motion.vibrafeed.to_excel(tmp_path / "motion.xls")


def run(code: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_it_comes_with_the_first_dataset(motion, tmp_path):
    """Until then `import vibrafeed` loads no xarray; after that files have it, too."""
    motion.to_netcdf(tmp_path / "motion.nc")
    code = """
import sys, vibrafeed
print("xarray" in sys.modules)
first = vibrafeed.sweep(
    scene="rectangle-on-plane", outputs="throw_number", frequency=50, amplitude="0.1 mm", beta=30
)
print(first.vibrafeed.study.kind)
import xarray
print(xarray.open_dataset("motion.nc").vibrafeed.study.kind)
"""
    assert run(code, tmp_path).split() == ["False", "sweep", "simulate"]


def test_it_is_there_at_once_where_xarray_is(tmp_path):
    code = """
import sys, types
seen = []
xarray = types.ModuleType("xarray")  # a stand-in: the true one takes a second
xarray.Dataset = object
xarray.register_dataset_accessor = lambda name: seen.append(name) or (lambda accessor: accessor)
sys.modules["xarray"] = xarray
import vibrafeed
print(sorted(seen))
"""
    assert run(code, tmp_path) == "['vf', 'vibrafeed']"
