"""Settings of all tests."""

import gc
import os
from collections.abc import Generator

import pytest

pytest.register_assert_rewrite("ledger_laws")

# `scripts/test` has compiled everything: services that tests start need not look.
os.environ.setdefault("VIBRAFEED_WARM_AT_START", "false")


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


@pytest.fixture
def anyio_backend() -> str:
    """Run tests that are coroutines by asyncio, as the service does."""
    return "asyncio"
