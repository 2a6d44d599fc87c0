"""Waiting for a state, with one patience for all: a busy machine is slow, and not wrong."""

import asyncio
import time
from collections.abc import Callable
from typing import TypeVar

PATIENCE = 120.0
"""Seconds after which a state is taken never to come. It measures nothing."""
EVERY = 0.05  # s between two looks
SELDOM = 0.25
"""Seconds between two looks at what stays as it is, once it is so, and takes some work to ask."""

State = TypeVar("State")


def wait_for(
    state: Callable[[], State], tell: Callable[[], object] = str, every: float = EVERY
) -> State:
    """Return the state as soon as it is true; if it does not come, fail with what `tell` says.

    It is looked at once in `every` seconds.
    """
    end = time.monotonic() + PATIENCE
    while not (reached := state()):
        if time.monotonic() > end:
            raise TimeoutError(f"it does not come: {tell()}")
        time.sleep(every)
    return reached


async def awaited(state: Callable[[], State]) -> State:
    """Return the state as soon as it is true, and let others run meanwhile."""
    end = time.monotonic() + PATIENCE
    while not (reached := state()):
        if time.monotonic() > end:
            raise TimeoutError("it does not come")
        await asyncio.sleep(EVERY / 5)
    return reached
