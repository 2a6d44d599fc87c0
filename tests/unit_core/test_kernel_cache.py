"""Compiled kernels follow the content of their files: each case runs in processes of its own."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from core import compiled

ROOT = compiled.CORE.parent
CALLEE = """
from core.compiled import compiled

@compiled
def inner(x):
    return x + {added}
"""
CALLER = """
from core.compiled import compiled
from core.toy.kernels.callee import inner

@compiled
def outer(x):
    return 2.0 * inner(x)
"""
ASK = """
from core.toy.kernels.caller import outer
found = outer(1.0)
print(found, sum(outer.stats.cache_hits.values()))
"""
NUMBAS_OWN = """
import numba
compiled = numba.njit(cache=True)
"""


def small_package(where: Path) -> Path:
    """Make a core with one kernel that calls into another file; return the folder it lies in."""
    core = Path(compiled.__file__).parent
    kernels = where / "core/toy/kernels"
    kernels.mkdir(parents=True)
    frozen = [where / "core" / name for name in compiled.FROZEN]
    for folder in {where / "core", where / "core/toy", kernels, *(file.parent for file in frozen)}:
        folder.mkdir(exist_ok=True)
        (folder / "__init__.py").write_text("")
    for file in (*frozen, where / "core/compiling.py"):
        shutil.copy(core / file.relative_to(where / "core"), file)
    (kernels / "callee.py").write_text(CALLEE.format(added="1.0"))
    (kernels / "caller.py").write_text(CALLER)
    return where


def ask(package: Path, cache: Path | None = None, **environment: str) -> tuple[float, int]:
    """Return what the kernel gives in a new process, and how often its code was loaded."""
    variables = {name: value for name, value in os.environ.items() if name[:6] != "NUMBA_"}
    variables |= {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    if cache is not None:
        variables["NUMBA_CACHE_DIR"] = str(cache)
    said = subprocess.run(
        [sys.executable, "-c", ASK], cwd=package, env=variables, check=True, timeout=120,
        stdout=subprocess.PIPE, text=True,
    ).stdout.split()  # fmt: skip
    return float(said[0]), int(said[1])


def edit_callee(package: Path) -> None:
    (package / "core/toy/kernels/callee.py").write_text(CALLEE.format(added="5.0"))


def kernel_folders(cache: Path) -> list[Path]:
    return sorted(cache.glob("kernels-*"))


def test_an_edited_callee_is_seen_and_a_touch_is_not(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    assert ask(package, cache) == (4.0, 0)
    assert ask(package, cache) == (4.0, 1)
    for file in package.rglob("*.py"):
        os.utime(file, (1e9, 1e9))
    assert ask(package, cache) == (4.0, 1)
    clone = small_package(tmp_path / "b")
    assert ask(clone, cache) == (4.0, 1), "a clone elsewhere, with other dates"
    edit_callee(package)
    assert ask(package, cache) == (12.0, 0)
    assert ask(package, cache) == (12.0, 1)
    assert ask(clone, cache) == (4.0, 1)


def test_numbas_own_cache_keeps_the_old_callee(tmp_path):
    """The judge of the test above: if numba follows callees one day, our cache can go."""
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    (package / "core/compiled.py").write_text(NUMBAS_OWN)
    assert ask(package, cache) == (4.0, 0)
    edit_callee(package)
    assert ask(package, cache) == (4.0, 1)


def test_a_flag_with_another_value_is_seen(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    ask(package, cache)
    with (package / "core/quantities/flags.py").open("a") as file:
        file.write("NEW = 1\n")
    assert ask(package, cache) == (4.0, 0)


@pytest.mark.parametrize("setting", [{"NUMBA_CPU_NAME": "generic"}, {"NUMBA_BOUNDSCHECK": "1"}])
def test_another_processor_or_setting_has_entries_of_its_own(tmp_path, setting):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    assert ask(package, cache) == (4.0, 0)
    assert ask(package, cache, **setting) == (4.0, 0)
    assert ask(package, cache, **setting) == (4.0, 1)
    assert ask(package, cache) == (4.0, 1)


def test_without_a_named_folder_the_cache_lies_beside_the_code(tmp_path):
    package = small_package(tmp_path / "a")
    assert ask(package) == (4.0, 0)
    assert ask(package) == (4.0, 1)
    assert kernel_folders(package / "core/__pycache__")


def test_it_runs_where_no_folder_can_be_made(tmp_path):
    package, file = small_package(tmp_path / "a"), tmp_path / "file"
    file.write_text("")
    assert ask(package, file / "cache") == (4.0, 0)
    assert ask(package, file / "cache") == (4.0, 0)


def test_folders_of_old_digests_go(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    for number in range(compiled.KEPT + 3):
        old = cache / f"kernels-{number:016x}"
        old.mkdir(parents=True)
        (old / "code.nbc").write_text("")
        os.utime(old, (1e9 + number, 1e9 + number))
    kept = cache / "kernels-of-somebody-else"
    kept.mkdir()
    ask(package, cache)
    left = kernel_folders(cache)
    assert kept in left
    assert len(left) == compiled.KEPT + 2, "the last used, the new one, and the other's"
    assert not (cache / f"kernels-{2:016x}").exists()
    assert (cache / f"kernels-{3:016x}").exists()


def test_the_digest_covers_all_that_kernels_import():
    """Of ours a kernel file imports kernels, and what the digest covers besides."""
    covered = set(compiled.sources())
    kernels = [file for file in covered if "kernels" in file.parts]
    assert len(kernels) > 4
    for file in kernels:
        for module in imported(file):
            path = compiled.CORE.parent / module.replace(".", "/")
            found = {path.with_suffix(".py"), path / "__init__.py"} & covered
            assert found, f"{file.name} imports {module}"


def test_every_kernel_file_takes_part_in_what_is_compiled_beforehand():
    code = (
        "import sys; from core.warm import GROUPS, carry_out; [carry_out(one) for one in GROUPS];"
        "print(*(m for m in sys.modules if '.kernels' in m))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    files = [file for file in compiled.sources() if "kernels" in file.parts]
    names = {".".join(file.relative_to(ROOT).with_suffix("").parts) for file in files}
    assert {name.removesuffix(".__init__") for name in names} <= set(done.stdout.split())


def test_after_warming_no_study_waits_for_the_compiler():
    """Methods, drives and outputs of all kinds find what `vibrafeed warm` has compiled."""
    code = """
from core.compiling import stopwatch
from core.intake import prepare_content
from core.kinds import tabulate
from core.warm import GROUPS, carry_out
[carry_out(group) for group in GROUPS]
spent = stopwatch.spent
sine = {"amplitude": "0.3 mm", "beta": 30}
wave = {"amplitude_along_1": "0.3 mm", "amplitude_along_2": "0.1 mm", "phase_along_2": 30,
        "amplitude_normal_1": "0.1 mm"}
tracks = {"rectangle-on-plane": {}, "cylinder-on-plane": {}, "rectangle-on-track": {"radius": 0.2}}
for scene, more in tracks.items():
    for method in ("events", "time-stepping"):
        for drive in (sine, wave):
            for rest in ({}, {"trajectory": 10}, {"outputs": ["efficiency", "hop_height"]}):
                parameters = {"frequency": 50, "friction": 0.3, **drive, **more}
                study = {"kind": "simulate", "scene": scene, "method": method, "most_periods": 20}
                tabulate(prepare_content(study | {"parameters": parameters} | rest))
print(stopwatch.spent - spent)
import numba
numba.njit(lambda: 1)()
print(stopwatch.spent - spent)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    waited, beyond = map(float, done.stdout.split())
    assert waited == 0, "something is not compiled beforehand"
    assert beyond > 0, "the stopwatch does not see what is compiled"


def test_every_function_of_a_kernel_file_is_compiled():
    found = 0
    for file in compiled.sources():
        if "kernels" in file.parts:
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.FunctionDef):
                    found += 1
                    made = " ".join(map(ast.unparse, node.decorator_list))
                    chosen = made.startswith(("by_type(", "_by_drive(")) or node.name == "_by_drive"
                    assert chosen or made in ("compiled", "borrowing", "disjoint")
    assert found > 100


def imported(file: Path) -> list[str]:
    """Return the modules of ours that a file imports."""
    nodes = list(ast.walk(ast.parse(file.read_text())))
    names = [node.module or "." for node in nodes if isinstance(node, ast.ImportFrom)]
    names += [a.name for node in nodes if isinstance(node, ast.Import) for a in node.names]
    return [name for name in names if re.match(r"(core|app|vibrafeed)\b|\.", name)]
