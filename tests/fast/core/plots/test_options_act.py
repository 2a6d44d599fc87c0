"""Each option of a picture changes it, or is refused with a sentence: none does nothing."""

import contextlib
import io
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
import xarray
from matplotlib.figure import Figure

import vibrafeed
from night import spread
from surfaces import box
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.pictures import PICTURES, PlotError

ROOT = Path(__file__).parents[4]
SWEPT = {
    "scene": "rectangle-on-plane", "outputs": ["acceleration_x", "throw_number"],
    "frequency": 50, "amplitude": {"start": "0.05 mm", "stop": "0.1 mm", "num": 4},
    "beta": {"start": 10, "stop": 40, "num": 8}, "friction": [0.2, 0.3, 0.4],
}  # fmt: skip
CHOSEN = {"scene": "rectangle-on-plane", "frequency": 60, "friction": [0.3, 0.5]}


UNCERTAIN = {
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x", "throw_number"],
    "frequency": 50,
    "beta": 20,
    "gamma": [0, 2],
    "samples": 256,
    "analyses": ["distribution", "sobol", "budget"],
    "uncertain": {
        "amplitude": {"mean": "0.1 mm", "deviation": "1 um"},
        "friction": {"lower": 0.2, "upper": 0.35},
    },
}
COURSE = {
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "trajectory": 40,
    "frequency": 50,
    "amplitude": "0.2 mm",
    "beta": 25,
    "friction": 0.3,
}
MEASURED = {
    "scene": "rectangle-on-plane",
    "frequency": 50,
    "discrepancy": False,
    "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
    "observations": [
        {"amplitude": "0.2 mm", "beta": 25, "conveying_velocity": "50 mm/s", "error": "2 mm/s"},
        {"amplitude": "0.3 mm", "beta": 25, "conveying_velocity": "90 mm/s", "error": "2 mm/s"},
    ],
}
PARETO = {"variant": "thesis", "criterion": {"kind": "pareto", "points": 12}}
CARRY_OUT: Mapping[str, Callable[[], xarray.Dataset]] = {
    "sweep": partial(vibrafeed.sweep, **SWEPT),
    "impact": partial(vibrafeed.sweep, ROOT / "configs" / "impact-rectangles.toml"),
    "optimum": partial(vibrafeed.optimise, **CHOSEN, criterion={"kind": "maximise"},
                       amplitude=["0.1 mm", "0.15 mm"]),
    "front": partial(vibrafeed.optimise, **CHOSEN, **PARETO, amplitude=["0.05 mm", "0.1 mm"]),
    "uncertain": partial(vibrafeed.sensitivity, **UNCERTAIN),
    "row": partial(vibrafeed.simulate, ROOT / "configs" / "row.toml", trajectory=40),
    "course": partial(vibrafeed.simulate, **COURSE),
    "plate": partial(
        vibrafeed.simulate, scene="part-on-plate", outputs=["velocity_x", "velocity_y"],
        frequency=50, friction=[0.2, 0.3], amplitude_along_1="0.1 mm",
        amplitude_across_1="0.1 mm", phase_across_1=-90, amplitude_tilt_y_1="0.03 deg",
        position_x=[-0.1, 0, 0.1], position_y=[-0.05, 0.05],
    ),
    "part": partial(vibrafeed.sweep, scene="resting-part", part=box(30, 20, 10),
                    outputs=["thrown_share"]),
    "calibration": partial(vibrafeed.calibrate, **MEASURED),
}  # fmt: skip
"""A small result of each sort that some picture needs."""


@cache
def result(sort: str) -> xarray.Dataset:
    return CARRY_OUT[sort]()


OF = {
    "posterior": "calibration",
    **dict.fromkeys(("distribution", "indices", "tornado"), "uncertain"),
    **dict.fromkeys(("line", "map", "contour", "levels"), "sweep"),
    "front": "front", "positions": "row", "trajectory": "course", "animation": "course",
    "landscape": "optimum", "bodies": "impact", "aspects": "part",
    "field": "plate",
}  # fmt: skip
AT = {
    "sweep": {"amplitude": 0.00005}, "impact": {"friction": 0.3},
    "optimum": {"amplitude": 0.0001}, "front": {"amplitude": 0.00005}, "uncertain": {"gamma": 0},
    "row": {"friction": 0.3}, "course": {"friction": 0.3}, "calibration": {"frequency": 50},
    "part": {"aspect": 2}, "plate": {"friction": 0.2},
}  # fmt: skip
OPTIONS: Mapping[str, Any] = {
    "variable": {"variable": "throw_number"},
    "axes": {"axes": ("friction",)},
    "two axes": {"axes": ("friction", "beta")},
    "nearest": {"nearest": True},
    "title": {"title": "Another name"},
    "units": {"units": ["m", "m/min", "mm/s^2", "rad"]},
    "dark": {"dark": True},
    "small": {"small": True},
}


ALIKE = ("posterior", "units")
"""Stays as it is: the unknown is a friction, which has no unit."""
CASES = [(kind, option) for kind in PICTURES for option in (*OPTIONS, "at")]


def seen(figure: Figure) -> bytes:
    picture = io.BytesIO()
    figure.savefig(picture, format="raw", dpi=60)
    return picture.getvalue()


@cache
def plain(kind: str) -> bytes:
    return seen(draw(result(OF[kind]), kind=kind))


def test_every_kind_is_asked():
    assert OF.keys() == PICTURES.keys()


@pytest.mark.parametrize(("kind", "option"), [*spread(CASES, 16), ALIKE])
def test_an_option_changes_the_picture_or_is_refused(kind: str, option: str):
    dataset = result(OF[kind])
    asked = {"at": AT[OF[kind]]} if option == "at" else OPTIONS[option]
    changed = True
    with contextlib.suppress(PlotError):
        changed = seen(draw(dataset, kind=kind, **asked)) != plain(kind)
    assert changed == ((kind, option) != ALIKE)


def test_a_front_is_drawn_at_the_value_asked_for():
    fronts = result("front")
    whole = draw(fronts)
    assert len(whole.axes[0].lines) == 2 * 4  # each with its knee
    held = draw(fronts, at={"amplitude": 0.00005})
    assert len(held.axes[0].lines) == 2 * 2
    labels = {text.get_text() for text in held.legends[0].get_texts()}
    assert {"friction 0.3", "friction 0.5"} < labels
    nearest = draw(fronts, at={"amplitude": 0.00004}, nearest=True)
    assert seen(nearest) == seen(held)
    with pytest.raises(PlotError, match=r"0\.04 mm is not a value of the axis amplitude"):
        draw(fronts, at={"amplitude": 0.00004})
    with pytest.raises(PlotError, match="front is an axis of this picture"):
        draw(fronts, at={"front": 0.0})
    # An output that is asked for is drawn, in place of the front.
    named = draw(fronts, variable="best_alpha")
    assert named.axes[0].get_xlabel() == "Place on the front"


def test_what_a_picture_leaves_out_is_said():
    fronts = vibrafeed.optimise(
        scene="rectangle-on-plane", variant="thesis", frequency=60, amplitude="0.05 mm",
        criterion={"kind": "pareto", "points": 5},
        friction={"start": 0.2, "stop": 0.5, "num": 9},
    )  # fmt: skip
    assert draw(fronts).legends[0].get_title().get_text() == "7 of 9 designs"
