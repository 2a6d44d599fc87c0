"""The accuracy report as files: page, pictures, datasets."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from app import report
from core.accuracy.page import Section, head_of, sections_of, write_page
from core.accuracy.report import SECONDS, machine, measure_study
from core.dataset.netcdf import write_netcdf
from core.sweep.prepare import Prepared
from core.watch import Watch

PAGE = "accuracy.md"


def write_report(
    prepared: Mapping[Path, Prepared],
    folder: Path,
    only: Sequence[str],
    seconds: float,
    stopped: Callable[[], bool],
    more: Sequence[Section] = (),
) -> list[Path]:
    """Measure studies, write everything into a folder, and return the files.

    Parameters
    ----------
    prepared : mapping of Path to Prepared
        The studies by their files.
    only : sequence of str
        Families of measurements; all if empty.
    seconds : float
        Of one family.
    stopped : callable
        Whether to stop.
    more : sequence of Section
        Further sections of the page, after those of the studies.

    Raises
    ------
    OSError
        If something cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    facts = machine()  # before the first measurement adds to the load
    command = shlex.join(["vibrafeed", "report", *map(str, prepared), "-o", str(folder)])
    command += "".join(f" --only {name}" for name in only)
    command += "" if seconds == SECONDS else f" --seconds {seconds:g}"
    sections: list[Section] = []
    written: list[Path] = []
    for path, study in prepared.items():
        if stopped():
            break
        with report.progress(path.name) as advance:
            part = measure_study(
                study, name=str(path), watch=Watch(advance, stopped), seconds=seconds, only=only
            )
        target = folder / f"accuracy-{path.stem}.nc"
        write_netcdf(part.table, target, history=f"{facts['date']} {command}")
        families = [one.family for one in part.measured if one.curves]
        pictures = _draw(target, folder, path.stem, families)
        written += [target, *pictures.values()]
        names = {family: picture.name for family, picture in pictures.items()}
        sections += sections_of(part, names)
    page = folder / PAGE
    page.write_text(
        write_page("Accuracy", head_of(facts, command), [*sections, *more]), encoding="utf-8"
    )
    return [*written, page]


def _draw(file: Path, folder: Path, stem: str, families: Sequence[str]) -> dict[str, Path]:
    """Draw the families of a written dataset; nothing where matplotlib is not installed."""
    try:
        from core.plots.accuracy import draw_accuracy
        from core.plots.files import save
    except ModuleNotFoundError as error:
        report.fail(f"{error.name} is missing: no pictures. pip install 'vibrafeed[plot]'.")
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
