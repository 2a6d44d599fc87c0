"""The studies of configs run, and those of the figures of chapter 5 are as printed."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.figures.studies import data as figure
from benchmarks.figures.studies import path_of
from night import spread
from vibrafeed.core.intake import load_study
from vibrafeed.core.kinds import prepare, run_study, tabulate
from vibrafeed.core.quantities import REGIMES

CONFIGS = Path(__file__).parents[4] / "configs"
STUDIES = sorted(CONFIGS.rglob("*.toml"))
NUMBERS = range(1, 30)
BESIDE = {"cycle_time", "quantile", "level", "uncertain"}  # dimensions of no parameter


@pytest.mark.parametrize("path", spread(STUDIES, 13), ids=lambda path: path.stem)
def test_study_runs_and_its_regime_tells_of_every_cell(path: Path) -> None:
    prepared = prepare(load_study(path))
    dataset = tabulate(prepared).to_xarray()
    concerned = {*map(str, dataset.data_vars)}
    if prepared.study.kind == "sweep":
        concerned = {name for one in prepared.plan.conditions for name in one.outputs}
    if "reduced" in dataset.attrs:
        assert all(np.isfinite(dataset[n]).any() for n in dataset.data_vars if "count" not in n)
        return
    if "findings" in dataset.attrs:  # a calibration: its cells are no designs
        assert np.isfinite(dataset["log_density"]).all()
        return
    regime = dataset["regime"]
    assert np.issubdtype(regime.dtype, np.integer)
    assert set(np.unique(regime)) <= set(regime.attrs["flag_values"])
    assert not (regime == REGIMES["not_assessed"].value).any()
    # What has no finite value says so: the model does not hold there, or nothing limits it.
    reasons = [r.value for name, r in REGIMES.items() if not r.valid or name == "unbounded"]
    for name, output in dataset.data_vars.items():
        if name not in concerned and not set(output.dims) <= set(regime.dims):
            assert np.isfinite(output).all(), name  # no condition asks of it
            continue
        assert set(output.dims) - BESIDE <= set(regime.dims), name
        assert (np.isfinite(output) | regime.isin(reasons)).all(), name


@pytest.mark.parametrize(
    ("number", "across", "least"), [(3, "height", 4 / 3), (15, "diameter", 5**0.5 / 2)]
)
def test_limiting_friction_of_chapter_3_is_the_formula_and_never_below_its_minimum(
    number: int, across: str, least: float
) -> None:
    study = load_study(CONFIGS / "figures" / f"fig-3-{number}.toml")
    assert study.title.startswith(f"Figure 3.{number}: ")
    dataset = run_study(study)
    limit = dataset["limiting_friction_right"]
    ratio = dataset[across] / dataset["length"]
    kappa = 3 if number == 3 else 12 * (ratio**2 + 1) / (3 * ratio**2 + 4)
    s = np.arctan(ratio) + np.deg2rad(dataset["pitch"])
    formula = (1 + kappa + np.tan(s) ** 2) / (kappa * np.tan(s))
    paradox = (s > 1e-9) & (s < np.pi / 2 - 1e-9)
    assert abs(limit / formula - 1).where(paradox).max() < 1e-12
    assert float(limit.min()) >= least
    assert np.isinf(limit).equals(dataset["regime"] == REGIMES["unbounded"].value)


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
