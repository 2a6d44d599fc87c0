"""The measurements of one family as arrays and notes: families can be measured apart and kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point
from vibrafeed.core.dataset.table import TableVariable
from vibrafeed.core.plan.pieces import Computed

MEASURED, MACHINE = "measured", "machine"  # among the notes
OF = ":"  # between a variable and its attribute that is an array


def keep(measured: Measured | None, machine: Mapping[str, str]) -> Computed:
    """Return a family of measurements, and facts on the machine, as arrays and texts to store.

    A job measures families apart, and its report joins them later (`kept` reads them back).

    Parameters
    ----------
    measured : Measured or None
        Curves, notes and values of single cells; None if the family does not apply.
    machine : mapping of str to str
        Machine, date and versions.
    """
    arrays: dict[str, NDArray[Any]] = {}
    content = None
    if measured is not None:
        cells = {}
        for name, variable in measured.cells.items():
            arrays[name] = variable.values
            plain = {}
            for key, value in variable.attributes.items():
                if isinstance(value, np.ndarray):
                    arrays[f"{name}{OF}{key}"] = value
                else:
                    plain[key] = value
            cells[name] = {"dims": variable.dims, "attributes": plain}
        content = {
            "family": measured.family,
            "curves": [asdict(curve) for curve in measured.curves],
            "notes": measured.notes,
            "cells": cells,
        }
    # Numbers that are none are written as Python does.
    return Computed(arrays, {MEASURED: json.dumps(content), MACHINE: json.dumps(dict(machine))})


def kept(computed: Computed) -> tuple[Measured | None, dict[str, str]]:
    """Return the measurements and the facts on the machine that `keep` has stored.

    `computed` has arrays and texts; the measurements are None if the family did not apply.
    """
    content = json.loads(computed.notes[MEASURED])
    machine: dict[str, str] = json.loads(computed.notes[MACHINE])
    if content is None:
        return None, machine
    arrays = computed.arrays
    cells = {}
    for name, one in content["cells"].items():
        start = f"{name}{OF}"
        found = {k.removeprefix(start): v for k, v in arrays.items() if k.startswith(start)}
        cells[name] = TableVariable(
            tuple(one["dims"]), arrays[name], {**one["attributes"], **found}
        )
    curves = tuple(
        Curve(**{**curve, "points": tuple(Point(**point) for point in curve["points"])})
        for curve in content["curves"]
    )
    return Measured(content["family"], curves, tuple(content["notes"]), cells), machine
