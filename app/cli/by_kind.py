"""The results of calibrations, sensitivities and optimisations without a solution, for a person."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vibrafeed.app.cli.console import is_muted, progress, say, table, tell
from vibrafeed.app.cli.units import DIGITS, format_number
from vibrafeed.core.dataset.table import percent_with_error
from vibrafeed.core.intake import parse_json
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table, TableVariable
    from vibrafeed.core.mechanics.arrays import Array
    from vibrafeed.core.study.shown import Shown, ShownUnits


# --- calibrations

MAX_ROWS = 20  # runs that are printed; the file has all
STATISTICS = ("best", "median", "lower_68", "upper_68", "lower_95", "upper_95")
"""The statistics of an unknown, of which each is a variable such as `lower_68_friction`."""


def show_findings(result: "Table", units: "ShownUnits") -> None:
    """Print a calibration: findings in sentences, unknowns with intervals, and measured runs."""
    for sentence in str(result.attributes["findings"]).splitlines():
        tell(f"  {sentence}")
    rows = []
    for name in str(result.attributes["unknowns"]).split():
        unit, (best, median, lower_68, upper_68, lower_95, upper_95) = _read_values(
            result, [f"{statistic}_{name}" for statistic in STATISTICS], units
        )
        intervals = f"{lower_68} to {upper_68}", f"{lower_95} to {upper_95}"
        rows.append((name, best, median, *intervals, unit))
    table(("unknown", "best", "median", "68 %", "95 %", "unit"), rows)
    _show_runs(result, units)


def _read_values(result: "Table", names: list[str], units: "ShownUnits") -> tuple[str, list[str]]:
    """Return the unit for printing, and the values of single variables, of one unit, as texts."""
    values = [float(result.variables[name].values) for name in names]
    unit = str(result.variables[names[0]].attributes["units"])
    shown = units.of(unit, max(map(abs, values)))
    return shown.unit or "-", [format_number(value * shown.factor, DIGITS) for value in values]


def _show_runs(result: "Table", units: "ShownUnits") -> None:
    output = str(result.attributes["output"])
    measured, predicted, low, high, residuals = (
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
            f"{run + 1}",
            text(measured[run]),
            text(predicted[run]),
            f"{text(low[run])} to {text(high[run])}",
            "-" if np.isnan(residuals[run]) else f"{residuals[run]:.1f}",
        )
        for run in range(min(len(measured), MAX_ROWS))
    ]
    unit = f" [{shown.unit}]" if shown.unit else ""
    table(("run", f"measured{unit}", f"predicted{unit}", "95 % of the posterior",
           "residual / error"), rows)  # fmt: skip
    if len(measured) > MAX_ROWS:
        say(f"  {len(measured) - MAX_ROWS:,} further runs stand in the file.")


# --- optimisations without a solution


def format_value(name: str, value: float, units: "ShownUnits") -> str:
    """Return a value with its unit as readable text."""
    shown = units.of(QUANTITIES[name].unit, abs(value))
    gap = "" if shown.unit in ("", "°") else " "
    return f"{format_number(shown.factor * value)}{gap}{shown.unit}"


def describe_nearest(result: "Table", units: "ShownUnits", deadline: float | None) -> list[str]:
    """Return lines on an optimisation without solution: the nearest designs, and possible changes.

    Each says by how much a limit is missed while all others are kept, or which change would let all
    be kept, or a missed target be reached. The search takes a while; the result is empty if it is
    skipped by Ctrl-C, or not needed. `deadline` is the time of `time.monotonic` at which to stop
    [s].
    """
    has_missed = has_status(result, "target_missed")
    is_solved = not has_missed and not has_status(result, "infeasible")
    if is_muted() or is_solved or set(result.variables["optimum_status"].dims) - {"front"}:
        return []
    from vibrafeed.core.optimise import reach as search  # few runs need it

    tell("  Searching for the nearest designs; Ctrl-C skips the search ...")
    try:
        study = parse_json(str(result.attributes["study"]))
        with progress("nearest designs") as advance:
            watch = Watch(advance, deadline=deadline).part(0.5)
            designs = [] if has_missed else search.nearest(study, watch)
            changes = search.ways(study, watch)
    except KeyboardInterrupt:
        return []
    lines = []
    for design in designs:
        side = "at most" if design.upper else "at least"
        bound = format_value(design.output, design.bound, units)
        value = format_value(design.output, design.value, units)
        lines.append(
            f"Nearest: {design.output} {value} ({side} {bound} "
            f"{_CONTACTS.get(design.name, 'is asked')}) with all other limits kept, at "
            f"{list_choice(design.choice, units)}."
        )
    for change in changes:
        value = format_value(change.output, change.value, units)
        lines.append(
            f"With {change.change}: {change.output} {value} and all limits kept, at "
            f"{list_choice(change.choice, units)}."
        )
    return lines


_CONTACTS = {
    "floor_contact": "keeps the part on the floor: throw number at most 1",
    "wall_contact": "keeps the part on the wall",
}


def list_choice(choice: Mapping[str, float], units: "ShownUnits") -> str:
    """Return `name value unit` of each chosen variable, separated by commas."""
    return ", ".join(f"{name} {format_value(name, value, units)}" for name, value in choice.items())


def has_status(result: "Table", name: str) -> bool:
    """True if a table is the result of an optimisation in which all designs ended with a status.

    `name` is a key of `OPTIMUM_STATUSES`. A table of another kind of study gives False.
    """
    status = result.variables.get("optimum_status")
    return status is not None and bool(np.all(status.values == OPTIMUM_STATUSES[name].value))


# --- sensitivities

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


def is_uncertain(result: "Table") -> bool:
    """True if a result comes from a sensitivity study, with uncertain parameters."""
    return "uncertain_parameters" in result.attributes


def is_short(name: str) -> bool:
    """True if a variable belongs to the short table of a study with many designs."""
    return not name.endswith(BESIDE)


def show_design(result: "Table", units: "ShownUnits") -> None:
    """Print a design with uncertain parameters: probabilities, and each output by parameter."""
    for name, variable in result.variables.items():
        if name.startswith("probability_") and not name.endswith("_error"):
            error = result.variables[f"{name}_error"].values.item()
            label = _demand_in_words(variable.attributes, units)
            tell(f"  {label}: {percent_with_error(variable.values.item(), error)}")
    for name in result.variables:
        if name.endswith("_left_out"):
            _show_output(result, name.removesuffix("_left_out"), units)


def _demand_in_words(attributes: Mapping[str, Any], units: "ShownUnits") -> str:
    """Return the label of a probability, such as `probability of x at most 2 mm`.

    `attributes` are those of its variable in a sensitivity study: a regime, or an output with the
    bounds `at_least` and `at_most`, in the units of files.
    """
    if "regime" in attributes:
        return f"probability of {attributes['regime']}"
    output = str(attributes["output"])
    bounds = {key: float(attributes[key]) for key in ("at_least", "at_most") if key in attributes}
    shown = units.of(QUANTITIES[output].unit, max(map(abs, bounds.values())))
    texts = (
        f"{key.replace('_', ' ')} {format_number(shown.factor * bound)} {shown.unit}".rstrip()
        for key, bound in bounds.items()
    )
    return f"probability of {output} {' and '.join(texts)}"


def _show_output(result: "Table", output: str, units: "ShownUnits") -> None:
    """Print mean, quantiles, Sobol indices and tolerance budget of an output of a single design.

    The budget says which share of the variance comes from which uncertain parameter.
    """
    from vibrafeed.core.sensitivity.prepare import QUANTILE

    columns = {
        name.removeprefix(f"{output}_"): column
        for name, column in result.variables.items()
        if name.startswith(f"{output}_")
    }
    left_out = columns["left_out"].values.item()
    if left_out == 1:
        tell(f"  {output}: no point has a valid value")
        return
    # Sobol indices and shares have the unit 1; the other columns have that of the output.
    in_unit = [column for column in columns.values() if column.attributes["units"] != "1"]
    sizes = np.abs(np.concatenate([*(column.values.ravel() for column in in_unit), [0.0]]))
    unit = str(in_unit[0].attributes["units"]) if in_unit else "1"
    shown = units.of(unit, float(sizes[np.isfinite(sizes)].max()))
    statistics = []
    for name in ("nominal", "mean", "deviation", "least", "largest"):
        if name in columns:
            error = columns.get(f"{name}_error")
            errors = None if error is None else error.values
            statistics.append(f"{name} {_with_error(columns[name].values, shown, errors)}")
    say("")
    heading = f"{output} ({shown.unit})" if shown.unit else output
    tell(f"  {heading}: {', '.join(statistics)}")
    if QUANTILE in columns:
        quantiles = (
            f"{100 * level:g} % below {_with_error(value, shown)}"
            for level, value in zip(
                result.coordinates[QUANTILE].values, columns[QUANTILE].values, strict=True
            )
        )
        tell(f"  {', '.join(quantiles)}")
    if left_out > 0:
        tell(f"  {_percent(left_out)} of the points have no valid value, and count in no mean.")
    if any(name in columns for name in COLUMNS):
        _show_influences(result, output, columns, shown)


def _show_influences(
    result: "Table", output: str, columns: "Mapping[str, TableVariable]", shown: "Shown"
) -> None:
    """Print Sobol indices, changes and shares of the variance of an output, a row a parameter."""
    from vibrafeed.core.sensitivity.prepare import UNCERTAIN

    parameters = str(result.coordinates[UNCERTAIN].attributes["flag_meanings"]).split()
    names = [name for name in COLUMNS if name in columns]
    rows = []
    for row, parameter in enumerate(parameters):
        cells = []
        for name in names:
            value, error = columns[name].values[row], columns.get(f"{name}_error")
            if name in SHARES:
                width = None if error is None else float(error.values[row])
                cells.append(percent_with_error(value, width))
            else:
                cells.append(_with_error(value, shown))
        rows.append((parameter, *cells))
    headings = [COLUMNS[name] for name in names]
    table(("parameter", *headings), rows, right=headings)
    influences = columns.get("total", columns.get("variance_share"))
    if influences is not None and np.isfinite(influences.values).all() and len(parameters) > 1:
        first = parameters[int(np.argmax(influences.values))]
        tell(f"  {first} matters most: a narrower tolerance of it narrows {output} most.")


def _with_error(value: "Array", shown: "Shown", error: "Array | None" = None) -> str:
    text = format_number(shown.factor * float(value))
    return text if error is None else f"{text} ± {format_number(shown.factor * float(error), 2)}"


def _percent(fraction: float) -> str:
    return f"{format_number(100 * fraction, 3)} %"
