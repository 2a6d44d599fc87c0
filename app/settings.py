"""The settings of the service, all in one place, read from the environment (`VIBRAFEED_...`)."""

from __future__ import annotations

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
    max_simulation_cells: int = Field(
        default=200_000, gt=0, description="Most cells of a simulation that is replied to at once."
    )
    max_execution_seconds: float = Field(
        default=30.0, gt=0, description="Longest run of a simulation that is replied to at once."
    )
    max_slice_cells: int = Field(
        default=1_000_000, gt=0, description="Largest number of values of one slice."
    )
    zarr_cache_bytes: int = Field(
        default=64_000_000, ge=0, description="Memory for the chunks that were read last."
    )
