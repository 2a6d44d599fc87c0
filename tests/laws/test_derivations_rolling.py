"""Chapter 4 of the source, derived anew from momentum balances by sympy, against the code.

Axes: E1 upwards, E2 in rolling direction, E3 along the axis; they turn with the yaw theta. Numbers
in brackets are equations of the source.
"""

import numpy as np
import pytest
import sympy as sp

from vibrafeed.core.mechanics import screws
from vibrafeed.core.mechanics.screws import reduce_screw

RANDOM = np.random.default_rng(4)
POINTS = 200
m, r, L, g, P = sp.symbols("m r L g P", positive=True)
alpha, beta, theta = sp.symbols("alpha beta theta", real=True)
spin, turn, drilling = sp.symbols("spin turn drilling", real=True)
RANGES = {
    m: (0.001, 0.1), r: (0.002, 0.02), L: (0.01, 0.1), g: (9, 10), P: (1, 8),
    alpha: (-3, 3), beta: (-1, 1), theta: (-3, 3), spin: (-5, 5), turn: (-5, 5),
    drilling: (-1e-3, 1e-3),
}  # fmt: skip
AT = {symbol: RANDOM.uniform(*ends, POINTS) for symbol, ends in RANGES.items()}

D_n = P * sp.sin(beta)
D_eta = P * sp.cos(beta) * sp.sin(alpha + theta)
D_sigma = P * sp.cos(beta) * sp.cos(alpha + theta)
I1, I3 = m * (3 * r**2 + L**2) / 12, m * r**2 / 2


def numbers(expression: sp.Expr) -> np.ndarray:
    function = sp.lambdify(list(RANGES), expression, "numpy")
    return np.broadcast_to(function(*AT.values()), (POINTS,))


@pytest.fixture(scope="module")
def balances() -> dict[str, sp.Expr]:
    """Solve the six balances of a rolling, yawing cylinder for floor, offset and accelerations.

    The vertical moment of friction that acts off mid-length belongs to the drilling moment.
    """
    N, f_eta, f_sigma, e, spin_rate, yaw_rate = sp.symbols("N f_eta f_sigma e psi2 theta2")
    frame = sp.Matrix([turn, 0, 0])  # the axes turn with the yaw
    velocity, rate = sp.Matrix([0, r * spin, 0]), sp.Matrix([0, r * spin_rate, 0])
    momentum, momentum_rate = (
        sp.Matrix([I1 * turn, 0, I3 * spin]),
        sp.Matrix([I1 * yaw_rate, 0, I3 * spin_rate]),
    )
    floor = sp.Matrix([N, -f_eta, -f_sigma])
    force = sp.Matrix([m * (D_n - g), m * D_eta, m * D_sigma]) + floor
    moment = sp.Matrix([-r, 0, e]).cross(floor) + sp.Matrix([drilling - e * f_eta, 0, 0])
    solved = sp.solve(
        [
            *(m * (rate + frame.cross(velocity)) - force),
            *(momentum_rate + frame.cross(momentum) - moment),
        ],
        [N, f_eta, f_sigma, e, spin_rate, yaw_rate],
        dict=True,
    )[0]
    names = {"N": N, "eta": f_eta, "sigma": f_sigma, "e": e, "spin2": spin_rate, "yaw2": yaw_rate}
    return {name: solved[symbol] for name, symbol in names.items()}


def test_the_rolling_cylinder_4_12_to_4_19(balances):
    """Errata 27 and 28: L in I1, and the offset e that makes the six balances agree."""
    diameter, length = 2 * AT[r], AT[L]
    push = {
        "vibration_acceleration": AT[P],
        "alpha": AT[alpha],
        "beta": AT[beta],
        "axis_yaw": AT[theta],
    }
    eta, sigma = screws.rolling_drive(**push), screws.axial_drive(**push)
    motion = {"diameter": diameter, "spin_rate": AT[spin], "yaw_rate": AT[turn]}
    along = screws.axial_friction_acceleration(axial_drive=sigma, **motion)
    normal = AT[g] - AT[P] * np.sin(AT[beta])
    got = {
        "N": AT[m] * normal,
        "eta": screws.rolling_friction(mass=AT[m], rolling_drive=eta),
        "sigma": screws.axial_friction(mass=AT[m], axial_friction_acceleration=along),
        "e": screws.pressure_offset_axial(axial_drive=sigma, normal_acceleration=normal, **motion),
        "spin2": screws.spin_acceleration(rolling_drive=eta, diameter=diameter),
        "yaw2": screws.yaw_acceleration(
            mass=AT[m], diameter=diameter, length=length, drilling_moment=AT[drilling]
        ),
    }
    # terms of either sign meet in friction and offset: compared with the size of what meets
    sizes = {"sigma": AT[m] * 10, "e": AT[r], "spin2": 10 / AT[r], "eta": AT[m] * 10}
    on_floor = normal > 0
    for name, value in got.items():
        expected = numbers(balances[name])
        scale = np.maximum(np.abs(expected), sizes.get(name, 0.0))
        assert np.all(np.abs(value - expected)[on_floor] <= 1e-13 * scale[on_floor]), name


def test_the_printed_yaw_rate_asks_for_no_offset_4_20(balances):
    """Erratum 28: (4.20) is what e = 0 would need, and its rate contradicts (4.18)."""
    needed = sp.solve(balances["e"], turn)[0]
    printed = 2 * D_sigma / (3 * r * spin)
    assert sp.simplify(needed - printed) == 0
    # With theta' = printed, theta'' follows from theta' and spin''; (4.18) wants 0.
    rate = sp.diff(printed, theta) * printed + sp.diff(printed, spin) * (2 * D_eta / (3 * r))
    stated = -sp.Rational(4, 9) * P**2 * sp.cos(beta) ** 2 * sp.sin(2 * (alpha + theta))
    assert sp.simplify(rate - stated / (r * spin) ** 2) == 0
    got = screws.printed_yaw_rate(
        axial_drive=numbers(D_sigma), diameter=2 * AT[r], spin_rate=AT[spin]
    )
    np.testing.assert_allclose(got, numbers(printed), rtol=1e-13)


def test_no_sliding_is_a_cone_not_an_angle(balances):
    """Erratum 29: with friction enough the cylinder rolls at any alpha + theta."""
    demand = sp.sqrt(balances["eta"] ** 2 + balances["sigma"] ** 2) / balances["N"]
    at = {P: 2, g: 9.8, alpha: 0.4, theta: 0.2, beta: 0.1, spin: 0, turn: 0, m: 1, r: 1, L: 1}
    assert 0 < float(demand.subs({**at, drilling: 0})) < 0.5


def test_the_reduction_of_a_wrench_4_1_to_4_7():
    """Erratum 26: r = F x M/F^2 gives M = r x F + p F back; the printed M x F/F^2 does not."""
    force = sp.Matrix(sp.symbols("F1:4", real=True))
    moment = sp.Matrix(sp.symbols("M1:4", real=True))
    square = force.dot(force)
    pitch = force.dot(moment) / square
    right, printed = force.cross(moment) / square, moment.cross(force) / square
    assert sp.simplify(right.cross(force) + pitch * force - moment) == sp.zeros(3, 1)
    assert sp.simplify(printed.cross(force) + pitch * force - moment) != sp.zeros(3, 1)
    F, M = RANDOM.normal(size=(2, POINTS, 3))
    reduction = reduce_screw(F, M)
    function = sp.lambdify([*force, *moment], [pitch, *right], "numpy")
    expected = np.stack(function(*F.T, *M.T))
    # |F| is above 0.03 here, so that the sums of products are divided by 1e-3 at the least
    assert np.linalg.norm(F, axis=-1).min() > 0.03
    np.testing.assert_allclose(reduction.pitch, expected[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(reduction.axis_point.T, expected[1:], rtol=0, atol=1e-12)
