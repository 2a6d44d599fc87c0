"""Jobs by their identifiers, and what became of them."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from fastapi.responses import Response

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.errors import GoneError, NotFoundError
from vibrafeed.app.jobs.ledger import ACTIVE, Job
from vibrafeed.app.jobs.manifest import Manifest
from vibrafeed.app.web.documents import results
from vibrafeed.app.web.problems import FailedError, NoSuchJobError, NotReadyError
from vibrafeed.app.web.replies import json_reply


def find_job(admission: Admission, number: str) -> Job:
    """Return the job with the identifier `number`; raise `NoSuchJobError` if there is none."""
    job = admission.ledger.job(number)
    if job is None:
        raise no_such_job(number)
    return job


def no_such_job(number: str) -> NoSuchJobError:
    """Return the error for an unknown job."""
    return NoSuchJobError(f"There is no job '{number[:80]}'. GET /jobs lists them.")


def manifest_of(admission: Admission, job: Job) -> Manifest:
    """Return the manifest (list of files) of a job's result.

    `admission` is the object that holds ledger and store of jobs.

    Raises
    ------
    FailedError
        If the job failed.
    NotReadyError
        If the job is not done, or its result is damaged and computed again.
    GoneError, NotFoundError
        If the result was removed.
    """
    if job.problem is not None:
        raise FailedError(job.problem)
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


def check_file(admission: Admission, job: Job, path: Path, digest: str) -> None:
    """Compare a file of a job's result with its SHA-256 before it is sent.

    A damaged or missing file is removed with its result, and the job queued again.

    Raises
    ------
    NotReadyError, NotFoundError
        If the file is damaged or missing, and the result is computed again, or cannot be.
    """
    store, damaged = admission.store, None  # None: the file is missing
    with suppress(FileNotFoundError), path.open("rb", buffering=0) as file:
        if store.integrity.matches(file, digest):
            return
        damaged = os.fstat(file.fileno())
    store.remove_file(job.key, path, damaged)
    raise _recompute(admission, job)


def _recompute(admission: Admission, job: Job) -> Exception:
    """Queue a job again whose result is missing, and return the error to raise for the client.

    It is `NotReadyError` if the result is computed again, and `NotFoundError` if it cannot be.
    `admission` is the object that accepts jobs.
    """
    if job.state == "successful" and admission.recompute(job):
        return NotReadyError(
            f"The results of the job {job.id} were damaged on the disk and are being "
            "computed again. Request them when the job is successful."
        )
    return NotFoundError(
        f"The results of the job {job.id} have been removed. Post its study again."
    )


def results_reply(admission: Admission, job: Job, base: str) -> Response:
    """Return the reply with the results of a job.

    `base` is the address of the service, for links. Raises the errors of `manifest_of` if the
    results are not there.
    """
    return json_reply(results(job, manifest_of(admission, job), base))
