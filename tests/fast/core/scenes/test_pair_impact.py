"""Impacts that can be checked by hand, and placements that have no impact or no unique one."""

import math

import numpy as np
import pytest

from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import QUANTITIES, REGIMES

VELOCITIES = [
    f"{name}_{body}_after" for body in "12" for name in ("velocity_x", "velocity_y", "spin")
]
PARTS = {
    "length_1": 0.04, "width_1": 0.02, "mass_1": 0.01,
    "length_2": 0.06, "width_2": 0.02, "mass_2": 0.03,
}  # fmt: skip
LAWS = ["frictionless", "pfeiffer_glocker", "moreau"]
DIAGONAL = math.hypot(0.04, 0.02) / 2
UPRIGHT = math.degrees(math.atan2(0.04, 0.02))  # turns corner 3 of part 1 straight below its centre


def collide(law: str | None = None, scene: str = "rectangle-pair-impact", **parameters: object):
    outputs = parameters.pop("outputs", None) or [
        "gap", "impulse_normal", "impulse_tangential", "energy_lost", "energy_before",
        "separation_normal", "separation_tangential", "approach_normal", *VELOCITIES,
    ]  # fmt: skip
    study = {"kind": "sweep", "scene": scene, "outputs": outputs,
             "parameters": {**PARTS, "restitution": 0.5, **parameters}}  # fmt: skip
    if law is not None:
        study["variant"] = law
    if law in LAWS[1:]:
        study["parameters"].setdefault("friction", 0.3)
    return run_study(parse_study(study))


def regime(dataset) -> str:
    return next(name for name, r in REGIMES.items() if r.value == int(dataset.regime))


def on_corner(**parameters: object) -> dict[str, object]:
    """Part 1 stands on a corner, its centre straight above it, on the upper edge of part 2."""
    return {"position_y_1": 0.01 + DIAGONAL, "position_x_1": 0.0, "angle_1": UPRIGHT, **parameters}


def test_an_eccentric_impact_turns_both_parts():
    """The corner meets part 2 at 20 mm from its centre: G_NN = 1/m1 + 1/m2 + 0.02^2/I2."""
    I2 = 0.03 * (0.06**2 + 0.02**2) / 12
    G_NN = 100 + 1 / 0.03 + 0.02**2 / I2
    known = {
        "inertia_2": I2, "delassus_normal": G_NN,
        # at the contact rho2 = (20, 10) mm: rho2 x n = 20 mm, rho2 x t = 10 mm
        "delassus_coupling": 0.02 * 0.01 / I2, "impulse_normal": 1.5 * 0.4 / G_NN,
        "spin_2_after": -0.02 * 0.6 / G_NN / I2, "contact_x": 0.02, "contact_y": 0.01,
        "normal_y": 1.0, "face_body": 2, "contact_corner": 3,
    }  # fmt: skip
    at = collide(**on_corner(position_x_1=0.02, velocity_y_1=-0.4), outputs=[*known])
    for name, value in known.items():
        assert float(at[name]) == pytest.approx(value, rel=1e-9), name


FLAT = {"position_y_1": 0.02, "position_x_1": 0.01, "velocity_y_1": -0.4}


# On a heavy part 2: G_ab = 1/m - c^2/I = -140, G_aa = 340 per kg, u = (-0.7, 0.3) m/s. The blow on
# the left end alone sends the right end down with 0.3 - 1.5 * 140 * 0.7/340.
BLOW = {**FLAT, "spin_1": 25.0, "velocity_y_1": -0.2, "mass_2": 1e6}


@pytest.mark.parametrize("turn", [0, 90, -90, 37])
def test_two_contacts_of_an_edge_on_an_edge_are_both_reversed(turn):
    """Both ends get -eps times their velocity; the impulses act at the point between."""
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    at = collide(
        position_x_1=c * 0.01 - s * 0.02, position_y_1=s * 0.01 + c * 0.02, angle_1=turn,
        angle_2=turn, velocity_x_1=s * 0.4, velocity_y_1=c * -0.4, contact_tolerance=1e-8,
    )  # fmt: skip
    assert regime(at) == "impact"
    apart = (float(at[f"velocity_{x}_1_after"] - at[f"velocity_{x}_2_after"]) for x in "xy")
    x, y = apart
    # relative motion along the normal at 10 mm from centre 2, below centre 1
    spin_1, spin_2 = float(at.spin_1_after), float(at.spin_2_after)
    assert y * c - x * s - 0.01 * spin_2 == pytest.approx(0.2, rel=1e-9)
    assert spin_1 == pytest.approx(spin_2, rel=1e-9)


@pytest.mark.parametrize(
    ("law", "placed", "told", "place"),
    [
        (None, {**FLAT, "position_x_1": 0.045}, "impact", 0.03),  # one end overhangs
        (None, {**FLAT, "spin_1": 30.0, "velocity_y_1": -0.1}, "impact", -0.01),  # one comes first
        # Friction at two ends is not solved.
        ("moreau", FLAT, "simultaneous", None),
        ("pfeiffer_glocker", FLAT, "simultaneous", None),
        ("moreau", {**FLAT, "velocity_y_1": 0.1}, "no_impact", None),
        (None, BLOW, "simultaneous", None),  # an end is hit again at once
        (None, {**BLOW, "restitution": 0}, "impact", None),
    ],
)
def test_ends_of_an_edge(law, placed, told, place):
    at = collide(law, **placed, outputs=["contact_x", "impulse_normal"])
    assert regime(at) == told
    assert np.isnan(at.impulse_normal) == (told == "simultaneous")
    if place is not None:
        assert float(at.contact_x) == pytest.approx(place, rel=1e-12)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"velocity_y_1": 0.4}, "no_impact"),
        ({"velocity_x_1": 0.4}, "no_impact"),  # grazing
        ({"velocity_y_1": -0.4, "position_y_1": 0.01 + DIAGONAL + 1e-6}, "apart"),
        ({"velocity_y_1": -0.4, "position_x_1": 0.0301}, "apart"),  # beside the part
    ],
)
def test_without_impact_nothing_changes(law, change, name):
    at = collide(law, **{**on_corner(), **change})
    assert regime(at) == name
    for velocity in VELOCITIES:
        assert float(at[velocity]) == change.get(velocity.removesuffix("_after"), 0.0)
    assert float(at.impulse_normal) == float(at.impulse_tangential) == 0
    assert float(at.energy_lost) == 0


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"position_y_1": 0.01 + DIAGONAL - 1e-6}, "overlap"),
        ({"position_y_1": 0.001}, "overlap"),
        ({"position_x_1": 0.03}, "simultaneous"),  # on the corner of part 2
        ({"position_x_1": 0.05, "position_y_1": 0.02, "angle_1": 0}, "simultaneous"),
    ],
)
def test_what_the_law_does_not_tell_has_a_status_and_no_number(law, change, name):
    at = collide(law, **{**on_corner(velocity_y_1=-0.4), **change})
    assert regime(at) == name
    for output in ("impulse_normal", "energy_lost", *VELOCITIES):
        assert np.isnan(at[output])


CYLINDERS = {
    "diameter_1": 0.02, "length_1": 0.06, "mass_1": 0.01,
    "diameter_2": 0.02, "length_2": 0.08, "mass_2": 0.03,
}  # fmt: skip
SPATIAL = [
    f"{name}_{axis}_{body}_after"
    for body in "12"
    for name in ("velocity", "spin")
    for axis in "xyz"
]


def clash(law: str | None = None, outputs: list[str] | None = None, **parameters: object):
    wanted = outputs or ["gap", "contact_form", "face_body", "contact_x", "contact_y", "contact_z",
                         "impulse_normal", "impulse_friction", "energy_lost", *SPATIAL]  # fmt: skip
    study = {"kind": "sweep", "scene": "cylinder-pair-impact", "outputs": wanted,
             "parameters": {**CYLINDERS, "position_x_1": 0.0, "position_y_1": 0.0,
                            "position_z_1": 0.02, "velocity_z_1": -0.4, "restitution": 0.5,
                            **parameters}}  # fmt: skip
    if law is not None:
        study["variant"] = law
    if law in LAWS[1:]:
        study["parameters"].setdefault("friction", 0.3)
    return run_study(parse_study(study))


# place of body 1 over body 2, which lies along x; form; body with the face; gap from the geometry
TILT = math.radians(30)
TILTED = 0.03 * math.sin(TILT) + 0.01 * math.cos(TILT)  # how far a cylinder at 30 deg reaches down
FORMS = {
    "rim on face": ({"elevation_2": 90, "elevation_1": 30, "position_x_1": 0.02,
                     "position_z_1": 0.04 + TILTED}, 1, 2),
    "rim on side": ({"elevation_1": 30, "position_z_1": 0.01 + TILTED}, 2, 2),
    "side on side": ({"azimuth_1": 90}, 4, 0),
    "side on side, not square": ({"azimuth_1": 25}, 4, 0),
}  # fmt: skip


@pytest.mark.parametrize("name", FORMS)
def test_each_form_of_contact_is_found_from_both_sides(name):
    place, form, body = FORMS[name]
    assert QUANTITIES["contact_form"].words[form] == name.partition(",")[0]
    for above, told in ((0.0, "impact"), (1e-4, "apart"), (-1e-4, "overlap")):
        at = clash(**{**place, "position_z_1": place.get("position_z_1", 0.02) + above})
        assert regime(at) == told
        if told != "overlap":
            assert (int(at.contact_form), int(at.face_body)) == (form, body)
            assert float(at.gap) == pytest.approx(above, rel=1e-9, abs=1e-16)
    assert np.isnan(at.impulse_normal)


def test_friction_rolls_a_cylinder_about_its_own_axis():
    """A blow with sliding on a heavy body: spin by mu L_N r/(m d^2/8)."""
    at = clash("moreau", azimuth_1=90, velocity_x_1=5.0, mass_2=1e9, friction=0.1)
    L_N = 0.6 * 0.01
    assert regime(at) == "impact_slip"
    # the contact lies below: friction along -x turns body 1 about +y
    spin = 0.1 * L_N * 0.01 / (0.01 * 0.02**2 / 8)
    names = ("impulse_normal", "impulse_friction", "spin_y_1_after", "velocity_x_1_after")
    found = [float(at[name]) for name in names]
    assert found == pytest.approx([L_N, 0.1 * L_N, spin, 5 - 0.1 * L_N / 0.01], rel=1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("place", "name"),
    [
        ({"azimuth_1": 90, "velocity_z_1": 0.1}, "no_impact"),
        ({"azimuth_1": 90, "velocity_z_1": 0, "velocity_x_1": 1}, "no_impact"),
        ({"azimuth_1": 90, "position_y_1": 0.0301}, "apart"),  # passes beside the end
        ({"elevation_1": 90, "elevation_2": 90, "position_z_1": 0.07}, "simultaneous"),  # 3
        ({"azimuth_1": 90, "position_y_1": 0.03, "position_x_1": 0.04}, "simultaneous"),  # ends
    ],
)
def test_cylinders_without_impact_or_without_a_unique_one(law, place, name):
    at = clash(law, **place)
    assert regime(at) == name
    impulse, velocity = float(at.impulse_normal), float(at.velocity_z_1_after)
    if name == "simultaneous":
        assert np.isnan(impulse)
    else:
        assert (impulse, velocity) == (0, place.get("velocity_z_1", -0.4))


def test_a_line_of_contact_is_reversed_as_a_whole_and_solved_without_friction_only():
    """Both ends of the line of parallel cylinders separate with -eps times their approach."""
    at = clash(position_x_1=0.01)
    spin_1, spin_2 = float(at.spin_y_1_after), float(at.spin_y_2_after)
    assert spin_1 == pytest.approx(spin_2, rel=1e-9)
    # v_z at a point is v_z - w_y (x - x_c), at the middle of body 1
    rise = float(at.velocity_z_1_after) - (float(at.velocity_z_2_after) - 0.01 * spin_2)
    assert rise == pytest.approx(0.2, rel=1e-9)
    # Parallel axes, and a side on an end face.
    for place, form in (
        ({"position_x_1": 0.01}, 4),
        ({"elevation_2": 90, "position_z_1": 0.05}, 5),
    ):
        told = [regime(clash(law, **place)) for law in LAWS]
        assert told == ["impact", "simultaneous", "simultaneous"]
        assert int(clash(**place).contact_form) == form
    # Where the whole line parts, all laws name the same end.
    ends = [clash(law, position_x_1=0.01, velocity_z_1=0.2).contact_x.item() for law in LAWS]
    assert ends == [ends[0]] * 3


def test_cylinders_on_a_floor_are_the_planar_problem():
    """Equal diameters: footprint h x d, but the inertia of the cylinder (theory 8.2)."""
    turn, half, r = math.radians(40), 0.03, 0.01
    y = 0.01 + half * math.sin(turn) + r * math.cos(turn)
    at = clash(azimuth_1=40, position_z_1=0.0, position_y_1=y, position_x_1=0.02, velocity_z_1=0.0,
               velocity_y_1=-0.4)  # fmt: skip
    x_P = 0.02 - half * math.cos(turn) + r * math.sin(turn)
    I_1, I_2 = (m * (0.75 * 0.02**2 + h**2) / 12 for m, h in ((0.01, 0.06), (0.03, 0.08)))
    G_NN = 1 / 0.01 + 1 / 0.03 + (x_P - 0.02) ** 2 / I_1 + x_P**2 / I_2
    names = ("contact_form", "impulse_normal", "contact_x", "spin_z_2_after")
    expected = [2, 0.6 / G_NN, x_P, -x_P * 0.6 / G_NN / I_2]
    assert [float(at[name]) for name in names] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("away", [1e-3, 1e-7])
def test_the_gap_of_rims_that_cross(away):
    """The end of body 1 comes down aslant on that of body 2, whose rim is at (40, 0, 10) mm."""
    n, t = np.array([1, 0, 1]) / math.sqrt(2), np.array([0.5, math.sqrt(0.5), -0.5])
    w = np.cross(t, n)
    end, side = (w - n) / math.sqrt(2), (-w - n) / math.sqrt(2)
    centre = np.array([0.04, 0, 0.01]) - 0.03 * end - 0.01 * side + away * n
    x, y, z = centre.tolist()
    azimuth, elevation = np.degrees([np.arctan2(end[1], end[0]), np.arcsin(end[2])]).tolist()
    at = clash(position_x_1=x, position_y_1=y, position_z_1=z, azimuth_1=azimuth,
               elevation_1=elevation)  # fmt: skip
    assert regime(at) == "apart"
    assert float(at.gap) == pytest.approx(away, rel=1e-8)
