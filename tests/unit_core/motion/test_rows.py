"""Rows of parts: worked values, isotonic contact by scipy, time stepping, laws."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

import vibrafeed
from core.errors import StudyError
from core.intake import prepare_content
from core.motion.kernels.rows import path_of_row
from core.motion.kernels.rows.contact import collide, pooled, start
from core.motion.kernels.rows.tables import row_of
from core.quantities import REGIMES
from night import count
from rows import TURN, cell, followed, two_level

MM_S = 9.81 / (2 * np.pi * 50) * 1e3
"""g/w at 50 Hz and 9.81 m/s2 [mm/s]."""


# --- worked values


def test_two_parts_that_push_each_other_under_two_levels():
    together, name = followed(cell(0, 0, [0.3, 0.4], steps=two_level(0.2, 2.0)))
    assert name == "periodic"
    assert together["platoons"] == 1
    for column in ("velocity", "slowest", "fastest"):  # that of one part of friction 0.35
        assert together[column] * MM_S == pytest.approx(5.350909, abs=5e-7)


def test_two_parts_that_leave_each_other_under_two_levels():
    apart, _ = followed(cell(0, 0, [0.4, 0.3], steps=two_level(0.2, 2.0)))
    assert apart["platoons"] == 2
    assert apart["slowest"] * MM_S == pytest.approx(4.756364, abs=5e-7)
    assert apart["fastest"] * MM_S == pytest.approx(6.064364, abs=5e-7)


def test_a_gap_closes_after_its_length_over_the_difference_of_velocities():
    gap = 5e-3 / (9.81 / (TURN * 50) ** 2)
    row = cell(0, 0, [0.3, 0.4], gap=[gap], steps=two_level(0.2, 2.0))
    # Velocities swing within a period: the gap closes within one of the time of the means.
    phases = TURN * 50 * np.array([3.82263 - 0.02, 3.82263 + 0.02])
    gaps = np.empty((2, 1))
    path_of_row(row, phases, np.empty((2, 2)), gaps)
    assert gaps[0] > 0.0
    assert gaps[1] == 0.0


def test_a_row_of_period_two():
    found, name = followed(cell(3.0, 0.9, [0.5, 0.3]))
    assert name == "periodic"
    assert found["multiple"] == 2
    assert found["velocity"] == pytest.approx(0.821698729434, abs=1e-11)
    gaps = np.empty((4, 1))
    path_of_row(cell(3.0, 0.9, [0.5, 0.3]), TURN * np.arange(200, 204), np.empty((4, 2)), gaps)
    assert sorted(gaps[:2, 0]) == pytest.approx([0.36625036, 0.81667924], abs=1e-8)
    assert gaps[2:] == pytest.approx(gaps[:2], abs=1e-10)


def test_an_aperiodic_row_keeps_its_mean():
    p, pz, gamma = 3.3397910, 0.6899518, -0.0118420
    row = cell(
        np.sqrt(p * p - pz * pz), pz, [0.6497323, 0.1273437], mass=[0.7813170, 1.6836820],
        gs=np.sin(gamma), gn=np.cos(gamma), most=8000,
    )  # fmt: skip
    found, name = followed(row)
    assert name == "aperiodic"
    assert found["platoons"] == 1
    # 0.9198 +- 0.0005 over 1,200 periods by another program; both errors are statistical.
    assert found["velocity"] == pytest.approx(0.9198, abs=3 * (5e-4 + found["error"]))


def test_equal_parts_are_one_part_to_the_bit():
    study = {"frequency": 50, "amplitude": "0.4 mm", "beta": 25, "outputs": ["conveying_velocity"]}
    one = vibrafeed.simulate(scene="rectangle-on-plane", friction=[0.2, 0.4], **study)
    row = vibrafeed.simulate(scene="row-on-plane", parts=[2, 20], friction=[0.2, 0.4], **study)
    assert (row.conveying_velocity.values == one.conveying_velocity.values[:, np.newaxis]).all()


def test_the_compiled_row_of_equal_parts_is_one_part_too():
    study = {"frequency": 50, "beta": 25, "outputs": ["conveying_velocity"]}
    for size in ("0.08 mm", "0.3 mm", "0.6 mm"):
        one = vibrafeed.simulate(scene="rectangle-on-plane", friction=0.35, amplitude=size, **study)
        row = vibrafeed.simulate(
            scene="row-on-plane", part_friction_1=0.35, part_friction_2=0.35 * (1 + 1e-15),
            amplitude=size, **study,
        )  # fmt: skip
        assert float(row.conveying_velocity) == pytest.approx(
            float(one.conveying_velocity), rel=1e-9
        )


def test_an_unequal_pair_that_hops():
    found, _ = followed(cell(2.5, 1.8, [0.6, 0.2]))
    alone = [followed(cell(2.5, 1.8, [mu, mu]))[0]["velocity"] for mu in (0.6, 0.2)]
    assert found["velocity"] == pytest.approx(1.8556, abs=1e-3)  # by stepping
    assert alone == pytest.approx([2.0977, 1.0184], abs=2e-3)  # by stepping
    assert found["flight"] > 0.0


# --- another method: isotonic regression by scipy


def test_contact_is_isotonic_regression():
    random = np.random.default_rng(1)
    for _ in range(count(300, 5000)):
        n = int(random.integers(2, 9))
        row = row_of(cell(1, 0, random.uniform(0.1, 0.9, n), mass=random.uniform(0.2, 3.0, n)))
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
        row = row_of(cell(1, 0, static, mass=random.uniform(0.2, 3.0, n)))
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
        row = row_of(cell(1, 0, [0.3] * n, mass=random.uniform(0.2, 3.0, n)))
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
    found, name = followed(cell(px, pz, friction, mass=mass))
    assert name in ("periodic", "aperiodic")
    errors = []
    for steps in (250, 1000):
        places = stepped(px, pz, friction, mass, 60, steps)
        means = (places[-1] - places[23]) / (36 * TURN)
        errors.append(np.abs(means.mean() - found["velocity"]))
    slack = 4.0 * found["error"]
    assert errors[1] < 4e-3 * max(px, 1.0) + slack
    assert errors[1] < 0.6 * errors[0] + slack or errors[0] < 5e-4


# --- laws


def test_laws_of_random_rows():
    random = np.random.default_rng(5)
    for _ in range(count(25, 1000)):
        n = int(random.integers(2, 6))
        px, pz = random.uniform(0.5, 3.0), random.uniform(0.1, 2.5)
        mu, mass = random.uniform(0.1, 0.8, n), random.uniform(0.3, 3.0, n)
        found, name = followed(cell(px, pz, mu, mass=mass))
        assert name in ("periodic", "aperiodic", "at_rest")
        slack = 1e-9 + 4.0 * found["error"]
        scaled, _ = followed(cell(px, pz, mu, mass=3.0 * mass))
        assert scaled["velocity"] == pytest.approx(found["velocity"], abs=slack)
        if name != "periodic":
            continue
        # Half a period later the mirror image: x -> -x, and the order of the parts.
        mirrored, _ = followed(cell(-px, pz, mu[::-1], mass=mass[::-1]))
        assert mirrored["velocity"] == pytest.approx(-found["velocity"], abs=slack)
        # A part far in front changes nothing but the mean.
        gap = [*np.zeros(n - 1), 1e6]
        more, _ = followed(cell(px, pz, [*mu, 0.3], mass=[*mass, 1.0], gap=gap))
        assert more["slowest"] <= found["slowest"] + slack
        assert more["fastest"] >= found["fastest"] - slack


def test_parts_never_overlap_and_separate_parts_never_meet():
    random = np.random.default_rng(6)
    for _ in range(count(10, 200)):
        n = int(random.integers(2, 8))
        row = cell(random.uniform(0.5, 3), random.uniform(0.1, 2), random.uniform(0.1, 0.8, n))
        phases = np.linspace(0.0, 30 * TURN, 900)
        places, gaps = np.empty((900, n)), np.empty((900, n - 1))
        path_of_row(row, phases, places, gaps)
        assert gaps.min() >= -1e-12
        assert gaps == pytest.approx(np.diff(places, axis=1), abs=1e-11)


def test_two_parts_of_one_friction_are_one_of_their_mass():
    three, _ = followed(cell(2.0, 0.6, [0.3, 0.3, 0.5], mass=[1.0, 2.0, 1.0]))
    two, _ = followed(cell(2.0, 0.6, [0.3, 0.5], mass=[3.0, 1.0]))
    for column in ("slowest", "fastest"):
        assert three[column] == pytest.approx(two[column], abs=1e-9)


def test_platoons_of_a_wave_that_slips_one_way_are_as_many_as_records():
    # Random frictions: 1 + 1/2 + ... + 1/n platoons in the mean, whatever their distribution.
    random, rows = np.random.default_rng(7), count(200, 3000)
    found = [
        followed(cell(0, 0, random.uniform(0.25, 0.9, 3), steps=two_level(0.2, 2.0)))[0]["platoons"]
        for _ in range(rows)
    ]
    # The number of blocks of three has the variance 1/4 + 2/9.
    assert np.mean(found) == pytest.approx(1 + 1 / 2 + 1 / 3, abs=4 * np.sqrt(0.4722 / rows))


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
        ({"parts": 4, "friction": 0.3, "restitution": 0.2}, "parameters.restitution", "not used"),
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
def test_a_drive_of_rows_is_followed_by_steps_where_events_refuse_it(drive):
    study = {**STUDY, "parameters": {**drive, "part_friction_1": 0.3, "part_friction_2": 0.4}}
    with pytest.raises(StudyError, match="the method events follows rows under"):
        prepare_content(study)
    prepared = prepare_content({**study, "method": "time-stepping"})
    assert prepared.plan.variant == "time-stepping"


def test_regimes_of_rows():
    def regime(**given):
        found = vibrafeed.simulate(scene="row-on-plane", outputs=["platoons"], **DRIVEN, **given)
        return int(found.regime)

    apart = {"part_friction_1": 0.3, "part_friction_2": 0.34, "part_friction_3": 0.28}
    assert regime(**apart) == REGIMES["separating"].value
    assert regime(parts=3, friction=0.3) == REGIMES["hopping"].value
    jumping = {**DRIVEN, "amplitude": "1.2 mm"}
    found = vibrafeed.simulate(
        scene="row-on-plane",
        outputs=["platoons"],
        **jumping,
        part_friction_1=0.3,
        part_friction_2=0.4,
    )
    assert int(found.regime) == REGIMES["out_of_phase_possible"].value


def test_a_study_of_one_part_knows_nothing_of_rows():
    prepared = prepare_content({
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "parameters": {**DRIVEN, "friction": 0.3},
    })  # fmt: skip
    assert not {"row", "parts"} & {one.gives for one in prepared.plan.equations}
