"""The error of a part's velocity that follows from the errors of a measured drive."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, raise_any
from vibrafeed.core.measured import Fit
from vibrafeed.core.motion.prepare import Simulation, prepare
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.plan import run_equations
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy
from vibrafeed.core.study.values import Fixed

LEAST_DRAWS, MAX_DRAWS = 20, 10_000
"""Fewest and most samples of the drive. Of 20, half a sample lies beyond each of `ENDS`; of 10,000,
250 do, which give that quantile to 6 % of the tail: more would cost motions for nothing."""
SAME = 1e-9  # relative difference below which a study's value counts as that of the fitted drive
ENDS = (2.5, 97.5)  # percent: the quantiles reported
VELOCITY = "conveying_velocity"


class DriveError(NamedTuple):
    """A velocity, and what the errors of a measured drive make of it.

    Attributes
    ----------
    velocity : float
        Of the drive as it was fitted [m s-1].
    standard_deviation : float
        Of the velocities of the draws [m s-1].
    lower, upper : float
        Between which 95 % of them lie [m s-1].
    draws : int
        How many have a velocity.
    without : int
        How many have none.
    """

    velocity: float
    standard_deviation: float
    lower: float
    upper: float
    draws: int
    without: int


def drive_error(
    study: SimulateStudy, fit: Fit, draws: int = 200, rng: np.random.Generator | None = None
) -> DriveError:
    """Return the error of a conveying velocity that comes from errors of a fitted drive.

    The part is followed under `draws` drives that the recording cannot tell from the fitted one
    (`Fit.draw`). Parameters that the study gives itself in place of numbers of the fit have no
    error. Errors of other parameters, of the model and of the sensor's scale are not counted. The
    result has the velocity, its standard deviation and an interval [m s-1], and how many drives
    gave none. `rng` makes the random numbers, the same ones by default.

    Raises
    ------
    StudyError
        With every problem of the study; if it has more than one cell, or nothing of the fit.
    """
    outputs = tuple(dict.fromkeys((VELOCITY, *study.outputs)))
    prepared = prepare(study.model_copy(update={"outputs": outputs, "reduce": None}))
    values, fitted = study.values(), fit.parameters()
    names = [
        name
        for name, number in fitted.items()
        if isinstance(value := values.get(name), Fixed)
        and abs(value.value - number) <= SAME * max(abs(number), 1e-30)
    ]
    raise_any(_problems(prepared, names, draws))
    drawn_parameters = fit.draw(rng or np.random.default_rng(0), draws)
    velocity = velocities(
        prepared, [{}, *({name: draw[name] for name in names} for draw in drawn_parameters)]
    )
    with_velocity = velocity[1:][np.isfinite(velocity[1:])]
    lower, upper = (
        np.percentile(with_velocity, ENDS).tolist() if with_velocity.size else (np.nan, np.nan)
    )
    deviation = float(with_velocity.std(ddof=1)) if with_velocity.size > 1 else np.nan
    return DriveError(
        float(velocity[0]), deviation, lower, upper, with_velocity.size, draws - with_velocity.size
    )


def velocities(prepared: Simulation, changes: Sequence[Mapping[str, float]]) -> NDArray[np.float64]:
    """Return the conveying velocity of a one-cell study after each change of parameters [m s-1].

    For the error of the velocity by a recorded drive. `prepared` is the study; each change gives
    new values of some parameters, in the units of studies; shape (changes,).
    """
    plan, fixed = prepared.plan, prepared.grid.fixed
    values = {
        name: parameter_to_si(name, np.array([change.get(name, fixed[name]) for change in changes]))
        for name in plan.parameters
    }
    return np.broadcast_to(run_equations(plan, values)[VELOCITY], len(changes))


def _problems(prepared: Simulation, fitted_names: Sequence[str], draws: int) -> Iterator[Problem]:
    # A study of several cells, one that takes nothing from the recording, and a wrong number of
    # draws.
    for axis in prepared.grid.axes:
        yield Problem(
            f"parameters.{axis}",
            f"{axis} has several values, but the error is computed for a single design",
            f"Give one value of {axis}",
        )
    if not fitted_names:
        yield Problem(
            "drive",
            "the study gives all parameters of the drive itself, and uses no recorded value",
            "Remove these parameters, so that they come from the recording",
        )
    if not LEAST_DRAWS <= draws <= MAX_DRAWS:
        yield Problem(
            "draws",
            f"{draws:,} draws are outside the limits",
            f"Give {LEAST_DRAWS} to {MAX_DRAWS:,} draws",
        )
