"""A row of parts over time, as a picture and as an animation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image

import vibrafeed
from vibrafeed.core.plots.animation import draw_lane
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.film import PALE, read_row
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import Style, mix
from vibrafeed.core.study.shown import ShownUnits

ROOT = Path(__file__).parents[4]
UNITS = ShownUnits()


@pytest.fixture(scope="module")
def row() -> xarray.Dataset:
    return vibrafeed.simulate(ROOT / "configs" / "row.toml")


def test_the_course_of_a_row_knows_which_parts_touch(row: xarray.Dataset):
    course = read_row(row, UNITS)
    assert course.centres.shape == (4, 401)
    assert course.length == 12.0
    gaps = np.diff(course.centres, axis=0) - 12.0
    assert gaps[:, 0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert course.closed[:, 0].tolist() == [True, False, True]
    assert gaps.min() > -1e-9
    assert gaps[course.closed].max() < 1e-6 < gaps[~course.closed].min()


def test_a_picture_shows_the_places_and_the_contacts(row: xarray.Dataset):
    axes = draw(row).axes[0]
    course = read_row(row, UNITS)
    for line, place in zip(axes.lines, course.centres, strict=True):
        np.testing.assert_allclose(line.get_ydata(), place)
    assert len(axes.collections) == 3  # one shade a contact
    shaded = [sum(path.vertices.shape[0] > 2 for path in one.get_paths())
              for one in axes.collections]  # fmt: skip
    assert [bool(count) for count in shaded] == course.closed.any(axis=1).tolist()


def test_an_animation_fills_parts_that_touch(row: xarray.Dataset):
    style = Style()
    first, *_, last = draw_lane(row, UNITS, style, 50, slow=5)
    pale = np.round(255 * np.array(mix(style.ground, style.curve, PALE)))
    upper = first.shape[0] // 2

    def filled(frame: np.ndarray) -> int:
        return int((np.abs(frame[:upper].astype(float) - pale).max(axis=-1) <= 2).sum())

    assert filled(first) > 1000
    assert filled(last) < 100


def test_an_animation_of_a_row_is_a_file(row: xarray.Dataset, tmp_path: Path):
    target = tmp_path / "row.gif"
    vibrafeed.animate(row, target, slow=2)
    with Image.open(target) as picture:
        assert picture.n_frames == 10  # ten periods of 20 ms, twice as slow, 25 a second


def test_parts_of_no_length_are_not_animated(row: xarray.Dataset, tmp_path: Path):
    with pytest.raises(PlotError, match="the length of the parts"):
        vibrafeed.animate(row.drop_vars("length"), tmp_path / "row.gif")
