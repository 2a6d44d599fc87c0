"""`vibrafeed lookup`: speeds read from an atlas."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, Json, Units
from vibrafeed.app.cli.studies import refuse, refuse_existing, warn
from vibrafeed.core.errors import Problem, StudyError, VibrafeedError

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table

MAX_SHOWN = 20  # rows on the screen
WAYS = (
    ("stick", "sticks"),
    ("forward", "slides forward"),
    ("backward", "slides backward"),
    ("flight", "is in the air"),
)


def lookup(
    assignments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE]...",
            help='Parameters of the motion to look up, as in a study: frequency="50 Hz" '
            'amplitude="0.4 mm" beta=25 '
            "friction=0.3.",
        ),
    ] = None,
    atlas: Annotated[
        Path,
        typer.Option(
            "--atlas", help="Atlas to look the values up in: a file written by `vibrafeed atlas`."
        ),
    ] = Path("atlas.nc"),
    rows: Annotated[
        Path | None,
        typer.Option(
            help="CSV file of cases to look up: one row per case, one column per "
            "parameter. A heading may name a unit, as in amplitude [mm]. NAME=VALUE "
            "then applies to all rows."
        ),
    ] = None,
    simulate: Annotated[
        bool,
        typer.Option("--simulate", help="Simulate the cases for which the atlas has no value."),
    ] = False,
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            help="Write the values looked up to this file; its suffix sets the format: "
            ".csv, .nc or "
            "another one.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Look up speed, regime and shares of motion in an atlas, each with its error.

    The atlas answers inside a regime and in the range of its axes, and says where it does not. Exit
    code 1 means that it did not answer everything, 2 that a parameter or a file is wrong.
    """
    from vibrafeed.app.cli.units import units_asked
    from vibrafeed.core.atlas.lookup import advice

    shown = units_asked(units)
    table = _look_up_or_exit(atlas, assignments or [], rows, simulate=simulate)
    if output is not None:
        _write(table, output, force=force)
    lines = advice(table)
    if as_json:
        console.document(_to_document(table) | {"advice": lines})
    else:
        if table.variables["lookup_status"].values.size == 1:
            _show_single(table, shown)
        elif output is None:
            _show_many(table, shown)
        for line in lines:
            console.tell(f"  {line}")
    if output is not None:
        typer.echo(f"wrote {output}", err=as_json)
    if lines:
        raise typer.Exit(FAILED)


def _look_up_or_exit(
    path: Path, assignments: list[str], rows: Path | None, *, simulate: bool
) -> Table:
    """Return the table of atlas values for the typed parameters; print every problem and exit.

    Parameters
    ----------
    path : Path
        The atlas.
    assignments : list of str
        Parameters typed as `name=value`.
    rows : Path or None
        CSV file with a case a row; the typed parameters are then for all rows.
    simulate : bool
        Whether cells without a value in the atlas are simulated.
    """
    from vibrafeed.core.atlas.lookup import lookup_grid, lookup_rows
    from vibrafeed.core.atlas.read import MAKE, open_atlas
    from vibrafeed.core.atlas.rows import read_rows
    from vibrafeed.core.study.unusual import questions

    source = rows or Path("lookup")
    refused: dict[Path, list[Problem]] = {}
    parameters, problems = _parse_assignments(assignments)
    if problems:
        refused[Path("lookup")] = problems
    columns: Mapping[str, tuple[float, ...]] = {}
    try:
        if rows is not None:
            columns = read_rows(rows)
    except StudyError as error:
        refused[source] = [*refused.get(source, []), *error.problems]
    except OSError as error:
        message = f"it cannot be read: {error.strerror or error}"
        refused[source] = [Problem("rows", message, "Name a CSV")]
    try:
        opened = open_atlas(path)
    except FileNotFoundError:
        refused[path] = [Problem("atlas", "the atlas file does not exist", MAKE)]
    except OSError as error:
        message = f"it cannot be read: {error.strerror or error}"
        refused[path] = [Problem("atlas", message, MAKE)]
    except VibrafeedError as error:
        refused[path] = [Problem("atlas", str(error).rstrip("."), MAKE)]
    if refused:
        refuse(refused)
    try:
        if rows is None:
            looked_up = lookup_grid(opened, parameters, simulate=simulate)
        else:
            looked_up = lookup_rows(opened, columns, parameters, simulate=simulate)
    except StudyError as error:
        refuse({source: error.problems})
    warn("lookup", questions({"parameters": {**columns, **parameters}}))
    return looked_up


def _parse_assignments(assignments: list[str]) -> tuple[dict[str, str | float], list[Problem]]:
    """Return typed `name=value` words as parameters by name, and the problems found.

    A value that is a number becomes one; others stay text, such as "50 Hz".
    """
    from vibrafeed.core.quantities import letter_of

    parameters: dict[str, str | float] = {}
    problems = []
    for text in assignments:
        written, sign, value = (part.strip() for part in text.partition("="))
        name = letter_of(written)
        if not sign:
            problems.append(Problem(text[:60], "it has no value", "Write name=value"))
        elif name in parameters:
            problems.append(Problem(written[:60], "it is given twice", "Give it once"))
        else:
            try:
                parameters[name] = float(value)
            except ValueError:
                parameters[name] = value
    return parameters, problems


def _write(table: Table, output: str, *, force: bool) -> None:
    """Write the table of a look-up in an atlas to a file, in the format of the suffix.

    `output` is the path. The command exits with a message if the file exists and `force` is False,
    if the suffix is unknown, or if the file cannot be written. Missing folders are made.
    """
    from vibrafeed.app.cli.targets import check_suffix, make_folder_of, write_or_exit

    check_suffix(output)
    refuse_existing("lookup", output, force=force)
    make_folder_of(output)
    history = f"{datetime.now(UTC).isoformat(timespec='seconds')} vibrafeed lookup"
    write_or_exit(Path("lookup"), table, output, history)


def _flag_words(table: Table, name: str) -> list[str]:
    """Return the words of a flag variable, such as the regime of each row."""
    from vibrafeed.core.dataset.frame import FrameColumn

    return [str(word) for word in FrameColumn(name, table.variables[name]).values.ravel()]


def _show_single(table: Table, shown: Any) -> None:
    """Print the looked-up values of a single part and drive: speed, regime, shares of the period.

    `shown` holds the units for printing.
    """
    from vibrafeed.app.cli.units import format_number
    from vibrafeed.core.atlas.numbers import AXES

    def value(name: str) -> float:
        """Return the value of a variable as a number."""
        return float(table.variables[name].values.ravel()[0])

    status = _flag_words(table, "lookup_status")[0]
    if status in ("answered", "simulated"):
        speed, error = value("conveying_velocity"), value("conveying_velocity_error")
        unit = shown.of("m s-1", abs(speed))
        how = "by simulation" if status == "simulated" else "from the atlas"
        console.say(
            f"  speed   {format_number(unit.factor * speed)} {unit.unit}, "
            f"stated error {format_number(unit.factor * error, 2)} {unit.unit}, {how}"
        )
        console.say(f"  regime  {_flag_words(table, 'regime')[0].replace('_', ' ')}")
        shares = [
            f"{word} {100 * value(f'{name}_fraction'):.1f} %"
            for name, word in WAYS
            if value(f"{name}_fraction") > 0
        ]
        console.tell(f"  shares  {', '.join(shares)} of the period")
    else:
        console.say(f"  no speed: {status.replace('_', ' ')}")
    console.tell(f"  numbers {', '.join(f'{name} {format_number(value(name))}' for name in AXES)}")


def _show_many(table: Table, shown: Any) -> None:
    """Print the first rows of a look-up of many parts: parameters, speed, error, regime, status.

    `table` is the result of the look-up in an atlas; `shown` gives the units for printing. At most
    `MAX_SHOWN` rows are printed.
    """
    import numpy as np

    from vibrafeed.app.cli.units import format_number
    from vibrafeed.core.dataset.frame import Frame

    speeds = table.variables["conveying_velocity"].values
    unit = shown.of("m s-1", float(np.nanmax(np.abs(speeds), initial=0.0)))
    frame = Frame.of(table)
    names = [
        c.name for c in frame.columns if c.variable.dims and c.name in _parameter_columns(table)
    ]
    answered = ("conveying_velocity", "conveying_velocity_error", "regime", "lookup_status")
    columns = {
        c.name: frame.piece(c, 0, MAX_SHOWN) for c in frame.columns if c.name in (*names, *answered)
    }
    has_value = [bool(np.isfinite(speed)) for speed in columns[answered[0]]]
    rows = [
        (
            *(format_number(float(columns[name][k])) for name in names),
            format_number(unit.factor * float(columns[answered[0]][k])),
            format_number(unit.factor * float(columns[answered[1]][k]), 2),
            str(columns["regime"][k]).replace("_", " ") if has_value[k] else "-",
            str(columns["lookup_status"][k]).replace("_", " "),
        )
        for k in range(min(frame.rows, MAX_SHOWN))
    ]
    headings = (*names, f"speed [{unit.unit}]", "error", "regime", "status")
    console.table(headings, rows, right=headings[:-2])
    if frame.rows > MAX_SHOWN:
        console.say(f"  and {frame.rows - MAX_SHOWN:,} more: write them all with -o speeds.csv")


def _parameter_columns(table: Table) -> list[str]:
    """Return the names of the columns that distinguish the rows of a look-up.

    They are its parameters, or the number of the row in a file.
    """
    from vibrafeed.core.atlas.lookup import ROW

    if ROW in table.coordinates:
        return [ROW]
    return list(table.coordinates)


def _to_document(table: Table) -> dict[str, Any]:
    """Return the result of a look-up in an atlas as plain values, for the option `--json`.

    `table` is the result. The document has a description of the atlas, and a list of values for
    each coordinate and variable, in the units of files; flags such as `regime` are words.
    """
    columns = {**table.coordinates, **table.variables}
    plain = {
        name: (_flag_words(table, name) if "flag_values" in one.attributes else one.values.tolist())
        for name, one in columns.items()
    }
    return {"atlas": table.attributes["atlas"], "values": plain}
