"""The mean that is told is that of the part's own course, whatever the status.

On the track under a sine by many cells of each sort; in every scene and under every form of drive what
repeats does so again, and what does not repeat does not.
"""  # noqa: E501

from functools import cache

import numpy as np
import pytest

from benchmarks import waves as drives
from benchmarks.every_status import FAMILIES, Judged, course_of, judged
from night import count, spread
from vibrafeed.core.motion.events import (
    motion_by_events,
)
from vibrafeed.core.motion.kernels.constants import COLUMN
from vibrafeed.core.motion.kernels.inputs import Cell
from vibrafeed.core.motion.method import STATUS, Groups, cells_of
from vibrafeed.core.motion.systems import CONTACTS
from vibrafeed.core.motion.waves import Wave, bound

CELLS = count(12, 17_000)
"""Of each of the six families: 10^5 by night."""
pytestmark = pytest.mark.timeout(1800 + CELLS // 2)  # a cell takes some 30 ms of a processor
MOST, PERIODS = 1000, 3000
"""Periods that the method may follow a part for, and those of its course."""
ODDS, CHANCE = 1e-3, 0.05
"""Share of the cells in which a bound may be exceeded, and a statistical error at 99 %.

Chaos may give way to a cycle after the periods that are followed: hence more than one in 100.
"""
AT_LEAST = 2
"""Cells of one status by chance, of few."""


@cache
def of(family: str) -> Judged:
    """Return the cells of a family, judged."""
    pick = np.random.default_rng([20261123, list(FAMILIES).index(family)])
    return judged(FAMILIES[family](pick, CELLS), max_periods=MOST, periods=PERIODS)


@pytest.mark.parametrize("family", spread(FAMILIES, 2))
def test_a_bound_holds_the_mean_of_the_course(family):
    found = of(family)
    told = ~np.isin(found.status, [STATUS["aperiodic"], STATUS["limit_reached"]])
    assert np.isfinite(found.course[told]).all()
    wrong = told & (found.off > 0.0)
    assert wrong.sum() <= ODDS * told.sum(), np.flatnonzero(wrong)


def test_a_statistical_error_holds_the_mean_of_the_course_and_is_of_use():
    """A hundredth of the drive's speed, and not a fifth of it. What is aperiodic does not repeat.

    Nor in three times as long, but where chaos gives way to a cycle.
    """
    every = [of(family) for family in FAMILIES]
    off, status, multiple, speed = (
        np.concatenate([getattr(f, n) for f in every])
        for n in ("off", "status", "multiple", "speed")
    )
    stated = np.concatenate([f.table[:, COLUMN.error] for f in every])
    chaos = status == STATUS["aperiodic"]
    known = chaos & np.isfinite(off)
    assert known.sum() >= 0.05 * len(off)
    assert np.count_nonzero(off[known] > 0.0) <= max(AT_LEAST, CHANCE * known.sum())
    assert np.median((stated / speed)[chaos]) < 0.01
    assert np.count_nonzero(multiple[chaos] > 0) <= max(AT_LEAST, CHANCE * len(off))


# --- every scene, every form of drive

EVERYWHERE = count(16, 4_000)
"""Of each scene and form."""
HAIRS = (0.0, 1e-12, 2e-12, 3e-12)
"""Of the restitution: where digits decide, courses with so much less of it part."""
RESTITUTIONS = [Cell._fields.index(name) for name in ("restitution", "wall_restitution")]
"""Columns of a row."""


def driven(scene: str, form: str) -> Groups:
    """Return random parts of a scene, a third with rebounds; on the plane half move in space."""
    pick = np.random.default_rng([28, len(scene), len(form)])
    wall, every_other = CONTACTS[scene].wall, np.arange(EVERYWHERE) % 2
    across = 0.3 if wall else 0.3 * every_other
    if form == "sine":
        groups = drives.feeder_parts(EVERYWHERE, int(pick.integers(10**6)), across)
        rebounds = pick.uniform(0.0, 0.7, EVERYWHERE) * (pick.random(EVERYWHERE) < 0.3)
        groups = groups._replace(restitution=rebounds)
    else:
        wave = getattr(drives, form)(pick, EVERYWHERE, 3)
        harmonics, steps = wave.harmonics.copy(), wave.steps.copy()
        harmonics[1], steps[1] = across * harmonics[0, ::-1], across * steps[2]
        groups = drives.parts(pick, Wave(harmonics, steps))
        groups = groups._replace(drive_number_across=bound(groups.wave, 1))
    if not wall:
        return groups._replace(gravity_number_across=0.0)
    return groups._replace(
        gravity_number_across=0.1, wall_friction=groups.friction_kinetic,
        wall_restitution=groups.restitution, curvature_number=0.01 * every_other,
    )  # fmt: skip


@pytest.mark.parametrize("form", ["sine", "harmonics", "steps"])
@pytest.mark.parametrize("scene", sorted(CONTACTS))
def test_what_repeats_does_so_again_and_what_does_not_does_not(scene, form):
    groups, contacts = driven(scene, form), CONTACTS[scene]
    settings = {"tolerance": 1e-12, "max_periods": float(MOST)}
    found, (rows, _) = motion_by_events(groups, contacts, **settings), cells_of(groups, **settings)
    periodic, restless = (
        np.flatnonzero(found.status == STATUS[name]) for name in ("periodic", "aperiodic")
    )
    assert periodic.size > 0.5 * EVERYWHERE
    slow, wrong = 0, []
    for cell in periodic:
        mean, unknown, multiple = course_of(rows[cell], PERIODS, contacts)
        right = abs(mean - found.velocity[cell]) <= found.error[cell] + unknown
        if multiple == 0:  # closed forms find a cycle that a part reaches later
            slow += 1
        elif multiple != found.multiple[cell] or not right:
            wrong.append(cell)
    assert slow <= max(AT_LEAST, 0.02 * periodic.size)
    assert len(wrong) <= ODDS * periodic.size, wrong
    repeating = 0
    for cell in restless:
        multiples = set()
        for hair in HAIRS if rows[cell][RESTITUTIONS].any() else HAIRS[:1]:
            near = rows[cell].copy()
            near[RESTITUTIONS] *= 1.0 - hair
            multiples.add(course_of(near, PERIODS, contacts)[2])
        repeating += len(multiples) == 1 and min(multiples) > 0
    assert repeating <= max(AT_LEAST, CHANCE * restless.size)
