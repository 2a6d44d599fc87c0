"""The contact of a corner has exactly the solutions that a search over its branches finds.

The search is in rational numbers: exact, and without anything of the code under test.
"""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest

from vibrafeed.core.mechanics import corner
from vibrafeed.core.mechanics.corner import (
    NO_SOLUTION,
    SEPARATION,
    SLIDING,
    STICK,
    TWO_SOLUTIONS,
    case,
    contact_force,
)


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.0, 1e16])
@pytest.mark.parametrize(
    ("response", "free", "told", "force"),
    [
        (1, 1, SEPARATION, 0), (1, 0, SLIDING, 0), (1, -1, SLIDING, 1), (-1, 1, TWO_SOLUTIONS, 1),
        (-1, 0, SLIDING, 0), (-1, -1, NO_SOLUTION, np.nan), (0, 1, SEPARATION, 0),
        (0, 0, TWO_SOLUTIONS, np.nan), (0, -1, NO_SOLUTION, np.nan),
    ],
)  # fmt: skip
def test_next_to_zero_the_solutions_are_those_of_both_branches(response, free, told, force, size):
    """Of every n with 0 <= n, 0 <= response n + free and one of them 0."""
    given = np.array([response * size]), np.array([free * size])
    assert case(*given) == told
    np.testing.assert_array_equal(contact_force(*given), [force])


# --- the corner as a whole, in slip and at rest

HALF_TANGENTS = [Fraction(n, 12) for n in range(-11, 36, 3)]  # of s/2
FRICTIONS = [Fraction(0), Fraction(1, 4), Fraction(1), Fraction(4, 3), Fraction(7, 2)]
TURNS = [Fraction(0), Fraction(1, 2), Fraction(9), Fraction(10), Fraction(30)]  # rho xi'^2
GRAVITY = Fraction(10)


def corner_solutions(kappa, s, c, mu, turn, sigma):
    """Return (n, t) of every solution; `sigma` None stands for a corner at rest."""
    gnn, gnt, gtt = 1 + kappa * c * c, kappa * s * c, 1 + kappa * s * s
    chi, along = turn * s - GRAVITY, -turn * c
    found = set()

    def slips(direction, from_rest):
        tau = gnn - direction * mu * gnt
        if tau == 0:
            assert chi != 0
            return
        force = -chi / tau
        slip = (gnt - direction * mu * gtt) * force + along
        if force >= 0 and (not from_rest or direction * slip > 0):
            found.add((force, -direction * mu * force))

    if chi >= 0:
        found.add((Fraction(0), Fraction(0)))
    if sigma is not None:
        slips(sigma, False)
        return found
    slips(1, True)
    slips(-1, True)
    determinant = gnn * gtt - gnt * gnt
    normal = (gnt * along - gtt * chi) / determinant
    tangential = (gnt * chi - gnn * along) / determinant
    if normal >= 0 and abs(tangential) <= mu * normal:
        found.add((normal, tangential))
    return found


def evaluated(kappa, s, c, mu, turn, sigma):
    """Return case, n, t of the code for one point."""
    direction = (np.float64(s), np.float64(c))
    body = {
        "inertia_ratio": np.float64(kappa), "half_diagonal": np.float64(1),
        "pitch_rate": np.sqrt(np.float64(turn)), "diagonal_direction": direction,
    }  # fmt: skip
    g = np.float64(GRAVITY)
    slip = np.float64(sigma or 0)
    friction = np.float64(mu)
    chi = corner.free_normal_acceleration(
        **{k: v for k, v in body.items() if k != "inertia_ratio"}, gravity=g
    )
    held = {
        "holding_normal_acceleration": corner.holding_normal_acceleration(**body, gravity=g),
        "holding_tangential_acceleration": corner.holding_tangential_acceleration(
            **body, gravity=g
        ),
    }
    common = {
        **held, "gap_tangential_rate": slip, "free_normal_acceleration": chi,
        "friction_static": friction,
    }  # fmt: skip
    way = corner.slip_direction(**common)
    tau = corner.normal_response(
        inertia_ratio=body["inertia_ratio"], diagonal_direction=direction,
        friction_kinetic=friction, slip_direction=way,
    )  # fmt: skip
    told = corner.contact_case(**common, normal_response=tau)
    force = corner.floor_acceleration(
        contact_case=told, slip_direction=way, normal_response=tau, free_normal_acceleration=chi,
        holding_normal_acceleration=held["holding_normal_acceleration"],
    )  # fmt: skip
    along = corner.acceleration_along(
        contact_case=told, slip_direction=way, floor_acceleration=force, friction_kinetic=friction,
        holding_tangential_acceleration=held["holding_tangential_acceleration"],
    )  # fmt: skip
    return float(told), float(force), float(along)


def near_an_edge(kappa, s, c, mu, turn):
    """Return whether rounding may decide: on the edge of the cone, at tau or chi = 0."""
    gnn, gnt = 1 + kappa * c * c, kappa * s * c
    chi = turn * s - GRAVITY
    normal = GRAVITY * (1 + kappa * s * s) / (1 + kappa) - turn * s
    tangential = c * (turn - GRAVITY * kappa * s / (1 + kappa))
    edges = (gnn - mu * gnt, gnn + mu * gnt, chi, normal, abs(tangential) - mu * normal)
    return any(abs(edge) < Fraction(1, 10**9) for edge in edges)


@pytest.mark.parametrize("sigma", [1, -1, None])
def test_the_corner_has_the_solutions_of_a_search_over_slip_stick_and_separation(sigma):
    seen, kappas = set(), [Fraction(3), Fraction(39, 10)]
    for kappa, half, mu, turn in itertools.product(kappas, HALF_TANGENTS, FRICTIONS, TURNS):
        s, c = 2 * half / (1 + half * half), (1 - half * half) / (1 + half * half)
        if near_an_edge(kappa, s, c, mu, turn):
            continue
        solutions = corner_solutions(kappa, s, c, mu, turn, sigma)
        told, force, along = evaluated(kappa, s, c, mu, turn, sigma)
        where = (kappa, half, mu, turn, told)
        seen.add(told)
        assert (len(solutions) > 1) == (told == TWO_SOLUTIONS), where
        assert (told == NO_SOLUTION) == (not solutions), where
        assert told != SEPARATION or solutions == {(0, 0)}, where
        if solutions:
            assert any(
                abs(float(n) - force) <= 1e-9 * (1 + abs(force))
                and abs(float(t) - along) <= 1e-9 * (1 + abs(along))
                for n, t in solutions
            ), where
        if told == TWO_SOLUTIONS:
            assert (0, 0) in solutions, where
            assert force > 0, where
    # At rest there is one solution always.
    slips = {SEPARATION, SLIDING, TWO_SOLUTIONS, NO_SOLUTION}
    assert seen == ({SEPARATION, SLIDING, STICK} if sigma is None else slips)
