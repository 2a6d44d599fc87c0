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


def test_the_least_limiting_friction_of_every_rectangle_is_four_thirds():
    outputs = ["least_limiting_friction", "least_limiting_pitch"]
    dataset = run("rectangle-isolated", outputs, height=[0.01, 1, 2, 300], length=1.0)
    assert float(dataset["least_limiting_friction"]) == 4 / 3
    # At a corner angle of atan 2 the least limit is that of the part lying flat.
    expected = [math.degrees(math.atan(2)) - 45, 0]
    found = dataset["least_limiting_pitch"].sel(height=[1, 2])
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-13)


@pytest.mark.parametrize(
    ("friction", "pitch_rate", "velocity", "expected"),
    [
        (0.3, 0, 0.1, "sliding"),
        (0.3, 20, 20, "separation"),
        (2.0, 0, 0.1, "no_solution"),
        (2.0, 20, 20, "two_solutions"),
        (2.0, 20, -20, "separation"),  # to the left there is one solution at every friction
        (2.0, 0, -0.1, "sliding"),
        (1.0, 0, None, "stick"),
        (0.1, 0, None, "sliding"),
        (0.1, 20, None, "separation"),
    ],
)
def test_each_case_of_a_corner_is_told(friction, pitch_rate, velocity, expected):
    outputs = ["floor_acceleration", "gap_normal_acceleration", "free_normal_acceleration"]
    slips = {} if velocity is None else {"velocity_along": velocity}
    dataset = run(
        "rectangle-isolated", outputs, **SQUARE, pitch=15, friction=friction,
        pitch_rate=pitch_rate, **slips,
    )  # fmt: skip
    assert int(dataset["regime"]) == REGIMES[expected].value
    force, gap, free = (float(dataset[name]) for name in outputs)
    assert math.isnan(force) if expected == "no_solution" else force >= 0
    assert (force == 0) == (expected == "separation")
    assert gap == free if expected == "separation" else not gap > 0


def test_a_corner_at_rest_slips_away_from_the_centre():
    # The centre falls on the left of the corner, which is driven to the right; and the mirror.
    outputs = ["slip_direction"]
    found = run("rectangle-isolated", outputs, **SQUARE, friction=0.1, pitch=[15, 75])
    assert found["slip_direction"].values.tolist() == [1, -1]


@pytest.mark.parametrize(
    ("scene", "variant", "outputs", "given", "places"),
    [
        ("rectangle-isolated", "derived", ["gap_normal", "gap_normal_rate"], {**SQUARE, "pitch": 0},
         {"parameters.centre_height", "parameters.velocity_upward"}),
        ("rectangle-on-track", "physical", ["centripetal_acceleration"], {}, {"parameters.radius"}),
    ],
)  # fmt: skip
def test_an_output_asks_for_what_it_is_made_of(scene, variant, outputs, given, places):
    with pytest.raises(StudyError) as caught:
        run(scene, outputs, variant, **given)
    assert {problem.place for problem in caught.value.problems} == places


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


def test_a_pitch_at_which_another_corner_is_lower_is_told():
    at = run("rectangle-isolated", ["floor_force"], **SQUARE, mass=1, friction=0.3,
             pitch=[-1, 0, 45, 90, 91])  # fmt: skip
    told = at["regime"] == REGIMES["invalid_geometry"].value
    assert told.values.tolist() == [True, False, False, False, True]


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
