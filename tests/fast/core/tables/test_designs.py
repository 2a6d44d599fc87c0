"""Designs as rows: one value of each parameter a design, instead of all combinations."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

import vibrafeed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.intake.forms import resolve_files
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.plan.evaluate import Fused, empty_results, evaluate_in_blocks
from vibrafeed.core.plan.trace import traced

STUDY = {"scene": "rectangle-on-plane", "outputs": ["throw_number", "vibration_acceleration"]}
ROWS = [(50.0, 0.3), (40.0, 0.2), (50.0, 0.3), (45.0, 0.5)]
BETA = [20.0, 30.0]


@pytest.fixture(scope="module")
def each():
    """Return the results of the designs, computed one by one."""
    ways = [vibrafeed.sweep(**STUDY, beta=BETA, frequency=f, amplitude=f"{a} mm") for f, a in ROWS]
    return xarray.concat(ways, "design", compat="override", coords="minimal", join="override")


def study(**designs):
    """Return the content of a study with designs."""
    return {"kind": "sweep", **STUDY, "parameters": {"beta": BETA}, **designs}


def ways(folder):
    """Yield the designs in every way to write them."""
    rows = [{"frequency": f, "amplitude": f"{a} mm"} for f, a in ROWS]
    yield study(designs=rows)
    yield study(designs={"rows": rows})
    lists = {"frequency": [f for f, _ in ROWS], "amplitude": [f"{a} mm" for _, a in ROWS]}
    zipped = study(designs={"zip": ["frequency", "amplitude"]})
    yield {**zipped, "parameters": {**zipped["parameters"], **lists}}
    table = folder / "designs.csv"
    lines = ["design;frequency_rpm;amplitude [um];Bemerkung"]
    lines += [f"{k};{60 * f:g};{1e3 * a:g};gut" for k, (f, a) in enumerate(ROWS)]
    table.write_text("\n".join(lines))
    yield study(designs={"file": str(table)})


def test_designs_are_computed_row_by_row(each, tmp_path):
    for content in ways(tmp_path):
        found = vibrafeed.sweep(content)
        assert found.throw_number.dims == ("beta", "design")
        np.testing.assert_array_equal(found.throw_number, each.throw_number.T)
        np.testing.assert_array_equal(found.vibration_acceleration, each.vibration_acceleration)
        np.testing.assert_array_equal(found.frequency, [f for f, _ in ROWS])
        np.testing.assert_array_equal(found.design, [1, 2, 3, 4])


def test_arrays_along_one_dimension_are_designs(each):
    frequency, amplitude = np.array(ROWS).T
    found = vibrafeed.sweep(
        **STUDY,
        beta=BETA,
        frequency=xarray.DataArray(frequency, dims="run"),
        amplitude=xarray.DataArray(amplitude, dims="run", attrs={"units": "mm"}),
    )
    np.testing.assert_array_equal(found.throw_number, each.throw_number.T)
    again = vibrafeed.sweep(
        **STUDY, beta=BETA, frequency=found.frequency, amplitude=found.amplitude
    )
    xarray.testing.assert_identical(again.throw_number, found.throw_number)


def test_motions_and_optima_take_designs():
    rows = [{"frequency": 50, "amplitude": "0.3 mm"}, {"frequency": 40, "amplitude": "0.2 mm"}]
    one = {"scene": "rectangle-on-plane", "beta": 20, "friction": 0.3}
    found = vibrafeed.simulate(**one, outputs=["conveying_velocity"], designs=rows)
    for row, speed in zip(rows, found.conveying_velocity.values, strict=True):
        alone = vibrafeed.simulate(**one, outputs=["conveying_velocity"], **row)
        assert float(alone.conveying_velocity) == speed


KINDS = {
    "optimise": {
        "variant": "thesis", "criterion": {"kind": "maximise", "output": "acceleration_x"},
        "friction": [0.3, 0.4], "outputs": ["throw_number"],
    },
    "sensitivity": {
        "beta": 20, "outputs": ["throw_number"], "samples": 256,
        "uncertain": {"gamma": {"lower": 0, "upper": 2}},
    },
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_other_kinds_take_designs(kind):
    study, run = {"scene": "rectangle-on-plane", **KINDS[kind]}, getattr(vibrafeed, kind)
    rows = [{"frequency": f, "amplitude": f"{a} mm"} for f, a in ROWS[:2]]
    frequency, amplitude = np.array(ROWS[:2]).T
    arrays = {"frequency": frequency, "amplitude": 1e-3 * amplitude}
    arrays = {name: xarray.DataArray(one, dims="run") for name, one in arrays.items()}
    both = run(**study, designs=rows), run(**study, **arrays)
    for found in both:
        assert found.frequency.dims == found.amplitude.dims == ("design",)
        for number, row in enumerate(rows, 1):
            xarray.testing.assert_allclose(
                found.sel(design=number).drop_vars("design"), run(**study, **row), rtol=1e-12
            )


def test_designs_of_a_calibration_are_its_candidates():
    runs = {"frequency": [45, 50, 55], "track_amplitude": [1e-4, 2e-4, 3e-4], "error": "5 %"}
    study = {
        "scene": "linear-drive-unit", "moving_mass": 10, "base_mass": 30, "points": 1_000,
        "ring_down_frequency": 60, "damping_ratio": 0.02, "observations": {**runs, "load_mass": 0},
        "unknowns": {"drive_force": {"lower": 10, "upper": 900}},
    }  # fmt: skip
    rows = [{"frequency": 50, "load_mass": 0}, {"frequency": 58, "load_mass": "1 kg"}]
    found = vibrafeed.calibrate(**study, designs=rows)
    assert found.information.dims == ("candidate_design",)
    assert found.candidate_frequency.dims == ("candidate_design",)
    grid = {"frequency": [50, 58], "load_mass": [0, 1]}
    whole = vibrafeed.calibrate(**study, candidates=grid)
    np.testing.assert_allclose(found.expected, np.diag(whole.expected), rtol=1e-12)
    alone = vibrafeed.calibrate(**study, candidates={"frequency": 58, "load_mass": 1})
    assert float(alone.expected) == pytest.approx(float(whole.expected[1, 1]), rel=1e-12)


@pytest.fixture(scope="module")
def prepared():
    """Return a study of 500 designs of three parameters over two axes."""
    rng = np.random.default_rng(1)
    rows = {
        "frequency": rng.uniform(30, 60, 500),
        "amplitude": rng.uniform(1e-4, 5e-4, 500),
        "gravity": rng.uniform(9.7, 9.9, 500),
    }
    parameters = {name: {"design": values.tolist()} for name, values in rows.items()}
    parameters |= {"beta": BETA, "gamma": {"start": 0, "stop": 5, "num": 7}}
    return prepare_content({**study(), "parameters": parameters})


def test_blocks_and_compiled_loops_agree(prepared):
    plan, grid = prepared.plan, prepared.grid
    by_blocks, fused = empty_results(plan, grid), empty_results(plan, grid)
    evaluate_in_blocks(plan, grid, by_blocks, block_cells=100)
    Fused(plan, traced(plan, grid.along), grid).run(fused)
    for name, values in by_blocks.items():
        np.testing.assert_array_equal(values, fused[name])
    part = grid.within({"design": (100, 200)})
    some = empty_results(plan, part)
    evaluate_in_blocks(plan, part, some)
    at = prepared.dims["throw_number"].index("design")
    np.testing.assert_array_equal(
        some["throw_number"], by_blocks["throw_number"].take(range(100, 200), axis=at)
    )


def test_a_result_says_its_designs_and_its_study_runs_again(prepared):
    table = outline(prepared)
    assert table.coordinates["frequency"].dims == ("design",)
    assert table.links("throw_number")["coordinates"].startswith("frequency amplitude")
    again = parse_study(prepared.study.content())
    assert again.key() == prepared.study.key()


def test_designs_are_verified_and_reduced():
    rows = [{"frequency": f, "amplitude": f"{a} mm"} for f, a in ROWS]
    found = vibrafeed.sweep(study(designs=rows), verify=5)
    assert found.attrs["verified_cells"] == 5
    reduced = vibrafeed.sweep(
        study(designs=rows), reduce={"over": ["design"], "statistics": ["max"]}
    )
    whole = vibrafeed.sweep(study(designs=rows))
    np.testing.assert_array_equal(reduced.throw_number_max, whole.throw_number.max("design"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            study(designs=[{"frequency": 50}, {"amplitude": 1e-4}]),
            "designs row 2: this design has no freq",
        ),
        (study(designs=[{"beta": 50}]), "parameters.beta: beta is given twice"),
        (study(designs={"zip": ["frequency"]}), "designs.zip: frequency is not a list of values"),
        (study(designs={"zap": ["frequency"]}), "designs: they are neither a table nor lists"),
        (study(designs=[]), "designs: the list of designs is empty"),
        (
            study(parameters={"frequency": {"design": [1, 2]}, "amplitude": {"design": [1e-4]}}),
            "designs: the parameters have different numbers of values: 2 of frequency, 1 of amp",
        ),
        (study(designs=[{"frequency": "5 kg", "amplitude": 1}]), "parameters.frequency: 'kg' does"),
        (study(designs={"file": "none.csv"}), "designs: none.csv cannot be read"),
    ],
)
def test_designs_that_are_none(content, message):
    with pytest.raises(StudyError) as caught:
        prepare_content(content, files=True)
    assert message in str(caught.value)


def test_the_service_reads_no_file_of_designs(tmp_path):
    content = [*ways(tmp_path)][-1]
    with pytest.raises(StudyError, match=r"designs.file: the service cannot read files"):
        prepare_content(content)
    sent = resolve_files(content, "curl", tmp_path)
    assert sent["designs"][1] == {"frequency": "2400 rpm", "amplitude": "200 um"}
    assert prepare_content(sent).cells == 8
