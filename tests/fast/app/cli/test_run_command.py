"""`vibrafeed run`: studies in; results, messages and exit codes out."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray

from commands import run, said, saved, tells

SWEEP = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["acceleration_x", "velocity_bound"]

[parameters]
frequency = "50 Hz"
amplitude = "0.5 mm"
beta = { start = 0, stop = 90, num = 10 }
friction = 0.3
"""
POINT = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": 30},
}
MOTION = """
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = { start = "0.1 mm", stop = "0.4 mm", num = 4 }
beta = "30 deg"
friction = 0.4
"""
SLOW = f'method = "reference"\n{MOTION}'


def opened(name: str) -> xarray.Dataset:
    return xarray.load_dataset(name, decode_times=False)


def test_results_go_beside_the_studies_or_where_they_are_told(here):
    saved(SWEEP)
    saved(MOTION, "other.toml")
    (here / "there.csv").mkdir()
    tells("run study.toml", "slip", "flight", "10 cells evaluated in")
    run("run study.toml -o new/x.nc")
    run("run study.toml -o there.csv")
    run("run study.toml other.toml -o folder.v2/")
    found = {path.relative_to(here).as_posix() for path in here.rglob("*") if path.is_file()}
    results = {"study.nc", "new/x.nc", "there.csv/study.nc"}
    results |= {"folder.v2/study.nc", "folder.v2/other.nc"}
    assert found - results == {"study.toml", "other.toml"}  # also nothing that is hidden


def test_a_plan_says_what_would_happen_and_writes_nothing(here):
    saved(SWEEP)
    words = ("10 cells", "bytes", "beta 10", "drive_normal", "alpha = 0")
    tells("run study.toml --dry-run", *words)
    (plan,) = json.loads(run("run study.toml --dry-run --json").stdout)["plans"]
    assert plan["cells"] == 10
    assert plan["outputs"]["velocity_bound"] == {"unit": "m s-1", "dimensions": {"beta": 10}}
    assert plan["defaults"]["gravity"] == {"value": 9.80665, "unit": "m s-2"}
    assert [path.name for path in here.iterdir()] == ["study.toml"]


def test_one_json_document_in_the_units_of_files():
    saved(SWEEP)
    (result,) = json.loads(run("run study.toml --json --units mm").stdout)["results"]
    largest = float(opened("study.nc").velocity_bound.max())
    assert result["outputs"]["velocity_bound"]["largest"] == largest
    assert result["cells"] == result["cells_computed"] == 10
    assert sum(result["regimes"].values()) == pytest.approx(1)


def test_quiet_prints_nothing_and_verbose_more():
    saved(SWEEP)
    assert said("run study.toml -q") == ""
    assert "equations" not in said("run study.toml --force")
    told = said("run study.toml --force -v")
    assert re.search(r"checked in \d+\.\d+ s; variant physical equations: .* kernels: ", told)


def test_a_motion_tells_what_is_computed_and_an_output_in_words():
    saved(MOTION)
    tells("run study.toml", "conveying_velocity", "hopping", "Fastest: ")
    point = re.sub("{ start.*}", '"0.1 mm"', MOTION).replace("[p", 'outputs = ["direction"]\n[p')
    saved(point)
    assert " direction: forwards " in said("run study.toml --force")
    (result,) = json.loads(run("run study.toml --json --force").output)["results"]
    assert result["states"] == {"direction": {"forwards": 1.0}}


def test_an_existing_result_is_replaced_with_force_only():
    saved(SWEEP)
    result = Path("study.nc")
    result.write_text("mine")
    tells("run study.toml --dry-run -o x.xlsx", "to write the Excel file")
    run("run study.toml --force")
    before = result.stat().st_mtime_ns
    assert "study.nc is complete already" in said("run study.toml --resume")
    assert result.stat().st_mtime_ns == before


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_a_study_comes_from_standard_input_and_a_result_goes_to_standard_output(mark, here):
    heading, *rows = run("run - -o -", input=mark + SWEEP).stdout.splitlines()
    assert heading.startswith("beta [degree],")
    assert len(rows) == 10
    assert list(here.iterdir()) == []
    point = json.dumps(POINT)
    assert len(run("run - -o -", input=point).stdout.splitlines()) == 2
    assert run("run - -o -.nc", input=point).stdout_bytes[1:4] == b"HDF"
    run("run -", input=point)
    assert Path("study.nc").exists()
    for command in ("run -", "convert - --to toml"):
        told = said(command, 2, input=b"\xff\xfe")
        assert told.startswith("standard input: error: 1 problem file: standard input is not UTF-8")


def test_a_terminal_shows_no_binary_file(monkeypatch):
    saved(SWEEP)
    terminal = SimpleNamespace(stdout=SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr("vibrafeed.app.cli.run.sys", terminal)
    assert "a terminal cannot show .nc. Use -o - for CSV" in said("run study.toml -o -.nc", 2)


def test_a_stopped_run_keeps_what_is_finished_and_says_how_to_go_on(stopped_after):
    saved(SLOW)
    stopped_after(1)
    tells(
        "run study.toml",
        "The run was stopped: 1 of 4 cells are computed.",
        "the other 3 are not computed, and marked so",
        "The same command with --resume computes the whole study again.",
        "1 of 4 cells evaluated in",
        code=1,
    )
    assert (opened("study.nc").motion_status != 0).sum() == 1
    stopped_after(-1)  # never
    run("run study.toml", 2)
    assert " 4 cells evaluated in" in said("run study.toml --resume")
    assert "is complete already" in said("run study.toml --resume")
    # What is there stays as it was.
    whole = Path("study.nc").read_bytes()
    stopped_after(1)
    told = said("run study.toml --force", 1)
    assert "study.nc stays as it was; what is computed goes to study.partial.nc" in told
    assert Path("study.nc").read_bytes() == whole
    assert (opened("study.partial.nc").motion_status != 0).sum() == 1


def test_a_run_that_is_stopped_before_a_cell_writes_nothing(here, stopped_after):
    saved(SLOW)
    told = "before a cell was computed; nothing is written"
    assert told in said("run study.toml --time-limit 0", 1)
    stopped_after(0)
    assert told in said("run study.toml", 130)
    assert [path.name for path in here.iterdir()] == ["study.toml"]


def test_ctrl_c_after_one_study_leaves_the_others_and_says_so(stopped_after):
    saved(SLOW)
    saved(SLOW, "other.toml")
    stopped_after(4)  # it is finished, and nothing is missing
    words = "The run was stopped: not carried out are other.toml."
    tells("run study.toml other.toml", words, code=1)
    assert Path("study.nc").exists()
    assert not Path("other.nc").exists()


def test_verification_is_told_in_a_line_and_so_is_what_is_not_verified(stopped_after):
    saved("verify = 3\n" + SWEEP)
    words = "3 cells verified by the same equations in extended precision; worst: "
    tells("run study.toml", words, "within the bound of 8")
    # A sweep is computed as a whole.
    late = "run study.toml --force --time-limit 0"
    tells(late, "all cells are computed, but not all", code=1)
    saved("verify = 2\n" + SLOW, "motion.toml")
    stopped_after(4)
    words = "0 cells verified by the method events; stopped before 2 of 2"
    tells("run motion.toml", words, code=1)


IMPOSSIBLE = """
kind = "optimise"
scene = "rectangle-on-plane"
[criterion]
kind = "maximise"
output = "acceleration_x"
[[constraints]]
output = "throw_number"
upper = 1
[[constraints]]
output = "acceleration_x"
lower = "500 m/s^2"
[variables]
amplitude = { lower = "0.1 mm", upper = "1 mm" }
[parameters]
frequency = 50
friction = 0.8
beta = 30
gamma = 3
"""


def test_an_optimum_without_a_solution_tells_what_helps_and_has_its_own_exit_code(monkeypatch):
    way = {"change": "an elliptical drive", "output": "conveying_velocity", "value": 0.1956}
    way = SimpleNamespace(**way, choice={"beta": 30.0})
    monkeypatch.setattr("vibrafeed.core.optimise.reach.ways", lambda study, watch: [way])
    saved(IMPOSSIBLE)
    asked = "(at least 500 m/s² is asked) with all other limits kept, at amplitude"
    other = (
        "With an elliptical drive: conveying_velocity 195.6 mm/s and all limits kept, at beta 30°."
    )
    told = "Nearest: acceleration_x ", asked, other, "nearest designs searched in"
    tells("run study.toml", *told, code=3)
    assert said("run study.toml --force --quiet", 3) == ""
    assert Path("study.nc").exists()


def test_a_robust_optimum_says_at_which_friction_its_outputs_hold():
    saved(
        'kind = "optimise"\nscene = "rectangle-on-plane"\nrobust = "worst"\n'
        '[criterion]\nkind = "maximise"\noutput = "acceleration_x"\n'
        '[parameters]\nfrequency = 50\namplitude = "0.1 mm"\n'
        "[uncertain]\nfriction = { lower = 0.25, upper = 0.45 }\n"
    )
    assert "Outputs are those at friction 0.35;" in said("run study.toml")


def test_pictures_of_motion():
    saved(MOTION)
    saved(MOTION.replace("0.4\n", "0.1\n"), "oiled.toml")
    run("run study.toml oiled.toml")
    run("plot study.nc oiled.nc -o both.png")
    saved(re.sub("{ start.*}", '"0.3 mm"', MOTION).replace("[p", "trajectory = 100\n[p"))
    run("run study.toml --force")
    run("plot study.nc -k animation --slow 2")
    for name in ("both.png", "study-animation.gif"):
        assert Path(name).stat().st_size > 10_000
    run("plot study.nc -o x.svg --title 'Hop by hop' --units m/min --dark --small")
    assert "#15181d" in Path("x.svg").read_text()


def test_studies_that_are_right_run_although_others_are_wrong(here):
    saved(SWEEP, "a.toml")
    saved(SWEEP.replace("50 Hz", "50 kg"), "b.toml")
    saved(POINT, "c.toml")
    run("run a.toml b.toml c.json", code=2)
    assert not list(here.glob("*.nc"))
    run("run b.toml --keep-going", code=2)
    tells("run a.toml b.toml c.json --keep-going --dry-run", "10 cells", "'kg' does", code=2)
    tells("run a.toml b.toml c.json --keep-going", "b.toml: error: 1 problem", code=2)
    assert sorted(path.name for path in here.glob("*.nc")) == ["a.nc", "c.nc"]
    told = run("run a.toml b.toml --keep-going --dry-run --json", code=2)
    (refused,) = json.loads(told.stdout)["refused"]
    assert (refused["study"], refused["errors"][0]["place"]) == ("b.toml", "parameters.frequency")
