"""Library and command line where POSIX is missing: on Linux, behind a harness of our own.

No Windows and no Mac was at hand. The harness, and what it cannot imitate, is in `portable.py`.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from portable import MACOS, WINDOWS, lacking

ROOT = Path(__file__).parents[2]
SERVICE = "app/jobs/runner.py"  # needs `fcntl`
USE = re.compile(r"(?:\bfrom |\b)(\w+)(?: import |\.)(\w+)")


@pytest.mark.parametrize("system", [WINDOWS, MACOS])
def test_only_the_service_needs_what_another_system_lacks(system):
    names = lacking(system)
    assert "fdatasync" in names["os"]  # a look at the stubs: they name what is known
    assert ("flock" in names["fcntl"]) == (system == WINDOWS)
    found = set()
    for folder in ("app/**", "core/**", "vibrafeed"):
        for file in ROOT.glob(f"{folder}/*.py"):
            text, place = file.read_text(), file.relative_to(ROOT)
            found |= {
                f"{place}: {module}.{name}"
                for module, name in USE.findall(text)
                if name in names.get(module, ()) and f'hasattr({module}, "{name}")' not in text
            }
    assert {use for use in found if not use.startswith(f"{SERVICE}: fcntl.")} == set()
    assert bool(found) == (system == WINDOWS)


def run(program: str, folder: Path, root: Path = ROOT / "vibrafeed", **more: str) -> set[str]:
    """Run a program in a folder on Windows; return what was refused.

    `more` are variables of its environment.
    """
    harness = folder / "harness"
    harness.mkdir()
    told = (f"{root}/", str(harness / "log"))
    (harness / "sitecustomize.py").write_text(f"import portable\nportable.install(*{told!r})\n")
    (folder / "sweep.toml").write_text(SWEEP)
    path = os.pathsep.join(map(str, (harness, ROOT / "tests" / "helpers", ROOT)))
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path, **more},
        cwd=folder,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    log = harness / "log"
    return set(log.read_text().splitlines()) if log.exists() else set()


REFUSED = """
import os
import pathlib

path = pathlib.Path("folder/file")
path.parent.mkdir()
held = path.open("w")
read = path.open()
OURS = f"{os.getcwd()}/ours.py"
for statement in (
    "os.open('.', os.O_RDONLY)",
    "path.unlink()",
    "path.rename('other')",
    "pathlib.Path('sweep.toml').replace(path)",
    "pathlib.Path('sweep.toml').rename('harness/sitecustomize.py')",
    "pathlib.Path('sweep.toml').replace('harness')",
    "pathlib.Path('a:b').touch()",
    "pathlib.Path('nul.txt').mkdir()",
    "os.fsync(read.fileno())",
    "import shutil; shutil.rmtree('folder')",
    "path.parent.rename('other')",
):
    try:
        exec(compile(statement, OURS, "exec"))
    except (ImportError, AttributeError, OSError, ValueError):
        continue
    raise AssertionError(f"{statement} was let through")
exec(compile("os.open('sweep.toml', os.O_RDONLY)", OURS, "exec"))
"""


def test_the_harness_refuses_what_windows_refuses(tmp_path):
    assert run(REFUSED, tmp_path, tmp_path) == {
        "fsync of a file open for reading", "open of a folder", "os.open without O_BINARY",
        "removal of an open file", "rename of an open file", "rename to a folder",
        "rename to what exists", "the name 'a:b'", "the name 'nul.txt'",
    }  # fmt: skip


SWEEP = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["throw_number"]

[parameters]
frequency = "50 Hz"
amplitude = { start = "0.1 mm", stop = "0.5 mm", num = 41 }
beta = { start = "5 deg", stop = "60 deg", num = 56 }
"""

LIBRARY = """
import vibrafeed

drive = {"scene": "rectangle-on-plane", "frequency": "50 Hz", "beta": "30 deg"}
strokes = {"amplitude": ["0.1 mm", "0.2 mm", "0.3 mm"]}
speed = {**drive, "friction": 0.3, "outputs": ["conveying_velocity"]}
assert vibrafeed.sweep(**drive, **strokes, outputs=["throw_number"]).sizes["amplitude"] == 3
means = {"over": ["amplitude"], "statistics": ["mean"]}
mean = vibrafeed.sweep(**drive, **strokes, outputs=["throw_number"], reduce=means)
assert mean.throw_number_mean.shape == ()
assert vibrafeed.simulate(**speed, amplitude="0.3 mm").conveying_velocity > 0
best = vibrafeed.optimise(
    scene="rectangle-on-track",
    criterion={"kind": "maximise", "output": "acceleration_x"},
    variables={"delta": {"lower": "0 deg", "upper": "30 deg"}},
    frequency="50 Hz", beta="30 deg", amplitude="0.3 mm", friction=0.3,
)
known = vibrafeed.calibrate(
    scene="rectangle-on-plane",
    parameters={"frequency": "50 Hz", "beta": "30 deg"},
    observations=[{**strokes, "regime": ["does not hop", "hops", "hops"]}],
    unknowns={"friction": {"lower": 0.05, "upper": 0.8}},
)
assert vibrafeed.load_study("sweep.toml")
"""

COMMAND = """
import sys
from pathlib import Path

from vibrafeed.app import cli


def vibrafeed(command, code=0):
    sys.argv = ["vibrafeed", *command.split()]
    try:
        cli.main()
    except SystemExit as end:
        assert end.code == code, f"{command}: {end.code}"
"""

COMMANDS = (
    COMMAND
    + """
from vibrafeed.core.dataset.formats import FORMATS

vibrafeed("new study.toml --yes")
vibrafeed("run study.toml --dry-run")
vibrafeed("run sweep.toml -o sweep.nc")
vibrafeed("run sweep.toml -o sweep.nc --force")
vibrafeed("run study.toml sweep.toml -o results --quiet")
for suffix in FORMATS:
    vibrafeed(f"export sweep.nc -o as{suffix}")
vibrafeed("export as.zarr -o back.csv")
vibrafeed("export back.csv -o no.csv", code=2)
for form in ("toml", "json", "curl", "python"):
    vibrafeed(f"convert sweep.toml --to {form} -o converted.{form}")
vibrafeed("plot sweep.nc")
vibrafeed("sheet sweep.nc")
vibrafeed("scenes rectangle-on-plane")
vibrafeed("materials")
vibrafeed("materials --leaves")
sys.stdin = open("sweep.toml", encoding="utf-8")
vibrafeed("run - -o -.csv")
"""
)

LARGE = (
    COMMAND
    + """
import numpy as np
import xarray

from vibrafeed.app.cli import running
from vibrafeed.core.lazy import store

vibrafeed("run sweep.toml -o sweep.nc")
store.STORED_CELLS, running.LARGE_BYTES = 500, 1
vibrafeed("run sweep.toml -o large.nc")
plain = store.ZarrStore.write


def stopped(self, index, watch):
    if index == 2:
        raise KeyboardInterrupt
    return plain(self, index, watch)


store.ZarrStore.write = stopped
vibrafeed("run sweep.toml -o resumed.zarr", code=1)
store.ZarrStore.write = plain
vibrafeed("run sweep.toml -o resumed.zarr --resume")
wanted = xarray.load_dataset("sweep.nc").throw_number
assert wanted.size == 41 * 56
for found in (xarray.load_dataset("large.nc"), xarray.open_zarr("resumed.zarr")):
    np.testing.assert_array_equal(found.throw_number, wanted)
assert not list(Path().glob(".*"))
"""
)

HELD = (
    LARGE
    + """
import contextlib
import io

from vibrafeed.core import system

system.PATIENCE = 0.2
running.LARGE_BYTES = 1 << 28
for name in ("a.xlsx", "a.nc"):
    vibrafeed(f"run sweep.toml -o {name}")
    before = Path(name).read_bytes()
    words = io.StringIO()
    with open(name), contextlib.redirect_stderr(words):
        vibrafeed(f"run sweep.toml -o {name} --force", code=1)
    assert Path(name).read_bytes() == before
    assert words.getvalue().startswith(f"{name} cannot be written: Permission denied."), words
    assert words.getvalue().count("\\n") == 1
    assert words.getvalue().endswith("Close it in Excel.\\n") == (name == "a.xlsx")
    vibrafeed(f"run sweep.toml -o {name} --force")
assert not list(Path().glob(".*"))
"""
)


@pytest.mark.parametrize("program", [LIBRARY, COMMANDS], ids=["library", "commands"])
def test_windows_refuses_nothing_of(program, tmp_path):
    assert run(program, tmp_path, PYTHONIOENCODING="cp932") == set()


def test_windows_refuses_nothing_of_a_large_file_and_keeps_what_excel_holds(tmp_path):
    assert run(HELD, tmp_path) == {"rename of an open file"}
