"""Tests that are coroutines run on asyncio."""

import pytest

pytest.register_assert_rewrite("ledger_laws")


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"
