"""A course of a part of our own making, in the form of public recordings, and its prediction."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from benchmarks.tracked_courses import FITTED, GRAVITY, MASS, position_error, predicted, read_course

RATE, KINETIC, FORCE = 960, FITTED[0], 7.0
"""Frames a second; the friction and the force over the weight that the part truly has."""
IMPACTS = {
    "frequency": 40, "acceleration_along_1": 50.0, "duration_1": 4, "acceleration_along_2": -160.0,
    "duration_2": 1, "duration_3": 1,
}  # fmt: skip


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """An upright surface that lifts a part, as a camera tracks both: in mm, with noise."""
    times = np.arange(121) / RATE
    moved = vibrafeed.simulate(
        scene="rectangle-on-plane", **IMPACTS, burst_periods=6, outputs=["burst_displacement"],
        trajectory=times.tolist(), gamma=90, gravity=GRAVITY, mass=MASS, friction_static=0.72,
        friction_kinetic=KINETIC, hold_down_force=FORCE * MASS * GRAVITY,
    )  # fmt: skip
    noise = np.random.default_rng(60).normal(0, 5e-4, (2, times.size))
    surface, part = 1e3 * np.array([moved.track_along, moved.track_along + moved.position_along])
    surface, part = np.array([surface, part]) + noise
    speeds = np.gradient(surface, times).astype(str)
    speeds[[0, -1]] = "\N{REPLACEMENT CHARACTER}"  # as their table has it
    lines = [
        f"{time:.8f},{at:.8f},{speed},{other:.8f}"
        for time, at, speed, other in zip(times, surface, speeds, part, strict=True)
    ]
    path = tmp_path_factory.mktemp("courses") / "Trial #1.csv"
    path.write_text("\n".join(["t,zp,vzp,zo", *lines]), "utf-8")
    return read_course(path)


def test_a_course_is_predicted_with_the_friction_and_force_of_its_run(course):
    largest = np.abs(course.part).max()
    assert largest > 1e-3
    assert position_error(course, predicted(course, KINETIC, FORCE)) < 0.1 * largest


def test_with_the_friction_of_a_table_it_is_not(course):
    largest = np.abs(course.part).max()
    assert position_error(course, predicted(course, 0.3, FORCE)) > 0.2 * largest
