"""The source's results for planes and the narrow track, derived anew from free bodies by sympy.

Each derivation starts from balances of forces and moments, not from the code, and is then compared
with the code at random points. Numbers in brackets are equations of the source.
"""

from functools import cache

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


ANGLES = {"gravity": AT[g], "gamma": AT[gamma]}
ALONG, NORMAL = floor.gravity_along(**ANGLES), floor.gravity_normal(**ANGLES)
ACROSS = floor.gravity_across(**ANGLES, delta=AT[delta])


def drive() -> dict[str, np.ndarray]:
    both = {"vibration_acceleration": AT[P], "beta": AT[beta]}
    return {
        "along": floor.drive_along(**both, alpha=AT[alpha]),
        "across": floor.drive_across(**both, alpha=AT[alpha]),
        "normal": floor.drive_normal(**both),
    }


def test_gravity_in_track_axes_3_13():
    """Erratum 6: the matrices of (3.13) themselves press the part on the wall, weight_y < 0."""
    onto = floor.leaning_gravity_normal(**ANGLES, delta=AT[delta])
    for got, component in zip((ALONG, ACROSS, onto), weight(gamma, delta), strict=True):
        agree(-got, component, 10)


def test_a_block_on_the_plane_3_9_to_3_12():
    """Per-axis friction as printed; sums of forces along x, y, z with zddot = 0."""
    ax, ay, normal = sp.symbols("ax ay normal")
    forces = DRIVE + weight(gamma, sp.Integer(0)) + sp.Matrix([-mu * normal, -mu * normal, normal])
    (solved,) = sp.solve(forces - sp.Matrix([ax, ay, 0]), [ax, ay, normal], dict=True)
    push = drive()
    n0 = floor.normal_acceleration(gravity_normal=NORMAL, drive_normal=push["normal"])
    agree(n0, solved[normal], 200)
    rubs = {"friction_kinetic": AT[mu], "normal_acceleration": n0}
    got_x = floor.per_axis_acceleration_x(in_plane_drive_x=push["along"] - ALONG, **rubs)
    got_y = floor.per_axis_acceleration_y(in_plane_drive_y=push["across"], **rubs)
    agree(got_x, solved[ax], 200)
    agree(got_y, solved[ay], 200)
    # (3.10), (3.12): components in axes turned by theta are projections on the turned unit vectors
    c, s = sp.cos(theta), sp.sin(theta)
    turned = {"acceleration_x": got_x, "acceleration_y": got_y, "yaw": AT[theta]}
    agree(floor.rotated_acceleration_x(**turned), c * solved[ax] + s * solved[ay], 200)
    agree(floor.rotated_acceleration_y(**turned), c * solved[ay] - s * solved[ax], 200)


@cache
def track_solution(lean: sp.Expr) -> dict[str, sp.Expr]:
    """Solve the free body of fig. 3.10: unknown wall forces, floor friction, acceleration.

    Wall corners rear and front at the top edge, wall normals without sin(sigma) as (3.13) has them,
    floor resultant through the centre, a_y = v^2/R.
    """
    unknown = rear, front, fx, fy, ax = sp.symbols("rear front fx fy ax")
    on_wall = c * sp.Matrix([-mu, 1, -mu_s])
    forces = [
        (sp.Matrix([-h / 2, -a / 2, b / 2]), rear * on_wall),
        (sp.Matrix([h / 2, -a / 2, b / 2]), front * on_wall),
        (sp.Matrix([0, 0, -b / 2]), sp.Matrix([-fx, fy, 0])),
    ]
    total = sum((force for _, force in forces), m * (DRIVE + weight(gamma, lean)))
    moment = sum((arm.cross(force) for arm, force in forces), sp.zeros(3, 1))
    equations = [total[0] - m * ax, total[1] - m * v**2 / R, *moment]
    (solved,) = sp.solve(equations, unknown, dict=True)
    return {str(symbol): solved[symbol] for symbol in unknown}


@pytest.mark.parametrize(("variant", "lean"), [("derived", delta), ("printed", -delta)])
def test_a_block_on_the_track_3_15_to_3_17(variant, lean):
    """The derived forms follow from the free body; the printed ones from it with g_y turned.

    Errata 6, 7 and 11: the reconstruction is exact, and neither K nor a_x depends on a, b, h, m.
    """
    solved, push, centripetal = track_solution(lean), drive(), AT[v] ** 2 / AT[R]
    across = {"gravity_across": ACROSS, "drive_across": push["across"]}
    sizes = {"width": AT[a], "height": AT[b], "friction_static": AT[mu_s]}
    balance = getattr(wall, f"{variant}_wall_balance")(
        centripetal_acceleration=centripetal, **across
    )
    load = wall.top_edge_wall_acceleration(wall_balance=balance, **sizes)
    corners = {"wall_force": AT[m] * load, "chord_cosine": AT[c], "width": AT[a], "length": AT[h],
               "friction_kinetic": AT[mu]}  # fmt: skip
    agree(wall.wall_force_rear(**corners), solved["rear"], 200)
    agree(wall.wall_force_front(**corners), solved["front"], 200)
    floor = wall.top_edge_floor_acceleration(wall_acceleration=load, **sizes)
    agree(AT[m] * floor, solved["fy"], 200)
    agree(AT[mu] * AT[m] * floor, solved["fx"], 200)  # lambda_N = lambda_Tx/mu_k, (3.15b)
    K = getattr(wall, f"{variant}_starting_acceleration")(
        drive_along=push["along"], gravity_along=ALONG, friction_kinetic=AT[mu], **across
    )
    got = wall.curved_acceleration_x(
        starting_acceleration=K, friction_kinetic=AT[mu], centripetal_acceleration=centripetal
    )
    agree(got, solved["ax"], 400)
    assert not sp.simplify(solved["ax"]).free_symbols & {a, b, h, m, mu_s, c}


def test_the_printed_forces_leave_the_friction_cone_3_15():
    """Errata 8 and 9: on floor and wall the friction is larger than mu times the normal force."""
    solved = track_solution(delta)
    floor = numbers(sp.sqrt(solved["fx"] ** 2 + solved["fy"] ** 2) * mu / sp.Abs(solved["fx"]))
    assert np.all(floor > np.maximum(1.0, AT[mu]))  # |lambda_T| over lambda_N = lambda_Tx/mu_k


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
    spin, f = sp.symbols("spin f")
    central = m * d**2 / 8
    # Rolling on a level plane: friction f at the rim turns the cylinder.
    rolls = [DRIVE[1] - f / m - d / 2 * spin, f * d / 2 - central * spin]
    right = sp.solve(rolls, [spin, f])[spin]
    printed = d / 2 * m * DRIVE[1] / central
    assert sp.simplify(printed / right) == 3
    push = {"drive_across": drive()["across"], "diameter": AT[d]}
    agree(rolling.rolling_angular_acceleration(**push), right, 1e5)
    agree(rolling.printed_angular_acceleration(**push), printed, 1e5)
