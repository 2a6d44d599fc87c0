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
            f"{kind}_{axis}_{k}" for kind in ("amplitude", "phase") for axis, k in self.terms
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
        push_per_metre = (
            inputs["drive_factor"] * np.square(waves.TURN * inputs["frequency"]) / inputs["gravity"]
        )
        for axis, k in self.terms:
            push = k * k * inputs[f"amplitude_{axis}_{k}"] * push_per_metre
            phase = inputs[f"phase_{axis}_{k}"]
            for moved_axis, arm, sign in ARMS.get(axis, ((axis, "", 1.0),)):
                moved_push = push * sign * inputs[arm] if arm else push
                harmonics[AXES.index(moved_axis), 0, k - 1] += moved_push * cosine(phase)
                harmonics[AXES.index(moved_axis), 1, k - 1] += moved_push * sine(phase)
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
        semi_major, semi_minor, tilt = (
            np.asarray(inputs.pop(name), dtype=float) for name in ELLIPSE
        )
        components = {
            "along": (semi_major * cosine(tilt), semi_minor * sine(tilt)),
            "normal": (semi_major * sine(tilt), -semi_minor * cosine(tilt)),
        }
        for axis, (of_sine, of_cosine) in components.items():
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
        given_steps = {
            axis: [n for level_axis, n in self.levels if level_axis == axis]
            for axis, _ in self.levels
        }
        missing = {axis: set(range(1, self.count + 1)) - set(n) for axis, n in given_steps.items()}
        return {
            axis: min(missing_steps)
            for axis, missing_steps in missing.items()
            if len(missing_steps) == 1
        }

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
        duration_fractions = np.stack([np.broadcast_to(inputs[f"duration_{n}"], shape)
                         for n in range(1, self.count + 1)])  # fmt: skip
        duration_fractions = ratio(duration_fractions, duration_fractions.sum(axis=0), np.nan)
        duration_fractions = np.where(duration_fractions < SHORTEST, 0.0, duration_fractions)
        duration_fractions = duration_fractions / duration_fractions.sum(axis=0)
        steps = np.zeros((4, self.count, *shape))
        for axis in dict.fromkeys(axis for axis, _ in self.levels):
            steps[AXES.index(axis)] = self._levels(axis, inputs, duration_fractions)
        ends = waves.TURN * np.cumsum(duration_fractions, axis=0)
        ends[-1] = np.where(np.isnan(ends[-1]), np.nan, waves.TURN)
        steps[waves.ENDS] = ends
        return waves.Wave(np.zeros((3, 2, 0, *shape)), steps)

    def _levels(self, axis: str, inputs: dict[str, Array], duration_fractions: Array) -> Array:
        # The push, minus the track's acceleration over gravity, step by step, in the shape of
        # `duration_fractions`, (steps, ...).
        levels = np.zeros_like(duration_fractions)
        closing = self.closing.get(axis, 0)
        for n in range(1, self.count + 1):
            if n != closing:
                levels[n - 1] = inputs[f"acceleration_{axis}_{n}"]
        if closing:  # the step that is left out makes the mean 0
            levels[closing - 1] = ratio(
                -(levels * duration_fractions).sum(axis=0), duration_fractions[closing - 1], 0.0
            )
        # No track can have a mean acceleration: NaN, unless it is rounding.
        mean = (levels * duration_fractions).sum(axis=0)
        is_open = np.abs(mean) > CLOSED * (np.abs(levels) * duration_fractions).sum(axis=0)
        levels = np.where(is_open, np.nan, levels - mean)
        # A step of no length is one with a step beside it.
        for n, neighbour in (
            *((n, n - 1) for n in range(1, self.count)),
            *((n, n + 1) for n in range(self.count - 2, -1, -1)),
        ):
            levels[n] = np.where(duration_fractions[n] == 0.0, levels[neighbour], levels[n])
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
        sine_part, cosine_part = inputs.pop("track_harmonic")
        inputs, _ = _aligned(inputs)
        metres_to_push = np.square(inputs["circular_frequency"]) / inputs["gravity"]
        first_push = inputs["drive_factor"] * inputs["amplitude"] * metres_to_push
        in_plane_push = first_push * cosine(inputs["beta"])
        along, across = (
            in_plane_push * cosine(inputs["alpha"]),
            in_plane_push * sine(inputs["alpha"]),
        )
        numbers = [
            number
            for push in (along, across, first_push * sine(inputs["beta"]))
            for number in (push, 4.0 * push * sine_part, 0.0 * push, 4.0 * push * cosine_part)
        ]
        harmonics = np.stack(np.broadcast_arrays(*numbers))
        shape = harmonics.shape[1:]
        return waves.Wave(harmonics.reshape(3, 2, 2, *shape), np.zeros((4, 0, *shape)))


Shape = Harmonics | Steps | HalfWave
"""The numbers that a drive has; its values are parameters like any other."""


def _aligned(inputs: dict[str, Array]) -> tuple[dict[str, Array], tuple[int, ...]]:
    arrays = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
    return arrays, np.broadcast_shapes(*(value.shape for value in arrays.values()))


def problems_of_wave(shape: Shape, values: Mapping[str, Array]) -> list[Problem]:
    """Return the problem if no combination of the given values makes a valid drive; else empty.

    A drive in steps must have some duration, and a mean acceleration of 0 on each axis. `shape` is
    the drive that the study's names define, `values` are its parameters in SI units.
    """
    inputs = {name: values.get(name, shape.defaults.get(name, 1.0)) for name in shape.inputs}
    wave = shape.wave(**{name: np.asarray(value) for name, value in inputs.items()})
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
    return [
        Problem(
            f"parameters.acceleration_{axis}_1",
            f"the mean acceleration {axis} is not 0: the track would run away",
            "Leave out the acceleration of one step, which is then computed, or change durations "
            "so that the sum of acceleration times duration is 0",
        )
        for levels, axis in zip(wave.steps, AXES, strict=False)
        if np.isnan(levels).any()
    ]


def shape_of(parameters: Iterable[str]) -> tuple[Shape | None, list[Problem]]:
    """Return the kind of drive that a study's parameter names define, and problems of these names.

    None for the plain sine, and if there are problems, such as names of two kinds.
    """
    drive_parameters = {*DRIVE, *SINE, *TURNS}
    names = [name for name in parameters if name in drive_parameters]
    terms = {(match[1], int(match[2])) for match in filter(None, map(_HARMONIC.fullmatch, names))}
    steps = list(filter(None, map(_STEP.fullmatch, names)))
    sines = [name for name in SINE if name in names]
    ellipse = [name for name in ELLIPSE if name in names]
    if (terms and steps) or (ellipse and (terms or steps)):
        kept = (ellipse[0], "an ellipse") if ellipse else (steps[0][0], "a drive in steps")
        other = "harmonics" if terms else "steps"
        return None, [_mixed(*kept, other, "Give one kind of drive")]
    if sines and (terms or steps or ellipse):
        other = "harmonics" if terms else "steps" if steps else "an ellipse"
        return None, [_mixed(name, "the plain sine", other, _NO_SINE[other]) for name in sines]
    if ellipse:
        return Ellipse((("along", 1), ("normal", 1))), []
    if terms:
        return Harmonics(tuple(sorted(terms, key=_by_axis))), []
    return _steps_of(steps) if steps else (None, [])


def _steps_of(steps: list[re.Match[str]]) -> tuple[Steps | None, list[Problem]]:
    # The drive in steps whose matched names are given, or the problem of an incomplete one.
    levels = {(match[1], int(match[2])) for match in steps if match[1]}
    count = max(int(match[2]) for match in steps)
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
    # The equation of one of `LIMITS` on an axis, from the drive number (sine) or the wave.
    says, scale_of, of_sine, of_wave = LIMITS[name]
    drive_input = "wave" if drive == "wave" else f"drive_number_{axis}"

    def value(**quantities: Array) -> Array:
        drive_value = quantities.pop(drive_input)
        scale = scale_of(**quantities)
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
    downhill, load = map(np.asarray, (groups.gravity_number_along, groups.gravity_number_normal))
    largest = largest_acceleration_along / gravity
    holding, braking = (
        groups.friction_static * load - downhill,
        groups.friction_kinetic * load + downhill,
    )
    braking_fraction = ratio(holding, holding + braking, 0.0)
    largest_velocity = (
        braking_fraction**2 * ratio(largest**2 - braking**2, 4 * largest, 0.0) * gravity / frequency
    )
    breaks_free = largest > groups.friction_static * load + downhill
    bound_holds = (
        (downhill >= 0.0) & (holding >= 0.0) & (np.asarray(groups.drive_number_normal) == 0.0)
    )
    bound_holds = bound_holds & in_plane(groups, Contacts(wall=True))
    return np.where(
        bound_holds & ~np.isnan(largest), np.where(breaks_free, largest_velocity, 0.0), np.nan
    )


def share_of_fastest(*, conveying_velocity: Array, fastest_velocity: Array) -> Array:
    """Return the conveying velocity over the largest that the same acceleration can give [1]."""
    return ratio(conveying_velocity, fastest_velocity, np.nan)


# --- the system of a part under such a drive: the same equations around a wave


AT_LIMIT = 1e-13
"""Relative excess over the limit of static friction up to which a step of a drive is still at the
limit, so that rounding does not decide."""


def throw_number(*, wave: waves.Wave, load_number: Array) -> Array:
    """Return the throw number, the largest upward drive acceleration over the load number [1]."""
    largest_push = np.maximum(waves.largest_over_period(wave, waves.NORMAL, "push"), 0.0)
    return ratio(largest_push, load_number, np.where(largest_push > 0.0, np.inf, 0.0))


def efficiency(*, motion: Motion, wave: waves.Wave) -> Array:
    """Return the conveying velocity over the largest speed of the track along x; 0 at rest [1].

    Infinite (regime `unbounded`) for a part that moves though the track does not move along x.
    """
    velocity, fastest = motion.velocity, waves.largest_over_period(wave, waves.ALONG, "speed")
    without_track_motion = np.where(np.isnan(velocity), np.nan, np.copysign(np.inf, velocity))
    return np.where(velocity != 0, ratio(velocity, fastest, without_track_motion), 0.0)


def _driven_motion(
    follow: Any, *, groups: Groups, watch: Watch | None = None, **settings: Array
) -> Motion:
    # No track can follow a wave with a mean acceleration: the numbers of such a wave are NaN.
    motion: Motion = follow(groups=groups, watch=watch, **settings)
    assert groups.wave is not None
    has_no_drive = np.isnan(waves.size(groups.wave))
    return motion._replace(
        status=np.where(has_no_drive, np.int8(STATUS["no_drive"]), motion.status)
    )


@cache
def _with_wave(groups: Any) -> Any:
    def groups_with_wave(*, wave: waves.Wave, **numbers: Array) -> Groups:
        part: Groups = groups(**numbers)
        static: Array = part.friction_static
        if wave.steps.shape[1]:
            # A sine passes the limit at a phase, but a step may lie on it as long as it lasts, as
            # the best drives do; the last bit of a sum would decide the motion.
            raised_static = static * (1.0 + AT_LIMIT)
            static = np.where(static > part.friction_kinetic, raised_static, static)
        return part._replace(wave=wave, friction_static=static)

    return groups_with_wave


_EQUATIONS_OF_WAVE = {
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


def under_wave(shape: Shape, equations: Collection[Equation]) -> tuple[Equation, ...]:
    """Return the equations of a conveying system with a wave in place of the sine drive.

    Of the given `equations`, those under a sine, stay those that hold for any drive.
    """
    changed = []
    for equation in equations:
        if equation.gives in ("groups", "motion"):
            of_motion = equation.gives == "motion"
            plain_function = equation.function
            function = (
                partial(_driven_motion, plain_function) if of_motion else _with_wave(plain_function)
            )
            needs = equation.inputs if of_motion else ("wave", *equation.inputs)
            equation = replace(equation, function=function, needs=needs, says=equation.summary)
        if equation.gives != "vibration_acceleration":
            changed.append(_EQUATIONS_OF_WAVE.get(equation.gives, equation))
    says = "Return the push of the drive on a part, per weight."
    wave = Equation("wave", shape.wave, "theory 13.14", needs=shape.inputs, says=says)
    return (wave, *changed)


def driven(system: Scene, shape: Shape) -> Scene:
    """Return a copy of a scene of motion in which another drive takes the place of the sine.

    The default of `alpha`, the azimuth of the sine, is dropped.
    """
    return replace(
        system,
        variants={
            name: under_wave(shape, equations) for name, equations in system.variants.items()
        },
        defaults={
            **{name: value for name, value in system.defaults.items() if name != "alpha"},
            **shape.defaults,
        },
    )
