"""Kernels that call kernels: machine code is made once an entry, and it is that of the text."""

import gc
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.codegen import CPUCodeLibrary

from vibrafeed.core import compiled as compiled_module
from vibrafeed.core.compiled import borrowing, by_type, compiled
from waiting import wait_for


class Line(NamedTuple):
    """A straight line."""

    slope: float


class Bow(NamedTuple):
    """A parabola."""

    bend: float
    slope: float


@compiled
def of_line(curve, x):
    return curve.slope * x


@compiled
def of_bow(curve, x):
    return (curve.bend * x + curve.slope) * x


@by_type("curve", {Line: of_line, Bow: of_bow})
def height(curve, x):
    """Return the height of a curve."""
    raise NotImplementedError


def calling(inner):
    @compiled
    def link(x):
        return inner(x) - 0.5 * inner(0.25 * x)

    return link


def chain():
    """Return functions each of which calls the one before it twice, and the same in Python."""

    @compiled
    def first(x):
        return math.sin(x) + 1e-3 * x

    calls, plain = [first], [first.py_func]
    for _ in range(5):
        calls.append(calling(calls[-1]))
        plain.append(calling(plain[-1]).py_func)
    return calls, plain


@pytest.fixture
def optimised(monkeypatch) -> list[str]:
    """Return the names of the libraries that are optimised from now on."""
    names: list[str] = []
    plain = CPUCodeLibrary._optimize_final_module

    def counted(library):
        names.append(library.name)
        return plain(library)

    monkeypatch.setattr(CPUCodeLibrary, "_optimize_final_module", counted)
    return names


def test_what_is_called_is_optimised_with_its_caller_only(optimised):
    calls, plain = chain()
    assert calls[-1](0.7) == plain[-1](0.7)
    assert len([name for name in optimised if "link" in name or "first" in name]) == 1
    assert calls[2](0.7) == plain[2](0.7), "an entry, too, once Python calls it"
    assert len([name for name in optimised if "link" in name or "first" in name]) == 2


def test_a_type_chooses_what_is_called():
    @compiled
    def both(line, bow, x):
        return height(line, x), height(bow, x)

    assert both(Line(2.0), Bow(3.0, 1.0), 2.0) == (4.0, 14.0)
    with pytest.raises(NotImplementedError):
        height(Line(2.0), 2.0)


def test_a_part_may_raise_allocate_and_change_an_array_in_place():
    @borrowing
    def add(row, x):
        if x < 0:
            raise ValueError("below 0")
        for place in range(row.size):
            row[place] += x

    @compiled
    def added_twice(x):
        row = np.zeros(3)
        add(row, x)
        add(row, x)
        return row

    @compiled
    def total(x):
        return added_twice(x).sum()

    assert added_twice(1.5).tolist() == [3.0] * 3
    assert total(1.5) == total(1.5) == 9.0, "an entry may be called by what is compiled later"
    assert total(2) == 12
    with pytest.raises(ValueError, match="below 0"):
        total(-1.0)


def test_garbage_is_collected_again_after_compiling(monkeypatch: pytest.MonkeyPatch):
    """dask keeps for good what `gc.isenabled()` says when another thread imports it."""
    seen = []
    compile_extra = compiled_module.compile_extra

    def watching(*arguments):
        seen.append((gc.isenabled(), gc.get_threshold()[0]))
        return compile_extra(*arguments)

    monkeypatch.setattr(compiled_module, "compile_extra", watching)
    calls, plain = chain()
    with ThreadPoolExecutor(4) as pool:  # threads may ask for the same function at once
        found = list(pool.map(calls[-1], [0.1 * k for k in range(16)]))
    assert found == [plain[-1](0.1 * k) for k in range(16)]
    assert set(seen) == {(True, 0)}
    wait_for(lambda: gc.get_threshold()[0] > 0)  # a thread of an earlier test may be compiling
