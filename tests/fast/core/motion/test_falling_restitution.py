"""Restitution that falls with the speed of impact, against a compliant contact."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibrafeed
from night import NIGHT
from vibrafeed.core.compiled import compiled
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.events import motion_by_events, planar_motion, planar_path
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.planar.plane_laws import Restitution, impulse, rebound
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, Motion, cells_of
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES
from vibrafeed.core.scenes import soft_contact

TURN = 2 * np.pi
EXACTLY = {"tolerance": 1e-12, "max_periods": 1000.0}
HOPS = {
    "scene": "rectangle-on-plane", "frequency": 50.0, "amplitude": "0.2 mm", "beta": "40 deg",
    "friction": 0.3, "restitution_speed": "0.1 m/s",
}  # fmt: skip


def simulate(*outputs, **given):
    found = vibrafeed.simulate(outputs=outputs, **{**HOPS, **given})
    return (*(found[name].values for name in outputs), found.regime.values)


# --- the law in the kernel


@compiled
def rebounds(constant: float, damping: float, speeds: Floats, rows: Floats) -> None:
    """Fill rebound, its derivative, and what the impact takes."""
    e = Restitution(constant, damping)
    for place in range(speeds.size):
        up, slope = rebound(e, speeds[place])
        rows[place, 0], rows[place, 1] = up, slope
        rows[place, 2] = impulse(e, speeds[place], up)


def kernel(constant, damping, speeds):
    rows = np.empty((speeds.size, 3))
    rebounds(constant, damping, speeds, rows)
    return rows.T


def test_the_kernel_has_the_law_to_many_digits():
    speeds = np.append(10 ** np.random.default_rng(1).uniform(-12, 6, 60), [0.1, 0.5, 1, 2])
    damping = 0.7
    up, slope, taken = kernel(1.0, damping, speeds)
    with mpmath.workdps(40):
        for v, found, by_speed in zip(speeds, up, slope, strict=True):
            d = mpmath.mpf(damping) * mpmath.mpf(float(v))
            known = 1 + mpmath.lambertw(-mpmath.exp(-1 - d + mpmath.log1p(d)))  # e d
            assert float(found) == pytest.approx(float(known / damping), rel=5e-16 * 4)
            # d(e d)/dd, by the law's derivative on both sides
            assert by_speed == pytest.approx(float((1 - known) * d / ((1 + d) * known)), abs=1e-14)
    assert np.array_equal(taken, speeds + up)
    assert np.all(np.diff(up[np.argsort(speeds)]) >= 0)  # no slow impact rebounds faster
    assert np.all((slope >= 0) & (slope <= 1))


def test_one_restitution_is_as_it_was_to_the_last_bit():
    speeds = 10 ** np.random.default_rng(2).uniform(-12, 6, 200)
    up, slope, taken = kernel(0.37, 0.0, speeds)
    assert np.array_equal(up, 0.37 * speeds)
    assert np.array_equal(taken, 1.37 * speeds)
    assert np.all(slope == 0.37)


# --- against a contact that gives


def landings_on_a_contact(normal, damping, periods, stiffness=1e12):
    """Return the speeds of impact, in the end, on a floor k x^(3/2) (1 + b x'); g and w are 1.

    Contact and flight are followed by one integrator that knows neither impact nor restitution.
    """

    def rate(tau, y):
        depth = max(-y[0], 0.0)
        force = stiffness * depth**1.5 * max(1 - damping * y[1], 0.0)
        return y[1], normal * np.sin(tau) - 1 + force

    def lands(tau, y):
        return y[0]

    lands.direction = -1
    found = solve_ivp(
        rate, (0.5, 0.5 + periods * TURN), (0.0, 0.5), events=lands, method="LSODA",
        rtol=1e-9, atol=1e-13, max_step=0.1,
    )  # fmt: skip
    late = found.t_events[0] > (periods - 8) * TURN
    return -found.y_events[0][late, 1]


@pytest.mark.parametrize(("damping", "multiple"), [(3.0, 2), (8.0, 1)])
def test_hops_on_a_contact_that_gives(damping, multiple):
    groups = Groups(1.0, 3.487, 0.0, 1.0, 0.3, 0.3, 1.0, impact_damping=damping)
    motion = planar_motion(groups, **EXACTLY)
    assert (motion.status, motion.multiple) == (STATUS["periodic"], multiple)
    speeds = landings_on_a_contact(3.487, damping, 20)
    assert speeds.size == pytest.approx(8 * motion.impacts, abs=1)
    # An impact on this floor takes some 1e-4 of a turn, and the last ones still settle.
    assert speeds.max() == pytest.approx(float(motion.landing_speed), rel=1e-3)
    path, _ = planar_path(groups, **EXACTLY, phases=np.linspace(0, multiple * TURN, 20_001))
    jumps = np.diff(path.velocity[:, 2])
    (at,) = np.nonzero(jumps > 0.1)
    before, after = -path.velocity[:, 2][at], path.velocity[:, 2][at + 1]
    known = before * soft_contact.hunt_crossley(damping * before)
    assert after == pytest.approx(known, abs=3e-3)  # the phases are 3e-4 of a turn apart


def test_another_method_follows_the_same_law():
    given = {"restitution": [0.02 if NIGHT else 0.002, 0.7], "amplitude": "0.2 mm"}
    exact, error, multiple, regime = simulate(
        "conveying_velocity", "conveying_velocity_error", "period_multiple", **given
    )
    other, _ = simulate("conveying_velocity", method="reference", max_periods=40, **given)
    assert multiple.tolist() == [1, 2]
    assert regime.tolist() == [REGIMES["hopping"].value, REGIMES["period_doubled"].value]
    assert np.all(np.abs(exact - other) < error + 1e-7)
    assert error[0] < 1e-6  # m/s: hops that never end, taken for a stay on the floor
    assert error[1] < 1e-13


# --- limits


def test_it_lies_between_no_rebound_and_a_full_one():
    plain = {name: value for name, value in HOPS.items() if name != "restitution_speed"}
    rigid = vibrafeed.simulate(outputs=["conveying_velocity"], restitution=0.0, **plain)
    none, _ = simulate("conveying_velocity", restitution=0.0)
    assert none == rigid.conveying_velocity.values
    # Rebounds are at most 1/b, which goes as the restitution: so does what they change.
    speeds = [float(simulate("conveying_velocity", restitution=e, amplitude="0.4 mm", beta=60)[0])
              for e in (0.04, 0.02, 0.01, 0.0)]  # fmt: skip
    assert np.array(speeds[:-1]) - speeds[-1] == pytest.approx(
        (speeds[2] - speeds[-1]) * np.array([4, 2, 1]), rel=1e-3
    )
    assert speeds[2] != speeds[-1]
    # Where an impact is slow beside 1/b the restitution is one: that of a constant one.
    groups = Groups(1.0, 1.5, 0.0, 1.0, 0.3, 0.3, np.array([0.0, 0.5, 1.0]))
    kept = planar_motion(groups, **EXACTLY)
    lost = planar_motion(groups._replace(impact_damping=0.0), **EXACTLY)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(kept, lost, strict=True))


def test_where_the_part_stays_on_the_floor_it_plays_no_part():
    slides = {"amplitude": "0.1 mm", "beta": "20 deg"}
    plain = {name: value for name, value in HOPS.items() if name != "restitution_speed"}
    found, _ = simulate("conveying_velocity", restitution=[0.1, 0.5], **slides)
    known = vibrafeed.simulate(outputs=["conveying_velocity"], **{**plain, **slides})
    assert np.all(found == known.conveying_velocity.values)


def test_small_hops_that_never_end_pass_into_a_stay():
    """From hops through the whole contact to a stay the mean has no jump beyond its error."""
    given = {"restitution": np.linspace(0.04, 0.1, 13).tolist(), "beta": 60}
    speed, error, impacts, regime = simulate(
        "conveying_velocity", "conveying_velocity_error", "impacts_per_period", **given
    )
    assert {REGIMES["hopping"].value, REGIMES["aperiodic"].value} == set(regime.tolist())
    assert impacts.max() > 100
    assert np.all(np.abs(np.diff(speed)) < 2e-4 + error[1:] + error[:-1])


# --- what it costs where it is not asked for, and what it refuses


def test_it_is_left_out_of_a_study_that_does_not_ask_for_it():
    plain = {k: v for k, v in HOPS.items() if k not in ("scene", "restitution_speed")}
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
             "parameters": {**plain, "restitution": 0.3}}  # fmt: skip
    names = {one.gives for one in prepare_content(study).plan.equations}
    study["parameters"]["restitution_speed"] = "0.1 m/s"
    more = {one.gives for one in prepare_content(study).plan.equations}
    assert more - names == {"impact_damping"}
    assert not np.any(cells_of(Groups(1, 1, 0, 1, 0.3, 0.3), **EXACTLY)[0][:, 12])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"alpha": 10}, "in the plane of the track"),
        ({"scene": "rectangle-on-track", "delta": 5}, "in the plane of the track"),
        ({"scene": "rectangle-on-track", "radius": "0.2 m"}, "in the plane of the track"),
        ({"restitution": None}, "restitution"),
        ({"scene": "sphere-on-plane", "restitution": 0.3}, "restitution_speed"),
    ],
)
def test_what_is_not_known_is_refused(changes, words):
    given = {k: v for k, v in {"restitution": 0.3, **changes}.items() if v is not None}
    with pytest.raises(StudyError, match=words):
        simulate("conveying_velocity", **given)


def test_a_push_across_has_no_solution():
    groups = Groups(1.0, 1.5, 0.0, 1.0, 0.3, 0.3, 1.0, drive_number_across=np.array([0.0, 0.5]),
                    impact_damping=1.0)  # fmt: skip
    found: Motion = motion_by_events(groups, Contacts(), **EXACTLY)
    assert found.status.tolist()[1] == STATUS["no_solution"]
    assert np.isnan(found.velocity[1])
    assert np.isfinite(found.velocity[0])


def test_on_a_wave_and_on_a_drive_unit():
    wave = {"frequency": 50.0, "amplitude_along_1": "0.15 mm", "amplitude_normal_1": "0.13 mm",
            "amplitude_normal_2": "0.01 mm", "phase_normal_2": 30.0}  # fmt: skip
    plain = {"scene": "rectangle-on-plane", "friction": 0.3, "restitution": 0.0, **wave}
    known = vibrafeed.simulate(outputs=["conveying_velocity"], **plain)
    found = vibrafeed.simulate(
        outputs=["conveying_velocity"], **plain | {"restitution": [0.0, 0.001]},
        restitution_speed="0.1 m/s",
    )  # fmt: skip
    speed = found.conveying_velocity.values
    assert speed[0] == known.conveying_velocity.values
    assert speed[1] == pytest.approx(speed[0], rel=1e-2)


# --- derivatives


def test_derivatives_are_those_of_the_falling_restitution():
    given = {"amplitude": "0.4 mm", "beta": 60, "restitution": 0.03}
    found = vibrafeed.simulate(
        outputs=["conveying_velocity"], **{**HOPS, **given},
        sensitivities=["restitution", "restitution_speed", "amplitude"],
    )  # fmt: skip
    for name, low, high, unit in (
        ("restitution", 0.02999, 0.03001, 2e-5), ("restitution_speed", 0.09999, 0.10001, 2e-5),
    ):  # fmt: skip
        pair, _ = simulate("conveying_velocity", **{**given, name: [low, high]})
        assert float(found[f"derivative_conveying_velocity_by_{name}"]) == pytest.approx(
            (pair[1] - pair[0]) / unit, rel=1e-5
        )
    assert float(found.derivative_status_restitution) == DERIVATIVE_STATUSES["differences"].value


@pytest.mark.parametrize("scene", ["sphere-on-plane", "roller-on-plane", "disc-on-edge"])
def test_round_parts_have_derivatives(scene):
    given = {"scene": scene, "frequency": 50.0, "amplitude": "0.01 mm", "beta": "30 deg",
             "friction": 0.3, "outputs": ["conveying_velocity"]}  # fmt: skip
    found = vibrafeed.simulate(**given, rolling_resistance=0.02,
                               sensitivities=["rolling_resistance", "rolling_factor"])  # fmt: skip
    pair = vibrafeed.simulate(**given, rolling_resistance=[0.01999, 0.02001])
    low, high = pair.conveying_velocity.values
    by = float(found.derivative_conveying_velocity_by_rolling_resistance)
    assert by == pytest.approx((high - low) / 2e-5, rel=1e-5)
    # v = kap/(1 + kap) v_block: the elasticity is 1/(1 + kap).
    kap = 2.5 if scene == "sphere-on-plane" else 2.0
    elasticity = float(found.sensitivity_conveying_velocity_to_rolling_factor)
    assert elasticity == pytest.approx(1 / (1 + kap), rel=1e-6)
