"""Threads that are kept from one call to the next.

To start two threads and to end them takes as long as a sweep of some 10^5 cells.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import Any, TypeVar

_T = TypeVar("_T")


def share_out(function: Callable[[_T], Any], tasks: Iterable[_T], threads: int) -> None:
    """Call a function for each task in several threads, and return when all are done.

    The calling thread is one of them: it begins at once, while others wake up, and does everything
    itself if they are busy.

    Parameters
    ----------
    function : callable
        Called with a task, by any of the threads; its results are dropped.
    tasks : iterable
        The arguments, one for each call.
    threads : int
        The largest number of calls at a time.

    Raises
    ------
    Exception
        The first that a call raises. Tasks that have not begun are left out then.
    """
    left = deque(tasks)
    errors: list[BaseException] = []

    def work() -> None:
        try:
            while True:
                try:
                    task = left.popleft()
                except IndexError:
                    return
                function(task)
        except BaseException as error:
            errors.append(error)
            left.clear()

    helpers = min(threads, len(left)) - 1
    calls = [_pool(threads).submit(work) for _ in range(helpers)]
    work()
    running = [call for call in calls if not call.cancel()]
    try:
        wait(running)
    except BaseException:  # they still write into the caller's arrays
        wait(running)
        raise
    if errors:
        raise errors[0]


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(1, threads - 1), thread_name_prefix="shared")


if hasattr(os, "register_at_fork"):  # a fork has no threads but its own
    os.register_at_fork(after_in_child=_pool.cache_clear)
