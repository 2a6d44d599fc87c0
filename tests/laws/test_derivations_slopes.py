"""The derivatives of planar motion (theory 13.16), derived anew by sympy, against the kernels.

Each event is written down as a function of one parameter p on which everything may depend: the
groups, and phase and velocities at the event before. sympy differentiates; the kernels get the same
numbers, a column a direction.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

from night import first_by_day
from plain_kernels import plain
from vibrafeed.core.motion.kernels.planar import derive, flow, sine_flight, slopes
from vibrafeed.core.motion.kernels.planar.slope_tables import (
    BY,
    DERIVED,
    DERIVED_BY,
    DIRECTIONS,
    ROW,
    SUMMED,
)
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS
from vibrafeed.core.motion.kernels.statuses import MODE

SLOPES, DERIVE = plain(slopes), plain(derive)
RANDOM = np.random.default_rng(1316)
CLOSE = 1e-11
"""Of numbers of size 1, after a few hundred roundings."""

p = sp.Symbol("p", real=True)
GROUPS = sp.symbols("c s gs gn mu_s mu_k e", cls=sp.Function)
c, s, gs, gn, mu_s, mu_k, e = (group(p) for group in GROUPS)
at, length, along, normal, end = (
    sp.Function(name)(p) for name in ("tau0", "D", "u0", "w0", "tau1")
)
"""Phase of an event, phase to the next, velocities along and normal at the event; the next's."""
x = sp.Symbol("x", real=True)

NUMBERS = {c: 1.3, s: 1.7, gs: 0.05, gn: 0.9, mu_s: 0.45, mu_k: 0.3, e: 0.4}


def drive():
    return plain(flow)["sine_of"](*(NUMBERS[group] for group in (c, s, gs, gn, mu_s, mu_k)))


def scratch():
    """Return a table of derivatives with nothing carried yet but random phases and velocities."""
    d = np.zeros((len(ROW), DIRECTIONS))
    for row in (ROW.phase, ROW.along, ROW.normal, ROW.end):
        d[row] = RANDOM.uniform(-1.0, 1.0, DIRECTIONS)
    return d


def by_parameter(expression, numbers, moves):
    """Return the derivative of an expression by p, a value a direction.

    `moves` has what p does to each function that is no group, a value a direction.
    """
    slope = sp.diff(expression, p)
    functions = [*NUMBERS, *moves]
    rates = [sp.Dummy() for _ in functions]
    plain_names = [sp.Dummy() for _ in functions]
    slope = slope.xreplace(
        {sp.Derivative(f, p): rate for f, rate in zip(functions, rates, strict=True)}
    )
    slope = slope.xreplace(dict(zip(functions, plain_names, strict=True)))
    value = sp.lambdify([*plain_names, *rates], slope, "math")
    given = {**NUMBERS, **numbers}
    at_numbers = [given[function] for function in functions]
    found = []
    for direction in range(DIRECTIONS):
        groups = [float(direction == place) for place in range(len(NUMBERS))]
        found.append(value(*at_numbers, *groups, *(move[direction] for move in moves.values())))
    return np.array(found)


def velocity(sign, start=along):
    """Return the velocity of a slip or a flight a phase x - tau0 after it began."""
    C, k = c + sign * mu_k * s, gs + sign * mu_k * gn
    return start + C * (sp.cos(at) - sp.cos(x)) - k * (x - at)


ANTIDERIVATIVES = {
    sp.Integer(1): x, x: x**2 / 2, sp.sin(x): -sp.cos(x), sp.cos(x): sp.sin(x),
    x * sp.sin(x): sp.sin(x) - x * sp.cos(x), sp.sin(x) * sp.cos(x): sp.sin(x) ** 2 / 2,
}  # fmt: skip
"""What `sp.integrate` gives of the terms of a flow, which takes it long beside functions of p."""


def integral(expression):
    """Return the integral by x from tau0 to tau1."""
    total = 0
    for term in sp.Add.make_args(sp.expand(expression)):
        factor, part = term.as_independent(x)
        total += factor * ANTIDERIVATIVES[part]
    return total.xreplace({x: end}) - total.xreplace({x: at})


def test_antiderivatives():
    for function, found in ANTIDERIVATIVES.items():
        assert sp.simplify(sp.diff(found, x) - function) == 0


def number_of(expression, numbers):
    return float(expression.subs({**NUMBERS, **numbers}).evalf(25))


@pytest.mark.parametrize(
    ("sign", "stops"),
    first_by_day([(-1, False), (0, False), (1, True), (-1, True), (1, False)], day=3),
)
def test_a_slip_or_a_flight(sign, stops):
    """Its end, its way, its time, and the work of friction over it."""
    numbers = {at: 0.4, end: 1.5}
    u = velocity(sign)
    last = u.subs(x, end)
    start = -number_of(last.subs(along, 0), numbers) if stops else 0.7 * (sign or 1)
    numbers[along] = start
    after = 0.0 if stops else number_of(last, numbers)
    mode = MODE.flight if sign == 0 else MODE.forward if sign > 0 else MODE.backward
    d = scratch()
    moves = {at: d[ROW.phase].copy(), along: d[ROW.along].copy(), end: d[ROW.end].copy()}
    if stops:  # implicit: the velocity at the end stays 0
        rate = number_of(sp.diff(u, x).subs(x, end), numbers)
        moves[end] = np.zeros(DIRECTIONS)
        moves[end] = -by_parameter(last, numbers, moves) / rate
    span = numbers[end] - numbers[at]
    given = (drive(), float(sign), start, after, numbers[at], span, stops, mode, DIRECTIONS, d)
    SLOPES["along"](*given)
    if sign != 0:
        SLOPES["rub"](drive(), float(sign), start, numbers[at], span, DIRECTIONS, d)
        work = integral(sign * mu_k * (gn - s * sp.sin(x)) * u)
        expected = by_parameter(work, numbers, moves)
        np.testing.assert_allclose(d[ROW.friction], expected, atol=CLOSE)
    np.testing.assert_allclose(d[ROW.phase], moves[end], atol=CLOSE)
    np.testing.assert_allclose(d[ROW.along], by_parameter(last, numbers, moves), atol=CLOSE)
    np.testing.assert_allclose(
        d[ROW.distance], by_parameter(integral(u), numbers, moves), atol=CLOSE
    )
    np.testing.assert_allclose(
        d[ROW.stick + mode], by_parameter(end - at, numbers, moves), atol=CLOSE
    )


@pytest.mark.parametrize("sign", [-1, 1])
def test_static_friction_lets_go(sign):
    threshold = sp.asin((gs + sign * mu_s * gn) / (c + sign * mu_s * s))
    d = scratch()
    SLOPES["release"](drive(), sign < 0, 1.0, number_of(threshold, {}), d)
    np.testing.assert_allclose(d[ROW.phase], by_parameter(threshold, {}, {}), atol=CLOSE)


def test_lift_off():
    d = scratch()
    SLOPES["lift"](drive(), ROW.end, d)
    np.testing.assert_allclose(d[ROW.end], by_parameter(sp.asin(gn / s), {}, {}), atol=CLOSE)


def height():
    """Return height and velocity off the floor a phase x - tau0 after a take-off."""
    w = normal + s * (sp.cos(at) - sp.cos(x)) - gn * (x - at)
    y = sp.Symbol("y", real=True)
    return sp.integrate(sp.expand(w.subs(x, y)), (y, at, x)), w


def hop():
    """Return numbers of a hop from its start to its landing, and the speed of that."""
    numbers = {at: 0.9, normal: 0.6}
    one = drive()
    numbers[end] = numbers[at] + plain(sine_flight)["landing"](one, numbers[normal], numbers[at])
    return numbers, -number_of(height()[1].subs(x, end), numbers)


def test_a_landing_and_its_speed():
    z, w = height()
    numbers, speed = hop()
    d = scratch()
    moves = {at: d[ROW.phase].copy(), normal: d[ROW.normal].copy(), end: np.zeros(DIRECTIONS)}
    moves[end] = by_parameter(z.subs(x, end), numbers, moves) / speed
    span = numbers[end] - numbers[at]
    SLOPES["land"](drive(), numbers[normal], numbers[at], span, speed, DIRECTIONS, d)
    np.testing.assert_allclose(d[ROW.end], moves[end], atol=CLOSE)
    expected = by_parameter(-w.subs(x, end), numbers, moves)
    np.testing.assert_allclose(d[ROW.normal], expected, atol=CLOSE)


def test_the_height_of_a_hop():
    z, w = height()
    numbers, _ = hop()
    d, nearest = scratch(), np.zeros(5)
    moves = {at: d[ROW.phase].copy(), normal: d[ROW.normal].copy(), end: np.zeros(DIRECTIONS)}
    span = numbers[end] - numbers[at]
    SLOPES["highest"](drive(), numbers[normal], numbers[at], span, DIRECTIONS, d, nearest)
    top = float(sp.nsolve(w.subs({**NUMBERS, **numbers}), x, numbers[at] + 0.4 * span))
    expected = by_parameter(z.subs(x, end), {**numbers, end: top}, moves)
    np.testing.assert_allclose(d[ROW.height], expected, atol=1e-9)  # the top is known to its root
    assert nearest[3] == pytest.approx(number_of(z.subs(x, top), numbers))


@pytest.mark.parametrize("rests", [False, True])
@pytest.mark.parametrize("skid", [0.0, 1.0, -1.0])
@pytest.mark.parametrize("stops", [False, True])
def test_an_impact(stops, skid, rests):
    """Rebound, slip and the energy that is lost; what hops leave that are left out."""
    if skid != 0.0 and not (stops and rests):
        return
    u, w = sp.Function("u")(p), sp.Function("w")(p)
    numbers = {u: -0.8, w: 0.5}
    d = scratch()
    moves = {u: d[ROW.along].copy(), w: d[ROW.normal].copy()}
    impulse = w if rests else (1 + e) * w
    slip = skid * mu_k * e * w if stops else u + mu_k * impulse
    up = 0 if rests else e * w
    landing = slopes.Landing(
        2.9, numbers[w], number_of(impulse, numbers), numbers[u], number_of(slip, numbers), rests,
        stops, skid, skid,
    )  # fmt: skip
    SLOPES["rebound"](drive(), NUMBERS[e], landing, DIRECTIONS, d)
    np.testing.assert_allclose(d[ROW.along], by_parameter(slip, numbers, moves), atol=CLOSE)
    lost = (u**2 - slip**2 + w**2 - up**2) / 2
    np.testing.assert_allclose(d[ROW.impact], by_parameter(lost, numbers, moves), atol=CLOSE)
    if not rests:
        np.testing.assert_allclose(d[ROW.normal], by_parameter(up, numbers, moves), atol=CLOSE)


def test_hops_that_are_left_out():
    """Their time 2 w/(n (1 - eps)), of rebound w = eps v, goes from the floor to the flight."""
    v = sp.Function("v")(p)
    time = 2 * e * v / ((gn - s * sp.sin(at)) * (1 - e))
    numbers = {at: 2.9, v: 0.01}
    d = scratch()
    moves = {at: d[ROW.phase].copy(), v: d[ROW.normal].copy()}
    slow, slides = 0.4, 0.7
    landing = slopes.Landing(2.9, 0.01, 0.01, 0.5, slow, True, False, 0.0, 1.0)
    SLOPES["leave_out_hops"](drive(), NUMBERS[e], landing, slides, DIRECTIONS, d)
    longer, rebound = by_parameter(time, numbers, moves), by_parameter(e * v, numbers, moves)
    np.testing.assert_allclose(d[ROW.flight], longer, atol=CLOSE)
    load = NUMBERS[gn] - NUMBERS[s] * math.sin(2.9)
    rubbed = NUMBERS[mu_k] * load * slow * longer
    np.testing.assert_allclose(d[ROW.impact], rubbed, atol=CLOSE)
    np.testing.assert_allclose(d[ROW.friction], -rubbed, atol=CLOSE)
    np.testing.assert_allclose(d[ROW.stick], -slides * rebound, atol=CLOSE)
    assert NUMBERS[c] * math.sin(2.9) > NUMBERS[gs]  # the way in which it slips is forward
    np.testing.assert_allclose(d[ROW.forward], slides * rebound - longer, atol=CLOSE)


@pytest.mark.parametrize("free", [1, 3])
def test_a_cycle_closes_again(free):
    """By y. = (1 - M)^-1 Q: of a rest only the slip is free, of hops phase and rebound as well."""
    d = RANDOM.uniform(-0.4, 0.4, (len(ROW), DIRECTIONS))
    rows = [ROW.phase, ROW.normal, ROW.along][-free:]
    columns = [BY.start_phase, BY.start_normal, BY.start_along][:free]
    if free == 1:
        columns = [BY.start_along]
    d[ROW.phase, BY.start_along] = d[ROW.normal, BY.start_along] = 0.0  # a slip moves no landing
    M = sp.Matrix(free, free, lambda i, j: d[rows[i], columns[j]])
    Q = sp.Matrix(free, DERIVED_BY, lambda i, j: d[rows[i], j])
    start = (sp.eye(free) - M).LUsolve(Q)
    expected = d[ROW.distance, :DERIVED_BY] + sum(
        d[ROW.distance, columns[j]] * np.array(start.row(j), dtype=float)[0] for j in range(free)
    )
    size = DIRECTIONS if free == 3 else DIRECTIONS - 2
    DERIVE["close"](size, d, np.zeros(5))
    np.testing.assert_allclose(d[ROW.distance, :DERIVED_BY], expected, atol=CLOSE)


def test_means_are_sums_over_the_time_of_the_cycle():
    """drive = friction + impacts + sin(gamma) v."""
    d, slopes_of_means = RANDOM.uniform(-1, 1, (len(ROW), DIRECTIONS)), np.empty((10, DERIVED_BY))
    result = np.zeros(RESULTS)
    result[COLUMN.multiple], result[COLUMN.velocity] = 2.0, 0.3
    DERIVE["tell"](drive(), result, d, slopes_of_means)
    for mean, row in SUMMED:
        np.testing.assert_allclose(slopes_of_means[mean], d[row, :DERIVED_BY] / (4 * math.pi))
    friction, impact, v = (sp.Function(name)(p) for name in ("friction", "impact", "v"))
    moves = {
        friction: slopes_of_means[DERIVED.friction], impact: slopes_of_means[DERIVED.impact],
        v: slopes_of_means[DERIVED.velocity],
    }  # fmt: skip
    moves = {name: np.append(move, np.zeros(3)) for name, move in moves.items()}
    numbers = {friction: 0.1, impact: 0.2, v: 0.3}
    expected = by_parameter(friction + impact + gs * v, numbers, moves)
    np.testing.assert_allclose(slopes_of_means[DERIVED.drive], expected[:DERIVED_BY])
