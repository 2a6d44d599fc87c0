"""Derivatives of simulated motion by the parameters of a study (theory 13.16).

Where a part of one restitution moves in the plane of the track and its normal under a sine they are
exact, carried through the events of the cycle. Any other motion is followed again on both sides.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import compiled, planar
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.groups import Contacts, Groups, cells_of, in_plane
from vibrafeed.core.motion.kernels.planar.slope_tables import DERIVED, DERIVED_BY
from vibrafeed.core.motion.result import COLUMNS, STATUS, Energy, Motion, motion_of
from vibrafeed.core.motion.systems import CONTACTS
from vibrafeed.core.plan.derivatives import (
    DERIVATIVE_STATUS,
    Derivatives,
    Derived,
    Rule,
    Ruled,
    derivatives,
    values_of,
)
from vibrafeed.core.plan.duals import Dual, slope_of, value_of
from vibrafeed.core.plan.equations import regimes, run
from vibrafeed.core.plan.plan import Plan, plan_scene
from vibrafeed.core.watch import Watch

HALVINGS = 12  # times that the step of a finite difference is halved
LARGEST_STEP = 0.02  # relative step of a parameter, the first of a series of finite differences
TRUSTED = 1e-3  # largest relative error of a derivative by differences that is still reported
BY_DIFFERENCES = ("effective_mass_ratio", "part_load")
"""Quantities without exact derivatives: plans with these are derived by differences."""
COUNTS = ("period_multiple", "impacts_per_period", "collisions_per_period")
"""Whole numbers that do not change inside a regime; a scene may lack some."""

BY = (
    "drive_number_along", "drive_number_normal", "gravity_number_along", "gravity_number_normal",
    "friction_static", "friction_kinetic", "restitution",
)  # fmt: skip
"""The groups that a motion in the plane is derived by, in the order of the kernel."""
ACROSS = ("drive_number_across", "gravity_number_across", "curvature_number")
"""Dimensionless numbers that push a part across the track."""
MOTION_MEANS = ("velocity", "stick", "forward", "backward", "flight", "landing_speed", "hop_height")
"""The fields of `Motion` that are derived, in the order of the kernel; those of `Energy` follow."""

SLOPED = Energy._fields.index("swing")
"""Fields of `Energy` before this one are derived in the kernel; it is not."""


@dataclass
class PlanarRules:
    """The rules of the equations `motion` and `energy` of a system, in the plane under a sine.

    What was computed last is kept: the same cells are derived by one parameter after another.

    Attributes
    ----------
    contacts : Contacts
        What the part can touch.
    energy : bool
        Whether the energies are wanted.
    watch : Watch, optional
        May stop it; what is not finished is not computed.
    """

    contacts: Contacts
    energy: bool
    watch: Watch | None = None
    _known: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]] | None = field(
        default=None, repr=False
    )
    _spent: tuple[NDArray[np.float64], NDArray[np.float64]] | None = field(default=None, repr=False)

    @property
    def rules(self) -> dict[str, Rule]:
        """The derivative rules of the equations, by the quantity that each equation gives."""
        return {"motion": self.motion, "energy": self.spent}

    def motion(self, inputs: Mapping[str, Any]) -> Ruled:
        """Return the motion with its derivative by one parameter, and the status of the derivative.

        `inputs` are those of the motion's equation by name, as numbers that carry a derivative by
        the parameter. The kernel gives derivatives by the dimensionless groups, which the chain
        rule joins with theirs; numbers that only count have the derivative 0. The status, one a
        cell, says where there is none.
        """
        groups: Groups = inputs["groups"]
        table, status = self._followed(groups, inputs["tolerance"], inputs["max_periods"])
        motion = motion_of(table[:, :COLUMNS], status, (len(status),))
        slopes = table[:, COLUMNS:-1].reshape(-1, len(DERIVED), DERIVED_BY)
        by = [np.asarray(slope_of(getattr(groups, name))) for name in BY]
        fields = motion._asdict()
        for place, name in enumerate(MOTION_MEANS):
            fields[name] = Dual(fields[name], _chained(slopes[:, place], by), [])
        for name in ("spread", "error", "impacts", "multiple", "across"):
            fields[name] = Dual(fields[name], 0.0, [])
        jump = np.isnan(slopes[:, 0, BY.index("restitution")]) & (by[-1] != 0)
        return Motion(**fields), self._status(groups, motion, np.where(jump, 0.0, table[:, -1]))

    def spent(self, inputs: Mapping[str, Any]) -> Ruled:
        """Return the energies of the motion with derivatives by one parameter, and a status of 0.

        The status is left to the rule of the motion. `inputs` are those of the energy's equation by
        name, as numbers that carry a derivative by the parameter. `swing`, the last field, has no
        derivative: NaN.
        """
        groups: Groups = inputs["groups"]
        settings = (inputs["tolerance"], inputs["max_periods"])
        table, _ = self._followed(groups, *settings)
        slopes = table[:, COLUMNS:-1].reshape(-1, len(DERIVED), DERIVED_BY)[:, len(MOTION_MEANS) :]
        if self._spent is None or self._spent[0] is not table:
            cells, width = self._cells(groups, *settings), len(Energy._fields)
            found, _ = run_cells(planar.spend_cells, cells, columns=width, watch=self._silent)
            self._spent = table, found
        by = [np.asarray(slope_of(getattr(groups, name))) for name in BY]
        fields: list[Any] = [
            Dual(column, _chained(slopes[:, place], by), [])
            for place, column in enumerate(self._spent[1].T[:SLOPED])
        ]
        fields.append(Dual(self._spent[1].T[SLOPED], np.nan, []))
        return Energy(*fields), 0

    @property
    def _silent(self) -> Watch | None:
        """Return the watch without its progress, which would be counted twice; None without one."""
        return None if self.watch is None else replace(self.watch, progress=None)

    def _cells(self, groups: Groups, tolerance: Any, max_periods: Any) -> NDArray[np.float64]:
        """Return the kernel's input of the cells, one row of numbers each, without derivatives.

        `groups` are the dimensionless groups of the part, which may carry derivatives by a
        parameter; `tolerance` and `max_periods` are settings of the method. Restitution is set to 0
        where the part never lifts off, so that cells with one motion have equal rows, and are
        computed once.
        """
        plain = Groups(*(value_of(number) for number in groups.numbers)).flat()
        lifts = np.abs(plain.drive_number_normal) > plain.gravity_number_normal
        plain = plain._replace(restitution=np.where(lifts, plain.restitution, 0.0))
        # Restitution plays no part in a cell that never lifts off: equal cells are computed once.
        return cells_of(plain, tolerance=tolerance, max_periods=max_periods)[0]

    def _followed(
        self, groups: Groups, tolerance: Any, max_periods: Any
    ) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
        """Return the results of the cells with their derivatives, and statuses, by `derive_cells`.

        A row a cell with the kernel's `DERIVED_COLUMNS`, and a status a cell. `groups` are the
        cells' dimensionless numbers, `tolerance` and `max_periods` settings of the method; the last
        result is kept and used again for equal cells.
        """
        cells = self._cells(groups, tolerance, max_periods)
        if self._known is None or not np.array_equal(self._known[0], cells):

            def derive(piece: Any, rows: Any, status: Any, stop: Any) -> None:
                """Run the kernel on a piece of the cells."""
                planar.derive_cells(self.energy, piece, rows, status, stop)

            found = run_cells(
                derive, cells, columns=compiled.derive.DERIVED_COLUMNS, watch=self._silent
            )
            self._known = (cells, *found)
        return self._known[1:]

    def _status(self, groups: Groups, motion: Motion, margin: Array) -> Any:
        """Return the status of the derivative of each cell: exact, or the reason why there is none.

        `groups` carry derivatives by one parameter, `motion` is the motion. `margin` is the least
        relative distance of a decision on the way, such as stick or slip, from its other outcome:
        below `KINK` the motion has a kink. Derivatives by what presses a part to a wall are kinks,
        too.
        """
        status = np.where(
            margin > compiled.derive.KINK, DERIVATIVE_STATUS["exact"], DERIVATIVE_STATUS["kink"]
        )
        if self.contacts.wall:  # a push across presses the part to the wall, or off it
            pushed = [np.asarray(slope_of(getattr(groups, name))) != 0 for name in ACROSS]
            status = np.where(reduce(np.logical_or, pushed), DERIVATIVE_STATUS["kink"], status)
        repeats = np.isin(motion.status, [STATUS["periodic"], STATUS["at_rest"]])
        status = np.where(repeats, status, DERIVATIVE_STATUS["not_periodic"])
        # Without friction the speed is that of the start; with the least friction it is another.
        status = np.where(motion.status == STATUS["neutral"], DERIVATIVE_STATUS["kink"], status)
        left = motion.status == STATUS["not_computed"]
        return np.where(left, DERIVATIVE_STATUS["not_computed"], status).astype(np.int8)


def _chained(slopes: Array, by: list[Array]) -> Array:
    """Return the derivative of a result by a parameter, by the chain rule over all groups.

    `slopes`, shape (cells, groups), are derivatives by the groups; `by` holds the derivative of
    each group by the parameter.
    """
    terms = (np.where(slope == 0, 0.0, slopes[:, place] * slope) for place, slope in enumerate(by))
    return sum(terms, start=np.zeros(len(slopes)))


def is_exact(plan: Plan, groups: Groups) -> NDArray[np.bool_]:
    """Return a mask of the cells whose motion has exact derivatives in closed form.

    That is motion in the plane under a sine by the method `events`, with constant restitution; a
    mask of one element, False, if the plan has none.
    """
    contacts = CONTACTS.get(plan.scene.name)
    by_differences = any(equation.gives in BY_DIFFERENCES for equation in plan.equations)
    if contacts is None or plan.variant != "events" or groups.wave is not None or by_differences:
        return np.zeros(1, dtype=bool)
    return np.atleast_1d(in_plane(groups, contacts) & np.equal(groups.impact_damping, 0.0))


def groups_at(plan: Plan, values: Mapping[str, Any]) -> Groups | None:
    """Return the dimensionless groups of cells from parameters in SI units; None if there are none.

    The equations of the plan are run up to the first that follows motions. A plan of tumbling parts
    has no groups. `values` are the parameters by name, arrays of one shape; others have their
    defaults.
    """
    before = []
    for equation in plan.equations:
        if equation.takes_long:
            break
        before.append(equation)
    known: dict[str, Any] = {name: np.asarray(value) for name, value in plan.defaults.items()}
    groups: Groups | None = run(before, known | dict(values)).get("groups")
    return groups


def derivatives_at(
    plan: Plan,
    cells: Mapping[str, Any],
    parameters: Collection[str],
    watch: Watch | None = None,
) -> Derivatives:
    """Return the derivatives of a plan's outputs at some cells by some parameters.

    Exact for closed forms, and for motion in the plane under a sine; elsewhere they are
    extrapolated from differences, which follow the part 25 times for each parameter.

    Parameters
    ----------
    plan : Plan
        Plan of a scene, or of a system of `vibrafeed.core.motion.systems` with the settings of its
        method among the defaults.
    cells : mapping of str to array_like
        Parameters of the cells by name, SI units.
    parameters : collection of str
        Names of those to differentiate by.
    watch : Watch, optional
        May stop the work; derivatives that are not finished have the status `not_computed`.

    Raises
    ------
    StudyError
        As `vibrafeed.core.plan.derivatives.derivatives` does.
    """
    watch = watch or Watch()
    if not any(equation.takes_long for equation in plan.equations):
        return derivatives(plan, cells, parameters)
    values = values_of(plan, cells, parameters)
    shape = next(iter(values.values())).shape
    groups = groups_at(plan, values)
    exact = np.zeros(shape, dtype=bool)
    if groups is not None:
        exact |= is_exact(plan, groups)
    slopes_at = {(o, p): _nothing(shape) for p in parameters for o in plan.outputs}
    share = exact.mean()
    if exact.any():
        energy = any(equation.gives == "energy" for equation in plan.equations)
        rules = PlanarRules(CONTACTS[plan.scene.name], energy, watch.part(share)).rules
        some = {name: value[exact] for name, value in values.items()}
        for key, derived in derivatives(plan, some, parameters, rules).items():
            slopes_at[key].put(exact, derived)
        watch.advance(share)
    for cell in np.flatnonzero(~exact):
        if watch.stopped():
            break
        one = {name: value[cell : cell + 1] for name, value in values.items()}
        for key, derived in _by_differences(plan, one, parameters).items():
            slopes_at[key].put(np.arange(exact.size) == cell, derived)
        watch.advance(1.0 / exact.size)
    return slopes_at


def _nothing(shape: tuple[int, ...]) -> Derived:
    """Return derivatives of a shape without any value, with the status `not_computed`."""
    value, slope, error, below, above = (np.full(shape, np.nan) for _ in range(5))
    status = np.full(shape, DERIVATIVE_STATUS["not_computed"], dtype=np.int8)
    return Derived(value, slope, error, status, below, above, np.zeros(shape, dtype=bool))


# --- by differences


def _by_differences(
    plan: Plan, values: Mapping[str, Array], parameters: Collection[str]
) -> Derivatives:
    """Return derivatives of simulated outputs at one cell, by finite differences within its regime.

    Central differences over steps that halve from 2 % down are extrapolated (Ridders), and the
    value of least error is kept. Steps across which regime, period multiple or impacts a period
    change are left out. NaN if nothing remains, if the motion is aperiodic or has no value, or if
    the error estimate exceeds a thousandth: next to a jump, or where the motion depends on its
    parameters too roughly.

    `plan` has the scene, method and outputs; `values` are the parameters of the cell, SI units,
    arrays of one element, of which those named in `parameters` are varied. The result is by output
    and parameter.
    """
    gives = plan.scene.outputs(plan.variant)
    counts = tuple(name for name in COUNTS if name in gives)
    outputs, asked = plan.outputs, tuple(dict.fromkeys((*plan.outputs, *counts)))
    more = plan_scene(plan.scene, plan.variant, asked, plan.parameters)
    settings = {name: value for name, value in plan.defaults.items() if name in more.defaults}
    plan = replace(more, defaults={**more.defaults, **settings})
    steps = LARGEST_STEP * 0.5 ** np.arange(HALVINGS)
    derivatives: Derivatives = {}
    for parameter in parameters:
        at = float(values[parameter][0])
        step = steps * (abs(at) or 1.0)
        around = at + np.concatenate([[0.0], -step, step])
        known = run(plan.equations, {**values, parameter: around})
        same = _same_regime(plan, known, counts)
        for output in outputs:
            results = np.broadcast_to(known[output], around.shape)
            if same is None:
                derivatives[output, parameter] = _lost(results[0], "not_periodic")
                continue
            inside = np.broadcast_to(same, around.shape)
            inside = inside[1 : 1 + HALVINGS] & inside[1 + HALVINGS :]
            low, high = results[1 : 1 + HALVINGS], results[1 + HALVINGS :]
            differences = ((high - low) / (2 * step))[inside]
            derivatives[output, parameter] = _extrapolated(float(results[0]), differences)
    return derivatives


def _same_regime(plan: Plan, known: Mapping[str, Any], counts: Collection[str]) -> Any:
    """Return a mask of motions with the regime of the first one; None if that does not repeat.

    Between motions of one regime, which have the same sequence of modes, a difference quotient
    tells the derivative. `plan` is that of the study, `known` holds the quantities of all motions;
    `counts` are the names of whole numbers, the period multiple first, that must be the same.
    """
    verdicts = regimes(plan, known)
    alike = (*(known[name] for name in counts), *verdicts.values())
    kinds = np.stack(np.broadcast_arrays(*alike)).reshape(len(alike), -1)
    if not kinds[0, 0] >= 1:
        return None
    return np.isclose(kinds, kinds[:, :1], rtol=1e-12, atol=0).all(axis=0)


def _extrapolated(value: float, differences: Array) -> Derived:
    """Return a derivative as the limit of central differences, with error and status.

    `value` is the output itself at the cell, and `differences` holds the differences over the step,
    each of half the step of the one before. Ridders' extrapolation takes off the errors of even
    powers of the step, and keeps the value that changed least. NaN with the status `no_value` or
    `unsettled` if the output is not finite or the error is above 1e-3 of the derivative.
    """
    if not math.isfinite(value):
        return _lost(value, "no_value")
    best, error = math.nan, math.inf
    above: list[float] = []
    for difference in map(float, differences):
        row = [difference]
        for order, former in enumerate(above, 1):
            row.append(row[-1] + (row[-1] - former) / (4.0**order - 1))
            apart = max(abs(row[-1] - row[-2]), abs(row[-1] - former))
            if apart < error:
                best, error = row[-1], apart
        above = row
    if not math.isfinite(best) or error > TRUSTED * abs(best):
        return _lost(value, "unsettled")
    return _single_cell(value, best, error, "differences")


def _lost(value: float, status: str) -> Derived:
    """Return the record of a derivative that could not be computed, with its status.

    `value` is the output itself, which is known.
    """
    return _single_cell(value, math.nan, math.nan, status)


def _single_cell(value: float, slope: float, error: float, status: str) -> Derived:
    """Return the record of a derivative at a single cell, with arrays of one element.

    `value` is the output, `slope` its derivative, `error` that of the derivative, `status` the name
    of its status, such as "differences".
    """
    single = _nothing((1,))
    single.value[:], single.slope[:], single.error[:], single.status[:] = (
        value,
        slope,
        error,
        DERIVATIVE_STATUS[status],
    )
    return single
