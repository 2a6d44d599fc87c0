"""Look-ups as a user writes them: parameters with units in, labelled speeds and shares out."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.atlas.cells import regime_of
from vibrafeed.core.atlas.find import LOOKUP_STATUSES, STATUS, AtlasValues, find
from vibrafeed.core.atlas.numbers import AXES, numbers_of
from vibrafeed.core.atlas.read import Atlas, open_atlas
from vibrafeed.core.atlas.rows import read_rows
from vibrafeed.core.dataset.table import (
    CONVENTIONS,
    REFERENCES,
    Table,
    TableVariable,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.intake.keywords import check_not_paired, plain
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.drives import shape_of
from vibrafeed.core.motion.groups import Groups, groups_of, table
from vibrafeed.core.motion.methods.events import EVENTS, planar_motion
from vibrafeed.core.motion.prepare import Simulation, prepare
from vibrafeed.core.motion.result import SHARES
from vibrafeed.core.plan.equations import regimes_of
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.labels import coordinates_of
from vibrafeed.core.quantities import QUANTITIES, by_letters
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.study import SimulateStudy
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.study.units import UnitError, read_numbers
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.study.values import Fixed, read_values
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    import xarray

SCENE: Final = "rectangle-on-plane"
OUTPUTS: Final = ("conveying_velocity", "conveying_velocity_error", "regime")
ROW: Final = "row"

Known = dict[str, Any]


def lookup(
    atlas: Atlas | str | os.PathLike[str],
    /,
    *,
    rows: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    simulate: bool = False,
    **parameters: Any,
) -> xarray.Dataset:
    """Return the values of an atlas for parts and drives: speeds, regimes, shares, with errors.

    The atlas holds for a block that moves in the plane of the track and does not rebound. What it
    does not answer, near the border of a regime or outside its range, has no speed (NaN) and a
    `lookup_status` that says so. Warns of values that are allowed and unusual.

    Parameters
    ----------
    atlas : Atlas or path
        What `vibrafeed atlas` wrote, or `open_atlas` returned: to read it once for many look-ups.
    rows : path or mapping, optional
        A CSV file with a parameter a column, or columns as arrays in the units of studies or with a
        unit of their own: each row is a case of its own. Keywords are then for all rows.
    simulate : bool
        Whether what the atlas does not answer is followed exactly.
    **parameters
        As in a study of motion: numbers, texts with units, lists, ranges.

    Returns
    -------
    xarray.Dataset
        Over the axes of the parameters, or over `row`.

    Raises
    ------
    StudyError
        With every problem of the parameters.
    VibrafeedError
        If the file is no atlas.

    Examples
    --------
    >>> found = vibrafeed.lookup(  # doctest: +SKIP
    ...     "atlas.nc", frequency="50 Hz", amplitude="0.4 mm", beta=25, friction=[0.3, 0.4]
    ... )
    >>> found.conveying_velocity.values.round(4)  # doctest: +SKIP
    array([0.0437, 0.0494])

    >>> try:
    ...     vibrafeed.lookup("other.nc", frequency=50, amplitude=4e-4, beta=25, friction=0.3)
    ... except FileNotFoundError:
    ...     print("vibrafeed atlas -o other.nc makes it")
    vibrafeed atlas -o other.nc makes it
    """
    opened = atlas if isinstance(atlas, Atlas) else open_atlas(atlas)
    check_not_paired(parameters)
    written = {name: plain(value, f"parameters.{name}") for name, value in parameters.items()}
    values, problems = by_letters(written, "parameters.")
    _refuse(problems)
    columns: Mapping[str, Any] = {}
    if rows is None:
        looked_up = lookup_grid(opened, values, simulate=simulate)
    else:
        if isinstance(rows, str | os.PathLike):
            columns = read_rows(Path(rows))
        else:
            given, problems = by_letters(plain(rows, "rows"), "rows.")
            _refuse(problems)
            columns = _columns(given)
        looked_up = lookup_rows(opened, columns, values, simulate=simulate)
    for question in questions({"parameters": {**columns, **values}}):
        warnings.warn(question, stacklevel=2)
    return looked_up.to_xarray()


def _columns(rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the columns of rows that a program gives, as numbers in the units of studies.

    `rows` has numbers, or texts with a unit such as those of arrays that carry one. Raises
    `StudyError` for values that are none of their parameter; other names are reported later.
    """
    columns, problems = dict(rows), []
    for name, values in rows.items():
        if name in PARAMETERS and not {*map(type, values)} <= {int, float}:
            try:
                columns[name] = read_numbers(name, QUANTITIES[name], values)
            except UnitError as error:
                problems.append(Problem(f"rows.{name}", error.message, error.fix))
    if problems:
        raise StudyError(problems)
    return columns


def lookup_grid(atlas: Atlas, parameters: Mapping[str, Any], *, simulate: bool = False) -> Table:
    """Look up the motion of parts in an atlas, for all combinations of parameter values.

    The table has one dimension for each parameter with several values.

    Parameters
    ----------
    atlas : Atlas
        The atlas.
    parameters : mapping
        Parameters by name, as in a study of motion: numbers, texts with units, lists, ranges.
    simulate : bool
        True to simulate cells for which the atlas has no value; otherwise they are NaN.

    Raises
    ------
    StudyError
        With every problem of the parameters.
    """
    prepared = _prepare_simulation(parameters)
    known = _before_motion(prepared, prepared.grid.si())
    shape = tuple(prepared.grid.shape.values())
    coordinates = coordinates_of(prepared.plan, prepared.grid)
    return _look_up_cells(
        atlas, prepared, known, tuple(prepared.grid.axes), shape, coordinates, simulate
    )


def lookup_rows(
    atlas: Atlas,
    columns: Mapping[str, Iterable[float]],
    parameters: Mapping[str, Any] | None = None,
    *,
    simulate: bool = False,
) -> Table:
    """Look up the motion of parts in an atlas for rows, each a part and a drive of its own.

    The table has the dimension `row`, numbered from 1.

    Parameters
    ----------
    atlas : Atlas
        The atlas.
    columns : mapping of str to iterable of float
        Parameters that differ between rows, in the units of studies, all of one length and not
        empty.
    parameters : mapping, optional
        Parameters that all rows share, one value each.
    simulate : bool
        True to simulate rows for which the atlas has no value; otherwise they are NaN.

    Raises
    ------
    StudyError
        With every problem of the parameters.
    """
    arrays = {name: np.asarray(tuple(values), dtype=np.float64) for name, values in columns.items()}
    shared = dict(parameters or {})
    problems = [
        Problem(
            f"parameters.{name}",
            f"{name} is given twice: as a parameter for all rows, and as a column of the rows",
            "Leave out the parameter or the column",
        )
        for name in shared
        if name in arrays
    ]
    problems += [
        Problem(
            f"parameters.{name}",
            f"{name} has several values, but a parameter that all rows share has one",
            f"Give one value, or make {name} a column of the rows",
        )
        for name, values in _readable(shared, shared).items()
        if values.ndim
    ]
    problems += _of_values(arrays)
    # Every row has the same plan: the first one's.
    first = {name: float(values[0]) for name, values in arrays.items() if values.size}
    try:
        prepared = _prepare_simulation({**shared, **first})
    except StudyError as error:
        raise StudyError([*problems, *error.problems]) from None
    _refuse(problems)
    rows = next(iter(arrays.values())).size
    si = prepared.grid.si()
    si |= {name: parameter_to_si(name, values) for name, values in arrays.items()}
    known = _before_motion(prepared, si)
    about = {"long_name": "Row", "units": "1"}
    coordinates = {ROW: TableVariable((ROW,), np.arange(1, rows + 1), about)}
    table = {
        name: TableVariable((ROW,), values, quantity_attributes(name))
        for name, values in arrays.items()
    }
    found = _look_up_cells(atlas, prepared, known, (ROW,), (rows,), coordinates, simulate)
    return Table(found.coordinates, {**table, **found.variables}, found.attributes)


def advice(looked_up: Table) -> list[str]:
    """Return sentences on the cells of a look-up for which the atlas has no value, with a remedy.

    `looked_up` is the table of a look-up, with its status and the four numbers of the atlas. The
    list is empty if every cell has a value.
    """
    status = looked_up.variables["lookup_status"].values
    lines = []
    near = int((status == STATUS["near_border"]).sum())
    if near:
        lines.append(
            f"{_cells(near)} near the border of a regime, where the atlas does not interpolate."
        )
    outside = status == STATUS["out_of_range"]
    for name, axis in AXES.items():
        values = looked_up.variables[name].values[outside]
        beyond = values[~((values >= axis.least) & (values <= axis.largest))]
        if beyond.size:
            lines.append(
                f"{_cells(beyond.size)} outside the atlas: the {name} {_span(beyond)}, and the "
                f"atlas goes from {axis.least:g} to {axis.largest:g}. It is {axis.definition}."
            )
    if lines:
        lines.append(
            "Follow them exactly: add --simulate (in Python simulate=True), or run a study of kind "
            "simulate."
        )
    return lines


def _cells(count: int) -> str:
    """Return a number of cells with the verb, such as `2 cells are`."""
    return "1 cell is" if count == 1 else f"{count:,} cells are"


def _span(values: NDArray[np.float64]) -> str:
    """Return the range of some values in words, such as ``is 0.1 to 0.3``; NaN left out."""
    known = values[~np.isnan(values)]
    if not known.size:
        return "has no value"
    least, largest = f"{known.min():.4g}", f"{known.max():.4g}"
    return f"is {least}" if least == largest else f"is {least} to {largest}"


def _prepare_simulation(parameters: Mapping[str, Any]) -> Simulation:
    """Return the prepared simulation of the parameters of a look-up.

    A look-up uses its checks, its grid, and its formulas from parameters to dimensionless groups.
    `parameters` are those of a study of motion, by name.

    Raises
    ------
    StudyError
        With every problem of the parameters. Those for which no atlas holds are problems, too:
        rebounds, drives across the track, other waveforms than a sine.
    """
    content = {
        "kind": "simulate",
        "scene": SCENE,
        "method": "events",
        "outputs": [*OUTPUTS[:2], *(f"{name}_fraction" for name in SHARES)],
        "parameters": dict(parameters),
    }
    problems = _of_values(_readable(parameters, ("restitution", "alpha")))
    try:
        study = parse_study(content)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    assert isinstance(study, SimulateStudy)
    shape, _ = shape_of(study.values())
    if shape is not None:
        message = "an atlas holds for the plain sine along a line"
        fix = "Give frequency, amplitude and beta, or simulate this drive"
        problems.append(Problem("parameters", message, fix))
    try:
        prepared = prepare(study)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    _refuse(problems)
    return prepared


def _readable(
    parameters: Mapping[str, Any], names: Iterable[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the values of the named parameters as arrays in the units of studies.

    `parameters` are as a user writes them: numbers, texts with units, ranges. A name that is not
    among them, is no parameter, or has an invalid value is left out: parsing the study reports
    that.
    """
    columns = {}
    for name in names:
        with suppress(UnitError):
            if name in parameters and name in PARAMETERS:
                values = read_values(name, parameters[name])
                columns[name] = np.array(
                    values.value if isinstance(values, Fixed) else values.array()
                )
    return columns


def _of_values(arrays: Mapping[str, NDArray[np.float64]]) -> list[Problem]:
    """Return the problems of parameter values for which no atlas holds: rebound and azimuth.

    `arrays` holds parameter values of any shape, by name, restitution without unit and the azimuth
    `alpha` in degrees; both have to be 0 or absent.
    """
    problems = []
    if np.any(arrays.get("restitution", 0.0)):
        message = "an atlas holds for parts that do not rebound: restitution 0"
        fix = "Leave it out, or simulate a part that rebounds"
        problems.append(Problem("parameters.restitution", message, fix))
    if np.any(arrays.get("alpha", 0.0)):
        message = "an atlas holds for motion in the plane of the track: alpha 0"
        fix = "Leave it out, or simulate a part that is pushed across the track"
        problems.append(Problem("parameters.alpha", message, fix))
    return problems


def _refuse(problems: list[Problem]) -> None:
    """Raise `StudyError` if there are problems."""
    if problems:
        raise StudyError(problems)


def _before_motion(prepared: Simulation, parameters: Mapping[str, Array]) -> Known:
    """Return the quantities that a look-up needs before any motion is simulated, in SI units.

    These are defaults and parameters of the plan, and the results of its quick equations, such as
    the dimensionless groups and the velocity scale.

    Parameters
    ----------
    prepared : Simulation
        The simulation whose plan is used.
    parameters : mapping of str to ndarray
        Values of the plan's parameters in SI units; their shapes broadcast.
    """
    known: Known = {name: np.asarray(value) for name, value in prepared.plan.defaults.items()}
    known |= {name: parameters[name] for name in prepared.plan.parameters}
    for equation in prepared.plan.equations:
        if not equation.takes_long and all(name in known for name in equation.inputs):
            known[equation.gives] = equation.function(
                **{name: known[name] for name in equation.inputs}
            )
    return known


def _look_up_cells(
    atlas: Atlas,
    prepared: Simulation,
    known: Known,
    dims: tuple[str, ...],
    shape: tuple[int, ...],
    coordinates: Mapping[str, TableVariable],
    simulate: bool,
) -> Table:
    """Return the table of a look-up: mean velocity, its error, regime, status and shares of cells.

    The four numbers of the atlas of each cell are variables, too.

    Parameters
    ----------
    atlas : Atlas
        The atlas.
    prepared : Simulation
        The simulation of the same parameters, which defines the regimes.
    known : mapping of str to Any
        The quantities that it computes before the motion: the dimensionless `groups` and
        `velocity_scale` [m/s]; they broadcast to `shape`.
    dims, shape : tuple
        Names and lengths of the dimensions of the cells.
    coordinates : mapping of str to TableVariable
        The coordinates of the table.
    simulate : bool
        True to simulate cells for which the atlas has no value; otherwise they are NaN.
    """
    groups: Groups = known["groups"]
    rows, _ = table((*groups.numbers, np.zeros(shape)))
    flat, _ = groups_of(rows[:, :-1], waved=False)
    numbers, unit = numbers_of(flat)
    entry = _in_way(find(atlas, numbers), unit)
    velocity, error = entry.velocity * np.abs(unit), entry.error * np.abs(unit)
    regime, status = regime_of(entry.pattern), entry.status
    shares = {name: getattr(entry, name) for name in SHARES}
    left = np.flatnonzero(status != STATUS["answered"]) if simulate else np.array([], dtype=int)
    if left.size:
        some, _ = groups_of(rows[left, :-1], waved=False)
        motion = planar_motion(some, **EVENTS.defaults, watch=Watch())
        velocity[left], error[left] = motion.velocity, motion.error
        regime[left] = regimes_of(prepared.plan.verdicts[:1], {"motion": motion})[REGIME]
        status[left] = STATUS["simulated"]
        entry.share_error[left] = 0.0
        for name in SHARES:
            shares[name][left] = getattr(motion, name)
    scale = np.broadcast_to(known["velocity_scale"], shape).ravel()

    def laid_out(values: NDArray[Any], attributes: Mapping[str, Any]) -> TableVariable:
        """Return a variable of the look-up in the shape of the cells."""
        return TableVariable(dims, values.reshape(shape), attributes)

    variables = {
        "conveying_velocity": laid_out(velocity * scale, quantity_attributes("conveying_velocity")),
        "conveying_velocity_error": laid_out(
            error * scale, quantity_attributes("conveying_velocity_error")
        ),
        "regime": laid_out(regime, regime_attributes(prepared.plan.verdicts[0].regimes)),
        "lookup_status": laid_out(status, _status_attributes()),
        **{
            f"{name}_fraction": laid_out(values, quantity_attributes(f"{name}_fraction"))
            for name, values in shares.items()
        },
        "share_error": laid_out(
            entry.share_error, {"units": "1", "long_name": "Stated error of each share"}
        ),
        **{
            name: laid_out(values, AXES[name].attributes())
            for name, values in zip(AXES, numbers, strict=True)
        },
    }
    return Table(coordinates, variables, _attributes(atlas))


def _in_way(values: AtlasValues, unit: Array) -> AtlasValues:
    """Return looked-up values in the axes of the track, where the drive may push backwards.

    The atlas holds drives that push forwards only. `unit` is the speed that velocities are
    multiples of, shape (n,); where it is below 0, the drive is the mirror image: velocities change
    their sign, and the shares of sliding forwards and backwards change places.
    """
    back = unit < 0
    return values._replace(
        velocity=np.where(back, -values.velocity, values.velocity) + 0.0,
        forward=np.where(back, values.backward, values.forward),
        backward=np.where(back, values.forward, values.backward),
    )


def _status_attributes() -> dict[str, Any]:
    """Return the CF attributes of the variable `lookup_status`, the status of each cell.

    They name the integer values of the flag, such as near the border of a regime or out of range.
    """
    return {
        "long_name": "Status of the look-up",
        "standard_name": "status_flag",
        "flag_values": np.array([flag.value for flag in LOOKUP_STATUSES.values()], dtype=np.int8),
        "flag_meanings": " ".join(LOOKUP_STATUSES),
        "comment": "; ".join(f"{n}: {flag.description}" for n, flag in LOOKUP_STATUSES.items()),
    }


def _attributes(atlas: Atlas) -> dict[str, Any]:
    """Return the global CF attributes of the table of a look-up in an atlas.

    They name the atlas, its resolution and version, and the model of its errors.
    """
    made = atlas.attributes
    return {
        "Conventions": CONVENTIONS,
        "title": "Look-up in an atlas of planar motion without restitution",
        "source": f"vibrafeed {core.__version__}, look-up in an atlas",
        "references": REFERENCES,
        "comment": made["comment"],
        "atlas": f"{made['resolution']}, version {made['atlas_version']}, {made['source']}",
        "error_model": made["error_model"],
    }
