"""What commands load before they do anything; `benchmarks/start_up.py` measures the time."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from vibrafeed.app.cli import COMMANDS

ROOT = Path(__file__).parents[2]
HEAVY = {
    "dask", "distributed", "fastapi", "h5netcdf", "h5py", "matplotlib", "netCDF4", "numba", "numpy",
    "openpyxl", "pandas", "pint", "psutil", "pydantic", "rich", "scipy", "sqlalchemy", "tomlkit",
    "uvicorn", "xarray", "xlsxwriter", "zarr",
}  # fmt: skip
READING = {"numpy", "psutil", "pydantic", "scipy"}
"""What a study is read and planned with; of scipy the names alone are loaded."""
HELP = [[name, "--help"] for name in COMMANDS]
HELP += [["key", name, "--help"] for name in ("add", "list", "withdraw", "audit")]
LIGHT = [
    ["scenes"], ["scenes", "rectangle-on-track"], ["scenes", "--schema"],
    ["scenes", "rectangle-on-track", "--method", "reference"], ["run", "fig-5-1.toml", "--dry-run"],
]  # fmt: skip
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


@pytest.mark.parametrize(
    ("calls", "allowed"),
    [
        ([["--help"], *HELP], set()),
        (LIGHT, READING),
        ([["run", "fig-5-1.toml"]], READING | {"netCDF4"}),
        ([["run", "nut.toml"]], READING | {"netCDF4", "numba"}),
    ],
    ids=["help", "light", "closed forms", "motion"],
)
def test_commands_load_what_they_need(calls, allowed, tmp_path):
    for name in ("figures/fig-5-1", "nut"):
        study = ROOT / "configs" / f"{name}.toml"
        (tmp_path / study.name).write_bytes(study.read_bytes())
    done = subprocess.run(
        [sys.executable, "-c", CALLS.format(calls)],
        capture_output=True, text=True, encoding="utf-8", cwd=tmp_path, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "FORCE_COLOR": ""},
    )  # fmt: skip
    modules = set(done.stderr.splitlines()[-1].split())
    assert HEAVY & modules <= allowed
    if not allowed:
        assert {f"vibrafeed.app.cli.{name}" for name in COMMANDS} <= modules
        assert not any(name.startswith("vibrafeed.core.study") for name in modules)
