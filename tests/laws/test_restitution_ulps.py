"""What a motion with restitution is called does not hang on the last bits of its parameters."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.restitution_ulps import changes, followed, moved, random_cells
from core.motion.result import STATUS

# 50 Hz, 0.23 mm, restitution 0.9: two motions lie beside each other, and a plain run from rest ends
# in the one or the other from one floating number to the next.
TWO_MOTIONS = (0.02144, 0.03306)
CELL = {
    "frequency": 50.0, "amplitude": 0.23e-3, "beta": np.radians(30.0), "gamma": 0.0,
    "friction_static": 0.3, "friction_kinetic": 0.3, "restitution": 0.9,
}  # fmt: skip


def test_cells_keep_status_and_value_within_3_ulp():
    # Of 10,000 cells one changes (`python -m benchmarks.restitution_ulps`). Before roundings were
    # measured from rest on, and runs told apart, 7 in 100 did.
    found = changes(random_cells(100, 1))
    names = ("periodic", "aperiodic")
    assert all((found.status == STATUS[name]).sum() > 20 for name in names)
    assert not found.of_status.any()
    assert found.of_value.sum() <= 1


@pytest.mark.parametrize("ulps", range(4))
def test_two_motions_that_rounding_decides_between_are_both_within_the_error(ulps):
    cell = {name: np.array([value]) for name, value in CELL.items()}
    cell["amplitude"] = moved(cell["amplitude"], ulps)
    found = followed(cell)
    assert found["motion_status"] == STATUS["sensitive"]
    velocity, error = found["conveying_velocity"], found["conveying_velocity_error"]
    for motion in TWO_MOTIONS:
        assert abs(velocity - motion) <= error
    # Still an answer: no further off than the two motions are from rest.
    assert error < max(TWO_MOTIONS)
