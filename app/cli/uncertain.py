"""The result of a sensitivity study for a person: one design in words and tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vibrafeed.app.cli.console import say, table, tell
from vibrafeed.app.cli.units import format_number
from vibrafeed.core.dataset.regimes import percent_with_error
from vibrafeed.core.quantities import QUANTITIES

if TYPE_CHECKING:
    from vibrafeed.core.dataset import Table
    from vibrafeed.core.mechanics.arrays import Array
    from vibrafeed.core.study.shown import Shown, ShownUnits

COLUMNS = {
    "first": "first index",
    "total": "total index",
    "at_lower": "at lower end",
    "at_upper": "at upper end",
    "linear": "linear change",
    "variance_share": "share of variance",
}
"""What is told of each parameter, by the last part of its name, and its heading."""
SHARES = ("first", "total", "variance_share")
BESIDE = ("_error", "_distribution")
"""Variables that a short table leaves out."""


def is_uncertain(result: Table) -> bool:
    """True if a result comes from a sensitivity study, with uncertain parameters."""
    return "uncertain_parameters" in result.attributes


def is_short(name: str) -> bool:
    """True if a variable belongs to the short table of a study with many designs."""
    return not name.endswith(BESIDE)


def show_design(result: Table, units: ShownUnits) -> None:
    """Print a design with uncertain parameters: probabilities, and each output by parameter.

    `result` is a sensitivity study with a single cell, `units` those for printing.
    """
    for name, one in result.variables.items():
        if name.startswith("probability_") and not name.endswith("_error"):
            error = result.variables[f"{name}_error"].values.item()
            words = _demand_in_words(one.attributes, units)
            tell(f"  {words}: {percent_with_error(one.values.item(), error)}")
    for name in result.variables:
        if name.endswith("_left_out"):
            _show_output(result, name.removesuffix("_left_out"), units)


def _demand_in_words(attributes: Mapping[str, Any], units: ShownUnits) -> str:
    """Return the label of a probability, such as `probability of x at most 2 mm`.

    A sensitivity study computes it. `attributes` are those of its variable: a regime, or an output
    with the bounds `at_least` and `at_most`, in the units of files. `units` are those for printing.
    """
    if "regime" in attributes:
        return f"probability of {attributes['regime']}"
    output = str(attributes["output"])
    bounds = {key: float(attributes[key]) for key in ("at_least", "at_most") if key in attributes}
    shown = units.of(QUANTITIES[output].unit, max(map(abs, bounds.values())))
    told = (f"{key.replace('_', ' ')} {format_number(shown.factor * value)} {shown.unit}".rstrip()
            for key, value in bounds.items())  # fmt: skip
    return f"probability of {output} {' and '.join(told)}"


def _show_output(result: Table, output: str, units: ShownUnits) -> None:
    """Print mean, quantiles, Sobol indices and the tolerance budget of one output of a design.

    The budget says which share of the variance comes from which uncertain parameter. `result` is a
    sensitivity study with a single cell, `output` the name of the output; `units` are those for
    printing.
    """
    from vibrafeed.core.sensitivity.prepare import QUANTILE, UNCERTAIN

    columns = {
        name.removeprefix(f"{output}_"): column
        for name, column in result.variables.items()
        if name.startswith(f"{output}_")
    }
    left = columns["left_out"].values.item()
    if left == 1:
        tell(f"  {output}: no point has a valid value")
        return
    own = [
        column.values.ravel() for column in columns.values() if column.attributes["units"] != "1"
    ]
    every = np.abs(np.concatenate([*own, [0.0]]))
    size = float(every[np.isfinite(every)].max())
    unit = next((str(column.attributes["units"]) for column in columns.values()
                 if column.attributes["units"] != "1"), "1")  # fmt: skip
    shown = units.of(unit, size)
    parts = []
    for part in ("nominal", "mean", "deviation", "least", "largest"):
        if part in columns:
            error = columns.get(f"{part}_error")
            errors = None if error is None else error.values
            parts.append(f"{part} {_format_value(columns[part].values, shown, errors)}")
    say("")
    tell(f"  {' '.join(filter(None, (output, shown.unit and f'({shown.unit})')))}: "
         + ", ".join(parts))  # fmt: skip
    if QUANTILE in columns:
        shares = result.coordinates[QUANTILE].values
        values = columns[QUANTILE].values
        told = (
            f"{100 * q:g} % below {_format_value(v, shown)}"
            for q, v in zip(shares, values, strict=True)
        )
        tell(f"  {', '.join(told)}")
    if left > 0:
        tell(f"  {_percent(left)} of the points have no valid value, and count in no mean.")
    by_parameter = [part for part in COLUMNS if part in columns]
    if by_parameter:
        names = str(result.coordinates[UNCERTAIN].attributes["flag_meanings"]).split()
        rows = []
        for row, parameter in enumerate(names):
            cells = []
            for part in by_parameter:
                value, error = columns[part].values[row], columns.get(f"{part}_error")
                if part in SHARES:
                    width = None if error is None else float(error.values[row])
                    cells.append(percent_with_error(value, width))
                else:
                    cells.append(_format_value(value, shown))
            rows.append((parameter, *cells))
        headings = [COLUMNS[part] for part in by_parameter]
        table(("parameter", *headings), rows, right=headings)
    decides = columns.get("total", columns.get("variance_share"))
    if decides is not None and np.isfinite(decides.values).all() and len(rows) > 1:
        most = int(np.argmax(decides.values))
        tell(f"  {rows[most][0]} matters most: a narrower tolerance of it narrows {output} most.")


def _format_value(value: Array, shown: Shown, error: Array | None = None) -> str:
    """Return a value in the shown unit as text, with its error if given."""
    text = format_number(shown.factor * float(value))
    return text if error is None else f"{text} ± {format_number(shown.factor * float(error), 2)}"


def _percent(share: float) -> str:
    """Return a share in per cent as text."""
    return f"{format_number(100 * share, 3)} %"
