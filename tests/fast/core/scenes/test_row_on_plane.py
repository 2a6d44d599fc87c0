"""Closed results of rows: worked values, limits, and a stop step by step."""

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
    forces = ["held_line_force", "sliding_line_force"]
    found, _ = values("bend", forces, line_push=1, **bend)
    assert found == pytest.approx([0.2332392, 0.1727879], abs=5e-8)
    part = {"length": "20 mm", "part_width": "10 mm"}
    (pitch,), _ = values("bend", ["bend_pitch"], **part, bend_radius="200 mm")
    assert pitch * 1e3 == pytest.approx(20.508, abs=5e-4)
    names = ["stop_force", "stop_contact_fraction", "stop_impact_share"]
    (force, contact, impacts), _ = values("stepped_stop", names, **STEPPED)
    assert [force / G, contact] == pytest.approx([0.1112701665, 0.1127016654], abs=5e-11)
    assert impacts == pytest.approx(0.696, abs=5e-4)
    # A bend that is nearly straight: q s, and the length of the part.
    both, _ = values("bend", forces, bend_radius=1e6, line_push=2.0, bend_friction=0.3,
                     bend_length=0.2)  # fmt: skip
    assert both == pytest.approx([0.4, 0.4], rel=1e-7)
    (pitch,), _ = values("bend", ["bend_pitch"], **part, bend_radius=1e4)
    assert pitch == pytest.approx(0.02, rel=1e-6)


@pytest.mark.parametrize(
    ("push", "friction", "least", "locked"),
    [((1.0, 0.3), 0.4, 0.1795, 0.2751), ((0.5, 0.5), 0.4, 0.060299340617, None),
     ((0.4, 0.9), 0.8, None, None)],
)  # fmt: skip
def test_the_least_force_on_a_stop_of_the_track_and_what_friction_locks_in(
    push, friction, least, locked
):
    """The mean of max(0, D - mu n) by sums over a period; the locked one step by step."""
    tau = (np.arange(100_000) + 0.5) * 2 * np.pi / 50_000  # two periods, the second is kept
    drive, load = push[0] * np.sin(tau), 1.0 - push[1] * np.sin(tau)
    force, total = 0.0, 0.0
    low, high = (drive - friction * load).tolist(), (drive + friction * load).tolist()
    for k in range(tau.size):
        force = max(0.0, low[k], min(high[k], force))
        total += force if k >= 50_000 else 0.0
    by_steps = [np.maximum(0.0, low).mean(), total / 50_000]
    found = [on_the_track(push, friction, name)[0] for name in ("least", "locked")]
    assert found == pytest.approx(by_steps, abs=1e-6)
    for one, known in zip(found, (least, locked), strict=True):
        assert known is None or one == pytest.approx(known, abs=5e-5)


def on_the_track(push, friction=0.4, name="least"):
    """Return a force on a stop of the track over the weight, both pushes in g."""
    amplitude = np.hypot(*push) * G / (2 * np.pi * 50) ** 2
    (force,), regime = values(
        "track_stop", [f"{name}_stop_force"], friction=friction, frequency=50, amplitude=amplitude,
        beta=np.degrees(np.arctan2(push[1], push[0])), row_mass=1.0,
    )  # fmt: skip
    return force / G, regime


def test_platoons_and_pairs():
    names = ["mean_platoons", "closing_time", "pair_force"]
    pair = {
        "part_mass_1": 1, "part_mass_2": 3, "part_friction_1": 0.3, "part_friction_2": 0.4,
        "part_gap": "5 mm", "row_velocity": 6.064364e-3, "front_velocity": 4.756364e-3,
    }  # fmt: skip
    for parts, mean in ((3, 1.8333), (10, 2.92897), (30, 3.99499)):
        found, _ = values("platoons", names, parts=parts, **pair)
        assert found == pytest.approx([mean, 3.82263, 0.75 * 0.1 * G], rel=3e-5)
    (force,), _ = values(
        "stepped_track_stop", ["least_stop_force"], forward_acceleration=0.2 * G,
        return_acceleration=G, friction=0.3, row_mass=2,
    )  # fmt: skip
    assert force / G == pytest.approx(2 * 0.7 * 0.2 / 1.2, rel=1e-12)


def test_where_the_force_is_a_bound_only():
    for push, regime in (((1.4, 0.1), "indeterminate_force"), ((0.5, 1.2), "flight")):
        assert on_the_track(push)[1] == regime
    assert on_the_track((0.1, 0.1)) == (0.0, "contact")
    still = {"frequency": 50, "beta": 90, "friction": 0.4, "row_mass": 1.0}
    for share, regime in ((0.999, "indeterminate_force"), (1.001, "contact")):
        amplitude = share * HELD_FROM * G / (2 * np.pi * 50) ** 2
        (force,), found = values("fixed_stop", ["stop_force"], amplitude=amplitude, **still)
        assert (found, force) == (regime, pytest.approx(0.4 * G))
    _, regime = values("stepped_stop", ["stop_force"], **{**STEPPED, "friction": 0.1})
    assert regime == "indeterminate_force"


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
    # 80/12 parts/s pass; 5 come: 60 mm/s of row against 80, so the tail gains 60*80/20 mm/s.
    expected = [300.0, 400.0, 0.24, 500 / 60, 6.25, 60 / 0.35, 0.016]
    assert (found, regime) == (pytest.approx(expected, rel=1e-12), "contact")
    moving = {name: LANE[name] for name in ("row_velocity", "length")}
    found, regime = values("lane", names[:3], inflow="500 1/min", **moving)
    assert (found[0], regime) == (pytest.approx(400.0), "crowded")
    assert np.isnan(found[2])
