"""Equations as a graph of elementwise steps: what numpy would compute, without computing it.

The equations of a plan are written for arrays and do not ask what stands in them. Given nodes of a
graph instead, numpy's own protocols tell which steps they take. What a step cannot be said of (a
loop over values, an index, a shape) makes the plan untraceable, and numpy runs it as it stands.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.mechanics.arrays import Elementwise, binade, exponent
from vibrafeed.core.plan.plan import Plan, Verdict, regimes_of, run
from vibrafeed.core.scenes import Equation

Function = Callable[..., Any]

IN_LOOPS: dict[Function, str] = {
    np.add: "{} + {}",
    np.subtract: "{} - {}",
    np.multiply: "{} * {}",
    np.divide: "{} / {}",
    np.negative: "-{}",
    np.square: "{0} * {0}",
    np.reciprocal: "1.0 / {}",
    np.sqrt: "sqrt({})",
    binade: "binade({})",
    exponent: "exponent({})",
    np.less: "{} < {}",
    np.less_equal: "{} <= {}",
    np.greater: "{} > {}",
    np.greater_equal: "{} >= {}",
    np.equal: "{} == {}",
    np.not_equal: "{} != {}",
    np.bitwise_and: "{} & {}",
    np.bitwise_or: "{} | {}",
    np.invert: "{} ^ True",
    np.isnan: "{0} != {0}",
    np.isinf: "abs({}) == inf",
    np.isfinite: "abs({}) < inf",
    np.where: "choose({}, {}, {})",
    np.maximum: "choose(({0} >= {1}) | ({0} != {0}), {0}, {1})",
    np.minimum: "choose(({0} <= {1}) | ({0} != {0}), {0}, {1})",
    np.absolute: "abs({})",
    np.sign: "choose({0} > 0.0, 1.0, choose({0} < 0.0, -1.0, choose({0} == 0.0, 0.0, {0})))",
    np.copysign: "copysign({}, {})",
}
"""The functions that a compiled loop takes in, with their expressions: exact or rounded once, so
that the bits are numpy's. Others numpy computes between two loops; of an `Elementwise` that is not
here a loop takes the steps."""

LOGICAL = {np.logical_and: np.bitwise_and, np.logical_or: np.bitwise_or, np.logical_not: np.invert}
"""Functions of truth values in numpy, and the ones that stand for them in a graph."""


class UntraceableError(VibrafeedError):
    """An equation takes a step that is not elementwise, or hangs on the values in an array."""


def _refuse(why: str) -> Function:
    def method(*_: Any, **__: Any) -> Any:
        raise UntraceableError(f"the equation {why}")

    return method


class Node(NDArrayOperatorsMixin):
    """One value of a graph: a parameter, by name, or a function of nodes and plain numbers.

    `number` is its place among the nodes of its graph, after those of its inputs, `axes` are those
    that it depends on, `dtype` is that of its values.
    """

    __slots__ = ("axes", "dtype", "function", "graph", "inputs", "name", "number")

    def __init__(
        self,
        graph: "Graph",
        function: Function | None,
        inputs: tuple[Any, ...],
        axes: frozenset[str],
        dtype: np.dtype[Any],
        name: str = "",
    ):
        self.graph, self.function, self.inputs = graph, function, inputs
        self.axes, self.dtype, self.name = axes, dtype, name
        self.number = len(graph.nodes)
        graph.nodes.append(self)

    @property
    def before(self) -> "Iterator[Node]":
        """The nodes among its inputs."""
        return (operand for operand in self.inputs if isinstance(operand, Node))

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **settings: Any
    ) -> Any:
        if method != "__call__" or settings or ufunc.nout != 1:
            raise UntraceableError(
                f"the equation calls {ufunc.__name__}.{method}, which is not an "
                "elementwise operation"
            )
        if isinstance(ufunc, Elementwise) and ufunc not in IN_LOOPS:
            return ufunc.body(*inputs)
        return self.graph.apply(LOGICAL.get(ufunc, ufunc), inputs)  # in place: a new value

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        # An iteration never ends by `if not np.any(...)`: further steps change no finished cell.
        if func is np.any and len(args) == 1 and not kwargs:
            return True
        if func is not np.where or len(args) != 3 or kwargs:
            raise UntraceableError(f"{func.__name__} is not elementwise")
        return self.graph.apply(np.where, args)

    def __getattr__(self, name: str) -> Any:
        raise UntraceableError(f"the equation uses .{name} of an array, which cannot be compiled")

    # numpy's power differs in the last bit between numbers and arrays
    __pow__ = _refuse("raises to a power, which cannot be compiled: write np.square, or a product")
    __array__ = _refuse("converts a computed value to an array, which cannot be compiled")
    __bool__ = _refuse("branches on a computed value, which cannot be compiled: use np.where")
    __getitem__ = _refuse("indexes an array, which cannot be compiled")
    __float__ = __int__ = __index__ = __len__ = __iter__ = _refuse(
        "converts an array to a number, which cannot be compiled"
    )


class Graph:
    """Nodes, each after its inputs, and equal ones once only."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._known: dict[Any, Any] = {}

    def leaf(self, name: str, axes: Iterable[str], dtype: Any = np.float64) -> Node:
        """Return the node of a parameter in the graph; the same name gives the same node."""
        key = (None, name)
        if key not in self._known:
            self._known[key] = Node(self, None, (), frozenset(axes), np.dtype(dtype), name)
        return self._known[key]

    def apply(self, function: Function, inputs: Iterable[Any]) -> Any:
        """Return the node (one for equal steps) or number for a function of nodes and numbers."""
        operands = tuple(
            operand if isinstance(operand, Node) else _number(operand) for operand in inputs
        )
        nodes = [operand for operand in operands if isinstance(operand, Node)]
        if not nodes:
            return function(*operands)
        simplified = SIMPLER[function](operands) if function in SIMPLER else None
        if simplified is not None:
            return simplified[0]
        key = (function, *map(_identity, operands))
        if key not in self._known:
            axes = frozenset().union(*(operand.axes for operand in nodes))
            self._known[key] = Node(self, function, operands, axes, _dtype(function, operands))
        return self._known[key]


def _number(value: Any) -> Any:
    if not isinstance(value, np.ndarray):
        return value
    if value.ndim:
        raise UntraceableError("the equation creates an array, which cannot be compiled")
    return value[()]


def _identity(operand: Any) -> Any:
    if isinstance(operand, Node):
        return operand.number
    return (type(operand), np.asarray(operand).tobytes())


def _dtype(function: Function, operands: Iterable[Any]) -> np.dtype[Any]:
    samples = (
        np.ones(1, operand.dtype) if isinstance(operand, Node) else operand for operand in operands
    )
    with np.errstate(all="ignore"):
        try:
            return np.asarray(function(*samples)).dtype
        except TypeError as error:
            raise UntraceableError(str(error)) from None


def _chosen(operands: tuple[Any, ...]) -> tuple[Any] | None:
    condition, first, second = operands
    if not isinstance(condition, Node):
        return (first if condition else second,)
    return (first,) if _identity(first) == _identity(second) else None


def _joined(operands: tuple[Any, ...], *, neutral: bool) -> tuple[Any] | None:
    for first, second in (operands, operands[::-1]):
        if isinstance(first, bool | np.bool_):
            return (second if bool(first) == neutral else first,)
    return (operands[0],) if _identity(operands[0]) == _identity(operands[1]) else None


def _product(operands: tuple[Any, ...]) -> tuple[Any] | None:
    for first, second in (operands, operands[::-1]):
        if _is(first, 1.0) and isinstance(second, Node) and second.dtype == np.float64:
            return (second,)
    return None


def _unchanged(operands: tuple[Any, ...], *, by: float) -> tuple[Any] | None:
    return (operands[0],) if _is(operands[1], by) and operands[0].dtype == np.float64 else None


SIMPLER: dict[Function, Callable[[tuple[Any, ...]], tuple[Any] | None]] = {
    np.where: _chosen,
    np.positive: lambda operands: (operands[0],),
    np.bitwise_and: partial(_joined, neutral=True),
    np.bitwise_or: partial(_joined, neutral=False),
    np.multiply: _product,
    np.divide: partial(_unchanged, by=1.0),
    np.subtract: partial(_unchanged, by=0.0),
}
"""By function: takes the operands of a step; returns its result in a tuple if that is known without
the step, to the last bit, else None."""


def _is(operand: Any, value: float) -> bool:
    return not isinstance(operand, Node) and bool(operand == value) and not np.signbit(operand)


@dataclass(frozen=True, eq=False)
class Traced:
    """The graph of a plan, and its results by name: nodes, or numbers that depend on nothing."""

    graph: Graph
    results: Mapping[str, Any]


def traced(plan: Plan, along: Mapping[str, str]) -> Traced | None:
    """Return the graph behind a plan's outputs and verdicts; None if an equation has none.

    `along` has the axis of each parameter with several values. Others are nodes too: equal plans
    share the graph.
    """
    parameters = (*plan.parameters, *plan.defaults)
    ranged = tuple((name, axis) for name, axis in along.items() if name in plan.parameters)
    return _traced(plan.equations, plan.verdicts, plan.outputs, parameters, ranged)


@lru_cache(maxsize=256)
def _traced(
    equations: tuple[Equation, ...],
    verdicts: tuple[Verdict, ...],
    outputs: tuple[str, ...],
    parameters: tuple[str, ...],
    ranged: tuple[tuple[str, str], ...],
) -> Traced | None:
    # The equations run on nodes in place of arrays, which record each operation.
    graph = Graph()
    axes = {name: {axis} for name, axis in ranged}
    leaves = {name: graph.leaf(name, axes.get(name, ())) for name in parameters}
    try:
        values = run(equations, leaves)
        return Traced(
            graph, {name: values[name] for name in outputs} | regimes_of(verdicts, values)
        )
    except UntraceableError:
        return None
