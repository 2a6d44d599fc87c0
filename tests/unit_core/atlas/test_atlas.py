"""The atlas: what its four numbers leave out, what it answers, how right that is, its bytes."""

from __future__ import annotations

import numpy as np
import pandas
import pytest
import xarray

import vibrafeed
from vibrafeed.core.atlas.build import ATLAS_VERSION, build
from vibrafeed.core.atlas.cells import exact, regime_of
from vibrafeed.core.atlas.find import STATUS, find
from vibrafeed.core.atlas.lookup import advice, lookup_grid, lookup_rows
from vibrafeed.core.atlas.numbers import AXES, Numbers, numbers_of, rests
from vibrafeed.core.atlas.practice import practical_numbers
from vibrafeed.core.atlas.read import of_table
from vibrafeed.core.atlas.rows import read_rows
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.errors import StoppedError, StudyError, VibrafeedError
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.methods.events import planar_motion
from vibrafeed.core.motion.result import SHARES
from vibrafeed.core.watch import Watch

PART = {"frequency": "50 Hz", "amplitude": "0.4 mm", "beta": 25, "friction": 0.3}


@pytest.fixture(scope="module")
def table():
    return build("coarse")


@pytest.fixture(scope="module")
def atlas(table):
    return of_table(table)


def random_groups(count: int) -> Groups:
    rng = np.random.default_rng(7)
    friction, load = rng.uniform(0.05, 1.2, count), rng.uniform(0.4, 2.0, count)
    return Groups(
        drive_number_along=rng.uniform(-4, 4, count),
        drive_number_normal=rng.uniform(-3.7, 3.7, count) * load,
        gravity_number_along=rng.uniform(-0.9, 0.9, count) * friction * load,
        gravity_number_normal=load,
        friction_static=friction * rng.uniform(1.0, 1.6, count),
        friction_kinetic=friction,
    )


def test_four_numbers_tell_the_whole_motion():
    groups = random_groups(3000)
    motion = planar_motion(groups, tolerance=1e-12, max_periods=1000)
    numbers, unit = numbers_of(groups)
    found = exact(numbers)
    np.testing.assert_allclose(found.velocity * unit, motion.velocity, rtol=0, atol=2e-11)
    back = unit < 0
    turned = {"forward": "backward", "backward": "forward"}
    for name in SHARES:
        mirrored = getattr(motion, turned.get(name, name))
        expected = np.where(back, mirrored, getattr(motion, name))
        np.testing.assert_allclose(getattr(found, name), expected, rtol=0, atol=1e-9)
    assert 0.3 < back.mean() < 0.7


def test_rest_is_where_friction_holds_the_part():
    rng = np.random.default_rng(1)
    numbers = Numbers(*(rng.uniform(a.least, a.largest, 4000) for a in AXES.values()))
    at_rest = exact(numbers).pattern == 1
    assert at_rest.any()
    np.testing.assert_array_equal(rests(numbers), at_rest)


def test_regimes_are_those_of_simulations():
    throws, beta = np.linspace(0.05, 3.7, 60), 25.0
    along = throws / np.tan(np.deg2rad(beta))
    found = regime_of(exact(numbers_of(Groups(along, throws, 0.0, 1.0, 0.35, 0.3))[0]).pattern)
    dataset = vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=50, beta=beta,
        amplitude=throws * 9.80665 / np.sin(np.deg2rad(beta)) / (2 * np.pi * 50) ** 2,
        friction_static=0.35, friction_kinetic=0.3,
    )  # fmt: skip
    np.testing.assert_array_equal(found, dataset.regime.values)
    assert len(set(found.tolist())) >= 4


@pytest.mark.parametrize("everywhere", [False, True])
def test_held_out_cells_lie_within_the_stated_error(atlas, everywhere):
    rng = np.random.default_rng(11)
    if everywhere:
        numbers = Numbers(*(rng.uniform(a.least, a.largest, 6000) for a in AXES.values()))
    else:
        numbers = practical_numbers(rng.random((6000, 7)))
    found, right = find(atlas, numbers), exact(numbers)
    answered = found.status == STATUS["answered"]
    assert answered.mean() > 0.6
    off = np.abs(found.velocity - right.velocity)[answered]
    stated = found.error[answered]
    assert np.mean(off <= stated) >= 0.99
    assert np.all(off <= 10 * stated)
    assert np.median(stated) < 1e-2  # of the drive's speed: no blanket
    assert np.mean((found.pattern == right.pattern)[answered]) >= 0.999
    for name in SHARES:
        off = np.abs(getattr(found, name) - getattr(right, name))[answered]
        assert np.mean(off <= found.share_error[answered]) >= 0.98, name


def test_what_is_not_answered_has_no_number(atlas):
    numbers = practical_numbers(np.random.default_rng(5).random((4000, 7)))
    numbers.throw_number[:10] = 3.73
    numbers.friction_ratio[10:20] = 1.7
    numbers.angle_number[20] = np.inf
    numbers.slope_number[21] = np.nan
    found = find(atlas, numbers)
    np.testing.assert_array_equal(found.status[:22], STATUS["out_of_range"])
    silent = found.status != STATUS["answered"]
    assert (found.status == STATUS["near_border"]).any()
    for name in ("velocity", "error", *SHARES, "share_error"):
        np.testing.assert_array_equal(np.isnan(getattr(found, name)), silent, name)
    assert not found.pattern[silent].any()


def test_nodes_are_exact(atlas):
    rng = np.random.default_rng(2)
    numbers = Numbers(*(rng.choice(axis, 300) for axis in atlas.axes))
    found, right = find(atlas, numbers), exact(numbers)
    answered = found.status == STATUS["answered"]
    assert answered.mean() > 0.95
    off = np.abs(found.velocity - right.velocity)[answered]
    assert off.max() <= 1e-6
    assert found.error[answered].max() <= 2e-6


def test_it_is_made_again_to_the_byte(table, tmp_path):
    first, again = tmp_path / "first.nc", tmp_path / "again.nc"
    write_netcdf(table, first)
    write_netcdf(build("coarse", Watch(threads=1)), again)
    assert first.read_bytes() == again.read_bytes()


def test_it_says_what_it_is(table):
    attributes = table.attributes
    assert attributes["atlas_version"] == ATLAS_VERSION
    assert vibrafeed.__version__ in attributes["source"]
    for words in ("4 t (1 - t)", "velocity number"):
        assert words in attributes["error_model"]
    assert all(axis.definition in attributes["numbers"] for axis in AXES.values())
    assert '"restitution":0' in attributes["study"]


def test_a_stop_leaves_no_part_of_an_atlas():
    with pytest.raises(StoppedError):
        build("coarse", Watch(stop=lambda: True))


def test_other_files_are_refused(table):
    attributes = {**table.attributes, "atlas_version": 99}
    with pytest.raises(VibrafeedError, match="version 99"):
        of_table(type(table)(table.coordinates, table.variables, attributes))
    with pytest.raises(VibrafeedError, match="not an atlas"):
        of_table(type(table)({}, {}, {}))


# --- as a user writes it


def test_a_look_up_is_what_a_simulation_gives(atlas):
    axes = {**PART, "amplitude": ["0.3 mm", "0.35 mm", "0.45 mm"], "gamma": [0, 1.2]}
    found = vibrafeed.lookup(atlas, **axes)
    right = vibrafeed.simulate(scene="rectangle-on-plane", **axes)
    assert found.conveying_velocity.dims == right.conveying_velocity.dims
    answered = found.lookup_status.values == STATUS["answered"]
    assert answered.sum() >= 4
    off = np.abs(found.conveying_velocity - right.conveying_velocity).values[answered]
    assert (off <= found.conveying_velocity_error.values[answered]).all()
    np.testing.assert_array_equal(found.regime.values[answered], right.regime.values[answered])


def test_a_look_up_warns_of_unusual_numbers_as_a_study_does(atlas):
    """Millimetres typed as metres, by themselves or as a column, had gone without a word."""
    with pytest.warns(UserWarning, match="amplitude = 0.3 means 300 mm; usual values are"):
        vibrafeed.lookup(atlas, **{**PART, "amplitude": 0.3})
    rest = {name: value for name, value in PART.items() if name != "amplitude"}
    with pytest.warns(UserWarning, match="amplitude = 0.3 means 300 mm; usual values are"):
        vibrafeed.lookup(atlas, rows={"amplitude": [0.3, 4e-4]}, **rest)


def test_a_drive_that_points_back_is_the_mirror_image(atlas):
    axes = {**PART, "friction": [0.3, 0.5, 0.7], "amplitude": np.linspace(0.1e-3, 0.7e-3, 12)}
    ahead = vibrafeed.lookup(atlas, **{**axes, "gamma": 2})
    back = vibrafeed.lookup(atlas, **{**axes, "beta": 180 - PART["beta"], "gamma": -2})
    assert np.isfinite(ahead.conveying_velocity.values).any()
    np.testing.assert_allclose(back.conveying_velocity, -ahead.conveying_velocity, rtol=1e-9)
    np.testing.assert_allclose(back.forward_fraction, ahead.backward_fraction, atol=1e-9)


def test_what_is_not_answered_can_be_simulated(atlas):
    asked = {**PART, "amplitude": np.linspace(0.1e-3, 2e-3, 40), "gamma": 3}
    found = vibrafeed.lookup(atlas, **asked)
    statuses = set(found.lookup_status.values.tolist())
    assert statuses == {STATUS[n] for n in ("answered", "near_border", "out_of_range")}
    whole = vibrafeed.lookup(atlas, **asked, simulate=True)
    simulated = whole.lookup_status.values == STATUS["simulated"]
    np.testing.assert_array_equal(simulated, found.lookup_status.values != STATUS["answered"])
    right = vibrafeed.simulate(scene="rectangle-on-plane", **asked)
    np.testing.assert_array_equal(
        whole.conveying_velocity.values[simulated], right.conveying_velocity.values[simulated]
    )
    np.testing.assert_array_equal(whole.regime.values[simulated], right.regime.values[simulated])


def test_advice_names_the_number_and_what_to_change(atlas):
    lines = advice(lookup_grid(atlas, {**PART, "amplitude": "4 mm"}))
    assert "the throw_number is 17.01, and the atlas goes from 0.02 to 3.72" in lines[0]
    assert "A0 w^2 sin(beta)" in lines[0]
    assert "--simulate" in lines[-1]
    assert advice(lookup_grid(atlas, PART)) == []
    nothing = advice(lookup_grid(atlas, {**PART, "beta": 0, "friction": 0}))
    assert any("slope_number has no value" in line for line in nothing)
    assert any("throw_number is 0," in line for line in nothing)


def test_rows_are_cases_of_their_own(atlas, tmp_path):
    file = tmp_path / "rows.csv"
    file.write_text("amplitude [mm];beta;friction\n0,4;25;0,3\n0,2;20 deg;0,5\n")
    columns = read_rows(file)
    assert columns["amplitude"] == (0.0004, 0.0002)
    table = lookup_rows(atlas, columns, {"frequency": "50 Hz"})
    single = lookup_grid(atlas, PART)
    speeds = table.variables["conveying_velocity"]
    assert speeds.dims == ("row",)
    assert speeds.values[0] == single.variables["conveying_velocity"].values
    dataset = vibrafeed.lookup(atlas, rows=file, frequency=50)
    np.testing.assert_array_equal(dataset.conveying_velocity.values, speeds.values)
    dataset = vibrafeed.lookup(
        atlas, rows={n: np.array(v) for n, v in columns.items()}, frequency=50
    )
    np.testing.assert_array_equal(dataset.conveying_velocity.values, speeds.values)


def test_columns_of_a_program_are_read_in_the_unit_that_they_carry(atlas):
    metres, degrees = [3e-4, 4e-4], [20.0, 30.0]
    right = vibrafeed.lookup(
        atlas, rows={"amplitude": metres, "beta": degrees}, frequency=50, friction=0.3
    )
    mm = xarray.DataArray([0.3, 0.4], dims="row", attrs={"units": "mm"})
    rad = xarray.DataArray(np.radians(degrees), dims="row", attrs={"units": "rad"})
    frame = pandas.DataFrame({"amplitude [mm]": [0.3, 0.4], "beta": degrees})
    for rows in (frame, {"amplitude": mm, "beta": rad}, {"amplitude": mm, "beta": degrees}):
        found = vibrafeed.lookup(atlas, rows=rows, frequency=50, friction=0.3)
        np.testing.assert_allclose(found.conveying_velocity, right.conveying_velocity, rtol=1e-12)
    with pytest.raises(StudyError, match="'mm' does not measure"):
        vibrafeed.lookup(atlas, rows={"beta": mm}, frequency=50, amplitude=3e-4, friction=0.3)
    with pytest.raises(StudyError, match="both along 'row'"):
        vibrafeed.lookup(atlas, amplitude=mm, beta=rad, frequency=50, friction=0.3)


def test_every_problem_is_told_at_once(atlas, tmp_path):
    with pytest.raises(StudyError) as told:
        lookup_grid(atlas, {**PART, "frequency": "4 km", "restitution": 0.2, "alpha": 5})
    places = [problem.place for problem in told.value.problems]
    assert places == ["parameters.frequency", "parameters.restitution", "parameters.alpha"]
    with pytest.raises(StudyError, match="plain sine"):
        lookup_grid(atlas, {"frequency": 50, "amplitude_along_1": 1e-3, "friction": 0.3})
    with pytest.raises(StudyError, match="friction: it is missing"):
        lookup_grid(atlas, {"frequency": 50, "amplitude": 1e-3, "beta": 20})
    file = tmp_path / "rows.csv"
    file.write_text("amplitude [mm],bet,friction\n0.4,25,0.3\n")
    with pytest.raises(StudyError, match="Did you mean 'beta'"):
        read_rows(file)
    file.write_text("amplitude [mm],friction\n0.4,much\n-1,0.3\n")
    with pytest.raises(StudyError) as told:
        read_rows(file)
    assert [p.place for p in told.value.problems] == ["row 2, amplitude", "row 1, friction"]
    rows = {"amplitude": [4e-4, 3e-4], "restitution": [0.0, 0.1]}
    with pytest.raises(StudyError) as told:
        lookup_rows(atlas, rows, {**PART, "beta": [20, 30]})
    text = str(told.value)
    for words in (
        "parameters.amplitude: amplitude is given twice",
        "do not rebound",
        "parameters.beta",
    ):
        assert words in text
