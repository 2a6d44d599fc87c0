"""Random cells of a motion followed again by another method: what `verify` in a study asks for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.feeding import RESOLVED
from vibrafeed.core.motion.prepare import ERROR, Simulation, other_method
from vibrafeed.core.motion.result import ANSWERED, STATUS
from vibrafeed.core.motion.systems import methods_of
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.labels import Sample, chosen_positions, sample_of
from vibrafeed.core.plan.plan import Plan, plan_scene, scene_parameters
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import Scene
from vibrafeed.core.watch import Watch

EXACT_MEANS = [STATUS[name] for name in ("periodic", "at_rest", "neutral", "settled")]
"""Statuses of motions all of whose outputs two methods should agree on."""

MEANS = [STATUS[name] for name in ANSWERED]
"""Statuses of motions that have a mean velocity, on which two methods agree within their errors."""

VELOCITY = "conveying_velocity"

SPEED = ("drive_number", "velocity_scale")


def accuracy(plan: Plan) -> str:
    """Return the known error of a plan's method as a sentence, for the attributes of a result.

    It tells, too, if an output states the error of each cell.
    """
    text = methods_of(plan.scene.name)[plan.variant].accuracy
    if ERROR not in plan.scene.outputs(plan.variant):
        return text
    told = ERROR if ERROR in plan.outputs else f"the output {ERROR}, if asked for,"
    return f"{text}; {told} states it for each cell"


NOT_JUDGED = "verified_not_judged"
"""The attribute that counts the cells of which two methods tell nothing to compare; none if all
are judged. `verified_worst` says why."""


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
        The cells that are judged: by all outputs where both methods find the motion to repeat, rest
        or settle, else by their mean velocities.
    output : str
        The output of largest difference, over the largest size of that output, in the former.
    cell : int
        Where it is.
    error, share : float
        The difference [unit of studies], and the same over that size.
    stated : float
        The other method's own estimate of its error there; NaN where it has none.
    means : int
        Cells that are judged by their mean velocities alone.
    strain : float
        The largest difference of these, over what both methods state.
    failed : int
        Cells that are further apart than both methods state, or that repeat after other numbers of
        periods.
    silent : mapping of str to int
        Why cells could not be judged, and how many.
    """

    method: str
    evaluated: NDArray[np.bool_]
    compared: NDArray[np.bool_]
    output: str = ""
    cell: int = -1
    error: float = 0.0
    share: float = 0.0
    stated: float = np.nan
    means: int = 0
    strain: float = 0.0
    failed: int = 0
    silent: Mapping[str, int] = field(default_factory=dict)

    def in_words(self, where: str) -> str:
        """Return the comparison of two methods as a sentence, for the user.

        `where` is the position of the largest difference, in words.
        """
        parts = []
        if self.output:
            unit = QUANTITIES[self.output].unit
            unit = "" if unit == "1" else f" {unit}"
            parts.append(
                f"{self.output} {where}: difference {self.error:.2g}{unit}, {self.share:.2g} of "
                f"its largest size in these cells; {self.compared.sum() - self.means} repeat, rest "
                "or settle by both methods and are compared"
            )
            if np.isfinite(self.stated):
                parts.append(
                    f"the method {self.method} states an error of {self.stated:.2g}{unit} there"
                )
        if self.means:
            parts.append(
                f"{self.means} do not repeat by both, and their mean velocities differ by "
                f"{self.strain:.2g} of both stated errors at most"
            )
        if self.failed:
            parts.append(f"{self.failed} are further apart than both methods state: NOT VERIFIED")
        if self.silent:
            reasons = ", ".join(f"{count} {reason}" for reason, count in self.silent.items())
            parts.append(f"{sum(self.silent.values())} could not be judged: {reasons}")
        return "; ".join(parts)


def compare(
    plan: Plan,
    cells: Mapping[str, Array],
    got: Mapping[str, Array],
    method: str,
    watch: Watch | None = None,
) -> Comparison:
    """Return the comparison of computed outputs of some cells with those of another method.

    `cells` are parameters in SI units, shape (n,), as all; `got` are outputs, in the units of
    studies, computed by `plan`. Status, velocity and error are computed again if they are missing.
    `watch` may stop the other method; cells that were not reached are not `evaluated`.
    """
    scene = plan.scene
    has = scene.outputs(method)
    outputs = [name for name in got if name in has and QUANTITIES[name].compared]
    judging = [name for name in (VELOCITY, ERROR, "motion_status") if name in has]
    count = next(iter(got.values())).size
    theirs = _follow_cells(scene, method, (*outputs, *judging, *SPEED), cells, count, watch)
    ours = got
    if not set(judging) <= set(got):  # what was not asked for is computed again
        silent = None if watch is None else replace(watch, progress=None)
        ours = {**_follow_cells(scene, plan.variant, tuple(judging), cells, count, silent), **got}
    both = ours["motion_status"], theirs["motion_status"]
    evaluated = both[1] != STATUS["not_computed"]
    exact = np.isin(both[0], EXACT_MEANS) & np.isin(both[1], EXACT_MEANS)
    apart, stated = _velocity_difference(ours, theirs)
    means = np.isin(both[0], MEANS) & np.isin(both[1], MEANS) & ~exact & np.isfinite(stated)
    nothing = np.zeros(both[1].shape)
    periods = [one.get("period_multiple", nothing) for one in (got, theirs)]
    other = exact & (np.minimum(*periods) > 0) & (periods[0] != periods[1])
    return Comparison(
        method,
        evaluated,
        exact | means,
        means=int(means.sum()),
        strain=float(np.max((apart / stated)[means], initial=0.0)),
        failed=int(((exact | means) & ~(apart <= stated) | other).sum()),
        silent=_reasons(method, *(status[evaluated & ~exact & ~means] for status in both)),
        **(_worst(outputs, got, theirs, exact) if exact.any() else {}),
    )


def _worst(
    outputs: Sequence[str],
    got: Mapping[str, Array],
    theirs: Mapping[str, Array],
    exact: NDArray[np.bool_],
) -> dict[str, Any]:
    # The output that differs most in the cells that count, over its largest size.
    worst: dict[str, Any] = {}
    for name in outputs:
        right = np.where(exact, theirs[name], 0.0)
        size = float(np.abs(right).max()) or 1.0
        error = np.where(exact, np.abs(got[name] - right), 0.0)
        error = np.where(np.isnan(error), np.inf, error)  # a value that only one method has
        cell = int(np.argmax(error))
        share = float(error[cell]) / size
        if not worst or share > worst["share"]:
            states = name == VELOCITY and ERROR in theirs
            stated = float(theirs[ERROR][cell]) if states else np.nan
            worst = {
                "output": name, "cell": cell, "error": float(error[cell]), "share": share,
                "stated": stated,
            }  # fmt: skip
    return worst


def _reasons(method: str, ours: Array, theirs: Array) -> dict[str, int]:
    names = {value: name for name, value in STATUS.items()}
    reasons = Counter[str]()
    for mine, other in zip(ours.tolist(), theirs.tolist(), strict=True):
        if mine not in EXACT_MEANS and mine not in MEANS:
            reasons[names[mine]] += 1
        elif other not in EXACT_MEANS and other not in MEANS:
            reasons[f"{names[other]} by {method}"] += 1
        else:
            reasons["without a stated error"] += 1
    return dict(reasons.most_common())


def _follow_cells(
    scene: Scene,
    method: str,
    outputs: tuple[str, ...],
    cells: Mapping[str, Array],
    count: int,
    watch: Watch | None,
) -> dict[str, Array]:
    asked = tuple(name for name in outputs if name in scene.outputs(method))
    parameters = [name for name in cells if name in scene_parameters(scene, method)]
    plan = plan_scene(scene, method, asked, parameters)
    known = run_equations(plan, {name: cells[name] for name in plan.parameters}, watch)
    return {
        name: np.broadcast_to(from_si(name, np.asarray(known[name], dtype=np.float64)), count)
        for name in asked
    }


def _velocity_difference(
    ours: Mapping[str, Array], theirs: Mapping[str, Array]
) -> tuple[Array, Array]:
    if not {VELOCITY, ERROR} <= set(ours) or not {VELOCITY, ERROR} <= set(theirs):
        nothing = np.zeros_like(theirs["motion_status"])
        return nothing, nothing + np.inf
    drive = theirs["drive_number"] * theirs["velocity_scale"]
    stated = ours[ERROR] + theirs[ERROR] + RESOLVED * drive
    return np.abs(ours[VELOCITY] - theirs[VELOCITY]), stated


def verified(
    prepared: Simulation, arrays: Mapping[str, NDArray[np.generic]], watch: Watch
) -> dict[str, str | int]:
    """Return the outcome of following some cells again by another method; empty if not asked for.

    `arrays` are the computed outputs, SI units; cells that were not computed are not chosen.
    """
    if prepared.study.verify is None:
        return {}
    sample = sample_of(prepared, arrays, ("motion_status", STATUS["not_computed"]))
    return verified_at(prepared, sample, arrays, watch)


def verified_alone(prepared: Simulation, watch: Watch) -> dict[str, str | int]:
    """Return the outcome of following some cells by two methods; empty if not asked for."""
    if prepared.study.verify is None:
        return {}
    places, count = chosen_positions(prepared)
    return verified_at(prepared, Sample(prepared.grid, places, count, count), None, watch)


def verified_at(
    prepared: Simulation,
    sample: Sample,
    arrays: Mapping[str, NDArray[np.generic]] | None,
    watch: Watch,
) -> dict[str, str | int]:
    """Return the outcome of following given cells again by another method, as attributes by name.

    `arrays` are the computed outputs, SI units; if None, the cells are simulated again.
    """
    plan = prepared.plan
    other = other_method(plan, prepared.grid)
    assert other is not None  # the study would have been refused
    against = f"the method {other.name}"
    if not sample.count or watch.stopped():
        return sample.verification_attributes(against)
    cells = prepared.grid.at(sample.positions, sample.count, plan.parameters)
    if arrays is None:
        known = run_equations(plan, cells, replace(watch, progress=None))
        at = {name: np.broadcast_to(known[name], sample.count) for name in plan.outputs}
    else:
        at = {name: sample.at(arrays[name], prepared.dims[name]) for name in plan.outputs}
    got = {name: np.asarray(from_si(name, values)) for name, values in at.items()}
    comparison = compare(plan, cells, got, other.name, watch)
    left = sum(comparison.silent.values())
    more: dict[str, str | int] = {NOT_JUDGED: left} if left else {}
    evaluated, compared = int(comparison.evaluated.sum()), int(comparison.compared.sum())
    worst = comparison.in_words(sample.where(comparison.cell)) if evaluated else ""
    return more | sample.verification_attributes(
        against, worst, evaluated=evaluated, compared=compared, failed=comparison.failed
    )
