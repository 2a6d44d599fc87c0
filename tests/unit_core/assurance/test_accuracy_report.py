"""The accuracy report: its curves against the theory, its page, what it leaves out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray

from vibrafeed.core.assurance.accuracy import closed_forms, model, motion, optimisers, storage
from vibrafeed.core.assurance.accuracy.cells import random_cells
from vibrafeed.core.assurance.accuracy.curves import (
    STEEP,
    Curve,
    Measured,
    Point,
    fitted_slope,
    tabulate_curves,
)
from vibrafeed.core.assurance.accuracy.families import families_of
from vibrafeed.core.assurance.accuracy.page import PageSection, head_of, sections_of, write_page
from vibrafeed.core.assurance.accuracy.report import measure_study, thinned
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.study.values import Points, Span
from vibrafeed.core.watch import Watch

PLANE = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "variant": "thesis",
    "outputs": ["acceleration_x", "throw_number"],
    "parameters": {
        "frequency": {"start": 20, "stop": 80, "num": 13},
        "amplitude": "0.2 mm",
        "beta": [10, 20, 30],
        "friction": 0.3,
    },
}
TRACK = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "variant": "derived",
    "outputs": ["transport_velocity", "starting_acceleration"],
    "parameters": {
        "frequency": {"start": 20, "stop": 60, "num": 11},
        "amplitude": "0.3 mm",
        "beta": 25,
        "friction": 0.3,
        "radius": "1e6 m",
        "distance": "0.15 mm",
    },
}
MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.3 mm", "num": 21},
        "beta": {"start": 20, "stop": 30, "num": 11},
        "friction": 0.4,
    },
}


def test_random_cells_lie_on_the_grid_whatever_its_size():
    grid = Grid({"beta": Span(0.0, 90.0, 100_000_000), "friction": Points((0.1, 0.2))}, {"mass": 2})
    cells = random_cells(grid, 50, ("beta", "friction", "mass"))
    steps = np.degrees(cells["beta"]) / (90 / (100_000_000 - 1))
    assert np.abs(steps - np.round(steps)).max() < 1e-6
    assert set(cells["friction"]) == {0.1, 0.2}
    again = random_cells(grid, 50, ("beta",))
    assert np.array_equal(cells["beta"], again["beta"])
    huge = Grid({name: Span(1.0, 2.0, 10**5) for name in ("frequency", "radius", "mass")}, {})
    assert random_cells(huge, 3, ("mass",))["mass"].shape == (3,)  # 10^15 cells


def test_random_cells_are_all_different():
    grid = Grid({"beta": Points((1.0, 2.0, 3.0)), "mass": Points((4.0, 5.0))}, {"friction": 0.5})
    cells = random_cells(grid, 50, ("beta", "mass", "friction"))
    assert cells["friction"].tolist() == [0.5] * 6
    assert len(set(zip(cells["beta"], cells["mass"], strict=True))) == 6
    alone = Grid({}, {"mass": 2.0})
    assert random_cells(alone, 50, ("mass",))["mass"].tolist() == [2.0]


def test_slopes():
    cost = [1.0, 2.0, 4.0, 8.0]
    assert fitted_slope([(c, 3 * c**-2) for c in cost]) == pytest.approx(-2)
    assert fitted_slope([(1.0, 1e-2), (1.1, 1e-5), (1.0, 1e-9)]) == STEEP
    # One run in a hundred took twice as long: still steep, and no positive slope.
    assert fitted_slope([(1.0, 1e-2), (1.0, 1e-5), (2.0, 1e-9)]) == STEEP
    assert math.isnan(fitted_slope([(1.0, 1e-9), (2.0, 1e-9)], floor=1e-8))
    # What lies at the reference's error takes no part.
    below = [*((c, 3 * c**-2) for c in cost), (16.0, 1e-3), (32.0, 1e-3)]
    assert fitted_slope(below, floor=1e-2) == pytest.approx(-2)


def test_closed_forms_are_flat_at_rounding():
    measured = closed_forms.measure(prepare_content(TRACK), Watch(), cells=30)
    assert [curve.subject for curve in measured.curves] == TRACK["outputs"]
    for curve in measured.curves:
        short, long = curve.points
        assert (short.setting, long.setting) == ("float32", "float64")
        assert 1e-10 < short.error < 1e-5
        assert long.error < 1e-14
        # The bar of the other accuracy tests; a slope of 0.1 would be a factor of 8 over 29 bits.
        assert max(p.more["conditioned_ulps"] for p in curve.points) < 8
        assert abs(curve.slope) < 0.1
        assert all(point.seconds > 0 for point in curve.points)


@pytest.fixture(scope="module")
def methods() -> Measured:
    return motion.measure(
        prepare_content({**MOTION, "scene": "cylinder-on-plane"}), Watch(), cells=6
    )


def test_methods_of_motion_have_their_order(methods):
    found = {(c.subject, c.method): c for c in methods.curves}
    stepping = found["hopping cells", "time-stepping"]
    # First order over 64-fold steps; landings within steps scatter each end by a factor of some.
    assert -1.6 < stepping.slope < -0.7
    assert found["hopping cells", "events"].points[-1].largest < 1e-8
    # Each time was taken once, in a fraction of a millisecond: only the far ends can be compared.
    assert found["hopping cells", "events"].points[0].seconds < stepping.points[-1].seconds
    (reference,) = found["sliding and hopping cells", "reference"].points
    assert reference.largest < 1e-8


def test_richardson_is_exact_for_an_error_that_is_a_power_of_the_step():
    truth = np.array([0.3, -0.2])

    def run(steps, order):
        velocity = truth + np.array([5.0, -7.0]) / (2 * steps + 1) ** order
        return motion.Means(velocity, np.zeros(2), truth > 0, truth > 0, 1e-3 * steps)

    for order in (1, 2):
        limit = motion._extrapolated(run(200, order), run(400, order), 400, order)
        assert limit.velocity == pytest.approx(truth, rel=1e-12)
        assert limit.seconds == pytest.approx(0.6)


def test_richardson_gains_an_order_where_the_error_is_smooth():
    """As where no event falls within a step."""
    order = 1

    def run(steps):
        # v(h) = v + a h + b h^2, as a smooth error of first order has it.
        h = 1 / (2 * steps + 1)
        return motion.Means(np.array([1 + h + h * h]), np.zeros(1), np.ones(1, bool),
                            np.ones(1, bool), float(steps))  # fmt: skip

    pairs = []
    for steps in (100, 200, 400, 800):
        limit = motion._extrapolated(run(steps // 2), run(steps), steps, order)
        pairs.append((limit.seconds, abs(float(limit.velocity[0]) - 1)))
    assert fitted_slope(pairs) == pytest.approx(-2, abs=0.05)


def result() -> Table:
    values = np.random.default_rng(3).normal(size=5000) * 10.0 ** np.arange(5000).clip(0, 12)
    place = np.arange(5000.0)
    return Table(
        {"beta": TableVariable(("beta",), place, {"units": "degree"})},
        {
            "throw_number": TableVariable(("beta",), values, {"units": "1"}),
            "regime": TableVariable(("beta",), np.ones(5000, np.int8), {"long_name": "regime"}),
        },
        {"Conventions": "CF-1.11"},
    )


def test_what_is_stored_is_within_half_a_quantum():
    measured = storage.measure(result(), Watch())
    for curve in measured.curves:
        for point in curve.points:
            assert point.largest <= point.more["half_quantum"], point.setting
            if curve.method != "compression":
                # More than half of the bound: it is the quantum that is measured.
                assert point.largest > 0.5 * point.more["half_quantum"], point.setting
    sizes = {point.setting: point.more["bytes_per_value"] for point in measured.curves[2].points}
    assert sizes["float64 8 bits level 1"] < sizes["float64 36 bits level 1"]


def test_formulas_are_compared_with_the_motion_of_the_same_parameters():
    content = {**TRACK, "outputs": ["velocity_bound"]}
    content["parameters"] = {
        name: value
        for name, value in TRACK["parameters"].items()
        if name not in ("radius", "distance")
    } | {"alpha": 0}
    content["parameters"].pop("friction")
    assert model.motion_of_sweep(prepare_content(content)) is None  # no friction, no motion
    sweep = prepare_content(TRACK)
    moving = model.motion_of_sweep(sweep)
    assert moving is not None
    measured = model.measure(sweep, moving, Watch(), cells=40)
    (speed, start) = measured.curves
    assert speed.subject == "transport_velocity"
    assert {"ratio", "within_tenth"} <= speed.points[0].more.keys()
    assert "ratio" not in start.points[0].more  # an acceleration is no velocity
    single = measured.cells["transport_velocity"].values / measured.cells["true_velocity"].values
    assert speed.points[0].more["ratio"] == pytest.approx(float(np.median(single)))


def test_rank_correlation():
    x = np.array([1.0, 2.0, 3.0, 4.0])
    assert model.rank_correlation(x, np.exp(x)) == pytest.approx(1)
    assert model.rank_correlation(x, -x) == pytest.approx(-1)
    # Ties have the mean rank; by hand: ranks 0, 1.5, 1.5, 3.
    assert model.rank_correlation(x, np.array([1.0, 2, 2, 3])) == pytest.approx(0.9486832980505138)


def test_what_has_no_value_takes_no_part_in_a_median():
    """Of these cells two thirds have no contact force at all (Painleve)."""
    content = {
        "kind": "sweep",
        "scene": "rectangle-isolated",
        "outputs": ["floor_acceleration", "slip_direction"],
        "parameters": {
            "height": 0.03, "length": 0.02, "pitch": {"start": 1, "stop": 20, "num": 20},
            "pitch_rate": 2, "velocity_along": 1, "friction": [0.5, 4.0, 5.0],
        },
    }  # fmt: skip
    measured = closed_forms.measure(prepare_content(content), Watch())
    for point in measured.curves[0].points:
        assert point.cells == 20
        assert 0 < point.error < point.largest < 1e-6
    assert "60 different random cells of 60" in measured.notes[0]


def test_parameters_that_a_short_float_cannot_hold_are_left_out():
    content = {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["floor_force", "acceleration_x"],
        "parameters": {
            "frequency": 50, "amplitude": "0.01 mm", "beta": 10, "friction": 0.9,
            "mass": [0.1, 1e45],
        },
    }  # fmt: skip
    measured = closed_forms.measure(prepare_content(content), Watch())
    (curve,) = measured.curves
    assert [(point.setting, point.cells) for point in curve.points] == [
        ("float32", 1),
        ("float64", 2),
    ]
    # The part sticks.
    assert "0 or without a value in all these cells: acceleration_x." in measured.notes
    assert "1 of 2" in measured.notes[-1]


def late_after(count: int) -> Watch:
    """Return a watch that lets a number of questions pass."""
    left = iter(range(count))
    return Watch(stop=lambda: next(left, None) is None)


def test_what_the_time_given_left_out_is_told(monkeypatch):
    sweep = prepare_content(TRACK)
    moving = model.motion_of_sweep(sweep)
    assert moving is not None
    none = model.measure(sweep, moving, Watch(stop=lambda: True))
    assert none.notes[0].startswith("0 different random cells of 11")
    assert "The time given ran out: 0 of 11 cells were followed." in none.notes
    (note,) = motion.measure(moving, Watch(stop=lambda: True)).notes
    assert note == "The time given ran out before a cell was found whose motion repeats."
    some = storage.measure(result(), late_after(7))
    assert [len(curve.points) for curve in some.curves] == [6, 1]
    assert some.notes[-1] == "The time given ran out: formats that were not reached are left out."
    part = measure_study(prepare_content(MOTION), name="m", seconds=0.0, only=("storage",))
    assert "The time given ran out: 100% of these cells have no value." in part.measured[0].notes


def test_a_part_at_rest_is_told_apart_from_one_that_does_not_repeat():
    content = {**MOTION, "parameters": {**MOTION["parameters"], "amplitude": [0.0, 1e-7]}}
    (note,) = motion.measure(prepare_content(content), Watch()).notes
    assert note == "No cell of 22 random ones moves and repeats its motion: nothing is measured."


def test_verifying_is_no_part_of_what_is_stored():
    content = {**PLANE, "verify": 5}
    part = measure_study(prepare_content(content), name="plane", only=("storage",))
    assert part.measured[0].curves


LARGE = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "criterion": {"kind": "maximise", "output": "acceleration_x"},
    "parameters": {
        "frequency": {"start": 20, "stop": 100, "num": 100_000},
        "amplitude": {"start": "0.1 mm", "stop": "0.5 mm", "num": 100_000},
        "friction": 0.3,
    },
}


def test_designs_are_drawn_from_a_grid_of_any_size():
    measured = optimisers.measure(prepare_content(LARGE), Watch(), 60.0, ("exact", "search"))
    assert measured.notes[0].startswith("20 different random designs of 10,000,000,000")
    assert [curve.points[0].cells for curve in measured.curves] == [20, 20]


def test_a_method_whose_time_is_over_is_not_repeated(monkeypatch):
    asked = []
    plain = optimisers.METHODS["scipy"]

    def solve(problem, design, scales, watch):
        asked.append(watch.stopped())
        return plain.solve(problem, design, scales, watch)

    methods = {"scipy": replace(plain, solve=solve)}
    monkeypatch.setattr(optimisers, "METHODS", methods)
    measured = optimisers.measure(prepare_content(LARGE), Watch(), 0.0, methods)
    assert asked == [True]
    assert "Stopped before all designs were done: scipy." in measured.notes


def test_optimisers_are_measured_against_the_closed_form():
    content = {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "variant": "thesis",
        "criterion": {"kind": "limit", "limit": 1.0},
        "parameters": {"frequency": 60, "amplitude": "0.2 mm", "friction": [0.3, 0.4]},
    }
    methods = ("exact", "search", "scipy")
    measured = optimisers.measure(prepare_content(content), Watch(), 60.0, methods)
    found = {curve.method: curve.points[0] for curve in measured.curves}
    assert found["exact"].largest == 0
    assert found["scipy"].largest < 1e-7  # its tolerance
    assert found["search"].largest < 1e-8  # likewise
    assert found["search"].more["evaluations"] > found["exact"].more["evaluations"]


def test_a_dataset_comes_back_as_it_was(tmp_path):
    part = measure_study(prepare_content(PLANE), name="plane.toml", only=("closed_forms",))
    path = tmp_path / "accuracy.nc"
    write_netcdf(part.table, path)
    with xarray.open_dataset(path, engine="netcdf4") as read:
        (measured,) = part.measured
        points = [(c, p) for c in measured.curves for p in c.points]
        assert read.sizes["point"] == len(points) == 4
        assert set(read["error"].coords) == {"point", "family", "subject", "method", "setting"} | {
            name for name in read.coords if read[name].ndim == 0
        }
        subject = read["subject"]
        words = str(subject.attrs["flag_meanings"]).split()
        assert [words[v] for v in subject.values] == [c.subject for c, _ in points]
        assert read["error_largest"].values.tolist() == [p.largest for _, p in points]
        assert read["time_per_cell"].attrs["units"] == "s"
        assert {"machine", "date", "versions", "study"} <= read.attrs.keys()


def test_the_page_names_every_curve_and_its_command():
    part = measure_study(
        prepare_content(PLANE), name="configs/plane.toml", only=("closed_forms", "storage")
    )
    more = PageSection("Extremes", "What others add.")
    sections = [*sections_of(part, {"storage": "files.png"}), more]
    page = write_page("Accuracy", head_of(part.table.attributes, "vibrafeed report x"), sections)
    for one in part.measured:
        assert f"`vibrafeed report configs/plane.toml --only {one.family}`" in page
        for curve in one.curves:
            assert f"| {curve.subject if one.family == 'closed_forms' else curve.method} |" in page
            for point in curve.points:
                assert f"| {point.setting} |" in page
    assert "![Files](files.png)" in page
    assert str(part.table.attributes["machine"]) in page
    assert page.endswith("## Extremes\n\nWhat others add.\n")


def test_a_family_that_a_study_has_not_is_an_error():
    with pytest.raises(StudyError, match="optimisers"):
        families_of(prepare_content(PLANE), ["optimisers"])


def test_a_large_grid_is_thinned_evenly():
    grid = Grid({"beta": Span(0.0, 90.0, 901), "alpha": Span(0.0, 90.0, 10)}, {})
    small = thinned(grid, 1000)
    assert small.cells <= 1000
    assert small.shape["alpha"] == 10
    steps = np.diff(small.coordinate("beta"))
    assert steps.max() - steps.min() < 0.11  # one step of the large grid
    assert small.coordinate("beta")[[0, -1]].tolist() == [0.0, 90.0]


def test_a_stop_keeps_what_was_measured():
    part = measure_study(prepare_content(PLANE), name="plane.toml", watch=Watch(stop=lambda: True))
    assert part.measured == ()
    assert part.table.variables["error"].values.size == 0


def test_without_a_cell_that_was_followed_there_are_no_columns_of_cells():
    """A dimension without values has no coordinate, and a file refuses it."""
    for size, names in ((0, set()), (2, {"cell_velocity"})):
        velocity = TableVariable(("cell",), np.empty(size), {"units": "1"})
        table = tabulate_curves([Measured("model", (), (), {"velocity": velocity})], {})
        assert {name for name in table.variables if name.startswith("cell_")} == names
        assert ("cell" in table.coordinates) == bool(size)


def test_words_of_flags_have_no_blanks():
    point = Point("800 steps, twice", 800.0, 1e-3, 1e-2, 1e-3, 4)
    one = Measured("motion", (Curve("motion", "hopping cells", "time-stepping", (point,)),))
    table = tabulate_curves([one], {})
    assert table.coordinates["setting"].attributes["flag_meanings"] == "800_steps_twice"
