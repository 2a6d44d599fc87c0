"""What is imported is declared, and what is missing is said how to install."""

from __future__ import annotations

import ast
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
OURS = {"vibrafeed"}


def normal(name: str) -> str:
    return name.lower().replace("_", "-")


def names(requirements: list[str]) -> set[str]:
    return {normal(match[0]) for one in requirements if (match := re.match(r"[\w.-]+", one))}


def of_service(file: str) -> bool:
    """True for the files that only `vibrafeed serve`, `key` and `mcp` load."""
    base = ["accuracy", "blocks", "errors", "manifest", "shares", "studies"]
    if file.startswith("app/jobs/"):
        return Path(file).stem not in base
    return file.startswith(
        ("app/web/", "app/main", "app/logs", "app/settings", "app/spans", "app/mcp")
    )


DEPENDENCIES = names(PROJECT["dependencies"])
EXTRAS = {extra: names(found) for extra, found in PROJECT["optional-dependencies"].items()}


@functools.cache
def sources() -> dict[Path, str]:
    """Return the text of each file of the program."""
    rooms = [ROOT / name for name in ("core", "app", "vibrafeed")]
    return {file: file.read_text() for room in rooms for file in room.rglob("*.py")}


def imported() -> dict[str, set[str]]:
    """Return the modules of others that the program imports, with the files that do."""
    found: dict[str, set[str]] = {}
    for file, text in sources().items():
        for node in ast.walk(ast.parse(text)):
            modules = []
            if isinstance(node, ast.Import):
                modules = [one.name for one in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                modules = [str(node.module)]
            for top in {module.split(".")[0] for module in modules} - OURS:
                if top not in sys.stdlib_module_names:
                    found.setdefault(top, set()).add(str(file.relative_to(ROOT)))
    return found


def test_every_package_that_is_imported_is_declared():
    declared = DEPENDENCIES.union(*(EXTRAS[name] for name in EXTRAS.keys() - {"dev", "docs"}))
    found = imported()
    assert len(found) > 30
    distributions = packages_distributions()
    for module, files in found.items():
        packages = {normal(name) for name in distributions.get(module, [module])}
        assert packages & declared, f"{module} of {sorted(files)} is declared nowhere"


def test_who_only_computes_needs_no_package_of_the_service():
    """What a module of the base imports, the base declares, but for what it loads when asked."""
    asked = {"matplotlib", "pillow", "pyarrow", "obstore"}
    asked |= {"distributed"}  # of `vibrafeed run --scheduler`
    distributions = packages_distributions()
    for module, files in imported().items():
        packages = {normal(name) for name in distributions.get(module, [module])}
        if not packages & (DEPENDENCIES | asked):
            assert all(map(of_service, files)), (module, files)
            extras = [EXTRAS[name] for name in ("serve", "traces", "postgres", "mcp")]
            assert packages & set().union(*extras), module
    assert not DEPENDENCIES & {"distributed", "fastapi", "sqlalchemy", "cryptography", "orjson"}
    assert {"vibrafeed"} <= EXTRAS["dev"]  # whose tests need the service


def test_every_package_that_is_declared_has_its_version():
    pinned = names((ROOT / "constraints.txt").read_text().splitlines())
    for declared in (DEPENDENCIES, *EXTRAS.values()):
        assert declared - OURS <= pinned


def test_workbooks_and_zarr_come_with_the_program():
    assert {"openpyxl", "xlsxwriter", "zarr", "dask"} <= DEPENDENCIES
    assert EXTRAS["tables"] == {"pyarrow"}


def test_in_a_clone_the_clone_is_installed(monkeypatch):
    monkeypatch.setattr("sys.prefix", str(ROOT / ".venv"))
    plain = ".venv/bin/pip install --constraint constraints.txt -e "
    assert installing("pyarrow", "tables") == f"{plain}'.[tables]'"
    assert installing("openpyxl") == f"{plain}."
    monkeypatch.setattr("sys.prefix", "/elsewhere")
    assert installing("openpyxl") == "pip install --constraint constraints.txt -e ."


def test_on_windows_pip_lies_elsewhere_and_quotes_are_no_quotes(monkeypatch):
    monkeypatch.setattr("sys.prefix", str(ROOT / ".venv"))
    monkeypatch.setattr(system, "WINDOWS", True)
    assert (
        installing(extra="serve")
        == r".venv\Scripts\pip install --constraint constraints.txt -e .[serve]"
    )


def test_from_a_wheel_all_packages_of_an_extra_are_named(monkeypatch, tmp_path):
    monkeypatch.setattr(system, "ROOT", tmp_path)
    declared = [
        "numpy",
        "uvicorn; extra == 'serve'",
        'h11>=0.16; extra == "serve"',
        "mypy; extra == 'dev'",
    ]
    monkeypatch.setattr(system, "requires", lambda name: declared)
    assert installing(extra="serve") == "pip install uvicorn h11"


def test_from_a_wheel_the_package_itself_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(system, "ROOT", tmp_path)
    assert installing("pyarrow", "tables") == "pip install pyarrow"
    assert installing("openpyxl") == "pip install openpyxl"


@pytest.mark.parametrize("extra", sorted(EXTRAS))
def test_no_message_takes_vibrafeed_from_an_index(extra):
    """None has it: the name would be looked for in vain, or found to be another's."""
    for file, text in sources().items():
        assert f"vibrafeed[{extra}]" not in text, file
