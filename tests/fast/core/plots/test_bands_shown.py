"""Bands of speeds as a person sees them: table, page, lines and maps."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

import vibrafeed
from vibrafeed.app.cli import app
from vibrafeed.core.plots.sheet import draw_sheet

DRIVE = {"scene": "rectangle-on-plane", "frequency": 50, "beta": 20, "gamma": 2}
BAND = {"low": 0.2, "high": 0.5}
MINUS = "\N{MINUS SIGN}"
OVER = "for friction 0.2 to 0.5"


@pytest.fixture(scope="module")
def line():
    amplitudes = {"start": 1e-4, "stop": 5e-4, "num": 9}
    return vibrafeed.simulate(**DRIVE, amplitude=amplitudes, friction=BAND)


@pytest.fixture(scope="module")
def plane():
    amplitudes = {"start": 1e-4, "stop": 5e-4, "num": 9}
    drive = DRIVE | {"beta": {"start": 5, "stop": 40, "num": 8}}
    return vibrafeed.simulate(**drive, amplitude=amplitudes, friction=BAND)


def entries(figure):
    legends = [*figure.legends, *(one.get_legend() for one in figure.axes if one.get_legend())]
    return [text.get_text() for legend in legends for text in legend.get_texts()]


def test_a_line_has_its_band(line):
    figure = vibrafeed.plot(line)
    assert OVER in entries(figure)
    (band,) = (
        one for axes in figure.axes for one in axes.collections
        if "FillBetween" in type(one).__name__ or "PolyCollection" in type(one).__name__
    )  # fmt: skip
    heights = band.get_paths()[0].vertices[:, 1]
    least = float(line.conveying_velocity_least.min())
    most = float(line.conveying_velocity_most.max())
    assert [heights.min(), heights.max()] == pytest.approx([1e3 * least, 1e3 * most])


def test_a_map_marks_where_the_sign_is_not_settled(plane):
    assert 0 < plane.sign_unsettled.mean() < 1
    assert f"sign not settled {OVER}" in entries(vibrafeed.plot(plane))
    settled = plane.assign(sign_unsettled=plane.sign_unsettled * 0)
    assert not [one for one in entries(vibrafeed.plot(settled)) if "settled" in one]


def test_the_page_says_the_band_in_the_digits_that_it_leaves():
    nut = vibrafeed.simulate(
        **DRIVE, amplitude="0.3 mm", friction=BAND, length=0.01,
        outputs=["conveying_velocity", "feed_rate"],
    )  # fmt: skip
    said = [text.get_text().strip() for text in draw_sheet(nut).texts]
    assert f"{MINUS}10 to 25 mm/s" in said
    assert f"{MINUS}60 to 150 parts/min" in said
    assert said.count(OVER) == 2
    assert "0.2 to 0.5" in said
    assert any("the direction of travel is not settled" in line for line in said)
    written = vibrafeed.plot(nut).findobj(lambda one: hasattr(one, "get_text"))
    beside = " ".join(" ".join(text.get_text() for text in written).split())
    assert f"mean velocity 11 mm/s, {MINUS}10 to 25 {OVER}" in beside


STUDY = """kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity", "feed_rate"]
[parameters]
frequency = 50
amplitude = {amplitude}
beta = 20
gamma = 2
length = "10 mm"
friction = {{ low = 0.2, high = 0.5 }}
"""


@pytest.mark.parametrize(
    ("amplitude", "lines"),
    [
        ('"0.3 mm"', ["conveying_velocity 11 -10 to 25 mm/s", "direction of travel is not settled",
                      "upper bound"]),
        ('["0.3 mm", "0.4 mm"]', ["conveying_velocity 11 21 mm/s amplitude",
                                  "conveying_velocity_least -10 -3 mm/s amplitude"]),
    ],
)  # fmt: skip
def test_the_console_has_the_digits_that_the_band_leaves(amplitude, lines, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.format(amplitude=amplitude), encoding="utf-8")
    target = tmp_path / "result.nc"
    done = CliRunner().invoke(app, ["run", str(tmp_path / "study.toml"), "-o", str(target)])
    assert done.exit_code == 0, done.output
    said = " ".join(done.output.split())
    for told in lines:
        assert told in said
