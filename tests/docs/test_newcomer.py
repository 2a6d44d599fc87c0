"""What the pages for newcomers say is done, here; `scripts/newcomer` does it from nothing."""

import contextlib
import io
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from newcomer import WIDTH, Differs, play, unprinted
from vibrafeed.app.cli import app

ROOT = Path(__file__).parents[2]
PLAYED = (
    "my-bowl", "measuring", "friction", "motion", "optimise", "rows", "tuning", "which-way-up",
)  # fmt: skip
PAGES = ["README.md", *(f"docs/{page}.md" for page in PLAYED)]


def command(text: str, folder: Path) -> str:
    """Run lines of the command line in this process: it has the kernels already."""
    said = ""
    for line in text.splitlines():
        name, *arguments = shlex.split(line, comments=True)
        assert name == "vibrafeed", line
        done = CliRunner().invoke(app, arguments)
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            raise done.exception
        if done.exit_code:
            raise Differs(f"{line} ended with {done.exit_code}:\n{done.output}")
        said += done.output
    return said


def code(text: str, folder: Path) -> str:
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(compile(text, "page", "exec"), {"__name__": "page"})
    return said.getvalue()


@pytest.mark.parametrize("page", PAGES)
def test_a_newcomer_sees_what_the_page_says(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", WIDTH)
    monkeypatch.setenv("NO_COLOR", "1")
    assert play(ROOT / page, tmp_path, command, code) > 1


def test_every_number_of_the_tutorial_is_printed_by_a_program():
    assert unprinted((ROOT / "docs/my-bowl.md").read_text()) == []


PAGE = """\
Save `a.toml`:

```toml
x = 0.5
```

```sh
make 0.5
```

```text
it is 7.4 mm/s, after 3.2 s, to 1e-9
```

It is 7.4 mm/s, not 7.5.

![It](page/it.png)
"""
PICTURE = b"\x89PNG\r\n\x1a\n" + 8 * b"\0" + b"\0\0\0\x07\0\0\0\x05" + 90 * b"."


def played(folder: Path, said: str, drawn: bytes) -> str:
    """Return a page after a newcomer has played it who sees what is given."""
    page, work = folder / "page.md", folder / "page"
    work.mkdir()
    page.write_text(PAGE)
    (work / "it.png").write_bytes(PICTURE)

    def make(text: str, place: Path) -> str:
        assert (text, (place / "a.toml").read_text()) == ("make 0.5\n", "x = 0.5\n")
        (place / "it.png").write_bytes(drawn)
        return said

    assert play(page, folder, make, make) == 4
    return page.read_text()


SAID = "it is 7.4 mm/s, after 9 s, to 2.5e-12  \n"


def test_times_and_rounding_may_differ_and_nothing_else(tmp_path):
    assert played(tmp_path, SAID, PICTURE) == PAGE
    assert unprinted(PAGE) == ["7.5"]


@pytest.mark.parametrize(
    ("said", "drawn", "message"),
    [
        (SAID.replace("7.4", "7.3"), PICTURE, "page.md says\nit is 7.4 mm/s"),
        (f"{SAID}Traceback (most recent call last)", PICTURE, "Traceback"),
        (SAID, PICTURE.replace(b"\x07", b"\x08"), "it.png is (8, 5) pixels, on the page (7, 5)"),
        (SAID, PICTURE[:30], "it.png shows less than on the page"),
        (SAID, b"GIF89a" + bytes(99), "it.png is no PNG"),
    ],
)
def test_what_differs_from_the_page_is_told(tmp_path, said, drawn, message):
    with pytest.raises(Differs) as told:
        played(tmp_path, said, drawn)
    assert message in str(told.value)
