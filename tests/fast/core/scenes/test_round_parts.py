"""Balls, rollers, discs on edge, cones: factors, limits, balances solved by the test itself."""

import re

import numpy as np
import pytest

import vibrafeed
from night import count
from vibrafeed.core.mechanics import resting, rolling, round_parts
from vibrafeed.core.quantities import REGIMES

ROUNDING = 1e-14
DRIVE = {"frequency": 50.0, "beta": 15.0, "alpha": 20.0, "gamma": 3.0}


def sweep(scene, *outputs, **given):
    found = vibrafeed.sweep(scene=scene, outputs=outputs, **given)
    values = [found[name].values for name in outputs]
    return (*values, found.regime.values)


def regimes(*names):
    return [REGIMES[name].value for name in names]


# --- worked values, of the problem's own statement


@pytest.mark.parametrize(
    ("scene", "hole", "kap"),
    [("sphere-on-plane", 0, 5 / 2), ("sphere-on-plane", 1, 3 / 2), ("roller-on-plane", 0, 2),
     ("roller-on-plane", 1, 1), ("disc-on-edge", 0, 2), ("disc-on-edge", 1, 1)],
)  # fmt: skip
def test_factors_of_ball_shell_disc_and_hoop(scene, hole, kap):
    given = {"frequency": 50.0, "amplitude": "0.02 mm", "beta": 10.0, "friction": 0.5,
             "diameter": "8 mm", "inner_diameter": 8e-3 * hole}  # fmt: skip
    pushed, found, share, regime = sweep(scene, "in_plane_drive_x", "acceleration_x",
                                         "rolling_share", **given)  # fmt: skip
    assert share == pytest.approx(kap / (1 + kap), rel=ROUNDING)
    assert found / pushed == pytest.approx(share, rel=ROUNDING)
    assert regime == REGIMES["roll"].value
    # It rolls with 1 + kap times less friction than a block needs to stay.
    needed, load, _ = sweep(scene, "required_friction", "normal_acceleration", **given)
    assert needed == pytest.approx(pushed / ((1 + kap) * load), rel=ROUNDING)


def test_a_tube_of_half_its_diameter():
    assert round_parts.tube_factor(diameter=2.0, inner_diameter=1.0) == pytest.approx(8 / 5)
    # (2/5) m (r^5 - r_i^5)/(r^3 - r_i^3) of a hollow ball.
    hollow = 1 / (2 / 5 * (1 - 0.5**5) / (1 - 0.5**3))
    assert round_parts.ball_factor(diameter=2.0, inner_diameter=1.0) == pytest.approx(hollow)


def cone(diameter, small_diameter, height):
    """Return factor, I_ax and I_t per mass, and the apex distance of a truncated cone."""
    sizes = {"diameter": diameter, "small_diameter": small_diameter, "height": height}
    centre = resting.cone_centre(**sizes)
    k = resting.cone_gyration(**sizes, mass_height=centre)
    axial = round_parts.axial_gyration(diameter=diameter, small_diameter=small_diameter)
    rho = round_parts.centre_radius(**sizes, mass_height=centre)
    half = round_parts.cone_half_angle(**sizes)
    factor = round_parts.cone_factor(
        centre_radius=rho, axial_gyration=axial, gyration=k, cone_half_angle=half
    )
    return factor, axial**2, k**2, rho / np.tan(half) if np.any(half) else np.inf


def test_a_truncated_cone_about_its_apex():
    half = round_parts.cone_half_angle(diameter=20.0, small_diameter=12.0, height=20.0)
    known = [11.309932, 0.6505371105, 35.28979592, 48.85689296, 41.63265306]
    assert [np.degrees(half), *cone(20.0, 12.0, 20.0)] == pytest.approx(known, rel=1e-7)


@pytest.mark.parametrize("half", [1e-6, 10, 20, 30, 45])
def test_a_full_cone_is_that_of_landau_and_lifshitz(half):
    found = cone(2 * np.tan(np.radians(half)), 0.0, 1.0)[0]
    square = np.cos(np.radians(half)) ** 2
    assert found == pytest.approx(3.75 * square / (1 + 5 * square), rel=ROUNDING)


def test_a_cone_that_becomes_a_cylinder_turns_no_more():
    factor, turning, regime = sweep(
        "cone-on-plane", "cone_factor", "turning_acceleration", amplitude="0.02 mm", **DRIVE,
        friction=0.5, diameter="20 mm", small_diameter=["19.9999999999999 mm", "20 mm"],
        height="15 mm",
    )  # fmt: skip
    assert factor == pytest.approx(2 / 3, rel=ROUNDING)
    assert turning[1] == 0
    assert set(regime) == set(regimes("roll"))


# --- laws


def test_a_solid_roller_along_the_track_is_the_cylinder():
    given = {**DRIVE, "amplitude": {"start": 1e-5, "stop": 3e-4, "num": 40}, "friction": 0.2}
    names = ("acceleration_x", "acceleration_y")
    roller = sweep("roller-on-plane", *names, **given, axis_yaw=0.0)
    for one, other in zip(roller, sweep("cylinder-on-plane", *names, **given), strict=True):
        np.testing.assert_allclose(one, other, rtol=ROUNDING)


def balance(push, load, kap, mu):
    """Return the acceleration of a ball from rest: a = D + f, w' = kap f x k/r, Coulomb at contact.

    By the least of friction: it rolls if that friction is in the disc, else f opposes the slip.
    """
    force = -push / (1 + kap)  # what makes a = w r: D + f = -kap f
    size = np.linalg.norm(push)
    if np.linalg.norm(force) > mu * load:
        force = -mu * load * push / size
    return push + force, kap * np.linalg.norm(force)


def test_balls_by_their_own_balance():
    random = np.random.default_rng(2)
    for _ in range(count(30, 300)):
        d = random.uniform(0.002, 0.02)
        given = {
            "frequency": 50.0, "amplitude": random.uniform(1e-6, 9e-5), "diameter": d,
            "beta": random.uniform(-60, 60), "alpha": random.uniform(-180, 180),
            "gamma": random.uniform(-5, 5), "friction": random.uniform(0.01, 0.3),
            "inner_diameter": d * random.uniform(0, 1),
        }  # fmt: skip
        outputs = ("acceleration_x", "acceleration_y", "angular_acceleration", "in_plane_drive_x",
                   "in_plane_drive_y", "floor_acceleration", "rolling_share")  # fmt: skip
        x, y, spin, px, py, load, share, _ = sweep("sphere-on-plane", *outputs, **given)
        kap = share / (1 - share)
        if load <= 0:
            continue
        a, rim = balance(np.array([px, py]), load, kap, given["friction"])
        assert [x, y] == pytest.approx(a, rel=1e-12, abs=1e-13)
        assert spin * d / 2 == pytest.approx(rim, rel=1e-12, abs=1e-13)


def test_discs_against_the_wall_by_their_own_balance():
    random = np.random.default_rng(3)
    for _ in range(count(30, 300)):
        d, m, mu, mu_w = random.uniform([0.005, 1e-3, 0.01, 0.01], [0.03, 1e-2, 0.4, 0.6])
        given = {
            "frequency": 50.0, "amplitude": random.uniform(1e-6, 9e-5), "diameter": d, "mass": m,
            "beta": random.uniform(-40, 40), "gamma": random.uniform(-5, 5), "friction": mu,
            "delta": random.uniform(1, 20), "wall_friction": mu_w,
        }  # fmt: skip
        outputs = ("acceleration_x", "angular_acceleration", "rolling_friction", "wall_drag",
                   "wall_force", "in_plane_drive_x", "floor_acceleration", "gravity_across",
                   "floor_axis_normal", "force_axis_normal")  # fmt: skip
        a, spin, floor, drag, wall, push, load, across, axis, force_axis, _ = sweep(
            "disc-on-edge", *outputs, **given
        )
        assert wall == pytest.approx(m * across, rel=ROUNDING)
        assert load > 0
        # Newton and Euler: m a = m D - drag - floor, I w' = r floor.
        assert m * a == pytest.approx(m * push - drag - floor, abs=1e-13)
        assert m * (d / 2) ** 2 / 2 * spin == pytest.approx(d / 2 * floor, abs=1e-15)
        # Coulomb: the wall holds, or its drag is all that it can and along the push.
        if abs(m * push) <= mu_w * wall:
            assert (a, floor) == (0, 0)
            continue
        assert drag == pytest.approx(np.sign(push) * mu_w * wall, rel=ROUNDING)
        slips = a - spin * d / 2
        if abs(slips) > 1e-9:
            assert floor == pytest.approx(np.sign(slips) * mu * m * load, rel=1e-12)
        else:
            assert abs(floor) <= mu * m * load * (1 + 1e-12)
        # The wrench of the floor, (N, -F) with the moment r F, passes the contact; that of all
        # forces passes r/kap above the centre where the disc rolls.
        n = m * load
        assert axis == pytest.approx(-d / 2 * floor**2 / (n**2 + floor**2), rel=1e-9)
        if abs(slips) <= 1e-9:
            assert force_axis == pytest.approx(d / 4, rel=1e-9)


def test_a_disc_that_the_drive_takes_off_the_wall():
    _, regime = sweep(
        "disc-on-edge", "acceleration_x", frequency=50.0, amplitude="0.08 mm", beta=10.0,
        alpha=[0.0, 30.0], delta=5.0, friction=0.1,
    )  # fmt: skip
    assert regime.tolist() == regimes("slip", "wall_lost")


def test_roots_of_every_factor():
    random = np.random.default_rng(5)
    along, across, q = 10 ** random.uniform(-6, 6, (3, 20_000))
    for kap in (1.0, 1.3, 2.0, 2.5, 50.0):
        z = rolling.slip_root(along, across, kap, q * 0.0, q, np.ones(20_000))
        left = (along / (z + q)) ** 2 + (across / (z + (1 + kap) * q)) ** 2
        rolls = np.hypot(along, across / (1 + kap)) <= q  # kinetic friction alone can hold it
        assert np.abs(left[~rolls] - 1).max() < 1e-12


@pytest.mark.parametrize(
    ("scene", "sizes"),
    [
        ("sphere-on-plane", {"inner_diameter": ["0 mm", "6 mm"]}),
        ("roller-on-plane", {"axis_yaw": [0.0, 40.0, 90.0], "inner_diameter": "3 mm"}),
        ("disc-on-edge", {"inner_diameter": "2 mm", "delta": [2.0, 20.0]}),
        ("cone-on-plane", {"small_diameter": ["1 mm", "7 mm"], "height": "9 mm",
                           "axis_yaw": [0.0, 70.0]}),
    ],
)  # fmt: skip
def test_fifty_digits(scene, sizes):
    output = "rolling_acceleration" if scene == "cone-on-plane" else "acceleration_x"
    found = vibrafeed.sweep(
        scene=scene, outputs=[output, "required_friction"], friction=0.2, verify=count(6, 20),
        **DRIVE, amplitude=["0.01 mm", "0.06 mm", "0.1 mm"], diameter="8 mm", **sizes,
    )  # fmt: skip
    error = re.search(r"error (\S+?),? ", found.attrs["verified_worst"])
    assert float(error[1]) < 1e-12
