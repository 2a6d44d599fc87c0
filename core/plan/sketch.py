"""The sketch of a study before its values are read: names alone, which is enough for a plan."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple


class Sketch(NamedTuple):
    """The names in a study, or in content that is no sound study yet.

    Attributes
    ----------
    scene : str
        Its scene.
    variant, method : str or None
        What it chooses, if anything.
    outputs : collection of str
        The outputs that it asks for.
    names : collection of str
        The parameters that it gives or leaves open, wherever they stand.
    """

    scene: str
    variant: str | None
    method: str | None
    outputs: Collection[str]
    names: Collection[str]
