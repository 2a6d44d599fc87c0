"""Time stepping against exact solutions, the reference method, and the laws of contact."""

from __future__ import annotations

import math
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from benchmarks.motions import (
    planar_stepped_motion,
    reference_motion,
    reference_path,
    stepped_motion,
    stepped_path,
)
from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.motion.result import STATUS

GRAVITY = 9.8
NO_DRIVE: dict[str, Any] = {
    "drive_number_along": 0.0, "drive_number_across": 0.0, "drive_number_normal": 0.0
}  # fmt: skip

HOPS = ("hop on a climb", "hop", "hop after hop", "chatter")


def worked(name: str) -> tuple[dict[str, Any], float]:
    """Return the planar groups of a worked value, and its mean velocity in g/w."""
    return MEAN_VELOCITIES[name].groups(), MEAN_VELOCITIES[name].scaled


def spatial(**changes: Any) -> dict[str, Any]:
    """Return groups of a drive aslant, at 15 degrees across, on a leaning and climbing track."""
    alpha, beta = math.radians(15.0), math.radians(25.0)
    gamma, delta, drive = math.radians(1.0), math.radians(18.0), 1.8
    return {
        "drive_number_along": drive * math.cos(beta) * math.cos(alpha),
        "drive_number_across": drive * math.cos(beta) * math.sin(alpha),
        "drive_number_normal": drive * math.sin(beta),
        "gravity_number_along": math.sin(gamma),
        "gravity_number_across": math.cos(gamma) * math.sin(delta),
        "gravity_number_normal": math.cos(gamma) * math.cos(delta),
        "friction_static": 0.4, "friction_kinetic": 0.4, "wall_friction": 0.3,
        "curvature_number": 0.01, **changes,
    }  # fmt: skip


def slope(steps: list[int], errors: list[float]) -> float:
    """Return the order of a method: the slope of log error over log step."""
    return -float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


# --- exact solutions


def disc() -> tuple[dict[str, Any], float, np.ndarray]:
    """Return a disc on an incline, the phase when it rests, and where (theory 13.8 (v))."""
    gamma, friction, speed, psi = math.radians(20.0), 0.6, 2.0, math.radians(70.0)
    pull, nu = math.sin(gamma), friction / math.tan(gamma)
    t, c = math.tan(psi / 2.0), speed * math.sin(psi) / math.tan(psi / 2.0) ** nu
    down = (
        t ** (2.0 * nu - 2.0) / (2.0 * nu - 2.0) - t ** (2.0 * nu + 2.0) / (2.0 * nu + 2.0)
    ) * c * c / (4.0 * pull)  # fmt: skip
    cross = (
        t ** (2.0 * nu - 1.0) / (2.0 * nu - 1.0) + t ** (2.0 * nu + 1.0) / (2.0 * nu + 1.0)
    ) * c * c / (2.0 * pull)  # fmt: skip
    groups = {
        **NO_DRIVE, "gravity_number_along": math.sin(gamma), "gravity_number_across": 0.0,
        "gravity_number_normal": math.cos(gamma),
        "friction_static": friction, "friction_kinetic": friction,
        "velocity": (-speed * math.cos(psi), speed * math.sin(psi), 0.0),
    }  # fmt: skip
    stop = speed * (nu + math.cos(psi)) / (pull * (nu * nu - 1.0))
    return groups, stop, np.array([-down, cross, 0.0])


def chute(phases: np.ndarray) -> tuple[dict[str, Any], np.ndarray, np.ndarray]:
    """Return a curved chute, speed and travel along it (theory 13.8 (vi), 4.5)."""
    gamma, delta, friction, curvature = math.radians(-25.0), math.radians(8.0), 0.2, 0.05
    pull = -math.sin(gamma) - friction * math.cos(gamma) * (math.cos(delta) + math.sin(delta))
    u = phases * math.sqrt(friction * pull * curvature)
    groups = {
        **NO_DRIVE, "gravity_number_along": math.sin(gamma),
        "gravity_number_across": math.cos(gamma) * math.sin(delta),
        "gravity_number_normal": math.cos(gamma) * math.cos(delta),
        "friction_static": friction, "friction_kinetic": friction, "wall_friction": friction,
        "curvature_number": curvature, "wall": True,
    }  # fmt: skip
    speed = math.sqrt(pull / (friction * curvature)) * np.tanh(u)
    return groups, speed, np.log(np.cosh(u)) / (friction * curvature)


def test_disc_on_an_incline_at_first_order() -> None:
    groups, stop, rest = disc()
    steps = [100, 1000, 10000, 100000]
    errors = [
        float(np.hypot(*(
            stepped_path(phases=[0.0, stop + 0.5], steps_per_period=n, **groups).position[-1] - rest
        )[:2])) for n in steps
    ]  # fmt: skip
    assert 0.9 < slope(steps, errors) < 1.1
    assert errors[-1] < 1e-4


def test_curved_chute_at_first_order() -> None:
    phases = np.array([0.0, 1.0, 5.0, 20.0])
    groups, speed, travel = chute(phases)
    steps = [100, 1000, 10000, 100000]
    found = [stepped_path(phases=phases, steps_per_period=n, **groups) for n in steps]
    for k in (1, 2, 3):
        assert 0.9 < slope(steps, [abs(p.velocity[k, 0] - speed[k]) for p in found]) < 1.1
    np.testing.assert_allclose(found[-1].position[:, 0], travel, atol=1e-4)
    np.testing.assert_array_equal(found[-1].position[:, 1:], 0.0)  # it keeps to the corner


@pytest.mark.parametrize("name", MEAN_VELOCITIES)
def test_worked_mean_velocities(name: str) -> None:
    groups, mean = worked(name)
    found = planar_stepped_motion(**groups, steps_per_period=2000)
    assert found.status == STATUS["periodic"]
    # A landing is placed to within a step, in which the velocity changes by step times drive.
    step = 2.0 * math.pi / 4001.0
    bound = step * groups["drive_number_along"] if name in HOPS else 10.0 * step**2
    assert abs(found.velocity - mean) < bound
    shares = found.stick + found.forward + found.backward + found.flight
    assert shares == pytest.approx(1.0, abs=1e-12)
    assert (found.flight > 0.0) == (name in HOPS)


@pytest.mark.parametrize("name", ["stick-slip", "sliding"])
def test_planar_motion_without_hops_is_of_second_order(name: str) -> None:
    groups, mean = worked(name)
    # Where in a step slip starts and stops is chance: a bound of the error, not its slope.
    for n in (250, 1000, 4000):
        found = planar_stepped_motion(**groups, steps_per_period=n)
        assert abs(found.velocity - mean) < 2.0 / n**2


@pytest.mark.parametrize("name", HOPS)
def test_hops_are_of_first_order_and_the_error_says_so(name: str) -> None:
    groups, mean = worked(name)
    for n in (250, 1000, 4000):
        found = planar_stepped_motion(**groups, steps_per_period=n)
        # Three runs tell the size of an error that is partly chance, not its digits.
        assert abs(found.velocity - mean) < 4.0 * float(found.error)
        assert float(found.error) < 20.0 / n


@pytest.mark.parametrize("rolling", [0.0, 2.0])
@pytest.mark.parametrize("wall", [False, True])
def test_in_space_at_first_order_to_the_reference(wall: bool, rolling: float) -> None:
    groups = spatial(wall=wall, rolling=rolling)
    phases = np.linspace(0.0, 6.0 * math.pi, 31)
    exact = reference_path(phases=phases, **groups)
    steps = [500, 5000, 50000]
    errors = [
        float(np.abs(
            stepped_path(phases=phases, steps_per_period=n, **groups).position - exact.position
        ).max()) for n in steps
    ]  # fmt: skip
    # A landing or an impact on the wall falls anywhere in a step: up to a factor of 3 each way.
    assert 0.75 < slope(steps, errors) < 1.25
    assert errors[-1] < 1e-2


def test_a_wall_lost_and_met_again() -> None:
    groups = spatial(wall=True, wall_restitution=0.3)
    phases = np.linspace(0.0, 6.0 * math.pi, 601)
    exact = reference_path(phases=phases, **groups)
    away = exact.position[:, 1] > 1e-6
    assert np.count_nonzero(np.diff(away.astype(int)) == 1) >= 2  # left at least twice
    assert np.count_nonzero(np.diff(away.astype(int)) == -1) >= 2  # and came back
    found = stepped_path(phases=phases, steps_per_period=50000, **groups)
    np.testing.assert_allclose(found.position, exact.position, atol=5e-3)


def test_mean_velocity_at_the_wall_is_that_of_the_reference() -> None:
    groups = spatial(wall=True)
    exact = reference_motion(**groups)
    assert exact.status == STATUS["periodic"]
    for n in (500, 4000):
        found = stepped_motion(**groups, steps_per_period=n)
        assert abs(found.velocity - exact.velocity) < max(2.0 * found.error, 1e-9)
        assert found.error < 20.0 / n


# --- laws


def test_planar_motion_is_that_in_space_without_anything_across() -> None:
    for name in MEAN_VELOCITIES:
        groups, _ = worked(name)
        planar = planar_stepped_motion(**groups, steps_per_period=500)
        across = {"drive_number_across": 0.0, "gravity_number_across": 0.0}
        for scene in ({}, {"rolling": 2.0}, {"wall": True}, {"wall": True, "rolling": 2.0}):
            found = stepped_motion(**groups, **across, **scene, steps_per_period=500)
            # To the rounding of 200 periods; an event that rounding moves is moved a whole step.
            np.testing.assert_allclose(found.velocity, planar.velocity, atol=1e-10)
            assert found.status == planar.status


def test_the_mirror_image_moves_the_same_way() -> None:
    groups = spatial(wall=False, gravity_number_across=0.0, curvature_number=0.0)
    mirrored = {**groups, "drive_number_across": -groups["drive_number_across"]}
    phases = np.linspace(0.0, 20.0, 101)
    for rolling in (0.0, 2.0):
        one = stepped_path(phases=phases, rolling=rolling, **groups)
        two = stepped_path(phases=phases, rolling=rolling, **mirrored)
        np.testing.assert_array_equal(one.position[:, 0], two.position[:, 0])
        np.testing.assert_array_equal(one.position[:, 1], -two.position[:, 1])


def test_groups_and_arrays_decide() -> None:
    # (A0, w) and (A0/4, 2w) have the same groups: nothing else goes in. Cells do not mix.
    groups, _ = worked("hop")
    drives = np.array([[0.5], [1.0]]) * groups["drive_number_along"]
    several = planar_stepped_motion(
        **{**groups, "drive_number_along": drives, "friction_kinetic": np.array([0.3, 0.35, 0.4])}
    )
    assert several.velocity.shape == several.status.shape == (2, 3)
    single = planar_stepped_motion(
        **{**groups, "drive_number_along": drives[1, 0], "friction_kinetic": 0.35}
    )
    assert several.velocity[1, 1] == single.velocity


def test_energy_is_never_created_without_a_drive() -> None:
    groups = {
        **spatial(restitution=0.8, wall_restitution=0.7, wall=True, friction_static=0.2,
                  friction_kinetic=0.2, curvature_number=0.0),
        **NO_DRIVE,
    }  # fmt: skip
    gravity = np.array([groups[f"gravity_number_{n}"] for n in ("along", "across", "normal")])
    # At the ends of steps: within the step of an impact the velocity passes through zero.
    found = stepped_path(
        phases=np.arange(20000) * (2.0 * math.pi / 4000.0), steps_per_period=4000,
        position=(0.0, 0.5, 1.0), velocity=(1.0, -0.7, 0.2), **groups,
    )  # fmt: skip
    energy = 0.5 * (found.velocity**2).sum(axis=1) + found.position @ gravity
    # In the step of an impact the weight acts on the mean of both velocities: step times speed.
    step = 2.0 * math.pi / 4000.0
    assert np.max(np.diff(energy)) < step * 2.0
    assert energy[-1] < 0.2 * energy[0]
    # Contacts close when the middle of a step is beyond: half a step of the fastest approach.
    assert found.position[:, 1:].min() > -step * 2.0


def test_an_elastic_hop_keeps_its_energy() -> None:
    groups = {
        **NO_DRIVE, "gravity_number_along": 0.0, "gravity_number_across": 0.0,
        "gravity_number_normal": 1.0, "friction_static": 0.3, "friction_kinetic": 0.3,
        "restitution": 1.0,
    }  # fmt: skip
    found = stepped_path(phases=np.linspace(0.0, 60.0, 601), position=(0.0, 0.0, 1.0), **groups)
    energy = 0.5 * found.velocity[:, 2] ** 2 + found.position[:, 2]
    # The midpoint rule is exact in flight; an impact turns the velocity where it is found.
    np.testing.assert_allclose(energy, 1.0, atol=2.0 * 2.0 * math.pi / 1000.0)


def test_friction_stays_in_its_disc() -> None:
    groups = spatial(wall=False, drive_number_normal=0.5, curvature_number=0.0)
    n = 2000
    phases = np.arange(0, 4 * n) * (2.0 * math.pi / n)
    for rolling in (0.0, 2.0):
        found = stepped_path(phases=phases, steps_per_period=n, rolling=rolling, **groups)
        middle = phases[:-1] + math.pi / n
        drive = np.stack(
            [groups[f"drive_number_{k}"] * np.sin(middle) for k in ("along", "across")]
        )
        pull = np.array([[groups["gravity_number_along"]], [groups["gravity_number_across"]]])
        force = np.diff(found.velocity[:, :2], axis=0).T * n / (2.0 * math.pi) - drive + pull
        normal = groups["gravity_number_normal"] - groups["drive_number_normal"] * np.sin(middle)
        # Rounding of the difference quotient, and half a step's drive where a slip begins.
        assert np.all(np.hypot(*force) <= 0.4 * normal + 2e-3)


def test_a_wedge_of_friction_on_floor_and_wall_holds_and_yields() -> None:
    # Theory 4.4: a part at rest in the corner holds up to mu_s n + mu_w s.
    lean, static, wall_friction = 0.1, 0.3, 0.4
    level = math.sqrt(1.0 - lean**2)
    held = static * level + wall_friction * lean
    for pull, moves in ((0.999 * held, False), (1.001 * held, True)):
        found = stepped_motion(
            **NO_DRIVE, gravity_number_along=-pull, gravity_number_across=lean,
            gravity_number_normal=level, friction_static=static, friction_kinetic=static,
            wall_friction=wall_friction, wall=True,
        )  # fmt: skip
        assert found.status == STATUS["runaway" if moves else "at_rest"]
        if not moves:
            assert found.velocity == 0.0
            assert found.stick == 1.0


def test_statuses() -> None:
    groups, _ = worked("hop")
    steep = planar_stepped_motion(**{**groups, "gravity_number_along": -0.8})
    assert steep.status == STATUS["runaway"]
    assert np.isnan(steep.velocity)
    smooth = planar_stepped_motion(**{**groups, "friction_static": 0.0, "friction_kinetic": 0.0})
    assert smooth.status == STATUS["neutral"]
    # From rest at phase 0: u = p (1 - cos tau), mean p; the midpoint rule is off by h^2/24.
    assert smooth.velocity == pytest.approx(groups["drive_number_along"], rel=1e-6)
    for value in (math.nan, math.inf):
        broken = planar_stepped_motion(**{**groups, "drive_number_along": value})
        assert broken.status == STATUS["no_solution"]
        assert np.isnan(broken.velocity)
    chaos = planar_stepped_motion(**{**groups, "drive_number_normal": 5.0, "restitution": 0.6})
    assert chaos.status == STATUS["aperiodic"]
    assert 0.0 < chaos.spread <= chaos.error


def test_what_is_refused() -> None:
    groups, _ = worked("hop")
    with pytest.raises(ValueError, match="at least 8"):
        planar_stepped_motion(**groups, steps_per_period=4)
    with pytest.raises(ValueError, match="the limit is"):
        planar_stepped_motion(**groups, steps_per_period=10**8)
    across = {"drive_number_across": 0.0, "gravity_number_across": 0.0}
    for phases in ([0.0, math.nan], [1.0, 0.0], []):
        with pytest.raises(ValueError, match="phases"):
            stepped_path(**groups, **across, phases=phases)
    with pytest.raises(ValueError, match="limit"):
        stepped_path(**groups, **across, phases=[0.0, 1e12])


def test_the_module_loads_no_compiler() -> None:
    code = "import sys, vibrafeed.core.motion.methods.stepping; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
