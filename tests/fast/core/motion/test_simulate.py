"""Studies of motion: plan, methods, datasets, limits, and what is said of a wrong one."""

import threading
from pathlib import Path

import numpy as np
import pytest

from mean_velocities import MEAN_VELOCITIES
from refusals import told_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.kinds import run_study, tabulate
from vibrafeed.core.motion import events
from vibrafeed.core.motion.feeding import effective_distance, parts_per_minute, velocity_for
from vibrafeed.core.motion.plate import PLATE
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.plan.plan import scene_parameters
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.watch import Watch

CONFIGS = Path(__file__).parents[4] / "configs"
HOP = {
    "frequency": "60 Hz", "amplitude": "0.4 mm", "beta": "25 deg", "friction": 0.4, "gravity": 9.8,
}  # fmt: skip
LEAN = {"alpha": "2 deg", "delta": "20 deg", "radius": "0.2 m", "amplitude": "0.25 mm"}
HOP_SPEED = MEAN_VELOCITIES["hop"].value


def study(scene: str = "rectangle-on-plane", **changes):
    parameters = {**HOP, **changes.pop("parameters", {})}
    parameters = {name: value for name, value in parameters.items() if value is not None}
    return {"kind": "simulate", "scene": scene, "parameters": parameters, **changes}


def run(**changes):
    return run_study(parse_study(study(**changes)))


def problems(**changes) -> dict[str, str]:
    return told_of(prepare_content, study(**changes))


# --- methods


@pytest.mark.parametrize("scene", [*CONTACTS])
def test_events_is_the_default_and_a_cell_of_the_plane_gets_the_answer_of_the_plane(scene):
    speed = "velocity_x" if scene == PLATE else "conveying_velocity"
    found = run(scene=scene, outputs=[speed], parameters={"alpha": [0, 10]})
    assert found.attrs["method"] == "events"
    assert float(found[speed][0]) == pytest.approx(HOP_SPEED, rel=1e-13)


def test_a_block_and_a_cylinder_differ_across_the_track_only():
    changes = {"parameters": {"alpha": "30 deg"}, "max_periods": 40}
    block, cylinder = run(**changes), run(scene="cylinder-on-plane", **changes)
    assert float(block.conveying_velocity) != float(cylinder.conveying_velocity)


def test_the_wall_is_like_the_floor_unless_it_is_given():
    given = {"scene": "rectangle-on-track"}
    same = {"wall_friction": HOP["friction"], "wall_restitution": 0}
    plain, alike, smooth = (
        float(run(**given, parameters={**LEAN, **more}).conveying_velocity)
        for more in ({}, same, {"wall_friction": 0.1})
    )
    assert plain == alike
    assert [plain, smooth] == pytest.approx([0.03868874124, 0.03827239394], rel=1e-8)  # reference


def test_the_wall_rebounds_by_its_own_restitution():
    hops = {**LEAN, "amplitude": "0.4 mm", "alpha": "5 deg", "wall_restitution": [0.0, 0.5]}
    dead, lively = run(scene="rectangle-on-track", parameters=hops).conveying_velocity.values
    assert dead != lively


# --- datasets


def test_it_says_where_the_part_sticks_slides_and_hops():
    found = run(
        parameters={"amplitude": {"start": "0.02 mm", "stop": "0.7 mm", "num": 69}},
        outputs=["conveying_velocity", "stick_fraction", "flight_fraction"],
    )
    meanings = found.regime.attrs["flag_meanings"].split()
    names = dict(zip(meanings, found.regime.attrs["flag_values"].tolist(), strict=True))
    seen = {name for name, value in names.items() if value in found.regime}
    assert {"stick", "stick_slip", "hopping", "hop_after_hop", "period_doubled"} <= seen
    held = found.where(found.regime == names["stick"], drop=True)
    assert (held.conveying_velocity == 0).all()
    assert (held.stick_fraction == 1).all()
    assert "flag_meanings" in found.motion_status.attrs
    assert found.attrs["study_sha256"]


def test_scaling_is_exact():
    # (A0, w) -> (A0/4, 2w): half the velocity, to the last digit.
    slow = {"friction": [0.2, 0.4, 0.9], "gamma": "1 deg"}
    fast = {**slow, "amplitude": "0.1 mm", "frequency": "120 Hz"}
    halves, wholes = (run(parameters=one).conveying_velocity for one in (fast, slow))
    np.testing.assert_array_equal(2 * halves, wholes)


def test_a_repeated_or_idle_axis_costs_nothing_more(monkeypatch):
    cells: list[int] = []
    kernel = events.solve_cells

    def counting(groups, table, status, stop):
        cells.append(len(groups))
        kernel(groups, table, status, stop)

    monkeypatch.setattr(events, "solve_cells", counting)
    found = run(parameters={
        "amplitude": "0.05 mm", "restitution": {"start": 0, "stop": 0.9, "num": 10},
        "friction": [0.2, 0.3],
    })  # fmt: skip
    assert sum(cells) == 2  # it never lifts off: restitution plays no part
    assert found.conveying_velocity.size == 20


def test_a_course_in_time():
    found = run(outputs=["hop_height", "landing_speed"], trajectory=2000)
    assert found.sizes["cycle_time"] == 2001
    assert float(found.cycle_time[-1]) == pytest.approx(1 / 60)
    # The top of the flight is met within a step: off by n (step/2)^2/2 at most.
    bar = float(found.length_scale) * 4 * (2 * np.pi / 2000) ** 2
    top = float(found.height_above_floor.max())
    assert top == pytest.approx(float(found.hop_height), abs=bar)
    assert float(found.position_along[-1]) * 60 == pytest.approx(HOP_SPEED, rel=1e-11)


def test_the_course_at_the_wall():
    found = run(scene="rectangle-on-track", trajectory=100,
                parameters={"alpha": "10 deg", "delta": "5 deg"})  # fmt: skip
    assert float(found.distance_from_wall.min()) >= 0
    assert np.isfinite(found.distance_from_wall).all()


def test_a_course_at_asked_times():
    times = [0.0, 0.001, 0.0123, 0.5]  # up to thirty periods
    found = run(trajectory=times)
    np.testing.assert_array_equal(found.cycle_time, times)
    assert float(found.position_along[-1]) == pytest.approx(0.5 * HOP_SPEED, rel=1e-11)


def test_a_tumbling_part():
    found = run_study(load_study(CONFIGS / "tumbling-course.toml"))
    assert found.attrs["scene"] == "cylinder-isolated"
    assert float(found.settling_time) < 1
    end = found.isel(cycle_time=-1)
    assert float(end.path_height) == pytest.approx(0.004, abs=1e-9)  # on its side
    assert int(end.path_corners) == 2


@pytest.mark.parametrize(
    ("scene", "method"),
    [(scene, method) for scene in SYSTEMS for method in SYSTEMS[scene].variants],
)
def test_every_output_of_every_system_by_every_method(scene, method):
    """Each method gives all of its outputs on one easy point."""
    system = SYSTEMS[scene]
    easy = {
        **HOP, "delta": "10 deg", "length": "20 mm", "height": "12 mm", "diameter": "8 mm",
        "restitution": 0.1, "duration": "0.2 s", "radius": "0.3 m", "mass": "2 g",
        "hold_down_force": "1 mN", "parts": 3, "line_yield": 0.8, "line_purity": 0.9,
        "burst_periods": 2,
    }  # fmt: skip
    used = set(scene_parameters(system, method)) - {"friction_static", "friction_kinetic"}
    parameters = {name: value for name, value in easy.items() if name in used}
    if scene == "disc-on-edge":  # it is to roll, not to slip
        parameters |= {"amplitude": "24 um", "friction": 0.25, "beta": "20 deg"}
    if scene == "row-on-plane":  # parts that rebound from the floor hop out of step
        parameters["restitution"] = 0
    outputs = list(system.outputs(method))
    found = run_study(parse_study({
        "kind": "simulate", "scene": scene, "method": method, "outputs": outputs,
        "parameters": parameters,
    }))  # fmt: skip
    # No bound is known of a drive off the floor, and there is one platoon.
    none = {"settling_time", "fastest_velocity", "share_of_fastest"}
    none |= {name for name in outputs if name.startswith("platoon_") and name[-1] != "1"}
    for name in outputs:
        assert name in none or np.isfinite(found[name]).all(), name


# --- stopping


def test_what_is_finished_is_kept():
    begun = threading.Event()
    prepared = prepare_content(
        study(parameters={"friction": {"start": 0.2, "stop": 0.9, "num": 3000}})
    )
    watch = Watch(lambda share: begun.set(), begun.is_set, threads=1)
    found, whole = tabulate(prepared, watch).to_xarray(), tabulate(prepared).to_xarray()
    left = found.motion_status.values == MOTION_STATUSES["not_computed"].value
    assert 0 < left.sum() < left.size
    assert np.isnan(found.conveying_velocity.values[left]).all()
    kept = found.conveying_velocity.values[~left]
    np.testing.assert_array_equal(kept, whole.conveying_velocity.values[~left])
    meanings = found.regime.attrs["flag_meanings"].split()
    unresolved = found.regime.attrs["flag_values"][meanings.index("unresolved")]
    assert (found.regime.values[left] == unresolved).all()


def test_progress_reaches_the_end():
    shares: list[float] = []
    prepared = prepare_content(study(parameters={"friction": [0.2, 0.3, 0.4]}))
    tabulate(prepared, Watch(shares.append))
    assert sum(shares) == pytest.approx(1)


# --- problems


def test_everything_is_told_at_once():
    found = problems(
        method="event", outputs=["conveying_velocty"], tolerance=2, max_period=9,
        parameters={"friction": None, "mass": "3 g", "betta": 3},
    )  # fmt: skip
    assert "Did you mean 'max_periods'" in found["max_period"]
    assert "2 is too large. Write at most 1" in found["tolerance"]
    assert "Did you mean 'beta'" in found["parameters.betta"]
    assert "Did you mean 'events'" in found["method"]
    assert "Did you mean 'conveying_velocity'" in found["outputs"]


def test_settings_and_courses_are_told_beside_all_else():
    found = problems(
        method="reference", tolerance=1e-4, trajectory=10,
        parameters={"friction": [0.1, 0.2], "alpha": 3, "frequency": 0, "radius": 3},
    )  # fmt: skip
    assert set(found) == {"tolerance", "trajectory", "parameters.frequency", "parameters.radius"}


PROBLEMS = [
    ({"parameters": {"wall_friction": 0.1}}, "parameters.wall_friction", "not used"),
    ({"parameters": {"friction": None}}, "parameters.friction", "it is missing"),
    ({"method": "reference", "tolerance": 1e-9}, "tolerance",
     "the method reference does not use tolerance. Remove it, or set method to events"),
    ({"method": "time-stepping"}, "method", "Known: events, reference"),
    ({"steps_per_period": 100}, "steps_per_period", "is not a key of a study of kind 'simulate'"),
    ({"max_periods": 5}, "max_periods", "5 is too small"),
    ({"scene": "rectangle-pair-impact", "parameters": dict.fromkeys(HOP)}, "scene",
     "cannot be simulated"),
    ({"parameters": {"frequency": 0}}, "parameters.frequency", "no period"),
    ({"parameters": {"friction": None, "friction_static": 0.2, "friction_kinetic": 0.3}},
     "parameters.friction_static", ""),
    ({"trajectory": 50, "parameters": {"friction": [0.1, 0.2]}}, "trajectory",
     "a trajectory is computed for a single design"),
    ({"trajectory": [1e4]}, "trajectory", "End it by"),
    ({"method": "reference", "trajectory": 50}, "trajectory", "Set method to events"),
    ({"method": "reference", "parameters": {"friction": 1e4}}, "parameters.friction",
     "at most 1000"),
    ({"variant": "thesis"}, "variant", "is not a key of a study of kind 'simulate'"),
    *(({"trajectory": wrong}, "trajectory", "whole number")
      for wrong in (1, -3, "many", [], [1, 0.5], [-1.0], True, [float("nan")])),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "place", "says"), PROBLEMS)
def test_what_is_wrong_is_said_at_its_place(changes, place, says):
    assert says in problems(**changes)[place]


def test_kinds_are_not_mixed_up():
    with pytest.raises(StudyError, match="not a kind"):
        prepare_content(study() | {"kind": "simulat"})


# --- no answer


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"method": "reference", "parameters": {"gamma": "60 deg"}}, "runaway"),
        ({"parameters": {"amplitude": "1 m", "alpha": "10 deg"}}, "limit_reached"),
        ({"parameters": {"amplitude": 1e300}}, "limit_reached"),
    ],
)
def test_what_has_no_mean_says_why(changes, status):
    found = run(**changes)
    assert int(found.motion_status) == MOTION_STATUSES[status].value
    assert np.isnan(found.conveying_velocity)


@pytest.mark.parametrize("amplitude", [0, 5e-324, 1e-300])
def test_next_to_no_drive_moves_nothing(amplitude):
    still = run(parameters={"amplitude": amplitude}, outputs=["conveying_velocity", "efficiency"])
    assert int(still.motion_status) == MOTION_STATUSES["at_rest"].value
    assert (float(still.conveying_velocity), float(still.efficiency)) == (0, 0)


# --- rates


@pytest.mark.parametrize("length", [0, -0.01, np.array([0.01, 0.0])])
def test_parts_without_a_length_have_no_rate(length):
    says = "length: length plus gap, the track that one part takes"
    with pytest.raises(StudyError, match=says):
        parts_per_minute(velocity=0.03, length=length)
    with pytest.raises(StudyError, match=says):
        velocity_for(parts_per_minute=100, length=length)


def test_the_effective_distance_gives_the_speed_back():
    content = {
        "kind": "sweep", "scene": "rectangle-on-track", "variant": "derived",
        "outputs": ["starting_acceleration", "transport_velocity"],
        "parameters": {**HOP, "delta": "10 deg", "radius": "0.2 m", "distance": "0.1 mm"},
    }  # fmt: skip
    K = run_study(parse_study(content)).starting_acceleration
    distance = effective_distance(
        velocity=run().conveying_velocity.values, starting_acceleration=K.values,
        friction_kinetic=np.array(0.4), radius=np.array(0.2),
    )  # fmt: skip
    content["parameters"]["distance"] = float(distance)
    again = run_study(parse_study(content)).transport_velocity
    assert float(again) == pytest.approx(HOP_SPEED, rel=1e-13)


def test_where_there_is_no_effective_distance():
    """Beyond the terminal velocity, without a start, backwards; at rest it is 0."""
    far, held, back, still, there = effective_distance(
        velocity=np.array([10.0, 1.0, -0.1, 0.0, 0.1]), friction_kinetic=np.array(0.4),
        starting_acceleration=np.array([1.0, -1.0, 1.0, 1.0, 1.0]), radius=np.array(0.2),
    )  # fmt: skip
    assert far == held == back == np.inf
    assert still == 0
    assert 0.005 < there < 0.0051  # v^2/(2 K) and a little
