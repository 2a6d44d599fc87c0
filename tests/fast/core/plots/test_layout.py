"""Every kind of picture, in both styles and sizes: no text meets another or leaves the figure."""

from pathlib import Path

import numpy as np
import pytest
import xarray

import vibrafeed
from layout import boxes, judge
from night import spread
from vibrafeed.core.plots.pictures import PlotError

CONFIGS = Path(__file__).parents[4] / "configs"
SMALL = {"dark": True, "small": True}
NAME = "How the acceleration of a part depends on the angles of a drive and its frequency"


def span(start: object, stop: object, num: int) -> dict[str, object]:
    return {"start": start, "stop": stop, "num": num}


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    return vibrafeed.sweep(
        scene="rectangle-on-plane", outputs=["acceleration_x", "throw_number"], title=NAME,
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


LINES = {"kind": "line", "axes": ("beta", "frequency")}
THROW = {"variable": "throw_number", "axes": ("beta", "frequency")}
FAMILY = {"kind": "line", "axes": ("amplitude", "beta")}
PERIODS = {"variable": "period_multiple"}
CLOSED = [{**SMALL}, {"kind": "map"}, {"kind": "levels"}, {"kind": "line"}, LINES, THROW]
MOTION = [{}, {"kind": "map", **SMALL}, FAMILY, PERIODS, {**PERIODS, "kind": "line"}]


@pytest.mark.parametrize("asked", spread(CLOSED, 3), ids=str)
def test_closed_forms(plane, asked):
    judge(vibrafeed.plot(plane, **asked))


@pytest.mark.parametrize("asked", spread(MOTION, 3), ids=str)
def test_motion(motion, asked):
    judge(vibrafeed.plot(motion, **asked))


def test_a_long_title_takes_two_lines(plane):
    figure = vibrafeed.plot(plane, title="A title of many words " * 12, small=True)
    assert figure.get_suptitle().count("\n") == 1
    assert figure.get_suptitle().endswith("…")
    judge(figure)


def test_optima():
    chosen = {"scene": "rectangle-on-plane", "frequency": "60 Hz", "friction": [0.3, 0.5]}
    best = vibrafeed.optimise(
        **chosen, criterion={"kind": "maximise"}, amplitude=span("0.1 mm", "0.2 mm", 5)
    )
    judge(vibrafeed.plot(best, kind="landscape", **SMALL))
    pareto = {"kind": "pareto", "points": 20}
    judge(vibrafeed.plot(vibrafeed.optimise(**chosen, criterion=pareto, amplitude="0.1 mm")))


def test_what_is_uncertain():
    told = vibrafeed.sensitivity(
        scene="rectangle-on-plane", outputs=["acceleration_x", "throw_number"], frequency=50,
        beta=20, gamma=[0, 2], samples=256, analyses=["distribution", "sobol", "budget"],
        uncertain={"amplitude": {"mean": "0.1 mm", "deviation": "1 um"},
                   "friction": {"lower": 0.2, "most_likely": 0.3, "upper": 0.35}},
        demands=[{"output": "acceleration_x", "at_least": 1.5, "at_most": 3}],
    )  # fmt: skip
    for kind, name in ((None, "Distribution"), ("indices", "Where"), ("tornado", "Effect")):
        figure = vibrafeed.plot(told, kind=kind, at={"gamma": 0})
        assert figure.get_suptitle().startswith(name)
        judge(figure)
    judge(vibrafeed.plot(told, variable="acceleration_x_mean", axes=("gamma",)))
    without = told.drop_vars("acceleration_x_total")
    for dataset, asked in (
        (without, {"kind": "indices"}),
        (told, {"kind": "tornado", "variable": "speed"}),
        (told.drop_attrs(), {"kind": "indices"}),
    ):
        with pytest.raises(PlotError):
            vibrafeed.plot(dataset, **asked)


def test_a_sentence_where_no_value_is_finite(motion):
    nothing = motion.copy(deep=True)
    nothing["conveying_velocity"][:] = np.nan
    for kind in ("contour", "line"):
        figure = vibrafeed.plot(nothing, kind=kind)
        said = [text.get_text() for text, _ in boxes(figure)]
        assert "Conveying velocity:\nno value here is finite." in said
        judge(figure)
