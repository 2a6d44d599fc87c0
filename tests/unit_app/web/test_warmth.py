"""Kernels compiled beside the service: what is logged where that fails."""

from __future__ import annotations

import asyncio
import logging
import sys

import pytest

from vibrafeed.app.web import warmth


@pytest.mark.parametrize(
    ("program", "why"),
    [
        ("#!/bin/sh\necho 'no space left on device' >&2\nexit 1\n", "no space left on device"),
        ("#!/bin/sh\nexit 3\n", "it ended with 3"),
        ("#!/bin/sh\nhead -c 100000 /dev/zero | tr '\\0' x >&2\necho end >&2\nexit 1\n", "xend"),
    ],
)
def test_the_log_says_why_kernels_could_not_be_compiled(
    program, why, tmp_path, monkeypatch, caplog
):
    python = tmp_path / "python"
    python.write_text(program)
    python.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(python))

    async def start() -> warmth.Warmth:
        warm = warmth.Warmth()
        warm.start()
        await warm._task
        return warm

    with caplog.at_level(logging.WARNING, "vibrafeed"):
        assert not asyncio.run(start()).is_warm
    (record,) = caplog.records
    assert record.getMessage().endswith(why)
    assert len(record.getMessage()) < 2_100
