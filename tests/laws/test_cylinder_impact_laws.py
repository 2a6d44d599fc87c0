"""Laws of the impacts of two cylinders; tolerances are argued in `tests/helpers/impacts.py`."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from impacts import CLOSE, IMPACTS, LAWS, evaluate, mirrored, swapped, where


def unit(x: np.ndarray) -> np.ndarray:
    return x / np.linalg.norm(x, axis=0)


def angles(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.arctan2(axis[1], axis[0]), np.arcsin(np.clip(axis[2], -1, 1))


def axis_of(points: dict, body: str) -> np.ndarray:
    az, el = points[f"azimuth_{body}"], points[f"elevation_{body}"]
    return np.array([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)])


@functools.cache
def cylinders() -> dict[str, np.ndarray]:
    """Return IMPACTS pairs that touch in one point and approach: rims on faces and sides, sides.

    A point of body B's surface and its normal are drawn; body A is put on it with the point that
    comes first along the normal. Either of them is body 1.
    """
    random = np.random.default_rng(3344)
    n = 3 * IMPACTS
    size = 10 ** random.uniform(-3, -1, n)
    r_A, l_A = size * random.uniform(0.1, 0.5, n), size * random.uniform(0.1, 0.5, n)
    factor = size * 10 ** random.uniform(-0.5, 0.5, n)
    r_B, l_B = factor * random.uniform(0.1, 0.5, n), factor * random.uniform(0.1, 0.5, n)
    u_B = axis_of({"azimuth_B": random.uniform(-np.pi, np.pi, n),
                   "elevation_B": np.arcsin(random.uniform(-0.99, 0.99, n))}, "B")  # fmt: skip
    c_B = size * random.uniform(-1, 1, (3, n))
    radial = unit(np.cross(u_B, unit(random.normal(size=(3, n))), axis=0))
    kind = random.integers(0, 3, n)  # rim on face, rim on side, side on side
    end = random.choice([-1, 1], n)
    on_face = c_B + end * l_B * u_B + 0.95 * r_B * np.sqrt(random.uniform(size=n)) * radial
    on_side = c_B + 0.95 * l_B * random.uniform(-1, 1, n) * u_B + r_B * radial
    p, normal = (np.where(kind == 0, x, y) for x, y in ((on_face, on_side), (end * u_B, radial)))
    u_A = unit(random.normal(size=(3, n)))
    across = unit(u_A - (u_A * normal).sum(0) * normal)
    u_A = np.where(kind == 2, across, u_A)
    w = (u_A * normal).sum(0)
    down = unit(normal - w * u_A)
    along = np.where(kind == 2, 0.95 * random.uniform(-1, 1, n), -np.sign(w)) * l_A
    c_A = p - along * u_A + r_A * down
    # Leave out what is nearly a line or a plane.
    good = (np.abs(w) < 0.999) & ((kind == 2) | (np.abs(w) > 1e-3))
    good &= (kind != 2) | (np.abs((u_A * u_B).sum(0)) < 0.999)
    points: dict[str, np.ndarray] = {}
    for body, c, u, r, half in (("1", c_A, u_A, r_A, l_A), ("2", c_B, u_B, r_B, l_B)):
        for i, axis in enumerate("xyz"):
            points[f"position_{axis}_{body}"] = c[i]
            points[f"velocity_{axis}_{body}"] = random.normal(size=n)
            points[f"spin_{axis}_{body}"] = random.normal(size=n) / size
        points[f"azimuth_{body}"], points[f"elevation_{body}"] = angles(u)
        points[f"diameter_{body}"], points[f"length_{body}"] = 2 * r, 2 * half
        points[f"mass_{body}"] = 10 ** random.uniform(-3, 0, n)
    points["friction"] = random.choice([0.0, 1.5], n, p=[0.05, 0.95]) * random.uniform(0, 1, n)
    points["restitution"] = np.clip(random.uniform(-0.1, 1.1, n), 0, 1)
    other_way = random.uniform(size=n) < 0.5
    turned = swapped(points)
    points = {k: np.where(other_way, turned[k], v) for k, v in points.items()}
    at = evaluate("cylinder-pair-impact", "frictionless", points)
    found = at["contact_form"][good]
    expected = np.choose(kind, [1, 2, 4])[good]
    # The far rim of a body may reach through the other one; the rest is found as placed.
    overlapping = where(at, "overlap")[good]
    assert np.all((found == expected) | overlapping)
    assert overlapping.mean() < 0.05
    assert not np.any(where(at, "apart", "simultaneous")[good])
    chosen = np.flatnonzero(good & where(at, "impact"))[:IMPACTS]
    assert len(chosen) == IMPACTS
    return {k: v[chosen] for k, v in points.items()}


@functools.cache
def of_cylinders(law: str) -> dict[str, np.ndarray]:
    return evaluate("cylinder-pair-impact", law, cylinders())


def in_space(at: dict, name: str, end: str = "") -> np.ndarray:
    return np.array([at[f"{name.replace('#', a)}{end}"] for a in "xyz"])


def speeds_in_space(at: dict) -> np.ndarray:
    total = np.zeros(IMPACTS)
    for b in "12":
        arm = np.linalg.norm(in_space(at, "contact_#") - in_space(at, f"position_#_{b}"), axis=0)
        for end in ("", "_after"):
            total += np.linalg.norm(in_space(at, f"velocity_#_{b}", end), axis=0)
            total += arm * np.linalg.norm(in_space(at, f"spin_#_{b}", end), axis=0)
    return total


def inertial(at: dict, body: str, end: str) -> np.ndarray:
    """Return J w of a body."""
    m, d, h = (at[f"{name}_{body}"] for name in ("mass", "diameter", "length"))
    axial, transverse = m * d**2 / 8, m * (0.75 * d**2 + h**2) / 12
    u, w = axis_of(at, body), in_space(at, f"spin_#_{body}", end)
    return transverse * w + (axial - transverse) * (u * w).sum(0) * u


def energy_in_space(at: dict, end: str) -> np.ndarray:
    total = np.zeros(IMPACTS)
    for b in "12":
        v, w = in_space(at, f"velocity_#_{b}", end), in_space(at, f"spin_#_{b}", end)
        total += (at[f"mass_{b}"] * (v * v).sum(0) + (w * inertial(at, b, end)).sum(0)) / 2
    return total


@pytest.mark.parametrize("law", LAWS)
class TestCylinders:
    @pytest.mark.by_day(1)
    def test_every_one_is_an_impact_at_a_point(self, law):
        at = of_cylinders(law)
        assert np.all(where(at, "impact", "impact_stick", "impact_slip"))
        assert np.all(np.isin(at["contact_form"], (1, 2, 4)))
        assert np.all(np.abs(at["gap"]) <= 1e-12 * at["cylinder_contact"].size)
        if law != "frictionless":
            assert (
                min(where(at, "impact_stick").sum(), where(at, "impact_slip").sum()) > IMPACTS // 10
            )

    def test_momentum_is_kept(self, law):
        at = of_cylinders(law)
        linear, angular = np.zeros((3, IMPACTS)), np.zeros((3, IMPACTS))
        size, turning = np.zeros(IMPACTS), np.zeros(IMPACTS)
        for b in "12":
            c = in_space(at, f"position_#_{b}")
            for end, sign in (("", -1), ("_after", 1)):
                p = at[f"mass_{b}"] * in_space(at, f"velocity_#_{b}", end)
                own = inertial(at, b, end)
                linear += sign * p
                angular += sign * (np.cross(c, p, axis=0) + own)
                size += np.linalg.norm(p, axis=0)
                turning += np.linalg.norm(c, axis=0) * np.linalg.norm(p, axis=0)
                turning += np.linalg.norm(own, axis=0)
        assert np.all(np.abs(linear) <= CLOSE * size)
        assert np.all(np.abs(angular) <= CLOSE * turning)
        assert np.all(np.abs(in_space(at, "momentum_residual_#")) <= CLOSE * size)
        assert np.all(np.abs(in_space(at, "angular_momentum_residual_#")) <= CLOSE * turning)

    def test_friction_stays_in_its_disc(self, law):
        at = of_cylinders(law)
        L_N, L_T = at["impulse_normal"], at["impulse_friction"]
        assert np.all(L_N > 0)
        limit = at["friction"] * L_N if law != "frictionless" else 0 * L_N
        assert np.all(limit * (1 + CLOSE) >= L_T)
        if law == "frictionless":
            return
        slack = 1e-11 * speeds_in_space(at)  # the root of the sliding direction adds a few digits
        L, u = at["spatial_impulse"].tangential, at["spatial_approach"].tangential
        frame = at["contact_frame"]
        after = in_space(at, "velocity_#_1", "_after") - in_space(at, "velocity_#_2", "_after")
        for b, sign in (("1", 1), ("2", -1)):
            arm = in_space(at, "contact_#") - in_space(at, f"position_#_{b}")
            after += sign * np.cross(in_space(at, f"spin_#_{b}", "_after"), arm, axis=0)
        w = [(np.array(t) * after).sum(0) for t in (frame.tangent_1, frame.tangent_2)]
        if law == "moreau":
            w = [after + at["restitution"] * before for after, before in zip(w, u, strict=True)]
        sticks, slides = where(at, "impact_stick"), where(at, "impact_slip")
        assert np.all(np.hypot(*w)[sticks] <= slack[sticks])
        if law == "moreau":
            along, turn = w[0] * L[0] + w[1] * L[1], w[0] * L[1] - w[1] * L[0]
            assert np.all(np.abs(L_T - limit)[slides] <= CLOSE * limit[slides])
            assert np.all(np.abs(turn)[slides] <= (slack * L_T)[slides])
            assert np.all(along[slides] <= (slack * L_T)[slides])

    def test_the_bodies_separate_as_restitution_says(self, law):
        at = of_cylinders(law)
        after, slack = at["separation_normal"], CLOSE * speeds_in_space(at)
        assert np.all(after >= -slack)
        if law != "pfeiffer_glocker":
            assert np.all(np.abs(after + at["restitution"] * at["approach_normal"]) <= slack)

    def test_energy_is_never_created(self, law):
        at = of_cylinders(law)
        before, after = at["energy_before"], energy_in_space(at, "_after")
        assert np.all(np.abs(before - energy_in_space(at, "")) <= CLOSE * before)
        assert np.all(np.abs(before - after - at["energy_lost"]) <= CLOSE * before)
        assert np.all(at["energy_lost"] >= -CLOSE * before)

    @pytest.mark.by_day(1)
    def test_swapping_mirroring_and_turning_change_nothing(self, law):
        at, points = of_cylinders(law), cylinders()
        other = swapped(evaluate("cylinder-pair-impact", law, swapped(points)))
        self.same(at, {k.replace("_1_after", "#").replace("_2_after", "_1_after")
                        .replace("#", "_2_after"): v for k, v in other.items()})  # fmt: skip
        # y -> -y: polar y, axial x and z change sign
        flip = ("position_y", "velocity_y", "azimuth", "spin_x", "spin_z")
        other = evaluate("cylinder-pair-impact", law, mirrored(points, flip))
        for b in "12":
            for name in ("velocity_y", "spin_x", "spin_z"):
                other[f"{name}_{b}_after"] = -other[f"{name}_{b}_after"]
        self.same(at, other)
        turn = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        turned = dict(points)
        for b in "12":
            for name in ("position", "velocity", "spin"):
                vector = turn @ in_space(points, f"{name}_#_{b}")
                turned.update({f"{name}_{a}_{b}": vector[i] for i, a in enumerate("xyz")})
            turned[f"azimuth_{b}"], turned[f"elevation_{b}"] = angles(turn @ axis_of(points, b))
        other = evaluate("cylinder-pair-impact", law, turned)
        for b in "12":
            for name in ("velocity", "spin"):
                vector = turn.T @ in_space(other, f"{name}_#_{b}", "_after")
                other.update({f"{name}_{a}_{b}_after": vector[i] for i, a in enumerate("xyz")})
        self.same(at, other, 1e-8)  # asin of an axis near the pole loses half of the digits

    def same(self, at: dict, other: dict, close: float = 1e-10) -> None:
        """Assert that two evaluations agree; 1/sine of nearly parallel axes costs three digits."""
        scale = speeds_in_space(at)
        for b in "12":
            arm = np.minimum(at[f"diameter_{b}"], at[f"length_{b}"]) / 4
            for name, by in (("velocity", 1.0), ("spin", arm)):
                error = in_space(at, f"{name}_#_{b}", "_after") - in_space(
                    other, f"{name}_#_{b}", "_after"
                )
                assert np.all(np.abs(error) * by <= close * scale), name
        np.testing.assert_array_equal(at["contact_form"], other["contact_form"])
        reduced = 1 / at["delassus_normal"]
        error = np.abs(at["impulse_normal"] - other["impulse_normal"])
        assert np.all(error <= close * scale * reduced)
