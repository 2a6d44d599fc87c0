"""Jobs by their identifiers, and what became of them."""

from __future__ import annotations

from fastapi.responses import Response

from app.jobs.desk import Desk
from app.jobs.errors import NotFoundError
from app.jobs.ledger import ACTIVE, Job
from app.jobs.manifest import Manifest
from app.web.documents import results
from app.web.problems import NoSuchJobError, NotReadyError
from app.web.replies import json_reply, problem_document


def find_job(desk: Desk, number: str) -> Job:
    """Return a job; raise `NoSuchJobError` if there is none."""
    job = desk.ledger.job(number)
    if job is None:
        raise no_such_job(number)
    return job


def no_such_job(number: str) -> NoSuchJobError:
    """Return the error that tells so."""
    return NoSuchJobError(f"There is no job '{number[:80]}'. GET /jobs lists them.")


def manifest_of(desk: Desk, job: Job) -> Manifest | Response:
    """Return what is known of a job's result, or the problem document if it failed."""
    if job.problem is not None:
        return problem_document(**job.problem)
    if job.state in ACTIVE:
        raise NotReadyError(f"The job {job.id} is {job.state}; its results are not there yet.")
    manifest = None if job.state == "dismissed" else desk.store.manifest(job.key)
    if manifest is None:
        raise NotFoundError(f"The results of the job {job.id} have been removed.")
    return manifest


def results_reply(desk: Desk, job: Job, base: str) -> Response:
    """Return the results of a job, or why there are none."""
    manifest = manifest_of(desk, job)
    if isinstance(manifest, Response):
        return manifest
    return json_reply(results(job, manifest, base))
