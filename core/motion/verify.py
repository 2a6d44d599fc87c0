"""Random cells of a motion followed again by another method: what `verify` in a study asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion.feeding import RESOLVED
from core.motion.prepare import ERROR, Simulation, other_method
from core.motion.result import STATUS
from core.motion.systems import methods_of
from core.plan.equations import run_equations
from core.plan.grid import from_si
from core.plan.plan import Plan, plan_scene, scene_parameters
from core.plan.sample import sample_of
from core.quantities import QUANTITIES
from core.scenes import Scene
from core.watch import Watch

SOUND = [STATUS[name] for name in ("periodic", "at_rest", "neutral", "settled")]
"""Statuses of motions that two methods should agree on: the others are chance, or no answer."""

SPEED = ("drive_number", "velocity_scale")


def accuracy(plan: Plan) -> str:
    """Return what is known of the error of a method, in words."""
    text = methods_of(plan.scene.name)[plan.variant].accuracy
    if ERROR in plan.outputs:
        return f"{text}; {ERROR} states it for each cell"
    if ERROR in plan.scene.outputs(plan.variant):
        return f"{text}; the output {ERROR}, if asked for, states it for each cell"
    return text


@dataclass(frozen=True)
class Comparison:
    """Outputs of some cells by two methods.

    Attributes
    ----------
    method : str
        The other method.
    evaluated : ndarray of bool
        The cells that the other method followed before a stop.
    compared : ndarray of bool
        The cells whose motion both methods found to repeat, rest or settle.
    output : str
        The output of largest difference, over the largest size of that output in these cells.
    cell : int
        Where it is.
    error, share : float
        The difference [unit of studies], and the same over that size.
    stated : float
        The other method's own estimate of its error there; NaN where it has none.
    failed : int
        Cells that are further apart than both methods state, or that repeat after other numbers of
        periods.
    """

    method: str
    evaluated: NDArray[np.bool_]
    compared: NDArray[np.bool_]
    output: str = ""
    cell: int = -1
    error: float = 0.0
    share: float = 0.0
    stated: float = np.nan
    failed: int = 0

    def in_words(self, where: str) -> str:
        """Return one sentence; `where` is the place of the largest difference."""
        if not self.output:
            return "no cell has an output to compare and repeats, rests or settles by both methods"
        unit = QUANTITIES[self.output].unit
        unit = "" if unit == "1" else f" {unit}"
        text = (
            f"{self.output} {where}: difference {self.error:.2g}{unit}, {self.share:.2g} of its "
            f"largest size in these cells; {self.compared.sum()} repeat, rest or settle by both "
            "methods and are compared"
        )
        if np.isfinite(self.stated):
            text += f"; the method {self.method} states an error of {self.stated:.2g}{unit} there"
        if self.failed:
            text += f"; {self.failed} are further apart than both methods state: NOT VERIFIED"
        return text


def compare(
    plan: Plan,
    cells: Mapping[str, Array],
    got: Mapping[str, Array],
    method: str,
    watch: Watch | None = None,
) -> Comparison:
    """Return how far outputs of a motion are from those of another method.

    Parameters
    ----------
    plan : Plan
        What computed them.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    got : mapping of str to ndarray, shape (n,)
        The outputs, in the unit of studies; `motion_status` among them if it is known.
    method : str
        The other method.
    watch : Watch, optional
        May stop the other method between cells.
    """
    scene = plan.scene
    has = scene.outputs(method)
    outputs = [name for name in got if name in has and QUANTITIES[name].compared]
    told = [name for name in (ERROR, "motion_status") if name in has]
    count = next(iter(got.values())).size
    theirs = _followed(scene, method, (*outputs, *told, *SPEED), cells, count, watch)
    status = theirs["motion_status"]
    sound = np.isin(status, SOUND)
    if "motion_status" in got:
        sound &= np.isin(got["motion_status"], SOUND)
    found = Comparison(method, status != STATUS["not_computed"], sound)
    for name in outputs if sound.any() else ():
        right = np.where(sound, theirs[name], 0.0)
        size = float(np.abs(right).max()) or 1.0
        error = np.where(sound, np.abs(got[name] - right), 0.0)
        error = np.where(np.isnan(error), np.inf, error)  # a value that only one method has
        cell = int(np.argmax(error))
        share = float(error[cell]) / size
        if not found.output or share > found.share:
            stated = np.nan
            if name == "conveying_velocity" and ERROR in theirs:
                stated = float(theirs[ERROR][cell])
            found = replace(
                found, output=name, cell=cell, error=float(error[cell]), share=share, stated=stated
            )
    if not sound.any():
        return found
    ours = got
    if ERROR not in got:  # what the first run stated was not asked for: it is found again
        silent = None if watch is None else replace(watch, progress=None)
        ours = _followed(scene, plan.variant, tuple(told), cells, count, silent)
    return replace(found, failed=int((sound & _apart(got, ours, theirs)).sum()))


def _followed(
    scene: Scene,
    method: str,
    outputs: tuple[str, ...],
    cells: Mapping[str, Array],
    count: int,
    watch: Watch | None,
) -> dict[str, Array]:
    """Return outputs of cells by a method, in the units of studies."""
    asked = tuple(name for name in outputs if name in scene.outputs(method))
    parameters = [name for name in cells if name in scene_parameters(scene, method)]
    plan = plan_scene(scene, method, asked, parameters)
    known = run_equations(plan, {name: cells[name] for name in plan.parameters}, watch)
    return {
        name: np.broadcast_to(from_si(name, np.asarray(known[name], dtype=np.float64)), count)
        for name in asked
    }


def _apart(
    got: Mapping[str, Array], ours: Mapping[str, Array], theirs: Mapping[str, Array]
) -> NDArray[np.bool_]:
    """Return which motions are further apart than both methods state.

    By the mean velocity, whose errors they state, and by the number of periods after which the
    motion repeats; a part that rests repeats after any number.
    """
    apart = np.zeros(next(iter(got.values())).shape, dtype=np.bool_)
    velocity, multiple = got.get("conveying_velocity"), got.get("period_multiple")
    if velocity is not None and ERROR in ours and ERROR in theirs:
        drive = theirs["drive_number"] * theirs["velocity_scale"]
        stated = ours[ERROR] + theirs[ERROR] + RESOLVED * drive
        apart |= ~(np.abs(velocity - theirs["conveying_velocity"]) <= stated)
    if multiple is not None:
        moves = (multiple > 0) & (theirs["period_multiple"] > 0)
        apart |= moves & (multiple != theirs["period_multiple"])
    return apart


def verified(
    prepared: Simulation, arrays: Mapping[str, NDArray[np.generic]], watch: Watch
) -> dict[str, str | int]:
    """Return what verifying found, as attributes of the result; nothing if not asked for.

    Parameters
    ----------
    prepared : Simulation
        The study.
    arrays : mapping of str to ndarray
        What was computed, SI units.
    watch : Watch
        May stop it.
    """
    if prepared.study.verify is None:
        return {}
    plan = prepared.plan
    sample = sample_of(prepared, arrays, ("motion_status", STATUS["not_computed"]))
    other = other_method(plan, prepared.grid)
    assert other is not None  # the study would have been refused
    against = f"the method {other.name}"
    if not sample.count or watch.stopped():
        return sample.told(against)
    cells = prepared.grid.at(sample.places, sample.count, plan.parameters)
    got = {
        name: np.asarray(from_si(name, sample.at(arrays[name], prepared.dims[name])))
        for name in plan.outputs
    }
    found = compare(plan, cells, got, other.name, watch)
    evaluated, compared = int(found.evaluated.sum()), int(found.compared.sum())
    worst = found.in_words(sample.where(found.cell)) if evaluated else ""
    return sample.told(against, worst, evaluated=evaluated, compared=compared, failed=found.failed)
