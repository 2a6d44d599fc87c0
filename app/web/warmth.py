"""Kernels compiled beside the service when it starts, so that no client waits for them."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import sys

logger = logging.getLogger("vibrafeed")

LONGEST = 2_000  # bytes of what is logged of a failure, its last ones
POLITE = 15  # niceness: whoever asks comes first


class Warmth:
    """Has `vibrafeed.core.warm` run in a process of its own.

    Attributes
    ----------
    is_warm : bool
        Everything is known to be compiled.
    """

    def __init__(self) -> None:
        """Begin without a running process."""
        self.is_warm = False
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Start compiling, as a task of the running event loop."""
        self._task = asyncio.create_task(self._run(), name="warm")

    async def stop(self) -> None:
        """Stop compiling, if it is still under way."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _run(self) -> None:
        """Compile missing kernels by `vibrafeed.core.warm`, in a process of low priority.

        `is_warm` is True afterwards if the process succeeded; its errors go to the log. The process
        is killed if this is cancelled.
        """
        try:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "vibrafeed.core.warm", "--processes", "1",
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.DEVNULL,
                stderr=asyncio.subprocess.PIPE,
                start_new_session=True,
            )  # fmt: skip
        except OSError:
            logger.exception("kernels cannot be compiled beforehand")
            return
        errors = b""
        try:
            with contextlib.suppress(ProcessLookupError):  # it has ended already
                os.setpriority(os.PRIO_PGRP, process.pid, POLITE)
            assert process.stderr is not None
            while piece := await process.stderr.read(LONGEST):
                errors = (errors + piece)[-LONGEST:]
            self.is_warm = await process.wait() == 0
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            await process.wait()
        if not self.is_warm:
            why = errors.decode(errors="replace").strip() or f"it ended with {process.returncode}"
            logger.warning("kernels could not be compiled beforehand: %s", why)
