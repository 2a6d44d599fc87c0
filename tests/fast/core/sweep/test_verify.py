"""Cells evaluated again: `verify` tells the truth, sees what is wrong, and can be stopped."""

import importlib
import math
from dataclasses import replace
from functools import wraps

import mpmath
import numpy as np
import pytest

from refusals import places_of
from verified_studies import BEST, BOUND, DRIVE, MOTION, PAIR, STUDIES, SWEEP, number, told
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, is_whole, tabulate
from vibrafeed.core.motion.systems import METHODS
from vibrafeed.core.optimise.methods import METHODS as OPTIMISERS
from vibrafeed.core.plan.labels import chosen_positions
from vibrafeed.core.plan.pieces import Computed, Cut, join
from vibrafeed.core.watch import Watch

motion_prepare = importlib.import_module("vibrafeed.core.motion.prepare")  # a function has its name


def test_an_ill_conditioned_cell_is_told_with_its_condition():
    # All four cells are taken. The worst is found among them by a direct computation.
    words, content = told(SWEEP), {**SWEEP, "outputs": ["normal_acceleration"]}
    assert words["verified_cells"] == 4
    assert words["verified_against"] == "the same equations in extended precision"
    found = tabulate(prepare_content(content)).variables["normal_acceleration"].values
    cells = {}
    with mpmath.workdps(50):
        for (i, k), got in np.ndenumerate(found):
            amplitude, beta = (1e-4, DRIVE)[i], (10, 30)[k]
            turn = mpmath.mpf(float(np.deg2rad(float(beta))))
            p = mpmath.mpf(amplitude) * (2 * mpmath.mpf(math.pi) * 50) ** 2
            g = mpmath.mpf(9.81)
            value = g - p * mpmath.sin(turn)
            moved = g + 3 * p * mpmath.sin(turn) + p * mpmath.cos(turn) * turn
            ulps = float(abs(mpmath.mpf(float(got)) - value)) / math.ulp(float(value))
            place = f"amplitude {amplitude:.12g} m, beta {beta} degree"
            cells[place] = (ulps / float(max(moved / abs(value), 1)), ulps)
    worst = max(cells, key=cells.get)
    only = told(content)["verified_worst"]
    assert worst in only
    share = number(r"([\d.e+-]+) ulp over the condition", only)
    assert share == pytest.approx(cells[worst][0], rel=0.05)
    assert number(r"([\d.e+-]+) ulp,", only) == pytest.approx(cells[worst][1], rel=0.01)
    assert ulps > 1e6  # a difference that cancels nine digits ...
    assert cells[worst][0] < BOUND  # ... is no fault of the equations
    assert f"within the bound of {BOUND}" in only


def test_values_that_are_all_exact_are_told_with_no_error():
    still = {**SWEEP["parameters"], "amplitude": 0.0}
    words = told({**SWEEP, "outputs": ["normal_acceleration"], "parameters": still, "verify": 2})
    assert "normal_acceleration at beta 10 degree: error 0 m s-2, 0 ulp" in words["verified_worst"]


def in_short_floats(function):
    return lambda **given: np.float32(function(**given)).astype(np.float64)


def careless(function):
    """(1e9 + x) - 1e9 keeps seven digits of x."""
    return lambda **given: (1e9 + function(**given)) - 1e9


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
    short, wrong = (with_equation(SWEEP, "throw_number", f) for f in (in_short_floats, careless))
    lost = told_of(short, prepare_content(SWEEP))
    for words in (lost, told_of(wrong, wrong)):  # right in digits and wrong in floats
        assert words.startswith("throw_number at")
        assert "BEYOND the bound" in words
    # Half a unit in the last place of a short float is 2**28 of a long one at most.
    assert 2**20 < number(r"([\d.e+-]+) ulp,", lost) <= 2**28


def times(factor):
    return lambda function: lambda **given: factor * function(**given)


def test_motions_are_followed_by_the_reference():
    words = told(MOTION)
    assert (words["verified_against"], words["verified_cells"]) == ("the method reference", 3)
    share = number(r", ([\d.e+-]+) of its largest", words["verified_worst"])
    assert share < 1e-8  # two exact methods; the reference states ten digits
    wrong = with_equation(
        MOTION, "conveying_velocity", lambda f: lambda **given: 1.001 * f(**given)
    )
    slow = told_of(wrong, prepare_content(MOTION))
    assert slow.startswith("conveying_velocity at")
    # A thousandth of the largest velocity, if that is the worst; no cell is off by more.
    assert number(r", ([\d.e+-]+) of its largest", slow) == pytest.approx(1e-3, rel=0.01)


FEW = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}


@pytest.mark.parametrize(
    ("more", "method", "by"),
    [({}, "reference", "the method events"), ({"alpha": 10}, "events", "the method reference")],
)
def test_the_other_method_can_follow_the_motion(more, method, by):
    content = {**MOTION, "verify": 1, "parameters": {**FEW, **more}, "method": method}
    assert told(content)["verified_against"] == by


WILD = {
    **MOTION,
    "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50, "amplitude": ["0.9 mm"], "beta": 40, "friction": 0.4, "restitution": 0.9,
    },
}  # fmt: skip


def test_motions_that_do_not_repeat_are_judged_by_their_means():
    # Thrown high with restitution: hardly a cell repeats.
    words = told(WILD)
    assert words["verified_cells"] == 1
    assert "verified_not_judged" not in words
    text = words["verified_worst"]
    assert text.startswith("1 do not repeat by both, and their mean velocities differ by")
    assert number(r"differ by ([\d.e+-]+) of both stated errors", text) < 1
    # A mean that is told far from its own, with an error that does not say so, is seen.
    wrong = with_equation(WILD, "conveying_velocity", times(9.0))
    seen = told_of(wrong, prepare_content({**WILD, "outputs": [*wrong.plan.outputs]}))
    assert "1 are further apart than both methods state: NOT VERIFIED" in seen


def test_what_cannot_be_judged_is_told_and_why():
    # Nearly no friction: the part nears its speed for longer than anybody looks.
    parameters = {**FEW, "amplitude": "0.25 mm", "friction": [1e-4, 0.1]}
    slow = {
        "outputs": ["conveying_velocity"],
        "max_periods": 100,
        "verify": 2,
        "method": "reference",
    }
    words = told({**MOTION, **slow, "parameters": parameters})
    assert (words["verified_cells"], words["verified_not_judged"]) == (1, 1)
    assert words["verified_worst"].endswith("1 could not be judged: 1 limit_reached")


def test_answers_are_set_against_extended_precision_and_another_method():
    words = told(BEST)
    assert words["verified_cells"] == 3
    assert "extended precision and answers of the method search" in words["verified_against"]
    assert "within the bound" in words["verified_worst"]
    prepared, kind = prepare_content(BEST), KINDS["optimise"]
    computed = kind.compute(prepared, Watch())
    # An answer told to be a tenth worse than it is: the rival finds that tenth.
    objective = computed.arrays["objective"]
    worse = Computed({**computed.arrays, "objective": 0.9 * objective}, computed.notes)
    text = kind.label(prepared, worse, Watch()).attributes["verified_worst"]
    places, _ = chosen_positions(prepared)
    tenth = float(0.1 * objective[places["friction"]].max())
    assert number(r"search finds ([\d.e+-]+) m s-2 more", text) == pytest.approx(tenth, rel=0.03)


def test_a_front_and_a_motion_have_their_verification():
    words = told({**BEST, "criterion": {"kind": "pareto", "points": 3}, "verify": 3})
    assert "front " in words["verified_worst"]
    assert "extended precision" in words["verified_against"]
    words = told({
        "kind": "optimise", "scene": "rectangle-on-plane", "verify": 1,
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": 10, "upper": 60}},
        "parameters": {"frequency": 50, "amplitude": "0.2 mm", "friction": 0.4},
    })  # fmt: skip
    assert words["verified_against"] == "the motion by the method reference"
    assert number(r", ([\d.e+-]+) of its largest", words["verified_worst"]) < 1e-8


@pytest.mark.parametrize("kind", STUDIES)
def test_pieces_tell_the_same(kind):
    prepared = prepare_content(STUDIES[kind])
    cut = Cut(prepared, 2)
    boxes = [cut.box(index) for index in range(len(cut))]
    assert len(boxes) > 1
    parts = ((box, KINDS[kind].compute(prepared.within(box), Watch())) for box in boxes)
    table = KINDS[kind].label(prepared, join(prepared, parts), Watch())
    assert table.attributes == tabulate(prepared).attributes
    assert table.attributes["verified_cells"] == STUDIES[kind]["verify"]


STATED = {**MOTION, "outputs": ["conveying_velocity", "conveying_velocity_error"]}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (SWEEP, f"rounding: at most {BOUND} ulp times"),
        (PAIR, "rounding of 64-bit floats"),
        (MOTION, "if asked for"),
        (STATED, "states it for each cell"),
        (BEST, "optimum_gap"),
    ],
)
def test_every_result_tells_its_error(content, words):
    plain = {name: value for name, value in content.items() if name != "verify"}
    table = tabulate(prepare_content(plain))
    assert not any(name.startswith("verified") for name in table.attributes)
    assert words in table.attributes["accuracy"]
    if content is BEST:
        assert table.attributes["evaluations"] == table.variables["evaluations"].values.sum()


def test_the_cells_are_different_and_the_same_each_time():
    (places, count), (again, _) = (
        chosen_positions(prepare_content({**MOTION, "verify": 12})) for _ in range(2)
    )
    assert count == 12
    assert len(set(zip(*(place.tolist() for place in places.values()), strict=True))) == 12
    assert all(np.array_equal(places[name], again[name]) for name in places)
    huge = {**SWEEP["parameters"], "amplitude": {"start": 1e-5, "stop": 1e-4, "num": 10**8}}
    places, count = chosen_positions(prepare_content({**SWEEP, "parameters": huge, "verify": 7}))
    assert count == 7
    assert places["amplitude"].max() > 10**7


@pytest.mark.parametrize(
    ("kind", "wrong"),
    [*((kind, 0) for kind in STUDIES), *(("sweep", n) for n in (10_001, 1.5, True))],
)
def test_a_wrong_number_is_refused_with_its_place(kind, wrong):
    assert places_of(prepare_content, {**STUDIES[kind], "verify": wrong}) == ["verify"]


def test_what_would_take_too_long_is_refused():
    long = {**MOTION["parameters"], "amplitude": {"start": 1e-4, "stop": 2e-4, "num": 100_000}}
    with pytest.raises(StudyError, match=r"takes too long: about 0\.\d+ s per cell") as refusal:
        prepare_content({**MOTION, "parameters": long, "verify": 10_000})
    most = int(
        refusal.value.problems[0].fix.removeprefix("Set verify to at most ").replace(",", "")
    )
    prepared = prepare_content({**MOTION, "parameters": long, "verify": most})
    assert prepared.seconds_to_verify == pytest.approx(100.0, rel=1 / most)
    few = prepare_content({**MOTION, "verify": 500})
    assert few.seconds_to_verify == 16 * few.seconds_a_verified_cell  # it has 16 cells


def test_a_motion_without_another_method_is_refused(monkeypatch):
    # The reference does not take so much friction.
    with pytest.raises(StudyError, match="no other method"):
        prepare_content({**MOTION, "parameters": {**FEW, "friction": 2000}})
    alone = {name: replace(one, checked_by=()) for name, one in METHODS["conveying"].items()}
    monkeypatch.setattr(motion_prepare, "methods_of", lambda scene: alone)
    with pytest.raises(StudyError, match="no other method"):
        prepare_content(MOTION)


def test_a_rim_on_a_side_is_found_to_the_last_digits():
    # The search for the nearest place of the rim once ended some 1e-12 beside it: a Newton step
    # that rounding put on its bracket was taken for one that left it.
    words = told({
        "kind": "sweep", "scene": "cylinder-pair-impact", "outputs": ["impulse_normal"],
        "verify": 1,
        "parameters": {
            "position_x_1": "14.6 mm", "position_y_1": "5.4 mm", "position_z_1": "19 mm",
            "azimuth_1": "82.1 deg", "elevation_1": "54.6 deg", "velocity_x_1": "0.2 m/s",
            "velocity_z_1": "-0.3 m/s", "diameter_1": "8 mm", "length_1": "30 mm", "mass_1": "5 g",
            "diameter_2": "8 mm", "length_2": "40 mm", "mass_2": "8 g", "restitution": 0.5,
            "contact_tolerance": 1,
        },
    })["verified_worst"]  # fmt: skip
    assert words.startswith("impulse_normal")
    assert number(r"([\d.e+-]+) ulp over the condition", words) < BOUND


def labelled(content, stop, progress=None):
    """Return the attributes of a study whose verifying is stopped, and of computing is not."""
    prepared = prepare_content(content)
    kind = KINDS[prepared.study.kind]
    computed = kind.compute(prepared, Watch())
    return kind.label(prepared, computed, Watch(progress, stop)).attributes


@pytest.mark.parametrize("kind", STUDIES)
def test_no_time_is_spent_after_the_deadline(kind, monkeypatch):
    def never(*arguments, **more):
        raise AssertionError("it was stopped")

    # What verifies is not reached: the words are no claim about a single cell.
    monkeypatch.setattr("vibrafeed.core.sweep.verify.outputs_in", never)
    monkeypatch.setattr("vibrafeed.core.motion.simulate.compare", never)
    rivals = {name: replace(method, solve=never) for name, method in OPTIMISERS.items()}
    monkeypatch.setattr("vibrafeed.core.optimise.check.METHODS", rivals)
    prepared, done = prepare_content(STUDIES[kind]), []
    computed = prepared.computing_share * (1 - 1e-9)
    table = tabulate(prepared, Watch(done.append, lambda: sum(done) > computed))
    asked, told = STUDIES[kind]["verify"], table.attributes
    assert (told["verified_cells"], told["verified_left_out"]) == (0, asked)
    assert told["verified_worst"] == f"stopped before {asked} of {asked} cells could be verified"
    assert np.isfinite(table.variables[next(iter(table.variables))].values).all()
    assert not is_whole(table)


def test_following_again_stops_between_cells():
    done = []  # a cell looks often, so that the looks of one are not known
    told = labelled(MOTION, lambda: bool(done), progress=done.append)
    assert (told["verified_cells"], told["verified_left_out"]) == (1, 2)
    assert "; 1 repeat, rest or settle" in told["verified_worst"]
    assert told["verified_worst"].endswith("; stopped before 2 of 3 cells could be verified")
    for content, noes in ((MOTION, 1), (BEST, 0)):
        none = labelled(content, after(noes))
        assert none["verified_worst"].startswith("stopped before 3 of 3 cells")


@pytest.mark.parametrize(("looks", "cells"), [(0, 0), (4, 0), (5, 20)])
def test_extended_precision_stops_between_parameters(looks, cells):
    # Looks: before the outputs, and before the differences by each of four parameters.
    many = {**SWEEP["parameters"], "amplitude": {"start": 1e-5, "stop": 1e-4, "num": 10}}
    told = labelled({**SWEEP, "parameters": many, "verify": 20}, after(looks))
    assert (told["verified_cells"], told.get("verified_left_out", 0)) == (cells, 20 - cells)
    assert ("stopped before" in told["verified_worst"]) == (cells < 20)
    assert ("ulp" in told["verified_worst"]) == (cells > 0)


def test_answers_stop_between_the_two_ways():
    done = []
    told = labelled(BEST, lambda: sum(done) >= 0.5, progress=done.append)
    # The outputs are judged, no answer is: no cell is verified, and the rival claims nothing.
    assert (told["verified_cells"], told["verified_left_out"]) == (0, 3)
    assert "within the bound" in told["verified_worst"]
    assert "finds" not in told["verified_worst"]


@pytest.mark.parametrize(
    ("content", "status", "left"), [(MOTION, "motion_status", 0), (BEST, "optimum_status", 8)]
)
def test_cells_that_were_not_computed_are_not_verified(content, status, left):
    prepared = prepare_content(content)
    kind = KINDS[prepared.study.kind]
    computed = kind.compute(prepared, Watch())
    # Leave all of the chosen cells but the first as a stop does.
    places, _ = chosen_positions(prepared)
    place = tuple(places[name][1:] for name in prepared.dims[status])
    arrays = {name: values.copy() for name, values in computed.arrays.items()}
    for values in arrays.values():
        if values.dtype == np.float64 and values.shape == arrays[status].shape:
            values[place] = np.nan
    arrays[status][place] = left
    told = kind.label(prepared, Computed(arrays, computed.notes), Watch()).attributes
    assert (told["verified_cells"], told["verified_left_out"]) == (1, 2)
    assert told["verified_worst"].endswith("stopped before 2 of 3 cells could be verified")


@pytest.mark.parametrize("kind", STUDIES)
def test_verifying_has_its_share_of_the_progress(kind):
    prepared, done = prepare_content(STUDIES[kind]), []
    tabulate(prepared, Watch(done.append))
    assert sum(done) == pytest.approx(1)
    assert prepared.computing_share < 0.9  # these grids are small
    plain = {name: value for name, value in STUDIES[kind].items() if name != "verify"}
    assert prepare_content(plain).computing_share == 1


def after(noes):
    """Return a watch's stop that says no so many times, and yes from then on."""
    looks = iter([False] * noes)
    return lambda: next(looks, True)
