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

from local_client import client_of
from vibrafeed.app.web.routes import page
from vibrafeed.core.quantities.pictures import INKS, colour_of

PAGE = Path(__file__).parents[4] / "app" / "page"
BROWSER = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
MOST = 400_000  # bytes, compressed
MARKUP = r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\("


@pytest.fixture
def client(tmp_path):
    return client_of(tmp_path)


def test_a_browser_gets_the_page_and_a_program_gets_links(client):
    page = client.get("/", headers=BROWSER)
    assert page.headers["content-type"].startswith("text/html")
    assert "<title>vibrafeed</title>" in page.text
    assert client.get("/").json()["title"] == "vibrafeed"
    assert client.get("/", headers={"Accept": "application/json"}).json()["links"]
    for path in ("/", "/docs"):  # scripts come of files of its own only
        reply = client.get(path, headers=BROWSER)
        assert "script-src 'self';" in reply.headers["content-security-policy"]
        assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\son[a-z]+=|\sstyle=", reply.text)


def test_a_wheel_with_a_bundle_sends_it_in_place_of_the_entry(tmp_path, monkeypatch):
    folder = tmp_path / "page"
    shutil.copytree(PAGE, folder)
    (folder / "bundle.js").write_text("// all modules")
    monkeypatch.setattr(page, "FILES", folder)
    monkeypatch.setattr(page, "BUNDLE", folder / "bundle.js")
    client = client_of(tmp_path / "data")
    assert client.get("/page/modules/main.js").text == "// all modules"
    assert "import" in client.get("/page/modules/answers.js").text


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
    for path in (PAGE / "modules").glob("*.js"):
        assert not re.search(MARKUP, path.read_text()), path
    files = [path for path in PAGE.rglob("*") if path.suffix in (".js", ".css", ".html", ".svg")]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < MOST


def test_each_colour_of_a_regime_has_its_mark():
    marks = (PAGE / "modules" / "markers.js").read_text()
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
    assert {colour_of(name) for name in INKS} == set(shapes)
    assert len({shapes[colour_of(name)] for name in motion}) == len(motion)


def test_figures_are_studies_that_the_service_takes(client):
    figures = client.get("/figures").json()
    assert [one["name"] for one in figures[:3]] == ["fig-3-3", "fig-3-15", "fig-5-1"]
    assert all(one["title"] and one["notes"] for one in figures)
    assert client.post("/sweeps", json=figures[-1]["study"]).status_code == 201
