"""Closed results of rows: worked values, limits, and time stepping against a stop."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes.row_on_plane import HELD_FROM

G = 9.80665


def values(variant, outputs, **given):
    """Return the outputs of a sweep, SI units, and the name of its regime."""
    found = vibrafeed.sweep(scene="row-on-plane", variant=variant, outputs=outputs, **given)
    (regime,) = [n for n, flag in REGIMES.items() if flag.value == int(found.regime)]
    return [float(found[name]) for name in outputs], regime


STEPPED = {
    "forward_acceleration": 0.2 * G, "return_acceleration": G, "friction": 0.3, "frequency": 50,
    "row_mass": 1.0,
}  # fmt: skip


def test_worked_values():
    bend = {"bend_radius": 0.2, "bend_friction": 0.3, "bend_length": 0.2}
    names = ["held_line_force", "sliding_line_force"]
    (held, sliding), _ = values("bend", names, line_push=1, **bend)
    assert held == pytest.approx(0.2332392, abs=5e-8)
    assert sliding == pytest.approx(0.1727879, abs=5e-8)
    (pitch,), _ = values(
        "bend", ["bend_pitch"], length="20 mm", part_width="10 mm", bend_radius="200 mm"
    )
    assert pitch * 1e3 == pytest.approx(20.508, abs=5e-4)
    names = ["stop_force", "stop_contact_fraction", "stop_impact_share"]
    (force, contact, impacts), _ = values("stepped_stop", names, **STEPPED)
    assert force / G == pytest.approx(0.1112701665, abs=5e-11)
    assert contact == pytest.approx(0.1127016654, abs=5e-11)
    assert impacts == pytest.approx(0.696, abs=5e-4)


def on_the_track(push, friction=0.4, **more):
    """Return the least force on a stop of the track over the weight, both pushes in g."""
    amplitude = np.hypot(*push) * G / (2 * np.pi * 50) ** 2
    (force,), regime = values(
        "track_stop", ["least_stop_force"], friction=friction, frequency=50, amplitude=amplitude,
        beta=np.degrees(np.arctan2(push[1], push[0])), row_mass=1.0, **more,
    )  # fmt: skip
    return force / G, regime


def test_the_least_force_on_a_stop_of_the_track():
    force, _ = on_the_track((0.5, 0.5))
    assert force == pytest.approx(0.060299340617, abs=5e-12)
    # The mean of max(0, D - mu n), by sums over a period.
    tau = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    slope = np.radians(3)
    force, _ = on_the_track((0.7, 0.4), gamma=3)
    wave = np.maximum(
        0.0, 0.7 * np.sin(tau) - np.sin(slope) - 0.4 * (np.cos(slope) - 0.4 * np.sin(tau))
    )
    assert force == pytest.approx(wave.mean(), abs=1e-9)
    assert on_the_track((0.1, 0.1))[0] == 0.0


def test_the_force_that_friction_locks_in_on_a_stop_of_the_track():
    def by_steps(px, pz, mu):
        tau = (np.arange(200_000) + 0.5) * 2 * np.pi / 100_000  # two periods, the second is kept
        push, load = px * np.sin(tau), 1.0 - pz * np.sin(tau)
        force, total = 0.0, 0.0
        for k, (low, high) in enumerate(zip(push - mu * load, push + mu * load, strict=True)):
            force = max(0.0, low, min(high, force))
            total += force if k >= 100_000 else 0.0
        return total / 100_000

    for px, pz, mu in ((1.0, 0.3, 0.4), (0.5, 0.5, 0.4), (0.45, 0.3, 0.4), (0.4, 0.9, 0.8)):
        amplitude = np.hypot(px, pz) * G / (2 * np.pi * 50) ** 2
        (least, locked), _ = values(
            "track_stop", ["least_stop_force", "locked_stop_force"], friction=mu, frequency=50,
            amplitude=amplitude, beta=np.degrees(np.arctan2(pz, px)), row_mass=1.0,
        )  # fmt: skip
        assert locked / G == pytest.approx(by_steps(px, pz, mu), abs=1e-7)
        assert least <= locked
        if px == 1.0:
            assert (least / G, locked / G) == pytest.approx((0.1795, 0.2751), abs=5e-5)


def test_platoons_and_pairs():
    names = ["mean_platoons", "closing_time", "pair_force"]
    pair = {
        "part_mass_1": 1, "part_mass_2": 3, "part_friction_1": 0.3, "part_friction_2": 0.4,
        "part_gap": "5 mm", "row_velocity": 6.064364e-3, "front_velocity": 4.756364e-3,
    }  # fmt: skip
    for parts, mean in ((3, 1.8333), (10, 2.92897), (30, 3.99499)):
        (platoons, closes, force), _ = values("platoons", names, parts=parts, **pair)
        assert platoons == pytest.approx(mean, abs=5e-5)
    assert closes == pytest.approx(3.82263, abs=5e-5)
    assert force == pytest.approx(0.75 * 0.1 * G, rel=1e-12)
    (force,), _ = values(
        "stepped_track_stop", ["least_stop_force"], forward_acceleration=0.2 * G,
        return_acceleration=G, friction=0.3, row_mass=2,
    )  # fmt: skip
    assert force / G == pytest.approx(2 * 0.7 * 0.2 / 1.2, rel=1e-12)


def test_where_the_force_is_a_bound_only():
    assert on_the_track((1.4, 0.1))[1] == "indeterminate_force"
    assert on_the_track((0.5, 1.2))[1] == "flight"
    still = {"frequency": 50, "beta": 90, "friction": 0.4, "row_mass": 1.0}
    for share, regime in ((0.999, "indeterminate_force"), (1.001, "contact")):
        amplitude = share * HELD_FROM * G / (2 * np.pi * 50) ** 2
        (force,), found = values("fixed_stop", ["stop_force"], amplitude=amplitude, **still)
        assert found == regime
        assert force == pytest.approx(0.4 * G)
    _, regime = values("stepped_stop", ["stop_force"], **{**STEPPED, "friction": 0.1})
    assert regime == "indeterminate_force"


def force_by_stepping(px, pz, mu, *, levels=None, periods=16, steps=1000):
    """Return the mean force of one part on a stop at rest in space, over its weight.

    Moreau's time stepping in the track's frame, with floor, friction and the stop as an obstacle.
    """
    h = 2 * np.pi / steps
    x = u = height = rate = total = 0.0
    tau = (np.arange(steps) + 0.5) * h
    push = px * np.sin(tau) if levels is None else levels(tau)
    # The track's own velocity and place, without mean: its acceleration is minus the push.
    track = -np.cumsum(push) * h
    track -= track.mean()
    place = np.cumsum(track) * h
    for k in range(periods * steps):
        j = k % steps
        free = rate + h * (pz * np.sin(tau[j]) - 1.0)
        impulse = max(0.0, -free) if height <= 0.0 else 0.0
        rate = free + impulse
        height = max(0.0, height + h * rate)
        v = u + h * push[j]
        wall = -track[j]  # of the stop, seen from the track
        u = np.sign(v) * max(0.0, abs(v) - mu * impulse)
        if x + place[j] >= 0.0 and u > wall:
            # Held at the stop it slips, with all its friction, while the track runs.
            held = v + mu * impulse * np.sign(track[j])
            if k >= periods * steps // 2:
                total += held - wall
            u, x = wall, -place[j]
        x += h * u
    return total / (np.pi * periods)


@pytest.mark.parametrize("throw", [1.8, 2.5])
def test_a_hopping_row_presses_on_its_stop_with_all_its_friction(throw):
    assert force_by_stepping(2.0, throw, 0.4) == pytest.approx(0.4, abs=4e-3)


def test_two_levels_press_on_a_stop_as_stepping_says():
    def levels(tau):
        half = np.pi / 1.2
        return np.where((tau < half) | (tau > 2 * np.pi - half), -0.2, 1.0)

    found = force_by_stepping(0.0, 0.0, 0.3, levels=levels)
    assert found == pytest.approx(0.11127, abs=2.5e-3)  # first order in a step of 6e-3


LANE = {
    "row_velocity": "80 mm/s", "length": "12 mm", "lane_length": "500 mm",
    "closed_time": "200 ms", "open_time": "100 ms",
}  # fmt: skip


def test_flow_of_a_lane():
    names = [
        "throughput", "throughput_limit", "queue_velocity", "fill_time", "clear_time",
        "escapement_rate", "part_spacing",
    ]  # fmt: skip
    found, regime = values("lane", names, inflow="300 1/min", **LANE)
    assert regime == "contact"
    # 80/12 parts/s pass; 5 come: 60 mm/s of row against 80, so the tail gains 60*80/20 mm/s.
    expected = [300.0, 400.0, 0.24, 500 / 60, 6.25, 60 / 0.35, 0.016]
    assert found == pytest.approx(expected, rel=1e-12)
    moving = {name: LANE[name] for name in ("row_velocity", "length")}
    found, regime = values("lane", names[:3], inflow="500 1/min", **moving)
    assert regime == "crowded"
    assert found[0] == pytest.approx(400.0)
    assert np.isnan(found[2])


def test_limits_of_a_bend():
    long = {"line_push": 2.0, "bend_friction": 0.3, "bend_length": 0.2}
    for radius, rel in ((1e3, 1e-4), (1e6, 1e-7)):
        names = ["held_line_force", "sliding_line_force"]
        both, _ = values("bend", names, bend_radius=radius, **long)
        assert both == pytest.approx([0.4, 0.4], rel=rel)  # straight: q s
    (pitch,), _ = values(
        "bend", ["bend_pitch"], length="20 mm", part_width="10 mm", bend_radius=1e4
    )
    assert pitch == pytest.approx(0.02, rel=1e-6)
