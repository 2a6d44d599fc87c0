"""Jobs by their identifiers, and what became of them."""

from __future__ import annotations

import os
from pathlib import Path

from fastapi.responses import Response

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.errors import GoneError, NotFoundError
from vibrafeed.app.jobs.ledger import ACTIVE, Job
from vibrafeed.app.jobs.manifest import Manifest
from vibrafeed.app.web.documents import results
from vibrafeed.app.web.downloads import Check
from vibrafeed.app.web.problems import NoSuchJobError, NotReadyError
from vibrafeed.app.web.replies import json_reply, problem_document


def find_job(admission: Admission, number: str) -> Job:
    """Return the job with the identifier `number`; raise `NoSuchJobError` if there is none."""
    job = admission.ledger.job(number)
    if job is None:
        raise no_such_job(number)
    return job


def no_such_job(number: str) -> NoSuchJobError:
    """Return the error for an unknown job."""
    return NoSuchJobError(f"There is no job '{number[:80]}'. GET /jobs lists them.")


def manifest_of(admission: Admission, job: Job) -> Manifest | Response:
    """Return the manifest (list of files) of a job's result, or a problem document if it failed.

    `admission` is the object that holds ledger and store of jobs.

    Raises
    ------
    NotReadyError
        If the job is not done, or its result is damaged and computed again.
    GoneError, NotFoundError
        If the result was removed.
    """
    if job.problem is not None:
        return problem_document(**job.problem)
    if job.gone:
        raise GoneError(
            f"The result of the job {job.id} was removed to make room. Post its study again."
        )
    if job.state in ACTIVE:
        raise NotReadyError(
            f"The job {job.id} is {job.state}: it has no results yet. Request them "
            "when the job is successful."
        )
    manifest = None if job.state == "dismissed" else admission.store.manifest(job.key)
    if manifest is None:
        raise _recompute(admission, job)
    return manifest


def check_of(admission: Admission, job: Job, path: Path) -> Check:
    """Return the check that a file of a job's result is intact, made before the file is sent.

    If the file is damaged, the check removes it, queues the job again, and raises the error for the
    client.

    Parameters
    ----------
    admission : Admission
        The object that holds ledger and store of jobs.
    job : Job
        The job.
    path : Path
        The file.
    """

    def broken(status: os.stat_result) -> Exception:
        """Remove the damaged result, queue its job again, and return the error for the client."""
        admission.store.remove_file(job.key, path, status)
        return _recompute(admission, job)

    return Check(admission.store.integrity, broken)


def error_for_missing_file(admission: Admission, job: Job, path: Path) -> Exception:
    """Return the error for a file that is missing from a result, and have it computed again."""
    admission.store.remove_file(job.key, path)
    return _recompute(admission, job)


def _recompute(admission: Admission, job: Job) -> Exception:
    """Queue a job again whose result is missing, and return the error to raise for the client.

    It is `NotReadyError` if the result is computed again, and `NotFoundError` if it cannot be.
    `admission` is the object that accepts jobs.
    """
    if job.state == "successful" and admission.mend(job):
        return NotReadyError(
            f"The results of the job {job.id} were damaged on the disk and are being "
            "computed again. Request them when the job is successful."
        )
    return NotFoundError(
        f"The results of the job {job.id} have been removed. Post its study again."
    )


def results_reply(admission: Admission, job: Job, base: str) -> Response:
    """Return the reply with the results of a job, or the problem document if the job failed.

    `base` is the address of the service, for links. Raises the errors of `manifest_of` if the
    results are not there.
    """
    manifest = manifest_of(admission, job)
    if isinstance(manifest, Response):
        return manifest
    return json_reply(results(job, manifest, base))
