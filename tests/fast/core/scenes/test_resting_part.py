"""Resting shares and toppling: worked values, measured throws, limits, descents, rocking."""

import re

import mpmath
import numpy as np
import pytest

import vibrafeed
from benchmarks.known_answers import known_answers
from night import count
from vibrafeed.core.mechanics import resting
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes.resting_part import ASPECTS

ROUNDING = 1e-14
"""Some ten roundings of numbers up to 1."""
MILLIMETRE = 1e-3


def part(shape, *outputs, **given):
    found = vibrafeed.sweep(scene="resting-part", variant=shape, outputs=outputs, **given)
    return [float(found[name]) for name in outputs]


def shares(shape, kind="let_down_share", **given):
    """Return the shares of a shape whose sizes are in mm."""
    sizes = {name: size * (1 if name == "sides" else MILLIMETRE) for name, size in given.items()}
    return part(shape, *(f"{kind}_{name}" for name in ASPECTS[shape]), **sizes)


# --- worked values, of the problem's own statement


def test_a_box_let_down_and_thrown():
    sizes = {"length": 3, "width": 2, "height": 1}
    assert shares("box", **sizes) == pytest.approx(
        [0.6450215619, 0.2427271960, 0.1122512421], abs=5e-11
    )
    assert shares("box", "thrown_share", **sizes) == pytest.approx(
        [0.8586676690, 0.1303972419, 0.0109350890], abs=5e-11
    )
    cube = shares("box", "thrown_share", length=1, width=1, height=1)
    assert cube == pytest.approx([1 / 3] * 3, abs=ROUNDING)


def seen(ends_x, ends_y, apart):
    """Return the share of directions in which a rectangle at a distance is seen, by its corners."""
    angle = sum(
        sign * np.arctan2(x * y, apart * np.sqrt(x * x + y * y + apart * apart))
        for sign, x, y in (
            (1, ends_x[1], ends_y[1]), (-1, ends_x[0], ends_y[1]),
            (-1, ends_x[1], ends_y[0]), (1, ends_x[0], ends_y[0]),
        )
    )  # fmt: skip
    return angle / (4.0 * np.pi)


@pytest.mark.parametrize("z", [5.0, 3.0, 0.5, 9.9])
def test_a_box_with_its_mass_off_the_middle(z):
    sizes = {"length": 30.0, "width": 20.0, "height": 10.0, "centre_of_mass": z}
    (x, y), (low, high) = (15.0, 10.0), (z, 10.0 - z)
    sides = 2.0 * seen((-x, x), (-low, high), y), 2.0 * seen((-y, y), (-low, high), x)
    let_down = [seen((-x, x), (-y, y), low), *sides, seen((-x, x), (-y, y), high)]
    assert sum(let_down) == pytest.approx(1.0, rel=1e-14)
    assert shares("weighted_box", **sizes) == pytest.approx(let_down, rel=1e-12)
    far = np.sqrt(x * x + y * y + max(low, high) ** 2)
    weights = np.array(let_down) * (far - np.array([low, y, x, high])) ** 2
    thrown = shares("weighted_box", "thrown_share", **sizes)
    assert thrown == pytest.approx(weights / weights.sum(), rel=1e-12)


def test_a_weighted_box_topples_about_its_own_centre_and_must_hold_it():
    (slope,) = part("weighted_box", "topple_slope", length=0.03, centre_of_mass=0.003)
    assert np.radians(slope) == pytest.approx(np.arctan(0.015 / 0.003), rel=1e-14)
    given = {"length": 0.03, "width": 0.02, "height": 0.01}
    found = vibrafeed.sweep(
        scene="resting-part", variant="weighted_box", outputs=["let_down_share_flat"], **given,
        centre_of_mass=0.011,
    )  # fmt: skip
    assert int(found.regime) == REGIMES["invalid_geometry"].value
    assert np.isnan(found.let_down_share_flat)


@pytest.mark.parametrize(
    ("device", "passing"),
    [({"ledge_width_1": "4 mm"}, [0, 0.5, 0.5, 0]), ({"ledge_width_1": "9 mm"}, [0, 1, 1, 0]),
     ({"ledge_width_1": "4 mm", "ledge_width_2": "4 mm"}, [0, 0.5, 0.5, 0]),
     ({"gap_length_1": "12 mm"}, [1, 1, 0, 1]), ({"wiper_height_1": "15 mm"}, [1, 0, 0, 1])],
)  # fmt: skip
def test_devices_see_either_way_round_of_a_weighted_box(device, passing):
    """On its side its centre is 3 mm off the middle, towards the wall or away from it."""
    names = [f"passing_share_{aspect}" for aspect in ASPECTS["weighted_box"]]
    found = vibrafeed.sweep(
        scene="orienting-line", variant="weighted_box", length="30 mm", width="20 mm",
        height="10 mm", centre_of_mass="2 mm", outputs=names, **device,
    )  # fmt: skip
    assert [float(found[name]) for name in names] == passing


@pytest.mark.parametrize(
    ("length", "end"), [(1, 0.2928932188), (2, 0.1055728090), (0.5, 0.5527864045)]
)
def test_a_cylinder_let_down(length, end):
    assert shares("cylinder", length=length, diameter=1)[1] == pytest.approx(end, abs=5e-11)


def test_the_bracket_of_both_shares_holds_measured_dice():
    # 9,329 throws of 15 steel cuboids; two of them lie further outside, by 4.4 and 5.4 points.
    dice = [one for one in known_answers("dice") if one.name.startswith("D-thrown")]
    assert sum(one.inputs["throws"] for one in dice) == 9329
    measured = np.array([one.value for one in dice])
    ends = np.array([
        [shares("box", kind, length=one.inputs["ratio"], width=1, height=1)[2] for one in dice]
        for kind in ("let_down_share", "thrown_share")
    ])  # fmt: skip
    assert np.sqrt(np.mean((ends[1] - measured) ** 2)) < 0.032
    outside = np.maximum(ends.min(axis=0) - measured, measured - ends.max(axis=0))
    assert (outside <= 0.03).sum() == 13
    assert outside.max() < 0.055


def test_truncated_and_full_cones():
    sizes = {"diameter": 20.0, "small_diameter": 12.0, "height": 20.0}
    known = [0.1791386837, 0.7652331257, 0.0556281907]
    assert shares("truncated_cone", **sizes) == pytest.approx(known, abs=5e-11)
    centre = resting.cone_centre(**sizes)
    foot = resting.side_foot(**sizes, mass_height=centre)
    assert [centre, foot] == pytest.approx([8.367346939, 0.498430141], abs=5e-10)
    for height, base in ((20, 0.2763932023), (10, 0.3787321875)):
        full = shares("truncated_cone", diameter=20, small_diameter=0, height=height)
        assert full == pytest.approx([base, 1 - base, 0], abs=5e-11)


def test_rectangles_at_a_wall():
    (found,) = part("box", "long_side_share", length=0.02, width=0.01)
    assert found == pytest.approx(0.7048328, abs=5e-8)


# --- laws: shares add up, shapes that become one another


def random_sizes(cells, *names, seed=39):
    random = np.random.default_rng(seed)
    return {name: 10 ** random.uniform(-3, -1, cells) for name in names}


@pytest.mark.parametrize(
    ("shape", "names"),
    [
        ("box", ("length", "width", "height")),
        ("cylinder", ("length", "diameter")),
        ("prism", ("length", "diameter")),
        ("turned", ("diameter", "small_diameter", "height")),
    ],
)
def test_shares_add_up_to_one(shape, names):
    sizes = random_sizes(5_000, *names)
    random = np.random.default_rng(1)
    if shape == "prism":
        sizes["sides"] = random.integers(3, 40, 5_000).astype(float)
    if shape == "turned":
        sizes["mass_height"] = sizes["height"] * random.uniform(0, 1, 5_000)
        sizes["side_foot"] = resting.side_foot(**sizes)
        assert {True, False} == set(resting.is_side_unstable(side_foot=sizes["side_foot"]))
    found = getattr(resting, f"{shape}_shares")(**sizes)
    depths = getattr(resting, f"{shape}_depths")(**sizes)
    for each in (found, resting.thrown_shares(let_down_shares=found, depths=depths)):
        assert np.all(np.array(each) >= 0)
        assert np.abs(sum(each) - 1).max() < ROUNDING


def thrown_boxes(**sizes):
    return resting.thrown_shares(
        let_down_shares=resting.box_shares(**sizes), depths=resting.box_depths(**sizes)
    )


@pytest.mark.parametrize("shape", ["box", "cylinder", "prism", "turned"])
def test_depths_are_those_of_the_farthest_point(shape):
    random = np.random.default_rng(12)
    for _ in range(20):
        a, b, c = random.uniform(2, 20, 3)
        low = c * random.uniform(0.1, 0.9)
        sizes = {
            "box": {"length": a, "width": b, "height": c}, "cylinder": {"length": a, "diameter": b},
            "prism": {"sides": 5.0, "length": a, "diameter": b},
            "turned": {"diameter": a, "small_diameter": b, "height": c, "mass_height": low},
        }[shape]  # fmt: skip
        farthest = {
            "box": np.sqrt(a * a + b * b + c * c) / 2, "cylinder": np.hypot(a, b) / 2,
            "prism": np.hypot(a, b) / 2,
            "turned": max(np.hypot(a / 2, low), np.hypot(b / 2, c - low)),
        }[shape]  # fmt: skip
        heights = getattr(resting, f"{shape}_centres")(**sizes)
        if shape == "turned":
            sizes["side_foot"] = resting.side_foot(**sizes)
        depths = getattr(resting, f"{shape}_depths")(**sizes)
        assert depths == pytest.approx([farthest - h for h in heights], abs=1e-13)


def test_the_depth_of_a_needle_keeps_its_digits():
    # R - h of a needle that stands on its end: (d/2)^2/(R + h), 1e-14 of its length.
    _, end = resting.cylinder_depths(length=1.0, diameter=2e-7)
    assert end == pytest.approx(1e-14, rel=1e-13)


def test_prisms_become_boxes_and_cylinders_and_cones_cylinders():
    length, diameter = random_sizes(1_000, "length", "diameter").values()
    side = diameter / np.sqrt(2)
    ends = {"length": length, "diameter": diameter}
    boxed = {"length": length, "width": side, "height": side}
    flat, on_side, end = resting.box_shares(**boxed)
    four = resting.prism_shares(sides=np.float64(4), **ends)
    assert np.abs(four - np.array([flat + on_side, end])).max() < ROUNDING
    thrown = thrown_boxes(**boxed)
    depths = resting.prism_depths(sides=np.float64(4), **ends)
    four = resting.thrown_shares(let_down_shares=four, depths=depths)
    assert np.abs(four - np.array([thrown[0] + thrown[1], thrown[2]])).max() < ROUNDING
    for name, rel in (("shares", 1e-13), ("depths", 1e-13), ("gyration", 1e-13)):
        many = getattr(resting, f"prism_{name}")(sides=np.float64(1e8), **ends)
        round_ = getattr(resting, f"cylinder_{name}")(**ends)
        # n-gons differ by 1/n^2
        np.testing.assert_allclose(many, round_, rtol=rel, atol=ROUNDING)
    sizes = {"diameter": diameter, "small_diameter": diameter, "height": length}
    sizes["mass_height"] = resting.cone_centre(**sizes)
    round_ = resting.cylinder_gyration(**ends)
    assert resting.cone_gyration(**sizes) == pytest.approx(round_, rel=1e-13)
    foot = resting.side_foot(**sizes)
    up, lying, down = resting.turned_shares(**sizes, side_foot=foot)
    round_ = resting.cylinder_shares(**ends)
    assert np.abs(np.array([lying, up + down]) - round_).max() < ROUNDING
    up, lying, down = resting.turned_depths(**sizes, side_foot=foot)
    lies, stands = resting.cylinder_depths(**ends)
    assert [lying, up, down] == pytest.approx(np.array([lies, stands, stands]), rel=1e-9)


def test_an_unstable_side_hands_its_share_on():
    sizes = {"diameter": "20 mm", "small_diameter": "12 mm", "height": "10 mm"}
    kinds = ("let_down", "thrown")
    names = [[f"{kind}_share_{name}" for name in ASPECTS["turned"]] for kind in kinds]
    top = vibrafeed.sweep(
        scene="resting-part", variant="turned", outputs=[*names[0], *names[1]], **sizes,
        centre_of_mass=["1 mm", "4 mm", "9 mm", "11 mm"],
    )  # fmt: skip
    states = ("contact", "contact", "unstable_side", "invalid_geometry")
    assert top.regime.values.tolist() == [REGIMES[name].value for name in states]
    for kind in names:
        upright, lying, inverted = (top[name].values for name in kind)
        assert (lying > 0).tolist()[:3] == [True, True, False]
        assert inverted[2] > inverted[1]
        assert upright[2] + inverted[2] == pytest.approx(1, abs=ROUNDING)


# --- a slow descent, by a program that knows points of a body and nothing of solid angles


def turned_descent(points, directions):
    """Return the angle from the axis at which a turned body ends, for angles in which it starts.

    `points` are rims (radius, height above the centre); the angle is that of the weight.
    """
    grid = np.linspace(0, np.pi, 4001)
    heights = (np.sin(grid)[:, None] * points[:, 0] + np.cos(grid)[:, None] * points[:, 1]).max(1)
    falls = np.argmin(
        [heights, np.append(heights[1:], np.inf), np.insert(heights[:-1], 0, np.inf)], axis=0
    )
    ends = np.arange(grid.size) + np.array([0, 1, -1])[falls]
    for _ in range(13):  # 2^13 steps of the grid
        ends = ends[ends]
    return grid[ends[np.rint(directions / grid[1]).astype(int)]]


def agree(found, expected, samples):
    """Compare counts with shares: five standard deviations, and 0.002 for finite steps."""
    scatter = 5 * np.sqrt(np.array(expected) * (1 - np.array(expected)) / samples)
    assert np.all(np.abs(np.array(found) - expected) < scatter + 0.002)


def test_turned_bodies_by_descent():
    random, samples = np.random.default_rng(5), count(20_000, 100_000)
    for _ in range(count(12, 50)):
        big, small, height = random.uniform(2, 20, 3)
        centre = height * random.uniform(0.02, 0.98)
        points = np.array([(big / 2, -centre), (small / 2, height - centre)])
        ends = turned_descent(points, np.arccos(random.uniform(-1, 1, samples)))
        found = [(ends > 3.1).mean(), ((ends < 3.1) & (ends > 0.01)).mean(), (ends < 0.01).mean()]
        agree(
            found,
            shares("turned", diameter=big, small_diameter=small, height=height,
                   centre_of_mass=centre),
            samples,
        )  # fmt: skip


# --- toppling


def test_a_standing_block_at_a_stop():
    outputs = ("topple_speed", "rocking_rate", "topple_slope", "rocking_friction")
    found = part("box", *outputs, length="10 mm", height="30 mm")
    known = [0.153545757, 21.567806, np.degrees(np.arctan(1 / 3)), 1 / 3]
    assert found == pytest.approx(known, rel=5e-8)


def test_a_part_stands_that_never_rocks_or_is_shaken_slowly():
    block = {"length": "10 mm", "height": "30 mm", "beta": "20 deg"}
    for given, outputs in (
        ({"amplitude": "0.1 mm", "frequency": [50, 200]}, ["topple_margin"]),
        ({"amplitude": "0.3 mm", "frequency": 50, "friction_static": [0.3, 0.5]},
         ["topple_margin", "rocking_margin"]),
    ):  # fmt: skip
        found = vibrafeed.sweep(scene="resting-part", outputs=outputs, **block, **given)
        states = [REGIMES[name].value for name in ("stands", "may_topple")]
        assert found.regime.values.tolist() == states
    assert found.topple_margin.values < 0
    assert found.rocking_margin.values == pytest.approx([0.3 - 1 / 3, 0.5 - 1 / 3], abs=1e-15)


def test_a_stop_by_energy():
    # Angular momentum m V z_c about the edge becomes I_o w; I_o w^2/2 lifts the centre to R.
    g = 9.80665
    for shape, sizes in (
        ("cylinder", {"length": 0.03, "diameter": 0.01}),
        ("prism", {"length": 0.03, "diameter": 0.01, "sides": 6}),
        ("truncated_cone", {"height": 0.03, "diameter": 0.01, "small_diameter": 0.006}),
        ("turned", {"diameter": 0.01, "centre_of_mass": 0.01, "radius_of_gyration": 0.02}),
    ):  # fmt: skip
        found = vibrafeed.sweep(scene="resting-part", variant=shape, **sizes,
                                outputs=["topple_speed", "edge_distance", "rocking_friction",
                                         "rocking_rate"])  # fmt: skip
        edge, ratio = float(found.edge_distance), float(found.rocking_friction)
        z = edge / np.hypot(1, ratio)
        turning = g * edge / float(found.rocking_rate) ** 2  # I_o/m
        rate = float(found.topple_speed) * z / turning
        assert turning * rate**2 / 2 == pytest.approx(g * (edge - z), rel=1e-12)


@pytest.mark.parametrize(
    ("q", "peak"), [(0.02, 25.785451), (0.1, 5.786522), (0.5, 1.800724), (1, 1.322397)]
)
def test_a_pulse_that_topples(q, peak):
    psi = resting.pulse_angle(rocking_rate=q, frequency=1 / (2 * np.pi))
    assert 1 / np.sin(psi) == pytest.approx(peak, abs=5e-7)


def test_the_root_of_the_pulse_to_many_digits():
    q = np.append(10 ** np.random.default_rng(3).uniform(-6, 6, 300), [0.3, 0.6, 1, 2])
    found = resting.pulse_angle(rocking_rate=q, frequency=1 / (2 * np.pi))
    with mpmath.workdps(30):
        for rate, psi in zip(2 * np.pi * (q * (1 / (2 * np.pi))), found, strict=True):
            p, x = mpmath.mpf(float(rate)), mpmath.mpf(float(psi))
            f = mpmath.sin(x) - p * (mpmath.cos(x) + mpmath.exp(-p * (mpmath.pi - x)))
            slope = mpmath.cos(x) + p * mpmath.sin(x) - p * p * mpmath.exp(-p * (mpmath.pi - x))
            # The root is off by f/slope; rounding of q and psi leaves some 1e-16 of each.
            assert abs(f / slope) < 1e-14 * x


def test_the_largest_push_over_load_by_many_phases():
    random, sines = np.random.default_rng(7), np.sin(np.linspace(0, 2 * np.pi, 100_001))
    for _ in range(20):
        beta, gamma, peak = random.uniform(-60, 60), random.uniform(-20, 20), random.uniform(0, 8)
        (found,) = part("box", "push_over_load", frequency=1 / (2 * np.pi), amplitude=peak,
                        beta=beta, gamma=gamma, gravity=9.8)  # fmt: skip
        b, g = np.radians([beta, gamma])
        push = peak * np.cos(b) * sines - 9.8 * np.sin(g)
        load = 9.8 * np.cos(g) - peak * np.sin(b) * sines
        # A phase nearest to the peak is off by 3e-5 at most: its square, times a slope.
        most = np.max(np.abs(push) / load) if load.min() > 1e-3 else np.inf
        assert found == pytest.approx(most, rel=1e-6)


def test_a_cone_agrees_with_fifty_digits():
    found = vibrafeed.sweep(
        scene="resting-part", variant="truncated_cone", diameter="20 mm", frequency=[10, 100],
        small_diameter={"start": "1 mm", "stop": "20 mm", "num": 20}, height=["5 mm", "40 mm"],
        outputs=["let_down_share_upright", "thrown_share_on_side", "topple_acceleration"],
        verify=20,
    )  # fmt: skip
    error = re.search(r"error ([^\s,]+)", found.attrs["verified_worst"])
    assert float(error[1]) < ROUNDING
