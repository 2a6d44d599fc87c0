"""A newcomer who does what a page says: writes files, types commands, looks at pictures.

Of a page, in its order: a block after "`name`:" is a file, `sh` is typed, `python` is run, `text`
is what the block before it prints, and a picture in the page's own folder is one that a block
before it has drawn, under the same name. Files that the page links lie ready.

    python tests/helpers/newcomer.py docs/my-bowl.md --write   # what is printed and drawn, anew

It needs nothing but Python, so that `scripts/newcomer` can use it before anything is installed.
"""

import argparse
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

PARTS = re.compile(
    r"(?:`(?P<title>[\w.-]+)`:\n\n)?^```(?P<language>\w+)\n(?P<text>.*?)^```$"
    r"|^!\[[^\]]*\]\((?P<picture>[^)]+\.png)\)$",
    re.MULTILINE | re.DOTALL,
)
LINKED = re.compile(r"(?<!!)\[[^\]]*\]\(([\w./-]+\.(?:csv|toml|stl))\)")
NUMBER = re.compile(r"(?<![\w.])\d[\d,]*(?:\.\d+)?")
TIMES = re.compile(r"\b[\d.,]+ (?:ms|s|min)\b")  # of computing
ROUNDING = re.compile(r"-?\b\d[\d.]*e-\d+\b")  # residuals: another processor has others
COMPILED = re.compile(r".*\b(?:compiling once, .*;|compiled in .*: once,) it is kept$")
COUNTED = re.compile(r"^#.*$|\b(?:ISO|[Ss]teps?) \d+", re.MULTILINE)  # no results
WIDTH = "80"  # columns

Typed = Callable[[str, Path], str]


class Differs(AssertionError):
    """What a newcomer sees is not what the page says."""


@dataclass(frozen=True)
class Part:
    """A block or a picture of a page; `kind` is a language, `file` or `picture`."""

    kind: str
    text: str
    title: str
    start: int
    end: int


def parts_of(page: str) -> Iterator[Part]:
    """Return what a page shows, in its order."""
    for found in PARTS.finditer(page):
        if found["picture"]:
            yield Part("picture", "", found["picture"], *found.span())
        elif found["title"]:
            yield Part("file", found["text"], found["title"], *found.span("text"))
        else:
            yield Part(found["language"], found["text"], "", *found.span("text"))


def steady(text: str) -> str:
    """Return what is printed without what differs from run to run or between machines."""
    lines = [line.rstrip() for line in text.strip("\n").splitlines()]
    # Whoever has compiled a sort of study before is not told again.
    lines = [line for line in lines if not COMPILED.match(line)]
    return ROUNDING.sub("ROUNDING", TIMES.sub("TIME", "\n".join(lines))).strip()


def size_of(picture: Path) -> tuple[int, int]:
    """Return width and height of a PNG, in pixels."""
    head = picture.read_bytes()[:24]
    if head[:8] != b"\x89PNG\r\n\x1a\n":
        raise Differs(f"{picture.name} is no PNG")
    width, height = struct.unpack(">II", head[16:24])
    return width, height


def unprinted(page: str) -> list[str]:
    """Return the numbers of a page's prose that no block of it shows."""
    blocks = {value for part in parts_of(page) for value in numbers(part.text)}
    prose = re.sub(r"^```.*?^```$", "", page, flags=re.MULTILINE | re.DOTALL)
    prose = COUNTED.sub("", re.sub(r"\]\([^)]*\)", "]", prose))
    return sorted({text for text in NUMBER.findall(prose) if numbers(text)[0] not in blocks})


def numbers(text: str) -> list[float]:
    """Return the sizes of all numbers in a text."""
    return [float(number.replace(",", "").rstrip(".")) for number in NUMBER.findall(text)]


def play(page: Path, folder: Path, command: Typed, code: Typed, *, write: bool = False) -> int:
    """Do all that a page says in a folder, and compare; return the number of things done.

    With `write` what is printed and drawn goes into the page instead.
    """
    text = page.read_text(encoding="utf-8")
    for name in LINKED.findall(text):
        shutil.copy(page.parent / name, folder)
    said, changes = "", []
    parts = list(parts_of(text))
    for part in parts:
        if part.kind == "file":
            (folder / part.title).write_text(part.text, encoding="utf-8")
        elif part.kind == "sh":
            said = command(part.text, folder)
        elif part.kind == "python":
            said = code(part.text, folder)
        elif part.kind == "text" and steady(said) != steady(part.text):
            if not write:
                raise Differs(f"{page.name} says\n{part.text}\nbut there is\n{said}")
            lines = [line.rstrip() for line in said.strip("\n").splitlines()]
            changes.append((part, "\n".join(lines).strip("\n") + "\n"))
        elif part.kind == "picture" and part.title.startswith(f"{page.stem}/"):
            look(page.parent / part.title, folder / Path(part.title).name, write=write)
        if "Traceback (most recent call last)" in said:
            raise Differs(said)
    for part, new in reversed(changes):
        text = text[: part.start] + new + text[part.end :]
    if changes:
        page.write_text(text, encoding="utf-8")
    return len(parts)


def look(shown: Path, drawn: Path, *, write: bool) -> None:
    """Compare a picture that was drawn with that of the page: both there, and of one size."""
    if not drawn.exists():
        raise Differs(f"{drawn.name} was promised and is not there")
    if write:
        shown.parent.mkdir(exist_ok=True)
        shutil.copy(drawn, shown)
    if size_of(shown) != size_of(drawn):
        raise Differs(f"{drawn.name} is {size_of(drawn)} pixels, on the page {size_of(shown)}")
    if drawn.stat().st_size < shown.stat().st_size / 2:
        raise Differs(f"{drawn.name} shows less than on the page")


def surroundings(tools: Path) -> dict[str, str]:
    """Return an environment in which this Python and its `vibrafeed` come first."""
    here = Path(sys.executable).parent
    if not (here / "vibrafeed").exists():
        here = tools
        for name, command in (("python", ""), ("vibrafeed", " -m vibrafeed")):
            (tools / name).write_text(f'#!/bin/sh\nexec "{sys.executable}"{command} "$@"\n')
            (tools / name).chmod(0o755)
    path = f"{here}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "COLUMNS": WIDTH, "NO_COLOR": "1", "PYTHONUTF8": "1"}


def typed(environment: dict[str, str], *arguments: str) -> Typed:
    """Return how a newcomer runs a text: as the last argument of a program."""

    def run(text: str, folder: Path) -> str:
        sys.stderr.write(text)
        done = subprocess.run(
            [*arguments, text], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, encoding="utf-8", check=False, env=environment,
        )  # fmt: skip
        if done.returncode:
            raise Differs(f"{text}ended with {done.returncode}:\n{done.stdout}")
        return done.stdout

    return run


def main() -> None:
    """Play pages in new folders."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="write what is printed into the pages")
    options = parser.parse_args()
    for page in options.pages:
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as tools:
            around = surroundings(Path(tools))
            command, code = typed(around, "sh", "-ec"), typed(around, "python", "-c")
            done = play(page, Path(folder), command, code, write=options.write)
        sys.stdout.write(f"{page}: {done} things done\n")


if __name__ == "__main__":
    main()
