"""Floors that give: restitution that falls with speed, linings, damping.

Which of them a study has, its parameters tell.

A study that gives `restitution_speed` has Hunt and Crossley's law in the place of one restitution,
one that gives `lining_stiffness` is told where its lining is too soft for a rigid floor, and one by
a floor with a spring and a damper may give the damping. Nothing else carries any of it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import cache

import numpy as np

from vibrafeed.core.mechanics import soft_contact
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.methods.regularised import sprung
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.scenes.scene import Condition, Constraint, Equation, Scene

SOURCE = "theory 18.3"
FALLING, LINING, DAMPED = "restitution_speed", "lining_stiffness", "contact_damping_ratio"
BY_EVENTS = ("events", "reference")
"""Methods that follow a part whose restitution falls with the speed of impact."""
SPRUNG = {"regularised": "Radau", "regularised-BDF": "BDF", "regularised-LSODA": "LSODA"}
"""Methods whose floor is a spring with a damper, and their integrators."""


def on_soft_floor(name: str, names: Collection[str]) -> Scene:
    """Return the scene of this name with the floor that a study's parameters define.

    `names` are those of the parameters: some of them add a restitution that falls with speed, a
    lining, or damping; without any, the floor is the plain one.
    """
    parameters = set(names)
    if not parameters & {FALLING, LINING, DAMPED}:
        return _plain(name)
    system = SYSTEMS[name]
    if FALLING in parameters:
        system = _with_falling_restitution(system, parameters)
    if LINING in parameters:
        system = _with_lining(system)
    return _with_damping_ratio(system, parameters)


@cache
def _plain(name: str) -> Scene:
    """Return a conveying system with damping from the restitution."""
    return _with_damping_ratio(SYSTEMS[name], ())


# --- restitution that falls with speed


def _with_falling_restitution(system: Scene, parameters: Collection[str]) -> Scene:
    """Return a system with Hunt and Crossley's law, given one restitution at one speed.

    The restitution then falls with the speed of impact. `parameters` are the names of the study's
    parameters; those that the law does not allow are refused.
    """
    law = Equation("impact_damping", soft_contact.impact_damping, SOURCE)

    def changed(known: tuple[Equation, ...]) -> tuple[Equation, ...]:
        """Return the equations with the law's damping in the groups."""
        others = [
            replace(
                one,
                function=_with_damping(one.function),
                says=one.summary,
                needs=("impact_damping", "velocity_scale", *one.inputs),
            )
            if one.gives == "groups"
            else one
            for one in known
        ]
        return (law, *others)

    return replace(
        system,
        variants={
            name: changed(known) if name in BY_EVENTS else known
            for name, known in system.variants.items()
        },
        defaults={n: value for n, value in system.defaults.items() if n != "restitution"},
        constraints=(*system.constraints, *_refusals(system, parameters)),
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

    return falling


def _refusals(system: Scene, parameters: Collection[str]) -> list[Constraint]:
    """Return the constraints on parameters of a study whose restitution falls with speed.

    That law is known only for motion in the plane, and by some methods: the constraints refuse
    other `parameters` of the study and other methods of `system`, and tell a remedy.
    """
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
    nothing += [
        Constraint((FALLING, name), lambda *_: False, message, f"Leave it or {name} out")
        for name in across
    ]
    fix = f"Leave restitution_speed out, or set method to {' or '.join(BY_EVENTS)}"
    return nothing + [
        Constraint(
            (FALLING,),
            lambda *_: False,
            f"{name} follows parts of one restitution, whatever the speed",
            fix,
            variant=name,
        )
        for name in system.variants
        if name not in BY_EVENTS
    ]


# --- linings


def contact_stiffness(*, lining_stiffness: Array, mass: Array, frequency: Array) -> Array:
    """Return the stiffness of the lining over mass times w^2 [1]."""
    return lining_stiffness / (mass * np.square(2 * np.pi * frequency))


def _with_lining(system: Scene) -> Scene:
    """Return a system, as a copy, whose floor has a springy lining of given stiffness and damping.

    Equations for the lining's natural frequency, sag and stiffness ratio come first. Methods with
    rigid contacts get the condition `soft_contact`, which marks cells where the lining is too soft
    for them; methods with a sprung floor take their contact stiffness from the lining.
    """
    own = (
        Equation("lining_frequency", soft_contact.lining_frequency, SOURCE),
        Equation("lining_sag", soft_contact.lining_sag, SOURCE),
        Equation("stiffness_ratio", soft_contact.stiffness_ratio, SOURCE),
    )

    def conditions(name: str) -> tuple[Condition, ...]:
        """Return the conditions of a variant, with that of a soft contact."""
        known = system.conditions[name]
        if name in SPRUNG:
            return known
        # It gives way to what has no answer, and stands before all that is told of the motion.
        place = [one.regime for one in known].index("runaway") + 1
        soft = Condition("soft_contact", soft_contact.is_soft, known[0].outputs, "contact")
        return (*known[:place], soft, *known[place:])

    def equations(name: str) -> tuple[Equation, ...]:
        """Return the equations of a variant, with the lining's stiffness."""
        known = system.variants[name]
        if name not in SPRUNG:
            return (*own, *known)
        motion = sprung(SPRUNG[name], softer=1.0)
        found = [replace(e, function=motion) if e.gives == "motion" else e for e in known]
        return (*own, Equation("contact_stiffness", contact_stiffness, SOURCE), *found)

    return replace(
        system,
        variants={name: equations(name) for name in system.variants},
        conditions={name: conditions(name) for name in system.conditions},
    )


# --- a spring and a damper


def _with_damping_ratio(system: Scene, parameters: Collection[str]) -> Scene:
    """Return a scene, as a copy, whose sprung floors take either damping ratio or restitution.

    The one follows from the other; `parameters` are the names of the study's parameters, which tell
    which of both it gives. `system` is the scene.
    """
    equations: tuple[Equation, ...] = (
        Equation("damping_of_restitution", soft_contact.damping_of_restitution, SOURCE),
        Equation("restitution_of_damping", soft_contact.restitution_of_damping, SOURCE),
    )
    if DAMPED in parameters:
        equations = (*equations, Equation("restitution", _restitution, SOURCE))
    return replace(
        system,
        variants={
            name: (*equations, *known) if name in SPRUNG else known
            for name, known in system.variants.items()
        },
    )


def _restitution(*, contact_damping_ratio: Array) -> Array:
    """Return the restitution of a floor with a spring and a damper that never pulls [1]."""
    return soft_contact.restitution_of_damping(contact_damping_ratio=contact_damping_ratio)
