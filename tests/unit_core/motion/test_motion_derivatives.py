"""Derivatives of planar motion against differences, against many digits, and against laws."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from benchmarks.derivatives import BAR, SURE, derived, errors, random_cells, repeating
from point_slopes import motion_sensitivities
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.motion.derivatives import derivatives_at
from vibrafeed.core.motion.groups import Groups, cells_of
from vibrafeed.core.motion.kernels.planar.derive import KINK
from vibrafeed.core.motion.kernels.planar.slope_tables import DERIVED
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.plan.derivatives import DERIVATIVE_STATUS
from vibrafeed.core.plan.plan import plan_scene

PLANE = "rectangle-on-plane"
POINT = {
    "frequency": 50.0, "amplitude": 3e-4, "beta": 0.5, "gamma": 0.02, "friction": 0.3,
    "gravity": 9.81,
}  # fmt: skip


def cell(c, s, friction=0.3, static=None, restitution=0.0, gs=0.02):
    static = friction if static is None else static
    groups = Groups(c, s, gs, 1.0, static, friction, restitution)
    return cells_of(groups, tolerance=1e-12, max_periods=1000.0)[0]


# --- the kernel


def test_random_cells_against_differences_inside_one_regime():
    cells = repeating(random_cells(150, 5))
    judged = 0
    for error, unsure, _, found in errors(cells).values():
        good = (found.margin > KINK)[:, None] & (unsure < SURE)
        assert not (good & ~(error <= BAR)).any()
        judged += good.sum()
    assert judged > 4_500  # of some 135 cells, 7 groups and 7 fields; at e = 0 no two sides


def test_results_are_those_of_the_plain_kernel_to_the_last_bit():
    from benchmarks.derivatives import plain

    cells = random_cells(300, 6)
    table, status = plain(cells)
    found = derived(cells)
    np.testing.assert_array_equal(table, found.results)
    np.testing.assert_array_equal(status, found.status)


def test_shares_add_up_and_so_do_energies():
    found = derived(repeating(random_cells(300, 7)))
    sure = found.margin > KINK
    slopes = found.slopes[sure]
    shares = slopes[:, [DERIVED.stick, DERIVED.forward, DERIVED.backward, DERIVED.flight]]
    size = np.abs(shares).max(axis=1)
    assert (np.abs(shares.sum(axis=1)) <= 1e-12 + 1e-11 * size).all()


def test_energy_of_the_drive_is_the_mean_of_its_push():
    # The kernel takes it from the balance; here each energy is judged by itself.
    from vibrafeed.core.motion.kernels.arrays import NEVER
    from vibrafeed.core.motion.planar import spend_cells

    cells = repeating(random_cells(60, 8))
    found, h = derived(cells), 1e-5

    def spent(cells):
        table, status = np.full((len(cells), 3), np.nan), np.zeros(len(cells), np.int8)
        spend_cells(cells, table, status, NEVER)
        return table

    near = found.margin > 1e-3
    for group in range(4):
        step = np.zeros_like(cells)
        step[:, group] = h
        difference = (spent(cells + step) - spent(cells - step)) / (2 * h)
        slopes = found.slopes[:, DERIVED.friction :, group]
        off = np.abs(slopes - difference)[near] / (1 + np.abs(difference[near]))
        assert np.median(off) < 1e-9
        assert np.quantile(off, 0.9) < 1e-6


@pytest.mark.parametrize("restitution", [1e-6, 1e-5])
def test_without_restitution_the_derivative_is_that_from_above(restitution):
    # Shrinking hops take a time of the first order in e, and move the part by the second.
    row = cell(1.4, 1.3)
    found = derived(row)
    here, above = found.results[0], derived(cell(1.4, 1.3, restitution=restitution)).results[0]
    slope = found.slopes[0, :, 6]
    assert found.margin[0] > KINK
    assert slope[DERIVED.flight] > 0
    assert abs((above[0] - here[0]) / restitution - slope[DERIVED.velocity]) < 50 * restitution
    # What was resolved of the hops is less than all of them.
    assert 0 < (above[6] - here[6]) / restitution <= slope[DERIVED.flight] * (1 + 1e-3)


def hopping(count, seed, more):
    """Return random cells without rebound that land once a period; static friction up to `more`."""
    pick = np.random.default_rng(seed)
    throw, beta = pick.uniform(1.05, 3.2, count), np.radians(pick.uniform(8, 75, count))
    gamma, kinetic = np.radians(pick.uniform(-5, 5, count)), pick.uniform(0.1, 0.9, count)
    normal = throw * np.cos(gamma)
    columns = (
        normal / np.tan(beta), normal, np.sin(gamma), np.cos(gamma),
        kinetic * pick.uniform(1.0, more, count), kinetic, 0.0,
    )  # fmt: skip
    return cells_of(Groups(*columns), tolerance=1e-12, max_periods=1000.0)[0]


@pytest.mark.parametrize(("more", "jumps"), [(1.0, 0), (1.6, 5)])
def test_the_least_restitution_moves_a_mean_as_the_derivative_at_none_says(more, jumps):
    """Velocity and shares over random cells, by steps of 1e-6, and of half of it."""
    cells = hopping(200, 1, more)
    here, steps = derived(cells), []
    for step in (1e-6, 5e-7):
        near = cells.copy()
        near[:, 6] = step
        there = derived(near)
        # Velocity, and the four shares, of the results; hops are whole down to 1e-7.
        steps.append((there.results[:, [0, 3, 4, 5, 6]] - here.results[:, [0, 3, 4, 5, 6]]) / step)
    told = [
        DERIVED.velocity,
        DERIVED.stick,
        DERIVED.forward,
        DERIVED.backward,
        DERIVED.flight,
    ]
    slopes = here.slopes[:, told, 6]
    sure = (here.margin > 1e-5) & (here.status == STATUS["periodic"])
    jump = np.isnan(slopes[:, 0])
    assert sure.sum() > 100
    assert jump.sum() >= jumps
    assert np.isfinite(here.slopes[jump][:, 0, :6]).all()  # by all else it has a derivative
    good = sure & ~jump
    assert (np.abs(slopes[good, 0]) > 0.01).sum() > 20  # of the first order, not of the second
    # The second order: some 50 times the step, more for shares beside an edge.
    off = np.abs(steps[0] - slopes)[good]
    assert (off[:, 0] <= 5e-3).all()
    assert (np.quantile(off, 0.9, axis=0) <= 1e-3).all()
    # Of a jump half the step makes as much: its quotient is twice as large, else it would be equal.
    apart = np.abs(steps[1] - 2 * steps[0])[jump & sure, 0] / np.abs(steps[1])[jump & sure, 0]
    assert (apart < 0.5).all()


def test_energies_move_with_the_least_restitution_as_the_derivative_at_none_says():
    """Impacts of small hops take what the floor would rub in their time, to the first order."""
    from vibrafeed.core.motion.kernels.arrays import NEVER
    from vibrafeed.core.motion.planar import spend_cells

    def spent(cells):
        table, status = np.full((len(cells), 3), np.nan), np.zeros(len(cells), np.int8)
        spend_cells(cells, table, status, NEVER)
        return table

    cells = hopping(200, 2, 1.0)
    here, near, step = derived(cells), cells.copy(), 1e-6
    near[:, 6] = step
    slopes = here.slopes[:, [DERIVED.friction, DERIVED.impact, DERIVED.drive], 6]
    sure = (here.margin > 1e-5) & (here.status == STATUS["periodic"])
    off = np.abs((spent(near) - spent(cells)) / step - slopes)[sure]
    assert sure.sum() > 100
    assert (np.abs(slopes[sure, :2]) > 0.01).mean() > 0.5
    assert (np.quantile(off, 0.9, axis=0) <= 1e-3).all()


def test_where_the_least_restitution_jumps_there_is_no_derivative_by_it_alone():
    # 51.2060 mm/s at 0, 51.1451 mm/s at 1e-12 to 1e-6 (`tests/laws/test_planar_means.py`).
    point = {
        "frequency": 63.083, "amplitude": 0.184447e-3, "beta": math.radians(39.096),
        "friction_static": 1.0514, "friction_kinetic": 0.7356, "restitution": 0.0,
    }  # fmt: skip
    names = ["restitution", "beta"]
    found = motion_sensitivities(PLANE, None, ["conveying_velocity"], point, names)
    by_restitution = found["conveying_velocity", "restitution"]
    assert math.isnan(by_restitution.derivative)
    assert "kink" in by_restitution.note
    assert found["conveying_velocity", "beta"].note == ""


def test_a_landing_that_stops_a_slip_leaves_one_of_the_first_order():
    # It was told 0, as exact; differences give 0.1175554 m/s (an independent quad solver, too).
    point = {
        "frequency": 50.0, "amplitude": 0.5e-3, "beta": math.radians(40.0), "friction": 0.6,
        "restitution": 0.0,
    }  # fmt: skip
    found = motion_sensitivities(PLANE, None, ["conveying_velocity"], point, ["restitution"])
    one = found["conveying_velocity", "restitution"]
    assert one.derivative == pytest.approx(0.1175554, abs=5e-8)
    assert (one.error, one.note) == (0.0, "")


@pytest.mark.parametrize(
    "row",
    [
        cell(2.0, 1.0),  # throw number 1: hops begin
        cell(0.02 + 0.3 * 1.0, 0.0),  # friction just holds
        cell(2.0, math.sqrt(1 + math.pi**2)),  # a hop as long as the period: it lands where n = 0
        cell(1.5, 0.5, friction=0.02 * (1 + 1e-12)),  # it nearly slides down for ever
    ],
)
def test_at_an_edge_there_is_none(row):
    found = derived(row)
    periodic = found.status[0] in (STATUS["periodic"], STATUS["at_rest"])
    assert not periodic or found.margin[0] <= KINK


def border(one, other, kind):
    """Return the two neighbouring floats between two rows where `kind` of their motion changes."""
    low, high = 0.0, 1.0
    first = kind(one)
    while True:
        middle = (low + high) / 2
        if middle in (low, high):
            return one + (other - one) * low, one + (other - one) * high
        if kind(one + (other - one) * middle) == first:
            low = middle
        else:
            high = middle


@pytest.mark.parametrize(
    ("one", "other", "column"),
    [
        (cell(0.5, 0.1), cell(1.5, 0.1), 3),  # the part begins to stick no more
        (cell(0.5, 0.9), cell(0.9, 0.9), 5),  # it begins to slide back
        (cell(1.5, 1.1, restitution=0.3), cell(1.5, 2.5, restitution=0.3), 5),
        (cell(1.5, 3.5), cell(1.5, 4.0), 11 - 1),  # the period doubles
    ],
)
def test_next_to_a_border_nothing_is_told_that_belongs_to_neither_side(one, other, column):
    """Derivatives close to a border are flagged, or those of their side some way off."""

    def kind(row):
        results = derived(row).results[0]
        return results[column] if column == 10 else results[column] > 0

    assert kind(one) != kind(other)
    below, above = border(one, other, kind)
    way = other - one
    for start, side in ((below, -1), (above, 1)):
        far = derived(start + side * 1e-6 * way)
        for off in (0.0, 1e-15, 1e-13, 1e-11, 1e-9):
            near = derived(start + side * off * way)
            if near.margin[0] <= KINK:
                continue
            here, there = near.slopes[0, 0], far.slopes[0, 0]
            alike = np.abs(here - there) <= 0.05 * (1e-2 + np.abs(there))
            # Where a landing grazes the floor slopes grow without bound on the way to it.
            grows = np.abs(here).max() > np.abs(there).max() > 1e3
            assert grows or alike.all()


# --- through the equations


def test_two_sided_sliding_against_its_closed_form():
    # gamma = 0, theory 13.8 (i), derived by mu with 40 digits.
    beta, mu, P, w, g = 0.3, 0.2, 30.0, 300.0, 9.81
    mp = mpmath.mp

    def speed(m):
        q = m * mp.tan(beta)
        sine = mp.pi * m * g / (2 * P * mp.cos(beta) * mp.cos(mp.pi * q / 2))
        bracket = (1 + q * q) * mp.sin(mp.pi * q / 2) + 2 * q / mp.pi * mp.cos(mp.pi * q / 2)
        return P / w * mp.cos(beta) * mp.sqrt(1 - sine * sine) * bracket

    point = {
        "frequency": w / (2 * math.pi), "amplitude": P / w**2, "beta": beta, "gravity": g,
        "friction": mu,
    }  # fmt: skip
    told = motion_sensitivities(PLANE, None, ["conveying_velocity"], point, ["friction"])
    one = told["conveying_velocity", "friction"]
    with mp.workdps(40):
        exact = float(mp.diff(speed, mpmath.mpf(mu)))
    assert one.derivative == pytest.approx(exact, rel=1e-12)
    assert (one.error, one.note) == (0.0, "")


def test_scaling_binds_the_exponents():
    # (A, f, g) -> (A, s f, s^2 g) gives s v; (s A, f, s g) gives s v (theory 13.16).
    names = ("frequency", "gravity", "amplitude")
    system, method, _ = choose_system(PLANE, None, POINT)
    outputs = ("conveying_velocity", "landing_speed", "hop_height", "flight_fraction")
    plan = plan_scene(system, method, outputs, POINT)
    rng = np.random.default_rng(3)
    cells = {
        **POINT,
        "amplitude": rng.uniform(5e-5, 6e-4, 200),
        "friction": rng.uniform(0.1, 0.6, 200),
        "beta": rng.uniform(0.1, 0.8, 200),
    }
    found = derivatives_at(plan, cells, names)
    for output, of_f, of_a in zip(outputs, (1, 1, 0, 0), (1, 1, 1, 0), strict=True):
        derived_by = {name: found[output, name] for name in names}
        one = derived_by["gravity"]
        sure = (one.status == DERIVATIVE_STATUS["exact"]) & (one.value != 0)
        assert sure.sum() > 50
        f, g, a = (
            derived_by[name].logarithmic(np.broadcast_to(cells[name], (200,)))[sure]
            for name in names
        )
        size = 1 + np.abs(f) + np.abs(g) + np.abs(a)
        assert (np.abs(f + 2 * g - of_f) <= 1e-12 * size).all()
        assert (np.abs(a + g - of_a) <= 1e-12 * size).all()


def test_a_grid_tells_cell_by_cell_what_points_tell():
    system, method, _ = choose_system(PLANE, None, POINT)
    outputs = ("conveying_velocity", "efficiency", "drive_power")
    plan = plan_scene(system, method, outputs, POINT)
    throws = np.array([0.3, 1.0, 1.5, 3.5])
    w = 2 * math.pi * POINT["frequency"]
    amplitudes = throws * POINT["gravity"] * math.cos(POINT["gamma"])
    amplitudes = amplitudes / (w * w * math.sin(POINT["beta"]))
    found = derivatives_at(plan, {**POINT, "amplitude": amplitudes}, ["amplitude", "gamma"])
    assert (found["efficiency", "gamma"].status == DERIVATIVE_STATUS["exact"]).tolist() == [
        True, False, True, True,
    ]  # fmt: skip
    for place, amplitude in enumerate(amplitudes.tolist()):
        point = {**POINT, "amplitude": amplitude}
        for key, one in motion_sensitivities(PLANE, None, outputs, point, ["gamma"]).items():
            np.testing.assert_equal(found[key].slope[place], one.derivative)


def test_a_push_across_presses_to_the_wall_and_has_no_two_sides():
    point = {**POINT, "alpha": 0.0}
    on_plane = motion_sensitivities(PLANE, None, ["conveying_velocity"], point, ["alpha"])
    assert on_plane["conveying_velocity", "alpha"].derivative == 0.0
    point["delta"] = 0.0
    on_track = motion_sensitivities(
        "rectangle-on-track", None, ["conveying_velocity"], point, ["alpha", "friction"]
    )
    assert "kink" in on_track["conveying_velocity", "alpha"].note
    assert on_track["conveying_velocity", "friction"].note == ""


# --- as a key of a study

STUDY = {
    "kind": "simulate", "scene": PLANE, "outputs": ["conveying_velocity", "motion_status"],
    "sensitivities": True,
    "parameters": {
        "frequency": 50, "amplitude": ["0.1 mm", "0.3 mm"], "beta": "25 deg", "friction": 0.3,
    },
}  # fmt: skip


def told(**changes):
    return tabulate(prepare_content({**STUDY, **changes})).to_xarray()


def test_a_simulation_gives_derivatives_with_units_and_how_they_were_found():
    found = told()
    of_beta = found.derivative_conveying_velocity_by_beta
    assert of_beta.attrs["units"] == "m s-1 degree-1"
    assert of_beta.dims == ("amplitude",)
    plain = told(sensitivities=None)
    more = {**STUDY["parameters"], "beta": "25.001 deg"}
    step = told(parameters=more, sensitivities=False).conveying_velocity - plain.conveying_velocity
    np.testing.assert_allclose(of_beta, step / 1e-3, rtol=1e-3)
    exponent = found.sensitivity_conveying_velocity_to_beta
    np.testing.assert_allclose(exponent, of_beta * 25 / found.conveying_velocity, rtol=1e-12)
    assert (found.derivative_status_beta == DERIVATIVE_STATUS["exact"]).all()
    assert "exact" in found.derivative_status_beta.attrs["flag_meanings"]
    assert not [name for name in found if "motion_status_" in name]
    np.testing.assert_array_equal(found.conveying_velocity, plain.conveying_velocity)


def test_derivatives_by_a_default_and_in_few_names():
    found = told(sensitivities=["gravity"])
    assert set(found) == {
        "conveying_velocity", "motion_status", "regime", "derivative_status_gravity",
        "derivative_conveying_velocity_by_gravity", "sensitivity_conveying_velocity_to_gravity",
    }  # fmt: skip
    assert found.derivative_conveying_velocity_by_gravity.attrs["units"] == "m s-1 m-1 s2"
    assert np.isfinite(found.sensitivity_conveying_velocity_to_gravity).all()


def test_motion_in_space_is_derived_by_differences():
    parameters = {**STUDY["parameters"], "alpha": "5 deg", "amplitude": "0.3 mm"}
    found = told(parameters=parameters, sensitivities=["friction"])
    assert found.derivative_status_friction == DERIVATIVE_STATUS["differences"]
    assert np.isfinite(found.derivative_conveying_velocity_by_friction)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sensitivities": ["fricton"]}, "friction"),
        ({"sensitivities": []}, "a list of parameter names"),
        ({"sensitivities": "friction"}, 'such as ["friction"]'),
        ({"outputs": ["motion_status"]}, "none of the requested outputs"),
        (
            {"parameters": {**STUDY["parameters"], "amplitude": {
                "start": 1e-4, "stop": 1e-3, "num": 600_000}}},
            "2,400,000 derivatives",
        ),
        (
            {"parameters": {**STUDY["parameters"], "alpha": "5 deg", "amplitude": {
                "start": 1e-4, "stop": 1e-3, "num": 2_000}}},
            "10,000 others are too many",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_derived_is_told(changes, words):
    with pytest.raises(StudyError, match=words.replace("[", r"\[")):
        prepare_content({**STUDY, **changes})


def test_a_tumbling_part_has_no_derivatives():
    study = {
        "kind": "simulate", "scene": "rectangle-isolated", "outputs": ["drift_velocity"],
        "sensitivities": True,
        "parameters": {
            "frequency": 50, "amplitude": 1e-4, "beta": 0.5, "friction": 0.3, "height": 0.01,
            "length": 0.02, "duration": 1.0, "restitution": 0.3, "pitch": 10,
        },
    }  # fmt: skip
    with pytest.raises(StudyError, match=r"tumbl|followed for a time|not used"):
        prepare_content(study)


def test_a_parameter_of_the_regime_alone_is_no_parameter_of_an_output():
    study = {
        "kind": "sweep", "scene": "cone-on-plane", "outputs": ["cone_factor"],
        "parameters": {
            "frequency": 50, "amplitude": 1e-5, "beta": 20, "friction": 0.3, "height": 0.02,
            "diameter": 0.02, "small_diameter": 0.01, "axis_yaw": 80,
        },
    }  # fmt: skip
    study["outputs"] = ["cone_factor", "rolling_acceleration"]
    derived = prepare_content({**study, "sensitivities": True}).derived
    assert "friction" not in derived.parameters
    assert "diameter" in derived.parameters
    with pytest.raises(StudyError, match="no requested output depends on 'friction'"):
        _ = prepare_content({**study, "sensitivities": ["friction"]}).derived


def test_a_row_has_derivatives_by_differences():
    study = {
        "kind": "simulate", "scene": "row-on-plane", "outputs": ["conveying_velocity"],
        "sensitivities": ["amplitude"],
        "parameters": {
            "frequency": 50, "amplitude": 3e-4, "beta": 20, "part_friction_1": 0.3,
            "part_friction_2": 0.2,
        },
    }  # fmt: skip
    found = tabulate(prepare_content(study))
    by = found.variables["derivative_conveying_velocity_by_amplitude"].values
    study["parameters"]["amplitude"] = [2.999e-4, 3.001e-4]
    del study["sensitivities"]
    low, high = tabulate(prepare_content(study)).variables["conveying_velocity"].values
    assert by == pytest.approx((high - low) / 2e-7, rel=1e-3)


SWEEP = {
    "kind": "sweep", "scene": "rectangle-on-track", "outputs": ["throw_number", "acceleration_x"],
    "sensitivities": ["amplitude", "beta"],
    "parameters": {
        "frequency": 50, "amplitude": [1e-4, 2e-4, 3e-4], "beta": ["10 deg", "20 deg"],
        "alpha": "3 deg", "friction": 0.3, "gamma": 0, "delta": "2 deg",
    },
}  # fmt: skip


def test_a_sweep_is_derived_exactly_on_the_axes_that_each_output_has():
    found = tabulate(prepare_content(SWEEP)).to_xarray()
    exponent = found.sensitivity_throw_number_to_amplitude
    assert exponent.dims == ("amplitude", "beta")
    np.testing.assert_allclose(exponent, 1.0, rtol=1e-15)
    by_beta = found.derivative_throw_number_by_beta * found.throw_number**-1
    cotangent = np.radians(1 / np.tan(np.radians(found.beta)))
    np.testing.assert_allclose(by_beta, 0 * by_beta + cotangent, rtol=1e-13)
    assert (found.derivative_status_amplitude == DERIVATIVE_STATUS["exact"]).all()
    plain = tabulate(prepare_content({**SWEEP, "sensitivities": None})).to_xarray()
    np.testing.assert_array_equal(found.acceleration_x, plain.acceleration_x)


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"precision": "single"}, "precision too"),
        ({"reduce": {"over": ["amplitude"]}}, "reduce too"),
        ({"sensitivities": ["length"]}, "no requested output depends on 'length'"),
    ],
)
def test_what_a_sweep_cannot_derive_is_told(changes, place):
    with pytest.raises(StudyError, match=place):
        prepare_content({**SWEEP, **changes})


def test_a_sweep_with_derivatives_is_not_read_lazily():
    from vibrafeed.core.sweep.lazy import open_lazily

    with pytest.raises(StudyError, match="as a whole"):
        open_lazily(prepare_content(SWEEP))
    with pytest.raises(StudyError, match="as a whole"):
        prepare_content(SWEEP, "sweep")
