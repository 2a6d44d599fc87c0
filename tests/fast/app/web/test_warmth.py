"""Kernels compiled beside the service: what is logged where that fails."""

from __future__ import annotations

import asyncio
import logging

import pytest

from vibrafeed.app.web import warmth


def no_folder(processes):
    assert processes == 1


def fails(processes):
    raise OSError(28, "No space left on device")


def compiles(processes):
    return "cache"


@pytest.mark.parametrize(
    ("function", "is_warm", "told"),
    [(compiles, True, ""), (no_folder, False, ""), (fails, False, "No space left on device")],
)
def test_the_log_says_why_kernels_could_not_be_compiled(
    function, is_warm, told, monkeypatch, caplog
):
    monkeypatch.setattr(warmth, "compile_kernels", function)
    warm = warmth.Warmth()
    with caplog.at_level(logging.WARNING, "vibrafeed"):
        asyncio.run(warm.compile())
    assert warm.is_warm == is_warm
    assert told in caplog.text
