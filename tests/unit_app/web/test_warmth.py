"""Kernels compiled beside the service: what is logged where that fails."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path

from vibrafeed.app.web.warmth import Warmth


def test_kernels_are_compiled_in_a_process_of_the_pool():
    async def pool(function, processes):
        assert (function.__name__, processes) == ("compile_kernels", 1)
        return Path("cache")

    warmth = Warmth()
    assert not warmth.is_warm
    asyncio.run(warmth.compile(pool))
    assert warmth.is_warm


def test_the_log_says_why_kernels_could_not_be_compiled(caplog):
    async def pool(function, processes):
        raise OSError(28, "No space left on device")

    warmth = Warmth()
    with caplog.at_level(logging.WARNING, "vibrafeed"):
        asyncio.run(warmth.compile(pool))
    assert not warmth.is_warm
    assert "No space left on device" in caplog.text
