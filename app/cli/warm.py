"""`vibrafeed warm`: kernels compiled before anybody waits for them."""

from __future__ import annotations

import os
import time
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, Json


def warm(
    processes: Annotated[
        int, typer.Option(min=1, help="Maximum number of processes that compile in parallel.")
    ] = os.cpu_count() or 1,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Only check if all simulation code is compiled; exit with code 1 if not.",
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Compile the simulation code for this processor, once; takes about a minute.

    Without it the first study of each kind waits for the compilation. Compiled code is kept in
    NUMBA_CACHE_DIR, or among the user's caches.
    """
    from vibrafeed.core.warm import compile_kernels, is_warm

    if check:
        warm_already = is_warm()
        if as_json:
            console.document({"compiled": warm_already})
        elif warm_already:
            console.say("All code is compiled for this processor.")
        if not warm_already:
            console.fail("Some code is not compiled for this processor yet. Run `vibrafeed warm`.")
            raise typer.Exit(FAILED)
        return
    started = time.perf_counter()
    folder = compile_kernels(processes)
    if folder is None:
        console.fail(
            "Compiled code cannot be kept: no folder can be written. "
            "Set NUMBA_CACHE_DIR to one that can."
        )
        raise typer.Exit(FAILED)
    seconds = time.perf_counter() - started
    if as_json:
        console.document({"compiled": True, "folder": str(folder), "seconds": seconds})
        return
    console.say(f"All code is compiled, and stored in {folder}: {seconds:.1f} s.")
