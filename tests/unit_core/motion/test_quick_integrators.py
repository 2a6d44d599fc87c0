"""scipy's implicit integrators with our calls of LAPACK: not a bit changes, and checks remain."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import BDF, LSODA, Radau, solve_ivp
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve

from benchmarks.worked_values import MEAN_VELOCITIES
from core.motion.methods.regularised import SOLVERS
from core.motion.methods.regularised.laws import Cell, laws
from core.motion.methods.regularised.linear import INTEGRATORS, factors_of, solution_of


def path(method):
    given = MEAN_VELOCITIES["hop"].groups()
    drive = given["drive_number_along"], given["drive_number_normal"]
    cell = Cell(laws(0.3, 0.4, 0.0, 1e-4, 1e6), drive, (0.0, given["gravity_number_normal"]))
    return solve_ivp(
        cell.rate, (0.0, 4.0), cell.rest(), method=method, jac=cell.jacobian, rtol=1e-6, atol=1e-8
    )


@pytest.mark.parametrize("own", [Radau, BDF, LSODA])
def test_every_bit_of_a_path_is_that_of_scipy(own):
    plain, quick = path(own), path(INTEGRATORS[own.__name__])
    assert plain.success
    assert plain.t.size > 50
    assert np.array_equal(plain.t, quick.t)
    assert np.array_equal(plain.y, quick.y)
    assert (plain.nfev, plain.njev, plain.nlu) == (quick.nfev, quick.njev, quick.nlu)


def test_every_solver_has_its_integrator():
    assert set(INTEGRATORS) == set(SOLVERS)


@pytest.mark.parametrize("kind", [float, complex])
def test_systems_are_solved_as_scipy_solves_them(kind):
    random = np.random.default_rng(5)
    for size in (4, 6):
        matrix = random.normal(size=(size, size)) + kind("1j" if kind is complex else 0)
        right = random.normal(size=size).astype(kind)
        ours, theirs = factors_of(matrix.copy()), lu_factor(matrix)
        assert all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))
        assert np.array_equal(solution_of(ours, right), lu_solve(theirs, right))


def test_what_scipy_refuses_is_refused():
    with pytest.raises(ValueError, match="infs or NaNs"):
        factors_of(np.full((2, 2), np.nan))
    with pytest.raises(ValueError, match="infs or NaNs"):
        solution_of(factors_of(np.eye(2)), np.array([1.0, np.inf]))
    with pytest.warns(LinAlgWarning, match="zero"):
        factors_of(np.zeros((2, 2)))
