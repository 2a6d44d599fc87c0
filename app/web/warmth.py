"""Kernels compiled beside the service when it starts, so that no client waits for them."""

from __future__ import annotations

import logging

from vibrafeed.app.jobs.process_pool import ProcessPool
from vibrafeed.core.warm import compile_kernels

logger = logging.getLogger("vibrafeed")


class Warmth:
    """Has the kernels compiled in a process of its own, which ends then.

    Attributes
    ----------
    is_warm : bool
        Everything is known to be compiled.
    """

    is_warm = False

    async def compile(self) -> None:
        """Compile missing kernels; an error goes to the log."""
        process_pool = ProcessPool(1, ())
        try:
            self.is_warm = await process_pool(compile_kernels, 1) is not None
        except Exception as error:
            logger.warning("kernels could not be compiled beforehand: %s", error)
        finally:
            process_pool.close()
