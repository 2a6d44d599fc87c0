"""A dataset in the units in which a person reads it."""

from typing import TYPE_CHECKING

import numpy as np

from vibrafeed.core.study.shown import ShownUnits

if TYPE_CHECKING:
    import xarray


def in_shown_units(dataset: "xarray.Dataset", units: ShownUnits) -> "xarray.Dataset":
    """Return a copy of a dataset in units for reading, such as mm/s; flags are unchanged.

    `units` chooses the unit of each variable by its unit in the dataset and its largest value.
    """
    changed = {}
    for name, array in dataset.variables.items():
        if "units" not in array.attrs or array.dtype.kind not in "fiu":
            continue
        sizes = np.abs(np.asarray(array.values, dtype=np.float64))
        shown = units.of(str(array.attrs["units"]), float(sizes[np.isfinite(sizes)].max(initial=0)))
        values = array.values if shown.factor == 1 else array.values * shown.factor
        changed[name] = (array.dims, values, {**array.attrs, "units": shown.unit})
    return dataset.assign(changed)
