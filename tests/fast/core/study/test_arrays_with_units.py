"""Units, dimensions and packing that arrays carry besides their numbers are read, or refused."""

import numpy as np
import pandas
import pint
import pytest
import xarray

import vibrafeed
from refusals import words_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import gather, parse_study

SCENE = {"scene": "rectangle-on-plane", "outputs": ["throw_number"], "beta": 20}
POINT = {"frequency": 50, "amplitude": "0.3 mm"}
UNIT = pint.LazyRegistry(kwargs={"force_ndarray_like": True})
PLAIN = pint.LazyRegistry()  # its thousand units are read in the first test that has one


def array(values, units, **more):
    return xarray.DataArray(values, attrs={"units": units}, **more)


def parameters(**given):
    content = gather(None, {**SCENE, **POINT, **given}, "sweep")
    return parse_study(content).content()["parameters"]


def refusal(**given):
    return words_of(parameters, **given)


COLUMN = pandas.Series([0.1, 0.3])
COLUMN.attrs["units"] = "mm"
MM = [
    array([0.1, 0.3], "mm", dims="amplitude"),
    xarray.DataArray([0.1, 0.3], dims="amplitude", attrs={"unit": "mm"}),
    xarray.DataArray(["0.1", "0.3"], dims="amplitude", attrs={"Units": "mm"}),
    xarray.Variable("amplitude", [0.1, 0.3], {"units": "mm"}),
    COLUMN,
    [array(0.1, "mm"), array(3e-4, "m")],
]
QUANTITIES = [
    lambda: PLAIN.Quantity([0.1, 0.3], "mm"),
    lambda: [0.1 * PLAIN.mm, 0.3 * PLAIN.mm],
    lambda: (0.1 * UNIT.mm, "0.3 mm"),
    lambda: np.array([0.1 * PLAIN.mm, 0.3 * PLAIN.mm], dtype=object),
    lambda: array(PLAIN.Quantity([0.1, 0.3], "mm"), "of no use", dims="amplitude"),
]


@pytest.mark.parametrize("given", [*(lambda one=one: one for one in MM), *QUANTITIES])
def test_lengths_in_millimetres_are_converted(given):
    assert parameters(amplitude=given())["amplitude"] == [1e-4, 3e-4]


def test_turns_a_minute_are_read_as_the_text_is():
    for turned in (array(3000.0, "rpm"), 3000 * PLAIN.rpm, array([3000], "1/min")):
        assert np.ravel(parameters(frequency=turned)["frequency"]) == [50.0]


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        (
            "frequency",
            array([314.159], "rad/s", dims="frequency"),
            "is an angular velocity, not a frequency. Divide the number by 2 pi",
        ),
        (
            "beta",
            array([10.0, 20.0], "degree", dims="amplitude"),
            "the dimension of its array is named 'amplitude'",
        ),
        ("amplitude", array([1.0], "kg"), "'kg' does not measure amplitude"),
        ("amplitude", array([1.0], "1"), "'1' is not a unit"),
        ("amplitude", array([1.0], "seconds since 2000-01-01"), "is not a unit"),
        ("amplitude", np.timedelta64(20, "ms"), "'s' does not measure amplitude"),
        ("amplitude", np.array(["2020-01-01"], "M8[ns]"), "is not a unit"),
        ("amplitude", np.ma.array([1e-4, 2e-4], mask=[False, True]), "None is not a number"),
        (
            "amplitude",
            xarray.DataArray([1, 3], dims="amplitude", attrs={"scale_factor": 1e-4}),
            "is not applied. Open the file with mask_and_scale=True",
        ),
    ],
)
def test_what_does_not_fit_is_refused(name, value, words):
    assert words in refusal(**{name: value})


def test_quantities_that_do_not_fit_are_refused():
    turned, bare = 314.159 * PLAIN.rad / PLAIN.s, 0.3 * PLAIN.dimensionless
    assert "is an angular velocity, not a frequency" in refusal(frequency=turned)
    assert "does not measure amplitude" in refusal(amplitude=bare)
    assert "'gram' does not measure gravity" in refusal(gravity=1 * PLAIN.gram)


def test_an_integer_of_thousands_of_digits_is_refused_in_words():
    for value, place in ((10**5000, ""), ({"start": 1, "stop": 2, "num": 10**5000}, ".num")):
        told = f"parameters.amplitude{place}: the number is larger than 1.8e308. "
        assert refusal(amplitude=value) == f"{told}Write a smaller number."


def test_numbers_in_the_unit_of_a_parameter_stay_numbers():
    content = gather(None, {"beta": array([10, 20], "degree"), "amplitude": array(1e-4, "m")})
    assert content["parameters"] == {"beta": [10, 20], "amplitude": 1e-4}


def test_arrays_along_one_dimension_are_designs_and_no_grid():
    runs = [array([1e-4, 3e-4], "m", dims="run"), array([10.0, 20.0], "degree", dims="run")]
    right = {"amplitude": {"design": [1e-4, 3e-4]}, "beta": {"design": [10, 20]}}
    assert parameters(amplitude=runs[0], beta=runs[1]) == {"frequency": 50.0, **right}
    assert gather(None, {"parameters": {"amplitude": runs[0]}, "beta": runs[1]}) == {
        "parameters": right
    }
    index = pandas.Index(["a", "b"], name="run")
    paired = parameters(
        amplitude=pandas.Series([1e-4, 3e-4], index), beta=pandas.Series([10, 20], index)
    )
    assert paired == {"frequency": 50.0, **right}
    other = array([40.0, 50.0], "Hz", dims="other")
    groups = {"frequency": other, "gamma": array([1.0, 2.0], "degree", dims="other")}
    assert "share the dimensions" in refusal(amplitude=runs[0], beta=runs[1], **groups)
    best = array([10.0, 20.0], "degree", dims="amplitude")
    assert "the dimension of its array is named 'amplitude'" in refusal(beta=best)
    apart = parameters(  # arrays without a name of their dimension, and columns without an index
        amplitude=xarray.DataArray([1e-4, 3e-4]), beta=xarray.DataArray([10.0, 20.0])
    )
    assert len(apart["amplitude"]) == len(apart["beta"]) == 2


def test_ranges_bounds_and_distributions_are_converted():
    mm = PLAIN.mm
    ends = {"start": 0.1 * mm, "stop": array(0.3, "mm")}
    for span in ({**ends, "num": 3}, {**ends, "step": np.float64(0.1) * mm}):
        read = parameters(amplitude=span)["amplitude"]
        assert (read["start"], read["stop"], read["num"]) == (1e-4, 3e-4, 3)
    study = vibrafeed.study(
        kind="optimise", scene="rectangle-on-plane", frequency=50, friction=0.3, beta=20,
        criterion={"kind": "maximise", "output": "conveying_velocity"},
        constraints=[{"output": "throw_number", "upper": PLAIN.Quantity(200, "percent")},
                     {"output": "conveying_velocity", "lower": array(30.0, "mm/s")}],
        variables={"amplitude": {"lower": 0.1 * mm, "upper": array(0.3, "mm")}},
    )  # fmt: skip
    assert study.content()["variables"] == {"amplitude": {"lower": 1e-4, "upper": 3e-4}}
    assert [one.upper or one.lower for one in study.constraints] == [2.0, 0.03]
    study = vibrafeed.study(
        kind="sensitivity", **SCENE, frequency=50,
        uncertain={"amplitude": {"mean": 0.3 * mm, "deviation": array(10.0, "µm")}},
    )  # fmt: skip
    assert study.content()["uncertain"] == {"amplitude": {"mean": 3e-4, "deviation": 1e-5}}


def test_observations_are_columns_of_tables_and_datasets():
    amplitude, velocity = [1e-4, 3e-4], [0.0035, 0.02]
    dataset = xarray.Dataset(
        {"conveying_velocity": ("amplitude", [3.5, 20.0], {"units": "mm/s"})},
        {"amplitude": ("amplitude", [0.1, 0.3], {"units": "mm"}), "beta": 20.0},
    )
    frame = pandas.DataFrame({"amplitude [mm]": [0.1, 0.3], "conveying_velocity [m s-1]": velocity})
    loose = {"amplitude": [0.1 * PLAIN.mm, 0.3 * PLAIN.mm], "conveying_velocity": velocity}
    for observations in (dataset, frame, loose, [{**loose}]):
        study = vibrafeed.study(
            kind="calibrate", scene="rectangle-on-plane", frequency=50,
            observations=observations, unknowns={"friction": {"lower": 0.1, "upper": 0.6}},
        )  # fmt: skip
        assert [run.amplitude for run in study.observations] == amplitude
        assert [run.conveying_velocity for run in study.observations] == velocity
        assert study.observations[1].beta == (20.0 if observations is dataset else None)


def test_rates_convert_arrays_that_carry_a_unit():
    velocity = array([30.0, 60.0], "mm/s", dims="beta", coords={"beta": [10, 20]})
    rate = vibrafeed.parts_per_minute(velocity=velocity, length=12 * PLAIN.mm, gap=0.003)
    np.testing.assert_allclose(rate, [120.0, 240.0], rtol=1e-15)
    back = vibrafeed.velocity_for(
        parts_per_minute=2 / PLAIN.s, length=12 * PLAIN.mm, gap=array(3.0, "mm")
    )
    assert back == pytest.approx(0.03, rel=1e-15)
    with pytest.raises(StudyError, match="does not measure conveying velocity"):
        vibrafeed.parts_per_minute(velocity=array([1.0], "m s-2"), length=0.01)


def test_the_axis_of_a_posterior_may_have_another_unit(tmp_path):
    def read(values, unit):
        density = ("beta", [0.0, 1.0, 0.0])
        beta = array(values, unit, dims="beta")
        xarray.Dataset({"density_beta": density}, {"beta": beta}).to_netcdf(tmp_path / "told.nc")
        told = {"beta": {"calibration": str(tmp_path / "told.nc")}}
        scene = {"scene": "rectangle-on-plane", "outputs": ["throw_number"]}
        return vibrafeed.study(kind="sensitivity", **scene, **POINT, uncertain=told)

    values = read(np.radians([18.0, 20.0, 22.0]), "rad").content()["uncertain"]["beta"]["values"]
    assert values == pytest.approx([18.0, 20.0, 22.0], rel=1e-15)
    with pytest.raises(StudyError, match="'mm' does not measure"):
        read([18.0, 20.0, 22.0], "mm")
