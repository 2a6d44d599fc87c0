"""Files of the site that docs does not hold: the first page, studies, and pages by programs.

The README is the first page. In the repository a page of docs links `../configs/x.toml`; in the
site that is `configs/x.toml`. mkdocs.yml names this file.
"""

from __future__ import annotations

import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
FILES = (
    "configs/**/*.toml",
    "configs/*.stl",
    "examples/**/*.py",
    "examples/**/*.toml",
    "examples/*.csv",
    "examples/*.yaml",
)
OUTSIDE = re.compile(r"\[([^\]]+)\]\([A-Z]+\.md\)")
LINK = re.compile(r"\]\(\.\./((?:configs|examples)/[^)]+)\)")


@cache
def written_pages() -> dict[str, str]:
    """Return the pages that are written from the code, by name."""
    sys.path.insert(0, str(ROOT))
    from benchmarks import gallery, kinds_page, mistakes_page, quantities_page, settings_page

    written = {
        "gallery": gallery,
        "kinds": kinds_page,
        "mistakes": mistakes_page,
        "quantities": quantities_page,
        "settings": settings_page,
    }
    return {f"generated/{name}.md": program.page() for name, program in written.items()}


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add the README, studies, examples and written pages to the site."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8").replace("](docs/", "](")
    files.append(File.generated(config, "index.md", content=OUTSIDE.sub(r"\1", readme)))
    for pattern in FILES:
        for path in sorted(ROOT.glob(pattern)):
            name = path.relative_to(ROOT).as_posix()
            files.append(File.generated(config, name, abs_src_path=str(path)))
    for name, text in written_pages().items():
        files.append(File.generated(config, name, content=text))


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Lead links of a page to these files."""
    return LINK.sub(r"](\1)", markdown)
