"""What systems do differently, in one module."""

from __future__ import annotations

import io
import os
import sys

import psutil
import pytest

from vibrafeed.core import system


def test_cores_are_those_of_this_process(monkeypatch):
    assert system.cores() == len(os.sched_getaffinity(0))
    monkeypatch.delattr(psutil.Process, "cpu_affinity")  # as on macOS
    assert system.cores() == os.cpu_count()


def test_priority_is_lowered_by_the_way_of_the_system(monkeypatch):
    said = []

    def nice(process, value=None):
        said.extend([] if value is None else [value])
        return 12

    monkeypatch.setattr(psutil.Process, "nice", nice)
    system.lower_priority(5)
    system.lower_priority(10)  # 19 is the end
    monkeypatch.setattr(psutil, "BELOW_NORMAL_PRIORITY_CLASS", 0x4000, raising=False)
    system.lower_priority(5)
    assert said == [17, 19, 0x4000]


@pytest.fixture
def held(monkeypatch, tmp_path):
    """Return a file and its new content, and a list of the waits till another program lets go."""
    source, target = tmp_path / "new", tmp_path / "result.CSV"
    source.write_text("new")
    target.write_text("old")
    waits: list[float] = []
    monkeypatch.setattr(system, "WINDOWS", True)
    monkeypatch.setattr(system.time, "sleep", waits.append)
    return source, target, waits


def test_a_file_that_is_held_for_a_moment_is_replaced(held, monkeypatch):
    source, target, waits = held
    plain = type(source).replace

    def replace(path, other):
        if len(waits) < 3:
            raise PermissionError(13, "Access is denied")
        plain(path, other)

    monkeypatch.setattr(type(source), "replace", replace)
    system.replace(source, target)
    assert target.read_text() == "new"
    assert len(waits) == 3


def test_a_sheet_that_stays_open_is_named_in_the_systems_words(held, monkeypatch):
    source, target, waits = held

    def replace(path, other):
        raise PermissionError(13, "Access is denied")

    monkeypatch.setattr(type(source), "replace", replace)
    with pytest.raises(PermissionError, match=r"Access is denied\. Close it in Excel"):
        system.replace(source, target)
    assert sum(waits) == pytest.approx(system.PATIENCE)
    monkeypatch.setattr(system, "WINDOWS", False)
    del waits[:]
    with pytest.raises(PermissionError):  # on POSIX systems it means that it is forbidden
        system.replace(source, target)
    assert waits == []


class Terminal(io.TextIOWrapper):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("kind", "written"), [(io.TextIOWrapper, "m/s²".encode()), (Terminal, b"m/s?")]
)
def test_every_character_can_be_written(kind, written, monkeypatch):
    stream = kind(io.BytesIO(), encoding="cp1251")
    monkeypatch.setattr(sys, "stdout", stream)
    monkeypatch.setattr(sys, "stderr", None)  # as of a program without a console
    system.write_utf8()
    stream.write("m/s²")
    stream.flush()
    assert stream.buffer.getvalue() == written
