"""The result of a calibration on the console: findings, the unknowns, and the runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibrafeed.app.cli.console import say, table, tell
from vibrafeed.app.cli.units import format_number

if TYPE_CHECKING:
    from vibrafeed.core.dataset import Table
    from vibrafeed.core.study.shown import ShownUnits

DIGITS = 4  # significant digits of printed values
MAX_ROWS = 20  # runs that are printed; the file has all


def show_findings(result: Table, units: ShownUnits) -> None:
    """Print a calibration: unknowns with intervals, measured runs, and findings in sentences.

    `result` is the table of the calibration, `units` those for printing.
    """
    rows = []
    for name in str(result.attributes["unknowns"]).split():
        unit, (best, median, *ends) = _read_values(
            result,
            [f"{what}_{name}" for what in ("best", "median", "lower_68", "upper_68", "lower_95",
                                           "upper_95")],
            units,
        )  # fmt: skip
        rows.append(
            (name, best, median, f"{ends[0]} to {ends[1]}", f"{ends[2]} to {ends[3]}", unit)
        )
    table(("unknown", "best", "median", "68 %", "95 %", "unit"), rows)
    _show_runs(result, units)
    for sentence in str(result.attributes["findings"]).splitlines():
        tell(f"  {sentence}")


def _read_values(result: Table, names: list[str], units: ShownUnits) -> tuple[str, list[str]]:
    """Return a readable unit, and the texts of some single values of a result in it.

    `names` are variables without dimensions that have a common unit, `units` the units for
    printing.
    """
    values = [float(result.variables[name].values) for name in names]
    unit = str(result.variables[names[0]].attributes["units"])
    shown = units.of(unit, max(map(abs, values)))
    return shown.unit or "-", [format_number(value * shown.factor, DIGITS) for value in values]


def _show_runs(result: Table, units: ShownUnits) -> None:
    """Print measured and predicted value of each run, with the prediction's 95 % interval.

    `result` is the table of a calibration, `units` those for printing; at most 20 runs are printed.
    """
    output = str(result.attributes["output"])
    measured, predicted, low, high, over = (
        np.asarray(result.variables[name].values, dtype=np.float64)
        for name in (output, "predicted_best", "predicted_lower_95", "predicted_upper_95",
                     "residual_over_error")
    )  # fmt: skip
    shown = units.of(
        str(result.variables[output].attributes["units"]),
        float(np.nan_to_num(np.abs(np.concatenate([measured, predicted]))).max()),
    )

    def text(value: float) -> str:
        """Return a value in the shown unit as text; `-` for NaN."""
        return "-" if np.isnan(value) else format_number(value * shown.factor, DIGITS)

    rows = [
        (
            f"{k + 1}",
            text(measured[k]),
            text(predicted[k]),
            f"{text(low[k])} to {text(high[k])}",
            "-" if np.isnan(over[k]) else format_number(over[k], 2),
        )
        for k in range(min(len(measured), MAX_ROWS))
    ]
    unit = f" [{shown.unit}]" if shown.unit else ""
    table(("run", f"measured{unit}", f"predicted{unit}", "95 % of the posterior",
           "residual / error"), rows)  # fmt: skip
    if len(measured) > MAX_ROWS:
        say(f"  {len(measured) - MAX_ROWS:,} further runs stand in the file.")
