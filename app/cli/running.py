"""Studies carried out one after the other: progress, Ctrl-C, results written and shown."""

from __future__ import annotations

import threading
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.by_kind import is_infeasible
from vibrafeed.app.cli.large import is_stored_in_blocks, run_large
from vibrafeed.app.cli.plans import more
from vibrafeed.app.cli.results import facts_of, show_result
from vibrafeed.app.cli.studies import (
    INTERRUPTED,
    interruptible_compiler,
    interruption,
    refuse_beyond_memory,
)
from vibrafeed.app.cli.targets import kept_apart, write_or_exit
from vibrafeed.core import kinds
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plan.pieces import cells_of
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared


@dataclass
class Running:
    """Studies that are carried out one after the other.

    Attributes
    ----------
    plain, resume : bool
        As for `run`: write NetCDF without compression; go on with stopped runs.
    units : str or None
        Units for printing.
    checked : float or None
        Seconds that checking the studies took; given with `--verbose` only, which prints more.
    deadline : float or None
        Time of `time.monotonic` at which to stop [s].
    facts : list of dict
        The results so far, as JSON documents.
    solved : bool
        True if every optimisation so far has a solution for some design.
    """

    plain: bool
    resume: bool
    units: str | None
    checked: float | None
    deadline: float | None
    facts: list[dict[str, Any]] = field(default_factory=list)
    solved: bool = True

    def carry_out(
        self,
        studies: Mapping[Path, Prepared],
        targets: Mapping[Path, str],
        complete: Collection[Path],
    ) -> bool:
        """Compute the studies of a command one after another, and write their results.

        The facts on every result are appended to `self.facts`. A study that is interrupted ends the
        run; the studies that were not carried out are then printed.

        Parameters
        ----------
        studies : mapping of Path to Prepared
            The studies by their files.
        targets : mapping of Path to str
            Path or URL of each study's result, by the study's file.
        complete : collection of Path
            Files of studies whose results exist already, which are not computed again.

        Returns
        -------
        bool
            True if all results are complete and verified.
        """
        verified, left = True, list(studies)
        for path, prepared in studies.items():
            target = targets[path]
            if path in complete:
                console.say(f"{path}: {target} is complete already")
                self.facts.append({"study": str(path), "result": target, "complete_before": True})
                left.remove(path)
                continue
            if is_stored_in_blocks(prepared, target):
                left.remove(path)
                whole, is_verified, facts = run_large(
                    path,
                    prepared,
                    target,
                    compression=not self.plain,
                    resume=self.resume,
                    history=history_of(path),
                    deadline=self.deadline,
                    units=self.units,
                )
                if facts:
                    self.facts.append(facts)
                    self._say_more(prepared)
                verified &= is_verified
                if not whole:
                    break
                continue
            computed = self._carry_out_study(path, prepared, target)
            if computed is None:
                break
            is_verified, interrupted = computed
            verified &= is_verified
            left.remove(path)
            if interrupted:
                break
        if left:
            console.fail(f"The run was stopped: not carried out are {', '.join(map(str, left))}.")
        return verified and not left

    def _carry_out_study(
        self, path: Path, prepared: Prepared, target: str
    ) -> tuple[bool, bool] | None:
        """Compute and write one result; None if nothing was written.

        Parameters
        ----------
        path : Path
            The study's file.
        prepared : Prepared
            The study, ready to be computed.
        target : str
            The path or URL of the result.

        Returns
        -------
        tuple of bool
            True if the result is complete and verified; True if Ctrl-C was pressed.
        """
        refuse_beyond_memory(path, prepared)
        compiled = stopwatch.spent
        begun = threading.Event()
        stopped_early = f"{path}: it was stopped before a cell was computed; nothing is written."
        with (
            console.progress(path.name) as advance,
            interruption(gently=prepared.can_stop, has_begun=begun.is_set) as interrupted,
            interruptible_compiler(stopped_early),
        ):

            def progress(share: float) -> None:
                """Advance the progress bar by a share of the work.

                Note that computing has begun.
                """
                begun.set()
                advance(share)

            try:
                table = kinds.tabulate(prepared, Watch(progress, interrupted, self.deadline))
            except StoppedError as stopped:
                console.fail(f"{path}: {stopped}; nothing is written.")
                return None
            except KeyboardInterrupt:
                at_once = f"{path}: it was stopped at once; nothing is written."
                console.fail(at_once if begun.is_set() else stopped_early)
                raise typer.Exit(INTERRUPTED) from None
        if kinds.share_left_out(table) == 1:
            console.fail(stopped_early)
            return None
        target = kept_apart(target) if not kinds.is_whole(table) else target
        evaluated = time.perf_counter()
        write_or_exit(path, table, target, history_of(path), compression=not self.plain)
        seconds = {
            "computing": float(table.price["elapsed_seconds"]),
            "compiling": stopwatch.spent - compiled,
            "writing": time.perf_counter() - evaluated,
        }
        facts = facts_of(path, target, table, cells_of(prepared, table)) | {"seconds": seconds}
        self.facts.append(facts)
        self.solved &= not is_infeasible(table)
        console.say(f"{path} -> {target}")
        show_result(facts, table, self.units, everything=self.checked is not None)
        if facts["cells_computed"] < facts["cells"]:
            options = "--resume" if target.endswith(".nc") else "--resume --force"
            console.fail(f"  The same command with {options} computes the whole study again.")
            if prepared.not_lazy is None:
                console.fail("  A run to Zarr (-o result.zarr) goes on where it was stopped.")
        done, cells = facts["cells_computed"], facts["cells"]
        of = f"{done:,} of {cells:,}" if done < cells else f"{cells:,}"
        noun = "cell" if cells == 1 else "cells"
        console.say(
            f"  {of} {noun} evaluated in {seconds['computing']:.3f} s, "
            f"written in {seconds['writing']:.3f} s"
        )
        if seconds["compiling"]:
            console.say(f"  compiled in {seconds['compiling']:.1f} s: once, it is kept")
        self._say_more(prepared)
        return kinds.is_whole(table) and not kinds.not_verified(table), interrupted()

    def _say_more(self, prepared: Prepared) -> None:
        """Print the further lines that `--verbose` asks for."""
        if self.checked is not None:
            for line in more(prepared, self.checked):
                console.tell(line)


def history_of(path: Path) -> str:
    """Return the first line of the CF attribute `history`: time, program and study."""
    return f"{datetime.now(UTC).isoformat(timespec='seconds')} vibrafeed run {path.name}"
