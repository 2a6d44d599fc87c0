"""The errors that planar events state, where they are hard to state.

The velocities were computed to 20 digits by another program (tests/data/README.md).
"""

import json
import math
from pathlib import Path

import pytest

from vibrafeed.core.motion.events import planar_motion
from vibrafeed.core.motion.method import Groups

FOUND = json.loads((Path(__file__).parents[2] / "data" / "planar_digits.json").read_text())


def followed(family):
    """Return every part of a family with its motion, its velocity and the size of the drive."""
    for one in FOUND:
        if one["family"] == family:
            c, s, *_, static, _ = one["groups"]
            motion = planar_motion(Groups(*one["groups"]), tolerance=1e-12, max_periods=1000.0)
            yield motion, float(one["velocity"]), math.hypot(c, s), (c, s, static)


@pytest.mark.parametrize("family", ["any", "throw", "friction", "slip"])
def test_the_stated_error_holds(family):
    parts = [*followed(family)]
    assert len(parts) >= 6
    for motion, velocity, _, _ in parts:
        assert abs(float(motion.velocity) - velocity) <= float(motion.error)


@pytest.mark.parametrize("family", ["any", "throw", "friction"])
def test_it_is_not_larger_than_a_thousand_roundings_of_the_drive(family):
    # It was 5e-3 just above throw number 1, and 2e-5 at friction 1e8.
    for motion, _, drive, _ in followed(family):
        assert float(motion.error) <= 1000 * 2.0**-52 * drive * 2 * math.pi


def test_near_the_threshold_of_slip_it_grows_as_the_phase_gets_unsure():
    for motion, _, _, (c, s, static) in followed("slip"):
        over = c / (static * (1 - s)) - 1  # the drive over what friction at rest holds
        unsure = 2.0**-52 / math.sqrt(over)  # of the phase where the slip starts
        assert float(motion.error) <= 2e-13 + 10 * unsure
