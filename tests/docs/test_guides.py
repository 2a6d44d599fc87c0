"""The guides are carried out to the letter: what a page shows is done in a copy of the tree."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from vibrafeed.core.kernel_cache import root

ROOT = Path(__file__).parents[2]
GUIDES = sorted((ROOT / "docs").glob("adding-a*.md"))
HEADING = re.compile(r"^## The (?:file|line|test|example): `([^`]+)`$", re.MULTILINE)
BLOCK = re.compile(r"^```(python|diff|toml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def carry_out(page: str, tree: Path) -> list[str]:
    """Do in a tree what a page shows: new files as they stand, and changes of files line by line.

    Returns the paths, in the page's order.
    """
    done = []
    _, *parts = HEADING.split(page)
    for path, part in zip(parts[::2], parts[1::2], strict=True):
        ((language, block),) = BLOCK.findall(part)
        file = tree / path
        if language != "diff":
            assert not file.exists(), path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block, encoding="utf-8")
        else:
            file.write_text(changed(file.read_text(encoding="utf-8"), block), encoding="utf-8")
        done.append(path)
    return done


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
    for name in ("core", "app", "vibrafeed"):
        shutil.copytree(ROOT / name, tmp_path / name, symlinks=True)  # and its bytecode
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_a_diff_is_applied_where_its_lines_stand() -> None:
    assert changed("a\nb\nc\n", " a\n+x\n b\n@@\n-c\n+d\n") == "a\nx\nb\nd\n"
    for text in ("b\n", "a\na\n"):
        with pytest.raises(AssertionError):
            changed(text, " a\n+x\n")


@pytest.mark.parametrize("page", GUIDES, ids=[page.stem for page in GUIDES])
def test_its_lines_stand_where_the_page_says(tree: Path, page: Path) -> None:
    assert carry_out(page.read_text(encoding="utf-8"), tree)


def test_adding_a_scene(tree: Path) -> None:
    page = (ROOT / "docs" / "adding-a-scene.md").read_text(encoding="utf-8")
    test = "tests/fast/core/scenes/test_ball_on_plane.py"
    assert carry_out(page, tree) == [
        "core/scenes/ball_on_plane.py", "core/scenes/__init__.py", test,
        "configs/ball-on-plane.toml",
    ]  # fmt: skip
    assert " passed" in run(tree, "-m", "pytest", "-q", "-p", "no:cacheprovider", test)
    # One process for the rest. 5/7 of P cos(0) cos(0), P = 1e-4 (100 pi)^2
    run(
        tree,
        "-c",
        "from vibrafeed.core.quantities import REGIMES\n"
        "from vibrafeed.core.intake import parse_study\n"
        "from vibrafeed.core.kinds import run_study\n"
        "found = run_study(parse_study({'kind': 'sweep', 'scene': 'ball-on-plane',\n"
        "    'outputs': ['acceleration_x'],\n"
        "    'parameters': {'frequency': 50, 'amplitude': '0.1 mm', 'beta': 0}}))\n"
        "exact = 5 / 7 * 9.869604401089358\n"
        "assert abs(float(found.acceleration_x) - exact) <= 1e-14 * exact\n"
        "assert int(found.regime) == REGIMES['roll'].value\n"
        "from typer.testing import CliRunner\n"
        "from vibrafeed.app.cli import app\n"
        "command = ['run', 'configs/ball-on-plane.toml', '--dry-run']\n"
        "assert '41' in CliRunner().invoke(app, command).output\n"
        "assert 'ball-on-plane' in CliRunner().invoke(app, ['scenes']).output\n",
    )


@pytest.mark.night
def test_adding_a_method(tree: Path) -> None:
    page = (ROOT / "docs" / "adding-a-method.md").read_text(encoding="utf-8")
    test = "tests/fast/core/motion/test_midpoint.py"
    assert carry_out(page, tree) == [
        "core/motion/midpoint.py", "core/motion/systems.py", test,
    ]  # fmt: skip
    assert " passed" in run(tree, "-m", "pytest", "-q", "-p", "no:cacheprovider", test)
    # As its `Method` says: offered where it follows, priced, verified, refused; not the default.
    run(
        tree,
        "-c",
        "from vibrafeed.core.catalogue import describe, describe_all\n"
        "from vibrafeed.core.errors import StudyError\n"
        "from vibrafeed.core.intake import prepare_content\n"
        "from vibrafeed.core.motion.midpoint import MIDPOINT\n"
        "methods = {line['name']: line['methods'] for line in describe_all()}\n"
        "assert {name for name in methods if 'midpoint' in methods[name]} == {\n"
        "    'rectangle-on-plane', 'cylinder-on-plane'}\n"
        "assert describe('rectangle-on-plane', method='midpoint')['method'] == 'midpoint'\n"
        "given = {'frequency': 50, 'amplitude': '0.2 mm', 'beta': 30, 'friction': 0.4}\n"
        "study = {'kind': 'simulate', 'scene': 'rectangle-on-plane', 'parameters': given}\n"
        "assert prepare_content(study).plan.variant == 'events'\n"
        "prepared = prepare_content({**study, 'method': 'midpoint', 'verify': 2})\n"
        "assert prepared.seconds_a_verified_cell > 0\n"
        "assert prepared.verified_by == 'the method ' + MIDPOINT.checked_by[0]\n"
        "given['alpha'] = 1\n"
        "try:\n"
        "    prepare_content({**study, 'method': 'midpoint'})\n"
        "except StudyError as refused:\n"
        "    assert refused.problems[0].message == MIDPOINT.refuses[0].message\n"
        "else:\n"
        "    raise AssertionError('alpha was not refused')\n",
    )
    said = run(tree, "-m", "vibrafeed", "scenes", "rectangle-on-plane", "--method", "midpoint")
    assert "method midpoint" in said


@pytest.mark.night
def test_adding_a_kind(tree: Path, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "adding-a-kind.md").read_text(encoding="utf-8")
    test = "tests/fast/core/test_mean.py"
    assert carry_out(page, tree) == [
        "core/mean/__init__.py", "core/mean/kind.py", "core/kinds/__init__.py", test,
    ]  # fmt: skip
    assert " passed" in run(tree, "-m", "pytest", "-q", "-p", "no:cacheprovider", test)
    # On the command line.
    file = str(tmp_path / "study.toml")
    run(
        tree,
        "-c",
        "from typer.testing import CliRunner\n"
        "from vibrafeed.app.cli import app\n"
        "def said(*words):\n"
        "    result = CliRunner().invoke(app, words)\n"
        "    assert result.exit_code == 0, result.output\n"
        "    return result.output\n"
        "assert 'mean' in said('--help').partition('Commands')[0]\n"
        f"said('new', {file!r}, '--kind', 'mean')\n"
        f"assert 'throw_number' in said('run', {file!r})\n"
        f"assert 'throw_number' in said('run', {file!r}, '--dry-run')\n"
        f"assert 'vibrafeed.mean(' in said('convert', {file!r}, '--to', 'python')\n"
        "assert '\"const\": \"mean\"' in said('schema')\n",
    )
    # In Python, over HTTP, and in the documentation.
    run(
        tree,
        "-c",
        "import vibrafeed\n"
        "assert float(vibrafeed.mean({!r}, beta=0).throw_number) == 0\n"
        "from fastapi.testclient import TestClient\n"
        "from vibrafeed.app.main import create_app\n"
        "from vibrafeed.app.settings import Settings\n"
        "from vibrafeed.core.kinds import KINDS\n"
        "service = create_app(Settings(data_directory={!r}))\n"
        "with TestClient(service, base_url='http://127.0.0.1') as client:\n"
        "    known = [one['id'] for one in client.get('/processes').json()['processes']]\n"
        "    assert known == [*KINDS, 'accuracy'] and 'mean' in known\n"
        "    document = client.get('/openapi.json').json()\n"
        "    schemas = document['components']['schemas']\n"
        "    assert 'MeanStudy' in schemas\n"
        "    assert schemas['AnyStudy']['discriminator']['mapping'].keys() == {{*KINDS}}\n"
        "    example = KINDS['mean'].example\n"
        "    said = client.post('/convert?to=toml', json=example)\n"
        "    assert said.status_code == 200, said.text\n"
        "    result = client.post('/processes/mean/execution', json=example)\n"
        "    assert result.status_code == 200, result.text\n".format(file, str(tmp_path / "data")),
    )
    shutil.copytree(ROOT / "benchmarks", tree / "benchmarks")
    said = run(tree, "-c", "from benchmarks.kinds_page import page; print(page())")
    assert "## mean" in said


@pytest.mark.night
def test_adding_an_output(tree: Path) -> None:
    """A flag, in two places: what it is, and what gives it."""
    page = (ROOT / "docs" / "adding-an-output.md").read_text(encoding="utf-8")
    assert carry_out(page, tree) == ["core/quantities/motion.py", "core/motion/feeding.py"]
    study = tree / "gait.toml"
    study.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\noutputs = ["gait"]\n[parameters]\n'
        'frequency = 50\namplitude = ["1 um", "0.2 mm", "0.6 mm"]\nbeta = 20\nfriction = 0.4\n'
    )
    said = run(tree, "-m", "vibrafeed", "run", str(study))
    assert re.search(r"gait: rests 33.*slides 33.*hops 33", said), said
    run(
        tree,
        "-c",
        "import vibrafeed\n"
        "from vibrafeed.core.catalogue import describe\n"
        "from vibrafeed.core.schema import study_schema\n"
        "from vibrafeed.core.errors import StudyError\n"
        "from vibrafeed.core.quantities import FLAGS\n"
        f"found = vibrafeed.simulate({str(study)!r})\n"
        "assert found.gait.values.tolist() == [0, 1, 2] and found.gait.dtype == 'int8'\n"
        "assert found.gait.attrs['flag_meanings'] == 'rests slides hops unknown'\n"
        "assert [*FLAGS['gait']] == found.gait.attrs['flag_meanings'].split()\n"
        "assert '\"gait\"' in __import__('json').dumps(study_schema())\n"
        "told = describe('rectangle-on-plane', method='events')['outputs']\n"
        "assert 'gait' in [output['name'] for output in told]\n"
        f"derived = vibrafeed.simulate({str(study)!r}, sensitivities=['friction'],\n"
        "    outputs=['gait', 'conveying_velocity'])\n"
        "assert [name for name in derived if name.endswith('_by_friction')] == [\n"
        "    'derivative_conveying_velocity_by_friction'], [*derived]\n"
        "try:\n"
        "    vibrafeed.optimise(scene='rectangle-on-plane',\n"
        "        criterion={'kind': 'maximise', 'output': 'gait'}, frequency=50,\n"
        "        amplitude='0.2 mm', friction=0.4,\n"
        "        variables={'beta': {'lower': 0, 'upper': 40}})\n"
        "except StudyError as refused:\n"
        "    assert 'gait' in str(refused), refused\n"
        "else:\n"
        "    raise AssertionError('a flag has no best value')\n",
    )
    assert "gait" in run(
        tree, "-m", "vibrafeed", "scenes", "rectangle-on-plane", "--method", "events"
    )


def test_adding_a_picture(tree: Path) -> None:
    page = (ROOT / "docs" / "adding-a-picture.md").read_text(encoding="utf-8")
    assert carry_out(page, tree) == ["core/plots/histogram.py", "core/plots/pictures.py"]
    run(
        tree,
        "-c",
        "import vibrafeed\n"
        "from vibrafeed.core.plots.pictures import PlotError\n"
        "dataset = vibrafeed.sweep(scene='rectangle-on-plane', outputs='acceleration_x',\n"
        "    frequency=50, amplitude='0.1 mm', beta=range(0, 41), friction=0.3)\n"
        "figure = vibrafeed.plot(dataset, kind='histogram')\n"
        "assert sum(bar.get_height() for bar in figure.axes[0].patches) == 41\n"
        "assert vibrafeed.plot(dataset).axes[0].patches != figure.axes[0].patches\n"
        "try:\n"
        "    vibrafeed.plot(dataset, kind='histogramm')\n"
        "except PlotError as error:\n"
        "    assert 'histogram' in str(error)\n",
    )
    assert "histogram" in run(tree, "-m", "vibrafeed", "plot", "--help")
