"""From the numbers of a drive to its wave: which kind a study gives, and what its wave is.

A study that gives numbers of no other drive has the plain sine of `amplitude`, `alpha` and `beta`,
and its system carries nothing of what stands here.
"""

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, ClassVar

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array, cosine, hypot, ratio, sine
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, Motion, in_plane
from vibrafeed.core.quantities.drives import AXES, DRIVE, WHERE
from vibrafeed.core.quantities.plate import TURNS
from vibrafeed.core.scenes import Scene
from vibrafeed.core.scenes.scene import Equation, arguments_of
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

ARMS = {
    "yaw": (("along", "position_y", -1.0), ("across", "position_x", 1.0)),
    "tilt_x": (("normal", "position_y", 1.0),),
    "tilt_y": (("normal", "position_x", -1.0),),
}
"""What a small turn of a plate moves at a place: the axis, the arm, its sign."""

_MOVES = (*AXES, *ARMS)
_HARMONIC = re.compile(rf"(?:amplitude|phase)_({'|'.join(_MOVES)})_(\d+)")
_STEP = re.compile(r"(?:acceleration_(along|across|normal)|duration)_(\d+)")


@dataclass(frozen=True)
class Harmonics:
    """Sines on each axis, at whole multiples of the frequency.

    The displacement of the track along an axis is the sum of A_k sin(k w t + phi_k); `terms` are
    pairs of an axis and an order k. A plate may turn as well, by small angles (`ARMS`): yaw psi and
    tilts theta move its place (X, Y) by (-psi Y, psi X, theta_x Y - theta_y X).
    """

    terms: tuple[tuple[str, int], ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed, parameters of a study."""
        numbers = [
            f"{what}_{axis}_{k}" for what in ("amplitude", "phase") for axis, k in self.terms
        ]
        return ("frequency", "gravity", "drive_factor", *numbers, *self.arms)

    @property
    def arms(self) -> dict[str, float]:
        """The coordinates of the place on a plate that turns, by default its origin [m]."""
        turns = any(axis in ARMS for axis, _ in self.terms)
        return {"position_x": 0.0, "position_y": 0.0} if turns else {}

    @property
    def defaults(self) -> dict[str, float]:
        """Default values of quantities that a study may omit, SI units."""
        phases = {f"phase_{axis}_{k}": 0.0 for axis, k in self.terms}
        return {"drive_factor": 1.0, **phases, **self.arms}

    def wave(self, **inputs: Array) -> waves.Wave:
        """Return the drive of harmonics: push k^2 w^2 A_k sin(k tau + phi_k)/g on each axis.

        Summed over the orders k. `inputs` are arrays by name in SI units; w = 2 pi f.
        """
        inputs, shape = _aligned(inputs)
        harmonics = np.zeros((3, 2, max(k for _, k in self.terms), *shape))
        unit = (
            inputs["drive_factor"] * np.square(waves.TURN * inputs["frequency"]) / inputs["gravity"]
        )
        for axis, k in self.terms:
            size = k * k * inputs[f"amplitude_{axis}_{k}"] * unit
            phase = inputs[f"phase_{axis}_{k}"]
            for along, arm, sign in ARMS.get(axis, ((axis, "", 1.0),)):
                moved = size * sign * inputs[arm] if arm else size
                harmonics[AXES.index(along), 0, k - 1] += moved * cosine(phase)
                harmonics[AXES.index(along), 1, k - 1] += moved * sine(phase)
        return waves.Wave(harmonics, np.zeros((4, 0, *shape)))


ELLIPSE = ("ellipse_major", "ellipse_minor", "ellipse_tilt")
"""Parameters of an elliptical drive."""


class Ellipse(Harmonics):
    """An ellipse in the plane of along and normal, by its semi-axes and the tilt of the longer.

    With the semi-axes a and b and the tilt theta the displacement is a sin(w t) along the line of
    theta, and -b cos(w t) across it, upwards.
    """

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed, parameters of a study."""
        return ("frequency", "gravity", "drive_factor", *ELLIPSE)

    @property
    def defaults(self) -> dict[str, float]:
        """Default values of quantities that a study may omit, SI units."""
        return {"drive_factor": 1.0}

    def wave(self, **inputs: Array) -> waves.Wave:
        """Return the drive, as of harmonics of order 1."""
        a, b, theta = (np.asarray(inputs.pop(name), dtype=float) for name in ELLIPSE)
        ways = {
            "along": (a * cosine(theta), b * sine(theta)),
            "normal": (a * sine(theta), -b * cosine(theta)),
        }
        for axis, (of_sine, of_cosine) in ways.items():
            inputs[f"amplitude_{axis}_1"] = hypot(of_sine, of_cosine)
            inputs[f"phase_{axis}_1"] = np.arctan2(of_cosine, of_sine)
        return super().wave(**inputs)


@dataclass(frozen=True)
class Steps:
    """Constant acceleration, from step to step; where one level is left out it closes the wave.

    `count` are the steps of a period, `levels` pairs of an axis and a step whose acceleration is
    given.
    """

    count: int
    levels: tuple[tuple[str, int], ...]

    @property
    def closing(self) -> dict[str, int]:
        """The step on each axis whose acceleration is computed so that the mean is 0, if any."""
        given = {axis: [n for a, n in self.levels if a == axis] for axis, _ in self.levels}
        missing = {axis: set(range(1, self.count + 1)) - set(n) for axis, n in given.items()}
        return {axis: min(left) for axis, left in missing.items() if len(left) == 1}

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities from which the wave is computed: levels and durations."""
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
        """Default values of quantities that a study may omit, SI units."""
        return {"drive_factor": 1.0, **{f"duration_{n}": 1.0 for n in range(1, self.count + 1)}}

    def wave(self, **inputs: Array) -> waves.Wave:
        """Return the drive whose acceleration is constant from step to step, over one period.

        `inputs` are arrays by name; of durations only ratios count. Steps shorter than `SHORTEST`
        of a period vanish. NaN in cells where a mean acceleration is not 0: no track can do that.
        """
        inputs, shape = _aligned(inputs)
        last = np.stack([np.broadcast_to(inputs[f"duration_{n}"], shape)
                         for n in range(1, self.count + 1)])  # fmt: skip
        last = ratio(last, last.sum(axis=0), np.nan)
        last = np.where(last < SHORTEST, 0.0, last)
        last = last / last.sum(axis=0)
        steps = np.zeros((4, self.count, *shape))
        for axis in dict.fromkeys(axis for axis, _ in self.levels):
            steps[AXES.index(axis)] = self._levels(axis, inputs, last)
        ends = waves.TURN * np.cumsum(last, axis=0)
        ends[-1] = np.where(np.isnan(ends[-1]), np.nan, waves.TURN)
        steps[waves.ENDS] = ends
        return waves.Wave(np.zeros((3, 2, 0, *shape)), steps)

    def _levels(self, axis: str, inputs: dict[str, Array], last: Array) -> Array:
        # The push, minus the track's acceleration over gravity, step by step; `last` are the shares
        # of the period that the steps last, shape (steps, ...), as is the result.
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
        # A step of no length is one with a step beside it.
        for n, beside in (
            *((n, n - 1) for n in range(1, self.count)),
            *((n, n + 1) for n in range(self.count - 2, -1, -1)),
        ):
            levels[n] = np.where(last[n] == 0.0, levels[beside], levels[n])
        return -levels * inputs["drive_factor"] / inputs["gravity"]


class HalfWave:
    """The drive of a unit whose force has a second harmonic, as a magnet's on a half wave has.

    Its displacement along the line of the vibration is A (sin(tau) + s sin(2 tau) + c cos(2 tau)),
    with s and c of `track_harmonic`.
    """

    inputs = (
        *("amplitude", "beta", "alpha", "track_harmonic", "circular_frequency", "gravity"),
        "drive_factor",
    )
    defaults: ClassVar = {"alpha": 0.0, "drive_factor": 1.0}

    def wave(self, **inputs: Any) -> waves.Wave:
        """Return the drive of a track under a force with a second harmonic, such as a magnet's.

        Its push is w^2 A sin(tau)/g, and 4 w^2 A (s, c)/g at 2 tau, along the line of vibration.
        """
        s, c = inputs.pop("track_harmonic")
        inputs, _ = _aligned(inputs)
        rate = np.square(inputs["circular_frequency"]) / inputs["gravity"]
        size = inputs["drive_factor"] * inputs["amplitude"] * rate
        level = size * cosine(inputs["beta"])
        along, across = level * cosine(inputs["alpha"]), level * sine(inputs["alpha"])
        numbers = [
            number
            for one in (along, across, size * sine(inputs["beta"]))
            for number in (one, 4.0 * one * s, 0.0 * one, 4.0 * one * c)
        ]
        harmonics = np.stack(np.broadcast_arrays(*numbers))
        shape = harmonics.shape[1:]
        return waves.Wave(harmonics.reshape(3, 2, 2, *shape), np.zeros((4, 0, *shape)))


Shape = Harmonics | Steps | HalfWave
"""The numbers that a drive has; its values are parameters like any other."""


def _aligned(inputs: dict[str, Array]) -> tuple[dict[str, Array], tuple[int, ...]]:
    arrays = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
    return arrays, np.broadcast_shapes(*(value.shape for value in arrays.values()))


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
        return [
            Problem(
                "parameters.duration_1",
                "all steps of the drive have a duration of 0",
                "Give at least one step of the drive a duration above 0",
            )
        ]
    axis = next(axis for i, axis in enumerate(AXES) if np.all(np.isnan(wave.steps[i]).any(axis=0)))
    return [
        Problem(
            f"parameters.acceleration_{axis}_1",
            f"the mean acceleration {axis} is not 0: the track would run away",
            "Leave out the acceleration of one step, which is then computed, or change durations "
            "so that the sum of acceleration times duration is 0",
        )
    ]


def shape_of(parameters: Iterable[str]) -> tuple[Shape | None, list[Problem]]:
    """Return the kind of drive that a study's parameter names define, and problems of these names.

    None for the plain sine, and if there are problems, such as names of two kinds.
    """
    known = {*DRIVE, *SINE, *TURNS}
    names = [name for name in parameters if name in known]
    terms = {(m[1], int(m[2])) for m in filter(None, map(_HARMONIC.fullmatch, names))}
    steps = list(filter(None, map(_STEP.fullmatch, names)))
    sines = [name for name in SINE if name in names]
    ellipse = [name for name in ELLIPSE if name in names]
    if (terms and steps) or (ellipse and (terms or steps)):
        mixed = (ellipse[0], "an ellipse") if ellipse else (steps[0][0], "a drive in steps")
        other = "harmonics" if terms else "steps"
        return None, [_mixed(*mixed, other, "Give one kind of drive")]
    if sines and (terms or steps or ellipse):
        other = "harmonics" if terms else "steps" if steps else "an ellipse"
        return None, [_mixed(name, "the plain sine", other, _NO_SINE[other]) for name in sines]
    if ellipse:
        return Ellipse((("along", 1), ("normal", 1))), []
    if terms:
        return Harmonics(tuple(sorted(terms, key=_by_axis))), []
    return _steps_of(steps) if steps else (None, [])


def _steps_of(steps: list[re.Match[str]]) -> tuple[Steps | None, list[Problem]]:
    levels = {(m[1], int(m[2])) for m in steps if m[1]}
    count = max(int(m[2]) for m in steps)
    if levels and count > 1:
        return Steps(count, tuple(sorted(levels, key=_by_axis))), []
    return None, [
        Problem(
            f"parameters.{steps[0][0]}",
            "a drive in steps needs at least two steps" if levels else "steps need an acceleration",
            "Add, for example, acceleration_along_1, duration_1 and duration_2",
        )
    ]


_NO_SINE = {
    "harmonics": (
        "Remove it, and write amplitude_along_1 = amplitude cos(beta) and amplitude_normal_1 = "
        "amplitude sin(beta), which is the vertical amplitude, both from zero to peak"
    ),
    "steps": "Remove it, or the steps",
    "an ellipse": "Remove it, or the ellipse",
}
"""What to do where a study gives the plain sine beside another drive."""


def _mixed(name: str, kind: str, other: str, fix: str) -> Problem:
    return Problem(
        f"parameters.{name}", f"{name} belongs to {kind}, but the study also gives {other}", fix
    )


def _by_axis(term: tuple[str, int]) -> tuple[int, int]:
    return _MOVES.index(term[0]), term[1]


# --- the demands of a drive on the machine, by axis


LIMITS: dict[str, tuple[str, Callable[..., Array], float, Callable[[waves.Wave, int], Array]]] = {
    "largest_acceleration": (
        "largest acceleration of the track {} over a period [m s-2]",
        lambda *, gravity: gravity,
        1.0,
        lambda wave, axis: waves.largest_over_period(wave, axis, "push size"),
    ),
    "stroke": (
        "stroke of the drive {}, peak to peak [m]",
        lambda *, length_scale: length_scale,
        2.0,
        waves.stroke,
    ),
    "largest_jerk": (
        "largest jerk of the drive {}, infinite where its acceleration jumps [m s-3]",
        lambda *, gravity, frequency: gravity * (waves.TURN * frequency),
        1.0,
        waves.jerk,
    ),
}
"""What each is, with {} for the axis, and its unit; its scale, of quantities by name; its value in
that scale of a sine, over the drive number of the axis, and of a wave on an axis."""


def limits(drive: str, axes: tuple[str, ...] = AXES) -> tuple[Equation, ...]:
    """Return the equations of the limits of the drive on some axes, for a "sine" or a "wave"."""
    return tuple(_limit(name, axis, drive) for name in LIMITS for axis in axes)


def _limit(name: str, axis: str, drive: str) -> Equation:
    says, scale_of, of_sine, of_wave = LIMITS[name]
    drive_input = "wave" if drive == "wave" else f"drive_number_{axis}"

    def value(**known: Array) -> Array:
        drive_value = known.pop(drive_input)
        scale = scale_of(**known)
        if isinstance(drive_value, waves.Wave):
            return of_wave(drive_value, AXES.index(axis)) * scale
        return of_sine * np.abs(drive_value) * scale

    needs, says = (drive_input, *arguments_of(scale_of)), says.format(WHERE[axis])
    return Equation(
        f"{name}_{axis}", value, "theory 13.14", needs=needs, says=f"Return the {says}."
    )


# --- the fastest that any drive along the track conveys a part (docs/theory/best-drive.md)


def fastest_velocity(
    *, groups: Groups, largest_acceleration_along: Array, frequency: Array, gravity: Array
) -> Array:
    """Return the largest mean velocity that any drive with a bounded acceleration gives [m s-1].

    `largest_acceleration_along` bounds the acceleration of the track [m s-2], `frequency` [Hz] is
    that of the drive, `groups` are the dimensionless groups of the part. A study's own drive is
    compared with it. 0 where no such drive frees the part forward. NaN where the bound does not
    hold: something drives the part off the floor or across, the track falls, or it is too steep for
    the part to lie on.
    """
    along, onto = map(np.asarray, (groups.gravity_number_along, groups.gravity_number_normal))
    most = largest_acceleration_along / gravity
    holding, braking = groups.friction_static * onto - along, groups.friction_kinetic * onto + along
    share = ratio(holding, holding + braking, 0.0)
    best = share**2 * ratio(most**2 - braking**2, 4 * most, 0.0) * gravity / frequency
    freed = most > groups.friction_static * onto + along
    holds = (along >= 0.0) & (holding >= 0.0) & (np.asarray(groups.drive_number_normal) == 0.0)
    holds = holds & in_plane(groups, Contacts(wall=True))
    return np.where(holds & ~np.isnan(most), np.where(freed, best, 0.0), np.nan)


def share_of_fastest(*, conveying_velocity: Array, fastest_velocity: Array) -> Array:
    """Return the conveying velocity over the largest that the same acceleration can give [1]."""
    return ratio(conveying_velocity, fastest_velocity, np.nan)


# --- the system of a part under such a drive: the same equations around a wave


AT_LIMIT = 1e-13
"""Relative excess over the limit of static friction up to which a step of a drive is still at the
limit, so that rounding does not decide."""


def throw_number(*, wave: waves.Wave, load_number: Array) -> Array:
    """Return the throw number, the largest upward drive acceleration over the load number [1]."""
    most = np.maximum(waves.largest_over_period(wave, waves.NORMAL, "push"), 0.0)
    return ratio(most, load_number, np.where(most > 0.0, np.inf, 0.0))


def efficiency(*, motion: Motion, wave: waves.Wave) -> Array:
    """Return the conveying velocity over the largest speed of the track along x; 0 at rest [1].

    Infinite (regime `unbounded`) for a part that moves though the track does not move along x.
    """
    v, fastest = motion.velocity, waves.largest_over_period(wave, waves.ALONG, "speed")
    beyond = np.where(np.isnan(v), np.nan, np.copysign(np.inf, v))
    return np.where(v != 0, ratio(v, fastest, beyond), 0.0)


def _driven_motion(
    follow: Any, *, groups: Groups, watch: Watch | None = None, **settings: Array
) -> Motion:
    # No track can do what has a mean acceleration: its numbers are NaN.
    found: Motion = follow(groups=groups, watch=watch, **settings)
    assert groups.wave is not None
    none = np.isnan(waves.size(groups.wave))
    return found._replace(status=np.where(none, np.int8(STATUS["no_drive"]), found.status))


@cache
def _with_wave(groups: Any) -> Any:
    def waved(*, wave: waves.Wave, **numbers: Array) -> Groups:
        part: Groups = groups(**numbers)
        static: Array = part.friction_static
        if wave.steps.shape[1]:
            # A sine passes the limit at a phase, but a step may lie on it as long as it lasts, as
            # the best drives do; the last bit of a sum would decide the motion.
            raised = static * (1.0 + AT_LIMIT)
            static = np.where(static > part.friction_kinetic, raised, static)
        return part._replace(wave=wave, friction_static=static)

    return waved


_OTHERS = {
    one.gives: one
    for one in (
        *limits("wave"),
        Equation(
            "drive_number", waves.size, "theory 13.14",
            says="Return an upper bound of the track's speed, over g/w [1].",
        ),
        *(
            Equation(
                f"drive_number_{axis}", partial(waves.bound, axis=place), "theory 13.14",
                says=f"Return an upper bound of the drive acceleration {where}, over gravity [1].",
            )
            for place, (axis, where) in enumerate(WHERE.items())
        ),
        Equation("throw_number", throw_number, "theory 13.14"),
        Equation("efficiency", efficiency, "theory 13.14"),
    )
}  # fmt: skip


def under_wave(shape: Shape, known: Collection[Equation]) -> tuple[Equation, ...]:
    """Return the equations of a conveying system with a wave in place of the sine drive.

    Of `known`, those under a sine, stay those that hold for any drive.
    """
    changed = []
    for equation in known:
        if equation.gives in ("groups", "motion"):
            of_motion = equation.gives == "motion"
            given = equation.function
            function = partial(_driven_motion, given) if of_motion else _with_wave(given)
            needs = equation.inputs if of_motion else ("wave", *equation.inputs)
            equation = replace(equation, function=function, needs=needs, says=equation.summary)
        if equation.gives != "vibration_acceleration":
            changed.append(_OTHERS.get(equation.gives, equation))
    says = "Return the push of the drive on a part, per weight."
    wave = Equation("wave", shape.wave, "theory 13.14", needs=shape.inputs, says=says)
    return (wave, *changed)


def driven(system: Scene, shape: Shape) -> Scene:
    """Return a copy of a scene of motion in which another drive takes the place of the sine.

    The default of `alpha`, the azimuth of the sine, is dropped.
    """
    return replace(
        system,
        variants={name: under_wave(shape, known) for name, known in system.variants.items()},
        defaults={**{n: v for n, v in system.defaults.items() if n != "alpha"}, **shape.defaults},
    )
