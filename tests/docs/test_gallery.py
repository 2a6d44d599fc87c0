"""The gallery shows every study and picture that it has, and each study can be drawn."""

import argparse
import shlex

import pytest

import vibrafeed
from benchmarks.gallery import GALLERY, LARGEST, PICTURES, STUDIES, Picture
from layout import judge
from night import spread
from vibrafeed.core.intake import load_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.plots.film import read_film
from vibrafeed.core.study.shown import ShownUnits


def options(picture: Picture) -> argparse.Namespace:
    """Return the options of the command that stands on the page."""
    parser = argparse.ArgumentParser()
    for short, long in (("-k", "--kind"), ("-v", "--variable"), ("-a", "--axes"), ("-s", "--slow")):
        parser.add_argument(short, long)
    return parser.parse_args(shlex.split(picture.options))


def test_every_study_and_every_picture_is_shown():
    studies = {name for picture in GALLERY for name in picture.studies}
    assert {path.stem for path in STUDIES.glob("*.toml")} == studies
    assert {path.name for path in PICTURES.iterdir()} == {picture.file for picture in GALLERY}


@pytest.mark.parametrize("picture", spread(GALLERY, 4), ids=lambda picture: picture.file)
def test_every_study_runs_and_every_picture_can_be_read(picture: Picture):
    datasets = [run_study(load_study(STUDIES / f"{name}.toml")) for name in picture.studies]
    asked = options(picture)
    assert (PICTURES / picture.file).stat().st_size < LARGEST or asked.slow
    if picture.file.endswith(".gif"):
        assert read_film(datasets[0], ShownUnits(), float(asked.slow)).times.size > 20
        return
    axes = tuple(asked.axes.split(",")) if asked.axes else None
    judge(vibrafeed.plot(datasets, variable=asked.variable, axes=axes, kind=asked.kind))
