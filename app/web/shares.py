"""Places for what a request computes: each owner has a share of them.

Reading a study, converting it, carrying out a short one and cutting a large slice take long. Few of
them run at a time, in turns of their owners, and in one queue with the blocks of jobs.
"""

from __future__ import annotations

import os
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any, TypeVar, cast

from fastapi import Depends, Request, params
from starlette.requests import ClientDisconnect

from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.process_pool import ProcessPool
from vibrafeed.app.web.dependencies import Body
from vibrafeed.app.web.entry import owner_of

CORES = os.cpu_count() or 1
_T = TypeVar("_T")
POST = " posts"  # purpose of requests that have a study read, and nothing computed
SECONDS_A_BYTE = 1e-7  # of a body that is read: large ones let smaller ones of their owner pass


@asynccontextmanager
async def slot_of(request: Request, size: int = 0, purpose: str = "") -> AsyncIterator[None]:
    """Wait for a computing slot for a request and hold it during the block.

    `size` is that of the body [bytes]: a larger one lets other requests of the same owner pass.
    Requests with a `purpose` do not count among the other ones of their owner.

    Raises
    ------
    ClientDisconnect
        If the client has left while it waited.
    """
    pool = cast(ProcessPool, request.app.state.process_pool)
    owner = owner_of(request.scope) + purpose
    async with pool.fair_queue.slot(owner, size * SECONDS_A_BYTE):
        await client_check(request)()
        yield


@asynccontextmanager
async def large_slot_of(request: Request) -> AsyncIterator[None]:
    """Hold a computing slot for a large slice during the block, as `slot_of` does.

    One owner has as many of them at a time as there are cores but one: their replies keep the event
    loop busy, too.
    """
    large = cast(FairQueue, request.app.state.large_shares)
    async with large.slot(owner_of(request.scope)), slot_of(request):
        yield


def threads_of(request: Request) -> int:
    """Return the number of threads that a request with a slot may compute with now."""
    pool = cast(ProcessPool, request.app.state.process_pool)
    return max(1, CORES // max(1, pool.fair_queue.taken))


async def calculate_in_process(
    request: Request, function: Callable[..., _T], *arguments: Any, seconds: float
) -> _T:
    """Run a function in a process of the pool and return its result; the caller holds a slot.

    The process is ended after `seconds` [s] with `StoppedError`, or with `ClientDisconnect` when
    the client leaves.
    """
    pool = cast(ProcessPool, request.app.state.process_pool)
    return await pool(function, *arguments, seconds=seconds, check=client_check(request))


def client_check(request: Request) -> Callable[[], Awaitable[None]]:
    """Return a function that raises `ClientDisconnect` if the client of a request has left.

    It is awaited now and then while something is computed for the client.
    """

    async def check() -> None:
        if await request.is_disconnected():
            raise ClientDisconnect

    return check


async def _hold_slot(request: Request, body: Body) -> AsyncIterator[None]:
    async with slot_of(request, len(body)):
        yield


def hold_slot() -> params.Depends:
    """Return a dependency that holds a place for a route, from its body to its reply."""
    return cast(params.Depends, Depends(_hold_slot, scope="function"))
