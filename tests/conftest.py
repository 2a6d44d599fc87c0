"""Marks by place and by measured duration."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
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


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests by place and duration, leave out the night's, begin with the longest files."""
    whole: dict[Path, float] = {}
    for item in items:
        seconds = DURATIONS.get(name_of(item.nodeid), 0.0)
        whole.setdefault(item.path, 0.0)
        if item.path.relative_to(HERE).parts[0] in ("service", "browser", "packaging"):
            item.add_marker(pytest.mark.service)
        if seconds >= SLOW:
            item.add_marker(pytest.mark.slow)
    for name, seconds in DURATIONS.items():
        path = HERE / name.partition("::")[0]
        if path in whole:
            whole[path] += seconds
    if not NIGHT:
        left = [item for item in items if item.get_closest_marker("night")]
        config.hook.pytest_deselected(items=left)
        items[:] = [item for item in items if not item.get_closest_marker("night")]
    items.sort(key=lambda item: -whole[item.path])


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
