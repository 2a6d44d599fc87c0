"""Types of the keywords of a study, for editors and type checkers; nothing loads them to run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray


class Labelled(Protocol):
    """A labelled array: a column of pandas or polars, or a data array of xarray."""

    def to_numpy(self) -> NDArray[Any]:
        """Return its values."""
        ...


class WithUnit(Protocol):
    """A quantity of pint."""

    @property
    def magnitude(self) -> Any:
        """Its number, or its array."""
        ...

    @property
    def units(self) -> Any:
        """Its unit."""
        ...


Number: TypeAlias = float | str | np.number[Any] | WithUnit
"""A number in the unit of the quantity, text with a unit, such as ``"0.25 mm"``, or a quantity."""

Values: TypeAlias = Number | Sequence[Number] | NDArray[Any] | Labelled | Mapping[str, Number]
"""One number; or several, which become an axis of the dataset.

A mapping is a range: ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``, or with ``step`` in the
place of ``num``.
"""

Bounds: TypeAlias = Mapping[str, Number]
"""Variables and their bounds: ``{"lower": 0, "upper": "60 deg"}``."""

Maps: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Parameters and what is known of them: ``{"friction": {"mean": 0.3, "deviation": 0.03}}``."""

Named: TypeAlias = str | Sequence[str]
"""One name or several."""
