"""What the commands refuse: an exit code and a sentence, and no file is written or changed."""

from pathlib import Path

import pytest

from commands import run, saved, tells

RECORDING = Path(__file__).parents[4] / "examples" / "accelerometer.csv"
SWEEP = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x", "throw_number"]

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 11 }
amplitude = "0.5 mm"
beta = { start = 0, stop = 90, num = 10 }
friction = 0.3
"""
MOTION = """
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = ["0.1 mm", "0.3 mm"]
beta = 30
friction = 0.4
"""
WRONG = SWEEP.replace("friction", "fricton").replace("0.5 mm", "0.5 kg")
LONG = "0.3" + "0" * 250
EXISTS = "exists already. Add --force to replace it, or give another name"
GROUP = "a.zarr exists already. Remove the existing output, or give another name."
DIGITS = "the number is larger than 1.8e308. Write a smaller number"

REFUSED = {
    "run study.toml wrong.toml worse.json absent.toml": (
        2,
        "wrong.toml: error: 2 problems",
        "parameters.amplitude: 'kg' does not measure amplitude",
        "parameters.fricton: 'fricton' is not a parameter. Did you mean 'friction'?",
        "worse.json: error: 1 problem",
        "absent.toml: error: 1 problem",
    ),
    "run digits.json digits.toml": (2, f"digits.json: error: 1 problem file: {DIGITS}", DIGITS),
    "run study.toml --max-cells 60": (
        2,
        "the study asks for 110 cells, the limit is 60",
        "It fits with 6 instead of 11 values of frequency",
    ),
    "run study.toml --units 'mm, cheese'": (
        2,
        "'cheese' is not a unit that vibrafeed knows. Write trade, si",
    ),
    # Where results would go.
    "run study.toml again/study.toml -o .": (2, "several studies would write to"),
    "run study.toml motion.toml": (2, "output: motion.nc exists already. It is a result of this"),
    "run study.toml -o mine.nc --resume": (2, f"output: mine.nc {EXISTS}"),
    "run study.toml -o a.zarr": (2, GROUP),
    "run study.toml -o a.zarr --force": (2, GROUP),
    "run study.toml -o a.zarr --resume": (2, GROUP),
    "run study.toml -o file/x.nc": (2, "file cannot be created"),
    "run study.toml -o nothing://bucket/key": (1, "nothing://bucket/key cannot be written"),
    "run study.toml other.toml -o x.csv": (2, "x.csv can hold only one result. Give a folder."),
    "run study.toml other.toml -o b.zarr": (2, "b.zarr can hold only one result. Give a folder."),
    "run study.toml other.toml -o -": (2, "the results of 2 studies cannot go to standard output"),
    "run study.toml -o -.zarr": (2, "a Zarr group consists of many files"),
    "run study.toml -o - --json": (2, "cannot both go to standard output"),
    "run study.toml -o y.nc --scheduler tcp://127.0.0.1:1": (
        2,
        "a cluster can run only sweeps and simulations to Zarr",
    ),
    "run .": (
        2,
        ".: error: 1 problem file: it is a folder. Name the studies in it, such as ./*.toml",
    ),
    # Formats.
    "run study.toml -o x.txt": (
        2,
        "'.txt' is not a known format of results. End the name in .nc, .zarr, .csv, .parquet",
        "or in / for a folder",
    ),
    "export x.nc -o x.parquett": (2, "Did you mean .parquet?"),
    "run study.toml -o y.nc --csv-style excel": (
        2,
        "--csv-style: --csv-style applies only to CSV. Remove --csv-style",
    ),
    "run huge.toml -o x.xlsx": (2, "3,600,000 rows in a sheet of Excel, the limit is 1,048,575"),
    "export x.nc -o y.csv --zarr-version 2": (2, "--zarr-version applies only to Zarr"),
    "export x.nc -o y.nc --units trade": (2, "the units of .nc files cannot be chosen"),
    "export x.nc -o x.zarr": (2, "exists already. Remove the existing output, or give another"),
    "export x.nc -o table.csv": (2, f"table.csv {EXISTS}"),
    "export table.csv -o y.xlsx": (
        2,
        "the file is not a result of vibrafeed. Give a NetCDF file or a Zarr group",
    ),
    "export absent.nc -o y.xlsx": (1, "absent.nc cannot be read: No such file"),
    # Other commands.
    "scenes rectangle-on-tack": (2, "Did you mean 'rectangle-on-track'?"),
    "plot motion.nc -k map": (2, "motion.nc: error: 1 problem"),
    "plot absent.nc": (1, "absent.nc: No such file or directory."),
    "plot motion.nc --units kelvin": (2, "'kelvin' is not a unit"),
    "plot motion.nc -k animation": (
        2,
        "Set trajectory = 400 in a study of one point, and run it.",
    ),
    "plot motion.nc --at amplitude": (2, "the option has no value. Write --at name=value"),
    f"plot motion.nc --at 'amplitude={LONG} mm'": (
        2,
        "has 256 characters. A value has at most 200 characters",
    ),
    "plot x.nc -o file": (2, f"file {EXISTS}"),
    "sheet x.nc -o file": (2, f"file {EXISTS}"),
    "convert study.toml --to yaml": (
        2,
        "to: a study cannot be converted to the format 'yaml'. "
        "Known: curl, json, powershell, python, toml.",
    ),
    "convert wrong.toml --to json": (2, "Did you mean 'friction'?"),
    "convert study.toml --to json -o file": (2, f"file {EXISTS}"),
    "convert study.toml --to json -o no/x.json": (1, "No such file or directory"),
    "report study.toml again/study.toml": (2, "several studies would write to"),
    "report study.toml wrong.toml": (2, "wrong.toml: error: 2 problems", "'friction'?"),
    "report study.toml -o file/below": (1, "Not a directory"),
    "new file --yes": (2, f"file {EXISTS}"),
    "new x.json --yes": (2, "Name the file x.toml; `vibrafeed convert` makes JSON of it later."),
    "new no/x.toml --yes": (1, "No such file or directory"),
    "new x.toml --frequency fast --friction -1": (
        2,
        "--frequency: 'fast' is not a number with a unit.",
        "--friction: friction is -1. It must be",
    ),
    "new x.toml --question xyz": (
        2,
        "--question: 'xyz' is not one of the answers. Please answer speed",
    ),
    "new x.toml --kind sweeps": (2, "'sweeps' is not a kind of study", "sweep"),
    "new x.toml --kind sweep --wiper '1 mm'": (
        2,
        "--wiper: this option has no effect together with --kind. Remove --wiper.",
    ),
    "new x.toml --radius '1 m'": (
        2,
        "--radius applies only with --track bowl, not with --track straight. Give",
    ),
    "new x.toml --amplitude '1 mm' --peak-to-peak '2 mm'": (
        2,
        "--amplitude and --peak-to-peak give the same quantity. Remove one",
    ),
    f"drive {RECORDING}": (
        2,
        "no column is given; the recording has the columns time, ax, ay, az. Give",
    ),
    "drive absent.csv --along ax": (
        2,
        "recording: the file cannot be read: No such file or directory.",
    ),
    f"drive {RECORDING} --along bx --normal az --rate '3 x' --unit kg --mounting 1,2,3"
    " --harmonics 12 --plot fit.bmp": (
        2,
        f"{RECORDING}: error: 6 problems --plot: '.bmp': unknown picture format. "
        "End the name of the picture in .png, .svg or .pdf. "
        "--rate: 'x' is not a unit. Write --rate=\"5 kHz\" (a bare number is in Hz). "
        "--mounting: the mounting needs the three columns of a triaxial sensor, which are not "
        "given. Give --sensor=three columns, instead of a column for each axis. "
        "--along: the table has no column 'bx'. Known: ax, ay, az, time. "
        "--unit: 'kg' is not a unit of acceleration. Known: m s-2, mm s-2, cm/s2, g, mg, "
        "mm/s, mm. "
        "--harmonics: a fit of 12 harmonics is not possible. Give a whole number from 1 to 10, or "
        "leave --harmonics out.",
    ),
    f"drive {RECORDING} --along ax --sensor ax,ay,az --rate '5 kHz' --time time": (
        2,
        "--rate: the recording has both a sampling rate (--rate) and a time column (--time). "
        "Give only the one that the recorder measures more accurately. "
        "--sensor: columns are given twice: three of a sensor (--sensor) and others (--along). "
        "Give either --sensor=three columns, or a column for each axis.",
    ),
    f"drive {RECORDING} --along ax -o no/part.toml": (1, "No such file or directory"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with studies, results, and what stands in the way."""
    found = tmp_path_factory.mktemp("refusals")
    files = {
        "study.toml": SWEEP,
        "other.toml": SWEEP,
        "again/study.toml": SWEEP,
        "wrong.toml": WRONG,
        "worse.json": '{"kind": "sweep"',
        "motion.toml": MOTION,
        "huge.toml": SWEEP.replace("11", "360_000"),
        "digits.json": f'{{"kind": {"7" * 900_000}}}',
        "digits.toml": f"frequency = {'7' * 900_000}\n",
        "file": "",
        "mine.nc": "mine",
        "table.csv": "a\n1\n",
    }
    for name in ("again", "a.zarr"):
        (found / name).mkdir()
    for name, text in files.items():
        saved(text, str(found / name))
    run(f"run {found}/study.toml -o {found}/x.nc")
    run(f"export {found}/x.nc -o {found}/x.zarr")
    run(f"run {found}/motion.toml")
    return found


@pytest.mark.parametrize(("line", "expected"), REFUSED.items(), ids=map(str, range(len(REFUSED))))
def test_what_is_refused_is_told_and_writes_nothing(line, expected, folder, monkeypatch):
    monkeypatch.chdir(folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
    code, *sentences = expected
    tells(line, *sentences, code=code)
    after = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
    assert after == before
