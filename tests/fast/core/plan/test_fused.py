"""The compiled way of a plan against numpy's: the same bits, whatever the scene and the threads."""

import numpy as np
import pytest

from benchmarks.evaluate import traceable
from fused_loops import check_same_bits
from night import NIGHT
from plans import make_plan
from vibrafeed.core.plan import evaluate as door
from vibrafeed.core.plan import program
from vibrafeed.core.plan.evaluate import Fused, evaluate
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.trace import Graph, UntraceableError, traced
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.values import Fixed, Points

UNTRACED = {
    ("rectangle-pair-impact", "frictionless"): "its results stand in stacked vectors",
    ("rectangle-pair-impact", "pfeiffer_glocker"): "a complementarity problem is solved by cases",
    ("rectangle-pair-impact", "moreau"): "the same",
    ("cylinder-pair-impact", "frictionless"): "the gap of two cylinders is searched for",
    ("cylinder-pair-impact", "pfeiffer_glocker"): "the same",
    ("cylinder-pair-impact", "moreau"): "the same",
    ("cylinder-rolling", "thesis"): "screws stand in stacked vectors",
    ("cylinder-rolling", "derived"): "the same",
    ("disc-on-edge", "physical"): "the same",
    ("soft-contact", "physical"): "powers, and roots that are searched for",
    ("row-on-plane", "platoons"): "a sum over the parts",
}
"""The variants of which numpy keeps some outputs, and why."""


VARIANTS = [
    (name, variant)
    for name, scene in SCENES.items()
    for variant in scene.variants
    if NIGHT or name != "orienting-line"  # whose outputs take seconds
]


@pytest.mark.parametrize(("name", "variant"), VARIANTS)
def test_what_numpy_keeps_is_listed(name, variant):
    assert bool(traceable(name, variant)[False]) == ((name, variant) in UNTRACED)


TRACK = ("frequency", "amplitude", "alpha", "beta", "friction", "radius", "distance", "speed")


def track(outputs: tuple[str, ...], **values) -> tuple[Plan, Grid]:
    """Return plan and grid of a track; a tuple of three is a span."""
    spans = {
        "frequency": (20, 120, 9), "amplitude": (1e-4, 1e-3, 8), "alpha": (0, 60, 7),
        "beta": (5, 60, 11), "friction": (0.1, 0.8, 6), "radius": 0.8, "distance": 2e-4,
    } | values  # fmt: skip
    plan = make_plan("rectangle-on-track", "derived", outputs, spans)
    axes = {
        name: Points(tuple(np.linspace(*v))) if isinstance(v, tuple) else Fixed(v)
        for name, v in spans.items()
    }
    return plan, Grid.of(axes)


@pytest.mark.parametrize(("threads", "task"), [(1, 600), (3, 5_000), (3, 1 << 20)])
def test_bits_do_not_depend_on_threads_or_tasks(monkeypatch, threads, task):
    monkeypatch.setattr(door, "TASK_CELLS", task)
    monkeypatch.setattr(door, "COLUMN_CELLS", task)
    # Numpy takes the arc of a stop between loops; the distances are short and long ones.
    spans = {"speed": (0.0, 0.2, 3), "distance": (1e-4, 0.3, 2), "beta": (5, 60, 6)}
    plan, grid = track(("travel_time", "stopping_time"), **spans)
    got = check_same_bits(plan, grid, threads)
    done: list[float] = []
    Fused(plan, traced(plan, grid.along), grid).run(got, threads, done.append)
    assert sum(done) == pytest.approx(1)


@pytest.mark.parametrize(
    ("outputs", "step", "less", "more", "known"),
    [
        # Short distances need no logarithms; a part that starts from rest needs one root.
        ("travel_time", "binade(", {"speed": 0.3, "distance": 2e-4},
         {"speed": 0.3, "distance": 0.3}, 0),
        ("transport_velocity", "sqrt(", {"speed": 0.0}, {"speed": 0.3}, 1),
    ],
)  # fmt: skip
def test_steps_that_values_make_superfluous_are_left_out(outputs, step, less, more, known):
    few, many = (
        "".join(Fused(plan, traced(plan, grid.along), grid).sources).count(step)
        for plan, grid in (track((outputs,), **given) for given in (less, more))
    )
    assert few == known < many


@pytest.mark.parametrize("shape", [(100_003,), (40_009, 3), (3, 40_009), (2, 2, 2, 2, 2, 5_003)])
def test_long_and_short_axes(shape):
    names = ("amplitude", "beta", "alpha", "friction", "distance", "frequency")
    chosen = names[-len(shape) :] if len(shape) == 6 else names[: len(shape)]
    values = {"amplitude": (1e-4, 1e-3), "beta": (5, 60), "alpha": (0, 60), "frequency": (20, 120)}
    values |= {"friction": (0.1, 0.8), "distance": (1e-5, 1e-3)}
    axes = {n: (*values[n], count) for n, count in zip(chosen, shape, strict=True)}
    middle = {n: sum(values[n]) / 2 for n in names if n not in chosen}
    plan, grid = track(("transport_velocity", "throw_number"), **middle, **axes)
    check_same_bits(plan, grid)


def test_one_loop_serves_studies_that_differ_in_their_numbers():
    sources = {
        Fused(plan, traced(plan, grid.along), grid).sources
        for plan, grid in (
            track(("transport_velocity",), radius=r, distance=d, frequency=(f, 99, 9))
            for r, d, f in ((0.8, 2e-4, 20), (0.5, 1e-3, 44))
        )
    }
    assert len(sources) == 1


def test_steps_that_change_nothing_are_left_out():
    graph = Graph()
    x, y = graph.leaf("x", ["x"]), graph.leaf("y", ["y"])
    assert (x + y) is (x + y)
    assert (x + y).axes == {"x", "y"}
    assert np.where(np.True_, x, y) is x
    assert np.where(x > y, x, x) is x
    assert ((x > y) & np.True_) is (x > y)
    assert not isinstance((x > y) & np.False_, type(x))
    assert all(one is x for one in (x * 1.0, x / 1, x - 0.0))
    # -0.0 + 0.0 is 0.0: a sum with 0 is a step.
    assert all(one is not x for one in (x + 0.0, x - (-0.0), 0.0 * x))


@pytest.mark.parametrize(
    "step",
    [
        float,
        lambda x: x if x > 0 else -x,
        lambda x: x**2,
        lambda x: x.ndim,
        lambda x: x[0],
        lambda x: np.stack([x, x]),
        np.add.reduce,
        np.asarray,
        lambda x: x * np.arange(3.0),
    ],
)
def test_what_is_not_elementwise_does_not_trace(step):
    with pytest.raises(UntraceableError):
        step(Graph().leaf("x", ["x"]))


def test_loops_are_compiled_once_numpy_has_worked_as_long(monkeypatch):
    monkeypatch.setattr(door, "_seen", door.defaultdict(int))
    for name in ("COMPILED_FROM", "CACHED_FROM"):
        monkeypatch.setattr(door, name, 300_000)
    monkeypatch.setattr(program, "_compiled", set())
    run, ran = Fused.run, []
    monkeypatch.setattr(Fused, "run", lambda *given: ran.append(1) or run(*given))
    plan, grid = track(("transport_velocity",))  # 33,264 cells: 3 ms of numpy
    asked = [bool(evaluate(plan, grid)) and len(ran) for _ in range(10)]
    assert asked == [*[0] * 9, 1]
