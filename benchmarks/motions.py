"""The functions of motion with every number by its name: for benchmarks and tests of single cells.

Each takes the fields of `Groups` and `Contacts` beside the settings of its own, and returns what
the function of that name in `vibrafeed.core.motion` does.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.motion import events, reference
from vibrafeed.core.motion import tumbling_scene as tumbling
from vibrafeed.core.motion.method import BLOCK_ON_FLOOR, Contacts, Groups, Motion, Path
from vibrafeed.core.motion.reference.laws import UX, UZ, ReferenceLaws, X, Z
from vibrafeed.core.motion.reference.part import FailedError, Part
from vibrafeed.core.motion.systems import METHODS


def path_by_reference(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    phases: ArrayLike,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: float = 0.0,
) -> Path:
    """Return the positions of one part at given phases, accurate to about twelve digits.

    For checks of others; NaN from where the method failed. The given state is that at the first of
    the `phases`, which ascend [rad]; `spin` is the velocity across, in g/w, that the spin of a
    cylinder gives its lowest point.
    """
    asked = np.atleast_1d(np.asarray(phases, dtype=np.float64))
    if not np.all(np.isfinite(asked)) or np.any(np.diff(asked) < 0.0):
        raise ValueError("the argument phases has to hold finite numbers in ascending order")
    state = np.array([*position, *velocity, spin], dtype=np.float64)
    part = Part(ReferenceLaws(groups, contacts), state)
    part.phase = float(asked[0])
    rows = np.full((asked.size, 7), np.nan)
    with contextlib.suppress(FailedError):  # what was not reached stays NaN
        part.advance(float(asked[-1]), asked, rows)
    return Path(asked, rows[:, X : Z + 1], rows[:, UX : UZ + 1])


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
reference_path = partial(_in_space, path_by_reference)


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
