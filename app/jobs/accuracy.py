"""The accuracy report of one study: measured by a worker, its page and pictures beside its data."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import xarray

from vibrafeed.core.assurance.accuracy.families import families_of
from vibrafeed.core.assurance.accuracy.kept import keep, kept
from vibrafeed.core.assurance.accuracy.page import head_of, sections_of, write_page
from vibrafeed.core.assurance.accuracy.report import machine, measure_family, part_of
from vibrafeed.core.extras import installing
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.app.jobs.store import Store

logger = logging.getLogger("vibrafeed.jobs")

PAGE = "accuracy.md"


def measure_block(prepared: Prepared, index: int, watch: Watch) -> Computed:
    """Measure one family of an accuracy study and return its results as arrays of a block.

    Parameters
    ----------
    prepared : Prepared
        The checked study.
    index : int
        Number of the family among those that the study has, from 0.
    watch : Watch
        Stops the measurement when the work is given up, and limits its threads.
    """
    facts = machine()
    return keep(measure_family(prepared, families_of(prepared)[index], watch), facts)


def write_report(
    store: Store, key: str, process: str, prepared: Prepared, cells: int, seconds: float
) -> None:
    """Join the blocks of an accuracy study into its report: dataset, page and pictures.

    Raises `TornBlockError` if a block is missing or damaged.

    Parameters
    ----------
    store : Store
        Where blocks are read and the report is written.
    key, process : str
        The study's identifier, and the process whose result the report is.
    prepared : Prepared
        The checked study.
    cells : int
        Size of a block in cells, under which the store keeps the blocks.
    seconds : float
        Computing time of all blocks [s], for the manifest.
    """
    count = len(families_of(prepared))
    blocks = [kept(store.read_block(key, cells, index)) for index in range(count)]
    facts = blocks[0][1]
    part = part_of(prepared, "study.json", [one for one, _ in blocks if one is not None], facts)

    def more(dataset: Path, folder: Path) -> list[Path]:
        """Write the page and the pictures of the report into a folder; return their paths.

        `dataset` is the path of the NetCDF file that the pictures are drawn from.
        """
        families = [one.family for one in part.measured if one.curves]
        pictures = draw(dataset, folder, "study", families, logger.warning)
        names = {family: path.name for family, path in pictures.items()}
        head = head_of(facts, "vibrafeed report study.json")
        page = write_page("Accuracy", head, list(sections_of(part, names)))
        (folder / PAGE).write_text(page, encoding="utf-8")
        return [folder / PAGE, *pictures.values()]

    store.finish(
        key, part.table, process=process, cells=prepared.cells, blocks=count, seconds=seconds,
        more=more,
    )  # fmt: skip


def draw(
    file: Path, folder: Path, stem: str, families: Sequence[str], warn: Callable[[str], object]
) -> dict[str, Path]:
    """Draw one picture per family of an accuracy dataset; return the path of each by its family.

    Parameters
    ----------
    file : Path
        The NetCDF file of the dataset.
    folder : Path
        Where the pictures are written, as `accuracy-<stem>-<family>.png`.
    stem : str
        Middle part of the file names.
    families : sequence of str
        The families to draw; one without curves gets no picture.
    warn : callable
        Called with a sentence if matplotlib is missing; the result is then empty.
    """
    try:
        from vibrafeed.core.plots.accuracy import draw_accuracy
        from vibrafeed.core.plots.files import save
    except ModuleNotFoundError as error:
        warn(f"{error.name} is missing: no pictures. {installing('matplotlib', 'plot')}")
        return {}
    pictures = {}
    with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
        for family in families:
            figure = draw_accuracy(dataset, family)
            if figure is not None:
                pictures[family] = folder / f"accuracy-{stem}-{family.replace('_', '-')}.png"
                save(figure, pictures[family])
    return pictures
