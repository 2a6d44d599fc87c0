"""Laws that every closed form must obey: friction cone, symmetry, lift-off, balances, variants."""

import numpy as np
import pytest

from plans import quantities_at
from vibrafeed.core.quantities import REGIMES

RANDOM = np.random.default_rng(20041)
POINTS = 5_000
EPS = np.finfo(float).eps

PLANE = {
    "frequency": RANDOM.uniform(5, 200, POINTS),
    "amplitude": 10 ** RANDOM.uniform(-6, -2.5, POINTS),
    "alpha": RANDOM.uniform(-np.pi, np.pi, POINTS),
    "beta": RANDOM.uniform(-np.pi / 2, np.pi / 2, POINTS),
    "gamma": RANDOM.uniform(-0.5, 0.5, POINTS),
    "gravity": np.full(POINTS, 9.8),
    "friction": RANDOM.uniform(0, 1.5, POINTS),
    "yaw": RANDOM.uniform(-np.pi, np.pi, POINTS),
}
TRACK = {
    **{name: PLANE[name] for name in PLANE if name != "yaw"},
    "alpha": RANDOM.uniform(-0.5, 1.5, POINTS),
    "delta": RANDOM.uniform(0, 0.6, POINTS),
}


def evaluate(scene: str, variant: str, outputs: list[str], points: dict, **changes) -> dict:
    """Return every quantity of the plan at the points, and the regime's numbers."""
    known = quantities_at(scene, variant, outputs, {**points, **changes})
    if "in_plane_drive_y" in known:
        known["drive"] = np.hypot(known["in_plane_drive_x"], known["in_plane_drive_y"])
    return known


def where(known: dict, name: str) -> np.ndarray:
    return known["regime"] == REGIMES[name].value


SCENES = pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
ACCELERATIONS = ["acceleration_x", "acceleration_y", "acceleration_z"]
ROTATED = ["rotated_acceleration_x", "rotated_acceleration_y"]


@SCENES
def test_friction_stays_in_its_cone_and_opposes_motion(scene):
    at = evaluate(scene, "physical", [*ACCELERATIONS, *ROTATED], PLANE)
    friction_x = at["in_plane_drive_x"] - at["acceleration_x"]
    friction_y = at["in_plane_drive_y"] - at["acceleration_y"]
    limit = at["friction"] * at["floor_acceleration"]
    # each component is a difference of two values of the size of the drive
    slack = 8 * EPS * at["drive"]
    assert np.all(np.hypot(friction_x, friction_y) <= limit + slack)
    work = friction_x * at["acceleration_x"] + friction_y * at["acceleration_y"]
    assert np.all(work >= -slack * at["drive"])
    # Turned axes keep the length; a mirrored drive mirrors the motion.
    length = np.hypot(at["acceleration_x"], at["acceleration_y"])
    turned = np.hypot(at["rotated_acceleration_x"], at["rotated_acceleration_y"])
    np.testing.assert_allclose(turned, length, rtol=8 * EPS, atol=1e-300)
    mirror = {"alpha": -PLANE["alpha"], "yaw": -PLANE["yaw"]}
    other = evaluate(scene, "physical", [*ACCELERATIONS, *ROTATED], PLANE, **mirror)
    np.testing.assert_array_equal(other["regime"], at["regime"])
    for name in (*ACCELERATIONS, *ROTATED):
        way = -1 if name.endswith("_y") else 1
        np.testing.assert_array_equal(other[name], way * at[name])


@SCENES
def test_flight_begins_at_throw_number_one(scene):
    at = evaluate(scene, "physical", [*ACCELERATIONS, *ROTATED, "throw_number"], PLANE)
    clear = np.abs(at["throw_number"] - 1) > 4 * EPS
    np.testing.assert_array_equal((at["throw_number"] > 1)[clear], where(at, "flight")[clear])
    flies = where(at, "flight")
    np.testing.assert_array_equal(at["acceleration_x"][flies], at["in_plane_drive_x"][flies])
    assert np.all(at["acceleration_z"][flies] >= 0)
    assert np.all(at["acceleration_z"][~flies] == 0)


def test_without_sideways_drive_block_cylinder_and_print_agree_while_sliding_forward():
    straight = {**PLANE, "alpha": np.zeros(POINTS)}
    block = evaluate("rectangle-on-plane", "physical", [*ACCELERATIONS, *ROTATED], straight)
    cylinder = evaluate("cylinder-on-plane", "physical", [*ACCELERATIONS, *ROTATED], straight)
    printed = evaluate("rectangle-on-plane", "thesis", [*ACCELERATIONS, *ROTATED], straight)
    forward = where(block, "slip") & (block["in_plane_drive_x"] > 0)
    assert forward.sum() > 250
    # near the friction limit the difference of drive and friction loses digits
    slack = 8 * EPS * block["drive"]
    assert np.all(np.abs(cylinder["acceleration_x"] - block["acceleration_x"]) <= slack)
    error = np.abs(printed["acceleration_x"] - block["acceleration_x"])[forward]
    assert np.all(error <= slack[forward])


def test_a_cylinder_meets_its_balance_of_slip():
    outputs = [*ACCELERATIONS, "angular_acceleration"]
    points = {k: v for k, v in PLANE.items() if k != "yaw"}
    at = evaluate("cylinder-on-plane", "physical", outputs, points, diameter=np.full(POINTS, 0.008))
    slips = where(at, "slip")
    q = at["friction"] * at["floor_acceleration"]
    # Slip acceleration of the contact point, from the motion; friction points against it.
    slip_x = at["acceleration_x"]
    slip_y = at["acceleration_y"] - 0.004 * at["angular_acceleration"]
    friction_x = at["in_plane_drive_x"] - at["acceleration_x"]
    friction_y = at["in_plane_drive_y"] - at["acceleration_y"]
    size = at["drive"]
    assert np.all(np.abs(np.hypot(friction_x, friction_y) - q)[slips] <= 8 * EPS * size[slips])
    across = friction_x * slip_y - friction_y * slip_x
    assert np.all(np.abs(across)[slips] <= 16 * EPS * (size * size)[slips])
    rolls = where(at, "roll")
    assert rolls.sum() > 250
    assert np.all(np.abs(slip_y)[rolls] <= 4 * EPS * size[rolls])
    # Moment about the axis: friction at the rim is all that turns it, I = m r^2/2.
    np.testing.assert_allclose(
        0.5 * 0.004 * at["angular_acceleration"][slips | rolls], friction_y[slips | rolls],
        rtol=0, atol=8 * EPS * size.max(),
    )  # fmt: skip


def test_corrected_and_printed_lean_differ_by_what_the_theory_says():
    printed = evaluate("rectangle-on-track", "thesis", ["starting_acceleration"], TRACK)
    derived = evaluate("rectangle-on-track", "derived", ["starting_acceleration"], TRACK)
    expected = 2 * TRACK["friction"] * 9.8 * np.cos(TRACK["gamma"]) * np.sin(TRACK["delta"])
    difference = printed["starting_acceleration"] - derived["starting_acceleration"]
    size = np.abs(derived["vibration_acceleration"]) + 9.8
    assert np.all(np.abs(difference - expected) <= 8 * EPS * size * (1 + TRACK["friction"]))
