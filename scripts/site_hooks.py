"""The README as the site's first page, and studies that pages link; mkdocs.yml calls this.

In the repository a page of docs links `../configs/x.toml`; in the site that is `configs/x.toml`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
FILES = ("configs/**/*.toml", "configs/*.stl", "examples/*.py", "examples/*.csv")
OUTSIDE = re.compile(r"\[([^\]]+)\]\([A-Z]+\.md\)")
LINK = re.compile(r"\]\(\.\./((?:configs|examples)/[^)]+)\)")


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add the README and the files to the site."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8").replace("](docs/", "](")
    files.append(File.generated(config, "index.md", content=OUTSIDE.sub(r"\1", readme)))
    for pattern in FILES:
        for path in sorted(ROOT.glob(pattern)):
            name = path.relative_to(ROOT).as_posix()
            files.append(File.generated(config, name, abs_src_path=str(path)))


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Lead links of a page to these files."""
    return LINK.sub(r"](\1)", markdown)
