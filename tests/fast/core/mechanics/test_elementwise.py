"""Functions made of few steps: against numbers of 50 digits, and compiled against numpy."""

import mpmath
import numpy as np

from vibrafeed.core.compiled import compiled_source
from vibrafeed.core.mechanics.arrays import arc_quotient, arc_series, binade, exponent
from vibrafeed.core.mechanics.rolling import slip_share

RANDOM = np.random.default_rng(36)
LOOP = """
def loop(x, powers, exponents):
    for i in range(x.size):
        powers[i] = binade(x[i])
        exponents[i] = exponent(x[i])
"""


def arc(square, root):
    """Return artanh(u)/u with u^2 = square, or arctan(u)/u below 0; root is sqrt(1 - square)."""
    u = mpmath.sqrt(abs(square))
    if square < 0:
        return mpmath.atan(u) / u
    return (mpmath.log((1 + u) / root) if square > 0.25 else mpmath.atanh(u)) / u


def worst_ulps(found, square, root=None):
    """Return the largest error of arcs against 50 digits, in units in the last place."""
    errors = []
    with mpmath.workdps(50):
        squares = [mpmath.mpf(one) for one in square.tolist()]
        roots = [mpmath.sqrt(1 - one) for one in squares] if root is None else root.tolist()
        for got, *values in zip(found.tolist(), squares, roots, strict=True):
            exact = arc(*values)
            errors.append(abs(got - exact) / float(np.spacing(float(exact))))
    return float(max(errors))


def test_parts_of_a_float_are_those_of_frexp_on_both_ways():
    x = np.concatenate([2.0 ** np.arange(-1022, 1024), 10 ** RANDOM.uniform(-300, 300, 2000)])
    mantissas, exponents = np.frexp(x)
    assert np.array_equal(exponent(x), exponents - 1.0)
    assert np.array_equal(binade(x), x / (2 * mantissas))
    assert np.array_equal(binade(-x), binade(x))
    looped = np.empty_like(x), np.empty_like(x)
    compiled_source(LOOP)(x, *looped)
    assert np.array_equal(looped[0], binade(x))
    assert np.array_equal(looped[1], exponent(x))


def test_arcs_of_both_kinds_within_five_units_in_the_last_place():
    s = np.concatenate([10 ** RANDOM.uniform(-20, 2.9, 500), RANDOM.uniform(0, 3, 500)])
    given = -np.expm1(-s), np.exp(-s / 2)
    assert worst_ulps(arc_quotient(*given), *given) < 5
    square = -np.concatenate([10 ** RANDOM.uniform(-20, 25, 500), RANDOM.uniform(0, 8, 500)])
    given = square, np.sqrt(1 - square)
    assert worst_ulps(arc_quotient(*given), *given) < 5


def test_small_arcs_within_a_unit_and_a_half_in_the_last_place():
    most = np.tan(np.pi / 16) ** 2
    square = np.append(RANDOM.uniform(-most, most, 300), 10 ** RANDOM.uniform(-20, -1.5, 100))
    assert worst_ulps(arc_series(square), square) < 1.5


def test_arcs_at_their_ends():
    assert arc_quotient(0.0, 1.0) == 1
    # Next to 1 only the root knows how far: artanh = ln(2/root).
    assert arc_quotient(1.0, 2.0**-900) == 901 * np.log(2.0)


def test_a_solid_cylinder_has_its_root_after_five_steps():
    turn = np.append(RANDOM.uniform(0, np.pi / 2, 20_000), 10 ** RANDOM.uniform(-12, 0, 5000))
    x, y = np.cos(turn), np.sin(turn)
    rolling = np.hypot(x, y / 3)  # friction that would hold it
    s = rolling * RANDOM.uniform(0, 1, turn.size)
    s[::3] = rolling[::3] * (1 - 10 ** RANDOM.uniform(-14, 0, s[::3].size))
    z = slip_share(x, y, s, 3.0)
    assert np.abs(np.hypot(x / (z + s), y / (z + 3 * s)) - 1).max() < 4e-15
