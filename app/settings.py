"""The settings of the service, all in one place, read from the environment (`VIBRAFEED_...`)."""

from __future__ import annotations

import os
from pathlib import Path

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict


class Settings(BaseSettings):
    """Settings and their safe defaults."""

    model_config = SettingsConfigDict(env_prefix="VIBRAFEED_", frozen=True, extra="forbid")

    data_directory: Path = Field(
        default=Path("data"), description="Where sweeps and their files are kept; made if missing."
    )
    max_body_bytes: int = Field(default=1_000_000, gt=0, description="Largest body of a request.")
    max_cells: int = Field(
        default=20_000_000, gt=0, description="Most cells of one sweep that is computed as a whole."
    )
    max_sweep_cells: int = Field(
        default=10**15,
        gt=0,
        le=10**17,
        description="Most cells of one sweep that is kept, to be read in pieces.",
    )
    max_axis_values: int = Field(
        default=2_000_000, gt=0, description="Most values of one axis of a sweep that is kept."
    )
    max_bytes: int = Field(
        default=1_000_000_000, gt=0, description="Most bytes of one sweep, before compression."
    )
    max_synchronous_seconds: float = Field(
        default=1.0,
        gt=0,
        description="A study that is thought to take longer on one core becomes a job.",
    )
    max_execution_seconds: float = Field(
        default=30.0, gt=0, description="Longest run of a study that is replied to at once."
    )
    max_wait_seconds: float = Field(
        default=60.0, ge=0, description="Longest that a client may wait for a job in one request."
    )
    max_job_seconds: float = Field(
        default=86_400.0, gt=0, description="Longest run of a job; what is done by then is kept."
    )
    max_queue: int = Field(
        default=100, gt=0, description="Most different studies that are computed or wait for it."
    )
    concurrent_jobs: int = Field(
        default=4, gt=0, description="Most different studies that are computed at a time."
    )
    scheduler: str | None = Field(
        default=None,
        pattern=r"^(tcp|tls)://",
        description="Address of a Dask scheduler whose workers see the data directory under the "
        "same path; workers of the service's own if left out.",
    )
    workers: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        gt=0,
        description="Worker processes of the service's own; one for each core if left out.",
    )
    lease_seconds: float = Field(
        default=15.0, gt=0, description="After this long without a sign, another server takes over."
    )
    retention_days: float = Field(
        default=30.0, gt=0, description="Jobs and studies not used for so long are removed."
    )
    disk_quota_bytes: int = Field(
        default=50_000_000_000,
        gt=0,
        description="Most bytes in the data directory; results used longest ago make room.",
    )
    max_slice_cells: int = Field(
        default=1_000_000, gt=0, description="Largest number of values of one slice."
    )
    zarr_cache_bytes: int = Field(
        default=64_000_000, ge=0, description="Memory for the chunks that were read last."
    )
