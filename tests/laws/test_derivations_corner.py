"""Corner of an isolated part on a plane: kinematics differentiated and forces solved by sympy.

Rectangle and cylinder differ in their inertia only. Numbers in brackets are the source's equations.
"""

import numpy as np
import pytest
import sympy as sp

from vibrafeed.core.mechanics import corner

RANDOM = np.random.default_rng(5)
POINTS = 200
t, g, m, a, b, mu = sp.symbols("t g m a b mu", positive=True)
angle, rate = sp.symbols("angle rate", real=True)
sigma = sp.symbols("sigma", real=True)
# b is the extent across the diagonal's foot (height or diameter), a the length
INERTIA = {
    "rectangle": m * (a**2 + b**2) / 12,
    "cylinder": m * (sp.Rational(3, 4) * b**2 + a**2) / 12,
}
RANGES = {
    g: (9, 10), m: (0.001, 1), a: (0.01, 0.1), b: (0.01, 0.1), mu: (0.05, 1.1),
    angle: (0.05, 3.0), rate: (-5, 5), sigma: (-1, 1),
}  # fmt: skip
AT = {symbol: RANDOM.uniform(*ends, POINTS) for symbol, ends in RANGES.items()}
AT[sigma] = np.sign(AT[sigma])
RHO = sp.sqrt(a**2 + b**2) / 2


def numbers(expression: sp.Expr) -> np.ndarray:
    function = sp.lambdify(list(RANGES), expression, "numpy")
    return np.broadcast_to(function(*AT.values()), (POINTS,))


def accelerations(inertia: sp.Expr, normal: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """Return both second rates of the corner under a normal force, slip of direction sigma.

    The corner stands at (rho cos s, -rho sin s) from the centre; pitch turns clockwise.
    """
    x, y, s = (sp.Function(name)(t) for name in ("x", "y", "s"))
    gap, place = y - RHO * sp.sin(s), x + RHO * sp.cos(s)
    tangential = -sigma * mu * normal
    moment = RHO * sp.cos(angle) * normal + RHO * sp.sin(angle) * tangential  # counter-clockwise
    motion = {
        x.diff(t, 2): tangential / m,
        y.diff(t, 2): normal / m - g,
        s.diff(t, 2): -moment / inertia,
    }
    second = []
    for length in (gap, place):
        expression = length.diff(t, 2).subs(motion)
        second.append(expression.subs(s.diff(t), rate).subs(s, angle))
    return second[0], second[1]


@pytest.mark.parametrize("shape", INERTIA)
def test_sliding_contact_3_6_and_3_33(shape):
    """Errata 3 and 19: the second row has -mu and sin^2."""
    normal = sp.symbols("normal")
    inertia = INERTIA[shape]
    gap, slip = (sp.expand(value) for value in accelerations(inertia, normal))
    tau, chi = gap.coeff(normal, 1), gap.coeff(normal, 0)
    kappa = numbers(m * RHO**2 / inertia)
    direction = np.sin(AT[angle]), np.cos(AT[angle])
    motion = {
        "half_diagonal": numbers(RHO),
        "pitch_rate": AT[rate],
        "diagonal_direction": direction,
    }
    response = corner.normal_response(
        inertia_ratio=kappa,
        diagonal_direction=direction,
        friction_kinetic=AT[mu],
        slip_direction=AT[sigma],
    )
    # sums of a few terms of size 1 + kappa (1 + mu) < 10
    np.testing.assert_allclose(response, numbers(m * tau), rtol=0, atol=1e-14)
    free = corner.free_normal_acceleration(**motion, gravity=AT[g])
    np.testing.assert_allclose(free, numbers(chi), rtol=0, atol=1e-13)
    in_contact = sp.solve(gap, normal)[0]
    got = corner.gap_tangential_acceleration(
        contact_case=np.full(POINTS, corner.TWO_SOLUTIONS),
        slip_direction=AT[sigma],
        normal_response=response,
        free_tangential_acceleration=corner.free_tangential_acceleration(**motion),
        inertia_ratio=kappa,
        friction_kinetic=AT[mu],
        gravity=AT[g],
        **motion,
    )
    expected = numbers(slip.subs(normal, in_contact))
    clear = np.abs(response) > 1e-2  # a pole at tau = 0
    np.testing.assert_allclose(got[clear], expected[clear], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("shape", INERTIA)
def test_limiting_friction_3_7_and_3_34(shape):
    """tau = 0 solved for mu, and its least value 2 sqrt(1 + kappa)/kappa (erratum 20)."""
    normal = sp.symbols("normal")
    gap, _ = accelerations(INERTIA[shape], normal)
    tau = sp.expand(gap).coeff(normal, 1)
    limit = sp.solve(tau.subs(sigma, 1), mu)[0]
    kappa = numbers(m * RHO**2 / INERTIA[shape])
    inverse = corner.inverse_limiting_friction(
        inertia_ratio=kappa, diagonal_direction=(np.sin(AT[angle]), np.cos(AT[angle]))
    )
    np.testing.assert_allclose(inverse, 1 / numbers(limit), rtol=0, atol=1e-14)
    k, tangent = sp.symbols("k tangent", positive=True)
    curve = (1 + k + tangent**2) / (k * tangent)
    best = [root for root in sp.solve(sp.diff(curve, tangent), tangent) if root.is_positive]
    assert best == [sp.sqrt(k + 1)]
    least = sp.simplify(curve.subs(tangent, best[0]))
    assert sp.simplify(least - 2 * sp.sqrt(1 + k) / k) == 0
    got = corner.least_limiting_friction(inertia_ratio=kappa)
    np.testing.assert_allclose(got, 2 * np.sqrt(1 + kappa) / kappa, rtol=1e-15)
    if shape == "rectangle":
        assert sp.simplify(m * RHO**2 / INERTIA[shape]) == 3
        assert least.subs(k, 3) == sp.Rational(4, 3)
