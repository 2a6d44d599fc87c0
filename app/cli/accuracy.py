"""The accuracy report of many studies as files: one page, pictures, datasets."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from vibrafeed.app.cli import console
from vibrafeed.app.jobs.accuracy import PAGE, draw
from vibrafeed.core.assurance import leaving_out
from vibrafeed.core.assurance.accuracy.families import SECONDS
from vibrafeed.core.assurance.accuracy.page import PageSection, head_of, sections_of, write_page
from vibrafeed.core.assurance.accuracy.report import machine, measure_study
from vibrafeed.core.assurance.hard_cases import HARD_CASES
from vibrafeed.core.assurance.judge import run_cases
from vibrafeed.core.assurance.tables import hard_cases_markdown, hard_cases_table
from vibrafeed.core.dataset.files import whole
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.watch import Watch

EXTREMES = ("extremes", "leaving-out")  # datasets of what is asked of no study


STOPPED = "The measurement was stopped early: the remaining measurements are missing."


def write_report(
    studies: Mapping[Path, Prepared],
    folder: Path,
    only: Sequence[str],
    seconds: float,
    stopped: Callable[[], bool],
    extremes: bool = False,
) -> tuple[list[Path], bool]:
    """Measure the accuracy of studies; write the page, pictures and datasets into a folder.

    Parameters
    ----------
    studies : mapping of Path to Prepared
        The studies by their files.
    folder : Path
        Where the report is written; created if missing.
    only : sequence of str
        Families of measurements; all if empty.
    seconds : float
        Time after which a family starts no further measurement [s].
    stopped : callable
        Returns True once Ctrl-C was pressed.
    extremes : bool
        True to also run the hard cases, which may fail, and to count what a study does not load or
        compute.

    Returns
    -------
    tuple
        The written files, and True if all hard cases passed.

    Raises
    ------
    OSError
        If something cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    facts = machine()  # before the first measurement adds to the load
    words = ["vibrafeed", "report", *map(str, studies), *(["--extremes"] if extremes else [])]
    command = shlex.join([*words, "-o", str(folder)])
    command += "".join(f" --only {name}" for name in only)
    command += "" if seconds == SECONDS else f" --seconds {seconds:g}"
    sections: list[PageSection] = []
    written: list[Path] = []
    page = folder / PAGE

    def write() -> None:
        """Write the page with all sections that are measured so far."""
        head = [*head_of(facts, command), *([STOPPED] if stopped() else [])]
        with whole(page) as temporary:
            temporary.write_text(write_page("Accuracy", head, sections), encoding="utf-8")

    for path, prepared in studies.items():
        if stopped():
            break
        with console.progress(path.name) as advance:
            part = measure_study(
                prepared, name=str(path), watch=Watch(advance, stopped), seconds=seconds, only=only
            )
        target = dataset_of(folder, path.stem)
        write_netcdf(part.table, target, history=f"{facts['date']} {command}")
        families = [one.family for one in part.measured if one.curves]
        pictures = draw(target, folder, path.stem, families, console.fail)
        written += [target, *pictures.values()]
        names = {family: picture.name for family, picture in pictures.items()}
        sections += sections_of(part, names, seconds)
        write()  # whatever becomes of the next study
    right = True
    if extremes:
        tables, more, right = _extremes(stopped)
        for name, table in tables.items():
            written.append(dataset_of(folder, name))
            write_netcdf(table, written[-1], history=f"{facts['date']} {command}")
        sections += more
    write()
    return [*written, page], right


def dataset_of(folder: Path, name: str) -> Path:
    """Return the path of a study's measurements in a folder; `name` is the stem of its file."""
    return folder / f"accuracy-{name}.nc"


def _extremes(stopped: Callable[[], bool]) -> tuple[dict[str, Table], list[PageSection], bool]:
    """Run the hard cases, and measure what studies of one output load and compute.

    `stopped` is a function that returns True once Ctrl-C was pressed.

    Returns
    -------
    tables : dict of str to Table
        One for each of the two, by the name of its file; those without rows are left out.
    sections : list of PageSection
        Their sections of the accuracy report.
    right : bool
        True if all hard cases passed.
    """
    with console.progress("hard cases") as advance:
        outcomes = run_cases(HARD_CASES, Watch(advance, stopped))
    with console.progress("what a study does not load or compute") as advance:
        rows = leaving_out.footprints(watch=Watch(advance, stopped))
    by = "`vibrafeed report --extremes`\n\n"
    tables: dict[str, Table] = {}
    sections: list[PageSection] = []
    if outcomes:
        tables[EXTREMES[0]] = hard_cases_table(outcomes)
        untried = len(HARD_CASES) - len(outcomes) if stopped() else 0
        sections.append(PageSection("Hard cases", by + hard_cases_markdown(outcomes, untried)))
    if rows:
        tables[EXTREMES[1]] = leaving_out.to_table(rows)
        sections.append(
            PageSection("What a study does not load or compute", by + leaving_out.to_markdown(rows))
        )
    return tables, sections, all(outcome.passed for outcome in outcomes)
