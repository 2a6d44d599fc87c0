"""Queries of the ledger for lists of jobs: the columns of a job, and the conditions."""

from __future__ import annotations

import json
import time
from typing import Any

from sqlalchemy import ColumnElement, Row, func, select

from vibrafeed.app.jobs.entries import ACTIVE, Job, Wanted
from vibrafeed.app.jobs.tables import JOBS, WORK

TICK = 1e-6  # s between the times of entry of two jobs, at least
JOB = select(
    JOBS,
    func.coalesce(WORK.c.done, 0).label("done"),
    func.coalesce(WORK.c.seconds, 0).label("spent"),
    WORK.c.began,
    func.coalesce(WORK.c.done_then, 0).label("done_then"),
).select_from(JOBS.outerjoin(WORK, WORK.c.key == JOBS.c.key))


def conditions(wanted: Wanted) -> list[ColumnElement[bool]]:
    """Return the SQL conditions of a filter of jobs, all of which a job has to meet.

    A field of `wanted` that is empty or None gives none.
    """
    # What has not begun has no duration.
    seconds = func.coalesce(JOBS.c.finished, time.time()) - JOBS.c.started
    (after, before), (least, most) = wanted.created, wanted.seconds
    clauses: list[ColumnElement[bool]] = []
    if wanted.seen_by is not None:
        clauses.append((JOBS.c.owner == wanted.seen_by) | (JOBS.c.shared == 1))
    if wanted.processes:
        clauses.append(JOBS.c.process.in_(wanted.processes))
    if wanted.states:
        clauses.append(JOBS.c.state.in_(wanted.states))
    # A job is told the millisecond in which it was entered, and is found by it.
    if after is not None:
        clauses.append(JOBS.c.created >= after - TICK / 2)
    if before is not None:
        clauses.append(JOBS.c.created < before + 1e-3 - TICK / 2)
    if least is not None:
        clauses.append(seconds >= least)
    if most is not None:
        clauses.append(seconds <= most)
    return clauses


def job_of(row: Row[*tuple[Any, ...]]) -> Job:
    """Return the job in a row of the ledger: the columns of `JOB`, a job joined with its work."""
    over = row.state not in ACTIVE
    return Job(
        id=row.id,
        key=row.key,
        process=row.process,
        state=row.state,
        cells=row.cells,
        blocks=row.blocks,
        done=_done(row),
        created=row.created,
        started=row.started,
        finished=row.finished,
        # What has not begun has taken nothing, though it may find a result that has.
        seconds=(row.seconds or 0.0) if over else row.spent * (row.state == "running"),
        problem=json.loads(row.problem) if row.problem else None,
        began=None if over else row.began,
        done_then=row.done_then,
        owner=row.owner,
        shared=bool(row.shared),
        gone=bool(row.gone),
    )


def _done(row: Row[*tuple[Any, ...]]) -> int:
    """Return the number of finished blocks of the job in a row; of an ended job, that at its end.

    `row` has the columns of `JOB`, a job joined with its work.
    """
    if row.state == "successful":
        return int(row.blocks)
    if row.state in ACTIVE:
        return int(row.done)
    return int(row.done_at_end or 0)  # the work that is there is that of others
