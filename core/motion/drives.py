"""From the numbers of a drive to its wave: which kind a study gives, and what its wave is.

A study that gives numbers of no other drive has the plain sine of `amplitude`, `alpha` and `beta`,
and its system carries nothing of what stands here.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Protocol

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array, cosine, ratio, sine
from vibrafeed.core.motion import limits, waves
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.result import STATUS, Motion
from vibrafeed.core.motion.waves import TURN, Wave
from vibrafeed.core.quantities.drives import AXES, DRIVE
from vibrafeed.core.scenes import Scene
from vibrafeed.core.scenes.scene import Equation
from vibrafeed.core.watch import Watch

CLOSED = 1e-9
"""Mean acceleration over the mean size of its steps, below which it is rounding of the study's
numbers and set to 0."""

SHORTEST = 1e-12
"""Shortest step of a drive, as a share of the period: shorter ones are left out."""

SINE = (
    *("amplitude", "peak_to_peak", "vertical_amplitude", "vertical_peak_to_peak"),
    *("alpha", "beta"),
)
"""Parameters of the plain sine."""

_HARMONIC = re.compile(r"(?:amplitude|phase)_(along|across|normal)_(\d+)")
_STEP = re.compile(r"(?:acceleration_(along|across|normal)|duration)_(\d+)")


class Shape(Protocol):
    """The numbers that a drive has; its values are parameters like any other."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed."""

    @property
    def defaults(self) -> dict[str, float]:
        """Default values of the quantities that a study may omit, SI units."""

    def wave(self, **inputs: Array) -> Wave:
        """Return the wave for these quantities, arrays in SI units that broadcast."""


@dataclass(frozen=True)
class Harmonics:
    """Sines on each axis, at whole multiples of the frequency.

    The displacement of the track along an axis is the sum of A_k sin(k w t + phi_k).

    Attributes
    ----------
    terms : tuple of (axis, order)
    """

    terms: tuple[tuple[str, int], ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed, parameters of a study."""
        numbers = [
            f"{what}_{axis}_{k}" for what in ("amplitude", "phase") for axis, k in self.terms
        ]
        return ("frequency", "gravity", "drive_factor", *numbers)

    @property
    def defaults(self) -> dict[str, float]:
        """Default values of the phases, 0, and of the factor of the drive, 1."""
        return {"drive_factor": 1.0, **{f"phase_{axis}_{k}": 0.0 for axis, k in self.terms}}

    def wave(self, **inputs: Array) -> Wave:
        """Return the drive of harmonics: push k^2 w^2 A_k sin(k tau + phi_k)/g on each axis.

        Summed over the orders k. `inputs` are arrays by name in SI units: the frequency f, w = 2 pi
        f, amplitudes A_k of the track's displacement and phases phi_k, gravity g, and the factor of
        the drive.
        """
        inputs = _aligned(inputs)
        shape = np.broadcast_shapes(*(value.shape for value in inputs.values()))
        harmonics = np.zeros((3, 2, max(k for _, k in self.terms), *shape))
        unit = inputs["drive_factor"] * np.square(TURN * inputs["frequency"]) / inputs["gravity"]
        for axis, k in self.terms:
            size = k * k * inputs[f"amplitude_{axis}_{k}"] * unit
            phase = inputs[f"phase_{axis}_{k}"]
            harmonics[AXES.index(axis), 0, k - 1] = size * cosine(phase)
            harmonics[AXES.index(axis), 1, k - 1] = size * sine(phase)
        return Wave(harmonics, np.zeros((4, 0, *shape)))


@dataclass(frozen=True)
class Steps:
    """Constant acceleration, from step to step; where one level is left out it closes the wave.

    Attributes
    ----------
    count : int
        Steps of a period.
    levels : tuple of (axis, step)
        The accelerations that are given.
    """

    count: int
    levels: tuple[tuple[str, int], ...]

    @property
    def closing(self) -> dict[str, int]:
        """The step on each axis whose acceleration is computed so that the mean is 0.

        That is the step without its own acceleration, if there is exactly one.
        """
        given = {axis: [n for a, n in self.levels if a == axis] for axis, _ in self.levels}
        missing = {axis: set(range(1, self.count + 1)) - set(n) for axis, n in given.items()}
        return {axis: min(left) for axis, left in missing.items() if len(left) == 1}

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed: levels and durations of steps.

        The step on each axis whose acceleration makes the mean 0 has none.
        """
        axes = dict.fromkeys(axis for axis, _ in self.levels)
        levels = [
            f"acceleration_{axis}_{n}"
            for axis in axes
            for n in range(1, self.count + 1)
            if self.closing.get(axis) != n
        ]
        durations = [f"duration_{n}" for n in range(1, self.count + 1)]
        return ("gravity", "drive_factor", *levels, *durations)

    @property
    def defaults(self) -> dict[str, float]:
        """Default values of the durations and of the factor of the drive, all 1."""
        return {"drive_factor": 1.0, **{f"duration_{n}": 1.0 for n in range(1, self.count + 1)}}

    def wave(self, **inputs: Array) -> Wave:
        """Return the drive whose acceleration is constant from step to step, over one period.

        `inputs` are arrays by name: accelerations of steps [m s-2], durations, of which only ratios
        count, gravity and the factor of the drive; the acceleration that is left out on an axis
        makes the mean 0. Steps shorter than `SHORTEST` of a period vanish. NaN in cells where a
        mean acceleration is not 0: no track can do that.
        """
        inputs = _aligned(inputs)
        shape = np.broadcast_shapes(*(value.shape for value in inputs.values()))
        last = np.stack([np.broadcast_to(inputs[f"duration_{n}"], shape)
                         for n in range(1, self.count + 1)])  # fmt: skip
        last = ratio(last, last.sum(axis=0), np.nan)
        last = np.where(last < SHORTEST, 0.0, last)
        last = last / last.sum(axis=0)
        steps = np.zeros((4, self.count, *shape))
        for axis in dict.fromkeys(axis for axis, _ in self.levels):
            steps[AXES.index(axis)] = self._levels(axis, inputs, last)
        ends = TURN * np.cumsum(last, axis=0)
        ends[-1] = np.where(np.isnan(ends[-1]), np.nan, TURN)
        steps[waves.ENDS] = ends
        return Wave(np.zeros((3, 2, 0, *shape)), steps)

    def _levels(self, axis: str, inputs: dict[str, Array], last: Array) -> Array:
        """Return the push of a drive in steps on a part along one axis, step by step, in g.

        Minus the acceleration of the track over gravity. `axis` is along, across or normal,
        `inputs` are the quantities of the drive by name, `last` are the shares of the period that
        the steps last, shape (steps, ...), as is the result. A step whose acceleration is left out
        makes the mean 0. NaN in cells where the mean is not 0: no track can do that.
        """
        levels = np.zeros_like(last)
        closing = self.closing.get(axis, 0)
        for n in range(1, self.count + 1):
            if n != closing:
                levels[n - 1] = inputs[f"acceleration_{axis}_{n}"]
        if closing:
            levels[closing - 1] = ratio(-(levels * last).sum(axis=0), last[closing - 1], 0.0)
        mean = (levels * last).sum(axis=0)
        open_by = np.abs(mean) > CLOSED * (np.abs(levels) * last).sum(axis=0)
        levels = np.where(open_by, np.nan, levels - mean)
        for n in range(1, self.count):  # a step of no length is one with a step beside it
            levels[n] = np.where(last[n] == 0.0, levels[n - 1], levels[n])
        for n in range(self.count - 2, -1, -1):
            levels[n] = np.where(last[n] == 0.0, levels[n + 1], levels[n])
        return -levels * inputs["drive_factor"] / inputs["gravity"]


def _aligned(inputs: dict[str, Array]) -> dict[str, Array]:
    """Return the inputs as float arrays."""
    return {name: np.asarray(value, dtype=float) for name, value in inputs.items()}


def what_is_open(shape: Shape, values: Mapping[str, Array]) -> list[Problem]:
    """Return the problem if no combination of the given values makes a valid drive; else empty.

    A drive in steps must have some duration, and a mean acceleration of 0 on each axis. `shape` is
    the drive that the study's names define, `values` are its parameters in SI units.
    """
    given = {name: values.get(name, shape.defaults.get(name, 1.0)) for name in shape.inputs}
    wave = shape.wave(**{name: np.asarray(value) for name, value in given.items()})
    if not np.all(np.isnan(waves.size(wave))):
        return []
    if np.all(np.isnan(wave.steps[waves.ENDS])):
        message = "all steps of the drive have a duration of 0"
        return [
            Problem(
                "parameters.duration_1",
                message,
                "Give at least one step of the drive a duration above 0",
            )
        ]
    axis = next(axis for i, axis in enumerate(AXES) if np.all(np.isnan(wave.steps[i]).any(axis=0)))
    message = f"the mean acceleration {axis} is not 0: the track would run away"
    fix = (
        "Leave one of its steps out, which then closes the wave, or change durations so that the "
        "sum of acceleration times duration is 0"
    )
    return [Problem(f"parameters.acceleration_{axis}_1", message, fix)]


def shape_of(parameters: Iterable[str]) -> tuple[Shape | None, list[Problem]]:
    """Return the kind of drive that a study's parameter names define, and problems of these names.

    Harmonics such as `amplitude_along_2`, steps such as `acceleration_along_1`, or None for the
    plain sine; also None if there are problems, such as names of two kinds.
    """
    known = {*DRIVE, *SINE}
    names = [name for name in parameters if name in known]
    terms = {(m[1], int(m[2])) for m in filter(None, map(_HARMONIC.fullmatch, names))}
    steps = list(filter(None, map(_STEP.fullmatch, names)))
    sines = [name for name in SINE if name in names]
    if terms and steps:
        fix = "Give one kind of drive"
        return None, [_mixed(steps[0][0], "a drive in steps", "harmonics", fix)]
    if sines and (terms or steps):
        other = "harmonics" if terms else "steps"
        return None, [_mixed(name, "the plain sine", other, _NO_SINE[other]) for name in sines]
    if terms:
        return Harmonics(tuple(sorted(terms, key=_by_axis))), []
    return _steps_of(steps) if steps else (None, [])


_NO_SINE = {
    "harmonics": (
        "Remove it, and write amplitude_along_1 = amplitude cos(beta) and amplitude_normal_1 = "
        "amplitude sin(beta), which is the vertical amplitude, both from zero to peak"
    ),
    "steps": "Remove it, or the steps",
}
"""What to do where a study gives the plain sine beside another drive."""


def _steps_of(names: list[re.Match[str]]) -> tuple[Steps | None, list[Problem]]:
    """Return the drive in steps that parameter names define (None if incomplete), and problems.

    `names` are matches of the pattern of such names, such as `acceleration_along_1` and
    `duration_2`: group 1 is the axis, None for a duration, group 2 the number of the step.
    """
    levels = {(m[1], int(m[2])) for m in names if m[1]}
    count = max(int(m[2]) for m in names)
    if not levels or count == 1:
        message = (
            "a single step is not a complete drive" if levels else "steps need an acceleration"
        )
        fix = "Add, for example, acceleration_along_1, duration_1 and duration_2"
        return None, [Problem(f"parameters.{names[0][0]}", message, fix)]
    return Steps(count, tuple(sorted(levels, key=_by_axis))), []


def _mixed(name: str, kind: str, other: str, fix: str) -> Problem:
    """Return the problem of a parameter `name` that belongs to another kind of drive.

    `kind` is the drive that it belongs to, `other` the one that the study gives too, `fix` the
    remedy.
    """
    return Problem(
        f"parameters.{name}", f"{name} belongs to {kind}, but the study also gives {other}", fix
    )


def _by_axis(term: tuple[str, int]) -> tuple[int, int]:
    """Return the sort key of an axis and an order."""
    return AXES.index(term[0]), term[1]


# --- the system of a part under such a drive: the same equations around a wave


AT_LIMIT = 1e-13
"""Relative excess over the limit of static friction up to which a step of a drive is still at the
limit, so that rounding does not decide."""


def drive_number(*, wave: Wave) -> Array:
    """Return an upper bound of the track's speed, over g/w [1]."""
    return waves.size(wave)


def drive_number_along(*, wave: Wave) -> Array:
    """Return an upper bound of the drive acceleration along the track, over gravity [1]."""
    return waves.bound(wave, waves.ALONG)


def drive_number_across(*, wave: Wave) -> Array:
    """Return an upper bound of the drive acceleration across the track, over gravity [1]."""
    return waves.bound(wave, waves.ACROSS)


def drive_number_normal(*, wave: Wave) -> Array:
    """Return an upper bound of the drive acceleration normal to the floor, over gravity [1]."""
    return waves.bound(wave, waves.NORMAL)


def throw_number(*, wave: Wave, load_number: Array) -> Array:
    """Return the throw number, the largest upward drive acceleration over the load number [1]."""
    most = np.maximum(waves.largest_over_period(wave, waves.NORMAL, "push"), 0.0)
    return ratio(most, load_number, np.where(most > 0.0, np.inf, 0.0))


def efficiency(*, motion: Motion, wave: Wave) -> Array:
    """Return the conveying velocity over the largest speed of the track along x; 0 at rest [1].

    Infinite (regime `unbounded`) for a part that moves though the track does not move along x.
    """
    v, fastest = motion.velocity, waves.largest_over_period(wave, waves.ALONG, "speed")
    beyond = np.where(np.isnan(v), np.nan, np.copysign(np.inf, v))
    return np.where(v != 0, ratio(v, fastest, beyond), 0.0)


def _where_driven(follow: Any) -> Any:
    """Return the function of a motion equation, extended by status `no_drive` for invalid waves.

    `follow` is the function for valid ones. A wave is invalid if its mean acceleration is not 0: no
    track can do that; its numbers are then NaN.
    """

    def driven_motion(*, groups: Groups, watch: Watch | None = None, **settings: Array) -> Motion:
        found: Motion = follow(groups=groups, watch=watch, **settings)
        assert groups.wave is not None
        none = np.isnan(waves.size(groups.wave))
        status = np.where(none, np.int8(STATUS["no_drive"]), found.status)
        return found._replace(status=status)

    return driven_motion


def _held_at_its_limit(groups: Groups, wave: Wave) -> Array:
    """Return the static friction, raised by a rounding where a step needs exactly its limit.

    A sine passes the limit at a phase, but a step may lie on it as long as it lasts, as the best
    drives do; where kinetic friction is smaller, the last bit of a sum would decide the motion.
    """
    static: Array = groups.friction_static
    if not wave.steps.shape[1]:
        return static
    return np.where(static > groups.friction_kinetic, static * (1.0 + AT_LIMIT), static)


@cache
def _with_wave(groups: Any) -> Any:
    """Return the function of the equation for a part's groups, with the wave of a drive added.

    `groups` is the function under a sine; the new one takes the argument `wave`, too.
    """

    def waved(*, wave: Wave, **numbers: Array) -> Groups:
        found: Groups = groups(**numbers)
        return found._replace(wave=wave, friction_static=_held_at_its_limit(found, wave))

    return waved


_OTHERS = {one.gives: one for one in limits.equations("wave")} | {
    function.__name__: Equation(function.__name__, function, "theory 13.14")
    for function in (
        drive_number, drive_number_along, drive_number_across, drive_number_normal, throw_number,
        efficiency,
    )
}  # fmt: skip


def under_wave(shape: Shape, known: Collection[Equation]) -> tuple[Equation, ...]:
    """Return the equations of a conveying system with a wave in place of the sine drive.

    `shape` tells the kind of wave and its parameters; `known` are the equations under a sine, of
    which those that hold for any drive stay.
    """
    changed = []
    for equation in known:
        if equation.gives == "groups":
            waved, needs = _with_wave(equation.function), ("wave", *equation.inputs)
            equation = replace(equation, function=waved, needs=needs, says=equation.summary)
        if equation.gives == "motion":
            follow, needs = _where_driven(equation.function), equation.inputs
            equation = replace(equation, function=follow, needs=needs, says=equation.summary)
        if equation.gives != "vibration_acceleration":
            changed.append(_OTHERS.get(equation.gives, equation))
    says = "Return the push of the drive on a part, per weight."
    wave = Equation("wave", shape.wave, "theory 13.14", needs=shape.inputs, says=says)
    return (wave, *changed)


def driven(system: Scene, shape: Shape) -> Scene:
    """Return a copy of a scene of motion in which another drive takes the place of the sine.

    `system` is the scene with its equations for each method (`variants`) and default values;
    `shape` is the kind of drive with its own parameters and defaults. The default of `alpha`, the
    azimuth of the sine, is dropped.
    """
    return replace(
        system,
        variants={name: under_wave(shape, known) for name, known in system.variants.items()},
        defaults={**{n: v for n, v in system.defaults.items() if n != "alpha"}, **shape.defaults},
    )
