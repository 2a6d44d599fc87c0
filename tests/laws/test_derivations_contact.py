"""The source's results for planes and the narrow track, derived anew from free bodies by sympy.

Each derivation starts from balances of forces and moments, not from the code, and is then compared
with the code at random points. Numbers in brackets are equations of the source.
"""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from vibrafeed.core.mechanics import floor, rolling, travel, wall

RANDOM = np.random.default_rng(3)
POINTS = 200
P, g, mu, mu_s, v, R, m = sp.symbols("P g mu mu_s v R m", positive=True)
a, b, h, d, c, x = sp.symbols("a b h d c x", positive=True)
alpha, beta, gamma, delta, theta = sp.symbols("alpha beta gamma delta theta", real=True)

RANGES = {
    P: (1, 200), g: (9, 10), mu: (0.05, 1), mu_s: (0.05, 1), v: (0, 2), R: (0.1, 2), m: (0.001, 1),
    a: (0.001, 0.004), b: (0.005, 0.02), h: (0.02, 0.1), d: (0.002, 0.02), c: (0.9, 1),
    x: (1e-4, 1e-1), alpha: (-1, 1), beta: (-1, 1), gamma: (-0.3, 0.3), delta: (0, 0.5),
    theta: (-3, 3),
}  # fmt: skip
AT = {symbol: RANDOM.uniform(*ends, POINTS) for symbol, ends in RANGES.items()}


def numbers(expression: sp.Expr) -> np.ndarray:
    """Return the values of an expression at the random points."""
    symbols = list(RANGES)
    function = sp.lambdify(symbols, expression, "numpy")
    return np.broadcast_to(function(*(AT[s] for s in symbols)), (POINTS,))


def agree(got: np.ndarray, expression: sp.Expr, size: float = 1.0) -> None:
    """Assert agreement to what the rounding of a dozen operations on terms of `size` allows."""
    expected = numbers(expression)
    scale = np.maximum(np.abs(expected), size)
    np.testing.assert_array_less(np.abs(got - expected), 1e-13 * scale + 1e-300)


DRIVE = sp.Matrix(
    [P * sp.cos(beta) * sp.cos(alpha), P * sp.cos(beta) * sp.sin(alpha), P * sp.sin(beta)]
)


def weight(climb: sp.Symbol, lean: sp.Expr) -> sp.Matrix:
    """Return gravity in track axes from the rotations of (3.13), climb first, then lean."""
    about_y = sp.Matrix(
        [[sp.cos(climb), 0, sp.sin(climb)], [0, 1, 0], [-sp.sin(climb), 0, sp.cos(climb)]]
    )
    about_x = sp.Matrix(
        [[1, 0, 0], [0, sp.cos(lean), -sp.sin(lean)], [0, sp.sin(lean), sp.cos(lean)]]
    )
    return about_x.T * about_y * sp.Matrix([0, 0, -g])


@pytest.fixture(scope="module")
def gravity_components() -> dict[str, np.ndarray]:
    angles = {"gravity": AT[g], "gamma": AT[gamma]}
    leaning = {**angles, "delta": AT[delta]}
    return {
        "along": floor.gravity_along(**angles),
        "normal": floor.gravity_normal(**angles),
        "leaning_normal": floor.leaning_gravity_normal(**leaning),
        "across": floor.gravity_across(**leaning),
    }


def drive() -> dict[str, np.ndarray]:
    both = {"vibration_acceleration": AT[P], "beta": AT[beta]}
    return {
        "along": floor.drive_along(**both, alpha=AT[alpha]),
        "across": floor.drive_across(**both, alpha=AT[alpha]),
        "normal": floor.drive_normal(**both),
    }


def test_gravity_in_track_axes_3_13(gravity_components):
    """Erratum 6: the matrices of (3.13) themselves press the part on the wall, weight_y < 0."""
    components = weight(gamma, delta)
    agree(-gravity_components["along"], components[0], 10)
    agree(-gravity_components["across"], components[1], 10)
    agree(-gravity_components["leaning_normal"], components[2], 10)


def test_a_block_on_the_plane_3_9_to_3_12(gravity_components):
    """Per-axis friction as printed; sums of forces along x, y, z with zddot = 0."""
    ax, ay, normal = sp.symbols("ax ay normal")
    body = weight(gamma, sp.Integer(0))
    solved = sp.solve(
        [
            DRIVE[0] + body[0] - mu * normal - ax,
            DRIVE[1] + body[1] - mu * normal - ay,
            DRIVE[2] + body[2] + normal,
        ],
        [ax, ay, normal],
        dict=True,
    )[0]
    push = drive()
    n0 = floor.normal_acceleration(
        gravity_normal=gravity_components["normal"], drive_normal=push["normal"]
    )
    agree(n0, solved[normal], 200)
    got_x = floor.per_axis_acceleration_x(
        in_plane_drive_x=push["along"] - gravity_components["along"],
        friction_kinetic=AT[mu],
        normal_acceleration=n0,
    )
    got_y = floor.per_axis_acceleration_y(
        in_plane_drive_y=push["across"], friction_kinetic=AT[mu], normal_acceleration=n0
    )
    agree(got_x, solved[ax], 200)
    agree(got_y, solved[ay], 200)
    # (3.10), (3.12): components in axes turned by theta are projections on the turned unit vectors
    axis_x = sp.Matrix([sp.cos(theta), sp.sin(theta)])
    axis_y = sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    plane = sp.Matrix([solved[ax], solved[ay]])
    turned = {"acceleration_x": got_x, "acceleration_y": got_y, "yaw": AT[theta]}
    agree(floor.rotated_acceleration_x(**turned), plane.dot(axis_x), 200)
    agree(floor.rotated_acceleration_y(**turned), plane.dot(axis_y), 200)


def track_solution(lean: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
    """Solve the free body of fig. 3.10: unknown wall forces, floor friction, acceleration.

    Wall corners rear and front at the top edge, wall normals without sin(sigma) as (3.13) has them,
    floor resultant through the centre, a_y = v^2/R.
    """
    rear, front, fx, fy, ax = sp.symbols("rear front fx fy ax")
    body = DRIVE + weight(gamma, lean)
    forces = [
        (sp.Matrix([-h / 2, -a / 2, b / 2]), rear * c * sp.Matrix([-mu, 1, -mu_s])),
        (sp.Matrix([h / 2, -a / 2, b / 2]), front * c * sp.Matrix([-mu, 1, -mu_s])),
        (sp.Matrix([0, 0, -b / 2]), sp.Matrix([-fx, fy, 0])),
    ]
    total = sum((force for _, force in forces), sp.zeros(3, 1)) + m * body
    moment = sum((arm.cross(force) for arm, force in forces), sp.zeros(3, 1))
    unknown = [rear, front, fx, fy, ax]
    equations = [total[0] - m * ax, total[1] - m * v**2 / R, *moment]
    solved = sp.solve(equations, unknown, dict=True)[0]
    wanted = dict(zip(("rear", "front", "fx", "fy", "ax"), unknown, strict=True))
    return {name: solved[symbol] for name, symbol in wanted.items()}


@pytest.mark.parametrize(("variant", "lean"), [("derived", delta), ("thesis", -delta)])
def test_a_block_on_the_track_3_15_to_3_17(gravity_components, variant, lean):
    """The derived forms follow from the free body; the printed ones from it with g_y turned.

    Errata 6, 7 and 11: the reconstruction is exact, and neither K nor a_x depends on a, b, h, m.
    """
    solved = track_solution(lean)
    push, centripetal = drive(), AT[v] ** 2 / AT[R]
    across = {
        "centripetal_acceleration": centripetal,
        "gravity_across": gravity_components["across"],
        "drive_across": push["across"],
    }
    printed = variant == "thesis"
    balance = (wall.printed_wall_balance if printed else wall.derived_wall_balance)(**across)
    load = wall.top_edge_wall_acceleration(
        wall_balance=balance, width=AT[a], height=AT[b], friction_static=AT[mu_s]
    )
    sizes = {
        "wall_force": AT[m] * load,
        "chord_cosine": AT[c],
        "width": AT[a],
        "length": AT[h],
        "friction_kinetic": AT[mu],
    }
    agree(wall.wall_force_rear(**sizes), solved["rear"], 200)
    agree(wall.wall_force_front(**sizes), solved["front"], 200)
    floor = wall.top_edge_floor_acceleration(
        wall_acceleration=load, width=AT[a], height=AT[b], friction_static=AT[mu_s]
    )
    agree(AT[m] * floor, solved["fy"], 200)
    agree(AT[mu] * AT[m] * floor, solved["fx"], 200)  # lambda_N = lambda_Tx/mu_k, (3.15b)
    K = (wall.printed_starting_acceleration if printed else wall.derived_starting_acceleration)(
        drive_along=push["along"],
        drive_across=push["across"],
        gravity_along=gravity_components["along"],
        gravity_across=gravity_components["across"],
        friction_kinetic=AT[mu],
    )
    got = wall.curved_acceleration_x(
        starting_acceleration=K, friction_kinetic=AT[mu], centripetal_acceleration=centripetal
    )
    agree(got, solved["ax"], 400)
    simplified = sp.simplify(solved["ax"])
    assert not simplified.free_symbols & {a, b, h, m, mu_s, c}


def test_the_printed_forces_leave_the_friction_cone_3_15():
    """Errata 8 and 9: on floor and wall the friction is larger than mu times the normal force."""
    solved = track_solution(delta)
    floor = numbers(sp.sqrt(solved["fx"] ** 2 + solved["fy"] ** 2) * mu / sp.Abs(solved["fx"]))
    assert np.all(floor > np.maximum(1.0, AT[mu]))  # |lambda_T| over lambda_N = lambda_Tx/mu_k
    on_wall = np.hypot(AT[mu], AT[mu_s])
    assert np.all(on_wall > np.maximum(AT[mu], AT[mu_s]))


def test_velocity_after_a_distance_3_18():
    """(3.18) solves v dv/dx = K - mu v^2/R with v(0) = v0."""
    K, start, s = sp.symbols("K v0 s", positive=True)
    law = sp.sqrt(start**2 * sp.exp(-2 * mu * s / R) + K * R / mu * (1 - sp.exp(-2 * mu * s / R)))
    assert sp.simplify(law * sp.diff(law, s) - (K - mu * law**2 / R)) == 0
    assert sp.simplify(law.subs(s, 0) - start) == 0
    got = travel.transport_velocity(
        starting_acceleration=AT[P],
        friction_kinetic=AT[mu],
        radius=AT[R],
        distance=AT[x],
        speed=AT[v],
    )
    # the plain form loses digits where 2 mu x/R is small, as 1/(2 mu x/R)
    np.testing.assert_allclose(got, numbers(law.subs({K: P, start: v, s: x})), rtol=1e-11)


def test_a_cylinder_on_the_plane_3_36_and_3_38():
    """Erratum 21: moment about the contact line over the inertia about that line, not the centre's.

    The drive acts at the centre, d/2 above the contact line; I = m d^2/8 about the axis.
    """
    spin = sp.symbols("spin")
    central = m * d**2 / 8
    at_contact = central + m * (d / 2) ** 2
    moment = d / 2 * m * DRIVE[1]
    right = sp.solve(at_contact * spin - moment, spin)[0]
    printed = sp.solve(central * spin - moment, spin)[0]
    push = {"drive_across": drive()["across"], "diameter": AT[d]}
    agree(rolling.rolling_angular_acceleration(**push), right, 1e5)
    agree(rolling.printed_angular_acceleration(**push), printed, 1e5)
    assert sp.simplify(printed / right) == 3
    # Rolling on a level plane: friction f at the rim gives the same without moments about the line.
    f = sp.symbols("f")
    rolling_motion = sp.solve(
        [DRIVE[1] - f / m - d / 2 * spin, f * d / 2 - central * spin], [spin, f], dict=True
    )[0]
    assert sp.simplify(rolling_motion[spin] - right) == 0
