"""The rolling cylinder of chapter 4: regimes, and what it shares with the one at rest."""

import numpy as np

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES

SCENE = "cylinder-rolling"
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


def test_without_spin_the_printed_yaw_rate_is_told_as_singular():
    dataset = run("printed_yaw_rate", spin_rate=[0.0, 1e-320, 40.0])
    assert np.isfinite(dataset["printed_yaw_rate"]).values.tolist() == [False, False, True]
    told = dataset["regime"] == REGIMES["singular"].value
    assert told.values.tolist() == [True, True, False]


def test_the_force_system_passes_the_centre_at_half_the_radius():
    names = [f"force_{name}" for name in AXIS]
    dataset = run(*names, spin_rate=[-300.0, -2.0, 50.0], yaw_rate=[-3.0, 1.0], axis_yaw=[10, 70])
    for name, place in zip(names, (0, 0.002, 0, 0), strict=True):
        np.testing.assert_allclose(dataset[name], place, rtol=1e-15, atol=1e-18)
    for couple in (0.0, 1e-6):
        none = run("force_axis_normal", frequency=0, drilling_moment=couple)
        assert np.isnan(none["force_axis_normal"])
        assert regime(none) == {"singular"}


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


def test_it_rolls_just_where_friction_suffices_and_tips_where_the_offset_passes_the_end():
    aslant = {"length": 10.0, "axis_yaw": 85, "spin_rate": 20}
    needed = float(run("required_friction", **aslant)["required_friction"])
    offset = abs(float(run("pressure_offset_axial", friction=10)["pressure_offset_axial"]))
    for factor, moves, stands in ((1 + 1e-12, "roll", "roll"), (1 - 1e-12, "slip", "tipping")):
        assert regime(run("spin_acceleration", **aslant, friction=needed * factor)) == {moves}
        long = run("pressure_offset_axial", friction=10, length=2 * offset * factor)
        assert regime(long) == {stands}
