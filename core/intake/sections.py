"""The sections that studies have; a kind has those that are keys of its model."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from vibrafeed.core.errors import Problem, given_twice, refused
from vibrafeed.core.intake.part import PART
from vibrafeed.core.intake.section import (
    DRIVE,
    Content,
    Resolved,
    Section,
    Stranger,
    advice_on_path,
    dotted,
    file_beside,
    no_field,
    no_parameter,
)
from vibrafeed.core.quantities import QUANTITIES, WORDS, by_letters, letter_of
from vibrafeed.core.study.distributions import CALIBRATION
from vibrafeed.core.study.grid_study import CRITERIA, DRIVE_ANGLES, MAX_RUNS, OBSERVED, PARAMETERS
from vibrafeed.core.study.reduction import LevelSet, Reduction
from vibrafeed.core.study.units import BARE_NUMBER, UnitError, unit_factor
from vibrafeed.core.study.values import DESIGN
from vibrafeed.core.suggestions import nearest
from vibrafeed.core.tables.headings import stem_and_unit
from vibrafeed.core.tables.read import read_table
from vibrafeed.core.tables.table import Column
from vibrafeed.core.tables.text import is_value

# --- The section `observations`: rows of a study, or of a CSV or XLSX file with a heading.


OWN: Final = (*OBSERVED, "error", "regime")
"""Columns that are no parameters."""
_COLUMNS: Final = (*OWN, *PARAMETERS)
HEADING = "Add a first row with names and units, such as amplitude [mm], conveying_velocity [mm/s]"


def _with_rows(content: Content, files: bool) -> Resolved:
    observations = content["observations"]
    if not isinstance(observations, str):
        return Resolved(content)
    if not files:
        raise refused(
            "observations", "the service cannot read files", "Send the rows as a list of objects"
        )
    return Resolved({**content, "observations": read_rows(Path(observations))})


def read_rows(path: Path, section: str = "observations") -> list[dict[str, Any]]:
    """Return the rows of a table in a file, each a mapping by parameter or measured output.

    Numbers get the unit in the heading of their column, as texts; empty cells are left out, and so
    are columns of remarks. `section` is the key of the study that names the file. Raises
    `StudyError` if the file cannot be read, or has no rows or no names.
    """
    try:
        table = read_table(path, section)
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise refused(
            section,
            f"{path.name} cannot be read: {getattr(error, 'strerror', None) or error}",
            advice_on_path(
                path, "Give the path of a CSV or XLSX file, from the folder of the study"
            ),
        ) from error
    if all(map(BARE_NUMBER.fullmatch, table.columns)):
        raise refused(section, f"{path.name} has no row of column names", HEADING)
    columns: dict[str, Column] = {}
    for heading, column in table.columns.items():
        name, unit = letter_of(heading), column.unit
        stem, ending = stem_and_unit(heading)
        if name not in _COLUMNS and letter_of(stem) in _COLUMNS:
            name, unit = letter_of(stem), unit or ending
        if name in columns:
            message = f"{path.name} has two columns named {name[:60]}"
            raise refused(section, message, "Rename or remove one of the two columns")
        if name in _COLUMNS or not _is_of_remarks(name, column):
            columns[name] = replace(column, unit=unit)
    return replace(table, columns=columns).rows()[:MAX_ROWS]


MAX_ROWS = MAX_RUNS + 1  # of a table: more are refused where they are counted


_NUMBERS_OF_ROWS = ("design", "nr", "no", "number", "run", "row", "index", "id", "#")


def _is_of_remarks(name: str, column: Column) -> bool:
    # A misspelt name of a column of words is no remark.
    if name.casefold().strip(".") in _NUMBERS_OF_ROWS:
        return True
    filled_cells = [cell for cell in column.cells if str(cell).strip()]
    return not (any(is_value(str(cell)) for cell in filled_cells) or nearest(name, _COLUMNS))


def _all_columns(rows: Any) -> Iterable[str]:
    runs = (
        [row for row in rows if isinstance(row, Mapping)] if isinstance(rows, list | tuple) else []
    )
    return (name for row in runs for name in row)


def _columns_of_parameters(rows: Any, _: Collection[str]) -> Iterable[str]:
    return (name for name in _all_columns(rows) if name not in OWN)


def _measured(rows: Any) -> Iterable[str]:
    columns = {*_all_columns(rows)}
    # What all motions have, where only regimes were seen.
    return [name for name in OBSERVED if name in columns] or ["flight_fraction"]


def _problem_path(path: Sequence[Any]) -> str:
    if len(path) < 2:
        return dotted(path)
    return f"observations row {int(path[1]) + 1}" + "".join(f", {name}"[:60] for name in path[2:3])


def _unknown_column(stranger: Stranger) -> Problem:
    known, shown = (*OWN, *PARAMETERS), (*OWN, *stranger.parameters)
    return Problem(
        stranger.place,
        f"'{stranger.name}' is neither a parameter nor a measured value",
        stranger.suggest(stranger.name, known, shown),
    )


# --- The section `designs`: rows of a table, or lists of parameters, whose values belong together.


def paired(content: Any) -> tuple[Any, list[Problem]]:
    """Return the content of a study with designs as values of its parameters, and problems.

    A study lists designs as rows, or names lists of its parameters that are pairs, triples, ...;
    a file is left as it is. Designs of a calibration are candidates for the next run.
    """
    designs = content.get("designs") if isinstance(content, Mapping) else None
    rows: Any = designs.get("rows") if isinstance(designs, Mapping) else designs
    names = designs.get("zip") if isinstance(designs, Mapping) else None
    if not isinstance(rows, list | tuple) and not isinstance(names, list | tuple):
        return content, []
    section = "candidates" if content.get("kind") == "calibrate" else "parameters"
    parameters = content.get(section, {})
    parameters = parameters if isinstance(parameters, Mapping) else {}
    problems = []
    if isinstance(names, list | tuple):
        columns: dict[str, Any] = {
            letter_of(str(name)): parameters.get(str(name)) for name in names
        }
        problems += [
            Problem(
                "designs.zip",
                f"{name} is not a list of values",
                "Give a list with one value per design",
            )
            for name, values in columns.items()
            if not isinstance(values, list | tuple)
        ]
    else:
        row_tables = [row for row in rows if isinstance(row, Mapping)]
        columns = {
            str(name): [row.get(name) for row in row_tables] for row in row_tables for name in row
        }
        problems += [
            Problem(
                f"designs row {values.index(None) + 1}",
                f"this design has no {name}, but other designs have one",
                f"Give {name} in every design",
            )
            for name, values in columns.items()
            if None in values
        ]
        problems += given_twice(section, columns, "designs", parameters)
        if not columns:
            problems.append(
                Problem("designs", "the list of designs is empty", "Add at least one row")
            )
    others = {name: value for name, value in content.items() if name != "designs"}
    if problems:
        return others, problems
    pairs = {name: {DESIGN: values} for name, values in columns.items()}
    return {**others, section: {**parameters, **pairs}}, []


def _with_designs(content: Content, files: bool) -> Resolved:
    designs = content["designs"]
    if not isinstance(designs, Mapping) or set(designs) != {"file"}:
        return Resolved(content)
    if not files:
        raise refused("designs.file", "the service cannot read files", "Send rows = [...]")
    rows = read_rows(Path(str(designs["file"])), "designs")
    return Resolved(*paired({**content, "designs": rows}))


# --- The section `uncertain`: from the result of a calibration that a study names to its densities.


MAX_BYTES = 200_000_000  # of a result
DENSITY = "density_"
"""With the name of a parameter, the variable that holds its density."""


def _files_beside(uncertain: Any, move: Callable[[str], str]) -> Any:
    if not isinstance(uncertain, dict):
        return uncertain
    return {
        name: {**distribution, CALIBRATION: move(distribution[CALIBRATION])}
        if isinstance(distribution, dict) and isinstance(distribution.get(CALIBRATION), str)
        else distribution
        for name, distribution in uncertain.items()
    }


def with_posteriors(content: Content, files: bool) -> Resolved:
    """Return the content of a study with densities in place of calibration files, and problems.

    One whose file has a problem is left out. Unless `files` of this machine may be read the content
    stays as it is, and is refused later.
    """
    uncertain = content.get("uncertain")
    if not files or not isinstance(uncertain, Mapping):
        return Resolved(content)
    densities = {
        name: _density(str(name), raw[CALIBRATION])
        for name, raw in uncertain.items()
        if isinstance(raw, Mapping) and set(raw) == {CALIBRATION}
    }
    problems = [density for density in densities.values() if isinstance(density, Problem)]
    densities = {**uncertain, **densities}
    valid = {
        name: density for name, density in densities.items() if not isinstance(density, Problem)
    }
    return Resolved({**content, "uncertain": valid}, problems)


def _density(name: str, path: object) -> dict[str, list[float]] | Problem:
    from vibrafeed.core.dataset.read import read_netcdf  # few studies need it

    key = f"uncertain.{name}.{CALIBRATION}"
    fix = "Give the NetCDF file that `vibrafeed run` wrote for a study of kind 'calibrate'"
    if not isinstance(path, str):
        return Problem(key, "calibration is not the path of a file", fix)
    try:
        table = read_netcdf(Path(path), most_bytes=MAX_BYTES)
    except Exception as error:  # the library raises many kinds for damaged files
        return Problem(key, f"{path} cannot be read: {error}"[:300], advice_on_path(path, fix))
    density = table.variables.get(f"{DENSITY}{name}")
    is_parameter_axis = name in table.coordinates and name in QUANTITIES
    if density is None or density.dims != (name,) or not is_parameter_axis:
        densities_in_file = ", ".join(
            variable_name.removeprefix(DENSITY)
            for variable_name, variable in table.variables.items()
            if variable_name.startswith(DENSITY) and len(variable.dims) == 1
        )
        return Problem(
            key,
            f"{path} has no probability density of {name}",
            f"The file has densities of {densities_in_file}" if densities_in_file else fix,
        )
    axis, quantity = table.coordinates[name], QUANTITIES[name]
    unit = str(axis.attributes.get("units", quantity.unit))
    try:
        factor = float(unit_factor(name, quantity, unit))
    except UnitError as error:
        return Problem(key, f"{path}: {error.message}", error.fix)
    values = factor * np.asarray(axis.values, dtype=np.float64)
    densities = np.asarray(density.values, dtype=np.float64)
    if not (np.isfinite(densities).all() and (densities > 0).any()):
        return Problem(
            key,
            f"the posterior density of {name} in {path} is 0 everywhere",
            "Run the calibration again",
        )
    # Only the positive part counts, with one 0 at either end.
    positive = np.flatnonzero(densities > 0)
    used = slice(max(positive[0] - 1, 0), positive[-1] + 2)
    return {"values": values[used].tolist(), "densities": densities[used].tolist()}


def _parameter_names(parameters: Any, _: Collection[str]) -> Iterable[str]:
    return map(str, parameters) if isinstance(parameters, Mapping) else ()


def _variable_names(variables: Any, known: Collection[str]) -> Iterable[str]:
    is_given = isinstance(variables, Mapping)
    return map(str, variables) if is_given else (angle for angle in DRIVE_ANGLES if angle in known)


def _criterion_outputs(criterion: Any) -> Iterable[str]:
    keys = criterion if isinstance(criterion, Mapping) else {}
    names = (keys.get("output", "acceleration_x"), keys.get("against"))
    return (name for name in names if isinstance(name, str))


SECTIONS: Final[Mapping[str, Section]] = {
    "parameters": Section(names=_parameter_names, unknown=no_parameter, by_parameter=True),
    "uncertain": Section(
        names=_parameter_names, beside=_files_beside, resolve=with_posteriors, by_parameter=True
    ),
    "variables": Section(names=_variable_names, unknown=no_parameter, by_parameter=True),
    "unknowns": Section(names=_parameter_names, unknown=no_parameter, by_parameter=True),
    "offsets": Section(unknown=no_parameter, by_parameter=True),
    "factors": Section(unknown=no_parameter, by_parameter=True),
    "candidates": Section(unknown=no_parameter, by_parameter=True),
    "observations": Section(
        names=_columns_of_parameters,
        outputs=_measured,
        place=_problem_path,
        unknown=_unknown_column,
        beside=lambda rows, move: move(rows) if isinstance(rows, str) else rows,
        resolve=_with_rows,
    ),
    "designs": Section(names=lambda *_: (), beside=file_beside, resolve=_with_designs),
    "drive": DRIVE,
    "part": PART,
    "criterion": Section(outputs=_criterion_outputs, tags=CRITERIA),
    "outputs": Section(outputs=lambda names: names if isinstance(names, list | tuple) else ()),
    "reduce": Section(
        unknown=lambda key: no_field(key, LevelSet if len(key.path) > 2 else Reduction)
    ),
}
"""Every section by its key, in the order in which they are read."""


# --- The words for angles in a study: azimuth is alpha, elevation beta, climb gamma, lean delta.


def in_letters(content: Any) -> tuple[Any, list[Problem]]:
    """Return the content of a study with the letters of angles in place of their words.

    The problems are those of angles that a section gives twice, by word and by letter.
    """
    if not isinstance(content, Mapping):
        return content, []
    letters, problems = dict(content), list[Problem]()
    for key, raw in content.items():
        faults: list[Problem] = []
        if key in ("sensitivities", "reduce"):
            letters[key] = _reduction(raw) if isinstance(raw, Mapping) else _names(raw)
        elif key == "designs" and isinstance(raw, list | tuple):
            letters[key], faults = _rows(raw)
        elif key == "observations" and isinstance(raw, Mapping | list | tuple):
            letters[key], faults = _rows([raw] if isinstance(raw, Mapping) else raw)
        elif key in SECTIONS and SECTIONS[key].by_parameter and isinstance(raw, Mapping):
            letters[key], faults = by_letters(raw, f"{key}.")
        problems += faults
    return letters, problems


def words_in(content: Any) -> dict[str, str]:
    """Return the words by which a study names angles, by letter, without those it names by both."""
    sections = content.items() if isinstance(content, Mapping) else ()
    names = {
        name
        for key, raw in sections
        if key in SECTIONS
        for table in (raw if isinstance(raw, list | tuple) else (raw,))
        if isinstance(table, Mapping)
        for name in table
    }
    return {letter: word for word, letter in WORDS.items() if {word, letter} & names == {word}}


def _rows(rows: list[Any] | tuple[Any, ...]) -> tuple[list[Any], list[Problem]]:
    # Rows with letters in place of the words of angles, and the problems of the first row with any.
    rows_and_faults: list[tuple[Any, list[Problem]]] = [
        by_letters(row, f"observations row {number}, ")
        if isinstance(row, Mapping) and not WORDS.keys().isdisjoint(row)
        else (row, [])
        for number, row in enumerate(rows, 1)
    ]
    return [row for row, _ in rows_and_faults], next(
        (faults for _, faults in rows_and_faults if faults), []
    )


def _reduction(raw: Mapping[str, Any]) -> dict[str, Any]:
    # Letters in place of the words of angles, which stand in `over` and in `along` of each level.
    letters = {name: _names(part) if name == "over" else part for name, part in raw.items()}
    levels = raw.get("levels")
    if isinstance(levels, Mapping):
        letters["levels"] = {
            name: {key: _names(part) if key == "along" else part for key, part in level.items()}
            if isinstance(level, Mapping)
            else level
            for name, level in levels.items()
        }
    return letters


def _names(raw: Any) -> Any:
    if isinstance(raw, list | tuple):
        return [*map(_names, raw)]
    return letter_of(raw) if isinstance(raw, str) else raw
