"""The price of a study: a few cells, timed once, within a budget; more cells never cost less."""

import itertools
import tracemalloc

import numpy as np
import pytest

import vibrafeed.core.kernel_cache
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan import prepared as module
from vibrafeed.core.plan.prepared import BUDGET, MARGIN, SAMPLED, Price
from vibrafeed.core.quantities import MOTION_STATUSES

HOPS = {"frequency": 50, "amplitude": "2.1 mm", "beta": 41, "friction": 0.4, "restitution": 0.6}
CALL = 2e-3  # s, of a call besides its cells
PERIODIC, APERIODIC = (MOTION_STATUSES[name].value for name in ("periodic", "aperiodic"))


def study(**more):
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "parameters": HOPS | more,
    }  # fmt: skip


def frictions(num):
    return {"start": 0.3, "stop": 0.5, "num": num}


class Motions:
    """Stands for the equations of a plan: each period of a cell takes so long, by its own clock."""

    def __init__(self, monkeypatch, a_period, repeat_after=np.inf):
        self.a_period, self.repeat_after = a_period, repeat_after
        self.now, self.asked = 0.0, []
        monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: True)
        monkeypatch.setattr(module, "run_equations", self.run)
        monkeypatch.setattr(module.time, "thread_time", lambda: self.now)
        monkeypatch.setattr(module.time, "monotonic", lambda: self.now)

    def run(self, plan, known, watch):
        count, allowed = known["friction"].size, float(known["max_periods"])
        each = self.a_period * min(allowed, self.repeat_after)
        done = min(count, int(BUDGET / each)) if each else count
        self.now += CALL + min(count * each, BUDGET)
        self.asked.append((count, allowed))
        if not done:
            raise StoppedError("stopped")
        status = np.full(count, PERIODIC if allowed >= self.repeat_after else APERIODIC)
        status[done:] = module.NOT_COMPUTED
        moved = type("Moved", (), {"status": status})
        return {one.gives: moved for one in plan.equations}


@pytest.mark.parametrize(
    ("a_period", "least", "most"),
    [(1e-6, 0.7, 1.3), (1e-2, 0.7, 1.3),  # the budget cuts one cell
     (10.0, BUDGET * 100 / 1e6, 1.3)],  # of 1,000 periods, 8 took the budget
)  # fmt: skip
def test_what_never_repeats_is_priced_for_all_its_periods(monkeypatch, a_period, least, most):
    motions = Motions(monkeypatch, a_period)
    content = study(friction=frictions(10**6)) | {"max_periods": 100_000}
    cell = prepare_content(content).price.cell
    assert least < cell / (MARGIN * a_period * 100_000) < most
    assert motions.now < 8 * BUDGET
    assert max(count for count, _ in motions.asked) <= SAMPLED


@pytest.mark.parametrize("repeat_after", [20.0, np.inf])
def test_more_cells_never_cost_less(monkeypatch, repeat_after):
    Motions(monkeypatch, 1e-5, repeat_after)
    counts = [2, 3, 10, 63, 64, 65, 100, 1000, 10**6]
    prices = [prepare_content(study(friction=frictions(num))).seconds for num in counts]
    assert all(one < two for one, two in itertools.pairwise(prices))


def test_an_axis_that_no_motion_depends_on_makes_no_more_motions(monkeypatch):
    motions = Motions(monkeypatch, 1e-4, 20.0)
    axes = {"friction": frictions(5), "length": [0.01, 0.02, 0.03]}
    content = study(**axes, part_gap=0.001) | {"outputs": ["feed_rate"]}
    prepared = prepare_content(content)
    assert prepared.cells == 15
    assert prepared.price.cell * 15 == pytest.approx(MARGIN * 5 * 20e-4)
    assert max(count for count, _ in motions.asked) == 5


def test_sampled_cells_are_evenly_spread_and_the_same_again():
    axes = {"friction": frictions(1000), "gamma": {"start": -2, "stop": 2, "num": 1000}}
    prepared = prepare_content(study(**axes))
    (known, count, share), (again, *_) = (
        module._spread_cells(prepared.plan, prepared.grid, {}) for _ in range(2)
    )
    assert (count, share) == (SAMPLED, 1.0)
    assert all(np.array_equal(known[name], again[name]) for name in known)
    halves = np.array([known["friction"] > 0.4, known["gamma"] > 0])
    quarters = np.unique(halves, axis=1, return_counts=True)[1]
    assert quarters.size == 4
    assert quarters.min() >= SAMPLED // 4 - 3


ROUND = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3, "diameter": "8 mm"}
DROPPED = {
    "length": "20 mm", "height": "12 mm", "drop_height": "10 mm", "pitch": 60, "friction": 0.3,
    "restitution": 0.2, "duration": 1,
}  # fmt: skip


@pytest.mark.parametrize(
    ("scene", "method", "parameters", "outputs"),
    [
        ("rectangle-on-plane", "events", HOPS, ["conveying_velocity"]),
        ("rectangle-on-plane", "reference", HOPS, ["motion_status"]),
        ("roller-on-plane", "events", ROUND, ["slip_velocity"]),
        ("rectangle-isolated", "events", DROPPED, ["settling_time"]),
        ("row-on-plane", "events", HOPS | {"parts": 3}, ["conveying_velocity"]),
    ],
)
def test_motions_of_all_kinds_are_priced(monkeypatch, scene, method, parameters, outputs):
    monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: True)
    content = {"kind": "simulate", "scene": scene, "method": method}
    prepared = prepare_content({**content, "parameters": parameters, "outputs": outputs})
    assert 0 < prepared.price.cell < float("inf")  # seconds, more while kernels are compiled


def test_without_compiled_code_nothing_is_simulated(monkeypatch):
    monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: not [*names])
    prepared = prepare_content(study())
    assert prepared.price == Price(0.0, MARGIN * prepared.method.seconds_a_cell)


def test_closed_forms_have_a_fixed_price_of_a_cell_at_any_size():
    # 10^24 cells: an axis of them alone would take 800 MB.
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "beta": (5, 60)}
    axes = {name: {"start": a, "stop": b, "num": 10**8} for name, (a, b) in ends.items()}
    content = {
        "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
        "parameters": {**axes, "friction": 0.3},
    }  # fmt: skip
    tracemalloc.start()
    try:
        prepared = prepare_content(content)
        assert prepared.seconds == MARGIN * prepared.plan.scene.seconds_a_cell * 1e24
        assert tracemalloc.get_traced_memory()[1] < 2e7  # bytes; what libraries keep is some 10^6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("repeat_after", [5.0, 700.0])
def test_a_motion_that_repeats_is_priced_as_measured_and_once(monkeypatch, repeat_after):
    motions = Motions(monkeypatch, 1e-6, repeat_after)
    prepared = prepare_content(study(friction=frictions(10**6)))
    assert prepared.price.cell == pytest.approx(MARGIN * 1e-6 * repeat_after)
    assert prepared.price.start == pytest.approx(MARGIN * CALL, rel=1e-6)
    asked = len(motions.asked)
    assert prepared.seconds_a_cell == prepared.price.cell  # parts have the price of the whole
    assert len(motions.asked) == asked
