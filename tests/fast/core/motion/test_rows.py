"""Rows of parts: isotonic contact by scipy, time stepping, and what studies of them say."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

import vibrafeed
from night import count
from rows import TURN, cell
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.kernels.rows import path_of_row
from vibrafeed.core.motion.kernels.rows.contact import collide, pooled, start
from vibrafeed.core.motion.kernels.rows.row_state import row_at
from vibrafeed.core.quantities import REGIMES

ROOT = Path(__file__).parents[4]


# --- another method: isotonic regression by scipy


def test_contact_is_isotonic_regression():
    random = np.random.default_rng(1)
    for _ in range(count(300, 5000)):
        n = int(random.integers(2, 9))
        row = row_at(cell(1, 0, random.uniform(0.1, 0.9, n), mass=random.uniform(0.2, 3.0, n)), 0.0)
        row.value[:] = random.normal(size=n)
        found = isotonic_regression(row.value.copy(), weights=row.mass)
        blocks = pooled(row, 0, n)
        assert row.value == pytest.approx(found.x, abs=1e-14)
        assert blocks == len(found.blocks) - 1


def test_starts_obey_friction_and_push_only():
    random = np.random.default_rng(2)
    for _ in range(count(300, 5000)):
        n = int(random.integers(2, 9))
        static = random.uniform(0.1, 0.9, n)
        row = row_at(cell(1, 0, static, mass=random.uniform(0.2, 3.0, n)), 0.0)
        push, load = random.uniform(-1.0, 1.0), random.uniform(0.2, 1.5)
        start(row, push, load, -1)
        way = np.sign(push)
        moves = row.mode != 0
        assert (row.mode[moves] == way).all()
        # Movers are the front under a push forward, the rear under one backward.
        order = moves if way > 0 else moves[::-1]
        assert (np.diff(order.astype(int)) >= 0).all()
        alone = way * push - static * load
        rear_first = slice(None) if way > 0 else slice(None, None, -1)
        pooled_alone = isotonic_regression(
            alone[rear_first], weights=row.mass[rear_first]
        ).x[rear_first]  # fmt: skip
        assert (moves == (pooled_alone > 1e-13)).all()


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_collisions_keep_momentum_and_gain_no_energy(restitution):
    random = np.random.default_rng(3)
    for _ in range(count(200, 3000)):
        n = int(random.integers(2, 8))
        row = row_at(cell(1, 0, [0.3] * n, mass=random.uniform(0.2, 3.0, n)), 0.0)
        row.speed[:] = random.normal(size=n)
        hit = int(np.argmin(np.diff(row.speed)))
        before = row.speed.copy()
        if np.diff(before)[hit] >= 0:
            continue
        lost, _ = collide(row, hit, restitution)
        assert row.mass @ row.speed == pytest.approx(row.mass @ before, abs=1e-13)
        energy = (row.mass @ before**2 - row.mass @ row.speed**2) / 2
        assert energy == pytest.approx(lost, abs=1e-13)
        assert lost >= 0.0
        # Parts that met part, at least by the restitution; none overlaps.
        apart, met = np.diff(row.speed), np.diff(before)
        assert (apart >= -restitution * met - 1e-12)[met < 0].all()


# --- another method: time stepping


def stepped(px, pz, friction, mass, periods, steps):
    """Return places at the ends of periods, by Moreau's stepping with isotonic contact.

    Each step minimises sum m (u - v)^2/2 + mu m n h |u| under the order of touching parts.
    """
    mu, m, h = np.array(friction), np.array(mass), TURN / steps
    x, u, height, rate, places = np.zeros(len(mu)), np.zeros(len(mu)), 0.0, 0.0, []
    for k in range(periods * steps):
        tau = (k + 0.5) * h
        free = rate + h * (pz * np.sin(tau) - 1.0)
        impulse = max(0.0, -free) if height <= 0.0 else 0.0
        rate = free + impulse
        height = max(0.0, height + h * rate) if height + h * rate > 0 else 0.0
        v = u + h * px * np.sin(tau)
        u = np.empty_like(v)
        touching = np.r_[np.diff(x) <= 1e-12, False]
        first = 0
        for i in range(len(mu)):
            if touching[i]:
                continue
            part = slice(first, i + 1)
            forward = isotonic_regression(v[part] - mu[part] * impulse, weights=m[part]).x
            back = isotonic_regression(v[part] + mu[part] * impulse, weights=m[part]).x
            u[part] = np.where(forward > 0, forward, np.where(back < 0, back, 0.0))
            first = i + 1
        x = x + h * u
        for i in np.nonzero(np.diff(x) < 0)[0]:
            pair = slice(i, i + 2)
            x[pair] = m[pair] @ x[pair] / m[pair].sum()
            u[pair] = m[pair] @ u[pair] / m[pair].sum()
        if (k + 1) % steps == 0:
            places.append(x)
    return np.array(places)


@pytest.mark.parametrize(
    ("px", "pz", "friction", "mass"),
    [
        (2.0, 0.6, [0.25, 0.4], [1.0, 2.0]),
        (1.5, 0.8, [0.5, 0.2, 0.35], [1.0, 0.5, 2.0]),
        (2.5, 1.8, [0.6, 0.2], [1.0, 1.0]),
    ],
)
def test_time_stepping_comes_nearer_with_its_step(px, pz, friction, mass):
    periods = count(4, 20)
    exact = np.empty((periods, len(mass)))
    row, ends = cell(px, pz, friction, mass=mass), TURN * np.arange(1, periods + 1)
    path_of_row(row, ends, exact, np.empty((periods, len(mass) - 1)))
    coarse, fine = (
        np.abs(stepped(px, pz, friction, mass, periods, steps) - exact).max(axis=1) / ends
        for steps in (100, 400)
    )
    assert fine.max() < 0.01
    assert fine.mean() < 0.5 * coarse.mean()  # of first order it is a quarter


# --- studies


STUDY = {
    "kind": "simulate", "scene": "row-on-plane", "outputs": ["conveying_velocity", "platoons"],
}  # fmt: skip
DRIVEN = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20}


@pytest.mark.parametrize(
    ("more", "place", "says"),
    [
        ({}, "parameters.parts", "it is missing"),
        ({"parts": 4}, "parameters.friction", "it is missing"),
        ({"parts": 1, "friction": 0.3}, "parameters.parts", "at least 2"),
        ({"parts": 4, "friction": 0.3, "alpha": 5}, "parameters.alpha", "not used"),
        ({"part_friction_1": 0.3, "part_friction_3": 0.2}, "parameters.friction", "it is missing"),
        (
            {"part_friction_1": 0.3, "part_mass_2": "4 g", "friction": 0.2},
            "parameters.mass",
            "it is missing",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(more, place, says):
    with pytest.raises(StudyError) as caught:
        prepare_content({**STUDY, "parameters": {**DRIVEN, **more}})
    assert any(one.place == place and says in str(one) for one in caught.value.problems)


@pytest.mark.parametrize(
    "drive",
    [
        {"frequency": 50, "amplitude_along_1": "0.3 mm", "amplitude_along_2": "0.1 mm"},
        {"frequency": 50, "acceleration_normal_1": 2, "duration_1": 1, "duration_2": 1},
    ],
)
def test_rows_take_every_drive_of_the_plane(drive):
    study = {**STUDY, "parameters": {**drive, "part_friction_1": 0.3, "part_friction_2": 0.4}}
    assert prepare_content(study).plan.variant == "events"


def regimes(outputs=("platoons",), **given):
    """Return a study of a row, and the names of its regimes."""
    found = vibrafeed.simulate(
        scene="row-on-plane", outputs=list(outputs), **{**DRIVEN, "max_periods": 60, **given}
    )
    names = {flag.value: name for name, flag in REGIMES.items()}
    return found, [names[value] for value in found.regime.values.ravel().tolist()]


APART = {"part_friction_1": 0.3, "part_friction_2": 0.34, "part_friction_3": 0.28}


def test_regimes_of_rows():
    assert regimes(**APART)[1] == ["separating"]
    assert regimes(parts=3, friction=0.3)[1] == ["hopping"]
    pair = {"part_friction_1": 0.3, "part_friction_2": 0.4}
    assert regimes(**pair, amplitude="1.2 mm")[1] == ["out_of_phase_possible"]


SLOPE = [
    # Friction at the rear and in front, and whether parts at the lower end leave: alone, or
    # pushed by the part above. tan(10 deg) is 0.1763.
    (10, (0.05, 0.3), True), (10, (0.3, 0.05), True), (10, (0.3, 0.06), False),
    (-10, (0.3, 0.05), True), (-10, (0.05, 0.3), True), (-10, (0.06, 0.3), False),
]  # fmt: skip


@pytest.mark.parametrize(("gamma", "friction", "away"), SLOPE)
def test_parts_that_run_down_a_slope_for_ever_have_no_mean_velocity(gamma, friction, away):
    found = vibrafeed.simulate(
        scene="row-on-plane", outputs=["conveying_velocity"], frequency=50, amplitude="0.1 mm",
        beta=20, gamma=gamma, part_friction_1=friction[0], part_friction_2=friction[1],
    )  # fmt: skip
    assert (found.regime == REGIMES["runaway"].value) == away
    assert np.isnan(found.conveying_velocity) == away


def test_a_stop_holds_the_parts_in_front_on_a_slope_and_not_those_behind():
    given = {"frequency": 50, "amplitude": "0.1 mm", "beta": 20, "fixed_stop_gap": 0,
             "part_friction_1": 0.05, "part_friction_2": 0.3, "mass": "10 g"}  # fmt: skip
    found = vibrafeed.simulate(
        scene="row-on-plane", outputs=["stop_force"], gamma=[-10.0, 10.0], **given
    )
    assert found.regime.values.tolist() == [REGIMES["blocked"].value, REGIMES["runaway"].value]


def test_parts_that_rebound_from_the_floor_are_followed_by_no_method():
    outputs = ["conveying_velocity", "feed_rate"]
    given = {**APART, "length": "12 mm"}
    found, names = regimes(outputs, restitution=[0.0, 0.2], **given)
    assert names[0] != names[1] == "not_supported"
    for output in outputs:
        assert np.isnan(found[output].values).tolist() == [False, True]
    _, names = regimes(parts=3, friction=0.3, restitution=[0.0, 0.2], max_periods=10)
    assert names[1] == "not_supported"


def test_a_part_that_friction_can_tip_is_said_where_its_height_is_given():
    # mu b > h: 0.34 of 12 mm are 35.3 mm.
    _, names = regimes(**APART, length="12 mm", height=["35 mm", "36 mm"])
    assert names == ["separating", "tipping"]
    _, names = regimes(parts=2, friction=0.3, length="12 mm", height=["39 mm", "41 mm"])
    assert names == ["hopping", "tipping"]


def test_parts_a_minute_are_those_that_leave_at_either_end():
    outputs = ["feed_rate", "conveying_velocity", "slowest_velocity", "fastest_part_velocity"]
    apart, _ = regimes(outputs, **APART, length="12 mm")
    forth, mean, last, first = (float(apart[name]) for name in outputs)
    assert 0 < last < mean < first
    assert forth == pytest.approx(60 * last / 0.012, rel=1e-12)  # what comes behind is no faster
    together, _ = regimes(outputs, parts=3, friction=0.3, length="12 mm")
    forth, mean, *_ = (float(together[name]) for name in outputs)
    assert forth == pytest.approx(60 * mean / 0.012, rel=1e-12)
    back, _ = regimes(outputs, **APART, length="12 mm", beta=160)
    forth, mean, last, first = (float(back[name]) for name in outputs)
    assert last < first < 0
    assert forth == pytest.approx(60 * first / 0.012, rel=1e-12)
    both, names = regimes(
        outputs, part_friction_1=0.1, part_friction_2=0.8, length="12 mm", gamma=4,
        amplitude="0.25 mm", beta=30,
    )  # fmt: skip
    forth, mean, last, first = (float(both[name]) for name in outputs)
    assert names == ["separating"]
    assert last < 0 < first
    assert forth == 0.0


ONE_PART = """
import sys
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
study = {
    "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "amplitude": [1e-4, 2e-4], "beta": 20, "friction": 0.3},
}
prepare_content(study)  # what is read once a process has been read
called = []
sys.setprofile(lambda frame, event, argument: called.append(frame.f_code.co_filename))
prepared = prepare_content(study)
tabulate(prepared)
sys.setprofile(None)
print(len(called), *sorted({one for one in called if "row" in one.rpartition("core")[2]}))
print(*(one.gives for one in prepared.plan.equations))
print(*(one for one in sys.modules if ".kernels." in one))
"""
"""Prints the files of rows that a study of one part calls, its equations, the kernels it loads."""


def test_a_study_of_one_part_knows_nothing_of_rows():
    done = subprocess.run(
        [sys.executable, "-c", ONE_PART], capture_output=True, text=True, cwd=ROOT, check=True
    )
    (calls, *files), equations, kernels = (line.split() for line in done.stdout.splitlines())
    assert int(calls) > 1000
    assert not files
    assert "motion" in equations
    assert not {"row", "parts"} & set(equations)
    assert "vibrafeed.core.motion.kernels.planar.plane_cells" in kernels
    assert not [name for name in kernels if "rows" in name]
