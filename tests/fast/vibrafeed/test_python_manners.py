"""Python is as good as the command line: questions, errors, short texts, pictures of files."""

from __future__ import annotations

import json

import matplotlib.pyplot as plt
import pytest

import vibrafeed
from vibrafeed import _functions
from vibrafeed.core.errors import StudyError

SWEEP = {"scene": "rectangle-on-plane", "outputs": ["throw_number"], "frequency": 50, "beta": 20}


def test_an_unusual_number_is_asked_about_where_it_was_written():
    with pytest.warns(UserWarning, match=r'amplitude = 0\.25 means 250 mm.*"0\.25 mm"') as asked:
        vibrafeed.sweep(**SWEEP, amplitude=0.25)
    assert asked[0].filename == __file__
    assert vibrafeed.sweep(**SWEEP, amplitude="250 mm") is not None  # a unit says that it is meant


def test_a_study_that_is_made_or_loaded_warns_too(tmp_path):
    told = r"amplitude = 0\.25 means 250 mm"
    with pytest.warns(UserWarning, match=told) as asked:
        vibrafeed.study(kind="sweep", **SWEEP, amplitude=0.25)
    assert asked[0].filename == __file__
    path = tmp_path / "study.json"
    path.write_text(
        json.dumps(
            {
                "kind": "sweep",
                "scene": "rectangle-on-plane",
                "outputs": ["throw_number"],
                "parameters": {"frequency": 50, "beta": 20, "amplitude": 0.25},
            }
        )
    )
    with pytest.warns(UserWarning, match=told) as asked:
        vibrafeed.load_study(path)
    assert asked[0].filename == __file__


@pytest.mark.parametrize("function", [vibrafeed.sweep, vibrafeed.open_lazily])
def test_a_function_asks_where_it_was_called(function):
    with pytest.warns(UserWarning, match="means 250 mm") as asked:
        function(**SWEEP, amplitude=0.25)
    assert [one.filename for one in asked] == [__file__]


def test_a_grid_that_memory_cannot_hold_is_an_error_in_words():
    with pytest.raises(vibrafeed.VibrafeedError, match="It fits with"):
        vibrafeed.sweep(
            **{**SWEEP, "beta": {"start": 0, "stop": 80, "num": 100_000}},
            amplitude={"start": 1e-4, "stop": 1e-3, "num": 100_000},
            gamma={"start": 0, "stop": 5, "num": 1_000},
        )


def test_studies_are_shown_briefly():
    study = vibrafeed.sweep(**SWEEP, amplitude=1e-3).vibrafeed.study
    assert len(repr(study)) < 300
    assert "None" not in repr(study)
    shown = study._repr_html_()
    assert "<td>parameters.frequency</td><td>50.0</td>" in shown
    assert "None" not in shown


def test_notebooks_show_the_words_of_an_error_alone():
    error = StudyError([])
    assert error._render_traceback_() == [f"StudyError: {error}"]


def test_a_long_computation_in_a_notebook_says_how_far_it_is(capsys):
    now = iter([0.0, 0.0, 1.0, 3.0, 3.1, 6.0])
    advance = _functions._progress(lambda: next(now))
    for share in (0.25, 0.25, 0.25, 0.25):
        advance(share)
    assert capsys.readouterr().err == "\rvibrafeed:  50 %, 3 s left\rvibrafeed: 100 %, 0 s left\n"


def test_a_file_is_drawn_by_its_path(tmp_path):
    path = tmp_path / "throw.nc"
    vibrafeed.sweep(**SWEEP, amplitude=[1e-4, 2e-4]).to_netcdf(path)
    for given in (path, str(path)):
        figure = vibrafeed.plot(given)
        assert figure is not None
        plt.close("all")
