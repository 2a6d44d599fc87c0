"""The first-order conditions of an optimum (Karush, Kuhn, Tucker): what they leave at a point."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.optimise.problem import OptimisationProblem

STEP = 1e-6  # of a variable's range; differences of the outputs then keep about ten digits
MAX_SUBSETS = 4000  # sets of binding constraints that are tried


def residual(
    problem: OptimisationProblem,
    x: Array,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    touching: float,
) -> Array:
    """Return the residual of the first-order optimality conditions (Karush, Kuhn, Tucker).

    At an optimum the negative gradient of the objective is a combination, without negative weights,
    of the inward gradients of the binding constraints; the residual is what is left of it, with
    each variable over its range, relative to the objective's scale. At a kink, |other| = 0, the
    other output's gradient may enter with up to twice its weight. NaN where a slope has no value.
    The result has the shape (cells,).

    Parameters
    ----------
    problem : OptimisationProblem
        The problem.
    x : ndarray, shape (variables, cells)
        The optima in SI units.
    design, scales : mapping of str to ndarray
        Fixed parameters and scales of the outputs, shape (cells,).
    touching : float
        Share of a scale, or of a range, within which a constraint binds.
    """
    count, cells = x.shape
    span = problem.upper - problem.lower
    unit = (x - problem.lower[:, None]) / span[:, None]
    # At each variable: two steps back, one back, one ahead, two ahead, and the point itself.
    steps = STEP * np.array([-2.0, -1.0, 1.0, 2.0])
    moves = np.concatenate([np.kron(np.eye(count), steps), np.zeros((count, 1))], axis=1)
    at = unit[:, :, None] + moves[:, None, :]
    column = {name: values[:, None] for name, values in design.items()}
    sizes = {name: values[:, None] for name, values in scales.items()}
    places = problem.lower[:, None, None] + span[:, None, None] * np.clip(at, 0.0, 1.0)
    known = problem.known(places, column)
    _, beyond = problem.judged(places, column, sizes)
    beyond = beyond + np.maximum(np.abs(at - 0.5) - 0.5, 0.0).sum(axis=0)
    # Across a contact the outputs have a kink: differences stay on the side that is allowed.
    allowed = beyond <= np.maximum(beyond[:, -1:], touching) + 1e-3 * STEP
    allowed = allowed[:, :-1].reshape(cells, count, 4)
    ahead = allowed[..., 2] & allowed[..., 3] & ~allowed[..., 1]
    back = allowed[..., 0] & allowed[..., 1] & ~allowed[..., 2]

    def slope(values: Array) -> Array:
        """Return the derivative by each variable over its range, shape (cells, variables).

        `values` are on the stencil: four points along each variable, then the point itself.
        """
        values = np.broadcast_to(values, (cells, 4 * count + 1))
        here = values[:, -1:]
        two_back, one_back, one_on, two_on = np.moveaxis(
            values[:, :-1].reshape(cells, count, 4), 2, 0
        )
        middle = (one_on - one_back) / 2
        forward = -1.5 * here + 2 * one_on - two_on / 2
        backward = 1.5 * here - 2 * one_back + two_back / 2
        return np.where(ahead, forward, np.where(back, backward, middle)) / STEP

    size = problem.scale(scales)[:, None]
    target = problem.sign * slope(problem.output(problem.criterion.output, known)) / size
    here = problem.known(x, design)
    pulls: list[Array] = []
    binds: list[Mask] = []
    most: list[float] = []
    for i in range(count):
        inward = np.zeros((cells, count))
        inward[:, i] = 1.0
        pulls += [-inward, inward]
        binds += [unit[i] <= touching, unit[i] >= 1 - touching]
        most += [np.inf, np.inf]
    for kept in problem.kept:
        margin = np.broadcast_to(problem.margin(kept, here, design), (cells,))
        tight = np.abs(margin) <= touching * scales[kept.output]
        # The margin's own slope, on the side of the absolute value where the point lies.
        value = np.broadcast_to(problem.output(kept.output, here), (cells,))
        turn = np.where((value < 0) & kept.absolute, -1.0, 1.0)
        along = slope(problem.output(kept.output, known)) * turn[:, None]
        along = along / scales[kept.output][:, None]
        pulls.append(along if kept.upper else -along)
        binds.append(tight)
        most.append(np.inf)
        if kept.absolute and kept.upper:
            # With a limit of next to nothing both of its sides bind.
            pulls.append(-pulls[-1])
            bound = np.broadcast_to(margin + np.abs(value), (cells,))
            binds.append(tight & (np.abs(bound) <= touching * scales[kept.output]))
            most.append(np.inf)
    if problem.weight and problem.against:
        other = slope(problem.output(problem.against, known)) / size
        value = np.broadcast_to(problem.output(problem.against, here), (cells,))
        kink = np.abs(value) <= touching * scales[problem.against]
        side = np.where(kink, 1.0, np.sign(value))
        target = target - problem.weight * side[:, None] * other
        pulls.append(-other)
        binds.append(kink)
        most.append(2 * problem.weight)
    return _least(target, np.stack(pulls), np.stack(binds), most)


def _least(target: Array, pulls: Array, binds: NDArray[np.bool_], most: list[float]) -> Array:
    """Return the smallest |target - sum of weights times pulls| over all weights, shape (cells,).

    It is the residual of the optimality conditions: what of the objective's gradient the
    constraints do not balance. Weights range from 0 to `most`. No more directions than variables
    are needed (Caratheodory), so all such subsets are tried.

    Parameters
    ----------
    target : ndarray, shape (cells, variables)
        Gradient of the objective.
    pulls : ndarray, shape (directions, cells, variables)
        Outward gradients of the constraints.
    binds : ndarray of bool, shape (directions, cells)
        True where a constraint binds.
    most : list of float
        Largest weight of each direction.
    """
    count = target.shape[1]
    starts = [target]
    starts += [
        target - top * pulls[i] * binds[i][:, None] for i, top in enumerate(most) if top < 9e9
    ]
    least = np.minimum.reduce([np.linalg.norm(start, axis=1) for start in starts])
    used = [i for i in range(len(pulls)) if binds[i].any()]
    subsets = [s for n in range(1, count + 1) for s in combinations(used, n)][:MAX_SUBSETS]
    for subset in subsets:
        here = np.flatnonzero(np.logical_and.reduce([binds[i] for i in subset]))
        if not here.size:
            continue
        matrix = np.stack([pulls[i][here] for i in subset], axis=2)
        matrix = np.where(np.isfinite(matrix), matrix, 0.0)
        for start in starts:
            wanted = np.where(np.isfinite(start[here]), start[here], 0.0)
            weights = np.einsum("cij,cj->ci", np.linalg.pinv(matrix), wanted)
            rest = np.linalg.norm(wanted - np.einsum("cij,cj->ci", matrix, weights), axis=1)
            top = np.array([most[i] for i in subset])
            fits = np.all((weights >= 0) & (weights <= top), axis=1)
            least[here] = np.where(fits, np.fmin(least[here], rest), least[here])
    return least
