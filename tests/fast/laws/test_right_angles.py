"""Whole multiples of 90 degrees are exact: no part rolls, slips or flies for a rounded pi."""

import math
import warnings

import numpy as np
import pytest
import xarray

import vibrafeed
from plans import make_plan
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
    beside = [np.nextafter(k * math.pi / 2, way) for k in TURNS for way in (-9e9, 9e9) if k]
    for values in (np.random.default_rng(90).uniform(-10, 10, 10_000), np.array(beside)):
        assert bits(sine(values)) == bits(np.sin(values))
        assert bits(cosine(values)) == bits(np.cos(values))


def test_whole_turns_go_while_an_angle_is_in_degrees():
    degrees = np.array([370.0, -350.0, 730.0, 10.0])
    assert len(set(radians(degrees))) == 1
    assert bits(radians(np.array([180.0, -180.0, 540.0, -0.0]))) == bits([np.pi, -np.pi, np.pi, 0])
    grid = Grid({}, {"azimuth_1": 450.0})
    assert float(grid.si()["azimuth_1"]) == np.pi / 2


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
    random = np.random.default_rng(2004)
    names = sorted(n for n in scene_parameters(SCENES[scene], variant) if not instead_of(n))
    cell = {name: float(random.uniform(0.1, 0.9)) for name in names}
    angles = [name for name in cell if QUANTITIES[name].is_angle]
    if level:
        cell |= dict.fromkeys(angles, 0.0)
    for name in angles:
        for k, far in ((0, -4), (1, 5), (2, -6), (3, -1)):
            near, turned = (results(scene, variant, cell | {name: 90.0 * n}) for n in (k, far))
            for output, value in turned.items():
                assert bits(value) == bits(near[output]), (name, 90 * far, output)


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
def test_a_drive_the_other_way_is_the_mirror_image(scene):
    """A cylinder that is driven along its axis does not roll."""
    found = vibrafeed.sweep(
        scene=scene, friction=0.5, frequency=50, amplitude=[1e-5, 1e-4, 3e-4], beta=[0, 30, 60],
        alpha=[-180, 0, 180], outputs=["acceleration_x", "acceleration_y", "normal_acceleration"],
    )  # fmt: skip
    ahead, back, again = (found.sel(alpha=alpha) for alpha in (0, 180, -180))
    xarray.testing.assert_equal(back.drop_vars("alpha"), again.drop_vars("alpha"))
    np.testing.assert_array_equal(ahead.regime, back.regime)
    np.testing.assert_array_equal(ahead.acceleration_x, -back.acceleration_x)
    assert not ahead.acceleration_y.values.any()
    assert not back.acceleration_y.values.any()
    assert int(ahead.regime[0, 0]) == REGIMES["stick"].value


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
@pytest.mark.parametrize("gamma", [90, -90])
def test_an_upright_floor_holds_nothing(scene, gamma):
    found = vibrafeed.sweep(
        scene=scene, friction=0.5, frequency=50, gamma=gamma, amplitude=[0, 1e-5], beta=[-30, 30],
        outputs=["acceleration_x", "throw_number", "normal_acceleration"],
    )  # fmt: skip
    still, driven = found.isel(amplitude=0), found.isel(amplitude=1)
    assert driven.throw_number.values.tolist() == [-math.inf, math.inf]
    assert np.isnan(still.throw_number).all()
    assert not still.normal_acceleration.values.any()
    flies = REGIMES["flight"].value
    assert int(driven.regime[1]) == flies
    assert (still.regime == flies).all()


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
    np.testing.assert_allclose(P, 4 * math.pi**2 * np.array([1e120, 1e-140]), rtol=1e-15)
