"""The report of one study as a job: a block with the measurement, then page and picture."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import xarray

from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.report import Report
from vibrafeed.core.system import installing

if TYPE_CHECKING:
    from vibrafeed.app.jobs.store import Store

logger = logging.getLogger("vibrafeed.jobs")

PAGE = "accuracy.md"


def write_report(
    store: Store, key: str, process: str, prepared: Prepared, cells: int, seconds: float
) -> None:
    """Write the measurement of a study as its result: dataset, page and picture.

    Raises `TornBlockError` if its block is missing or damaged.

    Parameters
    ----------
    store : Store
        Where the block is read and the result is written.
    key, process : str
        The study's identifier, and the process whose result the report is.
    prepared : Prepared
        The checked study.
    cells : int
        Size of a block in cells, under which the store keeps the block.
    seconds : float
        Computing time [s], for the manifest.
    """
    report = Report.of(store.read_block(key, cells, 0))

    def write_more(dataset: Path, folder: Path) -> list[Path]:
        picture = draw(dataset, folder / "accuracy-study.png", logger.warning)
        title = prepared.study.title or prepared.plan.scene.title
        section = report.section("study.json", title, picture.name if picture else None)
        (folder / PAGE).write_text(report.page([section]), encoding="utf-8")
        return [folder / PAGE, *([picture] if picture else [])]

    store.finish(
        key, report.table(prepared), process=process, cells=prepared.cells, blocks=1,
        seconds=seconds, write_more=write_more,
    )  # fmt: skip


def draw(file: Path, target: Path, warn: Callable[[str], object]) -> Path | None:
    """Draw the report in a NetCDF file; return the path of the picture, None if there is none.

    `warn` is called with a sentence if matplotlib is missing.
    """
    try:
        from vibrafeed.core.plots.drawing import save
        from vibrafeed.core.plots.measured import draw_report
    except ModuleNotFoundError as error:
        warn(f"{error.name} is missing: no pictures. {installing('matplotlib', 'plot')}")
        return None
    with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
        figure = draw_report(dataset)
        if figure is None:
            return None
        save(figure, target)
    return target
