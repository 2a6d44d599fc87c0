"""Restitution that falls with the speed of impact: Hunt and Crossley's law (theory 18.3)."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import cache

import numpy as np

from vibrafeed.core.mechanics import soft_contact
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.scenes.scene import Constraint, Equation, Scene, taking

FALLING = "restitution_speed"
"""The parameter that asks for the law: the speed at which `restitution` was measured."""


def with_falling_restitution(system: Scene, parameters: Collection[str]) -> Scene:
    """Return a system whose restitution falls with the speed of impact, given that at one speed.

    `parameters` are the names of the study's parameters; those that the law does not allow are
    refused.
    """
    law = Equation("impact_damping", soft_contact.impact_damping, "theory 18.3")

    def changed(known: tuple[Equation, ...]) -> tuple[Equation, ...]:
        found = [
            replace(one, function=_with_damping(one.function)) if one.gives == "groups" else one
            for one in known
        ]
        return (law, *found)

    return replace(
        system,
        variants={name: changed(known) for name, known in system.variants.items()},
        defaults={n: value for n, value in system.defaults.items() if n != "restitution"},
        constraints=(*system.constraints, *_refusals(parameters)),
    )


@cache
def _with_damping(groups: Callable[..., Groups]) -> Callable[..., Groups]:
    """Return the function of the groups' equation for a part whose restitution falls with speed.

    `groups` is the function for a constant restitution. The new one takes the damping of the
    contact law and the scale g/w of velocity (w = 2 pi f), too; restitution is 0 where the damping
    is infinite, else 1, as the law of the damping takes its place.
    """

    def falling(*, impact_damping: Array, velocity_scale: Array, **numbers: Array) -> Groups:
        """Return the groups of the part, with the law's damping."""
        found = groups(**numbers)
        damping = impact_damping * velocity_scale
        endless = np.isinf(damping)
        return found._replace(
            restitution=np.where(endless, 0.0, 1.0), impact_damping=np.where(endless, 0.0, damping)
        )

    falling.__signature__ = taking(groups, "impact_damping", "velocity_scale")  # type: ignore[attr-defined]
    falling.__doc__ = groups.__doc__
    return falling


def _refusals(parameters: Collection[str]) -> list[Constraint]:
    """Return the constraints of the law, which is known only for motion in the plane."""
    message = "restitution that falls with speed is known for motion in the plane of the track"
    nothing = [
        Constraint(
            (FALLING, name),
            lambda _, __, least, largest: least == largest == 0.0,
            message,
            f"Leave restitution_speed out, or set {name} to 0",
        )
        for name in ("alpha", "delta")
    ]
    across = [n for n in parameters if n == "radius" or "_across_" in n]
    return nothing + [
        Constraint((FALLING, name), lambda *_: False, message, f"Leave it or {name} out")
        for name in across
    ]
