"""A watch stops every method amid a cell, and that cell is as one that was not begun."""

import time

import numpy as np
import pytest

from vibrafeed.core.intake import study_of
from vibrafeed.core.kinds import KINDS, tabulate
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.watch import Watch
from waiting import wait_for

NOT_COMPUTED = MOTION_STATUSES["not_computed"].value
DEADLINE = 0.2  # s; these cells take hours, so that a test that ends at all has been stopped

HOPS = {"frequency": 50, "amplitude": "2.1 mm", "beta": 41, "friction": 0.4, "restitution": 0.6}
CURVE = {**HOPS, "alpha": 5, "delta": 5, "radius": 0.3}
WAVE = {
    "frequency": 50, "friction": 0.4, "restitution": 0.6, "amplitude_normal_1": "1.4 mm",
    "amplitude_along_1": "1.5 mm", "amplitude_along_9": "10 um", "amplitude_normal_7": "10 um",
}  # fmt: skip
PIN = {
    "length": "20 mm", "height": "12 mm", "drop_height": "10 mm", "pitch": 60, "friction": 0.3,
    "restitution": 0.4, "frequency": 50, "amplitude": "1 mm", "beta": 30,
}  # fmt: skip
ENDLESS = {
    "events": ("rectangle-on-plane", WAVE, {"max_periods": 1_000_000}),
    "events in space": ("rectangle-on-track", CURVE, {"max_periods": 1_000_000}),
    "reference": ("rectangle-on-plane", HOPS, {"max_periods": 1_000_000}),
    "events tumbling": ("rectangle-isolated", {**PIN, "duration": 10_000}, {}),
}  # fmt: skip
"""Of each method a study of one cell that takes long: scene, parameters, settings."""


def prepared(name, **changed):
    scene, parameters, settings = ENDLESS[name]
    content = {
        "kind": "simulate", "scene": scene, "method": name.split()[0],
        "outputs": ["drift_velocity" if scene.endswith("isolated") else "conveying_velocity"],
        "parameters": parameters, **changed,
    }  # fmt: skip
    # Longer than a study may ask for: no machine is to be through before the deadline.
    longer = {key: value for key, value in settings.items() if key not in changed}
    return KINDS["simulate"].prepare(study_of(content).model_copy(update=longer))


@pytest.mark.parametrize("name", ENDLESS)
def test_a_deadline_ends_a_cell(name):
    table = tabulate(prepared(name), watch=Watch(deadline=time.monotonic() + DEADLINE))
    assert table.variables["motion_status"].values == NOT_COMPUTED
    for output in set(table.variables) & {"drift_velocity", "conveying_velocity"}:
        assert np.isnan(table.variables[output].values)


@pytest.mark.parametrize("name", ["events in space", "events tumbling"])
def test_a_course_ends_too(name):
    watch = Watch(deadline=time.monotonic() + DEADLINE)
    table = tabulate(prepared(name, trajectory=10), watch=watch)
    assert table.variables["motion_status"].values == NOT_COMPUTED


def test_a_stop_that_is_asked_for_ends_a_cell_as_a_deadline_does():
    looks = iter((False, False, True))
    watch = Watch(stop=lambda: next(looks, True))
    table = tabulate(prepared("events tumbling"), watch=watch)
    assert next(looks, None) is None  # it was asked until it said so
    assert table.variables["motion_status"].values == NOT_COMPUTED


def test_a_stop_that_fails_is_told():
    def fails() -> bool:
        raise OSError("the disk is gone")

    with pytest.raises(OSError, match="the disk is gone"):
        tabulate(prepared("events tumbling"), watch=Watch(stop=fails))


def test_without_a_stop_nothing_looks():
    with Watch().flag() as flag:
        assert not flag
    with Watch(deadline=time.monotonic()).flag() as flag:
        assert wait_for(lambda: bool(flag))
