"""The settings of the service, all in one place, read from the environment (`VIBRAFEED_...`)."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

from pydantic import BeforeValidator, Field, SecretStr, field_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from vibrafeed.app.folders import data_folder
from vibrafeed.core.errors import Problem
from vibrafeed.core.suggestions import suggestion
from vibrafeed.core.system import installing

PREFIX = "VIBRAFEED_"
# Read by the tests only; whoever runs them may serve with the same environment.
TEST_SWITCHES = (
    "VIBRAFEED_NIGHT",
    "VIBRAFEED_REQUIRE_TOOLS",
    "VIBRAFEED_COMPLIANCE_CHECKER",
    "VIBRAFEED_CLIENT_GENERATOR",
    "VIBRAFEED_FUZZ_ACTIONS",
    "VIBRAFEED_FUZZ_CASES",
    "VIBRAFEED_FUZZ_LINKS",
    "VIBRAFEED_LAW_CELLS",
    "VIBRAFEED_DURATIONS",
)
FORMER = {
    "VIBRAFEED_ZARR_CACHE_BYTES": "Leave it out: Zarr chunks are computed when they are read",
    "VIBRAFEED_RESULTS_URL": "Leave it out: results are kept in VIBRAFEED_DATA_DIRECTORY alone",
    "VIBRAFEED_MAX_UNSENT_BYTES": "Leave it out: a proxy holds slow readers",
    "VIBRAFEED_API_KEY_HASHES": "Leave it out, and make keys by `vibrafeed key add`",
}
"""Settings of former versions, and the setting that does the same."""

_ORIGIN = re.compile(r"https?://([a-z0-9.-]+|\[[0-9a-f:.]+\])(:[0-9]{1,5})?")


def _split_words(raw: object) -> object:
    """Split the text of a setting into entries: a JSON list, or words separated by commas.

    What is not a text is returned unchanged; pydantic checks the result. Raises `ValueError` if a
    text begins like a JSON list but is not one.
    """
    if not isinstance(raw, str):
        return raw
    if raw.lstrip().startswith("["):
        try:
            return json.loads(raw)
        except (ValueError, RecursionError):
            raise ValueError(
                "the value of this environment variable begins like a JSON list but is not "
                "valid JSON: correct it, or "
                "separate entries by commas"
            ) from None
    return [word.strip() for word in raw.split(",") if word.strip()]


def url_fault(url: str) -> str | None:
    """Return the fault of a database URL in words, without any part of the URL.

    None if it is valid. No part is shown because it may be a password. A PostgreSQL URL is a fault,
    too, if its driver psycopg is not installed.
    """
    scheme, _, path = url.partition("://")
    if scheme == "sqlite":
        has_file = len(path) > 1 and path.startswith("/")
        return None if has_file else "sqlite:/// needs a file after it"
    if scheme != "postgresql":
        return "it begins neither with postgresql:// nor with sqlite:///"
    form = "it is not like postgresql://db.example:5432/jobs, with user:password@ before the host"
    try:
        parts = urlsplit(url)
        is_right = len(parts.path) > 1 and parts.port != 0 and url.count("@") <= 1
    except ValueError:
        is_right = False
    if not is_right or parts.fragment:
        return f"{form}; write /, ?, # and @ in a password as %2F, %3F, %23 and %40"
    if find_spec("psycopg") is None:
        return f"psycopg is not installed: {installing('psycopg[binary]', 'postgres')}"
    return None


Words = Annotated[tuple[str, ...], NoDecode, BeforeValidator(_split_words)]


class Settings(BaseSettings):
    """Settings and their safe defaults."""

    model_config = SettingsConfigDict(
        env_prefix=PREFIX, frozen=True, extra="forbid", hide_input_in_errors=True
    )

    data_directory: Path = Field(
        default_factory=data_folder,
        description="Directory in which the service stores studies and results; created if "
        "missing. By default `vibrafeed` in the data folder of the user, on Linux "
        "`~/.local/share`.",
    )
    ledger_url: SecretStr | None = Field(
        default=None,
        description="URL of the database that records jobs, as in "
        "`postgresql://db.example:5432/jobs`, with `user:password@` before the "
        "host; by default an SQLite file in the data directory.",
    )
    max_body_bytes: int = Field(
        default=1_000_000, gt=0, description="Maximum size of the body of a request, in bytes."
    )
    max_cells: int = Field(
        default=20_000_000,
        gt=0,
        description="Maximum number of cells (grid points) of a result in one file; a larger "
        "sweep becomes a job that writes a Zarr group.",
    )
    max_sweep_cells: int = Field(
        default=10**15,
        gt=0,
        le=10**17,
        description="Maximum number of cells (grid points) of a sweep whose values are "
        "computed only when they are read.",
    )
    max_axis_values: int = Field(
        default=2_000_000,
        gt=0,
        description="Maximum number of values on one axis of a sweep whose values are "
        "computed when they are read.",
    )
    max_bytes: int = Field(
        default=1_000_000_000,
        gt=0,
        description="Maximum size of a result in one file, in bytes, before compression.",
    )
    max_synchronous_seconds: float = Field(
        default=1.0,
        gt=0,
        description="Maximum expected computing time, in seconds on one core, of a study that "
        "is answered at once; longer ones become jobs.",
    )
    max_execution_seconds: float = Field(
        default=30.0,
        gt=0,
        description="Maximum computing time, in seconds, of a study that is answered at once.",
    )
    max_wait_seconds: float = Field(
        default=60.0,
        ge=0,
        description="Maximum time, in seconds, that a client may wait for a job in one request.",
    )
    max_job_seconds: float = Field(
        default=86_400.0,
        gt=0,
        description="Maximum computing time of a job in seconds, not counting the loading of "
        "code and the wait in the queue; finished blocks are kept.",
    )
    grace_seconds: float = Field(
        default=5.0,
        gt=0,
        description="Time in seconds for which a worker may continue a dismissed or overdue "
        "job; then the worker is killed and restarted.",
    )
    block_seconds: float = Field(
        default=1.0,
        gt=0,
        le=3600,
        description="Approximate computing time of one block of a job, in seconds. If a "
        "worker is killed, only its current block is computed again.",
    )
    max_queue: int = Field(
        default=100,
        gt=0,
        description="Maximum number of different studies that run or wait. If n keys have "
        "studies, each key may use 1/(n + 1) of these places.",
    )
    concurrent_jobs: int = Field(
        default=4,
        gt=0,
        description="Maximum number of studies that run in parallel; one that is smaller than "
        "all of them starts in addition.",
    )
    scheduler: str | None = Field(
        default=None,
        pattern=r"^(tcp|tls)://",
        description="Address of a Dask scheduler that computes the blocks of jobs, as in "
        "`tls://scheduler.example:8786`; its workers see the data directory under the same path. "
        "Whoever reaches a scheduler runs code on its workers.",
    )
    workers: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        gt=0,
        description="Number of processes that compute; by default one for each processor core. "
        "One more is kept for short work.",
    )
    lease_seconds: float = Field(
        default=15.0,
        gt=0,
        description="Time in seconds after which a server that gives no sign of life loses "
        "its jobs to another server.",
    )
    retention_days: float = Field(
        default=30.0,
        gt=0,
        description="Time in days after which unused jobs and studies are removed.",
    )
    disk_quota_bytes: int = Field(
        default=50_000_000_000,
        gt=0,
        description="Maximum size of all studies and results on the disk, in bytes; beyond it "
        "the least recently used ones are removed.",
    )
    max_slice_cells: int = Field(
        default=1_000_000,
        gt=0,
        description="Maximum number of values in one slice of a sweep that a client reads.",
    )
    max_table_rows: int = Field(
        default=1_000_000,
        gt=0,
        description="Maximum number of rows of a result sent as a CSV or Parquet table.",
    )
    max_sheet_rows: int = Field(
        default=100_000,
        gt=0,
        description="Maximum number of rows of a result sent as an XLSX table, which is "
        "slow to write.",
    )
    cors_origins: Words = Field(
        default=(),
        description="Origins of other web pages whose scripts may use the service, as in "
        "`https://lab.example`; a JSON list or comma-separated.",
    )
    max_requests: int = Field(
        default=512,
        gt=0,
        description="Maximum number of requests that are served at the same time; further "
        "requests are answered with 503.",
    )
    warm_at_start: bool = Field(
        default=True,
        description="Compile the simulation code in the background when the service starts, "
        "if it is not compiled yet.",
    )
    root_path: str = Field(
        default="",
        pattern=r"^(/[A-Za-z0-9._~-]+)*$",
        description="Path prefix under which a reverse proxy serves the application, as in "
        "`/vibrafeed`.",
    )
    drain_seconds: float = Field(
        default=0.0,
        ge=0,
        description="Time in seconds after a stop signal for which the service still answers "
        "requests that start no work; meanwhile `/readyz` reports that the "
        "service stops.",
    )
    shutdown_seconds: int = Field(
        default=4,
        gt=0,
        description="Maximum further time in seconds to finish running replies after "
        "`drain_seconds`; the service ends within 5 s after that.",
    )

    @property
    def ledger(self) -> Path | str:
        """The location of the ledger: a file path, or the URL of a database."""
        url = self.ledger_url
        return url.get_secret_value() if url else self.data_directory / "jobs.sqlite3"

    @field_validator("ledger_url")
    @classmethod
    def _database(cls, url: SecretStr | None) -> SecretStr | None:
        """Return the URL of the ledger's database unchanged.

        Raise `ValueError` if it has a fault.
        """
        # No part of it is echoed: what is wrong may be a password in the wrong place.
        if url is not None:
            fault = url_fault(url.get_secret_value())
            if fault is not None:
                raise ValueError(fault)
        return url

    @field_validator("scheduler")
    @classmethod
    def _cluster(cls, address: str | None) -> str | None:
        """Return the address of the scheduler unchanged.

        Raise `ValueError` if it needs distributed, missing here.
        """
        if address and find_spec("distributed") is None:
            raise ValueError(
                "a Dask scheduler needs the package distributed, which is missing: "
                f"{installing('distributed', 'cluster')}"
            )
        return address

    @field_validator("cors_origins")
    @classmethod
    def _origins(cls, origins: tuple[str, ...]) -> tuple[str, ...]:
        """Return the allowed origins unchanged.

        Raise `ValueError` if one is not like `https://lab.example`.
        """
        for word in origins:
            if not _ORIGIN.fullmatch(word):
                raise ValueError(
                    f"{word[:60]!r} is not a web origin in lower-case letters, as in "
                    "https://lab.example"
                )
        return origins


def unknown_variables(names: Iterable[str]) -> list[Problem]:
    """Return a problem for each environment variable named like a setting that does not exist.

    `names` are the names of all environment variables. Those that begin with `VIBRAFEED_` have to
    be settings, or switches of the tests; a problem says what replaces a former setting,
    or suggests the nearest name.
    """
    settings = [PREFIX + name.upper() for name in Settings.model_fields]
    return [
        Problem(
            name,
            "vibrafeed has no setting with this environment variable",
            FORMER.get(name.upper()) or suggestion(name.upper(), settings),
        )
        for name in sorted(names)
        if name.upper().startswith(PREFIX) and name.upper() not in (*settings, *TEST_SWITCHES)
    ]
