"""A trial follows few cells, for a bounded time, and tells what all of them take."""

from dataclasses import dataclass, field

import numpy as np
import pytest

import vibrafeed.core.kernel_cache
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.in_common import Families, families_of
from vibrafeed.core.motion.trial import FIRST, LEAST, MOST, UNFINISHED, Trial, _Followed
from vibrafeed.core.plan.prepared import TRIED_FROM

CALL = 2e-3  # s of a call, besides its cells
LANDINGS, OWN = 9e-3, 1e-3  # s of a cell: what it has in common with others, and its own


@dataclass(frozen=True)
class Told(Trial):
    """A trial whose cells take what they are told to, of a clock of its own."""

    a_period: float = 1e-6  # s
    repeat_after: float = 100.0
    asked: list = field(default_factory=list)

    def _load(self):
        pass

    @property
    def _settings(self):
        return self.parameters

    def _follow(self, start, stop, periods, left, parameters=None):
        if parameters is not None:  # siblings: each family needs its landings once
            families = (stop - start) // self.families.each
            seconds = CALL + families * LANDINGS + (stop - start) * OWN
            return _Followed(seconds, ended=True, repeats=False)
        each = min(100.0 if periods is None else periods, self.repeat_after) * self.a_period
        seconds = CALL + each * (stop - start)
        self.asked.append((start, stop, periods, min(seconds, left)))
        repeats = self.repeat_after <= (periods or 100.0)
        return _Followed(min(seconds, left), seconds <= left, seconds <= left and repeats)


def trial(formula, count=256, **told):
    def price(periods):
        return np.full(count, formula * (100.0 if periods is None else periods) / 100.0)

    return Told(None, {"max_periods": 100.0}, np.zeros(count), price, **told)


@pytest.mark.parametrize("formula", [1e-6, 1e-4, 1e-3])
def test_the_price_by_formula_does_not_matter_where_cells_are_short(formula):
    """What a call takes is not what a cell takes."""
    told = trial(formula)
    assert told.seconds_a_cell(1e6) == pytest.approx(1e-4, rel=0.05)


@pytest.mark.parametrize("formula", [1e-7, 1e-3, 1.0])
@pytest.mark.parametrize("a_period", [1e-7, 1e-5, 1e-3, 1.0])
@pytest.mark.parametrize("cells", [1, 1000, 10**9])
def test_a_trial_is_bounded(formula, a_period, cells):
    told = trial(formula, count=min(cells, 256), a_period=a_period)
    each = told.seconds_a_cell(cells)
    assert 0 < each < np.inf
    assert sum(seconds for *_, seconds in told.asked) <= FIRST + 2 * MOST
    assert len(told.asked) < 12


def test_a_trial_takes_a_tenth_of_what_the_study_takes():
    told = trial(2e-3, a_period=2e-5)  # 2 ms a cell
    told.seconds_a_cell(300)
    assert sum(seconds for *_, seconds in told.asked) < 2 * 0.1 * 300 * 2e-3
    told = trial(1e-7)
    told.seconds_a_cell(10)
    assert sum(seconds for *_, seconds in told.asked) <= 2 * LEAST


def test_of_a_long_cell_some_periods_are_followed():
    told = trial(1.0, count=1, a_period=1e-3, repeat_after=8.0)
    assert told.seconds_a_cell(1) == pytest.approx(CALL + 8e-3)
    followed = [periods for _, _, periods, _ in told.asked]
    assert followed[0] == 1
    assert np.all(np.diff(followed) > 0)


def test_what_has_not_repeated_is_told_by_formula():
    told = trial(10.0, count=1, a_period=0.02)
    each = told.seconds_a_cell(1)
    assert 2.0 / UNFINISHED < each < 10.0  # in truth 2 s; by formula 10 s


def test_a_cell_that_is_longer_than_its_price_is_told_by_its_periods():
    told = trial(0.09, count=1, a_period=0.02)  # 2 s in truth
    each = told.seconds_a_cell(1)
    assert told.asked[0][2] is None
    assert 2.0 / 3 < each < 2.0 * 3


def test_one_period_of_a_long_cell_is_followed_to_its_end_and_tells_nothing_of_repeating():
    """Where formula and measured time of a period differ, the measured one counts."""
    told = trial(0.5, count=1, a_period=0.4)  # of 100 periods; 40 s in truth
    each = told.seconds_a_cell(1)
    assert [seconds for *_, seconds in told.asked] == [pytest.approx(CALL + 0.4)]
    assert 20.0 < each <= 100 * (CALL + 0.4)


def test_a_period_that_is_broken_off_counts_half_beside_the_formula():
    told = trial(0.5, count=1, a_period=2.0)
    assert told.seconds_a_cell(1) == pytest.approx((0.5 * 100 * FIRST) ** 0.5)
    assert [seconds for *_, seconds in told.asked] == [FIRST]


def test_cells_that_take_too_long_are_not_waited_for():
    told = trial(1e-3, a_period=1.0)  # a cell takes 100 s
    assert told.seconds_a_cell(1) > LEAST
    assert len(told.asked) < 4


@pytest.mark.parametrize("size", [2, 100])
def test_what_cells_have_in_common_counts_once(size):
    """Beside its siblings a cell takes its own time, and its part of the landings of all."""
    families = Families(256, size, {}, {}, min(size, 4))
    told = trial(1e-3, a_period=(LANDINGS + OWN) / 100.0, families=families)
    assert told.seconds_a_cell(1e6) == pytest.approx(LANDINGS / size + OWN, rel=0.1)


HOPS = {"frequency": 50, "amplitude": "2.1 mm", "beta": 41, "friction": 0.4, "restitution": 0.6}


def study(**more):
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "parameters": HOPS | more,
    }  # fmt: skip


def test_without_compiled_code_the_price_is_that_by_formula(monkeypatch):
    monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: not [*names])
    prepared = prepare_content(study())
    assert prepared.tried_seconds == prepared.seconds


def test_an_axis_that_no_motion_depends_on_makes_no_more_motions(monkeypatch):
    asked = []
    monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: True)

    def seconds(self, cells):
        asked.append(cells)
        return 1.0

    monkeypatch.setattr(Trial, "seconds_a_cell", seconds)
    axes = {"friction": {"start": 0.3, "stop": 0.5, "num": 5}, "length": [0.01, 0.02, 0.03]}
    content = study(**axes, part_gap=0.001) | {"outputs": ["feed_rate"]}
    prepared = prepare_content(content)
    assert prepared.cells == 15
    assert prepared.tried_seconds == pytest.approx(5.0)
    assert asked == [5]


def test_only_a_study_that_is_worth_it_is_tried(monkeypatch):
    monkeypatch.setattr(vibrafeed.core.kernel_cache, "are_kept", lambda names: True)
    monkeypatch.setattr(Trial, "seconds_a_cell", lambda self, cells: 1.0)
    short = prepare_content(study())
    assert short.stated_seconds == short.seconds < TRIED_FROM
    long = prepare_content(study(friction={"start": 0.3, "stop": 0.5, "num": 10_000_000}))
    assert long.seconds > TRIED_FROM
    assert long.stated_seconds == pytest.approx(1e7)


AXES = {
    "amplitude": {"start": "0.5 mm", "stop": "2.1 mm", "num": 5},
    "friction": {"start": 0.2, "stop": 0.6, "num": 9},
    "gamma": {"start": -2, "stop": 2, "num": 3},
    "restitution": {"start": 0.2, "stop": 0.6, "num": 3},
}


def test_a_sample_has_cells_of_every_motion_normal_to_the_floor_and_their_siblings():
    prepared = prepare_content(study(**AXES))
    found = families_of(prepared.plan, prepared.grid, Contacts(), 256)
    assert (found.count, found.size, found.each) == (45, 9, 4)
    normal = [name for name in AXES if name != "friction"]
    singles = np.array([found.singles[name] for name in normal])
    assert np.unique(singles, axis=1).shape == (3, 45)
    siblings = np.array([found.siblings[name] for name in normal])
    assert np.array_equal(siblings, np.repeat(singles, 4, axis=1))
    frictions = found.siblings["friction"].reshape(45, 4)
    assert all(np.unique(row).size == 4 for row in frictions)
    assert np.array_equal(frictions[:, 0], found.singles["friction"])


def test_where_no_cells_have_landings_in_common_there_are_no_families():
    alone = {name: values for name, values in AXES.items() if name != "friction"}
    prepared = prepare_content(study(**alone))
    assert families_of(prepared.plan, prepared.grid, Contacts(), 256) is None
    waves = {"amplitude_normal_1": "0.5 mm", "amplitude_along_2": "0.2 mm"}
    content = study(**waves, friction=AXES["friction"])
    del content["parameters"]["amplitude"], content["parameters"]["beta"]
    prepared = prepare_content(content)
    assert families_of(prepared.plan, prepared.grid, Contacts(), 256) is None
