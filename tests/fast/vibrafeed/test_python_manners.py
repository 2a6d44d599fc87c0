"""Python is as good as the command line: questions, errors, short texts, pictures of files."""

import json

import matplotlib.pyplot as plt
import pytest

import vibrafeed
from vibrafeed import _functions

KEYS = {"scene": "rectangle-on-plane", "outputs": ["throw_number"]}
POINT = {"frequency": 50, "beta": 20}
SWEEP = {**KEYS, **POINT}


@pytest.mark.parametrize("name", ["sweep", "open_lazily", "study", "load_study"])
def test_an_unusual_number_is_asked_about_where_it_was_written(tmp_path, name):
    path = tmp_path / "study.json"
    kept = {"kind": "sweep", **KEYS, "parameters": {**POINT, "amplitude": 0.25}}
    path.write_text(json.dumps(kept))
    given = {**SWEEP, "amplitude": 0.25}
    asked = {"load_study": {"path": path}, "study": {"kind": "sweep", **given}}
    with pytest.warns(UserWarning, match=r'amplitude = 0\.25 means 250 mm.*"0\.25 mm"') as told:
        getattr(vibrafeed, name)(**asked.get(name, given))
    assert [one.filename for one in told] == [__file__]
    assert vibrafeed.sweep(**SWEEP, amplitude="250 mm") is not None  # a unit: it is meant


def test_a_grid_that_memory_cannot_hold_is_an_error_in_words():
    with pytest.raises(vibrafeed.VibrafeedError, match="It fits with"):
        vibrafeed.sweep(
            **{**SWEEP, "beta": {"start": 0, "stop": 80, "num": 100_000}},
            amplitude={"start": 1e-4, "stop": 1e-3, "num": 100_000},
            gamma={"start": 0, "stop": 5, "num": 1_000},
        )


def test_studies_are_shown_briefly():
    study = vibrafeed.study(
        kind="simulate", scene="rectangle-on-plane", **POINT, amplitude=1e-4, friction=0.3
    )
    assert repr(study) == (  # its outputs are those of default
        "SimulateStudy(scene='rectangle-on-plane', parameters={'frequency': 50.0, "
        "'amplitude': 0.0001, 'beta': 20.0, 'friction': 0.3})"
    )
    shown = study._repr_html_()
    assert "<td>parameters.frequency</td><td>50.0</td>" in shown
    error = vibrafeed.StudyError([])
    assert error._render_traceback_() == [f"StudyError: {error}"]  # of notebooks


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
