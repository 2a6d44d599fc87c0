"""The accuracy report of one study: measured by a worker, its page and pictures beside its data."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from app.jobs.store import Store
from core.accuracy.page import head_of, sections_of, write_page
from core.accuracy.report import machine, measure_study
from core.plan.prepared import Prepared

logger = logging.getLogger("vibrafeed.jobs")

PAGE = "accuracy.md"


def write_report(store: Store, key: str, process: str, prepared: Prepared) -> None:
    """Measure the accuracy of a study and write the report."""
    started, facts = time.perf_counter(), machine()
    part = measure_study(prepared, name="study.json")

    def more(dataset: Path, folder: Path) -> list[Path]:
        families = [one.family for one in part.measured if one.curves]
        pictures = draw(dataset, folder, "study", families, logger.warning)
        names = {family: path.name for family, path in pictures.items()}
        head = head_of(facts, "vibrafeed report study.json")
        page = write_page("Accuracy", head, list(sections_of(part, names)))
        (folder / PAGE).write_text(page, encoding="utf-8")
        return [folder / PAGE, *pictures.values()]

    seconds = time.perf_counter() - started
    store.finish(
        key, part.table, process=process, cells=prepared.cells, blocks=0, seconds=seconds, more=more
    )


def draw(
    file: Path, folder: Path, stem: str, families: Sequence[str], warn: Callable[[str], object]
) -> dict[str, Path]:
    """Draw the families of a written dataset; where matplotlib is not installed, warn instead."""
    try:
        from core.plots.accuracy import draw_accuracy
        from core.plots.files import save
    except ModuleNotFoundError as error:
        warn(f"{error.name} is missing: no pictures. pip install 'vibrafeed[plot]'.")
        return {}
    import xarray

    pictures = {}
    with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
        for family in families:
            figure = draw_accuracy(dataset, family)
            if figure is not None:
                pictures[family] = folder / f"accuracy-{stem}-{family.replace('_', '-')}.png"
                save(figure, pictures[family])
    return pictures
