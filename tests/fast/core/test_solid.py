"""Solids: worked values, closed forms, another program's stable poses, descents, symmetry."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import vibrafeed
import vibrafeed.core.solid
from night import count
from vibrafeed.core.scenes.resting_part import ASPECTS
from vibrafeed.core.solid import Hull, RoundedError, aspects_of

ROUNDING = 1e-12
HULLS = count(20, 200)
DROPS = 100_000
TOP = np.array([[0, 0], [30, 0], [30, 5], [5, 5], [5, 20], [0, 20]], float)


def bracket():
    """Return the L bracket of the worked values: a leg of 30 x 15 x 5, one of 5 x 15 x 15 on it."""
    corners = np.vstack([np.insert(TOP, 1, y, axis=1) for y in (0, 15)])
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)]
    sides = [(i, (i + 1) % 6) for i in range(6)]
    faces = [
        *caps, *((c + 6, b + 6, a + 6) for a, b, c in caps),
        *((j, i, i + 6) for i, j in sides), *((j, i + 6, j + 6) for i, j in sides),
    ]  # fmt: skip
    return trimesh.Trimesh(corners, faces, process=False)


def hull_of(rng, count=20):
    points = rng.standard_normal((count, 3)) * rng.uniform(0.5, 2, 3)
    return trimesh.convex.convex_hull(points)


# --- worked values


def test_the_bracket():
    part = bracket()
    assert part.volume == pytest.approx(3375, rel=ROUNDING)
    assert part.center_mass == pytest.approx([65 / 6, 7.5, 35 / 6], rel=ROUNDING)
    aspects = aspects_of(part)
    assert sum(one.let_down_share for one in aspects) == pytest.approx(1, abs=ROUNDING)
    assert sum(one.thrown_share for one in aspects) == pytest.approx(1, abs=ROUNDING)
    foot = aspects[0]
    assert (foot.base_along, foot.base_across, foot.base_least) == pytest.approx((65 / 6, 7.5, 7.5))


def test_mirrored_sides_are_two_aspects_and_turned_ones_are_one():
    # The two sides of the bracket are mirror images: which of them is down matters.
    assert len(aspects_of(bracket())) == 5
    assert len(aspects_of(trimesh.creation.box((30, 20, 10)))) == 3
    assert len(aspects_of(trimesh.creation.box((10, 10, 10)))) == 1
    assert len(aspects_of(trimesh.creation.cylinder(5, 14, sections=96))) == 2


# --- closed forms

SHAPES = {
    "box": {"length": 0.03, "width": 0.02, "height": 0.01},
    "prism": {"sides": 6, "length": 0.012, "diameter": 0.02},
    "cylinder": {"length": 0.014, "diameter": 0.01},
    "truncated_cone": {"diameter": 0.02, "small_diameter": 0.012, "height": 0.018},
}
SIDES = 256


def surface_of(shape, sizes):
    if shape == "box":
        return trimesh.creation.box((sizes["length"], sizes["width"], sizes["height"]))
    upper = sizes.get("small_diameter", sizes["diameter"])
    height = sizes.get("height", sizes.get("length"))
    angles = 2 * np.pi * np.arange(sizes.get("sides", SIDES)) / sizes.get("sides", SIDES)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    low, high = (
        np.insert(ring * diameter / 2, 2, z, axis=1)
        for diameter, z in ((sizes["diameter"], 0), (upper, height))
    )
    return trimesh.convex.convex_hull(np.vstack([low, high]))


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_as_surfaces_equal_their_closed_forms(shape):
    sizes = SHAPES[shape]
    exact = 1e-9 if shape in ("box", "prism") else 20 / SIDES**2
    names = [f"{kind}_{name}" for name in ASPECTS[shape]
             for kind in ("let_down_share", "thrown_share")]  # fmt: skip
    closed = vibrafeed.sweep(scene="resting-part", variant=shape, outputs=names, **sizes)
    known = sorted(
        tuple(float(closed[f"{kind}_{name}"]) for kind in ("let_down_share", "thrown_share"))
        for name in ASPECTS[shape]
    )
    aspects = aspects_of(surface_of(shape, sizes))
    found = sorted((one.let_down_share, one.thrown_share) for one in aspects)
    assert np.array(found) == pytest.approx(np.array(known), abs=exact)


def test_a_box_stands_as_its_closed_form():
    length, width, height = SHAPES["box"].values()
    outputs = ["gyration", "topple_slope"]
    closed = vibrafeed.sweep(scene="resting-part", outputs=outputs, length=length, height=height)
    flat = aspects_of(surface_of("box", SHAPES["box"]))[0]
    assert (flat.base_along, flat.base_across) == pytest.approx((length / 2, width / 2))
    assert flat.gyration == pytest.approx(float(closed["gyration"]), rel=1e-9)
    slope = np.degrees(np.arctan2(flat.base_along, flat.centre_height))
    assert slope == pytest.approx(float(closed["topple_slope"]), rel=1e-9)


# --- other programs, and other ways


def test_random_hulls_rest_as_another_program_says():
    rng = np.random.default_rng(1)
    for _ in range(HULLS):
        mesh = hull_of(rng)
        _, known = trimesh.poses.compute_stable_poses(mesh, threshold=1e-6)
        hull = Hull(mesh.vertices - mesh.center_mass)
        found = np.bincount(hull.ends, hull.solid_angles())
        found = sorted(share for share in found if share > 1e-6)
        assert found == pytest.approx(sorted(known), abs=1e-8)


def test_random_orientations_descend_to_the_aspects():
    rng = np.random.default_rng(2)
    mesh = hull_of(rng)
    hull = Hull(mesh.vertices - mesh.center_mass)
    directions = rng.standard_normal((DROPS, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    # The weight acts through a face; the part rolls on over the edge of the triangle that the line
    # from its middle to the foot of the centre crosses, until the foot is inside.
    face = (hull.normals @ directions.T / hull.heights[:, None]).argmax(0)
    ends = np.array([descent(hull, one) for one in range(len(hull.heights))])
    counts = np.bincount(ends[face], minlength=len(hull.heights)) / DROPS
    shares = np.bincount(hull.ends, hull.solid_angles(), len(hull.heights))
    assert counts == pytest.approx(shares, abs=5 * 0.5 / DROPS**0.5)


def descent(hull, face):
    corners = {one: {*hull.facets[hull.faces == one].ravel()} for one in range(len(hull.heights))}
    while True:
        a, b, c = (hull.points[k] for k in corners[face])
        foot = hull.normals[face] * hull.heights[face]
        weights = np.linalg.solve(np.stack([a, b, c], axis=1), foot)
        if weights.min() >= 0:
            return face
        # Along the line each weight falls from 1/3: the first at 0 is that of the opposite corner.
        left = [*corners[face]][np.argmax(1 / 3 - weights)]
        edge = corners[face] - {left}
        face = next(one for one, ends in corners.items() if edge < ends and one != face)


def test_a_turned_part_rests_as_before():
    rng = np.random.default_rng(3)
    mesh = hull_of(rng)
    before = aspects_of(mesh)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    mesh.apply_translation([5.0, -7.0, 11.0])
    after = aspects_of(mesh)
    for one, other in zip(before, after, strict=True):
        for name in ("let_down_share", "thrown_share", "height", "length", "width", "base_along",
                     "base_across", "base_least", "gyration"):  # fmt: skip
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-8), name


def test_a_rounded_side_is_one_aspect():
    assert len(aspects_of(trimesh.creation.icosphere(4))) == 1
    angles = np.pi * np.arange(34) / 33
    rim = np.stack([5 * np.cos(angles), np.zeros(34), 5 * np.sin(angles)], axis=1)
    half = trimesh.convex.convex_hull(np.vstack([rim, rim + np.array([0, 14, 0])]))
    # On its flat face, on its round side, and on either end, which are mirror images.
    assert [round(one.height, 1) for one in aspects_of(half)] == [5, 5, 14]


def test_too_many_faces(monkeypatch):
    monkeypatch.setattr(vibrafeed.core.solid, "MAX_ASPECTS", 4)
    with pytest.raises(RoundedError, match="the part rests on 5 faces of its hull"):
        aspects_of(bracket())


def test_corners_that_rounding_makes_in_flat_faces_change_nothing():
    block = trimesh.creation.box((30, 20, 10)).subdivide().subdivide()
    nut = trimesh.creation.annulus(3, 6, 5, sections=6)  # the inner hexagon lies in both ends
    rng = np.random.default_rng(4)
    for mesh, aspects in [(block, 3), (nut, 2)] * 3:
        mesh.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
        mesh.vertices = mesh.vertices.astype(np.float32)
        assert len(aspects_of(mesh)) == aspects
