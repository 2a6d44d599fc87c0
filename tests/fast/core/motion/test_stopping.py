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


def quick(name):
    """Return a study that compiles the same code, and is short."""
    scene, parameters, settings = ENDLESS[name]
    if scene.endswith("isolated"):
        return prepared(name, parameters={**parameters, "duration": 0.05})
    return prepared(name, **dict.fromkeys(settings, 8))


@pytest.mark.parametrize("name", ENDLESS)
def test_a_deadline_ends_a_cell(name):
    tabulate(quick(name), watch=Watch(deadline=time.monotonic() + 600))  # compiles
    table = tabulate(prepared(name), watch=Watch(deadline=time.monotonic() + DEADLINE))
    assert table.variables["motion_status"].values == NOT_COMPUTED
    for output in set(table.variables) & {"drift_velocity", "conveying_velocity"}:
        assert np.isnan(table.variables[output].values)


@pytest.mark.parametrize("name", ["events in space", "events tumbling"])
def test_a_course_ends_too(name):
    tabulate(prepared(name, trajectory=10, **dict.fromkeys(ENDLESS[name][2], 8))
             if "space" in name else quick(name))  # fmt: skip
    deadline = time.monotonic() + DEADLINE
    table = tabulate(prepared(name, trajectory=10), watch=Watch(deadline=deadline))
    assert table.variables["motion_status"].values == NOT_COMPUTED


def test_cells_that_were_done_before_the_stop_are_kept():
    name = "events in space"
    mixed = {**ENDLESS[name][1], "amplitude": ["0.01 mm", "2.1 mm"]}  # the first rests
    whole = prepared(name, parameters=mixed)
    table = tabulate(whole, watch=Watch(deadline=time.monotonic() + DEADLINE, threads=1))
    assert table.variables["motion_status"].values.tolist() == [
        MOTION_STATUSES["at_rest"].value, NOT_COMPUTED,
    ]  # fmt: skip
    assert table.variables["conveying_velocity"].values[0] == 0


def test_a_stop_that_is_asked_for_ends_a_cell_as_a_deadline_does():
    tabulate(quick("events tumbling"))
    looks = iter((False, False, True))
    watch = Watch(stop=lambda: next(looks, True))
    table = tabulate(prepared("events tumbling"), watch=watch)
    assert next(looks, None) is None  # it was asked until it said so
    assert table.variables["motion_status"].values == NOT_COMPUTED


def test_a_stop_that_fails_is_told():
    def fails() -> bool:
        raise OSError("the disk is gone")

    with pytest.raises(OSError, match="the disk is gone"):
        tabulate(quick("events tumbling"), watch=Watch(stop=fails))


def test_without_a_stop_nothing_looks():
    with Watch().flag() as flag:
        assert not flag
    with Watch(deadline=time.monotonic()).flag() as flag:
        assert wait_for(lambda: bool(flag))
