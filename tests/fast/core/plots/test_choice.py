"""What is drawn if nothing is asked for, and in which words and units."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes

import vibrafeed
from pictures import SPACE, legend, problem, subtitle
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.looks import categories_of

ROOT = pathlib.Path(__file__).parents[4]


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    """Slip and flight."""
    return vibrafeed.sweep(
        scene="rectangle-on-plane", outputs=["acceleration_x", "throw_number"],
        frequency=[40, 50, 60], amplitude="0.2 mm", friction=0.5,
        alpha={"start": -45, "stop": 45, "num": 10}, beta={"start": 0, "stop": 60, "num": 13},
    )  # fmt: skip


@pytest.fixture(scope="module")
def motion() -> xarray.Dataset:
    return vibrafeed.simulate(
        scene="rectangle-on-plane", outputs=["conveying_velocity", "period_multiple"],
        frequency=50, amplitude={"start": "0.1 mm", "stop": "0.7 mm", "num": 13},
        beta={"start": 10, "stop": 60, "num": 11}, friction=0.4, gamma=2, units=["m/min"],
    )  # fmt: skip


def hatches(axes: Axes) -> set[str]:
    areas = [getattr(area, "hatches", None) or [] for area in axes.collections]
    return {hatch for area in areas for hatch in area if hatch}


# --- what is exact


def test_an_output_that_is_exact_in_every_regime_is_not_hatched(plane: xarray.Dataset):
    doubtful = draw(plane, axes=("alpha", "beta"))
    assert "///" in hatches(doubtful.axes[0])
    assert "closed forms do not describe" in doubtful.legends[-1].get_title().get_text()
    exact = draw(plane, variable="throw_number", axes=("frequency", "beta"), kind="contour")
    assert "///" not in hatches(exact.axes[0])
    assert not exact.legends[-1].get_title().get_text()
    assert legend(exact) == ["slip", "flight"]


def test_lift_off_is_marked_where_the_throw_number_is_one(plane: xarray.Dataset):
    axes = draw(plane, variable="throw_number", axes=("beta",), at={"frequency": 60}).axes[0]
    assert "1: lift-off" in [text.get_text() for text in axes.texts]
    assert any(np.allclose(line.get_ydata(), 1.0) for line in axes.lines)
    low = draw(plane.isel(beta=slice(3)), variable="throw_number", axes=("beta",)).axes[0]
    assert not low.texts


# --- few values, and words


def test_few_values_of_an_axis_make_curves(plane: xarray.Dataset):
    figure = draw(plane, variable="throw_number")
    curves, _ = figure.legends
    names = [text.get_text().replace(SPACE, " ") for text in curves.get_texts()]
    assert names == ["60 Hz", "50 Hz", "40 Hz"]
    assert figure.axes[0].get_xlabel().startswith("Drive elevation")
    assert len(draw(plane, variable="throw_number", kind="contour").axes) == 2  # a colour bar


def test_numbers_that_stand_for_words_are_a_map_with_these_words(motion: xarray.Dataset):
    figure = draw(motion, variable="period_multiple")
    assert figure.get_suptitle() == "Period multiple"
    names = {entry.rsplit(", ", 1)[0] for entry in legend(figure)}
    assert names == {"repeats every period", "repeats every 2 periods"}
    shares = [entry.rsplit(", ", 1)[1] for entry in legend(figure)]
    assert sum(float(share.removesuffix(" %")) for share in shares) == pytest.approx(100, abs=0.2)
    assert not figure.axes[0].lines
    assert len(figure.axes) == 1  # no colour bar
    row = draw(motion, variable="period_multiple", kind="line", axes=("amplitude",))
    assert not row.axes[0].get_yticks().size
    found = problem(motion, variable="period_multiple", kind="contour")
    assert found.message == "period_multiple has a name in each cell, not a number"


def test_words_of_flags_and_of_what_has_no_value():
    flags = {"flag_values": np.int8([0, 8]), "flag_meanings": "not_computed settled"}
    status = xarray.DataArray(np.int8([8, 0]), name="motion_status", attrs=flags)
    assert categories_of(status) == {0: "not computed", 8: "settled"}
    side = xarray.DataArray([1.0, np.nan, 4.0], name="resting_side")
    assert categories_of(side) == {
        -1: "no value", 1: "the side at pitch 0°", 4: "the side at pitch 270°",
    }  # fmt: skip
    assert categories_of(xarray.DataArray([1.0], name="friction")) is None
    many = xarray.DataArray(np.arange(20.0), name="period_multiple")
    assert categories_of(many) is None


# --- a part that tumbles


def test_the_course_of_a_tumbling_part():
    dataset = vibrafeed.simulate(ROOT / "configs" / "tumbling-course.toml", trajectory=100)
    figure = draw(dataset)
    side, gaps, turns = figure.axes
    assert "rests on the side at pitch 0° after 0.177 s" in subtitle(figure)
    first, last = (patch.get_xy() for patch in side.patches if patch.get_zorder() == 4)
    # 20 by 8 mm, dropped with its lowest corner 10 mm above the plane, pitched by 60 degrees.
    assert first[:, 1].min() == pytest.approx(10.0)
    assert np.ptp(first[:, 1]) == pytest.approx(20 * np.sin(np.pi / 3) + 8 * np.cos(np.pi / 3))
    assert np.ptp(last[:, 0]) == pytest.approx(20.0, rel=1e-3)
    assert last[:, 1].min() == pytest.approx(0.0, abs=1e-3)
    assert gaps.lines[0].get_ydata()[0] == pytest.approx(10.0)
    assert turns.lines[0].get_ydata()[0] == pytest.approx(60.0)
    assert gaps.get_ylabel() == "Lowest corner\n(mm)"
    assert problem(dataset.drop_vars("path_pitch")).message == "its motion has no path_pitch"


# --- how it is asked for


def test_units_are_those_of_the_study_or_asked_for(motion: xarray.Dataset):
    def unit(**asked: object) -> str:
        return draw(motion, kind="line", axes=("amplitude",), **asked).axes[0].get_ylabel()

    assert unit() == "$v$ (m/min)"
    assert unit(units="trade") == "$v$ (mm/s)"
    assert unit(units=["si"]) == "$v$ (m/s)"
    axes = draw(motion, kind="line", axes=("amplitude",), units="m/min").axes[0]
    shown = motion["conveying_velocity"].isel(beta=5).values * 60
    curves = [np.asarray(line.get_ydata()) for line in axes.lines if len(line.get_ydata()) == 13]
    for curve in curves:
        np.testing.assert_allclose(curve, np.where(np.isfinite(curve), shown, np.nan))
    assert np.isfinite(curves).any(axis=0).all()
    found = problem(motion, units="kelvin")
    assert (found.place, found.message) == (
        "units",
        "'kelvin' is not a unit that vibrafeed knows",
    )


def test_the_nearest_value_is_taken_where_that_is_asked_for(plane: xarray.Dataset):
    figure = draw(plane, axes=("beta",), at={"frequency": 57, "alpha": 0}, nearest=True)
    assert "frequency 60 Hz" in subtitle(figure)
    assert problem(plane, at={"frequency": 57}).place == "at.frequency"
    assert problem(plane, at={"frequency": np.nan}, nearest=True).place == "at.frequency"


def test_a_title_and_what_is_fixed_in_two_lines(plane: xarray.Dataset):
    figure = draw(plane, axes=("beta",), title="Mine", small=True)
    assert figure.get_suptitle() == "Mine"
    facts, source = subtitle(figure).splitlines()
    assert facts.startswith("frequency 50 Hz · alpha")
    assert facts.endswith(" more")
    assert source.endswith("(rectangle-on-plane …")


def test_numbers_in_names_are_told_from_values():
    dataset = vibrafeed.sweep(ROOT / "configs" / "impact-rectangles.toml")
    figure = draw(dataset)
    assert "restitution 0.6 · position x₁ 5 mm · position y₁ 20.9641 mm" in subtitle(figure)
    assert figure.axes[1].get_ylabel() == "Normal impulse (mN s)"
