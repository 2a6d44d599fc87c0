"""Results for who feeds parts: parts a minute, and the direction in which they travel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import percent
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.rates import parts_per_minute
from vibrafeed.core.motion.result import ANSWERED, STATUS, Motion
from vibrafeed.core.quantities import DIRECTIONS
from vibrafeed.core.scenes.scene import Equation

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table

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


def oriented_feed_rate(*, line_feed_rate: Array, line_purity: Array) -> Array:
    """Return the parts per minute that leave a line of devices as they are wanted [min-1].

    The feed rate of the line times the purity of the line, the share of the leaving parts that lie
    in the wanted aspect.
    """
    return line_feed_rate * line_purity


def direction(*, motion: Motion, drive_number: Array) -> NDArray[np.int8]:
    """Return the direction of travel as a flag: forwards, backwards, at rest or unknown.

    A mean velocity that is no larger than its own stated error, or than 1e-9 of the drive's speed
    (`drive_number` in the scale g/w, w = 2 pi f), counts as rest: the last bit of a sum decides
    nothing. Unknown where `motion` has no mean velocity.
    """
    value = {name: np.int8(flag.value) for name, flag in DIRECTIONS.items()}
    velocity = np.asarray(motion.velocity)
    error = np.where(np.isnan(motion.error), 0.0, motion.error)
    rests = np.abs(velocity) <= np.maximum(error, RESOLVED * np.asarray(drive_number))
    way = np.where(velocity > 0, value["forwards"], value["backwards"])
    answered = np.isin(motion.status, [STATUS[name] for name in ANSWERED])
    known = np.where(rests | motion.only("stick"), value["rests"], way)
    direction: NDArray[np.int8] = np.where(answered & ~np.isnan(velocity), known, value["unknown"])
    return direction


RESULTS = (
    Equation("occupancy", occupancy, "theory 13.12"),
    Equation("feed_rate", feed_rate, "theory 13.12"),
    Equation("line_feed_rate", line_feed_rate, "theory 16.3"),
    Equation("oriented_feed_rate", oriented_feed_rate, "theory 16.3"),
    Equation("direction", direction, "theory 13.12"),
)
DEFAULTS = {"part_gap": 0.0}


def travel_in_words(table: Table) -> str:
    """Return a sentence on how many cells of a result travel backwards; empty if none do.

    It goes by `direction` if the result has that, else by its mean velocity or its feed rate;
    speeds below the stated error, or a nanometre a second, are those of parts that rest.
    """
    if "mean_acceleration" in table.variables:
        return _rolling_in_words(table)
    share = _share_backwards(table)
    if not share:
        return ""
    which = "The part travels" if share == 1 else f"{percent(share)} of the cells travel"
    if share == 1 and not _is_single(table):
        which = "All cells travel"
    return f"{which} backwards, against x."


def _rolling_in_words(table: Table) -> str:
    """Return sentences on cells in which a round part is not conveyed; empty if it is in all.

    It runs down the track, or nothing moves it. `table` is the result of a study, with the
    variables `mean_acceleration` and `motion_status`.
    """
    down = np.abs(table.variables["mean_acceleration"].values)
    status = table.variables["motion_status"].values
    runs, stays = status == STATUS["runaway"], status == STATUS["neutral"]
    sentences = []
    for share, words in (
        (float(np.mean(runs)), f"it runs down at {_between(down[down > 0])}"),
        (float(np.mean(stays)), "nothing conveys it, and it keeps the speed that it has"),
    ):
        if share:
            where = "" if share == 1 else f" in {percent(share)} of the cells"
            sentences.append(f"The part does not travel{where}: {words}.")
    return " ".join(sentences)


def _between(values: NDArray[np.float64]) -> str:
    """Return the smallest and the largest acceleration as text."""
    least, most = (f"{end:.2g}" for end in (values.min(initial=np.inf), values.max(initial=0.0)))
    return f"{most} m/s²" if least == most else f"{least} to {most} m/s²"


def _share_backwards(table: Table) -> float:
    """Return the share of the cells of a result that travel backwards, from 0 to 1.

    By `direction` if the result has it, else by the mean velocity beyond its stated error, else by
    the feed rate; 0 if it has none of these.
    """
    values = {name: variable.values for name, variable in table.variables.items()}
    if "direction" in values:
        return float(np.mean(values["direction"] == DIRECTIONS["backwards"].value))
    if "conveying_velocity" in values:
        error = values.get("conveying_velocity_error")
        least = SLOWEST
        if error is not None and table.variables["conveying_velocity_error"].dims == (
            table.variables["conveying_velocity"].dims
        ):
            least = np.fmax(error, SLOWEST)
        return float(np.mean(values["conveying_velocity"] < -least))
    if "feed_rate" in values:
        # Of parts of a metre: shorter ones give a higher rate at the same speed.
        return float(np.mean(values["feed_rate"] < -60.0 * SLOWEST))
    return 0.0


def _is_single(table: Table) -> bool:
    """True if a result has one cell only."""
    return all(not variable.dims for variable in table.variables.values())
