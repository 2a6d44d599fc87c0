"""Results as Octave, R, LibreOffice and an older xarray read them, where these are installed."""

import csv
import shutil
import subprocess
import textwrap
from pathlib import Path

import pytest

from results import check_same, rows, table_of_motion, written
from tools import absent
from vibrafeed.core.dataset.files import Storage
from vibrafeed.core.dataset.formats import write_result
from waiting import PATIENCE

OLDER = Path(__file__).parents[2] / ".venv-older" / "bin" / "python"
"""An environment with xarray 2024.6 and zarr 2.18, which reads no Zarr of version 3."""


MOTION = table_of_motion()


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    return written(MOTION, tmp_path_factory.mktemp("programs"))


def said(*command: str) -> str:
    """Run a program, which has to be installed; return what it prints."""
    if shutil.which(command[0]) is None:  # few have all of them: not even CI must
        pytest.skip(f"{command[0]} is not installed")
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def test_octave_reads_mat(places):
    code = f"""
        r = load('{places[".mat"]}').result;
        printf('%.17g\\n', size(r.data.conveying_velocity), r.data.amplitude);
        printf('%.17g\\n', permute(r.data.conveying_velocity, [2 1]));
        printf('%d\\n', r.data.regime == r.flags.regime.hopping);
        printf('%s\\n', r.units.conveying_velocity, r.dimensions.conveying_velocity{{:}}, r.study);
    """
    found = said("octave-cli", "--no-gui", "--norc", "--quiet", "--eval", code).splitlines()
    amplitudes = MOTION.coordinates["amplitude"].values
    speeds = MOTION.variables["conveying_velocity"].values
    assert [float(word) for word in found[:22]] == [5, 3, *amplitudes, *speeds.ravel()]
    assert sum(map(int, found[22:37])) == rows(MOTION)["regime"].count("hopping") > 0
    assert found[37:40] == ["m s-1", "amplitude", "beta"]
    assert found[40] == MOTION.attributes["study"]


def test_r_reads_csv(places):
    code = f"""
        d <- read.csv('{places[".csv"]}', check.names = FALSE)
        cat(names(d), sep = '\\n')
        cat('\\n', sprintf('%.17g', d[['conveying_velocity [m s-1]']]), '\\n')
        cat(sprintf('%.17g', d[['amplitude [m]']]), '\\n')
        cat(d$regime, '\\n')
    """
    *names, speeds, amplitudes, regimes = said("Rscript", "--vanilla", "-e", code).splitlines()
    expected = rows(MOTION, with_units=True)
    assert [name for name in names if name] == list(expected)
    assert numbers(speeds) == expected["conveying_velocity [m s-1]"]
    assert numbers(amplitudes) == expected["amplitude [m]"]
    assert regimes.split() == expected["regime"]


def test_an_older_xarray_reads_netcdf_and_zarr_of_version_2(places, tmp_path):
    if not OLDER.exists():
        absent("an older xarray is not installed")
    group = tmp_path / "x.zarr"
    write_result(MOTION, str(group), history="", storage=Storage(zarr_version=2))
    code = f"""
        import xarray
        for place, engine in (({str(places[".nc"])!r}, "netcdf4"), ({str(group)!r}, "zarr")):
            found = xarray.open_dataset(place, engine=engine)
            assert found.regime.dtype == "int8"
            print(*found.conveying_velocity.values.ravel().tolist())
            print(found.conveying_velocity.units)
            print(found.attrs["study"])
    """
    lines = said(str(OLDER), "-c", textwrap.dedent(code)).splitlines()
    speeds = MOTION.variables["conveying_velocity"].values.ravel().tolist()
    for of_file in (lines[:3], lines[3:]):
        assert numbers(of_file[0]) == speeds
        assert of_file[1:] == ["m s-1", MOTION.attributes["study"]]


def test_libreoffice_reads_excel(places, tmp_path):
    # 44: commas; 34: quotes; 76: UTF-8; the two words: texts unquoted, numbers with all digits.
    form = "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,false"
    home = f"-env:UserInstallation=file://{tmp_path}/home"
    said(
        "soffice", home, "--headless", "--convert-to", form, "--outdir", str(tmp_path),
        str(places[".xlsx"]),
    )  # fmt: skip
    with (tmp_path / "result.csv").open(newline="") as file:
        heads, *cells = csv.reader(file)
    # It holds all digits and writes 15 of them.
    expected = {
        head: [x if isinstance(x, str) else float(f"{x:.15g}") for x in column]
        for head, column in rows(MOTION, with_units=True).items()
    }
    found = {
        head: list(column) if isinstance(expected[head][0], str) else [float(x) for x in column]
        for head, column in zip(heads, zip(*cells, strict=True), strict=True)
    }
    check_same(found, expected)
