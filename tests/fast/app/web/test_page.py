"""The page at /: who gets it, under which policy, and what it is made of."""

from __future__ import annotations

import gzip
import hashlib
import importlib
import mimetypes
import re
import shutil
from pathlib import Path

import pytest

from access import give_key
from local_client import local_client
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.routes import page
from vibrafeed.core.quantities.pictures import INKS, colour_of

PAGE = Path(__file__).parents[4] / "app" / "page"
BROWSER = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
MOST = 400_000  # bytes, compressed


@pytest.fixture
def client(tmp_path):
    return local_client(create_app(Settings(data_directory=tmp_path)))


def test_a_browser_gets_the_page_and_a_program_gets_links(client):
    page = client.get("/", headers=BROWSER)
    assert page.headers["content-type"].startswith("text/html")
    assert "<title>vibrafeed</title>" in page.text
    assert client.get("/").json()["title"] == "vibrafeed"
    assert client.get("/", headers={"Accept": "application/json"}).json()["links"]


def test_the_page_runs_scripts_of_its_own_files_only(client):
    for path in ("/", "/page/modules/main.js", "/docs", "/static-offline-docs/swagger-ui.css"):
        policy = client.get(path, headers=BROWSER).headers["content-security-policy"]
        assert "script-src 'self';" in policy
        assert "unsafe" not in policy
    for path in ("/", "/docs"):
        text = client.get(path, headers=BROWSER).text
        assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\son[a-z]+=|\sstyle=", text)


def test_a_wheel_with_a_bundle_sends_it_in_place_of_the_entry(tmp_path, monkeypatch):
    folder = tmp_path / "page"
    shutil.copytree(PAGE, folder)
    (folder / "bundle.js").write_text("// all modules")
    monkeypatch.setattr(page, "FILES", folder)
    monkeypatch.setattr(page, "BUNDLE", folder / "bundle.js")
    client = local_client(create_app(Settings(data_directory=tmp_path / "data")))
    assert client.get("/page/modules/main.js").text == "// all modules"
    assert "import" in client.get("/page/modules/answers.js").text


def test_the_page_needs_no_key_and_what_it_asks_does(tmp_path):
    give_key(tmp_path)
    client = local_client(create_app(Settings(data_directory=tmp_path)))
    assert client.get("/", headers=BROWSER).status_code == 200
    assert client.get("/page/page.css").status_code == 200
    assert client.get("/scenes").status_code == 401


def test_scripts_have_their_type_whatever_the_registry_of_windows_says():
    for ending in (".js", ".css", ".svg"):
        mimetypes.add_type("text/plain", ending)
    importlib.reload(page)
    types = [mimetypes.guess_type(f"page{ending}")[0] for ending in (".js", ".css", ".svg")]
    assert types == ["text/javascript", "text/css", "image/svg+xml"]


def test_libraries_are_what_they_were_published_as():
    vendor = PAGE / "vendor"
    listed = dict(
        reversed(line.split()) for line in (vendor / "SHA256SUMS").read_text().splitlines()
    )
    files = [path for path in vendor.iterdir() if path.suffix in (".js", ".mjs", ".css")]
    assert {path.name for path in files} == set(listed)
    for path in files:
        assert hashlib.sha256(path.read_bytes()).hexdigest() == listed[path.name]
        assert path.name in (vendor / "README.md").read_text()


def test_the_page_makes_no_markup_from_text_and_stays_small():
    modules = [path.read_text() for path in (PAGE / "modules").glob("*.js")]
    assert len(modules) > 8
    for text in modules:
        assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", text)
    files = [path for path in PAGE.rglob("*") if path.suffix in (".js", ".css", ".html", ".svg")]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < MOST


def test_each_colour_of_a_regime_has_its_mark():
    marks = (PAGE / "modules" / "markers.js").read_text()
    assert {colour_of(name) for name in INKS} == set(re.findall(r'"(#\w{6})": [A-Z]+,', marks))
    motion = [
        "stick",
        "slip",
        "stick_slip",
        "hopping",
        "hop_after_hop",
        "period_doubled",
        "aperiodic",
    ]
    shapes = dict(re.findall(r'"(#\w{6})": ([A-Z]+),', marks))
    assert len({shapes[colour_of(name)] for name in motion}) == len(motion)


def test_figures_are_studies_that_the_service_takes(client):
    figures = client.get("/figures").json()
    assert [one["name"] for one in figures[:3]] == ["fig-3-3", "fig-3-15", "fig-5-1"]
    assert all(one["title"] and one["notes"] for one in figures)
    assert client.post("/sweeps", json=figures[-1]["study"]).status_code == 201
