"""Every kind of picture, in both styles and sizes: no text meets another or leaves the figure."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest
import xarray

import vibrafeed
from layout import boxes, judge
from night import spread
from vibrafeed.core.plots.pictures import PlotError

LOOKS = ({}, {"dark": True, "small": True})
ROOT = pathlib.Path(__file__).parents[4]


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


@pytest.mark.parametrize("look", spread(LOOKS, 1))
@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"kind": "map"},
        {"kind": "levels"},
        {"kind": "line"},
        {"kind": "line", "axes": ("beta", "frequency")},
        {"variable": "throw_number", "axes": ("beta", "frequency")},
    ],
    ids=str,
)
def test_closed_forms(plane: xarray.Dataset, asked: dict[str, object], look: dict[str, bool]):
    judge(vibrafeed.plot(plane, **asked, **look))


@pytest.mark.by_day(3)
@pytest.mark.parametrize("look", spread(LOOKS, 1))
@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"kind": "map"},
        {"kind": "line", "axes": ("amplitude", "beta")},
        {"variable": "period_multiple"},
        {"variable": "period_multiple", "kind": "line"},
        {"kind": "levels"},
    ],
    ids=str,
)
def test_motion(motion: xarray.Dataset, asked: dict[str, object], look: dict[str, bool]):
    judge(vibrafeed.plot(motion, **asked, **look))


@pytest.mark.parametrize("look", spread(LOOKS, 1))
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
    impact = vibrafeed.sweep(ROOT / "configs" / "impact-rectangles.toml")
    judge(vibrafeed.plot(impact, kind="bodies", **look))


@pytest.mark.parametrize("look", spread(LOOKS, 1))
def test_what_is_uncertain(look: dict[str, bool]):
    told = vibrafeed.sensitivity(
        scene="rectangle-on-plane", outputs=["acceleration_x", "throw_number"], frequency=50,
        beta=20, gamma=[0, 2], samples=256,
        analyses=["distribution", "sobol", "budget"],
        uncertain={"amplitude": {"mean": "0.1 mm", "deviation": "1 um"},
                   "friction": {"lower": 0.2, "most_likely": 0.3, "upper": 0.35}},
        demands=[{"output": "acceleration_x", "at_least": 1.5, "at_most": 3}],
    )  # fmt: skip
    for kind, name in (
        (None, "Distribution of the acceleration along the track"),
        ("indices", "Where the variance of the"),
        ("tornado", "What each tolerance does to the"),
    ):
        figure = vibrafeed.plot(told, kind=kind, at={"gamma": 0}, **look)
        assert name.split()[0] in figure.get_suptitle()
        judge(figure)
    lines = vibrafeed.plot(told, variable="acceleration_x_mean", axes=("gamma",), **look)
    judge(lines)
    without = told.drop_vars("acceleration_x_total")
    for dataset, asked in (
        (without, {"kind": "indices"}),
        (told, {"kind": "tornado", "variable": "speed"}),
        (told.drop_attrs(), {"kind": "indices"}),
    ):
        with pytest.raises(PlotError):
            vibrafeed.plot(dataset, **asked, **look)


@pytest.mark.parametrize("look", spread(LOOKS, 1))
def test_a_sentence_where_no_value_is_finite(motion: xarray.Dataset, look: dict[str, bool]):
    nothing = motion.copy(deep=True)
    nothing["conveying_velocity"][:] = np.nan
    for kind in ("contour", "line"):
        figure = vibrafeed.plot(nothing, kind=kind, **look)
        said = [text.get_text() for text, _ in boxes(figure)]
        assert "Conveying velocity:\nno value here is finite." in said
        judge(figure)


def test_a_long_title_takes_two_lines(plane: xarray.Dataset):
    figure = vibrafeed.plot(plane, title="A title of many words " * 12, small=True)
    assert figure.get_suptitle().count("\n") == 1
    assert figure.get_suptitle().endswith("…")
    judge(figure)
