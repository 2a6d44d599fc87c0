"""The accessor `dataset.vibrafeed` of xarray, `dataset.vf` for short: pictures, units, the study.

Every function that returns a dataset imports this module. Who only reads files with xarray imports
it: ``import vibrafeed.accessor``.
docs/decisions/2026-11-23-accessor.md lists the alternatives.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import xarray

from vibrafeed.core import intake  # whose names load the plan
from vibrafeed.core.dataset.formats import suffix_of, write_result
from vibrafeed.core.dataset.shown import in_shown_units
from vibrafeed.core.dataset.table import Table, judge_of, regime_shares
from vibrafeed.core.errors import Problem, StudyError, VibrafeedError
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.study.shown import Shown, ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError

if TYPE_CHECKING:
    import os

    from matplotlib.figure import Figure

    from vibrafeed._values import Named
    from vibrafeed.core.study.grid_study import Study


PLAIN = {"degree": Shown(1.0, "deg"), "min-1": Shown(1.0, "1/min")}
"""Units that `trade` writes without signs: degrees, and parts a minute."""


@xarray.register_dataset_accessor("vf")  # type: ignore[no-untyped-call]
@xarray.register_dataset_accessor("vibrafeed")  # type: ignore[no-untyped-call]
class Accessor:
    """The accessor of a dataset that vibrafeed returned, or of a file that it wrote.

    >>> motion = vibrafeed.simulate(
    ...     "rectangle-on-plane", frequency="50 Hz", beta=30, friction=0.5,
    ...     amplitude=["0.01 mm", "0.1 mm", "0.2 mm", "0.4 mm"],
    ... )
    >>> motion.vibrafeed.regime_shares()
    {'stick': 0.25, 'stick_slip': 0.25, 'hopping': 0.5}
    >>> trade = motion.vibrafeed.trade()
    >>> [trade[name].units for name in ("amplitude", "conveying_velocity", "beta")]
    ['mm', 'mm/s', 'deg']
    >>> motion.vibrafeed.shown("m/min").conveying_velocity.units
    'm/min'
    >>> motion.vibrafeed.study.scene
    'rectangle-on-plane'
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self._dataset = dataset

    def __repr__(self) -> str:
        names = [name for name in dir(type(self)) if not name.startswith("_")]
        scene = self._dataset.attrs.get("scene", "no scene")
        return f"<vibrafeed accessor of a dataset of {scene}: {', '.join(names)}>"

    @property
    def study(self) -> Study:
        """The study that the dataset answers, as `vibrafeed.study` would make it.

        Raises
        ------
        VibrafeedError
            If the dataset holds none: it is not a result of vibrafeed.
        """
        if "study" not in self._dataset.attrs:
            raise VibrafeedError("The dataset holds no study: it is not a result of vibrafeed.")
        return intake.parse_json(str(self._dataset.attrs["study"]))

    def plot(
        self, *, variable: str | None = None, axes: str | tuple[str, ...] | None = None,
        at: Mapping[str, float | str] | None = None, kind: str | None = None,
        title: str | None = None, units: Named | None = None, nearest: bool = False,
        dark: bool = False, small: bool = False,
    ) -> Figure:  # fmt: skip
        """Return a picture of the dataset; parameters and errors are those of `vibrafeed.plot`."""
        from vibrafeed import plot

        return plot(
            self._dataset, variable=variable, axes=axes, at=at, kind=kind, title=title,
            units=units, nearest=nearest, dark=dark, small=small,
        )  # fmt: skip

    def regime_shares(self, output: str | None = None) -> dict[str, float]:
        """Return the share of the cells in each regime that occurs, from 0 to 1.

        Parameters
        ----------
        output : str, optional
            The output whose regimes are counted; those of the contact if left out, or for an
            output that holds in every regime.

        Raises
        ------
        VibrafeedError
            If the dataset has no regime, or no such output.
        """
        if output is not None and output not in self._dataset:
            raise VibrafeedError(f"The dataset has no output {output}.")
        judge = None if output is None else judge_of(self._dataset[output].attrs, self._dataset)
        judge = judge or REGIME
        if judge not in self._dataset:
            raise VibrafeedError("The dataset has no regime: it is not a result of vibrafeed.")
        return regime_shares(self._dataset[judge].values)

    def shown(self, *units: str) -> xarray.Dataset:
        """Return the dataset in units that a person reads; names and flags stay as they are.

        Parameters
        ----------
        *units : str
            ``trade`` (mm, mm/s, degrees), ``si``, or units such as ``m/min``, each for its kind;
            if left out, the `units` of the study, or those of the trade.

        Returns
        -------
        xarray.Dataset
            A copy; `units` of its variables say what they are in. It is for reading: plots and
            studies take the dataset itself.

        Raises
        ------
        StudyError
            If one is no unit of anything here, or two are of one kind.
        """
        wanted = units or ("study" in self._dataset.attrs and self.study.units) or ()
        try:
            return in_shown_units(self._dataset, read_shown(wanted))
        except UnitError as error:
            raise StudyError([Problem("units", error.message, error.fix)]) from None

    def trade(self) -> xarray.Dataset:
        """Return the dataset in mm, mm/s, ms, g, mN, deg and 1/min, for reading.

        It is `shown("trade")` with the units written as programs read them.
        """
        return in_shown_units(self._dataset, ShownUnits("trade", PLAIN))

    def to_excel(self, path: str | os.PathLike[str]) -> None:
        """Write an Excel workbook: one row a cell, with units in the headings.

        Further sheets explain the columns and hold the study.

        Parameters
        ----------
        path : str or path
            The file, whose name ends in ``.xlsx``; what is there is replaced.

        Raises
        ------
        VibrafeedError
            If its name ends otherwise, the package is not installed, or a sheet of Excel has not
            enough rows.
        OSError
            If it cannot be written.
        """
        if suffix_of(str(path)) != ".xlsx":
            raise VibrafeedError(f"{path} does not end in .xlsx, by which a workbook is known.")
        line = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} dataset.vibrafeed.to_excel"
        history = f"{line}\n{self._dataset.attrs.get('history', '')}".rstrip()
        write_result(Table.of_xarray(self._dataset), str(path), history=history)
