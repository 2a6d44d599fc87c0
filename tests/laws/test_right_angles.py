"""Whole multiples of 90 degrees are exact: no part rolls, slips or flies for a rounded pi."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from plans import make_plan
from precise import CONTEXT, exact_values
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.mechanics.arrays import cosine, radians, sine
from vibrafeed.core.mechanics.floor import vibration_acceleration
from vibrafeed.core.motion import scales
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import scene_parameters
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.scenes import SCENES, instead_of

TURNS = range(-8, 9)
COSINES, SINES = (1.0, 0.0, -1.0, 0.0), (0.0, 1.0, 0.0, -1.0)
PLANES = ("rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track", "cylinder-rolling")


def bits(values: object) -> bytes:
    return np.asarray(values, dtype=float).tobytes()


@pytest.mark.parametrize("k", TURNS)
@pytest.mark.parametrize("to_radians", [radians, np.deg2rad])
def test_right_angles_have_the_sines_of_school(k, to_radians):
    angle = to_radians(np.array([90.0 * k]))
    assert bits(sine(angle)) == bits([SINES[k % 4]])  # no -0.0 either
    assert bits(cosine(angle)) == bits([COSINES[k % 4]])


def test_other_angles_have_the_bits_of_numpy():
    angles = np.random.default_rng(90).uniform(-10, 10, 100_000)
    beside = [np.nextafter(k * math.pi / 2, way) for k in TURNS for way in (-9e9, 9e9) if k]
    for values in (angles, np.deg2rad(np.arange(-720, 720, 7) + 0.25), np.array(beside)):
        assert bits(sine(values)) == bits(np.sin(values))
        assert bits(cosine(values)) == bits(np.cos(values))


def test_whole_turns_go_while_an_angle_is_in_degrees():
    degrees = np.array([370.0, -350.0, 730.0, 10.0])
    assert len(set(radians(degrees))) == 1
    assert bits(radians(np.array([180.0, -180.0, 540.0, -0.0]))) == bits([np.pi, -np.pi, np.pi, 0])
    grid = Grid({}, {"azimuth_1": 450.0})
    assert float(grid.si()["azimuth_1"]) == np.pi / 2


@pytest.mark.parametrize("k", range(-2, 3))
def test_50_digits_are_exact_too(k):
    plan = make_plan(
        "rectangle-on-plane", "physical", ["drive_along", "drive_normal"],
        ["frequency", "amplitude", "alpha", "beta"],
    )  # fmt: skip
    cell = {"frequency": 50.0, "amplitude": 1e-3, "alpha": 0.0, "beta": k * np.pi / 2}
    exact = exact_values(plan, {name: np.array([value]) for name, value in cell.items()})
    P = 1e-3 * (100 * CONTEXT.pi) ** 2
    for name, share in (("drive_along", COSINES), ("drive_normal", SINES)):
        assert abs(exact[name][0] - share[k % 4] * P) < 1e-30 * P


def results(scene: str, variant: str, cell: dict[str, float]) -> dict[str, np.ndarray]:
    """Return every output of one cell, each angle as the edge hands it on."""
    plan = make_plan(scene, variant, SCENES[scene].outputs(variant), list(cell))
    known = {name: np.asarray(value) for name, value in plan.defaults.items()}
    for name, value in cell.items():
        given = np.array([value])
        known[name] = radians(given) if QUANTITIES[name].is_angle else given
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        for equation in plan.equations:
            known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    return {name: np.asarray(known[name]) for name in plan.outputs}


def given(scene: str, variant: str) -> dict[str, float]:
    random = np.random.default_rng(2004)
    names = set(scene_parameters(SCENES[scene], variant))
    names = {name for name in names if not instead_of(name)}
    return {name: float(random.uniform(0.1, 0.9)) for name in sorted(names)}


@pytest.mark.parametrize(
    ("scene", "variant", "level"),
    [
        (name, variant, level)
        for name in PLANES
        for variant in SCENES[name].variants
        for level in (False, True)
        # Oblique, the sum of two angles rounds otherwise from -180 than from 180 degrees.
        if level or name != "cylinder-rolling"
    ],
)
def test_a_turned_angle_gives_the_same_to_the_bit(scene, variant, level):
    cell = given(scene, variant)
    angles = [name for name in cell if QUANTITIES[name].is_angle]
    if level:
        cell |= dict.fromkeys(angles, 0.0)
    for name in angles:
        reduced = [results(scene, variant, cell | {name: 90.0 * k}) for k in range(4)]
        for k in TURNS:
            turned = results(scene, variant, cell | {name: 90.0 * k})
            for output, value in turned.items():
                assert bits(value) == bits(reduced[k % 4][output]), (name, 90 * k, output)


def regimes(scene: str, outputs: list[str], **parameters: object):
    """Return the result of a sweep and the name of its regime."""
    asked = {"kind": "sweep", "scene": scene, "outputs": outputs, "parameters": parameters}
    result = run_study(parse_study(asked))
    return result, next(n for n, r in REGIMES.items() if r.value == int(result.regime))


DRIVE = {"frequency": 50, "amplitude": "10 um", "friction": 0.5}


@pytest.mark.parametrize("alpha", [0, 180, -180])
def test_a_cylinder_that_is_driven_along_its_axis_does_not_roll(alpha):
    outputs = ["acceleration_x", "acceleration_y"]
    result, regime = regimes("cylinder-on-plane", outputs, **DRIVE, alpha=alpha, beta=0)
    assert regime == "stick"
    assert float(result.acceleration_y) == 0


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
@pytest.mark.parametrize("amplitude", ["10 um", "0.1 mm", "0.3 mm"])
@pytest.mark.parametrize("beta", [0, 30, 60])
def test_a_drive_the_other_way_is_the_mirror_image(scene, amplitude, beta):
    outputs = ["acceleration_x", "acceleration_y", "normal_acceleration"]
    given = DRIVE | {"amplitude": amplitude, "beta": beta}
    ahead, regime = regimes(scene, outputs, **given, alpha=0)
    back, regime_back = regimes(scene, outputs, **given, alpha=180)
    assert regime == regime_back
    assert float(back.acceleration_x) == -float(ahead.acceleration_x)
    for name in outputs[1:]:
        assert float(back[name]) == float(ahead[name])


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
@pytest.mark.parametrize("gamma", [90, -90])
def test_an_upright_floor_holds_nothing(scene, gamma):
    outputs = ["acceleration_x", "throw_number", "normal_acceleration"]
    given = DRIVE | {"beta": 30, "gamma": gamma}
    result, regime = regimes(scene, outputs, **given)
    assert regime == "flight"
    assert float(result.throw_number) == math.inf
    still, regime = regimes(scene, outputs, **given | {"amplitude": 0})
    assert regime == "flight"
    assert float(still.normal_acceleration) == 0
    assert math.isnan(float(still.throw_number))
    down, _ = regimes(scene, outputs, **given | {"beta": -30})
    assert float(down.throw_number) == -math.inf


def test_a_level_drive_carries_no_weight_at_any_frequency():
    result, _ = regimes(
        "rectangle-on-plane", ["normal_acceleration"], frequency="1 MHz", amplitude="1 m",
        beta=180, gravity=9.8,
    )  # fmt: skip
    assert float(result.normal_acceleration) == 9.8


def test_the_groups_of_a_motion_are_exact():
    p, right = np.array(2.5), np.array(np.pi / 2)
    zero, one = np.array(0.0), np.array(1.0)
    assert scales.drive_number_along(drive_number=p, alpha=right, beta=zero) == 0
    assert scales.drive_number_normal(drive_number=p, beta=2 * right) == 0
    assert scales.gravity_number_normal(gamma=right) == 0
    assert scales.leaning_gravity_number_normal(gamma=zero, delta=-right) == 0
    assert scales.throw_number(drive_number_normal=one, load_number=zero) == math.inf


def test_a_drive_whose_square_is_no_float_has_its_acceleration():
    frequency, amplitude = np.array([1e160, 1e-170]), np.array([1e-200, 1e200])
    P = vibration_acceleration(frequency=frequency, amplitude=amplitude)
    assert pytest.approx(4 * math.pi**2 * np.array([1e120, 1e-140]), rel=1e-15) == P
    small = vibration_acceleration(frequency=np.array([1e160]), amplitude=np.array([1e-318]))
    assert small == pytest.approx([3947.8], rel=1e-4)  # 1e-318 has four digits
