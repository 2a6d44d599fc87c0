"""The command line, as a user runs it: files in, files and messages out."""

from __future__ import annotations

import json
import os
import pty
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from schemas import expanded
from vibrafeed.app.cli import COMMANDS, GONE, app
from waiting import PATIENCE, wait_for

STUDY = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x", "throw_number"]

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 11 }
amplitude = "0.5 mm"
beta = { start = 0, stop = 90, num = 10 }
friction = 0.3
"""

# What a command that neither computes in bulk nor writes must not load.
# (pint asks whether scipy is there, which loads its bare name, and none of its parts.)
HEAVY = ("sqlalchemy",
    "dask.array", "distributed", "netCDF4", "numba", "scipy.integrate", "scipy.linalg",
    "scipy.optimize", "fastapi", "matplotlib", "xarray", "uvicorn",
)  # fmt: skip


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


LOADED = """
import json, sys
from typer.testing import CliRunner
from vibrafeed.app.cli import COMMANDS, GONE, app
heavy, *commands = json.loads(sys.argv[1])
for command in commands:
    assert CliRunner().invoke(app, command).exit_code == 0, command
    print(json.dumps([name for name in heavy if name in sys.modules]))
"""


def loaded(*commands: list[str]) -> list[list[str]]:
    """Return the heavy modules that are there after each of the commands, in one new process."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED, json.dumps([HEAVY, *commands])],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_run_writes_beside_the_study(study):
    result = run("run", study)
    assert result.exit_code == 0, result.output
    assert study.with_suffix(".nc").exists()
    assert "slip" in result.output
    assert "flight" in result.output
    assert "110 cells" in result.output
    assert [path.name for path in study.parent.iterdir() if path.name.startswith(".")] == []


def test_run_writes_where_it_is_told(study, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(STUDY)
    assert run("run", study, "-o", tmp_path / "new" / "x.nc").exit_code == 0
    assert run("run", study, other, "-o", tmp_path / "folder").exit_code == 0
    assert (tmp_path / "new" / "x.nc").exists()
    assert {p.name for p in (tmp_path / "folder").iterdir()} == {"study.nc", "other.nc"}


MOTION = """
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = ["0.1 mm", "0.3 mm"]
beta = 30
friction = 0.4
"""


def test_an_interrupt_after_one_study_leaves_the_others_and_says_so(tmp_path, monkeypatch):
    from vibrafeed.core import kinds

    plain = kinds.tabulate

    def interrupted(prepared, watch):
        table = plain(prepared, watch)
        os.kill(os.getpid(), signal.SIGINT)  # it is finished, and nothing is missing
        return table

    monkeypatch.setattr(kinds, "tabulate", interrupted)
    one, other = tmp_path / "one.toml", tmp_path / "other.toml"
    for path in (one, other):
        path.write_text(MOTION)
    result = run("run", one, other)
    assert result.exit_code == 1
    assert f"The run was stopped: not carried out are {other}." in " ".join(result.output.split())
    assert one.with_suffix(".nc").exists()
    assert not other.with_suffix(".nc").exists()


def test_two_studies_do_not_overwrite_each_other(study, tmp_path):
    (tmp_path / "again").mkdir()
    other = tmp_path / "again" / "study.toml"
    other.write_text(STUDY)
    result = run("run", study, other, "-o", tmp_path)
    assert result.exit_code == 2
    assert "more than once" in result.output
    assert not (tmp_path / "study.nc").exists()


def test_all_errors_of_all_files_come_before_anything_runs(study, tmp_path):
    wrong, worse = tmp_path / "wrong.toml", tmp_path / "worse.json"
    wrong.write_text(STUDY.replace("friction", "fricton").replace("0.5 mm", "0.5 kg"))
    worse.write_text('{"kind": "sweep"')
    result = run("run", study, wrong, worse, tmp_path / "absent.toml")
    assert result.exit_code == 2
    for words in (
        f"{wrong}: error: 2 problems",
        "parameters.amplitude: 'kg' does not measure amplitude",
        "parameters.fricton: 'fricton' is not a parameter. Did you mean 'friction'?",
        f"{worse}: error: 1 problem",
        f"{tmp_path / 'absent.toml'}: error: 1 problem",
    ):
        assert words in result.output
    assert "Traceback" not in result.output
    assert not list(tmp_path.glob("*.nc"))


def test_a_study_that_is_too_large_is_told_what_fits(study):
    result = run("run", study, "--max-cells", 60)
    assert result.exit_code == 2
    assert "the study asks for 110 cells, the limit is 60" in result.output
    assert "It fits with 6 instead of 11 values of frequency" in result.output


def test_dry_run_says_what_would_happen_and_writes_nothing(study):
    result = run("run", study, "--dry-run")
    assert result.exit_code == 0
    for words in ("110 cells", "bytes", "frequency 11 x beta 10", "drive_normal", "alpha = 0"):
        assert words in result.output
    assert not study.with_suffix(".nc").exists()


def test_a_target_that_cannot_be_written_is_reported_and_leaves_nothing(study, tmp_path):
    (tmp_path / "folder.nc").mkdir()
    result = run("run", study, "-o", tmp_path / "folder.nc" / "study.nc" / "x.nc")
    assert result.exit_code == 0
    (tmp_path / "file").write_text("")
    result = run("run", study, "-o", tmp_path / "file" / "x.nc")
    assert result.exit_code == 2
    assert "cannot be made" in result.output


def test_light_commands_load_no_heavy_module(study):
    commands = [
        ["scenes"], ["scenes", "rectangle-on-track"], ["scenes", "--schema"],
        ["run", str(study), "--dry-run"],
    ]  # fmt: skip
    assert loaded(*commands) == [[]] * len(commands)


def test_a_command_of_old_names_what_does_the_same():
    for name, instead in GONE.items():
        done = run(name, "--any", "words")
        assert (done.exit_code, done.stderr) == (2, f"There is no command {name}. {instead}.\n")
    assert not GONE.keys() & COMMANDS.keys()


def test_run_loads_what_writing_needs_and_no_more(study):
    assert loaded(["run", str(study)]) == [["netCDF4"]]


def test_scenes_prints_units_equations_and_validity():
    everything = run("scenes")
    assert everything.exit_code == 0
    assert "cylinder-on-plane" in everything.output
    one = run("scenes", "rectangle-on-track", "--variant", "thesis")
    assert one.exit_code == 0
    for words in ("(3.18)", "mm/s", "wall_lost", "snapshot"):
        assert words in one.output
    wrong = run("scenes", "rectangle-on-tack")
    assert wrong.exit_code == 2
    assert "Did you mean 'rectangle-on-track'?" in wrong.output


def test_schema_is_json_that_accepts_the_example():
    schema = json.loads(run("scenes", "--schema").output)
    for kind, part in zip(
        ("sweep", "simulate", "optimise", "sensitivity", "calibrate"), schema["oneOf"], strict=True
    ):
        assert part["properties"]["kind"]["const"] == kind
        properties = expanded(part["properties"]["parameters"], schema)["properties"]
        assert "frequency" in properties


def test_the_schema_is_kept_until_a_source_changes(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(
        "vibrafeed.core.schema.study_schema", lambda: {"title": "made", "oneOf": []}
    )
    printed = run("scenes", "--schema").output
    (kept,) = (tmp_path / "vibrafeed").glob("schema-*.json")
    assert kept.read_text() == printed.rstrip("\n")
    assert json.loads(printed) == {"title": "made", "oneOf": []}
    kept.write_text("{}")
    assert run("scenes", "--schema").output == "{}\n"  # it is not made again
    for number in range(10):
        monkeypatch.setattr(
            "vibrafeed.app.kept_texts._digest", lambda number=number: f"other{number}"
        )
        monkeypatch.setattr("vibrafeed.core.schema.study_schema", lambda: {"other": True})
        assert json.loads(run("scenes", "--schema").output) == {"other": True}
    assert len(list((tmp_path / "vibrafeed").iterdir())) == 8
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))  # nothing can be kept there
    assert json.loads(run("scenes", "--schema").output) == {"other": True}


def test_settings_come_from_the_environment(monkeypatch):
    monkeypatch.setenv("VIBRAFEED_MAX_CELLS", "1234")
    assert json.loads(run("serve", "--show-settings").output)["max_cells"] == 1234
    monkeypatch.setenv("VIBRAFEED_MAX_CELLS", "many")
    result = run("serve", "--show-settings")
    assert result.exit_code == 2
    assert "VIBRAFEED_MAX_CELLS" in result.output


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("file", "it is not a directory"),
        ("file/data", "Not a directory"),
        ("/proc/data", "No such file"),  # where nobody makes any
        ("odd", "its jobs.sqlite3: unable to open database file"),
    ],
)
def test_a_data_directory_that_cannot_be_used_is_told_in_one_line(name, why, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    (tmp_path / "odd" / "jobs.sqlite3").mkdir(parents=True)
    directory = tmp_path / name
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(directory))
    assert_one_line(run("serve", "--port", "0"), directory, why)


def test_a_ledger_that_is_none_is_told_and_left_alone(tmp_path, monkeypatch):
    ledger = tmp_path / "jobs.sqlite3"
    ledger.write_bytes(b"no ledger " * 1000)
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))
    result = run("serve", "--port", "0")
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert line == (
        f"The ledger is damaged: file is not a database. Restore the backup of {ledger}; studies "
        "and results are not affected."
    )
    assert ledger.read_bytes() == b"no ledger " * 1000


def test_temporary_files_go_to_the_data_directory_where_the_system_has_no_folder(
    tmp_path, monkeypatch
):
    folders = []
    monkeypatch.setattr(
        "vibrafeed.app.web.server.serve_until_stopped",
        lambda *_, **__: folders.append(tempfile.gettempdir()),
    )
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("TMPDIR", "/proc/none")
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(
        tempfile, "_candidate_tempdir_list", lambda: [os.environ["TMPDIR"], "/proc/none"]
    )
    (tmp_path / "tmp").touch()
    assert_one_line(run("serve", "--port", "0"), tmp_path, "it can hold no folder for temporary")
    (tmp_path / "tmp").unlink()
    assert run("serve", "--port", "0").exit_code == 0
    assert folders == [str(tmp_path / "tmp")]


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_an_empty_ledger_beside_studies_is_not_taken_for_a_new_one(tmp_path, monkeypatch, host):
    (tmp_path / "studies" / ("0" * 64)).mkdir(parents=True)
    ledger = tmp_path / "jobs.sqlite3"
    ledger.touch()
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))
    result = run("serve", "--host", host, "--port", "0")
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"The ledger is empty, but {tmp_path / 'studies'} holds studies: ")
    assert "--new-ledger" in line
    served = []
    monkeypatch.setattr(
        "vibrafeed.app.web.server.serve_until_stopped", lambda *_, **__: served.append(1)
    )
    assert run("serve", "--new-ledger", "--port", "0").exit_code == 0
    assert served


def test_a_port_that_is_taken_is_told_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path / "data"))
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = run("serve", "--port", str(port))
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"Port {port} of 127.0.0.1 is taken.")
    assert not (tmp_path / "data").exists()


def test_who_starts_it_by_hand_reads_which_address_to_open(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "vibrafeed", "serve", "--port", str(port)],
        env={**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(tmp_path)},
        stdout=theirs, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        line = os.read(ours, 1000).decode()
    finally:
        process.terminate()
        process.wait(PATIENCE)
        os.close(ours)
        os.close(theirs)
    first, *_ = line.splitlines()
    assert first == f"Open http://127.0.0.1:{port}/ in a browser; Ctrl-C stops the service."


def assert_one_line(result, directory: Path, why: str) -> None:
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)  # no traceback
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"The data directory {directory} cannot be used: ")
    assert why in line
    assert line.endswith("VIBRAFEED_DATA_DIRECTORY to a directory that can be written.")


MOTION = """
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = { start = "0.1 mm", stop = "0.4 mm", num = 4 }
beta = "30 deg"
friction = 0.4
"""


@pytest.fixture
def motion(tmp_path: Path) -> Path:
    path = tmp_path / "motion.toml"
    path.write_text(MOTION)
    return path


def test_run_simulates(motion):
    result = run("run", motion)
    assert result.exit_code == 0, result.output
    assert "conveying_velocity" in result.output
    assert "hopping" in result.output
    assert motion.with_suffix(".nc").exists()


def test_the_catalogue_of_a_simulation_loads_no_compiler():
    assert loaded(["scenes", "rectangle-on-track", "--method", "reference"]) == [[]]


def test_a_simulation_out_of_time_is_written_and_said(motion, stopped_after):
    motion.write_text('method = "reference"\n' + motion.read_text())
    stopped_after(1)
    result = run("run", motion)
    assert result.exit_code == 1
    assert "1 of 4 cells are computed." in result.output
    assert "the other 3 are not computed, and marked so" in result.output
    assert motion.with_suffix(".nc").exists()


def test_what_was_not_verified_in_time_is_said(motion, study, tmp_path, stopped_after):
    motion.write_text('verify = 2\nmethod = "reference"\n' + motion.read_text())
    stopped_after(4)
    result = run("run", motion)
    assert result.exit_code == 1
    assert "0 cells verified by the method events; stopped before 2 of 2" in result.output
    # A sweep is computed as a whole; that it is not verified is said, too.
    late = tmp_path / "late.toml"
    late.write_text("verify = 3\n" + Path(study).read_text())
    result = run("run", late, "-o", tmp_path / "late.nc", "--time-limit", "0")
    assert result.exit_code == 1
    assert "all cells are computed, but not all" in result.output
    assert (tmp_path / "late.nc").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_keeps_what_is_finished(tmp_path):
    slow = tmp_path / "slow.toml"
    slow.write_text(
        MOTION.replace("num = 4", "num = 40").replace(
            'kind = "simulate"', 'kind = "simulate"\nmethod = "reference"'
        )
    )
    begun = tmp_path / "begun"
    code = f"""
import pathlib
from vibrafeed.app.cli import main
from vibrafeed.core.watch import Watch
advance = Watch.advance
def told(watch, share):
    advance(watch, share)
    if watch.progress is not None:  # the price follows some cells before
        pathlib.Path({str(begun)!r}).touch()
Watch.advance = told
main()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", code, "run", str(slow)], stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip

    def has_begun():
        assert process.poll() is None, process.communicate()
        return begun.exists()

    wait_for(has_begun)  # the first cells are done
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1, output + errors
    assert "not computed" in errors
    with xarray.open_dataset(slow.with_suffix(".nc"), decode_times=False) as found:
        done = found.motion_status.values != 0
        assert 0 < done.sum() < done.size
        assert np.isfinite(found.conveying_velocity.values[done]).all()


def test_pictures_of_motion(motion, tmp_path):
    assert run("run", motion).exit_code == 0
    for kind in ("line", "map"):
        result = run("plot", motion.with_suffix(".nc"), "-k", kind, "-o", tmp_path / f"{kind}.png")
        assert (result.exit_code == 0) == (kind == "line"), result.output
    motion.write_text(MOTION.replace("{ start = \"0.1 mm\", stop = \"0.4 mm\", num = 4 }", "3e-4")
                      .replace("[parameters]", "trajectory = 200\n[parameters]"))  # fmt: skip
    assert run("run", motion, "--force").exit_code == 0
    result = run("plot", motion.with_suffix(".nc"), "-o", tmp_path / "course.png")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "course.png").stat().st_size > 20_000
    look = ("--title", "Hop by hop", "--units", "m/min", "--dark", "--small")
    result = run("plot", motion.with_suffix(".nc"), "-o", tmp_path / "course.svg", *look)
    assert result.exit_code == 0, result.output
    assert "#15181d" in (tmp_path / "course.svg").read_text()
    result = run("plot", motion.with_suffix(".nc"), "--units", "kelvin")
    assert result.exit_code == 2
    assert "'kelvin' is not a unit" in result.output


def test_several_files_and_a_motion_in_time(motion, tmp_path):
    oiled = tmp_path / "oiled.toml"
    oiled.write_text(MOTION.replace("friction = 0.4", "friction = 0.1"))
    assert run("run", motion, oiled).exit_code == 0
    files = [path.with_suffix(".nc") for path in (motion, oiled)]
    result = run("plot", *files, "-o", tmp_path / "both.png")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "both.png").stat().st_size > 10_000
    result = run("plot", files[0], "-k", "animation")
    assert result.exit_code == 2
    assert "Set trajectory = 400 in a study of one point, and run it." in result.output
    motion.write_text(MOTION.replace("{ start = \"0.1 mm\", stop = \"0.4 mm\", num = 4 }", "3e-4")
                      .replace("[parameters]", "trajectory = 100\n[parameters]"))  # fmt: skip
    assert run("run", motion, "--force").exit_code == 0
    result = run("plot", files[0], "-k", "animation", "--slow", 10)
    assert result.exit_code == 0, result.output
    assert files[0].with_name(f"{files[0].stem}-animation.gif").stat().st_size > 10_000


def test_verification_is_told_in_one_line(study, tmp_path):
    text = Path(study).read_text()
    verified = tmp_path / "verified.toml"
    verified.write_text("verify = 3\n" + text)
    result = CliRunner().invoke(app, ["run", str(verified), "-o", str(tmp_path / "v.nc")])
    assert result.exit_code == 0, result.output
    lines = [line for line in result.output.splitlines() if "verified by" in line]
    assert len(lines) == 1
    assert "3 cells verified by the same equations in extended precision; worst: " in lines[0]
    assert "within the bound of 8" in lines[0]


def test_results_as_tables(tmp_path):
    study = tmp_path / "x.json"
    content = {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {"frequency": 50, "amplitude": ["0.5 mm", "1 mm"], "beta": [10, 20, 30]},
    }
    study.write_text(json.dumps(content))
    for name in ("y.csv", "y.parquet"):
        result = CliRunner().invoke(app, ["run", str(study), "-o", str(tmp_path / name)])
        assert result.exit_code == 0, result.output
    heading, *rows = (tmp_path / "y.csv").read_text().splitlines()
    assert heading.startswith("amplitude [m],beta [degree],")
    assert len(rows) == 6
    assert (tmp_path / "y.parquet").read_bytes()[:4] == b"PAR1"


IMPOSSIBLE = """
kind = "optimise"
scene = "rectangle-on-plane"
[criterion]
kind = "maximise"
output = "{output}"
[[constraints]]
output = "throw_number"
upper = 1
[[constraints]]
output = "{output}"
lower = "{least}"
[variables]
amplitude = {{ lower = "0.1 mm", upper = "1 mm" }}
[parameters]
frequency = 50
friction = 0.8
beta = 30
gamma = 3
"""


def test_an_optimum_without_a_solution_tells_what_comes_nearest_and_has_its_own_exit_code(tmp_path):
    study = tmp_path / "impossible.toml"
    study.write_text(IMPOSSIBLE.format(output="conveying_velocity", least="100 mm/s"))
    result = run("run", study)
    assert result.exit_code == 3, result.output
    assert study.with_suffix(".nc").exists()
    assert "Nearest: throw_number 2.056 (at most 1 is asked)" in result.output
    assert "With an elliptical drive: conveying_velocity 195.6 mm/s" in result.output
    # Closed forms, which are soon searched: nothing but the exit code is told.
    study.write_text(IMPOSSIBLE.format(output="acceleration_x", least="500 m/s^2"))
    quiet = run("run", study, "--force", "--quiet")
    assert (quiet.exit_code, quiet.output) == (3, "")


def test_a_robust_optimum_says_at_which_friction_its_outputs_hold(tmp_path):
    study = tmp_path / "robust.toml"
    study.write_text(
        'kind = "optimise"\nscene = "rectangle-on-plane"\nrobust = "worst"\n'
        '[criterion]\nkind = "maximise"\noutput = "acceleration_x"\n'
        '[parameters]\nfrequency = 50\namplitude = "0.1 mm"\n'
        "[uncertain]\nfriction = { lower = 0.25, upper = 0.45 }\n"
    )
    result = run("run", study)
    assert result.exit_code == 0, result.output
    assert "Outputs are those at friction 0.35;" in result.output
