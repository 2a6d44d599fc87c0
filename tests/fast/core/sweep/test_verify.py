"""Random cells evaluated again: `verify` tells the truth, and sees what is wrong."""

from __future__ import annotations

import importlib
import json
import math
from dataclasses import replace
from functools import wraps
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import xarray

from schemas import whole_schema
from verified_studies import BEST, BOUND, DRIVE, MOTION, PAIR, STUDIES, SWEEP, number, told
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.work import compute_block, write_result
from vibrafeed.core.code_version import code_version
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, tabulate
from vibrafeed.core.motion.systems import METHODS
from vibrafeed.core.plan.labels import chosen_positions
from vibrafeed.core.plan.pieces import Computed, Cut, carry_out, join
from vibrafeed.core.watch import Watch

motion_prepare = importlib.import_module("vibrafeed.core.motion.prepare")  # a function has its name


def test_an_ill_conditioned_cell_is_told_with_its_condition():
    # All four cells are taken. The worst is found among them by a direct computation.
    words = told(SWEEP)
    assert words["verified_cells"] == 4
    assert words["verified_against"] == "the same equations in extended precision"
    table = tabulate(prepare_content({**SWEEP, "outputs": ["normal_acceleration"]}))
    shares, ulps = {}, {}
    with mpmath.workdps(50):
        for i, amplitude in enumerate((1e-4, DRIVE)):
            for k, beta in enumerate((10, 30)):
                turn = mpmath.mpf(float(np.deg2rad(float(beta))))
                p = mpmath.mpf(amplitude) * (2 * mpmath.mpf(math.pi) * 50) ** 2
                g = mpmath.mpf(9.81)
                value = g - p * mpmath.sin(turn)
                moved = g + 3 * p * mpmath.sin(turn) + p * mpmath.cos(turn) * turn
                got = float(table.variables["normal_acceleration"].values[i, k])
                ulps[i, k] = float(abs(mpmath.mpf(got) - value)) / math.ulp(float(value))
                shares[i, k] = ulps[i, k] / float(max(moved / abs(value), 1))
    only = told({**SWEEP, "outputs": ["normal_acceleration"]})["verified_worst"]
    worst = max(shares, key=lambda place: shares[place])
    assert f"amplitude {(1e-4, DRIVE)[worst[0]]:.12g} m, beta {(10, 30)[worst[1]]} degree" in only
    assert number(r"([\d.e+-]+) ulp over the condition", only) == pytest.approx(
        shares[worst], rel=0.05
    )
    assert number(r"([\d.e+-]+) ulp,", only) == pytest.approx(ulps[worst], rel=0.01)
    assert ulps[1, 1] > 1e6  # a difference that cancels nine digits ...
    assert max(shares.values()) < BOUND  # ... is no fault of the equations
    assert f"within the bound of {BOUND}" in only


def with_equation(content, gives, change):
    """Return a study of which one equation is changed."""
    prepared = prepare_content(content)
    equations = tuple(
        replace(e, function=wraps(e.function)(change(e.function))) if e.gives == gives else e
        for e in prepared.plan.equations
    )
    return replace(prepared, plan=replace(prepared.plan, equations=equations))


def told_of(computing, verifying):
    """Return what is told if a changed study computes and another one verifies."""
    kind = KINDS[verifying.study.kind]
    return kind.label(verifying, kind.compute(computing, Watch()), Watch()).attributes[
        "verified_worst"
    ]


def test_a_digit_that_is_lost_is_seen():
    def in_short_floats(function):
        return lambda **given: np.float32(function(**given)).astype(np.float64)

    wrong = with_equation(SWEEP, "throw_number", in_short_floats)
    words = told_of(wrong, prepare_content(SWEEP))
    assert words.startswith("throw_number at")
    assert "BEYOND the bound" in words
    # Half a unit in the last place of a short float is 2**28 of a long one at most.
    assert 2**20 < number(r"([\d.e+-]+) ulp,", words) <= 2**28


def test_an_equation_that_is_right_in_digits_and_wrong_in_floats_is_seen():
    # (1e9 + x) - 1e9 keeps seven digits of x.
    def careless(function):
        return lambda **given: (1e9 + function(**given)) - 1e9

    wrong = with_equation(SWEEP, "throw_number", careless)
    words = told_of(wrong, wrong)
    assert words.startswith("throw_number at")
    assert "BEYOND the bound" in words


def test_motions_are_followed_by_the_reference():
    words = told(MOTION)
    assert words["verified_against"] == "the method reference"
    assert words["verified_cells"] == 3
    share = number(r", ([\d.e+-]+) of its largest", words["verified_worst"])
    assert share < 1e-8  # two exact methods; the reference states ten digits
    slow = told_of(
        with_equation(MOTION, "conveying_velocity", lambda f: lambda **given: 1.001 * f(**given)),
        prepare_content(MOTION),
    )
    assert slow.startswith("conveying_velocity at")
    # A thousandth of the largest velocity, if that is the worst; no cell is off by more.
    assert number(r", ([\d.e+-]+) of its largest", slow) == pytest.approx(1e-3, rel=0.01)


def test_the_other_method_can_follow_the_motion():
    def by(**more):
        return told({**MOTION, "verify": 1, **more})["verified_against"]

    few = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
    assert by(parameters=few, method="reference") == "the method events"
    aslant = {**few, "alpha": 10}
    assert by(parameters=aslant) == "the method reference"
    assert by(parameters=aslant, method="reference") == "the method events"
    # The reference does not take so much friction.
    with pytest.raises(StudyError, match="no other method"):
        by(parameters={**few, "friction": 2000})


WILD = {
    **MOTION,
    "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50, "amplitude": ["0.9 mm"], "beta": 40, "friction": 0.4, "restitution": 0.9,
    },
}  # fmt: skip


def test_motions_that_do_not_repeat_are_judged_by_their_means():
    # Thrown high with restitution: hardly a cell repeats.
    table = tabulate(prepare_content(WILD))
    assert table.variables["regime"].values.size == 1
    assert table.attributes["verified_cells"] == 1
    text = table.attributes["verified_worst"]
    assert text.startswith("1 do not repeat by both, and their mean velocities differ by")
    assert number(r"differ by ([\d.e+-]+) of both stated errors", text) < 1
    assert "verified_not_judged" not in table.attributes
    # A mean that is told far from its own, with an error that does not say so, is seen.
    wrong = with_equation(WILD, "conveying_velocity", lambda f: lambda **given: 9.0 * f(**given))
    seen = told_of(wrong, prepare_content({**WILD, "outputs": [*wrong.plan.outputs]}))
    assert "1 are further apart than both methods state: NOT VERIFIED" in seen


def test_what_cannot_be_judged_is_told_and_why():
    # Nearly no friction: the part nears its speed for longer than anybody looks.
    slow = {
        **MOTION,
        "method": "reference",
        "outputs": ["conveying_velocity"],
        "parameters": {
            "frequency": 50,
            "amplitude": "0.25 mm",
            "beta": 30,
            "friction": [1e-4, 0.1],
        },
        "max_periods": 100,
        "verify": 2,
    }
    words = told(slow)
    assert (words["verified_cells"], words["verified_not_judged"]) == (1, 1)
    assert words["verified_worst"].endswith("1 could not be judged: 1 limit_reached")


def test_answers_are_set_against_extended_precision_and_another_method():
    words = told(BEST)
    assert words["verified_cells"] == 3
    assert "extended precision and answers of the method search" in words["verified_against"]
    assert "within the bound" in words["verified_worst"]
    prepared = prepare_content(BEST)
    kind = KINDS["optimise"]
    computed = kind.compute(prepared, Watch())
    # An answer told to be a tenth worse than it is: the rival finds that tenth.
    objective = computed.arrays["objective"]
    worse = Computed({**computed.arrays, "objective": 0.9 * objective}, computed.notes)
    text = kind.label(prepared, worse, Watch()).attributes["verified_worst"]
    places, _ = chosen_positions(prepared)
    tenth = float(0.1 * objective[places["friction"]].max())
    assert number(r"search finds ([\d.e+-]+) m s-2 more", text) == pytest.approx(tenth, rel=0.03)


def test_a_front_and_a_motion_have_their_verification():
    pareto = {"kind": "pareto", "points": 5}
    words = told({**BEST, "criterion": pareto, "verify": 6})
    assert "front " in words["verified_worst"]
    assert "extended precision" in words["verified_against"]
    moving = {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": 10, "upper": 60}},
        "parameters": {"frequency": 50, "amplitude": "0.2 mm", "friction": 0.4},
        "verify": 1,
    }
    words = told(moving)
    assert words["verified_against"] == "the motion by the method reference"
    assert number(r", ([\d.e+-]+) of its largest", words["verified_worst"]) < 1e-8


@pytest.mark.parametrize("kind", STUDIES)
def test_pieces_tell_the_same(kind):
    prepared = prepare_content(STUDIES[kind])
    cut = Cut(prepared, 2)
    assert len(cut) > 1
    boxes = [cut.box(index) for index in range(len(cut))]
    parts = ((box, KINDS[kind].compute(prepared.within(box), Watch())) for box in boxes)
    table = KINDS[kind].label(prepared, join(prepared, parts), Watch())
    assert table.attributes == tabulate(prepared).attributes
    assert table.attributes["verified_cells"] == STUDIES[kind]["verify"]


def test_a_bound_is_named_only_where_there_is_one():
    table = tabulate(prepare_content({**PAIR, "verify": 1}))
    assert "bound" not in table.attributes["verified_worst"]
    assert "ulp over the condition number" in table.attributes["verified_worst"]
    assert "at most" not in table.attributes["accuracy"]


def test_every_result_tells_its_error():
    def accuracy(content):
        plain = {name: value for name, value in content.items() if name != "verify"}
        attributes = tabulate(prepare_content(plain)).attributes
        assert not any(name.startswith("verified") for name in attributes)
        return attributes["accuracy"]

    assert accuracy(SWEEP).startswith(f"rounding: at most {BOUND} ulp times")
    assert "if asked for" in accuracy(MOTION)
    stated = {**MOTION, "outputs": ["conveying_velocity", "conveying_velocity_error"]}
    assert accuracy(stated).endswith("states it for each cell")
    assert accuracy(BEST).startswith("optimum_gap")
    table = tabulate(prepare_content(BEST))
    each = table.variables["evaluations"].values
    assert table.attributes["evaluations"] == each.sum()


def test_the_cells_are_different_and_the_same_each_time():
    prepared = prepare_content({**MOTION, "verify": 12})
    places, count = chosen_positions(prepared)
    again, _ = chosen_positions(prepare_content({**MOTION, "verify": 12}))
    assert count == 12
    assert len(set(zip(*(place.tolist() for place in places.values()), strict=True))) == 12
    assert all(np.array_equal(places[name], again[name]) for name in places)
    huge = {**SWEEP["parameters"], "amplitude": {"start": 1e-5, "stop": 1e-4, "num": 10**8}}
    places, count = chosen_positions(prepare_content({**SWEEP, "parameters": huge, "verify": 7}))
    assert count == 7
    assert places["amplitude"].max() > 10**7


@pytest.mark.parametrize("wrong", [0, 10_001, 1.5, "many", True])
@pytest.mark.parametrize("kind", STUDIES)
def test_a_wrong_number_is_refused_with_its_place(kind, wrong):
    with pytest.raises(StudyError) as refusal:
        prepare_content({**STUDIES[kind], "verify": wrong})
    assert [problem.place for problem in refusal.value.problems] == ["verify"]


def test_what_would_take_too_long_is_refused():
    long = {**MOTION["parameters"], "amplitude": {"start": 1e-4, "stop": 2e-4, "num": 100_000}}
    with pytest.raises(StudyError, match=r"reference takes some 0\.\d+ s a cell") as refusal:
        prepare_content({**MOTION, "parameters": long, "verify": 10_000})
    most = int(refusal.value.problems[0].fix.removeprefix("Give at most ").replace(",", ""))
    prepared = prepare_content({**MOTION, "parameters": long, "verify": most})
    assert prepared.seconds_to_verify == pytest.approx(100.0, rel=1 / most)
    few = prepare_content({**MOTION, "verify": 500})
    assert few.seconds_to_verify == 16 * few.seconds_a_verified_cell  # it has 16 cells


def test_the_schema_has_it(tmp_path_factory):
    known = json.dumps(whole_schema(tmp_path_factory))
    assert known.count('"verify": {') == len(KINDS)


def test_a_motion_without_another_method_is_refused(monkeypatch):
    alone = {name: replace(one, checked_by=()) for name, one in METHODS["conveying"].items()}
    monkeypatch.setattr(motion_prepare, "methods_of", lambda scene: alone)
    with pytest.raises(StudyError, match="no other method"):
        prepare_content(MOTION)


def test_a_job_writes_what_verifying_found(tmp_path):
    prepared = prepare_content(SWEEP)
    store = Store(tmp_path)
    key, _ = store.add(prepared.study)
    for index in range(len(Cut(prepared, 2))):
        compute_block(str(tmp_path), key, "sweep", 2, index, code_version())
    write_result(str(tmp_path), key, "sweep", 2, 0.0)
    with xarray.open_dataset(store.folder(key) / "result.nc", engine="netcdf4") as dataset:
        for name, value in told(SWEEP).items():
            assert dataset.attrs[name] == value
        assert dataset.attrs["accuracy"].startswith("rounding")


def test_the_price_is_that_of_computing_alone(monkeypatch):
    now = 0.0
    monkeypatch.setattr(
        "vibrafeed.core.plan.pieces.time", SimpleNamespace(perf_counter=lambda: now)
    )

    def taking(seconds, work):
        def works(*arguments):
            nonlocal now
            now += seconds
            return work(*arguments)

        return works

    kind = KINDS["sweep"]
    table = carry_out(prepare_content(SWEEP), taking(2, kind.compute), taking(100, kind.label))
    assert table.price["elapsed_seconds"] == 2  # verifying is a part of the labels


def test_a_rim_on_a_side_is_found_to_the_last_digits():
    # The search for the nearest place of the rim once ended some 1e-12 beside it: a Newton step
    # that rounding put on its bracket was taken for one that left it.
    words = told(
        {
            "kind": "sweep",
            "scene": "cylinder-pair-impact",
            "outputs": ["impulse_normal"],
            "parameters": {
                "position_x_1": "14.6 mm",
                "position_y_1": "5.4 mm",
                "position_z_1": "19 mm",
                "azimuth_1": "82.1 deg",
                "elevation_1": "54.6 deg",
                "velocity_x_1": "0.2 m/s",
                "velocity_z_1": "-0.3 m/s",
                "diameter_1": "8 mm",
                "length_1": "30 mm",
                "mass_1": "5 g",
                "diameter_2": "8 mm",
                "length_2": "40 mm",
                "mass_2": "8 g",
                "restitution": 0.5,
                "contact_tolerance": 1,
            },
            "verify": 1,
        }
    )["verified_worst"]
    assert words.startswith("impulse_normal")
    assert number(r"([\d.e+-]+) ulp over the condition", words) < BOUND
