"""The description of a recording by its user, and the track accelerations that it then holds."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.measured.times import LEAST_SAMPLES, Times, read_times
from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.quantities.quantity import angle
from vibrafeed.core.study.grid_study import MAX_SAMPLES_ONCE
from vibrafeed.core.study.units import UnitError, problem, read_number, unit_factor
from vibrafeed.core.tables.files import FULL_SCALE
from vibrafeed.core.tables.headings import stem_and_unit
from vibrafeed.core.tables.read import read_table
from vibrafeed.core.tables.table import InputTable

# --- Detects a channel that was driven beyond its range.

RUN = 3  # equal samples in a row that a clipped crest holds
CREST = 4.0  # samples at an extreme value over those at the next: more is no crest
VISITS = 12  # fewest samples of the extreme value that are compared, if they are no runs
STEPS = 4.0  # steps of the sensor: crests whose heights differ by less may be equal


def clipping_problems(
    path: str, name: str, values: NDArray[np.float64], lines: NDArray[np.int64]
) -> Iterator[Problem]:
    """Yield a problem for each end of its range at which a channel of a recording is clipped.

    `path` is the column's place in the study and `name` its name, `values` are its samples and
    `lines` their lines in the file.

    A smooth crest, rounded to steps of the sensor, rests on its last step as well. Near its top it
    is a parabola: the time spent on the last step is at most 1/(sqrt(2) - 1) = 2.4 times that on
    the last but one. Extreme values that hold 4 times as many samples as the next value are thus no
    crest, if they come in runs. Single samples may hold the extreme value at the same phase of each
    period, where the rate is a multiple of the frequency: then the crests between them are alike.
    """
    if np.ptp(values) == 0.0:  # a channel that never moves has no range
        return
    for end_word, signed_values in (("highest", values), ("lowest", -values)):
        extreme = signed_values.max()
        is_extreme = signed_values == extreme
        if is_extreme.sum() < CREST * (signed_values == signed_values[~is_extreme].max()).sum():
            continue
        starts = np.flatnonzero(np.diff(is_extreme.astype(np.int8), prepend=0) == 1)
        stops = np.flatnonzero(np.diff(is_extreme.astype(np.int8), append=0) == -1) + 1
        is_run = stops - starts >= RUN
        if is_run.any() or _crests_differ(signed_values, is_extreme):
            first_line = lines[starts[is_run][0] if is_run.any() else starts[0]]
            yield Problem(
                path,
                f"column '{name}' is clipped: {is_extreme.sum()} samples have its {end_word} value "
                f"{values[starts[0]]:g}, first in line {first_line}",
                "Record again with a wider range of the sensor",
            )


def _crests_differ(values: NDArray[np.float64], is_extreme: NDArray[np.bool_]) -> bool:
    crests = np.flatnonzero(is_extreme[1:-1]) + 1
    if crests.size < VISITS:
        return False
    before, top, after = values[crests - 1], values[crests], values[crests + 1]
    curvature, slope = 2.0 * top - before - after, after - before
    tenth = crests.size // 10
    # Height of the crest above its top sample, by the parabola through three samples: s^2/(8 c).
    heights_above = np.sort(slope**2 / (8.0 * curvature))[tenth : crests.size - tenth]
    # Steps near the top only: numbers with few printed digits have finer steps near zero.
    upper = np.unique(values[values >= values.max() - 0.25 * np.ptp(values)])
    return bool(
        np.ptp(heights_above) - np.diff(heights_above).max()
        > STEPS * np.diff(upper).min(initial=np.inf)
    )


# --- The orientation of a sensor of three axes on the track.

Angles = tuple[float | str, float | str, float | str]

ORTHONORMAL = 1e-3  # rounding error of a matrix that a user copies
ANGLES = {
    name: angle(name, name.capitalize(), f"{name.capitalize()} of the sensor.", 360.0, "90 deg")
    for name in ("yaw", "pitch", "roll")
}
FIX = (
    "Give yaw, pitch and roll in degrees, such as [0, 0, 90], or a 3x3 rotation whose columns are "
    "the sensor's x, y and z in components along, across and normal"
)


def _rotation(mounting: object) -> NDArray[np.float64]:
    # Components in the track's axes are R times those in the sensor's; of angles,
    # R = R_z(yaw) R_y(pitch) R_x(roll); of a matrix the nearest rotation is taken.
    if mounting is None:
        return np.eye(3)
    entries = list(mounting) if isinstance(mounting, list | tuple | np.ndarray) else []
    subject = "the mounting of the sensor is"
    if len(entries) != 3:
        raise refused("mounting", f"{subject} neither three angles nor a rotation matrix", FIX)
    if all(np.ndim(entry) == 0 for entry in entries):
        return _rotation_of_angles(entries)
    try:
        matrix = np.array(entries, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.full((1, 1), np.nan)
    if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), atol=ORTHONORMAL):
        raise refused("mounting", f"{subject} a matrix that is not a rotation", FIX)
    if np.linalg.det(matrix) < 0:
        raise refused(
            "mounting",
            f"{subject} a matrix that mirrors the axes, not a rotation",
            'Reverse one channel with a minus sign: sensor = ["ax", "-ay", "az"]',
        )
    return Rotation.from_matrix(matrix).as_matrix()


def _rotation_of_angles(entries: list[object]) -> NDArray[np.float64]:
    angles: list[float] = []
    problems: list[Problem] = []
    for (name, quantity), raw in zip(ANGLES.items(), entries, strict=True):
        with gathered(problems, f"mounting.{name}"):
            angles.append(
                read_number(name, quantity, raw.item() if isinstance(raw, np.generic) else raw)
            )
    raise_any(problems)
    return Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()


AXES = ("along", "across", "normal")
MAX_ORDERS = 10  # harmonics that are fitted
STANDARD_GRAVITY = 9.80665  # [m s-2], what a sensor's "g" means, wherever it stands
FREQUENCY = replace(QUANTITIES["frequency"], strict=True)  # a drive at rest has no harmonics

ACCELERATION = Quantity(
    "m s-2", "a", "Acceleration", "Acceleration of a channel.", examples=("1 g",)
)  # fmt: skip
NOTHING_SAID: Final[Mapping[str, tuple[float, float]]] = MappingProxyType({})
_KINDS: Final[Mapping[int, Quantity]] = MappingProxyType(
    {
        2: ACCELERATION,
        1: replace(ACCELERATION, unit="m s-1", label="Velocity"),
        0: replace(ACCELERATION, unit="m", label="Displacement"),
    }
)
"""Channels by how often the displacement is differentiated in them."""
_VOLT = replace(ACCELERATION, unit="V", label="Voltage")
_COUNTS = ("", "lsb", "count", "counts", "digit", "digits", "raw")
_SENSITIVITY = re.compile(r"([\d.]+(?:[eE][-+]?\d+)?)\s*([^\s/]+)\s*(?:/|\bper\b)\s*\(?([^()]+)\)?")
_AMOUNT = re.compile(r"([\d.]+(?:[eE][-+]?\d+)?)\s*(\S.*)")
_LISTED = "m s-2, mm s-2, cm/s2, g, mg, mm/s, mm"


@contextmanager
def gathered(problems: list[Problem], path: str = "") -> Iterator[None]:
    """Add the problems found within to `problems`, so that what follows is looked at as well.

    `path` is the place in the study of a value that may have a wrong unit.
    """
    try:
        yield
    except UnitError as error:
        problems.append(problem(path, error))
    except StudyError as error:
        problems += error.problems


@dataclass(frozen=True)
class Recording:
    """The description of a recording, besides its file.

    Attributes
    ----------
    along, across, normal : str, optional
        Columns with the acceleration along the track, across it (to the left of the transport) and
        normal to it (upwards). A minus sign in front turns a channel round: ``"-ay"``.
    sensor : tuple of str, optional
        Instead: columns of the sensor's own right-handed axes x, y, z.
    mounting : three angles or 3x3 matrix, optional
        How `sensor` stands on the track: yaw, pitch and roll (numbers in degrees, or text), which
        turn the track's axes into the sensor's by R_z(yaw) R_y(pitch) R_x(roll); or that matrix,
        whose columns are the sensor's axes in components along, across, normal. In line with the
        track if left out.
    unit : str, optional
        Of the channels, instead of the one in their headings: ``m s-2``, ``g``, ``mg`` of
        accelerations, ``mm/s`` of velocities, ``mm`` or ``um`` of displacements.
    sensitivity : str, optional
        Of a sensor whose channels are voltages or counts: ``100 mV/g``, ``16384 counts/g``.
    scale : str, optional
        Full scale of the samples of a WAV file: ``10 g``, or ``5 V`` with a sensitivity.
    rate : float or str, optional
        Samples a second, if there is no column of times.
    time : str, optional
        Column of times; a column called ``time`` or ``t`` is found by itself.
    line_frequency : float or str, optional
        What the drive truly runs at, if that is known better than the recorder's clock is.
    frequency : float or str, optional
        About what the recording's fundamental is, within a tenth; found if left out.
    harmonics : int, optional
        How many orders to fit; as many as the data tell if left out.
    slopes : mapping of str to tuple, optional
        Least and largest angle [rad] by which the study's track rises along and across.
    """

    along: str | None = None
    across: str | None = None
    normal: str | None = None
    sensor: tuple[str, str, str] | None = None
    mounting: Angles | Sequence[Sequence[float]] | None = None
    unit: str | None = None
    sensitivity: str | None = None
    scale: str | None = None
    rate: float | str | None = None
    time: str | None = None
    line_frequency: float | str | None = None
    frequency: float | str | None = None
    harmonics: int | None = None
    slopes: Mapping[str, tuple[float, float]] = field(default_factory=lambda: NOTHING_SAID)


class Signal(NamedTuple):
    """A sound recording of the track's motion, and what is known of its drive beforehand.

    Attributes
    ----------
    times : ndarray, shape (n,)
        By the recorder's clock [s], ascending.
    values : ndarray, shape (axes, n)
        Accelerations [m s-2], as a sensor at rest shows them: +g upwards; or velocities [m s-1], or
        displacements [m].
    axes : tuple of str
        Which of along, across, normal.
    resolution : ndarray, shape (axes,)
        Smallest step between two values; 0 if nothing is known of it.
    line_frequency, frequency : float, optional
        [Hz], as in `Recording`.
    harmonics : int, optional
    slopes : mapping of str to tuple
        [rad], as in `Recording`.
    assumed : str
        The column of times that was taken for seconds, since nothing names its unit.
    derivative : int
        How often the displacement is differentiated in the values: 2 for accelerations.
    notes : tuple of str
        What of the recording was not used, in words.
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    axes: tuple[str, ...]
    resolution: NDArray[np.float64]
    line_frequency: float | None = None
    frequency: float | None = None
    harmonics: int | None = None
    slopes: Mapping[str, tuple[float, float]] = NOTHING_SAID
    assumed: str = ""
    derivative: int = 2
    notes: tuple[str, ...] = ()


def read_signal(
    source: str | Path | InputTable, recording: Recording, min_samples: int = LEAST_SAMPLES
) -> Signal:
    """Return the motion of a track from a recording, in the axes of the track, with times.

    Parameters
    ----------
    source : str, Path or InputTable
        The recording: the text of a table, the path of a file, or the table read from it.
    recording : Recording
        Section of the study that says which columns hold what: axes, units, times, mounting.
    min_samples : int
        The fewest samples that are read.

    Raises
    ------
    StudyError
        With all problems at once: columns, cells, units, times, numbers, clipped channels.
    """
    table = source if isinstance(source, InputTable) else read_table(source)
    problems: list[Problem] = []
    times = Times(np.zeros(0))
    with gathered(problems):
        times = read_times(table, recording.rate, recording.time)
    names = _channels(recording, problems)
    channels = []
    for path, name in names:
        with gathered(problems):
            channels.append(_channel(table, path, name, recording))
    with gathered(problems):
        rotation = _rotation(recording.mounting)
    frequencies = {}
    for key in ("line_frequency", "frequency"):
        with gathered(problems, key):
            raw = getattr(recording, key)
            frequencies[key] = None if raw is None else read_number(key, FREQUENCY, raw)
    count = recording.harmonics
    if count is not None and (type(count) is not int or not 1 <= count <= MAX_ORDERS):
        problems.append(
            Problem(
                "harmonics",
                f"a fit of {str(count)[:40]} harmonics is not possible",
                f"Give a whole number from 1 to {MAX_ORDERS}, or leave harmonics out",
            )
        )
    if len(table.lines) < min_samples:
        problems.append(
            Problem(
                "recording",
                f"the recording has {len(table.lines)} samples, which is too few",
                f"Record at least {min_samples} samples",
            )
        )
    if len({kind for *_, kind in channels}) > 1:
        problems.append(
            Problem(
                "unit",
                "the columns are different quantities, such as accelerations and velocities",
                "Name only columns of one quantity",
            )
        )
    raise_any(problems)
    values = np.array([samples for samples, _, _ in channels])[:, times.kept]
    resolution = np.array([step for _, step, _ in channels])
    axes = tuple(path for path, _ in names)
    if recording.sensor is not None:
        values, axes = rotation @ values, AXES
        resolution = np.sqrt(rotation**2 @ resolution**2)
    return Signal(
        times.seconds,
        values,
        axes,
        resolution,
        **frequencies,
        harmonics=count,
        slopes=recording.slopes,
        assumed=times.assumed,
        derivative=channels[0][2],
        notes=(times.note,) if times.note else (),
    )


def read_once(table: InputTable, recording: Recording) -> tuple[Signal, dict[str, float]]:
    """Return the signal of a drive that is followed as it was recorded, and what it is without.

    It has accelerations, or velocities, of a track that is at rest at both ends: without the mean
    acceleration, which is gravity, if the sensor shows it, and what is left over at the end. That
    is the second, by axis [m s-2]. Raises `StudyError` with all problems.
    """
    signal = read_signal(table, recording, min_samples=2)
    problems = [
        Problem(
            key,
            f"{key} is an option of the fit, and once = true uses the recording without a fit",
            f"Remove {key}, or once",
        )
        for key in ("line_frequency", "frequency", "harmonics")
        if getattr(recording, key) is not None
    ]
    if signal.derivative == 0:
        message = "accelerations computed from the recorded displacements would be mostly noise"
        problems.append(Problem("once", message, "Record velocities or accelerations"))
    if signal.times.size > MAX_SAMPLES_ONCE:
        message = (
            f"once = true allows {MAX_SAMPLES_ONCE:,} samples, and here are {signal.times.size:,}"
        )
        problems.append(Problem("once", message, "Shorten the recording, or record more slowly"))
    problems += [Problem("time", gaps, "Record again without gaps") for gaps in signal.notes]
    raise_any(problems)
    times, values = signal.times - signal.times[0], signal.values
    if signal.derivative == 2:
        velocity_gains = np.array([np.trapezoid(channel, times) for channel in values])
        mean = velocity_gains[:, np.newaxis] / times[-1]
        without_mean = values - mean
    else:
        mean = (values[:, -1:] - values[:, :1]) / times[-1]
        without_mean = values - values[:, :1] - mean * times
    removed = dict(zip(signal.axes, mean[:, 0].tolist(), strict=True))
    return signal._replace(times=times, values=without_mean), removed


def _channels(recording: Recording, problems: list[Problem]) -> list[tuple[str, str]]:
    # The place in the study and the column of each channel.
    columns = [(axis, name) for axis in AXES if (name := getattr(recording, axis)) is not None]
    sensor = recording.sensor
    if sensor is None and not columns:
        problems.append(
            Problem(
                "along",
                "the drive names no column of accelerations",
                "Name the columns: along = ..., normal = ..., or sensor = three columns",
            )
        )
    elif sensor is None and recording.mounting is not None:
        problems.append(
            Problem(
                "mounting",
                "the mounting needs the three columns of a triaxial sensor, which are not given",
                "Give sensor = three columns, instead of a column for each axis",
            )
        )
    if sensor is None:
        return columns
    if columns:
        problems.append(
            Problem(
                "sensor",
                f"columns are given twice: three of a sensor (sensor) and others ({columns[0][0]})",
                "Give either sensor = three columns, or a column for each axis",
            )
        )
    if isinstance(sensor, str) or len(sensor) != 3:
        problems.append(
            Problem(
                "sensor",
                "sensor does not name three columns of the recording",
                'Name the columns of x, y and z: sensor = ["ax", "ay", "az"]',
            )
        )
        return []
    return [(f"sensor.{axis}", name) for axis, name in zip("xyz", sensor, strict=True)]


def _channel(
    table: InputTable, path: str, name: str, recording: Recording
) -> tuple[NDArray[np.float64], float, int]:
    # Values in SI, their smallest step, and how often the displacement is differentiated in them.
    sign = -1.0 if name.startswith("-") and name not in table.columns else 1.0
    name = name if sign > 0 else name[1:].strip()
    values, unit_in_heading = table.numbers(name, path)
    unit_in_heading = unit_in_heading or _unit_at_end(name)
    problems = list(clipping_problems(path, name, values, table.lines))
    factor, derivative = 1.0, 2
    with gathered(problems):
        factor, derivative = _factor_and_derivative(path, name, unit_in_heading, recording)
    raise_any(problems)
    gaps = np.diff(np.unique(values))
    step = float(gaps.min()) if gaps.size else 0.0
    return sign * factor * values, factor * step, derivative


def _factor_and_derivative(
    path: str, name: str, unit_in_heading: str, recording: Recording
) -> tuple[float, int]:
    # The factor to SI units, and how often the displacement is differentiated (2: acceleration).
    key = "unit" if recording.unit else path
    unit, factor = recording.unit or unit_in_heading, 1.0
    if unit == FULL_SCALE:
        factor, unit = _full_scale(recording.scale, name)
        key = "scale"
    if recording.sensitivity is not None:
        return _by_sensitivity(recording.sensitivity, unit, factor)
    if not unit:
        raise refused(
            "unit",
            f"the unit of the recording's column '{name}' is not given",
            f"Give unit = one of {_LISTED}, or write the unit in the header: '{name} [g]'",
        )
    for kind, quantity in _KINDS.items():
        try:
            return factor * float(unit_factor(name, quantity, unit)), kind
        except UnitError:
            continue
    if _volts(unit) is not None:
        raise refused(
            path,
            f"column '{name}' is a voltage ({unit})",
            'Give the sensor\'s sensitivity, such as sensitivity = "100 mV/g"',
        )
    raise refused(key, f"'{unit[:40]}' is not a unit of acceleration", f"Known: {_LISTED}")


def _unit_at_end(name: str) -> str:
    unit = stem_and_unit(name)[1]
    return "" if unit in ("s", "ms", "us", "ns", "min") else unit


def _volts(unit: str) -> float | None:
    try:
        return float(unit_factor("channel", _VOLT, unit))
    except UnitError:
        return None


def _full_scale(text: str | None, name: str) -> tuple[float, str]:
    match = _AMOUNT.fullmatch((text or "").strip())
    if match is None:
        raise refused(
            "scale",
            f"the samples of channel {name} are shares of a full scale that is not given",
            'Give it, such as scale = "10 g", or scale = "5 V" and a sensitivity',
        )
    return float(match[1]), match[2]


def _by_sensitivity(text: str, unit: str, factor: float) -> tuple[float, int]:
    # "100 mV/g" is signal over quantity, "5 mm/s/V" quantity over signal.
    match = _SENSITIVITY.fullmatch(text.strip())
    number, output_unit, quantity_unit = match.groups() if match else ("1", "", "")
    for kind, quantity in _KINDS.items():
        try:
            quantity_factor = float(unit_factor("sensitivity", quantity, quantity_unit))
        except UnitError:
            continue
        if output_unit.casefold() in _COUNTS and unit.casefold() in _COUNTS:
            return factor * quantity_factor / float(number), kind
        volts_per_unit, volts_of_column = _volts(output_unit), _volts(unit or "V")
        if volts_per_unit is not None and volts_of_column is not None:
            return factor * volts_of_column / volts_per_unit * quantity_factor / float(number), kind
    raise refused(
        "sensitivity",
        f"'{text[:40]}' is not a sensitivity for channels in {unit or 'counts'}",
        'Write the output of the sensor for its quantity, such as "100 mV/g" or "16384 counts/g", '
        "and the unit of the channels: V, mV or counts",
    )
