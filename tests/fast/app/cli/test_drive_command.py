"""`vibrafeed drive`, as a user runs it, and studies with a recording from file to dataset."""

import tomllib
from pathlib import Path

import pytest
import xarray

from commands import run, saved, tells
from recordings import csv_of, signal_of
from vibrafeed.core.intake import parse_study
from vibrafeed.core.measured import Recording, fit_drive

RECORDING = Path(__file__).parents[4] / "examples" / "accelerometer.csv"
DRIVE = f"drive {RECORDING} --sensor ax,ay,az --line-frequency '50 Hz'"
PART = "drive part.csv --along ax --normal az"


def test_the_table_tells_numbers_and_errors():
    tells(
        DRIVE, "5,000 samples, 50.1 periods", "frequency: 50 Hz, as given", "% slow",
        "not explained by the fit: along 2.5 %, across 2.5 %, normal 2.6 % of the drive",
        "climbs by 3.38 degrees",
        "0.200072", "amplitude (mm)", "phase (°)", "-74.70", "not distinguishable from zero",
    )  # fmt: skip


@pytest.fixture
def part() -> str:
    """A recording of 0.2 mm along and 0.1 mm normal in phase: 0.1 sqrt(5) mm at atan(1/2)."""
    text = csv_of(signal_of({"along": [(2e-4, 0.0)], "normal": [(1e-4, 0.0)]}))
    saved(text, "part.csv")
    return text


def test_the_stroke_has_a_line_and_unusual_numbers_a_question(part):
    tells(PART, "stroke: 0.44721", "line of vibration, at 26.56")
    assert run(PART).stderr == ""
    saved(part.replace("time [s]", "number"), "part.csv")
    tells(PART, "Give --rate=the samples per second, or --time=the name of the time column", code=2)
    tells(f"{PART} --rate 2", "part.csv: warning: frequency = 0.05 Hz, fitted to part.csv, is unus")


def test_the_toml_is_the_parameters_of_a_study():
    told = run(f"{DRIVE} --toml -o part.toml").stdout
    assert told == Path("part.toml").read_text()
    parameters = tomllib.loads(told)["parameters"]
    content = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    values = {name: one.value for name, one in parse_study(content).values().items()}
    fit = fit_drive(RECORDING, Recording(sensor=("ax", "ay", "az"), line_frequency=50))
    assert values == pytest.approx(fit.parameters(), rel=1e-3)


@pytest.mark.usefixtures("part")
def test_a_picture_is_drawn():
    run(f"{PART} --plot fit.png")
    assert Path("fit.png").stat().st_size > 10_000


def test_a_study_finds_its_recording_beside_itself(here):
    (here / "folder").mkdir()
    recording = here / "folder" / "recording.csv"
    recording.write_bytes(RECORDING.read_bytes())
    text = (
        'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfriction = 0.3\n'
        '[drive]\nfile = "recording.csv"\nalong = "ax"\nnormal = "az"\n'
    )
    saved(text, "folder/study.toml")
    run("run folder/study.toml")
    with xarray.open_dataset(here / "folder" / "study.nc", engine="netcdf4") as dataset:
        assert dataset.attrs["drive"].startswith("fitted to recording.csv (SHA-256 ")
        assert str(here) not in str(dataset.attrs)
    saved(text.replace("file = ", "recording = "), "folder/named.toml")
    tells("run folder/named.toml", "not a key of the section drive. Did you mean 'file'?", code=2)
    recording.unlink()
    tells("run folder/study.toml --force", "drive.file: the file cannot be read: No such", code=2)
