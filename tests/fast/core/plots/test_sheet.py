"""One page about a result: its values are those of the file, and nothing lies on another thing."""

import itertools
import re

import pytest
from typer.testing import CliRunner

import vibrafeed
from night import spread
from vibrafeed.app.cli import app
from vibrafeed.core.plots.sheet import PAGE, draw_sheet

STUDIES = {
    "a map": {"amplitude": {"start": 1e-4, "stop": 4e-4, "num": 5}, "beta": [10, 20, 30, 40]},
    "one design": {"amplitude": 3e-4, "beta": 20},
}


def dataset_of(name: str):
    return vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=50, friction=0.3, length=0.02, title="A nut",
        **STUDIES[name], outputs=["conveying_velocity", "feed_rate", "throw_number"],
    )  # fmt: skip


@pytest.mark.parametrize("name", spread(STUDIES, 1))
def test_the_page_says_what_the_file_holds_line_beside_line(name):
    dataset = dataset_of(name)
    page = draw_sheet(dataset)
    page.canvas.draw()
    said = [text.get_text() for text in page.texts]
    assert said[0] == "A nut"
    assert {"50 Hz", "Friction coefficient"} < set(said)
    speeds = 1e3 * dataset.conveying_velocity.values
    ends = [f"{end:.4g}".replace("-", "\N{MINUS SIGN}") for end in (speeds.min(), speeds.max())]
    assert f"{' to '.join(dict.fromkeys(ends))} mm/s" in said
    for words in ("Regime", "does not tip", dataset.attrs["study_sha256"][:16]):
        assert any(words in line for line in said), words
    boxes = [text.get_window_extent() for text in page.texts if text.get_text()]
    boxes.append(page.axes[0].get_window_extent())
    width, height = (inches * page.dpi for inches in PAGE)
    assert min(box.y0 for box in boxes) < 0.08 * height  # the page is used to its foot
    for box in boxes:
        assert min(box.x0, box.y0) >= 0
        assert (box.x1 <= width, box.y1 <= height) == (True, True)
    for one, other in itertools.combinations(boxes, 2):
        wide = min(one.x1, other.x1) - max(one.x0, other.x0)
        high = min(one.y1, other.y1) - max(one.y0, other.y0)
        # The box of a line is a little higher than its letters.
        assert wide <= 0 or high <= 0.2 * min(one.height, other.height)


def test_the_command_writes_a_pdf_and_replaces_nothing_unasked(tmp_path):
    file = tmp_path / "nut.nc"
    dataset_of("one design").to_netcdf(file)
    done = CliRunner().invoke(app, ["sheet", str(file)])
    assert done.exit_code == 0, done.output
    page = file.with_suffix(".pdf").read_bytes()
    assert page.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", page)) == 1
    assert CliRunner().invoke(app, ["sheet", str(file)]).exit_code == 2
    wrong = CliRunner().invoke(app, ["sheet", str(file), "-o", str(tmp_path / "x.docx")])
    assert "End the name of the picture in .png, .svg or .pdf" in wrong.output
