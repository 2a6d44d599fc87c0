"""`python -m benchmarks.architecture_page` draws the rooms of docs/architecture.md.

The drawing has a row for each layer of the import contracts in pyproject.toml, with the first
sentence of each package's docstring, and the contracts that forbid a package something besides.
"""

from __future__ import annotations

import ast
import textwrap
import tomllib
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
DRAWING = ROOT / "docs" / "generated" / "rooms.svg"

WAY = {
    "vibrafeed.core.study": "1 a study is read and checked",
    "vibrafeed.core.scenes": "2 a scene names its equations",
    "vibrafeed.core.plan": "3 a plan leaves out what nothing asks for",
    "vibrafeed.core.motion": "4 motion is followed in time",
    "vibrafeed.core.sweep": "4 closed forms are evaluated",
    "vibrafeed.core.dataset": "5 a labelled dataset holds the results",
    "vibrafeed.core.plots": "6 a picture is drawn",
    "vibrafeed.app.web": "6 a reply is sent",
    "vibrafeed.app.cli": "6 a file is written",
}
"""Where the way of the data passes, by package."""

# Sizes in pixels. 1,000 across is what a page of the site shows without scaling; a sentence that is
# longer than a column wraps, at the mean width of a letter of the font.
WIDTH, NAME, LINE, MARGIN = 1000, 190, 17, 8
SENTENCE, STEP = 74, 40
STYLE = (
    "text{font:13px sans-serif;fill:#1b1f24}.name{font-weight:bold}"
    ".rule{fill:#8a3b12;font-style:italic}"
    ".step{fill:#0b5394}.box{fill:#fff;stroke:#8c959f}.way{fill:#e8f1fb;stroke:#0b5394}"
)


@dataclass(frozen=True)
class Room:
    """A package or module of a layer.

    `purpose` is the first sentence of its docstring; `rules` are the names of contracts that forbid
    it something besides the order of the layers.
    """

    name: str
    purpose: str
    rules: tuple[str, ...]


def contracts() -> list[dict[str, Any]]:
    """Return the import contracts of the project file."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    found: list[dict[str, Any]] = tomllib.loads(text)["tool"]["importlinter"]["contracts"]
    return found


def layers(rules: list[dict[str, Any]]) -> list[list[Room]]:
    """Return the packages of each layer, topmost first, with the app's own layers."""
    stacks = [rule["layers"] for rule in rules if rule["type"] == "layers"]
    whole, app = stacks[0], stacks[1]
    at = whole.index("app")
    forbidden = [rule for rule in rules if rule["type"] == "forbidden"]
    return [
        [_room(f"vibrafeed.{name}", forbidden) for name in layer.split(" | ")]
        for layer in ("", *app, *whole[at + 1 :])
    ]


def _room(name: str, forbidden: list[dict[str, Any]]) -> Room:
    """Return a package with the contracts that name it directly."""
    rules = tuple(rule["name"] for rule in forbidden if name in rule["source_modules"])
    return Room(name, purpose(name), rules)


def purpose(name: str) -> str:
    """Return the first sentence of the docstring of a package or module."""
    path = ROOT / name.replace(".", "/")
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].replace("`", "").split())


def drawing() -> str:
    """Return the architecture drawing as SVG."""
    y, parts = MARGIN, []
    for layer in layers(contracts()):
        top = y
        texts = []
        for room in layer:
            height, text = _texts(room, y + MARGIN)
            texts.append(text)
            y += height
        y += MARGIN
        kind = "way" if any(room.name in WAY for room in layer) else "box"
        size = f'width="{WIDTH - 2 * MARGIN}" height="{y - top}"'
        parts.append(f'<rect class="{kind}" x="{MARGIN}" y="{top}" {size}/>')
        parts += texts
        y += MARGIN // 2
    size = f'width="{WIDTH}" height="{y}"'
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y}" {size}>'
        "<title>Packages of vibrafeed: each imports from below only</title>"
        f'<style>{STYLE}</style><rect {size} fill="#fff"/>'
    )
    return "\n".join((head, *parts, "</svg>", ""))


def _texts(room: Room, y: int) -> tuple[int, str]:
    """Return the height of a package's box in pixels, and its texts, the first at `y`."""
    sentences = [("", line) for line in textwrap.wrap(room.purpose, SENTENCE)]
    sentences += [("rule", line) for rule in room.rules for line in textwrap.wrap(rule, SENTENCE)]
    steps = textwrap.wrap(WAY.get(room.name, ""), STEP)
    columns = (
        (2 * MARGIN, [("name", room.name)]),
        (NAME, sentences),
        (WIDTH - 310, [("step", line) for line in steps]),
    )
    texts = [
        f'<text class="{style}" x="{x}" y="{y + LINE * row + 10}">{escape(line)}</text>'
        for x, lines in columns
        for row, (style, line) in enumerate(lines)
    ]
    return LINE * max(len(lines) for _, lines in columns), "\n".join(texts)


if __name__ == "__main__":
    DRAWING.write_text(drawing(), encoding="utf-8")
    print(f"wrote {DRAWING.name}")
