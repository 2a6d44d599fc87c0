"""The options of a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from vibrafeed.core.plots.style import LIGHT, Style
from vibrafeed.core.study.shown import ShownUnits


@dataclass(frozen=True)
class Options:
    """The options of a picture; every picture takes the same, and refuses those without effect.

    Attributes
    ----------
    kind : str or None
        The name of the picture; None where the first that fits is drawn.
    variable : str or None
        The output; the first that fits if None.
    axes : tuple of str or None
        One or two dimensions, the first across.
    at : mapping of str to float
        Values of other dimensions, in the unit of the dataset.
    nearest : bool
        Whether a value of `at` that the dataset does not have stands for the nearest one.
    title : str or None
        The name over the picture; that of what it shows if None.
    style : Style
        Colours and sizes.
    units : ShownUnits
        Units in which values are read.
    is_natural : bool
        Whether the kind is the first that fits, and nobody named it.
    """

    kind: str | None = None
    variable: str | None = None
    axes: tuple[str, ...] | None = None
    at: Mapping[str, float] = field(default_factory=dict)
    nearest: bool = False
    title: str | None = None
    style: Style = LIGHT
    units: ShownUnits = field(default_factory=ShownUnits)
    is_natural: bool = False
