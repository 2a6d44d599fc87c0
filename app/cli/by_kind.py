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
    from vibrafeed.core.dataset.table import Table
    from vibrafeed.core.mechanics.arrays import Array
    from vibrafeed.core.study.shown import Shown, ShownUnits


# --- calibrations

MAX_ROWS = 20  # runs that are printed; the file has all


def show_findings(result: "Table", units: "ShownUnits") -> None:
    """Print a calibration: findings in sentences, unknowns with intervals, and measured runs.

    `result` is the table of the calibration, `units` those for printing.
    """
    for sentence in str(result.attributes["findings"]).splitlines():
        tell(f"  {sentence}")
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


def _read_values(result: "Table", names: list[str], units: "ShownUnits") -> tuple[str, list[str]]:
    """Return a readable unit, and the texts of some single values of a result in it.

    `names` are variables without dimensions that have a common unit, `units` the units for
    printing.
    """
    values = [float(result.variables[name].values) for name in names]
    unit = str(result.variables[names[0]].attributes["units"])
    shown = units.of(unit, max(map(abs, values)))
    return shown.unit or "-", [format_number(value * shown.factor, DIGITS) for value in values]


def _show_runs(result: "Table", units: "ShownUnits") -> None:
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
            "-" if np.isnan(over[k]) else f"{over[k]:.1f}",
        )
        for k in range(min(len(measured), MAX_ROWS))
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


def nearest(result: "Table", units: "ShownUnits", deadline: float | None) -> list[str]:
    """Return lines on an optimisation without solution: the nearest designs, and possible changes.

    Each says by how much a limit is missed while all others are kept, or which change would let all
    be kept, or a missed target be reached. The search takes a while; the result is empty if it is
    skipped by Ctrl-C, or not needed. `result` is the table of the optimisation, `units` are those
    for printing, `deadline` is the time of `time.monotonic` at which to stop [s].
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
            reaches = [] if has_missed else search.nearest(study, watch)
            others = search.ways(study, watch)
    except KeyboardInterrupt:
        return []
    lines = []
    for reach in reaches:
        bound = format_value(reach.output, reach.bound, units)
        lines.append(
            f"Nearest: {reach.output} {format_value(reach.output, reach.value, units)} "
            f"({'at most' if reach.upper else 'at least'} {bound} "
            f"{_CONTACTS.get(reach.name, 'is asked')}) with all other limits kept, at "
            f"{list_choice(reach.choice, units)}."
        )
    for way in others:
        value = format_value(way.output, way.value, units)
        lines.append(
            f"With {way.change}: {way.output} {value} and all limits kept, at "
            f"{list_choice(way.choice, units)}."
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


def _demand_in_words(attributes: Mapping[str, Any], units: "ShownUnits") -> str:
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


def _show_output(result: "Table", output: str, units: "ShownUnits") -> None:
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
            parts.append(f"{part} {_with_error(columns[part].values, shown, errors)}")
    say("")
    tell(f"  {' '.join(filter(None, (output, shown.unit and f'({shown.unit})')))}: "
         + ", ".join(parts))  # fmt: skip
    if QUANTILE in columns:
        shares = result.coordinates[QUANTILE].values
        values = columns[QUANTILE].values
        told = (
            f"{100 * q:g} % below {_with_error(v, shown)}"
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
                    cells.append(_with_error(value, shown))
            rows.append((parameter, *cells))
        headings = [COLUMNS[part] for part in by_parameter]
        table(("parameter", *headings), rows, right=headings)
    decides = columns.get("total", columns.get("variance_share"))
    if decides is not None and np.isfinite(decides.values).all() and len(rows) > 1:
        most = int(np.argmax(decides.values))
        tell(f"  {rows[most][0]} matters most: a narrower tolerance of it narrows {output} most.")


def _with_error(value: "Array", shown: "Shown", error: "Array | None" = None) -> str:
    text = format_number(shown.factor * float(value))
    return text if error is None else f"{text} ± {format_number(shown.factor * float(error), 2)}"


def _percent(share: float) -> str:
    return f"{format_number(100 * share, 3)} %"
