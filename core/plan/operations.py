"""The table of operations: the functions of numpy that equations may use, in compiled loops.

An equation is written once, for arrays. `vibrafeed.core.plan.loops` runs it on nodes of a graph,
whose steps become a compiled loop. A row of the table is all that it knows of one function.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import (
    arc_quotient,
    arc_series,
    binade,
    exponent,
)
from vibrafeed.core.mechanics.rolling import slip_share

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Operation:
    """A function of numpy as compiled loops have it.

    Attributes
    ----------
    function : callable
        The function: one of numpy's elementwise functions or of
        `vibrafeed.core.mechanics.arrays`, or `numpy.where`.
    loop : str
        The expression in a compiled loop, of the arguments; exact or rounded once, so that its bits
        are numpy's. Empty: numpy computes it between two loops; a loop takes the steps of an
        `Elementwise`.
    gives_truth : bool
        True if the result is a truth value.
    """

    function: Function
    loop: str = ""
    gives_truth: bool = False


# Columns: function, compiled loop, whether it gives a truth value.
_ROWS = (
    Operation(np.add, "{} + {}"),
    Operation(np.subtract, "{} - {}"),
    Operation(np.multiply, "{} * {}"),
    Operation(np.divide, "{} / {}"),
    Operation(np.power),
    Operation(np.positive),
    Operation(np.negative, "-{}"),
    Operation(np.square, "{0} * {0}"),
    Operation(np.reciprocal, "1.0 / {}"),
    Operation(np.sqrt, "sqrt({})"),
    Operation(np.hypot),
    Operation(np.ldexp),
    Operation(np.exp),
    Operation(np.expm1),
    Operation(np.log),
    Operation(np.log1p),
    Operation(binade, "binade({})"),
    Operation(exponent, "exponent({})"),
    Operation(arc_quotient),
    Operation(arc_series),
    Operation(slip_share),
    Operation(np.sin),
    Operation(np.cos),
    Operation(np.tan),
    Operation(np.arcsin),
    Operation(np.arccos),
    Operation(np.arctan),
    Operation(np.arctan2),
    Operation(np.sinh),
    Operation(np.cosh),
    Operation(np.tanh),
    Operation(np.arctanh),
    Operation(np.less, "{} < {}", gives_truth=True),
    Operation(np.less_equal, "{} <= {}", gives_truth=True),
    Operation(np.greater, "{} > {}", gives_truth=True),
    Operation(np.greater_equal, "{} >= {}", gives_truth=True),
    Operation(np.equal, "{} == {}", gives_truth=True),
    Operation(np.not_equal, "{} != {}", gives_truth=True),
    Operation(np.bitwise_and, "{} & {}"),
    Operation(np.bitwise_or, "{} | {}"),
    Operation(np.invert, "{} ^ True"),
    Operation(np.isnan, "{0} != {0}", gives_truth=True),
    Operation(np.isinf, "abs({}) == inf", gives_truth=True),
    Operation(np.isfinite, "abs({}) < inf", gives_truth=True),
    Operation(np.rint),
    Operation(np.where, "choose({}, {}, {})"),
    Operation(np.maximum, "choose(({0} >= {1}) | ({0} != {0}), {0}, {1})"),
    Operation(np.minimum, "choose(({0} <= {1}) | ({0} != {0}), {0}, {1})"),
    Operation(np.absolute, "abs({})"),
    Operation(
        np.sign, "choose({0} > 0.0, 1.0, choose({0} < 0.0, -1.0, choose({0} == 0.0, 0.0, {0})))"
    ),
    Operation(np.copysign, "copysign({}, {})"),
)

OPERATIONS: dict[Function, Operation] = {row.function: row for row in _ROWS}
"""The rows, by their function."""

IN_LOOPS: dict[Function, str] = {row.function: row.loop for row in _ROWS if row.loop}
"""The functions that a compiled loop takes in, with their expressions."""
