"""The page on the thesis is complete, and what a program writes of it is up to date."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks.figures.judgement import VERDICTS
from benchmarks.figures.page import FIGURES, PAGE, page
from benchmarks.figures.studies import picture_of
from vibrafeed.core.scenes import SCENES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8")
CLAIMS = PAGE.read_text(encoding="utf-8")
LAST = {2: 14, 3: 44, 4: 20}
ERRORS = TEXT.partition("## Errors")[2].partition("\n## ")[0]
EQUATIONS = re.compile(r"^\| \((\d)\.(\d+)\)(?: to \(\1\.(\d+)\))? \|", re.MULTILINE)
FIGURE_ROW = re.compile(
    r"^\| (?:\[([^]]+)\]\((\.\./figures/\S+)\) [^|]+)? \| .+ \| ([^|]+) \| .+ \|$", re.MULTILINE
)


def test_the_page_of_figures_is_up_to_date():
    assert page() == CLAIMS


def test_every_equation_and_every_error_has_a_row():
    rows = {
        (int(chapter), n)
        for chapter, first, last in EQUATIONS.findall(TEXT.partition("## Errors")[0])
        for n in range(int(first), int(last or first) + 1)
    }
    assert rows == {(chapter, n) for chapter, last in LAST.items() for n in range(1, last + 1)}
    numbers = re.findall(r"^\| (\d+) \|", ERRORS, re.MULTILINE)
    assert numbers == [str(number) for number in range(1, 33)]


def test_every_error_names_tests_that_exist_or_says_why_there_is_none():
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py"))
    for row in re.findall(r"^\| \d+ \|.*\|$", ERRORS, re.MULTILINE):
        shown = row.split(" | ")[-1]
        names = re.findall(r"`(test_\w+)`", shown)
        assert names or "no test: " in shown or "`tests/" in shown, row
        for name in names:
            assert f"def {name}(" in tests, name


def test_what_is_named_exists():
    for path in re.findall(r"`((?:tests|configs|core|docs)/\S+\.(?:py|toml|md))`", TEXT):
        assert (ROOT / path).is_file(), path
    pages = (ROOT / "docs").glob("theory*/*.md")
    theory = "".join(page.read_text(encoding="utf-8") for page in [ROOT / "docs/theory.md", *pages])
    for section in set(re.findall(r"\btheory (\d+(?:\.\d+)*)", TEXT)):
        assert re.search(rf"^#+ {re.escape(section)}\.? \S", theory, re.MULTILINE), section
    of_the_thesis = [name for name, scene in SCENES.items() if scene.source]
    assert len(of_the_thesis) == 8
    assert [name for name in of_the_thesis if f"`{name}`" not in TEXT] == []


def test_every_figure_has_a_row_and_a_picture():
    rows = FIGURE_ROW.findall(CLAIMS.partition("numbers |\n")[2])
    names = [(name, link) for names, link, _ in rows for name in names.split(", ") if names]
    assert [name for name, _ in names] == [f"5.{number}" for number in range(1, 30)]
    for number, (_, link) in zip(FIGURES, names, strict=True):
        assert (PAGE.parent / link).resolve() == picture_of(number)
    assert {verdict for *_, verdict in rows} == {*VERDICTS}
