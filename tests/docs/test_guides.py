"""The page on extending is carried out to the letter, in a copy of the tree."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from night import spread
from vibrafeed.core.kernel_cache import root

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
FILES = ROOT / "examples" / "extending"
HEADING = re.compile(
    r"^### The (?:file|line|test|example): \[?`([^`]+)`(?:\]\(\.\./examples/extending/\1\))?$",
    re.MULTILINE,
)
DIFF = re.compile(r"^```diff\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMON = """
import json
import vibrafeed
from fastapi.testclient import TestClient
from typer.testing import CliRunner
from vibrafeed.app.cli import app
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.catalogue import describe, describe_all
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, run_study
from vibrafeed.core.quantities import FLAGS, REGIMES
from vibrafeed.core.schema import study_schema

def said(*words):
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    return result.output

def refused(function, *given, **named):
    try:
        function(*given, **named)
    except vibrafeed.VibrafeedError as error:
        return str(error)
    raise AssertionError("it was not refused")
"""
SCENE = """
found = vibrafeed.sweep("ball-on-plane", outputs="acceleration_x", frequency=50,
                        amplitude="0.1 mm", beta=0)
exact = 5 / 7 * 9.869604401089358  # 5/7 of P cos(0) cos(0), P = 1e-4 (100 pi)^2
assert abs(float(found.acceleration_x) - exact) <= 1e-14 * exact
assert int(found.regime) == REGIMES["roll"].value
assert "41" in said("run", "configs/ball-on-plane.toml", "--dry-run")
assert "ball-on-plane" in said("scenes")
"""
# As its `Method` says: offered where it follows, priced, verified, refused; not the default.
METHOD = """
from vibrafeed.core.motion.midpoint import MIDPOINT
methods = {line["name"]: line["methods"] for line in describe_all()}
assert {name for name in methods if "midpoint" in methods[name]} == {
    "rectangle-on-plane", "cylinder-on-plane"}
given = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": given}
assert prepare_content(study).plan.variant == "events"
prepared = prepare_content({**study, "method": "midpoint", "verify": 2})
assert prepared.seconds_a_verified_cell > 0
assert prepared.verified_by == "the method " + MIDPOINT.checked_by[0]
given["alpha"] = 1
assert MIDPOINT.refuses[0].message in refused(prepare_content, {**study, "method": "midpoint"})
assert "method midpoint" in said("scenes", "rectangle-on-plane", "--method", "midpoint")
"""
# On the command line, in Python, over HTTP, and in the documentation.
KIND = """
from benchmarks.kinds_page import page
assert "mean" in said("--help").partition("Commands")[0]
said("new", "study.toml", "--kind", "mean")
assert "throw_number" in said("run", "study.toml")
assert "throw_number" in said("run", "study.toml", "--dry-run")
assert "mean" in said("convert", "study.toml", "--to", "json")
assert '"const": "mean"' in said("scenes", "--schema")
assert float(run_study(vibrafeed.study("study.toml", beta=0)).throw_number) == 0
service = create_app(Settings(data_directory="data"))
with TestClient(service, base_url="http://127.0.0.1") as client:
    known = [one["id"] for one in client.get("/processes").json()["processes"]]
    assert known == [*KINDS, "accuracy"] and "mean" in known
    schemas = client.get("/openapi.json").json()["components"]["schemas"]
    assert "MeanStudy" in schemas
    assert schemas["AnyStudy"]["discriminator"]["mapping"].keys() == {*KINDS}
    for place in ("/convert?to=toml", "/processes/mean/execution"):
        answer = client.post(place, json=KINDS["mean"].example)
        assert answer.status_code == 200, answer.text
assert "## mean" in page()
"""
# A flag, in two places: what it is, and what gives it.
OUTPUT = """
design = {"scene": "rectangle-on-plane", "frequency": 50, "beta": 20, "friction": 0.4}
asked = {**design, "amplitude": ["1 um", "0.2 mm", "0.6 mm"]}
found = vibrafeed.simulate(**asked, outputs=["gait"])
assert found.gait.values.tolist() == [0, 1, 2] and found.gait.dtype == "int8"
assert found.gait.attrs["flag_meanings"] == "rests slides hops unknown"
assert [*FLAGS["gait"]] == found.gait.attrs["flag_meanings"].split()
assert '"gait"' in json.dumps(study_schema())
with open("gait.toml", "w") as file:
    file.write("kind = 'simulate'\\nscene = 'rectangle-on-plane'\\noutputs = ['gait']\\n"
               "[parameters]\\nfrequency = 50\\nbeta = 20\\nfriction = 0.4\\n"
               "amplitude = ['1 um', '0.2 mm', '0.6 mm']")
assert "gait: rests 33" in said("run", "gait.toml")
derived = vibrafeed.simulate(
    **asked, sensitivities=["friction"], outputs=["gait", "conveying_velocity"])
assert [name for name in derived if name.endswith("_by_friction")] == [
    "derivative_conveying_velocity_by_friction"], [*derived]
best = {"kind": "maximise", "output": "gait"}
variables = {"friction": {"lower": 0.1, "upper": 0.4}}
told = refused(vibrafeed.optimise, **design | {"friction": None}, criterion=best,
               amplitude="0.2 mm", variables=variables)
assert "gait" in told, "a flag has no best value"
assert "gait" in said("scenes", "rectangle-on-plane", "--method", "events")
"""
PICTURE = """
dataset = vibrafeed.sweep(scene="rectangle-on-plane", outputs="acceleration_x",
    frequency=50, amplitude="0.1 mm", beta=range(0, 41), friction=0.3)
figure = vibrafeed.plot(dataset, kind="histogram")
assert sum(bar.get_height() for bar in figure.axes[0].patches) == 41
assert vibrafeed.plot(dataset).axes[0].patches != figure.axes[0].patches
assert "histogram" in refused(vibrafeed.plot, dataset, kind="histogramm")
assert "histogram" in said("plot", "--help")
"""
GUIDES: dict[str, tuple[str, list[str]]] = {
    "A scene": (SCENE, [
        "core/scenes/ball_on_plane.py", "core/scenes/__init__.py",
        "tests/fast/core/scenes/test_ball_on_plane.py", "configs/ball-on-plane.toml",
    ]),
    "A kind of study": (KIND, [
        "core/mean.py", "core/kinds/__init__.py",
        "tests/fast/core/test_mean.py",
    ]),
    "A picture": (PICTURE, ["core/plots/histogram.py", "core/plots/pictures.py"]),
    "A method of motion": (METHOD, [
        "core/motion/midpoint.py", "core/motion/systems.py",
        "tests/fast/core/motion/test_midpoint.py",
    ]),
    "An output": (OUTPUT, ["core/quantities/motion.py", "core/motion/feeding.py"]),
}  # fmt: skip


def carry_out(guide: str, tree: Path) -> list[str]:
    """Do in a tree what a section says: whole files that it links, and changes line by line.

    Returns the paths, in the page's order.
    """
    section = PAGE.partition(f"\n## {guide}\n")[2].partition("\n## ")[0]
    _, *parts = HEADING.split(section)
    for path, part in zip(parts[::2], parts[1::2], strict=True):
        file = tree / path
        if (FILES / path).exists():
            assert not file.exists(), path
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(FILES / path, file)
        else:
            (diff,) = DIFF.findall(part)
            file.write_text(changed(file.read_text(encoding="utf-8"), diff), encoding="utf-8")
    return parts[::2]


def changed(text: str, diff: str) -> str:
    """Return a text changed by a diff; the lines around each change have to be there, once."""
    for hunk in diff.split("@@\n"):
        lines = hunk.splitlines(keepends=True)
        before = "".join(line[1:] for line in lines if line[0] in " -")
        after = "".join(line[1:] for line in lines if line[0] in " +")
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    return text


def run(tree: Path, *arguments: str) -> str:
    """Return what a fresh Python says that imports from the tree; it has to succeed."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "COLUMNS": "200", "NO_COLOR": "1"}
    environment["NUMBA_CACHE_DIR"] = str(root())  # most kernels are the same
    done = subprocess.run(
        [sys.executable, *arguments], cwd=tree, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Return a copy of the program, without its tests."""
    for name in ("core", "app", "vibrafeed", "benchmarks"):
        shutil.copytree(ROOT / name, tmp_path / name, symlinks=True)  # and its bytecode
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_a_diff_is_applied_where_its_lines_stand():
    assert changed("a\nb\nc\n", " a\n+x\n b\n@@\n-c\n+d\n") == "a\nx\nb\nd\n"
    for text in ("b\n", "a\na\n"):
        with pytest.raises(AssertionError):
            changed(text, " a\n+x\n")


@pytest.mark.parametrize("guide", GUIDES)
def test_its_lines_stand_where_the_page_says(tree, guide):
    assert carry_out(guide, tree) == GUIDES[guide][1]


@pytest.mark.parametrize("guide", spread(GUIDES, 2))
def test_what_is_added_is_there(tree, guide):
    program, files = GUIDES[guide]
    carry_out(guide, tree)
    for test in (name for name in files if name.startswith("tests/")):
        assert " passed" in run(tree, "-m", "pytest", "-q", "-p", "no:cacheprovider", test)
    run(tree, "-c", COMMON + program)
