"""The compiled way of a plan against numpy's: the same bits, whatever the scene and the threads."""

import numpy as np
import pytest

from benchmarks.evaluate import grid_of, plan_of, traceable
from plans import make_plan
from vibrafeed.core.plan import evaluate as door
from vibrafeed.core.plan import program
from vibrafeed.core.plan.evaluate import Fused, empty_results, evaluate, evaluate_in_blocks
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
SHORT = {("soft-contact", "physical")}
"""Those whose outputs depend on so few parameters that no loop is worth while."""

BY_DAY = {
    ("rectangle-isolated", "thesis"), ("cylinder-isolated", "derived"),
    ("cylinder-pair-impact", "moreau"), ("cone-on-plane", "physical"),
    ("bowl-drive-unit", "measured"), ("row-on-plane", "bend"),
}  # fmt: skip
"""Those whose loops take the compiler 1 to 4 s; others, of up to 13 s, are for the night."""

VARIANTS = [
    pytest.param(name, variant, marks=[] if (name, variant) in BY_DAY else [pytest.mark.night])
    for name, scene in SCENES.items()
    for variant in scene.variants
]


def assert_same_bits(got, expected):
    for name, values in expected.items():
        # Of two zeros of different sign numpy itself takes either, by the width of its registers.
        np.testing.assert_array_equal(got[name], values, err_msg=name)


def both_ways(plan: Plan, grid: Grid, threads: int | None = None):
    expected, got = empty_results(plan, grid), empty_results(plan, grid)
    with np.errstate(all="ignore"):
        evaluate_in_blocks(plan, grid, expected)
    Fused(plan, traced(plan, grid.along), grid).run(got, threads)
    return got, expected


@pytest.fixture
def few_cells(monkeypatch):
    """Let loops take what numpy otherwise would because it is small."""
    for module in (program, door):
        monkeypatch.setattr(module, "FEW_CELLS", 200)
    for cached in (program.edge_of, program.program_of):
        cached.cache_clear()
    yield
    for cached in (program.edge_of, program.program_of):
        cached.cache_clear()


@pytest.mark.usefixtures("few_cells")
@pytest.mark.parametrize(("name", "variant"), VARIANTS)
def test_loops_give_the_bits_of_numpy(name, variant):
    ways = traceable(name, variant)
    assert bool(ways[False]) == ((name, variant) in UNTRACED), ways[False]
    plan = plan_of(name, variant, tuple(ways[True]))
    grid = grid_of(plan, 60_000, seed=1)
    assert Fused(plan, traced(plan, grid.along), grid).sources or (name, variant) in SHORT
    got, expected = both_ways(plan, grid)
    assert_same_bits(got, expected)


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


@pytest.mark.parametrize("task", [600, 5_000, 1 << 20])
@pytest.mark.parametrize("threads", [1, 3])
def test_bits_do_not_depend_on_threads_or_tasks(monkeypatch, threads, task):
    monkeypatch.setattr(door, "TASK_CELLS", task)
    monkeypatch.setattr(door, "COLUMN_CELLS", task)
    # Numpy takes the arc of a stop between loops; the distances are short and long ones.
    spans = {"speed": (0.0, 0.2, 3), "distance": (1e-4, 0.3, 2), "beta": (5, 60, 6)}
    plan, grid = track(("travel_time", "stopping_time"), **spans)
    done: list[float] = []
    got, expected = both_ways(plan, grid, threads)
    assert_same_bits(got, expected)
    Fused(plan, traced(plan, grid.along), grid).run(got, threads, done.append)
    assert sum(done) == pytest.approx(1)


@pytest.mark.parametrize("shape", [(100_003,), (40_009, 3), (3, 40_009), (2, 2, 2, 2, 2, 5_003)])
def test_long_and_short_axes(shape):
    names = ("amplitude", "beta", "alpha", "friction", "distance", "frequency")
    chosen = names[-len(shape) :] if len(shape) == 6 else names[: len(shape)]
    values = {"amplitude": (1e-4, 1e-3), "beta": (5, 60), "alpha": (0, 60), "frequency": (20, 120)}
    values |= {"friction": (0.1, 0.8), "distance": (1e-5, 1e-3)}
    axes = {n: (*values[n], count) for n, count in zip(chosen, shape, strict=True)}
    middle = {n: sum(values[n]) / 2 for n in names if n not in chosen}
    plan, grid = track(("transport_velocity", "throw_number"), **middle, **axes)
    assert_same_bits(*both_ways(plan, grid))


def test_short_distances_need_no_logarithms():
    short, long = (
        "\n".join(Fused(plan, traced(plan, grid.along), grid).sources)
        for plan, grid in (track(("travel_time",), speed=0.3, distance=x) for x in (2e-4, 0.3))
    )
    assert "binade(" not in short
    assert "binade(" in long


def test_a_part_that_starts_from_rest_needs_one_root():
    moving, resting = (
        "\n".join(Fused(plan, traced(plan, grid.along), grid).sources)
        for plan, grid in (track(("transport_velocity",), speed=v) for v in (0.3, 0.0))
    )
    assert resting.count("sqrt(") == 1
    assert moving.count("sqrt(") == 2


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
        lambda x: float(x),
        lambda x: x if x > 0 else -x,
        lambda x: x**2,
        lambda x: x.ndim,
        lambda x: x[0],
        lambda x: np.stack([x, x]),
        lambda x: np.add.reduce(x),
        lambda x: np.asarray(x),
        lambda x: x * np.arange(3.0),
    ],
)
def test_what_is_not_elementwise_does_not_trace(step):
    with pytest.raises(UntraceableError):
        step(Graph().leaf("x", ["x"]))


def test_loops_are_compiled_once_numpy_has_worked_as_long(monkeypatch):
    monkeypatch.setattr(door, "_seen", door.defaultdict(int))
    monkeypatch.setattr(door, "COMPILED_FROM", 300_000)
    monkeypatch.setattr(door, "CACHED_FROM", 300_000)
    monkeypatch.setattr(program, "_compiled", set())
    ran: list[int] = []
    run = Fused.run

    def counted(self, *given):
        ran.append(len(ran))
        run(self, *given)

    monkeypatch.setattr(Fused, "run", counted)
    plan, grid = track(("transport_velocity",))  # 33,264 cells: 3 ms of numpy
    asked = [bool(evaluate(plan, grid)) and len(ran) for _ in range(11)]
    assert asked[:9] == [0] * 9
    assert asked[9] == 1
