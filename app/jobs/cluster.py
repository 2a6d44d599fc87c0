"""A Dask cluster elsewhere, which takes the blocks of jobs through `concurrent.futures`."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any, TypeVar

from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.process_pool import EndedError, LostError

if TYPE_CHECKING:
    from distributed import Client

PATIENCE = 20.0  # s that a scheduler may take to answer
_T = TypeVar("_T")


class Cluster:
    """Runs functions on the workers of a Dask scheduler; connects when the first work comes.

    Parameters
    ----------
    address : str
        The scheduler's.

    Attributes
    ----------
    fair_queue : FairQueue
        Gives out the threads of all workers.
    trouble : str or None
        The reason why calls cannot be carried out.
    """

    def __init__(self, address: str):
        """Note the address of a scheduler."""
        self._address = address
        self._client: Client | None = None
        self._threads = 0
        self.fair_queue = FairQueue(2)
        self.trouble: str | None = None

    async def prepare(self) -> None:
        """Connect to the scheduler if need be, and count the threads of its workers.

        Raises
        ------
        LostError
            If it does not answer, or has no workers; `trouble` then says so.
        """
        try:
            self._threads = await asyncio.to_thread(self._count_threads)
        except Exception as error:  # of many kinds
            self._threads = 0
            self.trouble = f"the workers cannot be reached: {type(error).__name__}"
            raise LostError(f"{self.trouble}: {error}") from error
        self.trouble = None if self._threads else "there are no workers"
        if self.trouble:
            raise LostError(self.trouble)
        self.fair_queue.resize(self._threads + 1)  # long calls leave one place

    async def __call__(
        self,
        function: Callable[..., _T],
        *arguments: Any,
        on_start: Callable[[], Awaitable[None]],
        grace: float = 0.0,
    ) -> _T:
        """Run a function on a worker and return its result.

        A running call cannot be ended from here: `grace` [s] after its caller is cancelled, it is
        left to itself. Raises `EndedError` if workers die of it, and `LostError` if the scheduler
        is lost.
        """
        from distributed import KilledWorker
        from distributed.client import FutureCancelledError
        from distributed.comm.core import CommClosedError

        assert self._client is not None, "prepare() connects"
        executor = self._client.get_executor(pure=False)  # type: ignore[no-untyped-call]
        call = asyncio.wrap_future(executor.submit(function, *arguments))
        try:
            await on_start()
            await asyncio.wait({call})
            if call.cancelled():
                raise LostError("the scheduler has forgotten the work")
            result: _T = call.result()
            return result
        except KilledWorker as error:
            raise EndedError("The workers that computed a block died.") from error
        except (FutureCancelledError, CommClosedError) as error:
            raise LostError(f"{type(error).__name__}: {error}") from error
        finally:
            if not call.done():
                await asyncio.wait({call}, timeout=grace)
                call.cancel()

    def alive(self) -> int:
        """Return the number of threads of all workers at the last look."""
        return self._threads

    def close(self) -> None:
        """Close the connection; the workers stay."""
        client, self._client = self._client, None
        if client is not None:
            client.close(timeout=1)  # type: ignore[no-untyped-call]

    def _count_threads(self) -> int:
        from distributed import Client

        if self._client is not None and self._client.status != "running":
            self.close()
        if self._client is None:
            self._client = Client(self._address, set_as_default=False, timeout=PATIENCE)  # type: ignore[no-untyped-call]
        threads: dict[str, int] = self._client.nthreads()  # type: ignore[no-untyped-call]
        return sum(threads.values())
