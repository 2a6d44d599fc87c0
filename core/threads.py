"""Threads that are kept from one call to the next.

To start two threads and to end them takes as long as a sweep of some 10^5 cells.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import Any, TypeVar

_T = TypeVar("_T")


def share_out(function: Callable[[_T], Any], tasks: Iterable[_T], threads: int) -> None:
    """Call a function for each task in several threads, and return when all are done.

    One thread, or one task, is the caller's.

    Parameters
    ----------
    function : callable
        It must not share out tasks itself: all threads might wait for each other.
    tasks : iterable
        What it is called with, one after another.
    threads : int
        How many calls there are at a time, at most.

    Raises
    ------
    Exception
        The first that a call raises. Tasks that have not begun are left out then.
    """
    tasks = list(tasks)
    if threads <= 1 or len(tasks) <= 1:
        for task in tasks:
            function(task)
        return
    pool = _pool(threads)
    calls = [pool.submit(function, task) for task in tasks]
    try:
        for call in calls:
            call.result()
    finally:
        for call in calls:
            call.cancel()
        wait(calls)


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return the pool of this many threads, made once."""
    return ThreadPoolExecutor(threads, thread_name_prefix="shared")


if hasattr(os, "register_at_fork"):  # a fork has no threads but its own
    os.register_at_fork(after_in_child=_pool.cache_clear)
