"""Verifying stops when it is told to, has its share of the progress, and says what is left out."""

from __future__ import annotations

import importlib
from dataclasses import replace

import numpy as np
import pytest

from verified_studies import BEST, MOTION, STUDIES, SWEEP
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, is_whole, tabulate
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.plan.labels import chosen_positions
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.watch import Watch


class Countdown:
    """A watch's stop that says no so many times, and yes from then on."""

    def __init__(self, noes):
        self.left = noes

    def __call__(self):
        self.left -= 1
        return self.left < 0


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
    rivals = {name: replace(method, solve=never) for name, method in METHODS.items()}
    monkeypatch.setattr("vibrafeed.core.optimise.check.METHODS", rivals)
    prepared, done = prepare_content(STUDIES[kind]), []
    share = prepared.computing_share

    def late():
        return sum(done) > share * (1 - 1e-9)  # computing is over

    table = tabulate(prepared, Watch(done.append, late))
    asked = STUDIES[kind]["verify"]
    told = table.attributes
    assert told["verified_cells"] == 0
    assert told["verified_left_out"] == asked
    assert told["verified_worst"] == f"stopped before {asked} of {asked} cells could be verified"
    assert np.isfinite(table.variables[next(iter(table.variables))].values).all()
    assert not is_whole(table)


def test_following_again_stops_between_cells():
    done = []  # a cell looks often, so that the looks of one are not known
    told = labelled(MOTION, lambda: bool(done), progress=done.append)
    assert (told["verified_cells"], told["verified_left_out"]) == (1, 2)
    assert "; 1 repeat, rest or settle" in told["verified_worst"]
    assert told["verified_worst"].endswith("; stopped before 2 of 3 cells could be verified")
    assert labelled(MOTION, Countdown(1))["verified_worst"].startswith("stopped before 3 of 3")


@pytest.mark.parametrize(("looks", "cells"), [(0, 0), (2, 0), (4, 0), (5, 20)])
def test_extended_precision_stops_between_parameters(looks, cells):
    # Looks: before the outputs, and before the differences by each of four parameters.
    many = {**SWEEP["parameters"], "amplitude": {"start": 1e-5, "stop": 1e-4, "num": 10}}
    told = labelled({**SWEEP, "parameters": many, "verify": 20}, Countdown(looks))
    assert told["verified_cells"] == cells
    assert told.get("verified_left_out", 0) == 20 - cells
    assert ("stopped before" in told["verified_worst"]) == (cells < 20)
    assert ("ulp" in told["verified_worst"]) == (cells > 0)


def test_answers_stop_between_the_two_ways():
    prepared = prepare_content(BEST)
    kind, done = KINDS["optimise"], []
    computed = kind.compute(prepared, Watch())
    watch = Watch(done.append, lambda: sum(done) >= 0.5)
    told = kind.label(prepared, computed, watch).attributes
    # The outputs are judged, no answer is: no cell is verified, and the rival claims nothing.
    assert told["verified_cells"] == 0
    assert told["verified_left_out"] == 3
    assert "within the bound" in told["verified_worst"]
    assert "finds" not in told["verified_worst"]
    none = labelled(BEST, Countdown(0))
    assert none["verified_worst"] == "stopped before 3 of 3 cells could be verified"


@pytest.mark.parametrize(
    ("content", "status"), [(MOTION, "motion_status"), (BEST, "optimum_status")]
)
def test_cells_that_were_not_computed_are_not_verified(content, status, monkeypatch):
    prepared = prepare_content(content)
    places, _ = chosen_positions(prepared)
    place = tuple(places[name][1:] for name in prepared.dims[status])

    def without_two(arrays):
        """Leave all of the chosen cells but the first as a stop does."""
        changed = {name: values.copy() for name, values in arrays.items()}
        for values in changed.values():
            if values.dtype == np.float64 and values.shape == arrays[status].shape:
                values[place] = np.nan
        changed[status][place] = {"motion_status": 0, "optimum_status": 8}[status]
        return changed

    followed = []
    module = importlib.import_module("vibrafeed.core.motion.simulate")
    run = module.run_equations

    def counted(plan, cells, watch):
        followed.append(max(values.size for values in cells.values()))
        return run(plan, cells, watch)

    kind = KINDS[prepared.study.kind]
    computed = kind.compute(prepared, Watch())
    monkeypatch.setattr(module, "run_equations", counted)
    changed = Computed({**computed.arrays, **without_two(computed.arrays)}, computed.notes)
    told = kind.label(prepared, changed, Watch()).attributes
    # By the other method, and by its own for the error that it states.
    assert followed == ([1, 1] if content is MOTION else [])
    assert told["verified_cells"] == 1
    assert told["verified_left_out"] == 2
    assert told["verified_worst"].endswith("stopped before 2 of 3 cells could be verified")


def test_verifying_has_its_share_of_the_progress():
    for content in STUDIES.values():
        prepared, done = prepare_content(content), []
        tabulate(prepared, Watch(done.append))
        assert sum(done) == pytest.approx(1)
        assert prepared.computing_share < 0.9  # these grids are small
    assert Watch(done.append, threads=1).part(0.5).threads == 1
    plain = {name: value for name, value in SWEEP.items() if name != "verify"}
    assert prepare_content(plain).computing_share == 1
