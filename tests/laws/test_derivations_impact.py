"""Impacts of pairs: rates of the gap, inertias and impulse derived by sympy, against the scenes.

A corner of body 1 stands on the long face of body 2, both anywhere. Numbers in brackets are the
source's equations.
"""

import numpy as np
import pytest
import sympy as sp

from plans import quantities_at

RANDOM = np.random.default_rng(6)
POINTS = 200
t = sp.symbols("t")
NAMES = {
    "length": (0.02, 0.05), "width": (0.005, 0.015), "mass": (0.002, 0.02),
    "velocity_x": (-1, 1), "velocity_y": (-1, 1), "spin": (-20, 20),
}  # fmt: skip


@pytest.fixture(scope="module")
def points() -> dict[str, np.ndarray]:
    """Return placements with corner (-length, -width) of body 1 on the +width face of body 2."""
    at = {
        f"{name}_{body}": RANDOM.uniform(*ends, POINTS)
        for name, ends in NAMES.items()
        for body in (1, 2)
    }
    at["angle_2"] = RANDOM.uniform(-3, 3, POINTS)
    at["angle_1"] = at["angle_2"] + RANDOM.uniform(0.2, 1.3, POINTS)
    at["position_x_2"], at["position_y_2"] = RANDOM.uniform(-0.1, 0.1, (2, POINTS))
    c, s = np.cos(at["angle_2"]), np.sin(at["angle_2"])
    along, up = RANDOM.uniform(-0.4, 0.4, POINTS) * at["length_2"], at["width_2"] / 2
    corner_x = at["position_x_2"] + c * along - s * up
    corner_y = at["position_y_2"] + s * along + c * up
    c, s = np.cos(at["angle_1"]), np.sin(at["angle_1"])
    at["position_x_1"] = corner_x + (c * at["length_1"] - s * at["width_1"]) / 2
    at["position_y_1"] = corner_y + (s * at["length_1"] + c * at["width_1"]) / 2
    at["restitution"] = RANDOM.uniform(0, 1, POINTS)
    return at


def turn(angle: sp.Expr) -> sp.Matrix:
    return sp.Matrix([[sp.cos(angle), -sp.sin(angle)], [sp.sin(angle), sp.cos(angle)]])


def symbols_of(points: dict[str, np.ndarray]) -> dict[str, sp.Symbol]:
    return {name: sp.symbols(name, real=True) for name in points}


def numbers(expression: sp.Expr, points: dict[str, np.ndarray]) -> np.ndarray:
    function = sp.lambdify([sp.symbols(name, real=True) for name in points], expression, "numpy")
    return np.broadcast_to(function(*points.values()), (POINTS,))


def placed(p: dict[str, sp.Symbol], moving: bool = False) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """Return corner, centre of body 2 and face normal; as functions of time if they move."""
    time = t if moving else sp.Integer(0)
    r1, r2 = (
        sp.Matrix(
            [p[f"position_{axis}_{body}"] + p[f"velocity_{axis}_{body}"] * time for axis in "xy"]
        )
        for body in (1, 2)
    )
    one, two = (turn(p[f"angle_{body}"] + p[f"spin_{body}"] * time) for body in (1, 2))
    corner = r1 + one * sp.Matrix([-p["length_1"], -p["width_1"]]) / 2
    return corner, r2, two * sp.Matrix([0, 1])


def test_the_rates_of_the_contact_point_3_20_3_21(points):
    """Errata 12 to 14: body-fixed corner, turned and moved, differentiated in time."""
    p = symbols_of(points)
    corner, r2, normal = placed(p, moving=True)
    gap = normal.dot(corner - r2) - p["width_2"] / 2
    got = quantities_at(
        "rectangle-pair-impact", "frictionless", ["gap", "approach_normal", "normal_x"], points
    )
    # a sum of lengths of a tenth of a metre, and of speeds of a metre a second
    np.testing.assert_allclose(got["gap"], numbers(gap.subs(t, 0), points), rtol=0, atol=1e-15)
    rate = numbers(sp.diff(gap, t).subs(t, 0), points)
    np.testing.assert_allclose(got["approach_normal"], rate, rtol=0, atol=1e-14)
    np.testing.assert_allclose(got["normal_x"], numbers(normal[0].subs(t, 0), points), atol=1e-15)


def test_the_impulse_of_3_24_and_3_44(points):
    """Erratum 16: momentum balances and Newton's law give -(1 + eps); (1 - eps) drives inwards."""
    p = symbols_of(points)
    corner, r2, normal = placed(p)
    r1 = sp.Matrix([p["position_x_1"], p["position_y_1"]])
    names = ["velocity_x_1", "velocity_y_1", "spin_1", "velocity_x_2", "velocity_y_2", "spin_2"]
    unknown = sp.symbols([*names, "impulse"])
    equations, approach, after = [], sp.Integer(0), sp.Integer(0)
    for place, sign, centre in ((0, 1, r1), (3, -1, r2)):
        body, arm = names[place][-1], corner - centre
        m = p[f"mass_{body}"]
        inertia = m * (p[f"length_{body}"] ** 2 + p[f"width_{body}"] ** 2) / 12
        direction = [*normal, arm[0] * normal[1] - arm[1] * normal[0]]
        for k in range(3):
            old, new = p[names[place + k]], unknown[place + k]
            size = inertia if k == 2 else m
            equations.append(size * (new - old) - sign * unknown[-1] * direction[k])
            approach += sign * direction[k] * old
            after += sign * direction[k] * new
    newton = after + p["restitution"] * approach
    matrix, right = sp.linear_eq_to_matrix([*equations, newton], unknown)
    rows = np.stack([numbers(entry, points) for entry in matrix], -1).reshape(POINTS, 7, 7)
    side = np.stack([numbers(entry, points) for entry in right], -1)
    solved = np.linalg.solve(rows, side[..., None])[..., 0].T
    after_names = [f"{name}_after" for name in names]
    outputs = ["approach_normal", *after_names, "impulse_normal"]
    got = quantities_at("rectangle-pair-impact", "frictionless", outputs, points)
    hits = got["approach_normal"] < 0
    assert hits.sum() > 50
    for name, expected in zip([*after_names, "impulse_normal"], solved, strict=True):
        # Speeds of a metre a second, spins of some hundred radians a second; the linear solve is
        # conditioned by masses over inertias, some 1e5.
        atol = 1e-12 if "v" in name else 1e-10
        np.testing.assert_allclose(got[name][hits], expected[hits], rtol=1e-10, atol=atol)


def test_contact_points_have_no_inertia_of_their_own(points):
    """Erratum 15: the moment of inertia is the integral over the footprint h x a, nothing more."""
    x, y, h, a, m = sp.symbols("x y h a m", positive=True)
    integral = sp.integrate(
        sp.integrate(m / (a * h) * (x**2 + y**2), (x, -h / 2, h / 2)), (y, -a / 2, a / 2)
    )
    got = quantities_at(
        "rectangle-pair-impact", "frictionless", ["inertia_1", "impulse_normal"], points
    )
    function = sp.lambdify([h, a, m], integral, "numpy")
    expected = function(points["length_1"], points["width_1"], points["mass_1"])
    np.testing.assert_allclose(got["inertia_1"], expected, rtol=1e-14)


def test_the_axial_inertia_of_a_cylinder():
    """Erratum 23: m d^2/8 about the axis, m (3/4 d^2 + h^2)/12 across it, by integration."""
    radius, angle, z, d, h, m = sp.symbols("radius angle z d h m", positive=True)
    density = m / (sp.pi * d**2 / 4 * h)

    def integral(square: sp.Expr) -> sp.Expr:
        inner = sp.integrate(density * square * radius, (radius, 0, d / 2))
        return sp.integrate(sp.integrate(inner, (angle, 0, 2 * sp.pi)), (z, -h / 2, h / 2))

    axial, across = integral(radius**2), integral((radius * sp.sin(angle)) ** 2 + z**2)
    assert sp.simplify(axial - m * d**2 / 8) == 0
    assert sp.simplify(across - m * (sp.Rational(3, 4) * d**2 + h**2) / 12) == 0
    names = ("velocity_x", "velocity_y", "velocity_z", "spin_x", "spin_y", "spin_z", "azimuth",
             "elevation", "position_x", "position_y", "position_z")  # fmt: skip
    body = {**dict.fromkeys(names, 0.0), "diameter": 0.02, "length": 0.05, "mass": 0.3}
    both = {f"{name}_{n}": np.asarray(value) for name, value in body.items() for n in (1, 2)}
    both["position_z_1"] = np.asarray(0.02)
    for spin, expected in (("spin_x_1", axial), ("spin_z_1", across)):
        at = both | {spin: np.asarray(7.0)}
        got = quantities_at("cylinder-pair-impact", "frictionless", ["energy_before"], at)
        value = float(expected.subs({m: 0.3, d: 0.02, h: 0.05})) * 7**2 / 2
        assert float(got["energy_before"]) == pytest.approx(value, rel=1e-14)
