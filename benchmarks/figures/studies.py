"""The studies of chapter 5, their data, and where the pictures go."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import xarray as xr

from vibrafeed.core.intake import load_study, parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.study.sweep_and_simulate import SweepStudy

ROOT = Path(__file__).parents[2]
STUDIES = ROOT / "configs" / "figures"
PICTURES = ROOT / "docs" / "figures"


def path_of(number: int) -> Path:
    """Return the path of the study of figure 5.number."""
    return STUDIES / f"fig-5-{number}.toml"


def picture_of(number: int) -> Path:
    """Return the path of the picture of figure 5.number; a surface's is that of its contours."""
    return PICTURES / f"fig-5-{number + is_surface(number)}.png"


def is_surface(number: int) -> bool:
    """True if figure 5.number is a surface; the next one has contour lines of the same data."""
    return "(surface)" in (study(number).title or "")


@cache
def study(number: int) -> SweepStudy:
    """Return the study of figure 5.number."""
    return load_study(path_of(number))


@cache
def data(number: int) -> xr.Dataset:
    """Return the computed data of figure 5.number."""
    return run_study(study(number))


def changed(number: int, *, variant: str | None = None, **parameters: object) -> xr.Dataset:
    """Return a figure's data with another variant or other parameter values."""
    content = tomllib.loads(path_of(number).read_text(encoding="utf-8"))
    content["parameters"] |= parameters
    content["variant"] = variant or content["variant"]
    return run_study(parse_study(content))


def fine(start: float, stop: float, step: float) -> dict[str, float]:
    """Return a range with a step, as a study holds it."""
    return {"start": start, "stop": stop, "step": step}
