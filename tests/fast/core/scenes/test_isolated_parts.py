"""Isolated parts: worked values, limits, and motion that agrees with what it was made of."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.known_answers import answer
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.sweep.kind import prepare
from vibrafeed.core.sweep.slice import compute_slice, prepare_cut

SQUARE = {"height": 1.0, "length": 1.0}
OF_A_CYLINDER = answer("V-limiting-friction-2")


def run(scene: str, outputs: list[str], variant: str = "derived", **parameters: object):
    content = {"kind": "sweep", "scene": scene, "variant": variant, "outputs": outputs}
    return run_study(parse_study({**content, "parameters": parameters}))


def regime(dataset) -> str:
    return next(name for name, r in REGIMES.items() if r.value == int(dataset["regime"]))


def test_a_square_on_its_corner_by_15_degrees_has_a_diagonal_at_60():
    dataset = run("rectangle-isolated", ["diagonal_angle"], **SQUARE, pitch=15)
    assert float(dataset["diagonal_angle"]) == pytest.approx(60, abs=1e-13)


def test_the_least_limiting_friction_of_every_rectangle_is_four_thirds():
    outputs = ["least_limiting_friction", "least_limiting_pitch"]
    dataset = run("rectangle-isolated", outputs, height=[0.01, 1, 2, 300], length=1.0)
    assert float(dataset["least_limiting_friction"]) == 4 / 3
    # At a corner angle of atan 2 the least limit is that of the part lying flat.
    assert float(dataset["least_limiting_pitch"].sel(height=2)) == pytest.approx(0, abs=1e-13)
    assert float(dataset["least_limiting_pitch"].sel(height=1)) == pytest.approx(
        math.degrees(math.atan(2)) - 45, rel=1e-14
    )


@pytest.mark.parametrize(
    ("ratio", "printed", "tolerance"),
    [
        (2, OF_A_CYLINDER.value, OF_A_CYLINDER.tolerance),
        (1, 1.2276, 5e-5),
        (1.29846, 1.2, 5e-7),
        (1.25, 1.2039, 5e-5),
        (1e-9, 4 / 3, 1e-15),
        (1e9, math.sqrt(5) / 2, 1e-15),
    ],
)
def test_the_least_limiting_friction_of_a_cylinder_depends_on_its_shape(ratio, printed, tolerance):
    dataset = run("cylinder-isolated", ["least_limiting_friction"], diameter=ratio, length=1.0)
    assert float(dataset["least_limiting_friction"]) == pytest.approx(printed, abs=tolerance, rel=0)


def test_left_slip_is_the_mirror_image_of_right_slip():
    outputs = ["limiting_friction_right", "limiting_friction_left"]
    one = run("rectangle-isolated", outputs, **SQUARE, pitch=[0, 15, 44, 46])
    other = run("rectangle-isolated", outputs, **SQUARE, pitch=[90, 75, 46])  # s to 180 deg - s
    assert np.isinf(one["limiting_friction_left"]).values.tolist() == [True, True, True, False]
    right = one["limiting_friction_right"].values
    np.testing.assert_allclose(other["limiting_friction_left"].values, right[:3], rtol=1e-12)
    assert right[3] == np.inf
    assert np.isinf(other["limiting_friction_right"]).all()


@pytest.mark.parametrize(
    ("friction", "pitch_rate", "velocity", "expected"),
    [
        (0.3, 0, 0.1, "sliding"),
        (0.3, 20, 20, "separation"),
        (2.0, 0, 0.1, "no_solution"),
        (2.0, 20, 20, "two_solutions"),
        (2.0, 20, -20, "separation"),  # to the left there is one solution at every friction
        (2.0, 0, -0.1, "sliding"),
    ],
)
def test_each_case_of_a_slipping_corner_is_told(friction, pitch_rate, velocity, expected):
    outputs = ["floor_acceleration", "gap_normal_acceleration", "free_normal_acceleration"]
    dataset = run(
        "rectangle-isolated", outputs, **SQUARE, pitch=15, friction=friction,
        pitch_rate=pitch_rate, velocity_along=velocity,
    )  # fmt: skip
    assert regime(dataset) == expected
    force = float(dataset["floor_acceleration"])
    assert {
        "sliding": force > 0, "two_solutions": force > 0, "separation": force == 0,
        "no_solution": math.isnan(force),
    }[expected]  # fmt: skip
    free = float(dataset["free_normal_acceleration"])
    gap = float(dataset["gap_normal_acceleration"])
    assert gap == free if expected == "separation" else not gap > 0


def test_a_pitch_at_which_another_corner_is_lower_is_told():
    at = run("rectangle-isolated", ["floor_force"], **SQUARE, mass=1, friction=0.3,
             pitch=[-1, 0, 45, 90, 91])  # fmt: skip
    told = at["regime"] == REGIMES["invalid_geometry"].value
    assert told.values.tolist() == [True, False, False, False, True]


def test_a_corner_at_rest_is_held_slips_or_leaves():
    def at(**parameters):
        outputs = ["slip_direction", "floor_acceleration", "gap_tangential_acceleration"]
        return run("rectangle-isolated", outputs, **SQUARE, **{"pitch": 15, **parameters})

    assert regime(at(friction=1.0)) == "stick"
    slips = at(friction=0.1)
    assert regime(slips) == "sliding"
    # The centre falls on the left of the corner, which is driven to the right.
    assert float(slips["slip_direction"]) == 1
    assert float(slips["gap_tangential_acceleration"]) > 0
    assert float(at(friction=0.1, pitch=75)["slip_direction"]) == -1
    assert regime(at(friction=0.1, pitch_rate=20)) == "separation"


@pytest.mark.parametrize("scene", ["rectangle-isolated", "cylinder-isolated"])
@pytest.mark.parametrize("velocity", [None, 3.0, -3.0])
@pytest.mark.parametrize("friction", [0.1, 0.9])
def test_the_motion_of_the_corner_is_that_of_centre_and_pitch(scene, velocity, friction):
    across = "height" if scene.startswith("rect") else "diameter"
    parameters = {
        across: 0.02, "length": 0.03, "pitch": list(range(-20, 60, 7)), "friction": friction,
        "pitch_rate": 12.0,
    }  # fmt: skip
    if velocity is not None:
        parameters["velocity_along"] = velocity
    outputs = [
        "acceleration_along", "acceleration_upward", "pitch_acceleration", "floor_acceleration",
        "gap_normal_acceleration", "gap_tangential_acceleration", "slip_direction",
        "half_diagonal", "diagonal_angle", "inertia_ratio",
    ]  # fmt: skip
    at = run(scene, outputs, **parameters)
    s, rho, turn = np.deg2rad(at["diagonal_angle"]), at["half_diagonal"], 12.0
    x, y, xi = at["acceleration_along"], at["acceleration_upward"], at["pitch_acceleration"]
    normal = y - rho * xi * np.cos(s) + rho * turn**2 * np.sin(s)
    tangential = x - rho * xi * np.sin(s) - rho * turn**2 * np.cos(s)
    size = 1e-12 * (abs(x) + abs(y) + rho * turn**2 + 10)
    assert (abs(normal - at["gap_normal_acceleration"]) <= size).all()
    assert (abs(tangential - at["gap_tangential_acceleration"]) <= size).all()
    force = at["floor_acceleration"]
    assert (abs(y + at["gravity"] - force) <= size).all()
    turned = -at["inertia_ratio"] * (force * np.cos(s) + x * np.sin(s)) / rho
    assert (abs(turned - xi) <= size / rho).all()
    slides = at["slip_direction"] != 0
    assert (abs(x + at["slip_direction"] * friction * force) <= size).where(slides, True).all()


@pytest.mark.parametrize("scene", ["rectangle-isolated", "cylinder-isolated"])
def test_only_the_printed_slip_acceleration_differs(scene):
    across = "height" if scene.startswith("rect") else "diameter"
    parameters = {across: 0.02, "length": 0.03, "pitch": 10, "friction": 0.3, "velocity_along": 1}
    outputs = [
        "floor_acceleration", "gap_tangential_acceleration", "acceleration_along",
        "pitch_acceleration", "gap_normal_acceleration", "diagonal_angle", "inertia_ratio",
    ]  # fmt: skip
    printed, derived = (run(scene, outputs, v, **parameters) for v in ("thesis", "derived"))
    for name in set(outputs) - {"gap_tangential_acceleration"}:
        assert float(printed[name]) == float(derived[name])
    excess = printed["gap_tangential_acceleration"] - derived["gap_tangential_acceleration"]
    s = np.deg2rad(float(derived["diagonal_angle"]))
    more = 2.0 if scene.startswith("rect") else 2 - float(derived["inertia_ratio"]) * np.cos(2 * s)
    assert float(excess) == pytest.approx(0.3 * more * float(derived["floor_acceleration"]))


def test_an_impulse_without_collision_stops_the_corner():
    outputs = [
        "impact_impulse_normal", "impact_impulse_tangential", "inertia_ratio", "diagonal_angle",
        "gap_tangential_rate", "normal_response",
    ]  # fmt: skip
    for friction in (2.0, 5.0):
        at = run(
            "cylinder-isolated", outputs, diameter=0.02, length=0.03, mass=0.1, pitch=25,
            velocity_along=0.7, friction=friction,
        )  # fmt: skip
        assert regime(at) == "no_solution"
        kappa, s = float(at["inertia_ratio"]), math.radians(float(at["diagonal_angle"]))
        slip = float(at["gap_tangential_rate"])
        normal_normal = (1 + kappa * math.cos(s) ** 2) / 0.1
        normal_tangential = kappa * math.sin(s) * math.cos(s) / 0.1
        tangential_tangential = (1 + kappa * math.sin(s) ** 2) / 0.1
        # Slip to its end, then compression to its end with a corner at rest.
        tau = float(at["normal_response"]) / 0.1
        first = slip / (friction * tangential_tangential - normal_tangential)
        rest = normal_normal - normal_tangential**2 / tangential_tangential
        last = first - tau * first / rest
        tangential = -friction * first - normal_tangential / tangential_tangential * (last - first)
        assert float(at["impact_impulse_normal"]) == pytest.approx(last, rel=1e-13)
        assert float(at["impact_impulse_tangential"]) == pytest.approx(tangential, rel=1e-13)
    calm = run(
        "cylinder-isolated", outputs[:2], diameter=0.02, length=0.03, mass=0.1, pitch=25,
        velocity_along=0.7, friction=0.5,
    )  # fmt: skip
    assert float(calm["impact_impulse_normal"]) == 0


def test_gaps_and_rates_come_from_the_state_of_the_centre():
    outputs = [
        "gap_normal", "gap_tangential", "gap_normal_rate", "gap_tangential_rate",
        "touching_height", "pivot_velocity_along", "pivot_velocity_upward",
    ]  # fmt: skip
    at = run(
        "rectangle-isolated", outputs, height=0.03, length=0.04, pitch=0, pitch_rate=2,
        centre_along=0.1, centre_height=0.02, velocity_along=0.5, velocity_upward=0.25,
    )  # fmt: skip
    expected = (0.005, 0.12, 0.21, 0.47, 0.015, 0.03, 0.04)
    for name, value in zip(outputs, expected, strict=True):
        assert float(at[name]) == pytest.approx(value, rel=1e-14), name


def test_a_gap_asks_for_the_height_that_it_is_made_of():
    with pytest.raises(StudyError) as caught:
        run("rectangle-isolated", ["gap_normal", "gap_normal_rate"], **SQUARE, pitch=0)
    places = {problem.place for problem in caught.value.problems}
    assert places == {"parameters.centre_height", "parameters.velocity_upward"}


@pytest.mark.parametrize(
    ("written", "read"), [("90 deg/s", math.pi / 2), ("30 rpm", math.pi), ("2 rad/s", 2.0), (3, 3)]
)
def test_a_pitch_rate_has_units_of_its_own(written, read):
    at = run("rectangle-isolated", ["pivot_velocity_upward"], height=3.0, length=4.0, pitch=0,
             pitch_rate=written)  # fmt: skip
    assert float(at["pivot_velocity_upward"]) == pytest.approx(2 * read, rel=1e-14)


def test_an_angle_among_the_outputs_is_in_degrees_in_a_slice_too():
    content = {
        "kind": "sweep", "scene": "rectangle-isolated", "outputs": ["diagonal_angle"],
        "parameters": {**SQUARE, "pitch": [0, 15, 30]},
    }  # fmt: skip
    sweep = prepare(parse_study(content))
    found = compute_slice(
        prepare_cut(sweep, output="diagonal_angle", axes=["pitch"], at={}, most=10)
    )
    np.testing.assert_allclose(found["values"]["data"], [45, 60, 75], rtol=1e-15)
    assert found["unit"] == "degree"


def test_an_output_with_a_default_asks_for_its_parameters():
    with pytest.raises(StudyError) as caught:
        run("rectangle-on-track", ["centripetal_acceleration"], "physical")
    assert {p.place for p in caught.value.problems} == {"parameters.radius"}
