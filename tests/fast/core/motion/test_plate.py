"""A part on a plate: where it goes, at which speed, and what turns it."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion import plate
from vibrafeed.core.motion.method import Contacts, Groups
from vibrafeed.core.motion.waves import Wave, bound
from vibrafeed.core.quantities import MOTION_STATUSES

STATUS = {name: flag.value for name, flag in MOTION_STATUSES.items()}
VELOCITY = ("velocity_x", "velocity_y")
CIRCLE = {
    "frequency": 50, "friction": 0.3, "amplitude_along_1": "0.1 mm", "phase_along_1": 90,
    "amplitude_across_1": "0.1 mm",
}  # fmt: skip
BOUNCE = {"amplitude_normal_1": "0.05 mm", "phase_normal_1": 20}


def on_plate(*outputs: str, **given):
    return vibrafeed.simulate(scene="part-on-plate", outputs=list(outputs or VELOCITY), **given)


def velocity(found):
    return np.array([found.velocity_x.values, found.velocity_y.values])


def groups(harmonics, slope=(0.0, 0.0), restitution=0.0) -> Groups:
    wave = Wave(np.asarray(harmonics), np.zeros((4, 0)))
    along, across, normal = (float(bound(wave, axis)) for axis in range(3))
    return Groups(along, normal, slope[0], 1.0, 0.3, 0.25, restitution, across, slope[1], wave=wave)


def follow(part: Groups):
    """Return the velocity, shape (2,), in g/w."""
    chosen = plate.METHODS["events"]
    settings = {name: np.asarray(value) for name, value in chosen.defaults.items()}
    motion = chosen.follow(groups=part, contacts=Contacts(), **settings)
    return np.array([motion.velocity, motion.across])


def turn(vector, angle):
    c, s = np.cos(angle), np.sin(angle)
    x, y = vector[:2]
    return np.array([c * x - s * y, s * x + c * y])


@pytest.mark.parametrize("restitution", [0.0, 0.4])
def test_a_turned_drive_turns_the_velocity(restitution):
    rng = np.random.default_rng(62)
    for angle in rng.uniform(0, 2 * np.pi, 3):
        pushes = rng.uniform(-1, 1, (3, 2, 2)) * np.array([1.0, 1.0, 0.4])[:, None, None]
        slope = rng.uniform(-0.02, 0.02, 2)
        turned = pushes.copy()
        turned[:2] = turn(pushes, angle)
        here = follow(groups(pushes, slope, restitution))
        there = follow(groups(turned, turn(slope, angle), restitution))
        assert np.abs(there - turn(here, angle)).max() < 1e-11


@pytest.mark.parametrize("azimuth", [0, 30, 90, 135, -120])
def test_a_straight_line_is_the_plane_scene(azimuth):
    sine = {"frequency": 50, "amplitude": "0.3 mm", "beta": 30, "friction": 0.3}
    plane = vibrafeed.simulate(
        scene="rectangle-on-plane", outputs=["conveying_velocity", "flight_fraction"], **sine
    )
    found = on_plate(
        "travel_speed", "travel_direction", "flight_fraction", "slip_fraction", "stick_fraction",
        alpha=azimuth, **sine,
    )  # fmt: skip
    assert float(found.travel_speed) == pytest.approx(float(plane.conveying_velocity), rel=1e-11)
    assert float(found.travel_direction) == pytest.approx(azimuth, abs=1e-9)
    assert float(found.flight_fraction) == pytest.approx(float(plane.flight_fraction), rel=1e-11)
    shares = found.flight_fraction + found.slip_fraction + found.stick_fraction
    assert float(shares) == pytest.approx(1.0, rel=1e-12)


def test_a_bounce_at_twice_the_frequency_conveys_nothing_on_the_level():
    found = on_plate(
        "travel_speed", "travel_direction", frequency=50, friction=0.3, amplitude_along_1="0.2 mm",
        amplitude_normal_2="0.01 mm", phase_normal_2=90,
    )  # fmt: skip
    assert float(found.travel_speed) < 1e-12
    assert np.isnan(found.travel_direction)


def test_a_part_slides_down_a_plate_that_slopes_in_any_direction():
    down = on_plate("travel_direction", **CIRCLE, gamma=[0, 2], delta=[0, 2]).travel_direction
    along, across = float(down.sel(gamma=2, delta=0)), float(down.sel(gamma=0, delta=2))
    assert (across - along) % 360 == pytest.approx(90, abs=1e-6)  # as both slopes are apart
    assert abs(along % 360 - 180) < 45  # friction, which lags behind the circle, turns it


def test_towards_is_the_component_of_the_velocity():
    given = {**CIRCLE, **BOUNCE, "target_direction": [0, 45, 90]}
    found = on_plate(*VELOCITY, "velocity_towards", **given)
    x, y = velocity(found)
    assert found.velocity_towards.values == pytest.approx([x, (x + y) / np.sqrt(2), y], rel=1e-12)


def test_a_trajectory_is_a_path_in_the_plane():
    found = on_plate(*VELOCITY, **CIRCLE, **BOUNCE, trajectory=50)
    seconds = float(found.cycle_time[-1])
    for along, name in zip(VELOCITY, ("along", "across"), strict=True):
        moved = found[f"position_{name}"].values
        assert moved[0] == 0.0
        assert moved[-1] == pytest.approx(float(found[along]) * seconds, rel=1e-6)
        swing = found[f"track_{name}"].values
        assert np.ptp(swing) == pytest.approx(2e-4, rel=0.01)


def test_turns_belong_to_a_plate_alone():
    with pytest.raises(StudyError, match="amplitude_yaw_1 is not used"):
        vibrafeed.simulate(
            scene="rectangle-on-plane", frequency=50, friction=0.3, amplitude_along_1="0.1 mm",
            amplitude_yaw_1=0.1,
        )  # fmt: skip


def test_a_plate_has_no_wall():
    with pytest.raises(StudyError, match="wall_friction"):
        on_plate(**CIRCLE, wall_friction=0.2)


def test_a_band_of_friction_has_the_ends_of_both_components():
    found = on_plate(**CIRCLE | {"friction": {"low": 0.2, "high": 0.4}}, **BOUNCE)
    for name in VELOCITY:
        assert float(found[f"{name}_least"]) <= float(found[name]) <= float(found[f"{name}_most"])


def test_friction_too_weak_to_settle_has_a_velocity():
    given = {
        "scene": "part-on-plate", "outputs": ["velocity_x", "velocity_error"],
        "frequency": 50, "amplitude": "0.1 mm", "beta": 30, "friction": 0.002,
        "alpha": 20, "gamma": 0.02,
    }  # fmt: skip
    soon, late = (vibrafeed.simulate(**given, max_periods=n) for n in (20, 3000))
    assert int(soon.motion_status) == STATUS["weak_friction"]
    assert int(late.motion_status) == STATUS["periodic"]
    assert abs(float(soon.velocity_x - late.velocity_x)) <= float(soon.velocity_error)
    assert float(soon.velocity_error) < 0.05 * abs(float(late.velocity_x))


def test_a_hopping_part_has_no_velocity_of_weak_friction():
    found = on_plate(
        "motion_status", max_periods=20, **CIRCLE | {"friction": 1e-4}, amplitude_normal_1="0.2 mm"
    )
    assert int(found.motion_status) != STATUS["weak_friction"]


def test_friction_is_calibrated_by_speeds_on_a_plate():
    runs = {"phase_normal_1": [20, 80, 200], "target_direction": [0, 90, 45]}
    speeds = [
        float(on_plate("velocity_towards", **CIRCLE | {"friction": 0.23},
                       **BOUNCE | {"phase_normal_1": phase}, target_direction=towards)
              .velocity_towards)
        for phase, towards in zip(*runs.values(), strict=True)
    ]  # fmt: skip
    given = {name: value for name, value in {**CIRCLE, **BOUNCE}.items() if name not in runs}
    found = vibrafeed.calibrate(
        scene="part-on-plate", observations={**runs, "velocity_towards": speeds, "error": 2e-4},
        unknowns={"friction": {"lower": 0.1, "upper": 0.5}}, points=1000,
        **{name: value for name, value in given.items() if name != "friction"},
    )  # fmt: skip
    assert float(found.best_friction) == pytest.approx(0.23, abs=0.005)
    with pytest.raises(StudyError, match="rectangle-on-plane has no velocity_towards"):
        vibrafeed.calibrate(
            scene="rectangle-on-plane", observations={"velocity_towards": [0.01], "error": 1e-3},
            unknowns={"friction": {"lower": 0.1, "upper": 0.5}}, frequency=50, amplitude=2e-4,
            beta=30,
        )  # fmt: skip
