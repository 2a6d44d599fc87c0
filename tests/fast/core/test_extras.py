"""What is imported is declared, and what is missing is said how to install."""

import functools
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from vibrafeed.core import system
from vibrafeed.core.system import ROOT, installing

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
IMPORT = re.compile(
    r"^\s*(?:from (\w+)[\w.]* import|import (\w+)[\w.]*(?: as \w+)?$)", re.MULTILINE
)
OURS = {"vibrafeed"}
ASKED = {"matplotlib", "pillow", "pyarrow", "obstore", "distributed", "trimesh", "nptdms", "pyuff"}
"""What the base loads when it is asked for."""
OF_SERVICE = ("app/web/", "app/main", "app/logs", "app/settings", "app/spans", "app/mcp")
JOBS_OF_BASE = ("accuracy", "blocks", "errors", "manifest", "shares", "studies", "__init__")


def normal(name: str) -> str:
    return name.lower().replace("_", "-")


def names(requirements: list[str]) -> set[str]:
    return {normal(match[0]) for one in requirements if (match := re.match(r"[\w.-]+", one))}


DEPENDENCIES = names(PROJECT["dependencies"])
EXTRAS = {extra: names(found) for extra, found in PROJECT["optional-dependencies"].items()}


@functools.cache
def imported() -> dict[str, set[str]]:
    """Return the modules of others that the program imports, with the files that do."""
    found: dict[str, set[str]] = {}
    for file in (
        file for room in ("core", "app", "vibrafeed") for file in (ROOT / room).rglob("*.py")
    ):
        text = file.read_text()
        assert "vibrafeed[" not in text, "no index has it: the name would be found to be another's"
        modules = {name for both in IMPORT.findall(text) for name in both if name}
        for module in modules - OURS - set(sys.stdlib_module_names):
            found.setdefault(module, set()).add(str(file.relative_to(ROOT)))
    return found


def of_service(file: str) -> bool:
    """True for the files that only `vibrafeed serve`, `key` and `mcp` load."""
    is_job = file.startswith("app/jobs/") and Path(file).stem not in JOBS_OF_BASE
    return is_job or file.startswith(OF_SERVICE)


def test_what_is_imported_is_declared_and_by_the_base_what_the_base_imports():
    serving = set().union(*(EXTRAS[name] for name in ("serve", "traces", "postgres", "mcp")))
    others = set().union(*(EXTRAS[name] for name in EXTRAS.keys() - {"dev", "docs"}))
    distributions = packages_distributions()
    assert len(imported()) > 30
    for module, files in imported().items():
        packages = {normal(name) for name in distributions.get(module, [module])}
        assert packages & (DEPENDENCIES | others), f"{module} of {files} is declared nowhere"
        if not packages & (DEPENDENCIES | ASKED):
            assert all(map(of_service, files)), (module, files)
            assert packages & serving, module
    assert not DEPENDENCIES & {"distributed", "fastapi", "sqlalchemy", "cryptography", "orjson"}
    assert {"openpyxl", "xlsxwriter", "zarr", "dask"} <= DEPENDENCIES


def test_every_package_that_is_declared_has_its_version():
    pinned = names((ROOT / "constraints.txt").read_text().splitlines())
    assert DEPENDENCIES.union(*EXTRAS.values()) - OURS <= pinned


@pytest.mark.parametrize(
    ("prefix", "windows", "asked", "command"),
    [
        (".venv", False, ("pyarrow", "tables"),
         ".venv/bin/pip install --constraint constraints.txt -e '.[tables]'"),
        (".venv", False, ("openpyxl",),
         ".venv/bin/pip install --constraint constraints.txt -e ."),
        ("/elsewhere", False, ("openpyxl",), "pip install --constraint constraints.txt -e ."),
        (".venv", True, ("", "serve"),
         r".venv\Scripts\pip install --constraint constraints.txt -e .[serve]"),
    ],
)  # fmt: skip
def test_in_a_clone_the_clone_is_installed(monkeypatch, prefix, windows, asked, command):
    monkeypatch.setattr("sys.prefix", str(ROOT / prefix))
    monkeypatch.setattr(system, "WINDOWS", windows)
    assert installing(*asked) == command


def test_from_a_wheel_packages_are_named(monkeypatch, tmp_path):
    monkeypatch.setattr(system, "ROOT", tmp_path)
    assert installing("pyarrow", "tables") == "pip install pyarrow"
    assert installing("openpyxl") == "pip install openpyxl"
    declared = ["numpy", "uvicorn; extra == 'serve'", 'h11>=0.16; extra == "serve"', "mypy"]
    monkeypatch.setattr(system, "requires", lambda name: declared)
    assert installing(extra="serve") == "pip install uvicorn h11"
