"""Compiled kernels follow the content of their files: each case runs in processes of its own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from night import spread
from vibrafeed.core.kernel_cache import COMPILERS, CORE, NEUTRAL
from waiting import PATIENCE

CALLEE = """
from vibrafeed.core.compiled import compiled

@compiled
def inner(x):
    return x + 1.0
"""
CALLER = """
from vibrafeed.core.compiled import compiled
from vibrafeed.core.toy.kernels.callee import inner

@compiled
def outer(x):
    return 2.0 * inner(x)
"""
OTHER = """
from vibrafeed.core.compiled import compiled
from vibrafeed.core.quantities.flags import FLAG

@compiled
def lone(x):
    return x - FLAG
"""
ASK = """
from vibrafeed.core.toy.kernels.caller import outer
from vibrafeed.core.other.kernels.lone import lone
for kernel in (outer, lone):
    print(kernel(1.0), sum(kernel.stats.cache_hits.values()))
"""
FOLDERS = ("..", ".", "toy", "toy/kernels", "other", "other/kernels", "quantities")
FILES = {
    "toy/kernels/callee.py": CALLEE, "toy/kernels/caller.py": CALLER,
    "other/kernels/lone.py": OTHER, "quantities/flags.py": "FLAG = 1.0\n",
    **{f"{folder}/__init__.py": "" for folder in FOLDERS},
}  # fmt: skip
KEPT, MADE = (4.0, 1, 0.0, 1), (4.0, 0, 0.0, 0)
"""What both kernels give, each with 1 if its code was in the cache."""
CASES: dict[str, tuple[dict[str, str], dict[str, str], tuple[float, int, float, int]]] = {
    "a callee": ({"toy/kernels/callee.py": CALLEE.replace("1.0", "5.0")}, {}, (12.0, 0, 0.0, 1)),
    "dates": ({}, {}, KEPT),
    "a flag": ({"quantities/flags.py": "FLAG = 3.0\n"}, {}, (4.0, 1, -2.0, 0)),
    "a processor": ({}, {"NUMBA_CPU_NAME": "generic"}, MADE),
    "how code is compiled": ({COMPILERS[0]: (CORE / COMPILERS[0]).read_text() + "#"}, {}, MADE),
    "how code is kept": ({NEUTRAL[1]: (CORE / NEUTRAL[1]).read_text() + "#"}, {}, KEPT),
    "a setting": ({}, {"NUMBA_BOUNDSCHECK": "1"}, MADE),
}


def small_package(where: Path) -> Path:
    """Make a core with two packages of kernels; return the folder it lies in.

    One has a kernel that calls into another file, the other one that knows a flag.
    """
    core = where / "vibrafeed/core"
    for name in (*COMPILERS, *NEUTRAL):
        write(core / name, (CORE / name).read_text())
    for name, text in FILES.items():
        write(core / name, text)
    return where


def write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def start(package: Path, cache: Path | None, **environment: str) -> subprocess.Popen[str]:
    """Start a process that says what the kernels give, and how often their code was loaded."""
    variables = {name: value for name, value in os.environ.items() if name[:6] != "NUMBA_"}
    variables |= {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    if cache is not None:
        variables["NUMBA_CACHE_DIR"] = str(cache)
    return subprocess.Popen(
        [sys.executable, "-c", ASK], cwd=package, env=variables, stdout=subprocess.PIPE, text=True
    )


def said(process: subprocess.Popen[str]) -> tuple[float, ...]:
    told, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    return tuple(map(float, told.split()))


def ask(*arguments: Any, **environment: str) -> tuple[float, ...]:
    return said(start(*arguments, **environment))


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a package `a` and the cache in which its kernels are compiled."""
    folder = tmp_path_factory.mktemp("compiled")
    assert ask(small_package(folder / "a"), folder / "cache") == MADE
    return folder


@pytest.mark.parametrize("case", spread(CASES, 2))
def test_code_is_made_anew_where_and_only_where_it_must(compiled_once, tmp_path, case):
    edits, environment, found = CASES[case]
    shutil.copytree(compiled_once, tmp_path / "b")  # a clone elsewhere, with other dates
    package, cache = tmp_path / "b/a", tmp_path / "b/cache"
    for file in package.rglob("*.py"):
        os.utime(file, (1e9, 1e9))
    for name, text in edits.items():
        write(package / "vibrafeed/core" / name, text)
    assert ask(package, cache, **environment) == found
    assert ask(package, cache, **environment) == (found[0], 1, found[2], 1)
    assert ask(compiled_once / "a", cache) == KEPT  # side by side


def test_without_a_named_folder_the_cache_lies_with_the_user(tmp_path):
    package, home = small_package(tmp_path / "a"), tmp_path / "home"
    places = {"HOME": str(home), "XDG_CACHE_HOME": str(home / "caches")}
    # Several processes at once find whole code.
    running = [start(package, None, **places) for _ in range(2)]
    assert {said(process)[::2] for process in running} == {MADE[::2]}
    assert ask(package, None, **places) == KEPT
    assert list(home.rglob("toy-*/*.nbc"))
    assert not list(package.rglob("*.nbc"))
    (tmp_path / "file").write_text("")
    assert ask(package, tmp_path / "file" / "cache") == MADE  # where no folder can be made


WARMED = """
import sys
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.warm import STUDIES, carry_out
[carry_out(package) for package in STUDIES]
print(*(module for module in sys.modules if ".kernels" in module))
spent = stopwatch.spent
sine = {"amplitude": "0.3 mm", "beta": 30}
wave = {"amplitude_along_1": "0.3 mm", "amplitude_along_2": "0.1 mm", "phase_along_2": 30,
        "amplitude_normal_1": "0.1 mm"}
tracks = {"rectangle-on-plane": {}, "cylinder-on-plane": {}, "rectangle-on-track": {"radius": 0.2}}
for scene, more in tracks.items():
    for drive in (sine, wave):
        energy = {"outputs": ["friction_power"]}
        hops = {"outputs": ["efficiency", "hop_height"]}
        for rest in ({}, {"trajectory": 10}, hops, energy):
            parameters = {"frequency": 50, "friction": 0.3, **drive, **more}
            study = {"kind": "simulate", "scene": scene, "max_periods": 20}
            tabulate(prepare_content(study | {"parameters": parameters} | rest))
print(stopwatch.spent - spent)
import numba
numba.njit(lambda: 1)()
print(stopwatch.spent - spent)
"""


def test_after_warming_no_study_waits_for_the_compiler():
    """Methods, drives and outputs of all kinds find what `vibrafeed.core.warm` has compiled."""
    root = CORE.parent
    done = subprocess.run([sys.executable, "-c", WARMED], capture_output=True, text=True, cwd=root)
    assert done.returncode == 0, done.stderr
    modules, waited, beyond = done.stdout.splitlines()
    files = [file.relative_to(CORE).with_suffix("") for file in CORE.glob("*/kernels/**/*.py")]
    names = {".".join(("vibrafeed.core", *file.parts)).removesuffix(".__init__") for file in files}
    assert names <= set(modules.split()), "a kernel file has taken no part"
    assert float(waited) == 0, "something is not compiled beforehand"
    assert float(beyond) > 0, "the stopwatch does not see what is compiled"
