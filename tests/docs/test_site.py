"""The documentation as a site: built strictly, whole, and loading nothing from elsewhere."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# What a browser fetches by itself; a link is followed by a reader.
LOADS = re.compile(
    r"<(?:script|img|iframe|source|link(?![^>]*rel=\"?(?:canonical|prev|next|icon)))\b[^>]*?"
    r"(?:src|href)=[\"']?(?:https?:)?//[^\"' >]+"
)
STYLE = re.compile(r"(?:url\([\"']?|@import\s+[\"'])(?:https?:)?//")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("docs")
    settings = (ROOT / "mkdocs.yml").read_text().replace("docs_dir: docs", f"docs_dir: {ROOT}/docs")
    (folder / "mkdocs.yml").write_text(settings.replace("scripts/", f"{ROOT}/scripts/"))
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", folder / "site"], cwd=folder,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder / "site"


def test_every_page_is_there_and_in_the_navigation(site):
    home = (site / "index.html").read_text()
    for page in (ROOT / "docs").glob("**/*.md"):
        place = page.relative_to(ROOT / "docs").with_suffix(".html").as_posix()
        assert (site / place).exists(), place
        assert f'href="{place}"' in home, place


def test_no_page_loads_anything_from_elsewhere(site):
    for page in site.glob("**/*.html"):
        assert LOADS.findall(page.read_text()) == [], page.name
        assert "mermaid" not in page.read_text(), "its program would be fetched"
    for style in site.glob("**/*.css"):
        assert STYLE.findall(style.read_text()) == [], style.name
