"""The functions of motion with every number by its name: for benchmarks and tests of single cells.

Each takes the fields of `Groups` and `Contacts` beside the settings of its own.
"""

from __future__ import annotations

from typing import Any

from core.motion.groups import Contacts, Groups
from core.motion.methods import METHODS, events, reference, regularised, stepping, tumbling
from core.motion.path import Path
from core.motion.result import Motion


def _sorted(numbers: dict[str, Any]) -> tuple[Groups, Contacts, dict[str, Any]]:
    """Return groups, contacts and settings among numbers by name."""
    groups = {name: numbers[name] for name in Groups._fields if name in numbers}
    contacts = {name: numbers[name] for name in Contacts._fields if name in numbers}
    settings = {n: v for n, v in numbers.items() if n not in {*groups, *contacts}}
    return Groups(**groups), Contacts(**contacts), settings


def planar_motion(**numbers: Any) -> Motion:
    """Return what `events.planar_motion` does."""
    groups, _, settings = _sorted(numbers)
    return events.planar_motion(groups, **settings)


def planar_path(**numbers: Any) -> events.EventPath:
    """Return what `events.planar_path` does."""
    groups, _, settings = _sorted(numbers)
    return events.planar_path(groups, **settings)


def stepped_motion(**numbers: Any) -> Motion:
    """Return what `stepping.stepped_motion` does."""
    groups, contacts, settings = _sorted(numbers)
    return stepping.stepped_motion(groups, contacts, **settings)


def planar_stepped_motion(**numbers: Any) -> Motion:
    """Return what `stepping.stepped_motion` does, in the plane."""
    return stepped_motion(**numbers, planar=True)


def stepped_path(**numbers: Any) -> Path:
    """Return what `stepping.stepped_path` does."""
    groups, contacts, settings = _sorted(numbers)
    return stepping.stepped_path(groups, contacts, **settings)


def reference_motion(**numbers: Any) -> Motion:
    """Return what `reference.reference_motion` does."""
    groups, contacts, settings = _sorted(numbers)
    return reference.reference_motion(groups, contacts, **settings)


def reference_path(**numbers: Any) -> Path:
    """Return what `reference.reference_path` does."""
    groups, contacts, settings = _sorted(numbers)
    return reference.reference_path(groups, contacts, **settings)


def regularised_motion(**numbers: Any) -> Motion:
    """Return what `regularised.regularised_motion` does."""
    groups, _, settings = _sorted(numbers)
    return regularised.regularised_motion(groups, **settings)


def tumbling_motion(**numbers: Any) -> tumbling.Tumble:
    """Return what `tumbling.tumbling_motion` does."""
    own = {name: numbers.pop(name) for name in ("method", "watch") if name in numbers}
    return tumbling.tumbling_motion(tumbling.Throw(**numbers), **own)


def tumbling_path(*, times: Any, **numbers: Any) -> tumbling.TumblePath:
    """Return what `tumbling.tumbling_path` does."""
    own = {name: numbers.pop(name) for name in ("method",) if name in numbers}
    return tumbling.tumbling_path(tumbling.Throw(**numbers, duration=1.0), times=times, **own)


def follow(method: str, **numbers: Any) -> Motion:
    """Return what a method of `METHODS` follows, as the equation of a system does."""
    groups, contacts, settings = _sorted(numbers)
    return METHODS["conveying"][method].follow(contacts)(groups=groups, **settings)
