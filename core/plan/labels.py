"""The labels of a result of any kind: coordinates, outputs, attributes; and its verified cells."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.dataset.bands import BAND
from vibrafeed.core.dataset.table import (
    CONVENTIONS,
    REFERENCES,
    TableVariable,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.grid import Grid, from_si, random_positions
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.grid_study import DrivenStudy, MeasuredDrive
from vibrafeed.core.study.part_study import PartOfFile
from vibrafeed.core.study.values import DESIGN, Fixed, Values

LEFT_OUT = "verified_left_out"
"""The attribute with the number of cells that a stop left without verifying; absent if it left
none."""

FAILED = "verified_failed"
"""The attribute with the number of verified cells that are further off than their known error
allows; absent if there are none."""

Positions = Mapping[str, NDArray[np.int64]]


class ResultVariable(NamedTuple):
    """A variable that a kind adds to its result: dimensions besides the grid's, unit, and texts."""

    name: str
    dims: tuple[str, ...]
    unit: str
    label: str
    comment: str = ""
    more: Mapping[str, Any] = MappingProxyType({})

    @property
    def attributes(self) -> dict[str, Any]:
        """The CF attributes of the variable."""
        comment = {"comment": self.comment} if self.comment else {}
        return {"units": self.unit, "long_name": self.label, **comment, **self.more}


def coordinates_of(plan: Plan, grid: Grid) -> dict[str, TableVariable]:
    """Return the coordinates of a result: axes of the grid, fixed parameters, default values.

    They are in the units of files; fixed parameters and defaults are scalars, so that a file says
    all that went into its results.
    """
    coordinates = {
        name: TableVariable((name,), grid.coordinate(name), quantity_attributes(name))
        for name in grid.axes
    }
    coordinates |= {
        name: TableVariable((DESIGN,), np.array(paired.values), quantity_attributes(name))
        for name, paired in grid.paired.items()
    }
    ends = {name: {BAND: np.array([band.low, band.high])} for name, band in grid.bands.items()}
    fixed: dict[str, Any] = {
        name: value for name, value in grid.fixed.items() if name in plan.parameters
    }
    fixed |= {name: from_si(name, np.asarray(value)) for name, value in plan.defaults.items()}
    return coordinates | {
        name: TableVariable(
            (),
            np.asarray(value, dtype=np.float64),
            quantity_attributes(name) | ends.get(name, {}),
        )
        for name, value in fixed.items()
    }


def outputs_of(prepared: Prepared, arrays: Mapping[str, NDArray[Any]]) -> dict[str, TableVariable]:
    """Return the requested outputs with axes and labels, in the units of files.

    `arrays` are the computed outputs in SI units and radians.
    """
    plan = prepared.plan
    equations = {equation.gives: equation for equation in plan.equations}
    return {
        name: TableVariable(
            prepared.dims[name],
            prepared.in_files(name, arrays[name]),
            quantity_attributes(
                name,
                equation=equations[name].source,
                **{plan.scene.choice: plan.scene.variant_of(plan.variant, name)},
                **link_to_verdict(plan, name),
            ),
        )
        for name in plan.outputs
    }


def link_to_verdict(plan: Plan, output: str) -> dict[str, str]:
    """Return the CF attribute that names the flag variable which judges an output, if one does."""
    verdict = plan.verdict_on(output)
    return {} if verdict is None else {"ancillary_variables": verdict.name}


def verdict_variables(
    plan: Plan, dims: Mapping[str, tuple[str, ...]], arrays: Mapping[str, NDArray[Any]]
) -> dict[str, TableVariable]:
    """Return the flag variables of a result: the regimes, each with the outputs that it judges."""
    has_several = len(plan.verdicts) > 1
    return {
        verdict.name: TableVariable(
            dims[verdict.name],
            arrays[verdict.name],
            regime_attributes(verdict.regimes, verdict.outputs if has_several else ()),
        )
        for verdict in plan.verdicts
    }


def global_attributes(prepared: Prepared, method: str) -> dict[str, str]:
    """Return the attributes of a result that say where it is from: study, version, scene, drive."""
    study, plan = prepared.study, prepared.plan
    attributes = {
        "Conventions": CONVENTIONS,
        "title": study.title or plan.scene.title,
        "source": f"vibrafeed {core.__version__}, {method}",
        "references": REFERENCES,
        "comment": plan.scene.validity,
        "scene": plan.scene.name,
        plan.scene.choice: plan.variant,
        "study": study.canonical(),
        "study_sha256": study.key(),
    }
    if isinstance(study, DrivenStudy) and study.drive is not None:
        attributes["drive"] = _origin_of_drive(study.drive, study.values())
    part: PartOfFile | None = getattr(study, "part", None)
    if part is not None:
        attributes["part"] = f"{part.name} (SHA-256 {part.sha256})"
    if prepared.questions:
        attributes["warnings"] = "\n".join(prepared.questions)
    if study.notes:
        attributes["notes"] = study.notes
    if study.units:
        attributes["shown_units"] = ", ".join(study.units)
    return attributes


def _origin_of_drive(drive: MeasuredDrive, values: Mapping[str, Values]) -> str:
    left_over = ", ".join(
        f"{axis} {100 * fraction:.2g} %" for axis, fraction in drive.left_over.items()
    )
    origin = f"fitted to {drive.name} (SHA-256 {drive.sha256}); left over {left_over}"
    if drive.constant is not None:
        left_over = ", ".join(
            f"{axis} {acceleration:.3g} m s-2" for axis, acceleration in drive.constant.items()
        )
        origin = (
            f"{drive.name} (SHA-256 {drive.sha256}), followed once; without its mean acceleration, "
            f"{left_over}, so that the track ends at rest"
        )
    if drive.clock_error is not None:
        origin += f"; clock error {100 * drive.clock_error:.3g} %"
    overridden = [
        name for name, number in drive.numbers.items() if values.get(name) != Fixed(number)
    ]
    return origin + (f"; not from it {', '.join(overridden)}" if overridden else "")


def chosen_positions(prepared: Prepared) -> tuple[Positions, int]:
    """Return the axis positions of the cells to verify, and their number.

    They are all different, and the same for equal studies.
    """
    grid, requested = prepared.grid, prepared.study.verify or 0
    return random_positions(grid, requested, prepared.study.key()), min(requested, grid.cells)


@dataclass(frozen=True)
class Sample:
    """The cells of a study that are verified: the position of each on each axis of the grid.

    `chosen` counts those that a stop left without a value to verify, too.
    """

    grid: Grid
    positions: Positions
    count: int
    chosen: int

    def at(self, values: NDArray[np.generic], dims: Collection[str]) -> Array:
        """Return the values of an array over the axes `dims` at the cells, shape (count,)."""
        chosen = values[tuple(self.positions[name] for name in dims)]
        return np.broadcast_to(np.asarray(chosen, dtype=np.float64), self.count)

    def where(self, cell: int) -> str:
        """Return the position of a sampled cell: ``at frequency 50 Hz, beta 30 deg``."""
        parts = []
        for name, axis in self.grid.axes.items():
            index = int(self.positions[name][cell])
            unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
            value = float(axis.array(index, index + 1)[0])
            parts.append(f"{name} {value:.12g}" + ("" if unit == "1" else f" {unit}"))
        return f"at {', '.join(parts)}" if parts else "at the only cell"

    def verification_attributes(
        self,
        against: str,
        worst: str = "",
        *,
        evaluated: int = 0,
        compared: int = 0,
        failed: int = 0,
    ) -> dict[str, str | int]:
        """Return the verification result as attributes of the dataset.

        The numbers are those of the cells that no stop left out, of those with a value to compare,
        and of those that are further off than their known errors allow.
        """
        attributes: dict[str, str | int] = {"verified_cells": compared, "verified_against": against}
        if failed:
            attributes[FAILED] = failed
        not_evaluated = self.chosen - evaluated
        if not_evaluated:
            stop = f"stopped before {not_evaluated:,} of {self.chosen:,} cells could be verified"
            worst = f"{worst}; {stop}" if worst else stop
        return (
            attributes
            | {"verified_worst": worst}
            | ({LEFT_OUT: not_evaluated} if not_evaluated else {})
        )


def sample_of(
    prepared: Prepared,
    arrays: Mapping[str, NDArray[np.generic]],
    unfinished: tuple[str, int] | None = None,
) -> Sample:
    """Return the cells of a study that are to be verified: random ones, equal for equal studies.

    `arrays` are its computed results; `unfinished` is the name of a status among them, and its
    value in cells that a stop left without a result: these are taken out.
    """
    positions, chosen = chosen_positions(prepared)
    sample = Sample(prepared.grid, positions, chosen, chosen)
    if unfinished is None:
        return sample
    name, value = unfinished
    finished = sample.at(arrays[name], prepared.dims[name]) != value
    positions = {axis: position[finished] for axis, position in positions.items()}
    return replace(sample, positions=positions, count=int(finished.sum()))
