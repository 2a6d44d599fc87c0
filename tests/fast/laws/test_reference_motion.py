"""The reference method against exact solutions and worked values, to many digits."""

import math
from typing import Any

import numpy as np
import pytest

from benchmarks.motions import reference_motion, reference_path
from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.motion.method import STATUS

NO_DRIVE: dict[str, Any] = {
    "drive_number_along": 0.0, "drive_number_across": 0.0, "drive_number_normal": 0.0
}  # fmt: skip


@pytest.mark.parametrize("name", MEAN_VELOCITIES)
def test_worked_mean_velocities(name: str) -> None:
    case = MEAN_VELOCITIES[name]
    found = reference_motion(**case.groups())
    assert (found.status, found.multiple) == (STATUS["periodic"], 1)
    assert float(found.velocity) == pytest.approx(case.scaled, rel=1e-8)
    shares = found.stick + found.forward + found.backward + found.flight
    # Slips that are begun by quadrature start within 1e-3 of a phase; all phases are counted.
    assert shares == pytest.approx(1.0, abs=1e-9)


def test_disc_on_an_incline() -> None:
    gamma, friction, speed, psi = math.radians(20.0), 0.6, 2.0, math.radians(70.0)
    pull, nu = math.sin(gamma), friction / math.tan(gamma)
    t, c = math.tan(psi / 2.0), speed * math.sin(psi) / math.tan(psi / 2.0) ** nu
    down = c * c / (4.0 * pull) * (
        t ** (2.0 * nu - 2.0) / (2.0 * nu - 2.0) - t ** (2.0 * nu + 2.0) / (2.0 * nu + 2.0)
    )  # fmt: skip
    cross = c * c / (2.0 * pull) * (
        t ** (2.0 * nu - 1.0) / (2.0 * nu - 1.0) + t ** (2.0 * nu + 1.0) / (2.0 * nu + 1.0)
    )  # fmt: skip
    stop = speed * (nu + math.cos(psi)) / (pull * (nu * nu - 1.0))
    found = reference_path(
        phases=[0.0, stop - 1e-3, stop + 1e-3, stop + 5.0], **NO_DRIVE,
        gravity_number_along=math.sin(gamma), gravity_number_across=0.0,
        gravity_number_normal=math.cos(gamma), friction_static=friction, friction_kinetic=friction,
        velocity=(-speed * math.cos(psi), speed * math.sin(psi), 0.0),
    )  # fmt: skip
    np.testing.assert_allclose(found.position[-1], [-down, cross, 0.0], atol=1e-10)
    assert np.hypot(*found.velocity[1, :2]) > 0.0  # it stops when it should
    np.testing.assert_array_equal(found.velocity[2:], 0.0)


@pytest.mark.parametrize("rolling", [0.0, 2.0])
def test_curved_chute(rolling: float) -> None:
    gamma, delta, friction, curvature = math.radians(-25.0), math.radians(8.0), 0.2, 0.05
    pull = -math.sin(gamma) - friction * math.cos(gamma) * (math.cos(delta) + math.sin(delta))
    phases = np.array([0.0, 1e-4, 1.0, 5.0, 20.0, 40.0])
    u = phases * math.sqrt(friction * pull * curvature)
    found = reference_path(
        phases=phases, **NO_DRIVE, gravity_number_along=math.sin(gamma),
        gravity_number_across=math.cos(gamma) * math.sin(delta),
        gravity_number_normal=math.cos(gamma) * math.cos(delta), friction_static=friction,
        friction_kinetic=friction, wall_friction=friction, curvature_number=curvature, wall=True,
        rolling=rolling,
    )  # fmt: skip
    speed = math.sqrt(pull / (friction * curvature)) * np.tanh(u)
    np.testing.assert_allclose(found.velocity[:, 0], speed, atol=1e-9)
    np.testing.assert_allclose(
        found.position[:, 0], np.log(np.cosh(u)) / (friction * curvature), atol=1e-9
    )


def test_a_cylinder_slips_where_rolling_needs_more() -> None:
    # Along x and y at once: the secular equation of theory 7.3 gives constant accelerations.
    along, across, q = 0.5, 0.9, 0.2
    found = reference_path(
        phases=[0.0, 2.0], **NO_DRIVE, gravity_number_along=-along, gravity_number_across=-across,
        gravity_number_normal=1.0, friction_static=q, friction_kinetic=q, rolling=2.0,
    )  # fmt: skip
    ax, ay = found.velocity[-1, 0] / 2.0, found.velocity[-1, 1] / 2.0
    fx, fy = ax - along, ay - across
    assert math.hypot(fx, fy) == pytest.approx(q, rel=1e-9)
    # The contact slips with (u_x, u_y + spin) = (ax, across + 3 fy) t, against the friction.
    assert fx * (across + 3.0 * fy) == pytest.approx(fy * ax, abs=1e-9)


def test_bounces_in_closed_form() -> None:
    # Height 1 over a level floor: landing at sqrt(2), hops of 2 eps^k sqrt(2), all done after
    # sqrt(2) (1 + eps)/(1 - eps), where the run of hops ends though there is no end of them.
    restitution = 0.5
    landing = math.sqrt(2.0)
    end = landing * (1.0 + restitution) / (1.0 - restitution)
    found = reference_path(
        phases=[0.0, landing * 1.5, end - 1e-6, end + 1e-6], position=(0.0, 0.0, 1.0), **NO_DRIVE,
        gravity_number_along=0.0, gravity_number_across=0.0, gravity_number_normal=1.0,
        friction_static=0.3, friction_kinetic=0.3, restitution=restitution,
    )  # fmt: skip
    # Half a phase sqrt(2) into the first hop it is at its top, at eps^2.
    assert found.position[1, 2] == pytest.approx(restitution**2, abs=1e-11)
    assert found.velocity[1, 2] == pytest.approx(0.0, abs=1e-11)
    assert found.position[3, 2] == 0.0


@pytest.mark.parametrize(
    ("drive", "status"),
    [
        ({"drive_number_along": 0.3, "drive_number_normal": 0.0}, "at_rest"),
        ({"drive_number_along": 3.0, "drive_number_normal": 5.0, "restitution": 0.6,
          "max_periods": 12}, "aperiodic"),
        ({"drive_number_along": 1.0, "drive_number_normal": 1.5, "friction_static": 0.0,
          "friction_kinetic": 0.0}, "neutral"),
    ],
)  # fmt: skip
def test_statuses(drive: dict[str, float], status: str) -> None:
    level = {"gravity_number_along": 0.0, "gravity_number_normal": 1.0, "friction_static": 0.4,
             "friction_kinetic": 0.4}  # fmt: skip
    found = reference_motion(**{**level, **drive})
    assert found.status == STATUS[status]
    assert (found.velocity == 0.0) == (status == "at_rest")
    assert (found.spread > 0.0) == (status == "aperiodic")
    if status == "neutral":  # the speed is that of the start
        assert abs(float(found.velocity) - 1.0) <= float(found.error) < 1e-11


HOPS = ("drive_number_along", "drive_number_across", "drive_number_normal", "gravity_number_along",
        "gravity_number_across", "gravity_number_normal", "friction", "restitution",
        "curvature_number")  # fmt: skip


@pytest.mark.parametrize(
    "numbers",
    [
        # A landing within the rounding of another event, which the integrator does not see.
        (1.0298, 0.3126, 1.976, 0.0345, 0.3095, 0.9503, 0.8728, 0.1115, 0.0085),
        # The slip along the wall stops amid the last hops on the floor.
        (0.6236, 0.3571, 1.7582, -0.0764, 0.2627, 0.9618, 0.7042, 0.244, 0.0163),
    ],
)
def test_hops_at_the_wall_end_on_the_floor(numbers: tuple[float, ...]) -> None:
    groups = dict(zip(HOPS, numbers, strict=True))
    friction, groups["wall_restitution"] = groups.pop("friction"), groups["restitution"]
    names = ("friction_static", "friction_kinetic", "wall_friction")
    groups |= dict.fromkeys(names, friction) | {"wall": True}
    exact = reference_path(phases=np.linspace(0.0, 4.0 * math.pi, 65), **groups)
    assert exact.position[:, 1:].min() >= -1e-9  # neither through the floor nor through the wall
