"""Marks by place and by measured duration."""

from __future__ import annotations

import gc
import json
import os
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest

import postgres
from night import NIGHT
from tools import absent

# `scripts/test` has compiled everything: services that tests start need not look.
os.environ.setdefault("VIBRAFEED_WARM_AT_START", "false")

HERE = Path(__file__).parent
DURATIONS: dict[str, float] = json.loads((HERE / "durations.json").read_text())
"""Seconds of each test with all its cases, on a quiet machine; `scripts/durations` writes it."""
SLOW = 0.125  # s; `make quick` leaves out what takes as long

measured: dict[str, float] = {}


def name_of(node: str) -> str:
    """Return file and name of a test, without the case."""
    return node.removeprefix("tests/").partition("[")[0]


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while tests are collected: all that is imported and collected stays.

    To look through it again and again takes a third of the time of collecting, in each process.
    """
    thresholds = gc.get_threshold()
    gc.set_threshold(0)  # not gc.disable(), which dask takes for good if it is imported meanwhile
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(*thresholds)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests by place and duration, leave out the night's, begin with the longest files.

    In random order (`make night`) they stay as they come.
    """
    if not NIGHT:
        night = {item for item in items if item.get_closest_marker("night")}
        night |= set(cases_of_the_night([item for item in items if item not in night]))
        config.hook.pytest_deselected(items=[item for item in items if item in night])
        items[:] = [item for item in items if item not in night]
    whole: dict[Path, float] = dict.fromkeys((item.path for item in items), 0.0)
    for name, cases in by_name(items).items():
        seconds = DURATIONS.get(name, 0.0)
        whole[cases[0].path] += seconds
        for item in cases:
            if item.path.relative_to(HERE).parts[0] in ("service", "browser", "packaging"):
                item.add_marker(pytest.mark.service)
            if seconds >= SLOW:
                item.add_marker(pytest.mark.slow)
    if not config.pluginmanager.hasplugin("randomly"):
        items.sort(key=lambda item: -whole[item.path])


def by_name(items: list[pytest.Item]) -> dict[str, list[pytest.Item]]:
    """Group cases by their test."""
    groups: dict[str, list[pytest.Item]] = {}
    for item in items:
        groups.setdefault(name_of(item.nodeid), []).append(item)
    return groups


def cases_of_the_night(items: list[pytest.Item]) -> Iterator[pytest.Item]:
    """Yield what `by_day(n)` leaves to the night: all but n cases, evenly spread, of a test."""
    for cases in by_name(items).values():
        mark = cases[0].get_closest_marker("by_day")
        if mark:
            (day,) = mark.args
            kept = {round(k * len(cases) / day) for k in range(day)}
            yield from (item for k, item in enumerate(cases) if k not in kept)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Add up what each test took."""
    name = name_of(report.nodeid)
    measured[name] = measured.get(name, 0.0) + report.duration


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write what was measured, where it is asked for."""
    file = os.environ.get("VIBRAFEED_DURATIONS")
    if file and not hasattr(session.config, "workerinput"):
        worth = {name: round(took, 2) for name, took in measured.items() if took >= 0.05}
        worth |= {name: took for name, took in DURATIONS.items() if is_left_out(name)}
        Path(file).write_text(json.dumps(worth, indent=0, sort_keys=True) + "\n")


def is_left_out(name: str) -> bool:
    """True if a test is there and was not run, as those of the night."""
    file, *_, function = name.split("::")
    path = HERE / file
    return name not in measured and path.exists() and f"def {function}(" in path.read_text()


@pytest.fixture(scope="session")
def postgresql() -> Iterator[postgres.Postgres]:
    """Debian's PostgreSQL, on loopback; tests that stop it start it again."""
    programs = postgres.programs()
    if programs is None:
        absent("PostgreSQL is not installed")
    with postgres.running(programs) as server:
        yield server
