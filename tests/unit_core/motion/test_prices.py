"""Prices follow what costs: settings, hops, space, the drive, how long a part tumbles."""

import numpy as np
import pytest

from benchmarks.prices import measured
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.systems import SYSTEMS

HOPS = {"frequency": 50, "amplitude": "2.1 mm", "beta": 41, "friction": 0.4, "restitution": 0.6}
SLIDES = {"frequency": 50, "amplitude": "0.1 mm", "beta": 30, "friction": 0.3}
PIN = {
    "length": "20 mm", "height": "12 mm", "drop_height": "10 mm", "pitch": 60, "friction": 0.3,
    "restitution": 0.2, "duration": 1,
}  # fmt: skip
SHAKEN = {**PIN, "frequency": 50, "amplitude": "1 mm", "beta": 60}
METHODS = ("events", "reference")


def study(method="events", scene="rectangle-on-plane", parameters=HOPS, **settings):
    outputs = ["motion_status"]
    content = {"kind": "simulate", "scene": scene, "method": method, "outputs": outputs}
    return content | {"parameters": parameters} | settings


def price(*given, **changed):
    prepared = prepare_content(study(*given, **changed))
    assert 0 < prepared.seconds <= prepared.most_seconds < np.inf
    return prepared.seconds


@pytest.mark.parametrize("method", METHODS)
def test_they_grow_with_the_periods_of_a_motion_that_seldom_repeats(method):
    few, many = (price(method, max_periods=n) for n in (500, 20_000))
    assert 5 * few < many < 100 * few


@pytest.mark.parametrize("method", METHODS)
def test_a_motion_that_repeats_does_not_cost_what_is_allowed(method):
    few, many = (price(method, parameters=SLIDES, max_periods=n) for n in (500, 20_000))
    assert many < 2 * few
    prepared = [
        prepare_content(study(method, parameters=SLIDES, max_periods=n)) for n in (100, 20_000)
    ]
    few, many = (one.most_seconds for one in prepared)
    assert many > 5 * few


def test_they_grow_with_the_time_that_a_part_is_shaken():
    short, long = (
        price("events", "rectangle-isolated", {**SHAKEN, "duration": n}) for n in (1, 1000)
    )
    assert long == pytest.approx(1000 * short)
    still = price("events", "rectangle-isolated", {**PIN, "duration": 1000})
    assert still < long / 100  # it comes to rest


def test_they_follow_the_numbers_of_the_cells_and_not_what_is_given():
    """An angle of 0, or a restitution of a part that never leaves the floor, costs nothing."""
    plain = price(parameters=SLIDES)
    assert price(parameters={**SLIDES, "restitution": 0.8, "alpha": 0}) == plain
    assert price(parameters={**SLIDES, "alpha": 10}) > 10 * plain
    mixed = {**SLIDES, "alpha": {"start": 0, "stop": 10, "num": 21}}
    assert plain < price(parameters=mixed) / 21


def test_the_study_that_took_hours_is_no_small_one():
    assert price("reference", max_periods=100_000) > 5
    content = {
        "kind": "optimise", "scene": "rectangle-on-plane", "parameters": {**HOPS},
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": 10, "upper": 60}},
    }  # fmt: skip
    del content["parameters"]["beta"]
    prepared = prepare_content(content)
    assert prepared.seconds <= prepared.most_seconds


def test_usual_studies_stay_small():
    assert price("events") < 0.1
    assert price("events", parameters=SLIDES) < 0.1
    wide = {**SLIDES, "friction": {"start": 0.1, "stop": 0.9, "num": 1000}}
    assert price("events", parameters=wide) < 1


def test_they_cost_little_themselves():
    """A study of any size is priced by a few of its cells."""
    axis = {"start": 0.1, "stop": 0.9, "num": 100_000}
    huge = prepare_content(study(parameters={**SLIDES, "friction": axis, "restitution": axis}))
    assert huge.cells == 10**10
    assert huge.seconds > 10**10 * 1e-7


def test_the_work_grows_as_the_price_does():
    """Measured, with room for a machine that does much else and is another one."""
    said, took = [], []
    measured(study("reference", max_periods=8))  # loads what it needs
    for periods in (20, 2000):
        content = study("reference", max_periods=periods)
        found = measured(content)
        said.append(found.said)
        took.append(found.took)
    assert took[1] > took[0]
    assert said[1] > said[0]
    grew = (said[1] / said[0]) / (took[1] / took[0])
    assert 1 / 20 < grew < 20


# Of round parts the slip is a motion of its own, with numbers of its own.
ROUND = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3, "diameter": "8 mm"}
VARIANTS = [
    (scene, method)
    for scene in ("roller-on-plane", "sphere-on-plane")
    for method in SYSTEMS[scene].variants
]


@pytest.mark.parametrize(("scene", "method"), VARIANTS)
def test_the_slip_of_a_round_part_has_a_price_without_its_motion(scene, method):
    for name in ("slip_velocity", "backward_fraction", "conveying_velocity"):
        assert price(method, scene, ROUND, outputs=[name]) > 0
