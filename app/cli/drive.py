"""`vibrafeed drive`: the drive that a recording of an accelerometer shows."""

import functools
import re
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.console import needing
from vibrafeed.app.cli.options import FAILED, Json, Units
from vibrafeed.app.cli.studies import refuse, warn, write_text
from vibrafeed.core.errors import Problem, StudyError

if TYPE_CHECKING:
    from vibrafeed.core.measured import Fit, Recording, RingDown

_OPTION = re.compile(r"--([a-z-]+) = ")
_LIST = re.compile(r'\[("[^\]]*")\]')
COLUMN = (
    "Name or number of the column with the motion {}; a minus sign before the name reverses it."
)


def drive(
    recording: Annotated[
        Path,
        typer.Argument(
            help="File of the recording: CSV, XLSX, LVM, MAT, WAV, TDMS or UFF.",
            show_default=False,
        ),
    ],
    along: Annotated[str | None, typer.Option(help=COLUMN.format("along the track"))] = None,
    normal: Annotated[
        str | None, typer.Option(help=COLUMN.format("normal to the track, upwards"))
    ] = None,
    across: Annotated[
        str | None, typer.Option(help=COLUMN.format("across the track, to the left"))
    ] = None,
    sensor: Annotated[
        str | None,
        typer.Option(
            help="Names of the three columns of a triaxial sensor (axes x, y, z), as in ax,ay,az, "
            "instead of --along, --normal and --across."
        ),
    ] = None,
    mounting: Annotated[
        str | None,
        typer.Option(
            help="How a triaxial sensor is turned against the track: yaw, pitch and roll "
            "in degrees, as in 0,0,90."
        ),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            help="Unit of the columns, instead of that in their headings: g, mg, m s-2 or mm s-2 "
            "for accelerations; mm/s for velocities; mm or um for displacements; V or mV with "
            "--sensitivity."
        ),
    ] = None,
    sensitivity: Annotated[
        str | None,
        typer.Option(
            help="Sensitivity of the sensor if the columns are voltages or counts, as in "
            "'100 mV/g' or '16384 counts/g'."
        ),
    ] = None,
    scale: Annotated[
        str | None,
        typer.Option(help="Full scale of a WAV file, as in '8 g', or '5 V' with --sensitivity."),
    ] = None,
    rate: Annotated[
        str | None,
        typer.Option(help="Samples per second; needed if the recording has no time column."),
    ] = None,
    time: Annotated[
        str | None,
        typer.Option(
            help="Name of the recording's time column; by default the column named time, t, "
            "timestamp, elapsed, Zeit, temps, tiempo, tempo or X_Value, or the only column with "
            "a unit of time."
        ),
    ] = None,
    line_frequency: Annotated[
        str | None,
        typer.Option(
            help="True frequency of the drive in Hz, if known; the fit then reports the "
            "error of the recorder's clock."
        ),
    ] = None,
    frequency: Annotated[
        str | None,
        typer.Option(
            help="Approximate frequency of the recorded motion in Hz; by default it is "
            "found from the recording."
        ),
    ] = None,
    harmonics: Annotated[
        int | None,
        typer.Option(
            help="Number of harmonics of the drive to fit; by default as many as the "
            "recording can resolve."
        ),
    ] = None,
    ring_down: Annotated[
        bool,
        typer.Option(
            "--ring-down",
            help="Fit the free vibration after a knock on the feeder: natural frequency and "
            "damping ratio.",
        ),
    ] = False,
    loaded: Annotated[
        Path | None,
        typer.Option(
            help="With --ring-down: a second recording, with --added-mass on the feeder, from "
            "which the moving mass is computed."
        ),
    ] = None,
    added_mass: Annotated[
        str | None, typer.Option(help="With --loaded: the mass that was added, as in '2 kg'.")
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(
            help="Draw the recording and the fitted drive to this file: .png, .svg or .pdf."
        ),
    ] = None,
    toml: Annotated[
        bool,
        typer.Option(
            "--toml", help="Print only the fitted drive parameters, as TOML lines for a study."
        ),
    ] = False,
    units: Units = None,
    as_json: Json = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write the fitted drive parameters to this TOML file."),
    ] = None,
) -> None:
    """Fit the harmonics of a drive, with errors, to a recording of a sensor on the track.

    Exit code 2 means that the recording or an option is wrong, 1 that a file could not be written.
    """
    from vibrafeed.app.cli.drives import document_of, show_fit, show_ring_down, toml_of
    from vibrafeed.app.cli.units import units_asked
    from vibrafeed.core.intake.section import channel_questions
    from vibrafeed.core.measured import Recording
    from vibrafeed.core.study.unusual import questions_of_drive

    shown = units_asked(units)
    options = Recording(
        along=along,
        across=across,
        normal=normal,
        sensor=_split_list(sensor),  # type: ignore[arg-type] # their number is checked by the reader
        mounting=_split_list(mounting),  # type: ignore[arg-type]
        unit=unit,
        sensitivity=sensitivity,
        scale=scale,
        rate=rate,
        time=time,
        line_frequency=line_frequency,
        frequency=frequency,
        harmonics=harmonics,
    )
    if ring_down:
        free_vibration, mass = _fit_ring_down(recording, options, loaded, added_mass, plot)
        lines = show_ring_down(recording, free_vibration, mass, toml=toml, as_json=as_json)
        if output is not None:
            _write(output, lines, quiet=toml or as_json)
        return
    fit = _fit_recording(recording, options, plot)
    warn(recording, questions_of_drive(fit.parameters(), recording.name) + channel_questions(fit))
    lines = toml_of(fit, recording)
    if toml:
        typer.echo(lines)
    elif as_json:
        console.document(document_of(fit, recording))
    else:
        show_fit(fit, recording, shown)
    if output is not None:
        _write(output, lines, quiet=toml or as_json)
    if plot is None:
        return
    from vibrafeed.core.plots.drawing import save
    from vibrafeed.core.plots.measured import draw_fit

    try:
        save(draw_fit(fit), plot)
    except OSError as error:
        console.fail(f"{error.filename or recording}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    typer.echo(f"wrote {plot}", err=toml or as_json)


def _write(output: Path, lines: str, *, quiet: bool) -> None:
    """Write the lines of a TOML file, and say so; exit with a message if that is not possible."""
    write_text(output, lines + "\n")
    typer.echo(f"wrote {output}", err=quiet)


def _fit_ring_down(
    recording: Path,
    options: "Recording",
    loaded: Path | None,
    added_mass: str | None,
    plot: Path | None,
) -> "tuple[RingDown, tuple[float, float] | None]":
    """Return the free vibration in a recording, and the moving mass with its error [kg], if known.

    `loaded` is the recording with `added_mass` on the feeder; `plot` is refused. Prints every
    problem and exits if there is one.
    """
    from vibrafeed.core.measured import fit_ring_down, moving_mass

    problems: dict[Path, list[Problem]] = {recording: []}
    if plot is not None:
        problems[recording].append(
            Problem("--plot", "a ring-down cannot be drawn", "Remove --plot")
        )
    if (loaded is None) != (added_mass is None):
        message = "--loaded and --added-mass need each other"
        problems[recording].append(Problem("--loaded", message, "Give both or neither"))
    fits = []
    for file in filter(None, (recording, loaded)):
        try:
            fits.append(fit_ring_down(file, options))
        except StudyError as error:
            named = map(_name_options, error.problems)
            problems[file] = [*problems.get(file, []), *named]
        except OSError as error:
            message = f"the file cannot be read: {error.strerror or error}"
            problems[file] = [Problem("recording", message, "Give the path of a recording")]
    invalid = {file: listed for file, listed in problems.items() if listed}
    if invalid:
        refuse(invalid)
    try:
        mass = None if added_mass is None else moving_mass(fits[0], fits[1], added_mass)
        return fits[0], mass
    except StudyError as error:
        refuse({recording: [replace(problem, place="--added-mass") for problem in error.problems]})


def _split_list(text: str | None) -> tuple[str, ...] | None:
    """Return the entries of a list that was typed with commas; None if the option was not given."""
    return None if text is None else tuple(part.strip() for part in text.split(","))


def _fit_recording(recording: Path, options: "Recording", plot: Path | None) -> "Fit":
    """Return the drive fitted to a recording; print every problem and exit if there is one.

    `options` holds the columns and options of the recording; `plot` is the file of the picture, if
    one is wanted.
    """
    from vibrafeed.core.measured import fit_drive
    from vibrafeed.core.tables.read import read_table

    problems = _problems_of_picture(plot)
    try:
        if not (options.along or options.across or options.normal or options.sensor):
            columns = ", ".join(read_table(recording).columns)
            fix = "Give --along and --normal, or --sensor with three columns"
            problems.append(
                Problem(
                    "--along",
                    f"no column is given; the recording has the columns {columns}",
                    fix,
                )
            )
            refuse({recording: problems})
        fit = fit_drive(recording, options)
    except StudyError as error:
        problems += error.problems
    except OSError as error:
        message = f"the file cannot be read: {error.strerror or error}"
        problems.append(Problem("recording", message, "Give the path of a recording"))
    if problems:
        refuse({recording: [_name_options(problem) for problem in problems]})
    return fit


@functools.cache
def _recording_keys() -> tuple[str, ...]:
    from vibrafeed.core.measured import Recording

    return tuple(field.name for field in fields(Recording) if field.name != "slopes")


@functools.cache
def _key_pattern() -> re.Pattern[str]:
    names = "|".join(_recording_keys())
    # A key within a sentence: `rate = `, `leave rate out`, `the key rate`, or `(rate)`.
    return re.compile(
        rf"\b(?:{names})(?= = | out\b)|(?<=the key )(?:{names})\b|(?<=\()(?:{names})(?=\))"
        r"|\bline_frequency\b"
    )


def _name_options(problem: Problem) -> Problem:
    """Return a problem that names options of the command where it named keys of a study."""
    key, dot, rest = problem.place.partition(".")
    place = f"--{key.replace('_', '-')}" if key in _recording_keys() else key
    message, fix = map(_replace_keys, (problem.message, problem.fix))
    return replace(problem, place=place + dot + rest, message=message, fix=fix)


def _replace_keys(text: str) -> str:
    """Return a text with options in place of keys of a study: ``--rate=`` for ``rate =``."""
    text = _key_pattern().sub(lambda match: f"--{match[0].replace('_', '-')}", text)
    text = _OPTION.sub(r"--\1=", text.replace("the key --", "--"))
    # `["a", "b"]`, as TOML has it, becomes `a,b`.
    return _LIST.sub(lambda match: match[1].replace('"', "").replace(" ", ""), text)


def _problems_of_picture(plot: Path | None) -> list[Problem]:
    """Return the problem of a picture whose suffix names no format, if it is one.

    Exits if matplotlib is missing.
    """
    from vibrafeed.core.plots.pictures import PlotError

    if plot is None:
        return []
    with needing("plot", "matplotlib"):
        from vibrafeed.core.plots.drawing import check_format
    try:
        check_format(plot)
    except PlotError as error:
        return [Problem("--plot", error.problem.message, error.problem.fix)]
    return []
