"""The studies of configs run; the figures of chapter 5 are as printed, with the numbers of claims.

docs/generated/thesis-figures.md has the claims. They are computed again here, from the data alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import vibrafeed
from benchmarks.figures.measures import crossing, slope
from benchmarks.figures.studies import changed, fine, path_of
from benchmarks.figures.studies import data as figure
from night import NIGHT, spread
from vibrafeed.core.intake import load_study
from vibrafeed.core.kinds import prepare, run_study, tabulate
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.quantities import REGIMES

TRACK = range(22, 30)


# --- claims on the figures of chapter 5 (docs/generated/thesis-figures.md), as numbers


def place_of_largest(values: xr.DataArray, dim: str) -> float:
    return float(values.where(values == values.max(), drop=True)[dim].item())


def drive(dataset: xr.Dataset) -> xr.DataArray:
    """Return A0 w^2 [m s-2]."""
    return dataset["amplitude"] * (2 * np.pi * dataset["frequency"]) ** 2


def largest_ax_place(dim: str) -> float:
    dataset = changed(1, alpha=fine(0, 2, 0.5), beta=fine(20, 35, 0.002))
    return place_of_largest(dataset["acceleration_x"], dim)


def level_set(dim: str, end: str) -> float:
    """Return an end of the region a_x >= 70.5 m/s2 of figure 5.1 [degree]."""
    a_x = changed(1, alpha=fine(0, 30, 0.02), beta=fine(0, 60, 0.02))["acceleration_x"]
    inside = (a_x >= 70.5).any([d for d in a_x.dims if d != dim])
    return float(getattr(a_x[dim].where(inside), end)())


def largest_physical_ax() -> float:
    dataset = changed(1, variant="physical", beta=fine(0, 90, 0.001), alpha=0)
    return float(dataset["acceleration_x"].max())


def slope_at(number: int, frequency: float) -> float:
    return float(slope(figure(number)["acceleration_x"]).sel(frequency=frequency))


def best_beta(number: int, output: str) -> float:
    """Return the elevation with the largest output, the same at every frequency [degree]."""
    values = changed(number, beta=fine(0, 90, 0.01))[output]
    best = values["beta"].isel(beta=values.argmax("beta"))
    assert float(best.max() - best.min()) < 0.011  # a step of the axis, where neighbours tie
    return float(best.mean())


def line_over_drive(part: int) -> float:
    """Return slope (0) or intercept (1) of a_x over A0 w^2 in figure 5.9; it is a line."""
    dataset = figure(9)
    (y, x) = xr.broadcast(dataset["acceleration_x"], drive(dataset))
    fit = np.polyfit(x.values.ravel(), y.values.ravel(), 1)
    assert np.allclose(np.polyval(fit, x), y, rtol=0, atol=1e-10)
    return float(fit[part])


def drive_at_lift_off() -> float:
    dataset = figure(9)
    return float((drive(dataset) / dataset["throw_number"]).mean())


def small_a_y(dim: str) -> float:
    """Return how far the region |a_y| <= 5 m/s2 of figure 5.11 reaches [degree]."""
    small = abs(figure(11)["acceleration_y"]) <= 5
    return float(small[dim].where(small).max())


def saddle_friction() -> float:
    """Return the friction at which a_y does not change over beta, at the saddle's beta."""
    beta = crossing(slope(figure(13)["acceleration_y"]))
    a_y = changed(13, beta=[beta - 0.01, beta + 0.01])["acceleration_y"]
    return crossing(a_y.isel(beta=1) - a_y.isel(beta=0))


def start_of_motion(variant: str) -> float:
    """Return the frequency above which K is positive at 0.1 mm; K is linear in f^2 [Hz]."""
    K = changed(22, variant=variant)["starting_acceleration"].sel(amplitude=1e-4, method="nearest")
    per_square, constant = np.polyfit(K["frequency"] ** 2, K, 1)
    return float(np.sqrt(-constant / per_square))


def share_of_largest(number: int) -> xr.DataArray:
    v = figure(number)["transport_velocity"]
    return v / v.max()


def amplitude_of_level() -> float:
    """Return the amplitude, beta 0, with the velocity of 1 mm and beta 25 deg [mm]."""
    share = share_of_largest(23)
    level = float(share.isel(amplitude=-1).sel(beta=25))
    return 1e3 * crossing(share.sel(beta=0), level)


def lowest_share_of_box() -> float:
    return float(share_of_largest(25).sel(alpha=slice(0, 45), beta=slice(0, 35)).min())


def best_alpha() -> float:
    v = changed(25, alpha=fine(0, 90, 0.01))["transport_velocity"]
    return place_of_largest(v, "alpha")


def gain_by_lean(variant: str) -> float:
    """Return the gain of velocity from delta 0 to 10 deg [%]."""
    v = changed(26, variant=variant)["transport_velocity"].sel(gamma=0)
    return 100 * float(v.sel(delta=10, method="nearest") / v.sel(delta=0) - 1)


def loss_by_climb() -> float:
    v = figure(26)["transport_velocity"].sel(delta=0)
    return 100 * float(1 - v.sel(gamma=90) / v.sel(gamma=0))


def least_distance(frequency: float, *, all_the_way: bool) -> float:
    """Return the distance from which on the velocity of figure 5.27 falls with friction [m].

    It falls all the way, or is lower at friction 1 than at 0.
    """
    v = changed(27, frequency=frequency, distance=fine(0.19, 0.29, 0.0005))["transport_velocity"]
    falls = (v.diff("friction") < 0).all("friction") if all_the_way else slope(v) < 0
    return float(v["distance"].where(falls).min())


def distance_at_track_speed() -> float:
    """Return the distance at which figure 5.28, gamma 0, reaches the track's speed [mm]."""
    dataset = figure(28).sel(gamma=0)
    return 1e3 * crossing(dataset["transport_velocity"] - dataset["velocity_bound"])


@dataclass(frozen=True)
class Statement:
    """A number of a claim: the figure, the number as its page has it, how to measure it."""

    figure: int
    says: str
    printed: str
    measure: Callable[[], float]

    @property
    def tolerance(self) -> float:
        """Half a unit of the last digit printed; reading errors are far below it."""
        digits = len(self.printed.partition(".")[2])
        return 0.5 * 10.0**-digits


STATEMENTS = [
    # P = 71.06 m/s2. a_x = P cb ca - mu (g - P sb) is largest at alpha 0, beta = atan(0.5).
    Statement(1, "largest a_x", "74.55", lambda: float(figure(1)["acceleration_x"].max())),
    Statement(1, "its alpha", "0", lambda: largest_ax_place("alpha")),
    Statement(1, "its beta", "26.57", lambda: largest_ax_place("beta")),
    # A coarser grid gave 20.5 and 44.8 for two of these ends.
    Statement(1, "a_x >= 70.5, largest alpha", "20.6", lambda: level_set("alpha", "max")),
    Statement(1, "a_x >= 70.5, least beta", "8.2", lambda: level_set("beta", "min")),
    Statement(1, "a_x >= 70.5, largest beta", "44.9", lambda: level_set("beta", "max")),
    # sqrt(P^2 - g^2), theory 12.1; 70.37 was read off a grid that misses lift-off.
    Statement(1, "largest physical a_x", "70.38", largest_physical_ax),
    # da_x/dmu = P sb - g
    Statement(
        3, "a_x: friction turns", "7.93", lambda: crossing(slope(figure(3)["acceleration_x"]))
    ),
    Statement(
        5, "a_x: friction turns", "38.1", lambda: crossing(slope(figure(5)["acceleration_x"]))
    ),
    Statement(5, "da_x/dmu at 50 Hz", "7", lambda: slope_at(5, 50)),
    Statement(5, "da_x/dmu at 80 Hz", "33", lambda: slope_at(5, 80)),
    # atan(mu/ca)
    Statement(7, "best beta", "27.5", lambda: best_beta(7, "acceleration_x")),
    Statement(9, "slope over A0 w^2", "1.0579", lambda: line_over_drive(0)),
    Statement(9, "intercept", "-4.9", lambda: line_over_drive(1)),
    Statement(9, "A0 w^2 at lift-off", "37.9", drive_at_lift_off),
    Statement(11, "least a_y", "-4.9", lambda: float(figure(11)["acceleration_y"].min())),
    Statement(
        11,
        "a_y at (20, 45)",
        "37.4",
        lambda: float(figure(11)["acceleration_y"].sel(alpha=20, beta=45)),
    ),
    Statement(11, "|a_y| <= 5, largest alpha", "8", lambda: small_a_y("alpha")),
    Statement(11, "|a_y| <= 5, largest beta", "16", lambda: small_a_y("beta")),
    Statement(13, "saddle, beta", "7.93", lambda: crossing(slope(figure(13)["acceleration_y"]))),
    Statement(13, "saddle, mu", "0.0384", saddle_friction),
    Statement(
        13, "da_y/dmu at 0", "-9.8", lambda: float(slope(figure(13)["acceleration_y"]).sel(beta=0))
    ),
    Statement(
        13,
        "da_y/dmu at 90",
        "61.3",
        lambda: float(slope(figure(13)["acceleration_y"]).sel(beta=90)),
    ),
    # atan(mu/sa)
    Statement(15, "best beta", "61.1", lambda: best_beta(15, "acceleration_y")),
    Statement(
        17, "a_y: friction turns", "38.1", lambda: crossing(slope(figure(17)["acceleration_y"]))
    ),
    Statement(22, "motion at 0.1 mm", "13.5", lambda: start_of_motion("thesis")),
    Statement(22, "motion at 0.1 mm, derived", "15.3", lambda: start_of_motion("derived")),
    Statement(
        23, "v/v_max", "0.952", lambda: float(share_of_largest(23).isel(amplitude=-1).sel(beta=25))
    ),
    Statement(23, "A0 of that level", "0.91", amplitude_of_level),
    # At high frequency, where gravity counts for little: sqrt(cos 35 deg).
    Statement(
        24,
        "v(35)/v(0)",
        "0.905",
        lambda: float(
            figure(24)["transport_velocity"].isel(frequency=-1).sel(beta=35)
            / figure(24)["transport_velocity"].isel(frequency=-1).sel(beta=0)
        ),
    ),
    Statement(25, "lowest v/v_max of the box", "0.849", lowest_share_of_box),
    Statement(25, "best alpha", "16.7", best_alpha),
    # The wall load at rest, theory 4.3.
    Statement(
        25,
        "wall load",
        "-94.4",
        lambda: float(figure(25)["wall_balance"].sel(alpha=45, beta=20)),
    ),
    Statement(
        26,
        "wall load as printed",
        "-1.7",
        lambda: float(figure(26)["wall_balance"].sel(gamma=0).sel(delta=10, method="nearest")),
    ),
    Statement(26, "gain by lean, %", "0.18", lambda: gain_by_lean("thesis")),
    Statement(26, "gain by lean, derived, %", "-0.18", lambda: gain_by_lean("derived")),
    Statement(26, "loss by climb, %", "3.5", loss_by_climb),
    # Both ends of the printed span: which x lets v fall depends on what is asked and on f.
    Statement(27, "least x, mu 0 to 1", "0.21", lambda: least_distance(120, all_the_way=False)),
    Statement(27, "least x, all mu", "0.26", lambda: least_distance(20, all_the_way=True)),
    Statement(28, "throw number", "3.65", lambda: float(figure(28)["throw_number"].sel(gamma=0))),
    Statement(28, "track speed", "0.21", lambda: float(figure(28)["velocity_bound"])),
    Statement(28, "x at track speed, mm", "0.16", distance_at_track_speed),
]


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda s: f"5.{s.figure} {s.says}")
def test_number_of_a_claim(statement: Statement) -> None:
    assert statement.measure() == pytest.approx(
        float(statement.printed), abs=statement.tolerance, rel=0
    )


# --- the same, as shapes and signs


def test_5_19_angular_acceleration_is_that_of_the_formula_and_three_times_too_large() -> None:
    dataset = figure(19)
    alpha, beta = np.deg2rad(dataset["alpha"]), np.deg2rad(dataset["beta"])
    formula = 4 * drive(dataset) * np.cos(beta) * np.sin(alpha) / dataset["diameter"]
    printed = dataset["angular_acceleration"]
    assert (abs(printed - formula) <= 1e-14 * float(printed.max())).all()
    derived = changed(19, variant="derived")["angular_acceleration"]
    assert (abs(printed - 3 * derived) <= 1e-14 * float(printed.max())).all()


@pytest.mark.parametrize("number", [22, 23, 24, 27, 28])
def test_the_wall_would_have_to_pull_wherever_the_part_moves(number: int) -> None:
    regime = figure(number)["regime"]
    if "beta" in regime.dims:  # a drive straight up, at 90 degrees, does not touch the wall at all
        regime = regime.where(regime.beta != 90, drop=True)
    names = ("wall_lost", "flight_and_wall_lost", "no_motion")
    assert regime.isin([REGIMES[name].value for name in names]).all()


@pytest.mark.parametrize("number", TRACK)
def test_the_effective_distance_of_track_figures_is_marked_as_assumed(number: int) -> None:
    study = load_study(path_of(number))
    assert "distance" in study.values()
    assert "effective distance" in study.notes


def test_the_printed_friction_of_the_wall_is_outside_its_cone() -> None:
    """The wall presses in `derived`; its friction is mu along x and mu along z at once."""
    found = vibrafeed.sweep(
        scene="rectangle-on-track", variant="derived", outputs=["wall_force", "wall_balance"],
        frequency=60, amplitude="1 mm", beta=2, delta=10, friction=0.3, radius="0.8 m",
        width="1.5 mm", height="10 mm", mass="5 g",
    )  # fmt: skip
    assert float(found.wall_balance) > 0
    assert int(found.regime) == REGIMES["outside_cone"].value


CONFIGS = Path(__file__).parents[4] / "configs"
SLOW = {  # seconds each, for the night
    "best-drive-angles", "best-drive-unit", "best-drive-unit-robust", "calibrate-friction",
    "calibrate-rail", "optimise-robust-steps", "optimise-steps",
}  # fmt: skip
STUDIES = [path for path in sorted(CONFIGS.rglob("*.toml")) if NIGHT or path.stem not in SLOW]
NUMBERS = range(1, 30)
BESIDE = {"cycle_time", "quantile", "level", "uncertain"}  # dimensions of no parameter


@pytest.mark.parametrize("path", spread(STUDIES, 10), ids=lambda path: path.stem)
def test_study_runs_and_its_regime_tells_of_every_cell(path: Path) -> None:
    prepared = prepare(load_study(path))
    dataset = tabulate(prepared).to_xarray()
    if "reduced" in dataset.attrs:
        assert all(np.isfinite(dataset[n]).any() for n in dataset.data_vars if "count" not in n)
        return
    if "findings" in dataset.attrs:  # a calibration: its cells are no designs
        assert np.isfinite(dataset["log_density"]).all()
        return
    if "optimum_status" in dataset:
        assert (dataset["optimum_status"] == STATUS["optimal"]).all()
    regime = dataset["regime"]
    assert set(np.unique(regime)) <= set(regime.attrs["flag_values"])
    assert not (regime == REGIMES["not_assessed"].value).any()
    # What has no finite value says so: the model does not hold there, or nothing limits it.
    told = ("unbounded", "no_pass")
    reasons = [r.value for name, r in REGIMES.items() if not r.valid or name in told]
    for name, output in dataset.drop_vars("optimum_gap", errors="ignore").data_vars.items():
        beside = set(output.dims) - BESIDE <= set(regime.dims)
        assert (np.isfinite(output) | (regime.isin(reasons) if beside else False)).all(), name


@pytest.mark.parametrize("number", NUMBERS)
def test_figure_is_as_printed_and_finite(number: int) -> None:
    study, dataset = load_study(path_of(number)), figure(number)
    assert study.title.startswith(f"Figure 5.{number}: ")
    assert study.notes
    assert study.variant == "thesis"
    assert float(dataset["gravity"]) == 9.8
    flying = [REGIMES[name].value for name in ("flight", "flight_and_wall_lost")]
    at_the_edge = abs(dataset["throw_number"] - 1) < 1e-12
    told = dataset["regime"].isin(flying)
    assert (at_the_edge | (told == (dataset["throw_number"] > 1))).all()
    if 90 in dataset.get("gamma", ()):  # an upright floor holds nothing: its throw number is inf
        dataset = dataset.sel(gamma=dataset.gamma != 90)
    assert all(np.isfinite(output).all() for output in dataset.data_vars.values())
    assert all(91 <= size <= 181 for size in dataset.sizes.values())


@pytest.mark.parametrize("surface", range(1, 21, 2))
def test_surface_and_contour_lines_show_the_same_data(surface: int) -> None:
    first, second = load_study(path_of(surface)), load_study(path_of(surface + 1))
    assert first.values() == second.values()
    assert (first.scene, first.outputs) == (second.scene, second.outputs)


@pytest.mark.parametrize(("number", "least"), [(3, 4 / 3), (15, 5**0.5 / 2)])
def test_limiting_friction_of_chapter_3_is_never_below_its_minimum(
    number: int, least: float
) -> None:
    study = load_study(CONFIGS / "figures" / f"fig-3-{number}.toml")
    assert study.title.startswith(f"Figure 3.{number}: ")
    assert study.variant == "thesis"
    dataset = run_study(study)
    limit = dataset["limiting_friction_right"]
    assert float(limit.min()) >= least
    assert np.isinf(limit).equals(dataset["regime"] == REGIMES["unbounded"].value)
