"""What a plan has to know of a study before its values: names alone."""

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
