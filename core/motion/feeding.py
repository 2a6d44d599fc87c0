"""Results for who feeds parts: parts a minute, and the direction in which they travel."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import percent
from vibrafeed.core.errors import raise_any, refused
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.travel import distance_bound
from vibrafeed.core.motion.method import ANSWERED, STATUS, Motion
from vibrafeed.core.motion.scales import product
from vibrafeed.core.quantities import DIRECTIONS, QUANTITIES
from vibrafeed.core.scenes.scene import Equation
from vibrafeed.core.study.units import UnitError, in_own_unit, problem

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table

_MEASURED: Final = {
    "velocity": "conveying_velocity", "gap": "part_gap", "parts_per_minute": "feed_rate"
}  # fmt: skip
"""The quantities of arguments that have a name of their own."""


def parts_per_minute(*, velocity: Array, length: Array, gap: Array | float = 0.0) -> Array:
    """Return the number of parts that arrive per minute at a mean velocity, theory 13.12 [min-1].

    Parameters
    ----------
    velocity : ndarray
        Mean conveying velocity [m s-1].
    length, gap : ndarray
        Length of a part along the track, and free length between two parts [m]; together above 0.

    Raises
    ------
    StudyError
        If a part takes no length, or an array carries the unit of another quantity.

    Examples
    --------
    >>> float(round(vibrafeed.parts_per_minute(velocity=0.03, length=0.012, gap=0.003), 9))
    120.0
    """
    velocity, length, gap = _in_own_units(velocity=velocity, length=length, gap=gap)
    return 60.0 * velocity / _spacing(length, gap)


def velocity_for(*, parts_per_minute: Array, length: Array, gap: Array | float = 0.0) -> Array:
    """Return the mean velocity that a rate needs; inverse of `parts_per_minute` [m s-1].

    Examples
    --------
    >>> round(vibrafeed.velocity_for(parts_per_minute=120, length=0.012, gap=0.003), 15)
    0.03
    """
    rate, length, gap = _in_own_units(parts_per_minute=parts_per_minute, length=length, gap=gap)
    return rate * _spacing(length, gap) / 60.0


def effective_distance(
    *, velocity: Array, starting_acceleration: Array, friction_kinetic: Array, radius: Array
) -> Array:
    """Return the distance x at which (3.18) from rest gives a speed (theory 13.12) [m].

    The speed may be simulated or measured. Infinite where (3.18) never reaches it: at or above the
    terminal velocity, where the part does not start, and for a speed the other way, below 0.

    Parameters
    ----------
    velocity : ndarray
        The speed [m s-1].
    starting_acceleration : ndarray
        Acceleration of the part from rest [m s-2].
    friction_kinetic : ndarray
        Coefficient of friction in sliding.
    radius : ndarray
        Radius of the bowl's wall [m].

    Examples
    --------
    >>> distance = vibrafeed.effective_distance(
    ...     velocity=0.03, starting_acceleration=4.0, friction_kinetic=0.3, radius=0.2
    ... )
    >>> round(1e6 * float(distance))
    113
    """
    velocity, starting_acceleration, friction_kinetic, radius = _in_own_units(
        velocity=velocity,
        starting_acceleration=starting_acceleration,
        friction_kinetic=friction_kinetic,
        radius=radius,
    )
    distance = distance_bound(
        starting_acceleration=starting_acceleration,
        velocity_bound=velocity,
        friction_kinetic=friction_kinetic,
        radius=radius,
    )
    return np.where(velocity < 0, np.inf, distance)


def _in_own_units(**values: Any) -> list[Any]:
    # Numbers in the units of their quantities; all wrong ones are reported together.
    read, problems = [], []
    for name, value in values.items():
        try:
            read.append(in_own_unit(name, QUANTITIES[_MEASURED.get(name, name)], value))
        except UnitError as error:
            problems.append(problem(name, error))
    raise_any(problems)
    return read


def _spacing(length: Array, gap: Array | float) -> Array:
    # The length of track that a part and its gap take.
    spacing = length + gap
    if np.any(spacing <= 0.0):
        raise refused(
            "length",
            "length plus gap, the track that one part takes, is not above 0",
            "Give length or gap above 0",
        )
    return spacing


RESOLVED = 1e-9
"""Difference of two mean velocities, over the drive's speed, below which they are the same."""

SLOWEST = 1e-9
"""Speed in m/s below which a part counts as at rest if the drive's speed is not known."""


def occupancy(*, length: Array, part_gap: Array) -> Array:
    """Return the share of the track's length that parts occupy, length/(length + gap) [1]."""
    return length / (length + part_gap)


def feed_rate(*, conveying_velocity: Array, length: Array, occupancy: Array) -> Array:
    """Return the parts per minute, 60 v occupancy/length; negative where parts travel back [min-1].

    The sign is that of the velocity, and not cut off at 0: a rate of 0 would not tell parts that
    rest from parts that leave at the wrong end, and a search for the best rate could not get away
    from there.
    """
    return parts_per_minute(velocity=conveying_velocity, length=length / occupancy)


def line_feed_rate(*, feed_rate: Array, line_yield: Array) -> Array:
    """Return the parts per minute behind a line of devices, feed rate times yield [min-1].

    They leave in any aspect. None pass of a track that brings none: a rate below 0 counts as 0.
    """
    return np.maximum(feed_rate, 0.0) * line_yield


def direction(*, motion: Motion, drive_number: Array) -> NDArray[np.int8]:
    """Return the direction of travel as a flag: forwards, backwards, at rest or unknown.

    A mean velocity that is no larger than its own stated error, or than 1e-9 of the drive's speed
    (`drive_number` in the scale g/w, w = 2 pi f), counts as rest: the last bit of a sum decides
    nothing. Unknown where `motion` has no mean velocity.
    """
    value = {name: np.int8(flag.value) for name, flag in DIRECTIONS.items()}
    velocity = np.asarray(motion.velocity)
    error = np.where(np.isnan(motion.error), 0.0, motion.error)
    is_at_rest = np.abs(velocity) <= np.maximum(error, RESOLVED * np.asarray(drive_number))
    travel = np.where(velocity > 0, value["forwards"], value["backwards"])
    answered = np.isin(motion.status, [STATUS[name] for name in ANSWERED])
    resolved = np.where(is_at_rest | motion.only("stick"), value["rests"], travel)
    direction: NDArray[np.int8] = np.where(
        answered & ~np.isnan(velocity), resolved, value["unknown"]
    )
    return direction


RESULTS = (
    Equation("occupancy", occupancy, "theory 13.12"),
    Equation("feed_rate", feed_rate, "theory 13.12"),
    Equation("line_feed_rate", line_feed_rate, "theory 16.3"),
    product(
        "oriented_feed_rate", "line_feed_rate", "line_purity", source="theory 16.3",
        says="the parts per minute that leave a line of devices as they are wanted [min-1]",
    ),
    Equation("direction", direction, "theory 13.12"),
)  # fmt: skip
DEFAULTS = {"part_gap": 0.0}


def travel_in_words(table: "Table") -> str:
    """Return a sentence on how many cells of a result travel backwards; empty if none do.

    It goes by `direction` if the result has that, else by its mean velocity or its feed rate;
    speeds below the stated error, or a nanometre a second, are those of parts that rest.
    """
    variables = table.variables
    if "mean_acceleration" in variables:
        return _rolling_in_words(table)
    if "direction" in variables:
        backwards = variables["direction"].values == DIRECTIONS["backwards"].value
    elif "conveying_velocity" in variables:
        velocity, error = variables["conveying_velocity"], variables.get("conveying_velocity_error")
        stated = error is not None and error.dims == velocity.dims
        resting_speed = np.fmax(error.values, SLOWEST) if error is not None and stated else SLOWEST
        backwards = velocity.values < -resting_speed
    elif "feed_rate" in variables:
        # Of parts of a metre: shorter ones give a higher rate at the same speed.
        backwards = variables["feed_rate"].values < -60.0 * SLOWEST
    else:
        return ""
    fraction = float(np.mean(backwards))
    if not fraction:
        return ""
    subject = f"{percent(fraction)} of the cells travel"
    if fraction == 1:
        single = all(not variable.dims for variable in variables.values())
        subject = "The part travels" if single else "All cells travel"
    return f"{subject} backwards, against x."


def _rolling_in_words(table: "Table") -> str:
    # Of cells in which a round part is not conveyed: it runs down, or nothing moves it.
    acceleration = np.abs(table.variables["mean_acceleration"].values)
    status = table.variables["motion_status"].values
    accelerations = acceleration[acceleration > 0]
    lowest, highest = (
        f"{end:.2g}" for end in (accelerations.min(initial=np.inf), accelerations.max(initial=0.0))
    )
    range_in_words = highest if lowest == highest else f"{lowest} to {highest}"
    sentences = []
    for name, words in (
        ("runaway", f"it runs down at {range_in_words} m/s²"),
        ("neutral", "nothing conveys it, and it keeps the speed that it has"),
    ):
        if fraction := float(np.mean(status == STATUS[name])):
            in_cells = "" if fraction == 1 else f" in {percent(fraction)} of the cells"
            sentences.append(f"The part does not travel{in_cells}: {words}.")
    return " ".join(sentences)
