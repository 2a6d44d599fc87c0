"""The documents keep up with the code: names, routes, examples."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from benchmarks.quantities_page import PAGE, page
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import DIRECTIONS, MOTION_STATUSES

ROOT = Path(__file__).parents[4]


def blocks(path: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / path).read_text(), re.DOTALL)


def test_the_quantities_page_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == page()


def test_every_route_is_documented(tmp_path, without_studies):
    routes = create_app(Settings(data_directory=tmp_path)).openapi()["paths"]
    text = (ROOT / "docs/api.md").read_text()
    for path, methods in routes.items():
        for method in methods:
            assert f"`{method.upper()} {path}`" in text


def test_the_readme_shows_a_study_that_runs():
    motion, study = blocks("README.md", "toml")
    assert prepare_content(tomllib.loads(study)).cells == 61 * 3 * 21 * 41
    assert prepare_content(tomllib.loads(motion)).cells == 71 * 56


def test_the_page_on_motion_shows_a_study_and_rates_that_run():
    study, fed = blocks("docs/motion.md", "toml")
    (measured,) = blocks("docs/measured-drives.md", "toml")
    found = run_study(parse_study(tomllib.loads(study)))
    assert found.sizes == {"cycle_time": 401}
    driven = tomllib.loads(measured)
    driven["drive"]["file"] = str(ROOT / "examples" / driven["drive"]["file"])
    assert prepare_content(driven, files=True).cells == 21
    rate = run_study(parse_study(tomllib.loads(fed)))
    assert f"{float(rate.feed_rate):.2f} parts a minute, forwards" in " ".join(
        (ROOT / "docs/motion.md").read_text().split()
    )
    assert int(rate.direction) == DIRECTIONS["forwards"].value
    namespace: dict[str, object] = {}
    exec(blocks("docs/motion.md", "python")[0], namespace)
    text = (ROOT / "docs/motion.md").read_text()
    for name, flag in MOTION_STATUSES.items():
        assert f"`{name}`" in text or flag.valid, name


def test_the_readme_shows_the_two_commands_first():
    text = (ROOT / "README.md").read_text()
    assert re.search(r"```\n(.*?)```", text, re.DOTALL)[1].split() == [
        "make",
        "run",
        "make",
        "test",
    ]


def test_links_between_documents_hold():
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")):
        for target in re.findall(r"\]\(([^)#]+)\)", path.read_text()):
            if not target.startswith("http"):
                assert (path.parent / target).exists(), f"{path.name}: {target}"
