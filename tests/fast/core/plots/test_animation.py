"""The motion of a part as an animation."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image

import vibrafeed
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.plots.animation import COLOURS, draw_frames
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.film import FRAMES_PER_SECOND, amplitude_of, read_film
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import Style, mix
from vibrafeed.core.study.shown import ShownUnits

ROOT = Path(__file__).parents[4]
UNITS = ShownUnits()


@pytest.fixture(scope="module")
def hop() -> xarray.Dataset:
    return vibrafeed.simulate(ROOT / "configs" / "trajectory.toml", trajectory=200)


@pytest.fixture(scope="module")
def fall() -> xarray.Dataset:
    return vibrafeed.simulate(ROOT / "configs" / "tumbling-course.toml")


def test_a_frame_shows_where_track_and_part_are(hop: xarray.Dataset):
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


def test_cycles_follow_each_other_and_the_part_goes_on(hop: xarray.Dataset):
    film = read_film(hop, UNITS)
    cycles = round(film.times.size / FRAMES_PER_SECOND)
    assert cycles > 1
    assert f"cycle shown {cycles} times" in film.notes
    ride = film.part[0] - film.track[0]
    assert ride[FRAMES_PER_SECOND] - ride[0] == pytest.approx(
        1000 * float(hop.conveying_velocity) / 50, rel=1e-6
    )
    part_of_it = hop.isel(cycle_time=slice(0, 120))
    assert not any("cycle" in note for note in read_film(part_of_it, UNITS).notes)


def test_a_tumbling_part_turns_at_its_size_until_it_rests(fall: xarray.Dataset):
    film = read_film(fall, UNITS)
    assert np.ptp(film.outline[0]) == pytest.approx(20)
    assert np.ptp(film.outline[1]) == pytest.approx(8)
    assert np.rad2deg(film.pitch[[0, -1]]) == pytest.approx([60, 0], abs=0.1)
    assert film.times[-1] == pytest.approx(1.15 * float(fall.settling_time))
    assert list(dict.fromkeys(film.modes)) == ["flight", "corner", "side"]


def test_the_part_has_the_colour_of_what_it_does(hop: xarray.Dataset):
    film = read_film(hop, UNITS, slow=10)
    style = Style()
    for mode, frame in itertools.islice(
        zip(film.modes, draw_frames(film, style, 60), strict=True), 5
    ):
        wanted = mix(COLOURS[mode], style.ground, 0.25) if mode in COLOURS else (1.0, 1.0, 1.0)
        near = np.abs(frame / 255 - np.array(wanted)).max(axis=-1) < 0.01
        assert near[60:170].sum() > 500, mode


@pytest.mark.parametrize("look", [{}, {"dark": True, "small": True}])
def test_a_gif_runs_for_ever_as_slow_as_asked(
    hop: xarray.Dataset, tmp_path: Path, look: dict[str, bool]
):
    target = tmp_path / "part.gif"
    vibrafeed.animate(hop, target, slow=20, **look)
    with Image.open(target) as picture:
        assert picture.n_frames == read_film(hop, UNITS, 20).times.size
        assert picture.info["duration"] == 1000 // FRAMES_PER_SECOND
        assert picture.info["loop"] == 0
    assert target.stat().st_size < 400_000


def test_wrong_requests(hop: xarray.Dataset, tmp_path: Path):
    hop.to_netcdf(tmp_path / "hop.nc")

    def told(target: str = "part.gif", **asked: object) -> str:
        with pytest.raises(VibrafeedError) as caught:
            draw_file(tmp_path / "hop.nc", [tmp_path / target], **asked)
        return str(caught.value)

    assert "'.png': unknown animation format" in told("part.png", kind="animation")
    assert "only an animation has a slow-motion factor" in told("part.png", slow=5)
    assert "a map does not move" in told(kind="map")
    assert "'-1' is not above 0" in told(slow=-1)
    assert "at most 1,000 are drawn. Give a smaller slow-motion factor" in told(slow=1e5)
    assert "shows the whole trajectory" in told(variable="position_along")
    with pytest.raises(PlotError, match=r"vibrafeed\.animate"):
        draw(hop, kind="animation")
    with pytest.raises(PlotError, match="has no trajectory"):
        vibrafeed.animate(hop.isel(cycle_time=0, drop=True), tmp_path / "part.gif")


@pytest.mark.parametrize(("gamma", "says"), [(2.0, "climbs by 2"), (-3.0, "falls by 3")])
def test_a_track_that_is_not_level_is_said_to_be_so(hop: xarray.Dataset, gamma, says):
    tilted = hop.assign(gamma=hop["gamma"] * 0 + gamma)
    assert any(says in note for note in read_film(tilted, UNITS).notes)
    assert not any("seen along" in note for note in read_film(hop, UNITS).notes)


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
