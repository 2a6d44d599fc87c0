"""Derivatives of closed forms and of motion, against differences and against laws."""

import itertools
import math

import mpmath
import numpy as np
import pytest

from night import spread
from plans import values_at
from point_slopes import motion_sensitivities, sensitivities
from vibrafeed.core.errors import StudyError
from vibrafeed.core.plan import plan as plans
from vibrafeed.core.scenes import SCENES

# --- closed forms against differences of the scenes themselves


ORDINARY = {
    "frequency": 47.0, "amplitude": 2.1e-4, "friction": 0.31, "gravity": 9.81, "alpha": 0.23,
    "beta": 0.37, "mass": 0.021, "length": 0.033, "width": 0.017, "height": 0.012,
    "diameter": 0.014, "pitch": 0.31, "pitch_rate": 1.7, "centre_height": 0.03,
    "centre_along": 0.01, "velocity_along": 0.13, "velocity_upward": -0.07, "axis_yaw": 0.21,
    "spin_rate": 2.3, "yaw_rate": 1.1, "drilling_moment": 1.3e-4,
    "position_x_1": 0.001, "position_y_1": 0.0161, "angle_1": 0.4, "length_1": 0.02,
    "width_1": 0.012, "mass_1": 0.02, "velocity_x_1": 0.1, "velocity_y_1": -0.2, "spin_1": 1.0,
    "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.1, "length_2": 0.025, "width_2": 0.011,
    "mass_2": 0.03, "velocity_x_2": -0.05, "velocity_y_2": 0.1, "spin_2": -0.7,
    "restitution": 0.4, "contact_tolerance": 0.5, "gamma": 0.05, "delta": 0.09, "yaw": 0.11,
    "distance": 0.2, "radius": 0.4, "speed": 0.3, "time": 0.012,
}  # fmt: skip


CYLINDERS = {
    "position_x_1": 0.0, "position_y_1": 0.0, "position_z_1": 0.0, "azimuth_1": 0.2,
    "elevation_1": 0.1, "diameter_1": 0.02, "length_1": 0.03, "position_x_2": 0.002,
    "position_y_2": 0.001, "position_z_2": -0.0168, "azimuth_2": 1.3, "elevation_2": -0.05,
    "diameter_2": 0.015, "length_2": 0.04, "velocity_x_1": 0.1, "velocity_y_1": 0.05,
    "velocity_z_1": -0.3, "spin_x_1": 1.0, "spin_y_1": -2.0, "spin_z_1": 0.5,
    "velocity_x_2": -0.1, "velocity_y_2": 0.02, "velocity_z_2": 0.1, "spin_x_2": 0.3,
    "spin_y_2": 0.7, "spin_z_2": -1.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("scene", "variant"),
    [
        (s, v)
        for s in (
            "rectangle-on-plane",
            "cylinder-on-plane",
            "rectangle-on-track",
            "rectangle-isolated",
            "rectangle-pair-impact",
            "cylinder-rolling",
        )
        for v in SCENES[s].variants
    ]
    + [("cylinder-pair-impact", "moreau")],
)
def test_closed_forms_against_differences(scene, variant):
    # Fourth order, step 1e-3: truncation of order 1e-12 and rounding of order 1e-13/1e-3, both
    # relative to the value's own scale, value over parameter; bends may be a hundred times that.
    outputs = [name for name in SCENES[scene].outputs(variant) if name != "regime"]
    ordinary = ORDINARY | (CYLINDERS if scene == "cylinder-pair-impact" else {})
    used = plans.scene_parameters(SCENES[scene], variant)
    point = {name: ordinary[name] for name in used if name in ordinary}
    rng = np.random.default_rng(3)
    chosen = list(rng.choice(sorted(n for n in point if point[n] != 0), 4, replace=False))
    found = sensitivities(scene, variant, outputs, point, chosen)
    at = values_at(scene, variant, outputs, point)
    compared = 0
    for parameter in chosen:
        h = 1e-3 * abs(point[parameter])
        m2, m1, p1, p2 = (
            values_at(scene, variant, outputs, point | {parameter: point[parameter] + k * h})
            for k in (-2, -1, 1, 2)
        )
        for output in outputs:
            one = found[output, parameter]
            if math.isnan(one.derivative):
                assert one.note
                continue
            expected = (8 * (p1[output] - m1[output]) - (p2[output] - m2[output])) / (12 * h)
            scale = abs(at[output] / point[parameter]) + abs(expected)
            # What is 0 up to rounding, as residuals are, has terms of order 1e-2 to 1.
            allowed = 1e-8 * scale + 1e-11
            assert one.derivative == pytest.approx(expected, abs=allowed), (output, parameter)
            compared += 1
    assert compared > len(outputs)


# --- laws


ON_TRACK = {
    "frequency": 50.0, "amplitude": 3e-4, "beta": 0.3, "gamma": 0.0, "delta": 0.0, "distance": 0.5,
}  # fmt: skip


@pytest.mark.parametrize(
    ("radius", "friction", "speed"),
    spread([*itertools.product((1e-9, 0.2, 1e9), (0.0, 1e-12, 1e-7), (0.0, 0.7))], 6),
)
def test_a_travel_time_has_its_slope_by_friction_down_to_none(radius, friction, speed):
    """The slope is the integral of -(d(v^2)/dmu)/(2 v^3) over the way, by 40 digits."""
    point = ON_TRACK | {"friction_kinetic": friction, "radius": radius, "speed": speed}
    one = sensitivities(
        "rectangle-on-track", "derived", ["travel_time"], point, ["friction_kinetic"]
    )["travel_time", "friction_kinetic"]
    with mpmath.workdps(40):
        mu, R, x, v0 = (mpmath.mpf(n) for n in (friction, radius, 0.5, speed))
        K = mpmath.mpf(3e-4 * (100 * math.pi) ** 2 * math.cos(0.3))

        def slope(root):
            """Return the integrand by the root of the way, which has no pole at rest."""
            s = 2 * mu * root**2 / R
            phi = -mpmath.expm1(-s) / s if s else mpmath.mpf(1)
            bend = (mpmath.exp(-s) - phi) / s if s else mpmath.mpf(-1) / 2
            square = v0**2 * mpmath.exp(-s) + 2 * K * root**2 * phi
            by_s = -(v0**2) * mpmath.exp(-s) + 2 * K * root**2 * bend
            return -by_s * 2 * root**2 / R / (2 * square**1.5) * 2 * root

        exact = float(mpmath.quad(slope, mpmath.linspace(0, mpmath.sqrt(x), 9)))
    assert one.derivative == pytest.approx(exact, abs=4 * one.error)
    assert one.error <= 1e-5 * abs(exact) + 1e-8


def test_a_jump_has_no_derivative():
    # The part lets go: below the limit of static friction it rests, above it slides at once.
    P, G = 1e-4 * (100 * math.pi) ** 2, 9.80665
    limit = P * math.cos(0.2) / (G - P * math.sin(0.2))
    point = {"frequency": 50.0, "amplitude": 1e-4, "beta": 0.2, "friction_kinetic": 0.2}
    near, free = (
        sensitivities(
            "rectangle-on-plane", "physical", ["acceleration_x"],
            {**point, "friction_static": static}, ["friction_static"],
        )["acceleration_x", "friction_static"]
        for static in (limit, 0.4)
    )  # fmt: skip
    assert free.derivative == 0
    # The limit itself is rounded: the tie is met, or the point lies just in slip.
    assert near.derivative == 0 or (math.isnan(near.derivative) and "jump" in near.note)


def test_a_parameter_that_plays_no_part_is_refused():
    with pytest.raises(StudyError, match="radius"):
        sensitivities(
            "rectangle-on-plane", None, ["vibration_acceleration"],
            {"frequency": 50.0, "amplitude": 1e-4}, ["radius"],
        )  # fmt: skip


# --- simulated motion


HOPS = {"frequency": 50.0, "beta": 0.4, "friction": 0.4, "gravity": 9.81}


@pytest.mark.parametrize(
    ("more", "word"),
    [
        # At throw number 1 hops begin: one side slides, the other hops.
        ({"amplitude": 9.81 / (math.sin(0.4) * (100 * math.pi) ** 2)}, ""),
        ({"amplitude": 2.1e-3, "beta": 0.5, "restitution": 0.6}, "aperiodic"),
    ],
)
def test_motion_at_the_edge_of_its_regime_or_aperiodic_has_no_derivative(more, word):
    one = motion_sensitivities(
        "rectangle-on-plane", None, ["conveying_velocity"], HOPS | more, ["amplitude"]
    )["conveying_velocity", "amplitude"]
    assert math.isnan(one.derivative)
    assert one.note
    assert word in one.note
