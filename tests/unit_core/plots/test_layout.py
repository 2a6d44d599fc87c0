"""Every kind of picture, in both styles and sizes: no text meets another or leaves the figure."""

from __future__ import annotations

import pathlib
from itertools import combinations

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox

import vibrafeed
from core.plots.regimes import ON_FILL
from pictures import subtitle

LOOKS = ({}, {"dark": True, "small": True})
MEET = 1.0  # dots
ROOT = pathlib.Path(__file__).parents[3]


def span(start: object, stop: object, num: int) -> dict[str, object]:
    return {"start": start, "stop": stop, "num": num}


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    return vibrafeed.sweep(
        scene="rectangle-on-plane",
        outputs=["acceleration_x", "throw_number"],
        title="How the acceleration of a part depends on the angles of a drive and its frequency",
        frequency=span(20, 60, 9), amplitude="0.2 mm", friction=0.5,
        alpha=span(-45, 45, 19), beta=span(0, 60, 13),
    )  # fmt: skip


@pytest.fixture(scope="module")
def motion() -> xarray.Dataset:
    return vibrafeed.simulate(
        scene="rectangle-on-plane", outputs=["conveying_velocity", "period_multiple"],
        frequency=50, amplitude=span("0.05 mm", "0.75 mm", 15), beta=span(5, 60, 12),
        friction=0.4, gamma=2,
    )  # fmt: skip


@pytest.fixture(scope="module")
def best() -> xarray.Dataset:
    return vibrafeed.optimise(
        scene="rectangle-on-plane", criterion={"kind": "maximise"}, frequency="60 Hz",
        amplitude=span("0.1 mm", "0.2 mm", 9), friction=[0.2, 0.4, 0.6],
    )  # fmt: skip


@pytest.fixture(scope="module")
def course() -> xarray.Dataset:
    return vibrafeed.simulate(ROOT / "configs" / "tumbling-course.toml", trajectory=200)


@pytest.fixture(scope="module")
def hop() -> xarray.Dataset:
    return vibrafeed.simulate(ROOT / "configs" / "trajectory.toml", trajectory=200)


def boxes(figure: Figure) -> list[tuple[Text, Bbox]]:
    """Return the texts that a picture shows, and where: of an axis those of ticks in sight."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    found = [text for text in figure.findobj(Text, include_self=False) if text.get_visible()]
    # To ask an axis for its ticks moves those of a surface.
    places = [(text, text.get_window_extent(renderer)) for text in found if text.get_text().strip()]
    ticks, drawn = set(), set()
    for axes in figure.findobj(Axes):
        for axis in axes._axis_map.values():
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                ticks |= {tick.label1, tick.label2}
            if axis.get_visible():
                drawn |= {tick.label1 for tick in axis._update_ticks()}
    return [place for place in places if place[0] not in ticks - drawn]


def area(text: Text, box: Bbox) -> Path:
    """Return the outline of a text, a turned one in its own directions."""
    turn = text.get_rotation()
    text.set_rotation(0)
    level = text.get_window_extent()
    text.set_rotation(turn)
    half = np.array([level.width, level.height]) / 2 - MEET
    corners = half * [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]
    middle = [(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2]
    return Affine2D().rotate_deg(turn).translate(*middle).transform_path(Path(corners, closed=True))


def contrast(one: object, other: object) -> float:
    def luminance(colour: object) -> float:
        rgb = np.array(to_rgb(np.atleast_2d(colour)[0] if np.ndim(colour) > 1 else colour))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def judge(figure: Figure) -> None:
    """Fail where texts meet, leave the figure, or cannot be told from what lies below."""
    found = boxes(figure)
    frame = figure.bbox
    for text, box in found:
        across, up = (
            frame.x0 <= box.x0 < box.x1 <= frame.x1,
            frame.y0 <= box.y0 < box.y1 <= frame.y1,
        )
        assert (across, up) == (True, True), f"{text.get_text()!r} leaves the figure"
        if str(text.get_color()) != ON_FILL:
            assert contrast(text.get_color(), figure.get_facecolor()) > 4.5, text.get_text()
    areas = [(text.get_text(), area(text, box)) for text, box in found]
    for (one, mine), (other, its) in combinations(areas, 2):
        assert not mine.intersects_path(its), f"{one!r} meets {other!r}"
    assert len(subtitle(figure).split("\n")) <= 2


@pytest.mark.parametrize("look", LOOKS, ids=["light", "small and dark"])
@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"kind": "surface"},
        {"kind": "map"},
        {"kind": "line"},
        {"kind": "line", "axes": ("beta", "frequency")},
        {"variable": "throw_number", "axes": ("beta", "frequency")},
    ],
    ids=str,
)
def test_closed_forms(plane: xarray.Dataset, asked: dict[str, object], look: dict[str, bool]):
    judge(vibrafeed.plot(plane, **asked, **look))


@pytest.mark.parametrize("look", LOOKS, ids=["light", "small and dark"])
@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"kind": "surface"},
        {"kind": "map"},
        {"kind": "line", "axes": ("amplitude", "beta")},
        {"variable": "period_multiple"},
        {"variable": "period_multiple", "kind": "line"},
    ],
    ids=str,
)
def test_motion(motion: xarray.Dataset, asked: dict[str, object], look: dict[str, bool]):
    judge(vibrafeed.plot(motion, **asked, **look))


@pytest.mark.parametrize("look", LOOKS, ids=["light", "small and dark"])
def test_one_part_and_optima(
    hop: xarray.Dataset, course: xarray.Dataset, best: xarray.Dataset, look: dict[str, bool]
):
    for dataset, kind in ((hop, None), (course, None), (best, None), (best, "landscape")):
        judge(vibrafeed.plot(dataset, kind=kind, **look))
    fronts = vibrafeed.optimise(
        scene="rectangle-on-plane", criterion={"kind": "pareto", "points": 20},
        frequency="60 Hz", amplitude="0.1 mm", friction=[0.3, 0.5],
    )  # fmt: skip
    judge(vibrafeed.plot(fronts, **look))


@pytest.mark.parametrize("look", LOOKS, ids=["light", "small and dark"])
def test_a_sentence_where_no_value_is_finite(motion: xarray.Dataset, look: dict[str, bool]):
    nothing = motion.copy(deep=True)
    nothing["conveying_velocity"][:] = np.nan
    for kind in ("contour", "surface", "line"):
        figure = vibrafeed.plot(nothing, kind=kind, **look)
        said = [text.get_text() for text, _ in boxes(figure)]
        assert "Conveying velocity:\nno value here is finite." in said
        judge(figure)


def test_a_long_title_takes_two_lines(plane: xarray.Dataset):
    figure = vibrafeed.plot(plane, title="A title of many words " * 12, small=True)
    assert figure.get_suptitle().count("\n") == 1
    assert figure.get_suptitle().endswith("…")
    judge(figure)
