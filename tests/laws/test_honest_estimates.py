"""Stated errors against better references, over some hundred random studies each.

`python -m benchmarks.honest_estimates` does the same over ten thousand.
"""

import numpy as np
import pytest

from benchmarks.honest_estimates import (
    ESTIMATES,
    by_events,
    judge,
    random_groups,
)
from benchmarks.motions import planar_motion
from night import spread
from vibrafeed.core.motion.method import STATUS

STUDIES = {"spatial": 800, "events": 800, "chaos": 300}


@pytest.mark.parametrize("name", spread(STUDIES, 1))
def test_the_true_error_is_seldom_larger_than_the_stated_one(name: str) -> None:
    for row in ESTIMATES[name][0](STUDIES[name]):
        assert row.judged > 200
        # A share of 1 % of the judged: more than its three standard deviations above is no chance.
        misses = row.exceeded + row.unstated
        assert misses <= 0.01 + 3 * np.sqrt(0.01 / row.judged), row
        assert row.elsewhere or row.worst <= 10, row
        assert row.median > 1e-5, "an estimate that exaggerates that much says nothing"


def test_the_judge_sees_a_dishonest_estimate() -> None:
    groups = random_groups(200, 9)
    exact = by_events(groups)
    good = exact.status == STATUS["periodic"]
    off = exact._replace(velocity=exact.velocity * (1 + 1e-3))
    row = judge("a thousandth off", off, exact.velocity, exact.error, good, 0.0)
    assert row.exceeded > 0.9
    assert row.worst > 1e3
    assert not row.honest


def test_a_slide_that_gains_speed_for_ever_is_no_mean() -> None:
    """Hops at random on a slope that is steeper than kinetic friction: it never stops again."""
    found = planar_motion(
        drive_number_along=np.array(1.4281), drive_number_normal=np.array(2.5282),
        gravity_number_along=np.array(-0.0781), gravity_number_normal=np.array(0.9969),
        friction_static=np.array(0.0844), friction_kinetic=np.array(0.0572),
        restitution=np.array(0.5754), tolerance=np.array(1e-12), max_periods=np.array(1000.0),
    )  # fmt: skip
    assert found.status == STATUS["runaway"]
    assert np.isnan(found.velocity)
