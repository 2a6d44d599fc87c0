"""The record of a method of motion: the one seam between following a part and all the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from vibrafeed.core.motion.course import TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.scenes import Constraint

Follow = Callable[..., Any]
"""An equation: takes by keyword a part's numbers, the settings that it needs and a `watch`; returns
a `Motion`, or a `Tumble` of a part that tumbles, or the `Energy` of a motion."""

FollowCourse = Callable[[TrajectoryRequest], TrajectoryValues]


def everything(contacts: Contacts) -> bool:
    """Return True: the method can follow parts with any contacts."""
    del contacts
    return True


@dataclass(frozen=True)
class Method:
    """One way to follow the motion of a part: what it takes, costs, knows of its error, refuses.

    Attributes
    ----------
    name : str
        As a study names it.
    follow : callable
        Takes the `Contacts` of a system; returns the equation that follows its cells.
    source : str
        Where the theory tells of it.
    accuracy : str
        What is known of its error, in words.
    seconds_a_cell : float
        Roughly the time of a cell on one core [s], for cells that it verifies, and where its code
        is not compiled yet; other prices are measured.
    defaults : mapping of str to float
        Its settings where a study leaves them out.
    course : callable or None
        Takes the `Contacts` of a system; returns what follows one part in time. None if the method
        gives means only.
    energy : callable or None
        Takes the `Contacts` of a system; returns the equation of its `Energy`, which takes the
        `Motion`, too. None if the method does not tell it.
    checked_by : tuple of str
        The methods by which it is verified, the most exact first.
    refuses : tuple of Constraint
        What a study must respect that asks for it.
    follows : callable
        Takes the `Contacts` of a system; returns whether the method can follow it.
    """

    name: str
    follow: Callable[[Contacts], Follow]
    source: str
    accuracy: str
    seconds_a_cell: float
    defaults: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    course: Callable[[Contacts], FollowCourse] | None = None
    energy: Callable[[Contacts], Follow] | None = None
    checked_by: tuple[str, ...] = ()
    refuses: tuple[Constraint, ...] = ()
    follows: Callable[[Contacts], bool] = everything
