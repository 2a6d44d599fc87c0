"""A labelled result before it becomes a file, an xarray dataset or a reply.

One place gives every variable its CF attributes; the views below only carry them over.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import is_valid, judge_of
from vibrafeed.core.quantities import QUANTITIES, REGIMES, Flag
from vibrafeed.core.quantities.quantity import in_sentence

if TYPE_CHECKING:
    import xarray

CONVENTIONS = "CF-1.11"
REFERENCES = (
    "J. Diaz Gonzalez, Dynamics of parts on narrow tracks using the multibody theory, M.S. thesis, "
    "2004"
)

Attributes = Mapping[str, Any]


@dataclass(frozen=True)
class TableVariable:
    """An array with the names of its dimensions and its attributes."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attributes: Attributes


@dataclass(frozen=True)
class Table:
    """Variables over coordinates, as CF sees them.

    Attributes
    ----------
    coordinates : mapping of str to Variable
        The axes (each over itself), and the fixed parameters (without dimension).
    variables : mapping of str to Variable
        The outputs, and the flag variables that judge them (`ancillary_variables` names these).
    attributes : mapping
        Global attributes.
    price : mapping
        Global attributes that differ from run to run: what it cost. Files that equal studies share
        leave them out.
    """

    coordinates: Mapping[str, TableVariable]
    variables: Mapping[str, TableVariable]
    attributes: Attributes
    price: Attributes = field(default_factory=dict)

    def with_price(self, price: Attributes) -> Table:
        """Return the table with other attributes for the cost of computing it, such as seconds."""
        return replace(self, price=price)

    def valid(self, name: str) -> NDArray[np.bool_] | None:
        """Return a mask of the cells in which an output is valid; None if no regime judges it.

        It has the shape of the output `name`. Where the regime has further axes, an output is valid
        if it is so anywhere on them.
        """
        output = self.variables[name]
        judge = judge_of(output.attributes, self.variables)
        if judge is None or judge == name:
            return None
        regimes = self.variables[judge]
        dropped = tuple(k for k, dim in enumerate(regimes.dims) if dim not in output.dims)
        mask = is_valid(regimes.values).any(axis=dropped)
        sizes = dict(zip(output.dims, output.values.shape, strict=True))
        shape = [sizes[dim] if dim in regimes.dims else 1 for dim in output.dims]
        return np.broadcast_to(mask.reshape(shape), output.values.shape)

    @classmethod
    def of_xarray(cls, dataset: xarray.Dataset) -> Table:
        """Return a table with the coordinates, variables and attributes of an xarray dataset.

        Arrays are not copied, so that changes of values are seen in both.
        """

        def plain(arrays: Mapping[Any, xarray.DataArray]) -> dict[str, TableVariable]:
            """Return variables of plain arrays."""
            return {
                str(name): TableVariable(tuple(map(str, a.dims)), a.values, dict(a.attrs))
                for name, a in arrays.items()
            }

        return cls(plain(dataset.coords), plain(dataset.data_vars), dict(dataset.attrs))

    def to_xarray(self) -> xarray.Dataset:
        """Return the table as an xarray dataset, with its price among the attributes.

        Arrays are not copied, so that changes of values are seen in both.
        """
        import xarray  # heavy, and a file or a reply does not need it

        def view(variables: Mapping[str, TableVariable]) -> dict[str, Any]:
            """Return variables of xarray."""
            return {
                name: xarray.Variable(v.dims, v.values, dict(v.attributes))
                for name, v in variables.items()
            }

        return xarray.Dataset(
            view(self.variables),
            coords=view(self.coordinates),
            attrs={**self.attributes, **self.price},
        )


def quantity_attributes(name: str, **extra: str) -> dict[str, Any]:
    """Return the CF attributes of a quantity in a result: unit, label, symbol and description.

    `name` is a key of `QUANTITIES`, such as `frequency`; `extra` are further attributes.
    """
    quantity = QUANTITIES[name]
    return {
        "units": quantity.unit,
        "long_name": quantity.label,
        "symbol": quantity.symbol,
        "comment": quantity.description,
        **extra,
    }


def regime_attributes(names: tuple[str, ...], judged: Sequence[str] = ()) -> dict[str, Any]:
    """Return the CF flag attributes of a variable with the named regimes.

    `judged` are the outputs for which it speaks; none are named if it is the only such variable.
    """
    attributes = flag_attributes("regime", REGIMES, names)
    if judged:
        labels = ", ".join(in_sentence(QUANTITIES[name].label) for name in judged)
        attributes["long_name"] += f" of {labels}"
    return attributes


def flag_attributes(
    variable: str, flags: Mapping[str, Flag], names: tuple[str, ...]
) -> dict[str, Any]:
    """Return the CF flag attributes of a variable, which give each value a name.

    Parameters
    ----------
    variable : str
        The quantity whose label is taken.
    flags : mapping of str to Flag
        All flags by name, with value and description.
    names : tuple of str
        The flags that may occur in the variable.
    """
    ordered = sorted(names, key=lambda name: flags[name].value)
    legend = "; ".join(f"{name}: {flags[name].description}" for name in ordered)
    return {
        "long_name": QUANTITIES[variable].label,
        "standard_name": "status_flag",
        "flag_values": np.array([flags[name].value for name in ordered], dtype=np.int8),
        "flag_meanings": " ".join(ordered),
        "comment": legend,
    }
