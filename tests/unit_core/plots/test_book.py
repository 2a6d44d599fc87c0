"""The book of charts: its pages, its bytes, its example."""

from __future__ import annotations

import re

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plots.book import FRICTIONS, SLOPES, write_book
from vibrafeed.core.plots.book_intro import Example
from vibrafeed.core.plots.book_page import BETAS, LARGEST, Chart, draw_page, stretches
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.watch import Watch


def test_it_has_no_date_and_no_page_that_is_steeper_than_friction(tmp_path):
    first, again = tmp_path / "first.pdf", tmp_path / "again.pdf"
    for target in (first, again):
        assert write_book(target, frictions=(0.1,), slopes=(6.0, -6.0)) == "1 page"
    assert first.read_bytes() == again.read_bytes()
    assert len(re.findall(rb"/Type /Page\b", first.read_bytes())) == 1
    assert b"CreationDate" not in first.read_bytes()


def test_a_stop_leaves_nothing(tmp_path):
    with pytest.raises(StoppedError):
        write_book(tmp_path / "book.pdf", watch=Watch(stop=lambda: True))
    assert not list(tmp_path.iterdir())


def test_the_curves_are_simulations():
    chart = Chart.of(0.3, 2.0)
    some = np.array([20, 90, 200, 350])
    gamma, frequency = np.deg2rad(2.0), 60.0
    for k in (1, 5):
        beta = np.deg2rad(BETAS[k])
        amplitude = (
            chart.throw[some] * 9.80665 * np.cos(gamma)
            / (np.sin(beta) * (2 * np.pi * frequency) ** 2)
        )  # fmt: skip
        dataset = vibrafeed.simulate(
            scene="rectangle-on-plane", outputs=["conveying_velocity", "efficiency"],
            frequency=frequency, amplitude=amplitude, beta=BETAS[k], gamma=2.0, friction=0.3,
        )  # fmt: skip
        speed = dataset.conveying_velocity.values * frequency / 9.80665
        np.testing.assert_allclose(chart.speed[k][some], speed, rtol=1e-9, atol=1e-12)
        share = dataset.efficiency.values
        np.testing.assert_allclose(chart.coefficient[k][some], share, rtol=1e-9, atol=1e-12)
        np.testing.assert_array_equal(chart.regime[k][some], dataset.regime.values)


def test_the_example_is_a_simulation():
    example = Example()
    motion = vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=example.frequency, amplitude=example.amplitude,
        beta=example.beta, friction=example.friction,
    )  # fmt: skip
    speed, _ = example.readings
    velocity = speed * 9.80665 / example.frequency
    assert velocity == pytest.approx(float(motion.conveying_velocity), rel=1e-9)


def test_every_regime_has_a_line_of_its_own(tmp_path):
    chart = Chart.of(0.3, 0.0)
    names = {name for row, share in zip(chart.regime, chart.coefficient, strict=True)
             for *_, name in stretches(row, share)}  # fmt: skip
    assert names == {"stick", "stick_slip", "slip", "hopping", "hop_after_hop"}
    assert set(np.unique(chart.regime)) == {REGIMES[name].value for name in names}
    figure = draw_page(chart)
    floor, above, below = figure.axes
    assert floor.get_xlim()[1] == above.get_xlim()[0] == 1.0
    assert below.get_xlim() == (0.0, LARGEST)
    figure.savefig(tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").stat().st_size > 10_000


def test_the_shipped_pages_are_within_friction():
    assert min(FRICTIONS) > 0
    assert 0.0 in SLOPES
