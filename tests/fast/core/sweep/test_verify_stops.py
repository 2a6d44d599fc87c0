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

simulate = importlib.import_module("vibrafeed.core.motion.simulate")  # a function has its name


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
    ("content", "status", "left", "runs"),
    [(MOTION, "motion_status", 0, [1, 1]), (BEST, "optimum_status", 8, [])],
)
def test_cells_that_were_not_computed_are_not_verified(content, status, left, runs, monkeypatch):
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
    run, followed = simulate.run_equations, []

    def counted(plan, cells, watch):
        followed.append(max(values.size for values in cells.values()))
        return run(plan, cells, watch)

    monkeypatch.setattr(simulate, "run_equations", counted)
    told = kind.label(prepared, Computed(arrays, computed.notes), Watch()).attributes
    assert followed == runs  # by the other method, and by its own for the error that it states
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
