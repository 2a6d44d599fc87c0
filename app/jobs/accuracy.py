"""The accuracy report of one study: measured by a worker, its page and pictures beside its data."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path

import xarray

from app.jobs.store import Store
from core.assurance.accuracy.families import families_of
from core.assurance.accuracy.kept import keep, kept
from core.assurance.accuracy.page import head_of, sections_of, write_page
from core.assurance.accuracy.report import machine, measure_family, part_of
from core.extras import installing
from core.plan.pieces import Computed
from core.plan.prepared import Prepared
from core.watch import Watch

logger = logging.getLogger("vibrafeed.jobs")

PAGE = "accuracy.md"


def measure_block(prepared: Prepared, index: int, watch: Watch) -> Computed:
    """Measure one family of an accuracy study and return its results as arrays of a block."""
    facts = machine()
    return keep(measure_family(prepared, families_of(prepared)[index], watch), facts)


def write_report(
    store: Store, key: str, process: str, prepared: Prepared, cells: int, seconds: float
) -> None:
    """Write the accuracy report from its blocks; raise `TornBlockError` if one cannot be read.

    Parameters
    ----------
    cells : int
        Under which the blocks are kept.
    seconds : float
        What they took.
    """
    count = len(families_of(prepared))
    blocks = [kept(store.read_block(key, cells, index)) for index in range(count)]
    facts = blocks[0][1]
    part = part_of(prepared, "study.json", [one for one, _ in blocks if one is not None], facts)

    def more(dataset: Path, folder: Path) -> list[Path]:
        """Write the page and pictures of the report into a folder; return their paths."""
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
    """Draw one picture per family of an accuracy dataset.

    Without matplotlib call `warn` instead.
    """
    try:
        from core.plots.accuracy import draw_accuracy
        from core.plots.files import save
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
