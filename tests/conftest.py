"""Marks by place and by measured duration."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

import postgres
from tools import absent

# `scripts/test` has compiled everything: services that tests start need not look.
os.environ.setdefault("VIBRAFEED_WARM_AT_START", "false")

HERE = Path(__file__).parent
SLOW = frozenset((HERE / "slow.txt").read_text().split())
"""Tests that take an eighth of a second or more, as `scripts/slow` measured: file and name."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of the service, and the slow ones."""
    for item in items:
        place = item.path.relative_to(HERE)
        if place.parts[0] in ("service", "browser", "packaging"):
            item.add_marker(pytest.mark.service)
        name = item.nodeid.partition("::")[2].partition("[")[0]
        if f"{place.name}::{name}" in SLOW:
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def postgresql() -> Iterator[postgres.Postgres]:
    """Debian's PostgreSQL, on loopback; tests that stop it start it again."""
    programs = postgres.programs()
    if programs is None:
        absent("PostgreSQL is not installed")
    with postgres.running(programs) as server:
        yield server
