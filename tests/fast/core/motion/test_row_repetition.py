"""How the motion of a row ends: a drift has no mean, a cycle is the shortest one."""

import numpy as np
import pytest

import vibrafeed
from night import count
from rows import TURN, cell, followed, path
from vibrafeed.core.motion.kernels.rows.contact import count_closing
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, row_at

OUTPUTS = ["conveying_velocity", "conveying_velocity_error", "platoons", "period_multiple"]
DRIVE = {"frequency": 50, "amplitude": "0.8 mm", "beta": 3.5}


def row_of_frictions(*friction, **more):
    """Return the study of a row of slippery parts with these frictions, from the rear on."""
    own = {f"part_friction_{n}": mu for n, mu in enumerate(friction, 1)}
    return vibrafeed.simulate(scene="row-on-plane", outputs=OUTPUTS, **own, **{**DRIVE, **more})


# --- a drift has no mean


@pytest.mark.parametrize(
    ("friction", "right"),
    [((0.01, 0.02), 0.508), ((0.03, 0.05), 1.355), ((0.01, 0.02, 0.04), 0.790)],
)
def test_a_row_of_slippery_parts_that_leave_each_other_moves_as_its_parts_do(friction, right):
    """Right: the mean of the velocities of the parts alone [mm/s]."""
    found = row_of_frictions(*friction)
    alone = vibrafeed.simulate(
        scene="rectangle-on-plane", outputs=OUTPUTS[:1], friction=list(friction), **DRIVE
    ).conveying_velocity.values.mean()
    assert alone * 1e3 == pytest.approx(right, abs=5e-4)
    assert (found.motion_status, found.period_multiple) == (1, 1)
    assert found.platoons == len(friction)
    error = float(found.conveying_velocity_error)
    assert abs(float(found.conveying_velocity) - alone) <= error < 1e-8 * alone * 1e3


def test_a_drift_in_too_few_periods_to_tell_one_has_no_mean():
    found = row_of_frictions(0.01, 0.02, max_periods=20)
    assert found.motion_status == 6
    assert all(np.isnan(found[output].values) for output in OUTPUTS)


def test_no_row_has_a_mean_that_later_periods_contradict():
    random, seen = np.random.default_rng(3), set()
    for _ in range(count(12, 100)):
        n = int(random.integers(2, 5))
        row = cell(
            random.uniform(3, 10), random.uniform(0.1, 0.95), random.uniform(0.005, 0.05, n),
            mass=random.uniform(0.2, 3.0, n), e=random.choice([0.0, 0.5]),
        )  # fmt: skip
        found, name = followed(row)
        seen.add(name)
        if name == "limit_reached":
            continue
        row[5] = 8000
        later, of_later = followed(row)
        if of_later != "limit_reached":
            apart = abs(found["velocity"] - later["velocity"])
            assert apart <= found["error"] + later["error"]
    assert {"limit_reached", "periodic"} <= seen


@pytest.mark.parametrize("gap", [300.0, 1e5, 1e9])
def test_parts_that_approach_each_other_slowly_have_the_mean_of_those_that_touch(gap):
    """Rear and front alone have .958 and .589: the gap closes after some 130 periods."""
    found, name = followed(cell(3.0, 0.9, [0.5, 0.3], gap=[gap]))
    assert (name, found["multiple"], found["platoons"]) == ("periodic", 2, 1)
    assert found["velocity"] == pytest.approx(0.821698729434, abs=1e-10)  # of those that touch


@pytest.mark.parametrize("stop", ["fixed_stop_gap", "track_stop_gap"])
def test_a_row_far_from_its_stop_presses_on_it_in_the_end(stop):
    near, far = (
        vibrafeed.simulate(
            scene="row-on-plane", outputs=["stop_force", "conveying_velocity"], frequency=50,
            amplitude="0.2 mm", beta=20, part_friction_1=0.4, part_friction_2=0.3, mass="4 g",
            **{stop: gap},
        )
        for gap in ("0 mm", "5 m")
    )  # fmt: skip
    assert near.motion_status == far.motion_status == 1
    for output in ("stop_force", "conveying_velocity"):
        assert float(far[output]) == pytest.approx(float(near[output]), rel=1e-9, abs=1e-12)


def test_a_drift_behind_a_part_that_wanders_is_seen():
    """The rear pair does not repeat; the part in front still loses its first speed."""
    wild = cell(5.0, 0.69, [0.65, 0.13, 1e-4], mass=[0.78, 1.68, 1.0], gap=[0.0, 1e4])
    assert followed(wild)[1] == "limit_reached"


# --- the shortest cycle


def true_multiple(row, periods=1500):
    """Return after how many periods the distances of a row's parts repeat, to 1e-9, at last."""
    places, _ = path(row, TURN * np.arange(periods + 1))
    moved = np.diff(places, axis=0)
    scale = np.abs(moved).max()
    for multiple in range(1, 13):
        if np.abs(moved[-36:] - moved[-36 - multiple : -multiple]).max() < 1e-9 * scale:
            return multiple
    return 0


def test_rows_that_alternate_while_they_settle_repeat_in_the_end_after_one_period():
    """Rebounds by 0.9 or 0.6 turn the difference of two velocities round every period."""
    random, seen = np.random.default_rng(17), []
    for _ in range(count(20, 300)):
        n = int(random.integers(2, 5))
        row = cell(
            random.uniform(0.5, 6.0), random.uniform(0.5, 3.0), random.uniform(0.1, 0.8, n),
            mass=random.uniform(0.3, 3.0, n), e=random.choice([0.6, 0.9]),
        )  # fmt: skip
        found, name = followed(row)
        if name == "periodic":
            seen.append(true_multiple(row))
            assert found["multiple"] == seen[-1] or seen[-1] == 0
    assert seen.count(1) > 3


def test_cycles_of_two_and_five_periods_stay_what_they_are():
    found, _ = followed(cell(3.0, 0.9, [0.5, 0.3]))
    assert found["multiple"] == true_multiple(cell(3.0, 0.9, [0.5, 0.3])) == 2
    # A light part that a heavy one pushes: the heavy one repeats every period, the light one not.
    push = 2e-4 * (TURN * 50) ** 2 / 9.80665
    along, normal = push * np.cos(np.radians(20)), push * np.sin(np.radians(20))
    light = cell(along, normal, [0.5, 0.3], mass=[1e9, 1e-12])
    assert followed(light)[0]["multiple"] == true_multiple(light) == 5


# --- collisions


def test_collisions_are_the_contacts_that_close():
    row = row_at(cell(1, 0, [0.3] * 4, gap=[0.0, 0.0, 1.0], stop=IN_SPACE, stop_gap=2.0), 0.0)
    row.closed[:] = 0, 1, 0, 0
    row.speed[:] = 2.0, 1.0, 1.0, 0.0, 0.0
    assert count_closing(row, 0, 1e-12) == 1  # two that touch at one velocity are struck once
    row.gap[:] = 0.0, 0.0, 0.0, 0.0
    assert count_closing(row, 0, 1e-12) == 2  # two close at once; the last meets no faster stop
    row.speed[-1] = -1.0
    assert count_closing(row, 0, 1e-12) == 3
    row.speed[:] = 1.0 + 1e-15, 1.0, 1.0, 1.0, 1.0
    assert count_closing(row, 0, 1e-12) == 0  # rounding
