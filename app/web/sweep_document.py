"""The description of a sweep in the service: its study, size, axes, outputs."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field

from vibrafeed.app.web.replies import Document
from vibrafeed.core.dataset.table import regime_attributes
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES


class SweepAxis(BaseModel):
    """An axis of a sweep."""

    name: str
    unit: str
    size: int


class SweepOutput(BaseModel):
    """An output of a sweep, with the axes that it depends on."""

    name: str
    unit: str
    label: str
    dims: list[str]
    source: str | None


class SweepDescription(BaseModel):
    """The description of a sweep."""

    id: str
    study: Document
    scene: str
    variant: str
    validity: str
    cells: int
    bytes: int
    axes: list[SweepAxis]
    outputs: list[SweepOutput]
    regimes: list[str]
    shared: bool
    links: dict[str, str]
    warnings: list[str] = Field(
        default=[], description="Of unusual values, in the reply to a study that was sent"
    )


def description(key: str, sweep: Prepared, *, shared: bool) -> dict[str, Any]:
    """Return the JSON description of a sweep: study, size, axes, outputs, links.

    `key` is its identifier; `shared` is True if all keys may read it.
    """
    equations = {equation.gives: equation for equation in sweep.plan.equations}
    verdicts = sweep.plan.verdicts
    labels = {
        one.name: regime_attributes(one.regimes, one.outputs if len(verdicts) > 1 else ())[
            "long_name"
        ]
        for one in verdicts
    }
    return {
        "id": key,
        "study": sweep.study.content(),
        "scene": sweep.plan.scene.name,
        "variant": sweep.plan.variant,
        "validity": sweep.plan.scene.validity,
        "cells": sweep.cells,
        "bytes": sweep.bytes,
        "axes": [
            {"name": name, "unit": QUANTITIES[name].unit, "size": axis.size}
            for name, axis in sweep.grid.axes.items()
        ],
        "outputs": [
            {
                "name": name,
                "unit": sweep.units[name],
                "label": labels.get(name) or QUANTITIES[name].label,
                "dims": list(dims),
                "source": equations[name].source if name in equations else None,
            }
            for name, dims in sweep.dims.items()
        ],
        "regimes": list(sweep.plan.regimes),
        "shared": shared,
        "links": {
            name: f"/sweeps/{key}{end}"
            for name, end in (
                ("self", ""),
                ("slice", "/slice"),
                ("netcdf", "/netcdf"),
                ("zarr", "/zarr"),
            )
        },
    }
