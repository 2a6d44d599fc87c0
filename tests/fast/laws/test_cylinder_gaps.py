"""The gap of two cylinders against a distance that is found without any form of contact.

The witness projects two points onto the bodies in turn, with momentum. Their distance is never
below the true one, and what their direction separates, by the support functions, never above it:
both ends enclose the distance, and share no code with what is tested.
"""

import numpy as np
import pytest

import vibrafeed
from night import count
from vibrafeed.core.mechanics.cylinder_contact import Cylinder, cylinder_contact
from vibrafeed.core.mechanics.cylinder_impact import is_apart
from vibrafeed.core.quantities import REGIMES

PAIRS, STEPS = count(day=40, night=200), count(day=400, night=1000)
# A contact that rises by less counts as a line or a face:
# `vibrafeed.core.mechanics.rectangle_contact.ALIKE`.
ALIKE = 1e-9

WASHER, ROD, BLOCK = (10e-3, 0.5e-3), (1e-3, 10e-3), (5e-3, 5e-3)  # radius, half length [m]
FAMILIES = {
    "washers": (WASHER, WASHER, "any", 14e-3),
    "rods": (ROD, ROD, "any", 9e-3),
    "as long as wide": (BLOCK, BLOCK, "any", 8e-3),
    "washer and rod": (WASHER, ROD, "any", 12e-3),
    "sheets": ((10e-3, 1e-6), (10e-3, 1e-6), "any", 12e-3),
    "parallel washers": (WASHER, WASHER, "parallel", 14e-3),
    "parallel rods": (ROD, ROD, "parallel", 9e-3),
    "crossed washers": (WASHER, WASHER, "crossed", 14e-3),
    "crossed rods": (ROD, ROD, "crossed", 9e-3),
    "nearly parallel washers": (WASHER, WASHER, "nearly", 14e-3),
}


def unit(vector):
    return vector / np.linalg.norm(vector, axis=0)


def random_pair(family: str) -> tuple[Cylinder, Cylinder]:
    of_1, of_2, axes, reach = FAMILIES[family]
    random = np.random.default_rng(2004)
    u_1, u_2 = (unit(random.normal(size=(3, PAIRS))) for _ in range(2))
    lean = 10 ** random.uniform(-3, -1, PAIRS)
    u_2 = {
        "any": u_2,
        "parallel": u_1,
        "crossed": unit(np.cross(u_1, u_2, axis=0)),
        "nearly": unit(u_1 + lean * u_2),
    }[axes]
    bodies = []
    for axis, (radius, half) in ((u_1, of_1), (u_2, of_2)):
        centre = random.uniform(-reach, reach, (3, PAIRS))
        sizes = np.full(PAIRS, radius), np.full(PAIRS, half)
        bodies.append(Cylinder(tuple(centre), tuple(axis), *sizes))
    return bodies[0], bodies[1]


def projected(point, body):
    """Return the point of a body that is nearest to a point."""
    axis, away = np.array(body.axis), point - np.array(body.centre)
    height = np.sum(away * axis, axis=0)
    off = away - height * axis
    far = np.maximum(np.linalg.norm(off, axis=0), 1e-300)
    inside = np.minimum(1.0, body.radius / far)
    return np.array(body.centre) + np.clip(height, -body.half, body.half) * axis + off * inside


def reach(body, n):
    axis = np.array(body.axis)
    along = np.sum(n * axis, axis=0)
    return body.half * np.abs(along) + body.radius * np.linalg.norm(n - along * axis, axis=0)


def enclosed(one, two):
    """Return a lower and an upper bound of the distance; the lower one is negative in overlap."""
    x, y = np.array(one.centre), np.array(two.centre)
    x_before, y_before, t = x, y, np.ones(PAIRS)
    low, high = np.full(PAIRS, -np.inf), np.full(PAIRS, np.inf)
    for _ in range(STEPS):
        t_next = (1 + np.sqrt(1 + 4 * t * t)) / 2
        ahead = (t - 1) / t_next
        u, v = x + ahead * (x - x_before), y + ahead * (y - y_before)
        half_way = (u - v) / 2
        x_new, y_new = projected(u - half_way, one), projected(v + half_way, two)
        turns = np.sum((u - x_new) * (x_new - x) + (v - y_new) * (y_new - y), axis=0) > 0
        t, x_before, y_before, x, y = np.where(turns, 1.0, t_next), x, y, x_new, y_new
        between = x - y
        distance = np.linalg.norm(between, axis=0)
        n = between / np.maximum(distance, 1e-300)
        apart = np.sum(n * (np.array(one.centre) - np.array(two.centre)), axis=0)
        low = np.maximum(low, apart - reach(one, n) - reach(two, n))
        high = np.minimum(high, distance)
    return low, high


@pytest.mark.parametrize("family", FAMILIES)
def test_a_gap_is_the_distance_of_the_bodies(family):
    one, two = random_pair(family)
    low, high = enclosed(one, two)
    at = cylinder_contact(cylinder_1=one, cylinder_2=two)
    near, meet = ALIKE * at.size, high <= 1e-12
    apart = low > near
    assert apart.sum() > 0.1 * PAIRS
    assert np.all((at.gap >= low - near)[apart])
    assert np.all((at.gap <= high + near)[apart])
    assert np.all(is_apart(cylinder_contact=at, contact_tolerance=ALIKE)[apart])
    assert np.all(at.gap[meet] <= near[meet])
    # The witness has closed in: what it encloses tells gaps apart.
    assert np.median((high - low)[apart] / at.size[apart]) < 1e-9
    # From the nearest point of body 2 the gap leads along the normal onto body 1.
    rims, first = apart & (at.form == 0), np.array(at.first)
    for met, body in ((first + at.gap * np.array(at.normal), one), (first, two)):
        np.testing.assert_allclose(projected(met, body)[:, rims], met[:, rims], rtol=0, atol=1e-15)


def test_two_washers_that_were_said_to_overlap():
    result = vibrafeed.sweep(
        scene="cylinder-pair-impact", outputs=["gap"],
        diameter_1=0.02, diameter_2=0.02, length_1=1e-3, length_2=1e-3,
        azimuth_1=-99.71571014192888, azimuth_2=-9.71571014192888,
        elevation_1=-60.201986682670935, elevation_2=49.90047630987742,
        position_x_1=0.0, position_y_1=0.0, position_z_1=0.0,
        position_x_2=-0.0061010771866972366, position_y_2=-0.012750910292771724,
        position_z_2=0.013618784114556727,
    )  # fmt: skip
    assert float(result.gap) == pytest.approx(2.397e-3, abs=5e-7)
    assert int(result.regime) == REGIMES["apart"].value


@pytest.mark.parametrize("family", ["washers", "as long as wide"])
def test_a_pair_does_not_depend_on_those_beside_it(family):
    one, two = random_pair(family)
    whole = cylinder_contact(cylinder_1=one, cylinder_2=two)

    def cell(body, k):
        centre, axis = (tuple(part[k : k + 1] for part in v) for v in (body.centre, body.axis))
        return Cylinder(centre, axis, body.radius[k : k + 1], body.half[k : k + 1])

    for k in range(0, PAIRS, 3):
        alone = cylinder_contact(cylinder_1=cell(one, k), cylinder_2=cell(two, k))
        for of_all, of_one in zip(whole, alone, strict=True):
            assert np.array_equal(np.array(of_all)[..., k], np.array(of_one)[..., 0]), k
