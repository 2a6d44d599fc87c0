"""The file of every study, written by the command line, in the hands of readers that are not ours.

Readers run in processes of their own: importing netCDF4 tells a process, and its children, where
compression plugins are, so that a reader started there opens what the user's reader does not.
"""

import json
import os
import subprocess
import sysconfig
from pathlib import Path

import pytest

from night import NIGHT
from tools import tool
from waiting import PATIENCE

ROOT = Path(__file__).parents[2]
# Calibrations have no regime; their files are written by the same hand.
STUDIES = sorted(
    path for path in (ROOT / "configs").rglob("*.toml") if not path.stem.startswith("calibrate-")
)
if not NIGHT:  # by day every tenth
    STUDIES = [path for n, path in enumerate(STUDIES) if n % 10 == 0]
NAMES = sorted(study.stem for study in STUDIES)
REDUCED = {study.stem for study in STUDIES if "\n[reduce]\n" in study.read_text()}
"""Studies whose file holds answers in place of cells, and no regime of each."""
CHECKER = "VIBRAFEED_COMPLIANCE_CHECKER"


def fresh_environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != "HDF5_PLUGIN_PATH"}


def run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        timeout=PATIENCE,  # all studies in one process, on a machine that does other things too
        env=fresh_environment(),
        check=False,
    )


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the file of each study, all written by one run of the command line."""
    vibrafeed = Path(sysconfig.get_path("scripts")) / "vibrafeed"
    folder = tmp_path_factory.mktemp("files")
    done = run(vibrafeed, "run", *STUDIES, "-o", folder)
    assert done.returncode == 0, done.stdout + done.stderr
    written = {path.stem: path for path in folder.iterdir()}
    assert sorted(written) == NAMES
    return written


@pytest.fixture(scope="module")
def ncdump() -> str:
    return tool("ncdump")


@pytest.fixture(scope="module")
def compliance_checker() -> str:
    """Return the checker, which needs an environment of its own."""
    default = ROOT / ".venv-cf" / "bin" / "compliance-checker"
    wanted = os.environ.get(CHECKER) or str(default)
    return tool(wanted, CHECKER)


@pytest.fixture(scope="module")
def complaints(
    compliance_checker: str, files: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, list[str]]:
    command = [compliance_checker, "--test=cf:1.11", "--criteria=strict", "-f", "json_new", "-o"]
    report = tmp_path_factory.mktemp("cf") / "report.json"
    done = run(*command, report, *files.values())
    assert report.exists(), done.stdout + done.stderr
    found = json.loads(report.read_text(encoding="utf-8"))
    return {
        Path(path).stem: [
            f"{check['name']}: {message}"
            for check in result["cf:1.11"]["all_priorities"]
            for message in check["msgs"]
        ]
        for path, result in found.items()
    }


@pytest.mark.parametrize("name", NAMES)
def test_ncdump_reads_the_file_and_its_compressed_data(
    name: str, ncdump: str, files: dict[str, Path]
) -> None:
    # The header alone opens even where the compression is unknown.
    variable = "transport_velocity_count" if name in REDUCED else "regime"
    data = run(ncdump, "-v", variable, files[name])
    assert data.returncode == 0, data.stderr
    header, _, values = data.stdout.partition("data:")
    assert f"netcdf {name} {{" in header
    assert ':Conventions = "CF-1.11"' in header
    assert ("byte regime" in header) == (name not in REDUCED)
    assert "_FillValue" not in header
    assert str(ROOT) not in header
    assert f" {variable} =" in values


@pytest.mark.parametrize("name", NAMES)
def test_cf_1_11_has_no_complaint(name: str, complaints: dict[str, list[str]]) -> None:
    assert complaints[name] == []
