"""The motion of a part, and of a row of parts, as an animation."""

from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image

import vibrafeed
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.plots.animation import COLOURS, draw_frames, draw_lane
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.film import FRAMES_PER_SECOND, PALE, amplitude_of, read_film, read_row
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import Style, mix
from vibrafeed.core.study.shown import ShownUnits

CONFIGS = Path(__file__).parents[4] / "configs"
UNITS = ShownUnits()


@pytest.fixture(scope="module")
def hop() -> xarray.Dataset:
    return vibrafeed.simulate(CONFIGS / "trajectory.toml", trajectory=200)


@pytest.fixture(scope="module")
def row() -> xarray.Dataset:
    return vibrafeed.simulate(CONFIGS / "row.toml")


def test_a_frame_shows_where_track_and_part_are(hop):
    film = read_film(hop, UNITS, slow=50)
    assert film.times.size % FRAMES_PER_SECOND == 0  # a period of 20 ms takes a second
    track = 0.25 * np.sin(100 * np.pi * film.times)
    np.testing.assert_allclose(film.track[0], track * np.cos(np.pi / 6), atol=1e-3)
    np.testing.assert_allclose(film.track[1], track * np.sin(np.pi / 6), atol=1e-3)
    gap = film.part[1] - film.track[1] + film.outline[1].min()
    assert gap.min() == pytest.approx(0.0, abs=1e-12)
    # The hop is 0.0247 mm high: too little to be seen, so it is drawn larger, and that is said.
    assert gap.max() == pytest.approx(2 * 1000 * float(hop.hop_height), rel=0.02)
    assert "gap 2 times as large" in film.notes
    flying = np.array(film.modes) == "flight"
    assert (gap[flying].max() > 0) & (gap[~flying].max() < 1e-9)


def test_cycles_follow_each_other_and_the_part_goes_on(hop):
    film = read_film(hop, UNITS)
    cycles = round(film.times.size / FRAMES_PER_SECOND)
    assert cycles > 1
    assert f"cycle shown {cycles} times" in film.notes
    ride = film.part[0] - film.track[0]
    a_cycle = 1000 * float(hop.conveying_velocity) / 50
    assert ride[FRAMES_PER_SECOND] - ride[0] == pytest.approx(a_cycle, rel=1e-6)
    part_of_it = hop.isel(cycle_time=slice(0, 120))
    assert not any("cycle" in note for note in read_film(part_of_it, UNITS).notes)
    assert not any("seen along" in note for note in film.notes)
    for gamma, says in ((2.0, "climbs by 2"), (-3.0, "falls by 3")):
        tilted = hop.assign(gamma=hop["gamma"] * 0 + gamma)
        assert any(says in note for note in read_film(tilted, UNITS).notes)


def test_a_tumbling_part_turns_at_its_size_until_it_rests():
    fall = vibrafeed.simulate(CONFIGS / "tumbling-course.toml")
    film = read_film(fall, UNITS)
    assert np.ptp(film.outline, axis=1) == pytest.approx([20, 8])
    assert np.rad2deg(film.pitch[[0, -1]]) == pytest.approx([60, 0], abs=0.1)
    assert film.times[-1] == pytest.approx(1.15 * float(fall.settling_time))
    assert list(dict.fromkeys(film.modes)) == ["flight", "corner", "side"]


def test_a_gif_runs_for_ever_as_slow_as_asked(hop, row, tmp_path):
    target = tmp_path / "part.gif"
    vibrafeed.animate(hop, target, slow=10, dark=True, small=True)
    film = read_film(hop, UNITS, 10)
    style = Style(dark=True, small=True)
    frame = next(draw_frames(film, style, 60)) / 255
    wanted = mix(COLOURS[film.modes[0]], style.ground, 0.25)  # the colour of what it does
    assert (np.abs(frame - np.array(wanted)).max(axis=-1) < 0.01).sum() > 500
    # Of the second half of a period, the strip shows a slip from 15 to 51 % of its width.
    frame = next(draw_frames(read_film(hop.isel(cycle_time=slice(100, 201)), UNITS), style, 60))
    forward = np.array(mix(COLOURS["forward"], style.ground, 0.25))
    columns = np.flatnonzero((np.abs(frame / 255 - forward).max(axis=-1) < 0.01).any(axis=0))
    assert columns[[0, -1]] == pytest.approx([35, 108], abs=3)
    with Image.open(target) as picture:
        assert picture.n_frames == film.times.size
        assert picture.info["duration"] == 1000 // FRAMES_PER_SECOND
        assert picture.info["loop"] == 0
    assert target.stat().st_size < 400_000
    vibrafeed.animate(row, target, slow=2)
    with Image.open(target) as picture:
        assert picture.n_frames == 10  # ten periods of 20 ms, twice as slow, 25 a second


def test_wrong_requests(hop, row, tmp_path):
    hop.to_netcdf(tmp_path / "hop.nc")
    for target, asked, told in (
        ("part.png", {"kind": "animation"}, "'.png': unknown animation format"),
        ("part.png", {"slow": 5}, "only an animation has a slow-motion factor"),
        ("part.gif", {"kind": "map"}, "a picture of kind map cannot be"),
        ("part.gif", {"slow": -1}, "'-1' is not above 0"),
        ("part.gif", {"slow": 1e5}, "at most 1,000 are drawn. Give a smaller slow-motion factor"),
        ("part.gif", {"variable": "position_along"}, "shows the whole trajectory"),
    ):
        with pytest.raises(VibrafeedError) as caught:
            draw_file(tmp_path / "hop.nc", [tmp_path / target], **asked)
        assert told in str(caught.value)
    with pytest.raises(PlotError, match=r"vibrafeed\.animate"):
        draw(hop, kind="animation")
    with pytest.raises(PlotError, match="has no trajectory"):
        vibrafeed.animate(hop.isel(cycle_time=0, drop=True), tmp_path / "part.gif")
    with pytest.raises(PlotError, match="the length of the parts"):
        vibrafeed.animate(row.drop_vars("length"), tmp_path / "row.gif")


@pytest.mark.parametrize(
    "told",
    [
        {"amplitude": 2e-4},
        {"peak_to_peak": 4e-4, "beta": 30.0},
        {"vertical_amplitude": 1e-4, "beta": 30.0},
        {"vertical_peak_to_peak": 2e-4, "beta": 30.0},
    ],
)
def test_the_track_moves_by_its_amplitude_however_that_is_given(told):
    assert amplitude_of(xarray.Dataset(coords=told)) == pytest.approx(2e-4)
    assert amplitude_of(xarray.Dataset(coords={"beta": 30.0})) is None


def test_a_picture_of_a_row_shows_the_places_and_the_contacts(row):
    course = read_row(row, UNITS)
    assert course.centres.shape == (4, 401)
    gaps = np.diff(course.centres, axis=0) - 12.0
    assert gaps[:, 0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert course.closed[:, 0].tolist() == [True, False, True]
    assert gaps.min() > -1e-9
    assert gaps[course.closed].max() < 1e-6 < gaps[~course.closed].min()
    axes = draw(row).axes[0]
    for line, place in zip(axes.lines, course.centres, strict=True):
        np.testing.assert_allclose(line.get_ydata(), place)
    shaded = [sum(path.vertices.shape[0] > 2 for path in one.get_paths())
              for one in axes.collections]  # fmt: skip
    assert [bool(count) for count in shaded] == course.closed.any(axis=1).tolist()


def test_an_animation_of_a_row_fills_parts_that_touch(row):
    style = Style()
    first, *_, last = draw_lane(row, UNITS, style, 50, slow=2)
    pale = np.round(255 * np.array(mix(style.ground, style.curve, PALE)))
    first, last = (np.abs(frame[: len(frame) // 2] - pale).max(axis=-1) for frame in (first, last))
    assert (first <= 2).sum() > 1000
    assert (last <= 2).sum() < 100
