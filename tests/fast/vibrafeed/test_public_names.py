"""What `import vibrafeed` gives, and what it costs."""

from __future__ import annotations

import doctest
import inspect
import json
import os
import pickle
import re
import subprocess
import sys
import traceback
from pathlib import Path

import matplotlib.figure
import pytest

import vibrafeed
import vibrafeed.accessor
import vibrafeed.parameters
from vibrafeed import core

ROOT = Path(__file__).parents[3]
POINT = {
    "scene": "rectangle-on-plane", "frequency": "50 Hz", "amplitude": "0.25 mm", "beta": 30,
    "friction": 0.5,
}  # fmt: skip
ACCELERATION = {**POINT, "outputs": ["acceleration_x"]}


def test_every_public_name_is_there():
    for name in vibrafeed.__all__:
        assert getattr(vibrafeed, name) is not None, name
    assert dir(vibrafeed) == sorted(vibrafeed.__all__)  # what users need, and nothing else
    assert vibrafeed.__version__ == core.__version__
    with pytest.raises(AttributeError, match="no attribute 'swep'"):
        vibrafeed.swep  # noqa: B018 - the look-up is what is tried


def examples() -> list[doctest.DocTest]:
    """Return the examples in the docstrings of the package, of its names and of the accessor."""
    objects = [vibrafeed, vibrafeed.accessor.Accessor, vibrafeed.parameters]
    objects += [getattr(vibrafeed, name) for name in vibrafeed.__all__]
    finder = doctest.DocTestFinder(recurse=False)
    return [
        test
        for one in objects
        if inspect.ismodule(one) or inspect.isclass(one) or inspect.isfunction(one)
        for test in finder.find(one, one.__name__, globs={"vibrafeed": vibrafeed})
        if test.examples
    ]


@pytest.mark.parametrize("example", examples(), ids=lambda example: example.name)
def test_its_examples_do_what_they_say(example, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert not doctest.DocTestRunner().run(example).failed


def test_every_public_name_stands_in_an_example_that_is_run():
    lines = [line for test in examples() for line in test.examples]
    told = " ".join(line.source for line in lines if doctest.SKIP not in line.options)
    for name in vibrafeed.__all__:
        assert re.search(rf"vibrafeed\.{name}\b", told), name


def test_the_example_of_the_readme_leaves_a_picture(tmp_path):
    text = (ROOT / "README.md").read_text()
    motion, code = (
        re.search(rf"```{language}\n(.*?)```", text, re.DOTALL)[1]
        for language in ("toml", "python")
    )
    (tmp_path / "motion.toml").write_text(motion)
    path = {"PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=os.environ | path, check=True)
    assert (tmp_path / "motion.png").stat().st_size > 10_000


def test_importing_it_loads_no_library():
    code = "import json, sys; before = set(sys.modules); import vibrafeed"
    tell = "print(json.dumps(sorted(set(sys.modules) - before)))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; {tell}"], cwd=ROOT, capture_output=True, check=True
    )
    outside = {name.partition(".")[0] for name in json.loads(done.stdout)}
    assert outside - sys.stdlib_module_names == {"vibrafeed"}
    assert not outside & {
        "typing",
        "pathlib",
        "dataclasses",
        "re",
    }  # what is slow of the standard's


def test_errors_have_the_name_by_which_users_import_them():
    problem = vibrafeed.Problem("parameters.beta", "it is wrong", "Write 20")
    for error in (
        vibrafeed.StudyError([problem]), vibrafeed.LimitError("cells", 2, 1, "Less"),
        vibrafeed.VibrafeedError("no"),
    ):  # fmt: skip
        name = f"vibrafeed.{type(error).__name__}"
        assert traceback.format_exception_only(error)[0].startswith(f"{name}: ")
        again = pickle.loads(pickle.dumps(error))
        assert (type(again), str(again)) == (type(error), str(error))
    assert pickle.loads(pickle.dumps(problem)) == problem
    code = "import pickle, sys; print(pickle.load(sys.stdin.buffer).problems[0])"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, check=True,
        input=pickle.dumps(vibrafeed.StudyError([problem])),
    )  # fmt: skip
    assert done.stdout.decode().strip() == str(problem)


def test_a_study_of_another_kind_is_refused_where_it_is_carried_out():
    study = vibrafeed.study(kind="simulate", **POINT)
    for carry_out in (vibrafeed.sweep, vibrafeed.optimise):
        with pytest.raises(vibrafeed.StudyError) as caught:
            carry_out(study)
        assert [problem.place for problem in caught.value.problems] == ["kind"]


def test_problems_of_a_study_as_a_whole_are_told_with_those_of_its_values():
    with pytest.raises(vibrafeed.StudyError) as caught:
        vibrafeed.sweep(**ACCELERATION | {"scene": "rectangle-on-plan", "friction": -1})
    assert {problem.place for problem in caught.value.problems} == {"scene", "parameters.friction"}


def test_a_sweep_of_any_size_is_opened():
    huge = {name: {"start": 1e-3, "stop": 40, "num": 10**5} for name in ("beta", "alpha")}
    lazy = vibrafeed.open_lazily(ACCELERATION, **huge, gamma=0)
    assert lazy.sizes["beta"] == lazy.sizes["alpha"] == 10**5
    last = dict.fromkeys(huge, 40)
    same = vibrafeed.sweep(ACCELERATION, **last, gamma=0).acceleration_x
    assert lazy.acceleration_x[dict.fromkeys(lazy.acceleration_x.dims, -1)].values == same


def test_a_picture_takes_one_axis_by_name_and_values_with_units():
    dataset = vibrafeed.sweep(ACCELERATION, beta=range(5, 45, 5), alpha=range(0, 20, 5))
    figure = vibrafeed.plot(dataset, axes="beta", at={"alpha": "10 deg"})
    assert isinstance(figure, matplotlib.figure.Figure)
    with pytest.raises(vibrafeed.VibrafeedError, match=r"at\.alpha"):
        vibrafeed.plot(dataset, axes="beta", at={"alpha": "11 deg"})


def test_the_catalogue_tells_all_scenes_or_one():
    names = [scene["name"] for scene in vibrafeed.scenes()]
    assert "rectangle-on-track" in names
    assert vibrafeed.scenes("rectangle-on-track")["validity"]
    assert vibrafeed.scenes("rectangle-on-plane", method="events")["method"] == "events"
    with pytest.raises(vibrafeed.StudyError, match="Did you mean 'rectangle-on-track'"):
        vibrafeed.scenes("rectangle-on-trak")
