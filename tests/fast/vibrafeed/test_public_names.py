"""What `import vibrafeed` gives."""

import doctest
import inspect
import pickle
import re
import traceback
from pathlib import Path

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


def test_a_study_of_another_kind_is_refused_and_all_problems_are_told_at_once():
    with pytest.raises(vibrafeed.StudyError) as caught:
        vibrafeed.sweep(vibrafeed.study(kind="simulate", **POINT))
    assert [problem.place for problem in caught.value.problems] == ["kind"]
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
