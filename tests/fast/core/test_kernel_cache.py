"""Compiled kernels follow the content of their files: each case runs in processes of its own."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from night import spread
from vibrafeed.core import kernel_cache
from vibrafeed.core.kernel_cache import COMPILERS, CORE, KEPT, NEUTRAL, imported, packages, sources
from vibrafeed.core.warm import STUDIES
from waiting import PATIENCE

ROOT = CORE.parent
FROZEN = ("quantities/flags.py",)
"""What kernels may import besides kernels; the values are frozen into the code."""
CALLEE = """
from vibrafeed.core.compiled import compiled

@compiled
def inner(x):
    return x + {added}
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
def outer(x):
    return x - FLAG
"""
ASK = """
import sys
from importlib import import_module
outer = import_module(sys.argv[1]).outer
found = outer(1.0)
print(found, sum(outer.stats.cache_hits.values()))
"""
NUMBAS_OWN = """
import numba
compiled = numba.njit(cache=True)
"""


def small_package(where: Path) -> Path:
    """Make a core with two packages of kernels; return the folder it lies in.

    One has a kernel that calls into another file, the other one that knows a flag.
    """
    core = where / "vibrafeed/core"
    kernels, others = core / "toy/kernels", core / "other/kernels"
    for folder in (kernels, others, core / "quantities"):
        folder.mkdir(parents=True)
        for inside in (folder, folder.parent):
            (inside / "__init__.py").touch()
    for folder in (core, core.parent):
        (folder / "__init__.py").touch()
    for name in (*COMPILERS, *NEUTRAL):
        shutil.copy(CORE / name, core / name)
    (core / "quantities/flags.py").write_text("FLAG = 1.0\n")
    (kernels / "callee.py").write_text(CALLEE.format(added="1.0"))
    (kernels / "caller.py").write_text(CALLER)
    (others / "lone.py").write_text(OTHER)
    return where


def start(
    package: Path, cache: Path | None, asked: str = "toy.kernels.caller", **environment: str
) -> subprocess.Popen[str]:
    """Start a process that says what a kernel gives, and how often its code was loaded."""
    variables = {name: value for name, value in os.environ.items() if name[:6] != "NUMBA_"}
    variables |= {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    if cache is not None:
        variables["NUMBA_CACHE_DIR"] = str(cache)
    return subprocess.Popen(
        [sys.executable, "-c", ASK, f"vibrafeed.core.{asked}"], cwd=package, env=variables,
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip


def said(process: subprocess.Popen[str]) -> tuple[float, int]:
    """Return what a process says in the end."""
    told, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    found, loaded = told.split()
    return float(found), int(loaded)


def ask(*arguments: Any, **environment: str) -> tuple[float, int]:
    """Return what the kernel gives in a new process, and how often its code was loaded."""
    return said(start(*arguments, **environment))


def edit_callee(package: Path) -> None:
    (package / "vibrafeed/core/toy/kernels/callee.py").write_text(CALLEE.format(added="5.0"))


def kernel_folders(cache: Path) -> list[Path]:
    return sorted(cache.glob("toy-*"))


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a package `a` and the cache in which its kernel is compiled."""
    folder = tmp_path_factory.mktemp("compiled")
    assert ask(small_package(folder / "a"), folder / "cache") == (4.0, 0)
    return folder


@pytest.fixture
def compiled_package(compiled_once: Path, tmp_path: Path) -> tuple[Path, Path]:
    """Return a package whose kernel is compiled, and its cache: a test may change both."""
    shutil.copytree(compiled_once, tmp_path / "compiled")
    return tmp_path / "compiled/a", tmp_path / "compiled/cache"


def test_an_edited_callee_is_seen_and_a_touch_is_not(compiled_package, tmp_path):
    package, cache = compiled_package
    for file in package.rglob("*.py"):
        os.utime(file, (1e9, 1e9))
    assert ask(package, cache) == (4.0, 1)
    clone = small_package(tmp_path / "b")
    assert ask(clone, cache) == (4.0, 1), "a clone elsewhere, with other dates"
    edit_callee(package)
    assert ask(package, cache) == (12.0, 0)
    assert ask(package, cache) == (12.0, 1)
    assert ask(clone, cache) == (4.0, 1)


@pytest.mark.night  # it hangs on numba's version only
def test_numbas_own_cache_keeps_the_old_callee(tmp_path):
    """The judge of the test above: if numba follows callees one day, our cache can go."""
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    (package / "vibrafeed/core/compiled.py").write_text(NUMBAS_OWN)
    assert ask(package, cache) == (4.0, 0)
    edit_callee(package)
    assert ask(package, cache) == (4.0, 1)


@pytest.mark.night
def test_other_packages_stay_compiled(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    assert ask(package, cache, "other.kernels.lone") == (0.0, 0)
    assert ask(package, cache) == (4.0, 0)
    edit_callee(package)
    assert ask(package, cache, "other.kernels.lone") == (0.0, 1)
    assert ask(package, cache) == (12.0, 0)


@pytest.mark.night
def test_a_flag_with_another_value_is_seen_where_it_is_known(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    ask(package, cache)
    assert ask(package, cache, "other.kernels.lone") == (0.0, 0)
    (package / "vibrafeed/core/quantities/flags.py").write_text("FLAG = 3.0\n")
    assert ask(package, cache, "other.kernels.lone") == (-2.0, 0)
    assert ask(package, cache) == (4.0, 1)


@pytest.mark.parametrize("name", spread(COMPILERS, 1))
def test_another_way_to_compile_opens_new_folders(compiled_package, name):
    package, cache = compiled_package
    with (package / "vibrafeed/core" / name).open("a") as file:
        file.write("NEW = 1\n")
    assert ask(package, cache) == (4.0, 0)


@pytest.mark.parametrize("name", spread(NEUTRAL, 1))
def test_how_code_is_kept_opens_none(compiled_package, name):
    package, cache = compiled_package
    with (package / "vibrafeed/core" / name).open("a") as file:
        file.write("NEW = 1\n")
    assert ask(package, cache) == (4.0, 1)


@pytest.mark.night
def test_several_processes_at_once_find_whole_code(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    running = [start(package, cache) for _ in range(4)]
    assert {said(process)[0] for process in running} == {4.0}
    assert ask(package, cache) == (4.0, 1)


@pytest.mark.night
@pytest.mark.parametrize(
    "setting", spread([{"NUMBA_CPU_NAME": "generic"}, {"NUMBA_BOUNDSCHECK": "1"}], 1)
)
def test_another_processor_or_setting_has_entries_of_its_own(tmp_path, setting):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    assert ask(package, cache) == (4.0, 0)
    assert ask(package, cache, **setting) == (4.0, 0)
    assert ask(package, cache, **setting) == (4.0, 1)
    assert ask(package, cache) == (4.0, 1)


def test_without_a_named_folder_the_cache_lies_with_the_user(tmp_path):
    package, home = small_package(tmp_path / "a"), tmp_path / "home"
    places = {"HOME": str(home), "XDG_CACHE_HOME": str(home / "caches")}
    assert ask(package, None, **places) == (4.0, 0)
    assert ask(package, None, **places) == (4.0, 1)
    assert list(home.rglob("toy-*/*.nbc"))
    assert not list(package.rglob("*.nbc"))


def test_it_runs_where_no_folder_can_be_made(tmp_path):
    package, file = small_package(tmp_path / "a"), tmp_path / "file"
    file.write_text("")
    assert ask(package, file / "cache") == (4.0, 0)
    assert ask(package, file / "cache") == (4.0, 0)


def test_folders_of_old_digests_go(tmp_path):
    package, cache = small_package(tmp_path / "a"), tmp_path / "cache"
    for number in range(KEPT + 3):
        old = cache / f"toy-{number:016x}"
        old.mkdir(parents=True)
        (old / "code.nbc").write_text("")
        os.utime(old, (1e9 + number, 1e9 + number))
    kept = cache / "toy-of-somebody-else"
    kept.mkdir()
    ask(package, cache)
    left = kernel_folders(cache)
    assert kept in left
    assert len(left) == KEPT + 2, "the last used, the new one, and the other's"
    assert not (cache / f"toy-{2:016x}").exists()
    assert (cache / f"toy-{3:016x}").exists()


def kernel_files() -> list[Path]:
    files = {file for name in packages() for file in sources(name) if "kernels" in file.parts}
    assert files == set(CORE.glob("*/kernels/**/*.py"))
    return sorted(files)


def test_of_ours_a_kernel_imports_kernels_and_constants():
    allowed = {*kernel_files(), CORE / "compiled.py", *(CORE / name for name in FROZEN)}
    for file in kernel_files():
        assert parsed_imports(file) <= allowed, file


def test_imports_are_found_as_the_parser_finds_them():
    files = [*kernel_files(), *(CORE / name for name in (*FROZEN, *COMPILERS))]
    for file in files:
        assert parsed_imports(file) == set(imported(file.read_text())), file


def test_the_digest_of_a_package_covers_all_that_it_imports():
    for name, folder in packages().items():
        covered = set(sources(name))
        assert set(folder.glob("*.py")) <= covered
        for file in covered - {CORE / one for one in COMPILERS}:
            assert parsed_imports(file) <= covered, f"{name}: {file}"


def test_a_package_does_not_hang_on_the_others():
    found = {
        name: {other for other, folder in packages().items() if folder / "__init__.py" in files}
        for name, files in ((name, sources(name)) for name in packages())
    }
    for name, others in found.items():
        assert others <= {name, "motion"}, name


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Return a copy of the program."""
    for name in ("core", "app", "vibrafeed"):
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, tmp_path / name, symlinks=True, ignore=ignore)
    return tmp_path


PLANAR = """
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.warm import STUDIES, carry_out
carry_out("motion-planar", slice(1))
print(stopwatch.spent)
"""


@pytest.mark.night
def test_after_an_edit_of_a_tumbling_kernel_a_planar_simulation_compiles_nothing(tree):
    """Nor does it in another clone."""
    from vibrafeed.core.plots.film import FIRST
    from vibrafeed.core.warm import carry_out

    carry_out("motion-planar", FIRST)
    environment = {
        **os.environ,
        "PYTHONPATH": str(tree),
        "NUMBA_CACHE_DIR": str(kernel_cache.root()),
    }
    file = tree / "core/motion/kernels/tumbling/supports.py"
    file.write_text(file.read_text().replace("import math", "import math  # edited", 1))
    done = subprocess.run(
        [sys.executable, "-c", PLANAR], capture_output=True, text=True, cwd=tree, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == 0


def test_every_package_of_kernels_is_compiled_beforehand():
    shared = {"motion"}
    assert set(STUDIES) == set(packages()) - shared


def test_after_warming_every_kernel_file_has_taken_part_and_no_study_waits_for_the_compiler():
    """Methods, drives and outputs of all kinds find what `vibrafeed.core.warm` has compiled."""
    code = """
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
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    modules, *seconds = done.stdout.splitlines()
    names = {
        ".".join(("vibrafeed", *file.relative_to(ROOT).with_suffix("").parts))
        for file in kernel_files()
    }
    assert {name.removesuffix(".__init__") for name in names} <= set(modules.split())
    waited, beyond = map(float, seconds)
    assert waited == 0, "something is not compiled beforehand"
    assert beyond > 0, "the stopwatch does not see what is compiled"


def test_every_function_of_a_kernel_file_is_compiled():
    found = 0
    for file in kernel_files():
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef):
                found += 1
                made = " ".join(map(ast.unparse, node.decorator_list))
                chosen = made.startswith(("by_type(", "_by_drive(")) or node.name == "_by_drive"
                assert chosen or made in ("compiled", "borrowing", "disjoint")
    assert found > 100


def parsed_imports(file: Path) -> set[Path]:
    """Return the files of ours that a file imports, as Python's own parser reads it."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        names = []
        if isinstance(node, ast.ImportFrom):
            names = [node.module or ".", *(f"{node.module}.{one.name}" for one in node.names)]
        elif isinstance(node, ast.Import):
            names = [one.name for one in node.names]
        for name in names:
            assert not name.startswith((".", "vibrafeed.app")), f"{file}: {name}"
            top, *below = name.split(".")
            path = CORE.parent.joinpath(*below)
            if top == "vibrafeed":
                found |= {path.with_suffix(".py"), path / "__init__.py"}
    return {path for path in found if path.is_file()}
