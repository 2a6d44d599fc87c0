"""The section `uncertain`: from the result of a calibration that a study names to its densities."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.intake.section import Content, Resolved, Section, advice_on_path
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.distributions import CALIBRATION
from vibrafeed.core.study.units import UnitError, unit_factor

MAX_BYTES = 200_000_000  # of a result
DENSITY = "density_"
"""With the name of a parameter, the variable that holds its density."""


def beside(uncertain: Any, folder: Path) -> Any:
    """Return the section `uncertain` of a study with paths of calibration files from here.

    File names in it are relative to `folder`, that of the study; they become paths from the current
    folder. Other content stays as it is.
    """
    if not isinstance(uncertain, dict):
        return uncertain
    return {
        name: {**one, CALIBRATION: str(folder / one[CALIBRATION])}
        if isinstance(one, dict) and isinstance(one.get(CALIBRATION), str)
        else one
        for name, one in uncertain.items()
    }


def with_posteriors(content: Content, files: bool) -> Resolved:
    """Return the content of a study with densities in place of calibration files, and problems.

    An uncertain parameter may name the file of a calibration, whose density of this parameter it
    takes. One whose file has a problem is left out. `files` is True if files of this machine may be
    read; without that the content stays as it is, and is refused later.
    """
    uncertain = content.get("uncertain")
    if not files or not isinstance(uncertain, Mapping):
        return Resolved(content)
    resolved, problems = dict(uncertain), list[Problem]()
    for name, raw in uncertain.items():
        if isinstance(raw, Mapping) and set(raw) == {CALIBRATION}:
            read = _density(str(name), raw[CALIBRATION])
            if isinstance(read, Problem):
                problems.append(read)
                del resolved[name]
            else:
                resolved[name] = read
    return Resolved({**content, "uncertain": resolved}, problems)


def _density(name: str, path: object) -> dict[str, list[float]] | Problem:
    """Return values and probability densities of a parameter in a calibration result.

    Or its problem, if the file at `path` cannot be read or has no density of the parameter `name`.
    The result has the lists `values` and `densities`, for values in the units of files; densities
    of 0 at the ends are cut off.
    """
    from vibrafeed.core.dataset.read import read_netcdf  # few studies need it

    key = f"uncertain.{name}.{CALIBRATION}"
    fix = "Name the NetCDF file that `vibrafeed run` wrote of a study of kind 'calibrate'"
    if not isinstance(path, str):
        return Problem(key, "the key calibration is not the path of a file", fix)
    try:
        table = read_netcdf(Path(path), most_bytes=MAX_BYTES)
    except Exception as error:  # of a strange file the library raises of many kinds
        return Problem(key, f"{path} cannot be read: {error}"[:300], advice_on_path(path, fix))
    density = table.variables.get(f"{DENSITY}{name}")
    known_axis = name in table.coordinates and name in QUANTITIES
    if density is None or density.dims != (name,) or not known_axis:
        known = ", ".join(n.removeprefix(DENSITY) for n, one in table.variables.items()
                          if n.startswith(DENSITY) and len(one.dims) == 1)  # fmt: skip
        message = f"{path} has no density of {name}"
        return Problem(key, message, f"It has those of {known}" if known else fix)
    axis, quantity = table.coordinates[name], QUANTITIES[name]
    unit = str(axis.attributes.get("units", quantity.unit))
    try:
        factor = float(unit_factor(name, quantity, unit))
    except UnitError as error:
        return Problem(key, f"{path}: {error.message}", error.fix)
    values = factor * np.asarray(axis.values, dtype=np.float64)
    densities = np.asarray(density.values, dtype=np.float64)
    if not (np.isfinite(densities).all() and (densities > 0).any()):
        return Problem(
            key,
            f"the posterior density of {name} in {path} is 0 everywhere",
            "Run the calibration again",
        )
    # Nothing is lost beyond the first and the last 0 next to some mass.
    some = np.flatnonzero(densities > 0)
    kept = slice(max(some[0] - 1, 0), some[-1] + 2)
    return {"values": values[kept].tolist(), "densities": densities[kept].tolist()}


UNCERTAIN: Final = Section(
    names=lambda uncertain, _: uncertain if isinstance(uncertain, Mapping) else (),
    beside=beside,
    resolve=with_posteriors,
    by_parameter=True,
)
"""The section `uncertain`."""
