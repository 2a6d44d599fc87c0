"""What systems do differently, in one module."""

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


def test_a_file_that_is_held_is_replaced_once_it_is_let_go(monkeypatch, tmp_path):
    source, target = tmp_path / "new", tmp_path / "result.CSV"
    source.write_text("new")
    waits: list[float] = []
    plain = type(source).replace
    looks = 3

    def replace(path, other):
        if len(waits) < looks:
            raise PermissionError(13, "Access is denied")
        plain(path, other)

    monkeypatch.setattr(system, "WINDOWS", True)
    monkeypatch.setattr(system.time, "sleep", waits.append)
    monkeypatch.setattr(type(source), "replace", replace)
    system.replace(source, target)
    assert target.read_text() == "new"
    assert len(waits) == 3
    waits.clear()
    looks = 1e9  # a sheet that stays open is named in the system's words
    with pytest.raises(PermissionError, match=r"Access is denied\. Close it in Excel"):
        system.replace(source, target)
    assert sum(waits) == pytest.approx(system.PATIENCE)
    monkeypatch.setattr(system, "WINDOWS", False)
    waits.clear()
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
