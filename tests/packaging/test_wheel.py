"""The wheel holds the files of the repository byte for byte, under one name, beside any other."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import vibrafeed
from tools import tool
from waiting import PATIENCE

ROOT = Path(__file__).parents[2]
FOLDERS = ("core", "app", "configs", "vibrafeed")
BUNDLE = "vibrafeed/app/page/bundle.js"
BUILD = [sys.executable, "-m", "hatchling", "build", "--target"]
POINT = {
    "scene": "rectangle-on-plane", "frequency": "50 Hz", "amplitude": "0.25 mm", "beta": 30,
    "friction": 0.5,
}  # fmt: skip
PROGRAM = f"""
import pickle, sys
import vibrafeed, app, core
from multiprocessing import get_context
from concurrent.futures import ProcessPoolExecutor

if __name__ == "__main__":
    study = vibrafeed.study(kind="simulate", method="reference", **{POINT})
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        print(pool.submit(vibrafeed.simulate, study).result().conveying_velocity.item())
    print(app.OWNER, core.OWNER, vibrafeed.core.__file__)
    print(pickle.loads(pickle.dumps(study)) == study)
"""


def tracked() -> dict[str, bytes]:
    """Return the committed files of the program by their names in the wheel."""
    listed = subprocess.run(
        [tool("git"), "ls-files", *FOLDERS], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    files = [name for name in listed if not (ROOT / name).is_symlink()]
    named = {f"vibrafeed/{name.removeprefix('vibrafeed/')}": name for name in files}
    return {name: (ROOT / file).read_bytes() for name, file in named.items()}


def contents(wheel: Path) -> dict[str, bytes]:
    """Return the files of a wheel by name, but what describes it."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if ".dist-info/" not in name]
        return {name: archive.read(name) for name in names}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a wheel, made from the source distribution."""
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run([*BUILD, "sdist", "--directory", folder], cwd=ROOT, check=True)
    (archive,) = folder.glob("*.tar.gz")
    shutil.unpack_archive(archive, folder, filter="data")
    (source,) = (path for path in folder.iterdir() if path.is_dir())
    subprocess.run([*BUILD, "wheel", "--directory", folder], cwd=source, check=True)
    (made,) = folder.glob("*.whl")
    return made


@pytest.fixture(scope="module", params=["wheel", "editable"])
def python(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the Python of an environment of its own that borrows the dependencies of this one."""
    folder = tmp_path_factory.mktemp(request.param)
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    borrowed = [place for place in sys.path if place.endswith("site-packages")]
    (packages / "borrowed.pth").write_text("\n".join(borrowed))
    wanted = ["--editable", ROOT] if request.param == "editable" else []
    subprocess.run(
        [sys.executable, "-m", "pip", "--quiet", "--python", folder / "bin" / "python", "install",
         "--no-deps", "--no-index", "--no-build-isolation",
         *(wanted or [request.getfixturevalue("wheel")])],
        check=True,
    )  # fmt: skip
    return folder / "bin" / "python"


def test_its_files_are_those_of_the_repository(wheel):
    files, found = tracked(), contents(wheel)
    assert len(files) > 400
    found.pop(BUNDLE, None)  # where esbuild is installed
    assert found == files


def test_a_checkout_without_links_builds_the_same_wheel(wheel, tmp_path):
    """Git on Windows writes a small text file in the place of a link."""
    for name in (*FOLDERS, "scripts", "pyproject.toml", "README.md", "LICENSE"):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tmp_path / name, symlinks=True)
        else:
            shutil.copy(ROOT / name, tmp_path)
    for name in ("core", "app"):
        (tmp_path / "vibrafeed" / name).unlink()
        (tmp_path / "vibrafeed" / name).write_text(f"../{name}")
    subprocess.run([*BUILD, "wheel", "--directory", tmp_path / "dist"], cwd=tmp_path, check=True)
    (made,) = (tmp_path / "dist").glob("*.whl")
    assert contents(made) == contents(wheel)


def test_it_works_beside_a_core_and_an_app_of_the_user(python, tmp_path):
    for name in ("core", "app"):
        (tmp_path / f"{name}.py").write_text("OWNER = 'the user'\n")
    (tmp_path / "program.py").write_text(PROGRAM)
    variables = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [python, "program.py"], cwd=tmp_path, env=variables, capture_output=True, text=True,
        timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    speed, owners, same = done.stdout.splitlines()
    expected = vibrafeed.simulate(POINT, method="reference").conveying_velocity.item()
    assert float(speed) == pytest.approx(expected)
    assert owners.startswith("the user the user")
    assert Path(owners.split()[-1]).parts[-3:] == ("vibrafeed", "core", "__init__.py")
    assert same == "True"
    for command in ([python, "-m", "vibrafeed"], [python.with_name("vibrafeed")]):
        done = subprocess.run(
            [*command, "--help"], cwd=tmp_path, capture_output=True, text=True, check=True
        )
        assert "Usage: vibrafeed" in done.stdout
