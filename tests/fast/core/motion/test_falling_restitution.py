"""Restitution that falls with the speed of impact, against a compliant contact."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibrafeed
from vibrafeed.core.compiled import compiled
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.events import motion_by_events, planar_motion
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.planar.plane_laws import Restitution, impulse, rebound
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, Motion
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


@pytest.mark.parametrize("damping", [0.7, 0.0])
def test_the_kernel_has_the_law(damping):
    speeds = np.append(10 ** np.random.default_rng(1).uniform(-12, 6, 60), [0.1, 0.5, 1, 2])
    rows = np.empty((speeds.size, 3))
    rebounds(1.0 if damping else 0.37, damping, speeds, rows)
    up, slope, taken = rows.T
    if not damping:
        assert np.array_equal(up, 0.37 * speeds)
        assert np.array_equal(taken, 1.37 * speeds)
        assert np.all(slope == 0.37)
        return
    d = damping * speeds
    known = d * soft_contact.hunt_crossley(d)  # to 40 digits in `test_soft_contact.py`
    assert up == pytest.approx(known / damping, rel=5e-15)
    assert np.array_equal(taken, speeds + up)
    # d(e d)/dd, by the law's derivative on both sides
    assert slope == pytest.approx((1 - known) * d / ((1 + d) * known), abs=1e-13)
    assert np.all(np.diff(up[np.argsort(speeds)]) >= 0)  # no slow impact rebounds faster


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


def test_another_method_follows_the_same_law():
    given = {"restitution": [0.002, 0.7], "amplitude": "0.2 mm"}
    exact, error, multiple, regime = simulate(
        "conveying_velocity", "conveying_velocity_error", "period_multiple", **given
    )
    other, _ = simulate("conveying_velocity", method="reference", max_periods=40, **given)
    assert multiple.tolist() == [1, 2]
    assert regime.tolist() == [REGIMES["hopping"].value, REGIMES["period_doubled"].value]
    assert np.all(np.abs(exact - other) < error + 1e-7)
    assert np.all(error < [1e-6, 1e-13])  # m/s: hops that never end, taken for a stay


# --- limits


def test_without_rebound_it_is_no_restitution():
    plain = {name: value for name, value in HOPS.items() if name != "restitution_speed"}
    rigid = vibrafeed.simulate(outputs=["conveying_velocity"], restitution=0.0, **plain)
    none, _ = simulate("conveying_velocity", restitution=0.0)
    assert none == rigid.conveying_velocity.values
    # Rebounds are at most 1/b, which goes as the restitution: so does what they change.
    given = {"restitution": [0.04, 0.02, 0.01, 0.0], "amplitude": "0.4 mm", "beta": 60}
    *speeds, least = simulate("conveying_velocity", **given)[0]
    assert np.array(speeds) - least == pytest.approx(
        (speeds[2] - least) * np.array([4, 2, 1]), rel=1e-3
    )


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
    assert np.isnan(found.velocity).tolist() == [False, True]


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
        sensitivities=["restitution", "restitution_speed"],
    )  # fmt: skip
    for name, ends in (
        ("restitution", [0.02999, 0.03001]),
        ("restitution_speed", [0.09999, 0.10001]),
    ):
        (low, high), _ = simulate("conveying_velocity", **{**given, name: ends})
        by = float(found[f"derivative_conveying_velocity_by_{name}"])
        assert by == pytest.approx((high - low) / 2e-5, rel=1e-5)
    assert float(found.derivative_status_restitution) == DERIVATIVE_STATUSES["differences"].value


@pytest.mark.parametrize("scene", ["sphere-on-plane", "roller-on-plane", "disc-on-edge"])
def test_round_parts_have_derivatives(scene):
    found = vibrafeed.simulate(
        scene=scene, frequency=50.0, amplitude="0.01 mm", beta="30 deg", friction=0.3,
        rolling_resistance=0.02, outputs=["conveying_velocity"], sensitivities=["rolling_factor"],
    )  # fmt: skip
    # v = kap/(1 + kap) v_block: the elasticity is 1/(1 + kap).
    kap = 2.5 if scene == "sphere-on-plane" else 2.0
    elasticity = float(found.sensitivity_conveying_velocity_to_rolling_factor)
    assert elasticity == pytest.approx(1 / (1 + kap), rel=1e-6)
