"""The functions of motion with every number by its name: for benchmarks and tests of single cells.

Each takes the fields of `Groups` and `Contacts` beside the settings of its own, and returns what
the function of that name in `vibrafeed.core.motion` does.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from vibrafeed.core.motion import events, reference
from vibrafeed.core.motion import tumbling_scene as tumbling
from vibrafeed.core.motion.method import Contacts, Groups, Motion
from vibrafeed.core.motion.systems import METHODS


def _sorted(numbers: dict[str, Any]) -> tuple[Groups, Contacts, dict[str, Any]]:
    """Return groups, contacts and settings from named numbers."""
    groups = {name: numbers[name] for name in Groups._fields if name in numbers}
    contacts = {name: numbers[name] for name in Contacts._fields if name in numbers}
    settings = {n: v for n, v in numbers.items() if n not in {*groups, *contacts}}
    return Groups(**groups), Contacts(**contacts), settings


def _in_plane(function: Callable[..., Any], **numbers: Any) -> Any:
    """Return a planar function's result for named numbers."""
    groups, _, settings = _sorted(numbers)
    return function(groups, **settings)


def _in_space(function: Callable[..., Any], **numbers: Any) -> Any:
    """Return a spatial function's result for named numbers."""
    groups, contacts, settings = _sorted(numbers)
    return function(groups, contacts, **settings)


planar_motion = partial(_in_plane, events.planar_motion)
planar_path = partial(_in_plane, events.planar_path)
reference_motion = partial(_in_space, reference.reference_motion)
reference_path = partial(_in_space, reference.reference_path)


def tumbling_motion(**numbers: Any) -> tumbling.Tumble:
    """Return the motion of tumbling parts given by named numbers."""
    own = {name: numbers.pop(name) for name in ("watch",) if name in numbers}
    return tumbling.tumbling_motion(tumbling.Throw(**numbers), **own)


def tumbling_path(*, times: Any, **numbers: Any) -> tumbling.TumblePath:
    """Return the path of a tumbling part given by named numbers."""
    return tumbling.tumbling_path(tumbling.Throw(**numbers, duration=1.0), times=times)


def follow(method: str, **numbers: Any) -> Motion:
    """Return the motion by a method of `METHODS`, as in the equation of a system."""
    groups, contacts, settings = _sorted(numbers)
    return METHODS["conveying"][method].follow(groups=groups, contacts=contacts, **settings)
