"""The rolling cylinder of chapter 4: values, regimes, and what it shares with the one at rest."""

import numpy as np
import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.plan.evaluate import empty_results, evaluate_in_blocks
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.sweep.kind import prepare

SCENE = "cylinder-rolling"
DRIVE = 4e-4 * (2 * np.pi * 50) ** 2  # of 50 Hz and 0.4 mm [m s-2]
BASE = {
    "frequency": 50, "amplitude": 4e-4, "alpha": 12, "beta": 6, "gravity": 9.8, "diameter": 0.008,
    "length": 0.02, "mass": 0.005, "friction": 0.35,
}  # fmt: skip
AXIS = ("pitch", "axis_normal", "axis_rolling", "axis_axial")


def run(*outputs: str, variant: str = "derived", scene: str = SCENE, **changes: object):
    study = {
        "kind": "sweep", "scene": scene, "variant": variant, "outputs": list(outputs),
        "parameters": {**BASE, **changes},
    }  # fmt: skip
    try:
        return run_study(parse_study(study))
    except StudyError as error:
        # drop what these outputs do not use
        unused = {p.place.removeprefix("parameters.") for p in error.problems if "not used" in
                  f"{p.message} {p.fix}"}  # fmt: skip
        if not unused:
            raise
        study["parameters"] = {k: v for k, v in study["parameters"].items() if k not in unused}
        return run_study(parse_study(study))


def regime(dataset) -> set[str]:
    names = {r.value: name for name, r in REGIMES.items()}
    return {names[int(value)] for value in np.unique(dataset["regime"])}


def test_values_by_hand():
    dataset = run(
        "rolling_drive", "axial_drive", "drive_normal", "floor_force", "rolling_friction",
        "axial_friction", "spin_acceleration", "yaw_acceleration", "pressure_offset_axial",
        "required_friction", "cone_margin", "printed_yaw_rate",
        axis_yaw=20, spin_rate=300, yaw_rate=5, drilling_moment=1e-6,
    )  # fmt: skip
    P, beta, turn = DRIVE, np.deg2rad(6), np.deg2rad(32)
    eta, sigma = P * np.cos(beta) * np.sin(turn), P * np.cos(beta) * np.cos(turn)
    n0, u = 9.8 - P * np.sin(beta), 0.004 * 300 * 5
    friction = np.hypot(eta / 3, sigma - u)
    expected = {
        "rolling_drive": eta,
        "axial_drive": sigma,
        "drive_normal": P * np.sin(beta),
        "floor_force": 0.005 * n0,
        "rolling_friction": 0.005 * eta / 3,
        "axial_friction": 0.005 * (sigma - u),
        "spin_acceleration": 2 * eta / (3 * 0.004),
        "yaw_acceleration": 1e-6 / (0.005 * (3 * 0.004**2 + 0.02**2) / 12),
        "pressure_offset_axial": 0.004 * (sigma - 1.5 * u) / n0,
        "required_friction": friction / n0,
        "cone_margin": 0.005 * (0.35 * n0 - friction),
        "printed_yaw_rate": 2 * sigma / (3 * 0.004 * 300),
    }
    for name, value in expected.items():
        assert float(dataset[name]) == pytest.approx(value, rel=1e-13), name
    # The offset is 0.0137 m, beyond half of 20 mm: it tips.
    assert regime(dataset) == {"tipping"}


def test_at_rest_and_without_yaw_it_is_the_cylinder_on_the_plane():
    axes = {
        "alpha": {"start": -180, "stop": 180, "num": 41},
        "beta": {"start": -80, "stop": 80, "num": 31},
        "friction": [0.1, 0.5, 2.0],
        "length": 10.0,  # so long that nothing tips
    }
    here = run("spin_acceleration", "required_friction", "normal_acceleration", **axes)
    there = run("angular_acceleration", scene="cylinder-on-plane", variant="derived", **axes)
    np.testing.assert_allclose(here["spin_acceleration"], there["angular_acceleration"], rtol=4e-16)
    # Same cone, except that the other scene tells `stick` where nothing makes it roll.
    value = {name: r.value for name, r in REGIMES.items()}
    expected = there["regime"].where(there["regime"] != value["stick"], value["roll"])
    for name in ("roll", "slip", "flight"):
        assert (here["regime"] == value[name]).any(), name
    np.testing.assert_array_equal(here["regime"], expected)
    physical = run("angular_acceleration", scene="cylinder-on-plane", variant="physical", **axes)
    rolls = (here["regime"] == value["roll"]).values
    np.testing.assert_allclose(
        np.broadcast_to(here["spin_acceleration"].values[..., None], rolls.shape)[rolls],
        physical["angular_acceleration"].values[rolls],
        rtol=1e-15, atol=1e-300,
    )  # fmt: skip


def test_it_rolls_just_where_friction_suffices():
    found = run("required_friction", "cone_margin", length=10.0, axis_yaw=85, spin_rate=20)
    needed = float(found["required_friction"])
    assert regime(run("spin_acceleration", length=10.0, axis_yaw=85, spin_rate=20,
                      friction=needed * (1 + 1e-12))) == {"roll"}  # fmt: skip
    assert regime(run("spin_acceleration", length=10.0, axis_yaw=85, spin_rate=20,
                      friction=needed * (1 - 1e-12))) == {"slip"}  # fmt: skip
    margins = run("cone_margin", length=10.0, axis_yaw=85, friction=[0.9 * needed, 1.1 * needed])
    assert list(np.sign(margins["cone_margin"].values)) == [-1, 1]


def test_it_tips_just_where_the_offset_passes_the_end():
    offset = abs(float(run("pressure_offset_axial", friction=10)["pressure_offset_axial"]))
    for factor, name in ((1 + 1e-12, "roll"), (1 - 1e-12, "tipping")):
        there = run("pressure_offset_axial", friction=10, length=2 * offset * factor)
        assert regime(there) == {name}


def test_the_printed_yaw_rate_holds_the_floor_at_mid_length():
    yaw_rate = float(run("printed_yaw_rate", spin_rate=40)["printed_yaw_rate"])
    there = run("pressure_offset_axial", "axial_friction", spin_rate=40, yaw_rate=yaw_rate)
    sigma = float(run("axial_drive")["axial_drive"])
    assert abs(float(there["pressure_offset_axial"])) < 1e-17
    assert float(there["axial_friction"]) == pytest.approx(0.005 * sigma / 3, rel=1e-14)


def test_its_time_derivative_is_that_of_theory_9_4_and_contradicts_4_18():
    step, spin = 1e-4, 40.0
    at = run(
        "printed_yaw_rate", "yaw_acceleration", "spin_acceleration",
        axis_yaw=[20 - step, 20, 20 + step], spin_rate=spin,
    )  # fmt: skip
    # d/dt of 2 D_sigma/(3 r phi') by theta, which moves at that rate, and by phi' as in (4.19)
    rate, over = float(at["printed_yaw_rate"][1]), np.deg2rad(2 * step)
    by_yaw = float(at["printed_yaw_rate"][2] - at["printed_yaw_rate"][0]) / over * rate
    by_spin = -rate / spin * float(at["spin_acceleration"][1])
    P, beta, turn = DRIVE, np.deg2rad(6), np.deg2rad(12 + 20)
    expected = -(4 / 9) * (P * np.cos(beta)) ** 2 * np.sin(2 * turn) / (0.004 * spin) ** 2
    assert by_yaw + by_spin == pytest.approx(expected, rel=1e-8)
    assert float(at["yaw_acceleration"]) == 0


def test_without_spin_the_printed_yaw_rate_is_told_as_singular():
    dataset = run("printed_yaw_rate", spin_rate=[0.0, 1e-320, 40.0])
    values = dataset["printed_yaw_rate"].values
    assert not np.isfinite(values[:2]).any()
    assert np.isfinite(values[2])
    singular = REGIMES["singular"].value
    assert list(dataset["regime"] == singular) == [True, True, False]
    assert not REGIMES["singular"].valid


def test_the_force_system_passes_the_centre_at_half_the_radius():
    names = [f"force_{name}" for name in AXIS]
    dataset = run(*names, spin_rate=[-300.0, -2.0, 50.0], yaw_rate=[-3.0, 1.0], axis_yaw=[10, 70])
    np.testing.assert_allclose(dataset["force_axis_normal"], 0.002, rtol=1e-15)
    for name in names[2:]:
        np.testing.assert_array_equal(dataset[name], 0)
    assert np.all(np.abs(dataset["force_pitch"]) < 1e-18)


def test_a_force_system_without_force_is_singular():
    for couple in (0.0, 1e-6):
        dataset = run("force_axis_normal", frequency=0, drilling_moment=couple)
        assert np.isnan(dataset["force_axis_normal"])
        assert regime(dataset) == {"singular"}


def test_the_floor_acts_at_one_point_if_the_drilling_moment_says_so():
    moving = {"spin_rate": 50, "yaw_rate": 3, "axis_yaw": 40}
    at = run("pressure_offset_axial", "rolling_friction", "floor_pitch", **moving)
    e, F_eta = float(at["pressure_offset_axial"]), float(at["rolling_friction"])
    names = ["floor_pitch", *(f"floor_{name}" for name in AXIS[1:])]
    forces = ["floor_force", "rolling_friction", "axial_friction"]
    there = run(*names, *forces, **moving, drilling_moment=e * F_eta)
    assert abs(float(there["floor_pitch"])) < 1e-17
    assert abs(float(at["floor_pitch"])) > 1e-4
    # The axis passes that point: from the nearest point to the contact point is along the force.
    point = np.array([-0.004, 0, e])
    nearest = np.array([float(there[name]) for name in names[1:]])
    force = np.array([float(there[name]) for name in forces]) * [1, -1, -1]
    np.testing.assert_allclose(np.cross(point - nearest, force), 0, atol=1e-15)


def test_the_printed_sign_turns_the_axes_round_and_changes_nothing_else():
    scene = SCENES[SCENE]
    outputs = [name for name in scene.outputs("derived") if name != "regime"]
    moving = {"spin_rate": 50, "yaw_rate": 3, "axis_yaw": 40, "drilling_moment": 1e-6}
    derived, thesis = (run(*outputs, variant=v, **moving) for v in ("derived", "thesis"))
    for name in outputs:
        sign = -1 if "_axis_" in name else 1
        assert float(thesis[name]) == sign * float(derived[name]), name


def test_yaw_and_azimuth_add_up():
    outputs = ("spin_acceleration", "pressure_offset_axial", "floor_pitch")
    moving = {"spin_rate": 50, "yaw_rate": 3}
    one = run(*outputs, alpha=42, axis_yaw=0, **moving)
    other = run(*outputs, alpha=12, axis_yaw=30, **moving)
    for name in outputs:
        assert float(one[name]) == pytest.approx(float(other[name]), rel=1e-14)


def test_rates_are_read_with_their_units():
    dataset = run("printed_yaw_rate", spin_rate="60 rpm")
    assert float(dataset["spin_rate"]) == pytest.approx(2 * np.pi, rel=1e-15)
    with pytest.raises(StudyError, match="does not measure spin rate"):
        run("printed_yaw_rate", spin_rate="50 Hz")


def test_each_output_keeps_only_what_it_depends_on():
    grid = {"spin_rate": [1.0, 2.0], "axis_yaw": [0, 10, 20], "diameter": [0.008, 0.009]}
    dataset = run("spin_acceleration", "axial_friction", "floor_force", "floor_pitch", **grid)
    assert dataset["floor_force"].dims == ()
    assert set(dataset["spin_acceleration"].dims) == {"axis_yaw", "diameter"}
    assert set(dataset["axial_friction"].dims) == set(grid)
    assert set(dataset["floor_pitch"].dims) == set(grid)


def test_wrenches_are_handed_on_block_by_block():
    study = {
        "kind": "sweep", "scene": SCENE,
        "outputs": ["floor_pitch", "force_axis_rolling", "cone_margin"],
        "parameters": {
            **BASE,
            "mass": [0.001, 0.005],
            "axis_yaw": {"start": 0, "stop": 90, "num": 7},
            "spin_rate": {"start": -50, "stop": 50, "num": 5},
            "yaw_rate": [1, 2, 3],
            "drilling_moment": 1e-6,
        },
    }  # fmt: skip
    prepared = prepare(parse_study(study))
    whole, parts = (empty_results(prepared.plan, prepared.grid) for _ in range(2))
    evaluate_in_blocks(prepared.plan, prepared.grid, whole, block_cells=10**9)
    for block_cells in (1, 4, 50):
        evaluate_in_blocks(prepared.plan, prepared.grid, parts, block_cells=block_cells)
        for name, values in whole.items():
            np.testing.assert_array_equal(parts[name], values)
