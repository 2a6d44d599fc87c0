"""What commands load before they do anything; `benchmarks/start_up.py` measures the time."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from vibrafeed.app.cli import COMMANDS

ROOT = Path(__file__).parents[4]
HEAVY = {
    "dask", "distributed", "fastapi", "h5netcdf", "h5py", "matplotlib", "netCDF4", "numba", "numpy",
    "openpyxl", "pandas", "pint", "psutil", "pydantic", "rich", "scipy", "sqlalchemy", "tomlkit",
    "xarray", "xlsxwriter", "zarr",
}  # fmt: skip
NEEDED = {"netCDF4", "numpy", "psutil", "pydantic", "scipy"}
"""What a study is read, computed and written with; of scipy the names alone are loaded."""

CALLS = """
import sys
from vibrafeed.app.cli import main
for words in {}:
    sys.argv = ["vibrafeed", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, (words, end.code)
print(*sys.modules, file=sys.stderr)
"""


def loaded(*calls: list[str], folder: Path) -> set[str]:
    """Return the names of all modules after some calls of the command line in one process."""
    done = subprocess.run(
        [sys.executable, "-c", CALLS.format(list(calls))],
        capture_output=True, text=True, encoding="utf-8", cwd=folder, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "FORCE_COLOR": ""},
    )  # fmt: skip
    return set(done.stderr.splitlines()[-1].split())


def test_help_of_every_command_loads_nothing_that_computes_or_draws(tmp_path):
    keys = ("add", "list", "withdraw", "audit")
    calls = [["--help"], *([name, "--help"] for name in COMMANDS)]
    calls += [["key", name, "--help"] for name in keys]
    modules = loaded(*calls, folder=tmp_path)
    assert HEAVY & modules == set()
    assert {f"vibrafeed.app.cli.{name}" for name in COMMANDS} <= modules
    rooms = {name.split(".")[2] for name in modules if name.startswith("vibrafeed.core.")}
    assert rooms.isdisjoint({"mechanics", "scenes", "study", "intake", "quantities"})


@pytest.mark.parametrize("study", ["figures/fig-5-1", "nut"])
def test_a_run_loads_what_it_needs(study, tmp_path):
    """A study of closed forms, and one that is simulated."""
    text = (ROOT / "configs" / f"{study}.toml").read_text(encoding="utf-8")
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    modules = loaded(["run", "study.toml"], folder=tmp_path)
    assert HEAVY & modules <= NEEDED | {"numba"}
    models = {name for name in modules if name.startswith("vibrafeed.core.study.")}
    assert not any(name.endswith(("optimise_study", "calibrate_study")) for name in models)
