"""A labelled result before it becomes a file, an xarray dataset or a reply.

One place gives every variable its CF attributes; the views below only carry them over.
"""

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.quantities import QUANTITIES, REGIMES, Flag
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.quantities.quantity import in_sentence

if TYPE_CHECKING:
    import xarray

CONVENTIONS = "CF-1.11"
REFERENCES = (
    "J. Diaz Gonzalez, Dynamics of parts on narrow tracks using the multibody theory, M.S. thesis, "
    "2004"
)

Attributes = Mapping[str, Any]

_VALID = np.zeros(256, dtype=np.bool_)
_VALID[[flag.value for flag in REGIMES.values() if flag.valid]] = True


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

    def links(self, name: str) -> dict[str, str]:
        """Return the CF attribute that links a variable to its coordinates that are no axes.

        They are names in a text; `name` is that of a variable. The result may be empty.
        """
        dims = set(self.variables[name].dims)
        off_axis = [
            key for key, coordinate in self.coordinates.items() if coordinate.dims != (key,)
        ]
        linked = [key for key in off_axis if set(self.coordinates[key].dims) <= dims]
        return {"coordinates": " ".join(linked)} if linked else {}

    def with_price(self, price: Attributes) -> "Table":
        """Return the table with other attributes for the cost of computing it, such as seconds."""
        return replace(self, price=price)

    def with_history(self, history: str) -> "Table":
        """Return the table with the CF attribute `history`, and the cost, among its attributes."""
        return replace(
            self, attributes={**self.attributes, "history": history, **self.price}, price={}
        )

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
        dropped = tuple(
            position for position, dim in enumerate(regimes.dims) if dim not in output.dims
        )
        mask = is_valid(regimes.values).any(axis=dropped)
        sizes = dict(zip(output.dims, output.values.shape, strict=True))
        shape = [sizes[dim] if dim in regimes.dims else 1 for dim in output.dims]
        return np.broadcast_to(mask.reshape(shape), output.values.shape)

    @classmethod
    def of_xarray(cls, dataset: "xarray.Dataset") -> "Table":
        """Return a table with the coordinates, variables and attributes of an xarray dataset.

        Arrays are not copied, so that changes of values are seen in both.
        """

        def plain(arrays: "Mapping[Any, xarray.DataArray]") -> dict[str, TableVariable]:
            """Return variables of plain arrays."""
            return {
                str(name): TableVariable(
                    tuple(map(str, array.dims)), array.values, dict(array.attrs)
                )
                for name, array in arrays.items()
            }

        return cls(plain(dataset.coords), plain(dataset.data_vars), dict(dataset.attrs))

    def to_xarray(self) -> "xarray.Dataset":
        """Return the table as an xarray dataset, with its price among the attributes.

        Arrays are not copied, so that changes of values are seen in both.
        """
        import xarray  # heavy, and a file or a reply does not need it

        def in_xarray(variables: Mapping[str, TableVariable]) -> dict[str, Any]:
            """Return variables of xarray."""
            return {
                name: xarray.Variable(variable.dims, variable.values, dict(variable.attributes))
                for name, variable in variables.items()
            }

        return xarray.Dataset(
            in_xarray(self.variables),
            coords=in_xarray(self.coordinates),
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


def regime_attributes(names: tuple[str, ...], judged_outputs: Sequence[str] = ()) -> dict[str, Any]:
    """Return the CF flag attributes of a variable with the named regimes.

    `judged_outputs` are those for which it speaks; none are named if it is the only such variable.
    """
    attributes = flag_attributes("regime", REGIMES, names)
    if judged_outputs:
        labels = ", ".join(in_sentence(QUANTITIES[name].label) for name in judged_outputs)
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


# --- regimes: which one judges an output, where they are valid, shares of cells, words


def judge_of(attributes: Mapping[Any, Any], names: Container[Any]) -> str | None:
    """Return the name of the variable whose regimes judge an output; None if it always holds.

    It is the one that `ancillary_variables` of the output names.

    Parameters
    ----------
    attributes : mapping
        The attributes of the output.
    names : container of str
        The variables of the result.
    """
    linked = str(attributes.get("ancillary_variables", "")).split()
    judges = [name for name in linked if is_regime(name) and name in names]
    return judges[0] if judges else None


def is_valid(regimes: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Return a mask of the cells whose regime describes a real part, of the same shape."""
    return _VALID[regimes]


def regime_shares(regimes: NDArray[np.integer]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, 0 to 1, in the order of flag values.

    Every cell counts equally, whatever the spacing of the axes.

    Parameters
    ----------
    regimes : ndarray of int
        Values of a variable `regime`, any shape.
    """
    return {name: count / regimes.size for name, count in regime_counts(regimes).items()}


def regime_counts(regimes: NDArray[np.integer]) -> dict[str, int]:
    """Return the number of cells in each regime that occurs, by name, in the order of the flags."""
    numbers, counts = np.unique(regimes, return_counts=True)
    names = {flag.value: name for name, flag in REGIMES.items()}
    return {names[n]: c for n, c in zip(numbers.tolist(), counts.tolist(), strict=True)}


def flags_of(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """Return the word of each value of a flag variable, such as {1: "stick"}, by its CF attributes.

    The attributes are `flag_values` and `flag_meanings`; a variable without them has no words.
    """
    numbers = np.atleast_1d(attributes.get("flag_values", [])).tolist()
    return dict(zip(numbers, str(attributes.get("flag_meanings", "")).split(), strict=False))


def percent_with_error(share: float, error: float | None) -> str:
    """Return a sampled share in per cent with its error, rounded to the error.

    Both are from 0 to 1. An error of 0.27 % leaves one decimal, `92.2 % ± 0.3 %`; without an error
    there is one, too. A share that is NaN becomes a dash.
    """
    if not math.isfinite(share):
        return "-"
    decimals = 1
    if error is not None and math.isfinite(error) and error > 0:
        decimals = min(max(-math.floor(math.log10(100 * error)), 0), 3)
    text = f"{100 * share + 0.0:.{decimals}f}"
    text = text.removeprefix("-") if not float(text) else text
    return f"{text} %" if error is None else f"{text} % ± {100 * error:.{decimals}f} %"


def percent(share: float) -> str:
    """Return a share in per cent as text, with one more digit if it is small or nearly all."""
    if share < 0.0005:
        return "< 0.1\N{NO-BREAK SPACE}%"
    if 0.9945 <= share < 1:
        return f"{min(100 * share, 99.9):.1f}\N{NO-BREAK SPACE}%"
    return f"{100 * share:.{1 if share < 0.0995 else 0}f}\N{NO-BREAK SPACE}%"
