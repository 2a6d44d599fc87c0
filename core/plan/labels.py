"""The labels of a result of any kind: coordinates, outputs, and attributes of the whole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.dataset.table import (
    CONVENTIONS,
    REFERENCES,
    TableVariable,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.drive import MeasuredDrive
from vibrafeed.core.study.grid_study import DrivenStudy
from vibrafeed.core.study.values import Fixed, Values


def coordinates_of(plan: Plan, grid: Grid) -> dict[str, TableVariable]:
    """Return the coordinates of a result: axes of the grid, fixed parameters, default values.

    They are in the units of files, with attributes; fixed parameters and defaults are scalars, so
    that a file says all that went into its results.
    """
    coordinates = {
        name: TableVariable((name,), grid.coordinate(name), quantity_attributes(name))
        for name in grid.axes
    }
    fixed = {name: value for name, value in grid.fixed.items() if name in plan.parameters}
    fixed |= {name: _edge(name, value) for name, value in plan.defaults.items()}
    return coordinates | {
        name: TableVariable((), np.asarray(value, dtype=np.float64), quantity_attributes(name))
        for name, value in fixed.items()
    }


def outputs_of(prepared: Prepared, arrays: Mapping[str, NDArray[Any]]) -> dict[str, TableVariable]:
    """Return the requested outputs with axes and labels, in the units of files.

    `arrays` are the computed outputs in SI units and radians. `prepared` is the study, with its
    plan and the axes of each output.
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
    """Return the flag variables of a result: the regimes, each with the outputs that it judges.

    `dims` has their axes and `arrays` their values, by name.
    """
    apart = len(plan.verdicts) > 1
    return {
        one.name: TableVariable(
            dims[one.name],
            arrays[one.name],
            regime_attributes(one.regimes, one.outputs if apart else ()),
        )
        for one in plan.verdicts
    }


def _edge(name: str, value: float) -> float:
    return float(np.rad2deg(value)) if QUANTITIES[name].is_angle else value


def global_attributes(prepared: Prepared, how: str) -> dict[str, str]:
    """Return the attributes of a result that say where it is from: study, version, scene, drive.

    `how` says in words how it was computed, behind the version in `source`.
    """
    study, plan = prepared.study, prepared.plan
    attributes = {
        "Conventions": CONVENTIONS,
        "title": study.title or plan.scene.title,
        "source": f"vibrafeed {core.__version__}, {how}",
        "references": REFERENCES,
        "comment": plan.scene.validity,
        "scene": plan.scene.name,
        plan.scene.choice: plan.variant,
        "study": study.canonical(),
        "study_sha256": study.key(),
    }
    if isinstance(study, DrivenStudy) and study.drive is not None:
        attributes["drive"] = _origin(study.drive, study.values())
    if prepared.questions:
        attributes["warnings"] = "\n".join(prepared.questions)
    if study.notes:
        attributes["notes"] = study.notes
    if study.units:
        attributes["shown_units"] = ", ".join(study.units)
    return attributes


def _origin(drive: MeasuredDrive, values: Mapping[str, Values]) -> str:
    left = ", ".join(f"{axis} {100 * share:.2g} %" for axis, share in drive.left_over.items())
    told = f"fitted to {drive.name} (SHA-256 {drive.sha256}); left over {left}"
    if drive.clock_error is not None:
        told += f"; clock error {100 * drive.clock_error:.3g} %"
    others = [name for name, number in drive.numbers.items() if values.get(name) != Fixed(number)]
    return told + (f"; not from it {', '.join(others)}" if others else "")
