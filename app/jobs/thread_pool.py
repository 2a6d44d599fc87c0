"""A thread pool for calls of jobs that wait for the ledger or the disk."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

# Threads of their own for jobs: downloads, which fill those of the event loop, cannot delay the
# renewal of a lease.
THREADS = 2

_T = TypeVar("_T")


class ThreadPool:
    """Runs functions aside from the event loop."""

    def __init__(self) -> None:
        """Start a pool of `THREADS` threads."""
        self._threads = ThreadPoolExecutor(THREADS, thread_name_prefix="jobs")

    async def __call__(self, function: Callable[..., _T], *arguments: Any, **options: Any) -> _T:
        """Run a function in a thread and return its result."""
        call = functools.partial(function, *arguments, **options)
        return await asyncio.get_running_loop().run_in_executor(self._threads, call)

    def close(self) -> None:
        """Wait for running functions and accept no more."""
        self._threads.shutdown()
