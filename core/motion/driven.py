"""The system of a part under a drive that is no plain sine: the same equations around a wave."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.motion import limits, waves
from vibrafeed.core.motion.drives import Shape
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.result import STATUS, Motion
from vibrafeed.core.motion.waves import Wave
from vibrafeed.core.scenes import Scene
from vibrafeed.core.scenes.scene import Equation
from vibrafeed.core.watch import Watch

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
