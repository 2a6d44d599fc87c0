"""`dataset.vibrafeed`: what a dataset of vibrafeed can do besides."""

import inspect

import matplotlib.figure
import numpy as np
import openpyxl
import pytest
import xarray

import vibrafeed


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
    speed = motion.conveying_velocity.values
    for units, unit, factor in (("trade", "mm/s", 1000), ((), "m/min", 60), ("si", "m/s", 1)):
        shown = motion.vibrafeed.shown(*([units] if units else []))
        assert shown.conveying_velocity.units == unit
        np.testing.assert_allclose(shown.conveying_velocity, factor * speed, rtol=1e-15)
        xarray.testing.assert_identical(shown.regime.variable, motion.regime.variable)
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
    feed_rate = 60 * motion.conveying_velocity.values / 0.01
    np.testing.assert_allclose(trade.feed_rate, feed_rate, rtol=1e-12)
    assert trade.amplitude.values.tolist() == [0.2, 0.4]
    assert trade.beta == 25
    assert motion.feed_rate.units == "min-1"
    xarray.testing.assert_identical(motion.vf.trade(), trade)  # the short name


def test_it_is_drawn(motion):
    takes = list(inspect.signature(vibrafeed.plot).parameters.values())[1:]
    assert list(inspect.signature(motion.vibrafeed.plot).parameters.values()) == takes
    figure = motion.vibrafeed.plot(axes="amplitude")
    assert isinstance(figure, matplotlib.figure.Figure)


def test_what_is_no_result_is_told_so():
    other = xarray.Dataset({"a": 1})
    for ask in (lambda: other.vibrafeed.study, other.vibrafeed.regime_shares):
        with pytest.raises(vibrafeed.VibrafeedError, match="not a result of vibrafeed"):
            ask()


def test_a_workbook_has_the_rows_of_the_dataset(motion, tmp_path):
    motion.vibrafeed.to_excel(tmp_path / "motion.xlsx")
    book = openpyxl.load_workbook(tmp_path / "motion.xlsx")
    headings, *rows = book["values"].iter_rows(values_only=True)
    columns = dict(zip(headings, zip(*rows, strict=True), strict=True))
    speeds = motion.conveying_velocity.values.tolist()
    assert [*columns["conveying_velocity [m s-1]"]] == speeds
    assert columns["regime"] == ("stick", "stick_slip", "hopping", "hopping")
    with pytest.raises(vibrafeed.VibrafeedError, match=r"does not end in \.xlsx"):
        motion.vibrafeed.to_excel(tmp_path / "motion.xls")
