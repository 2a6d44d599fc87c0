"""Studies of motion: plan, methods, datasets, limits, and what is said of a wrong one."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.kinds import run_study, tabulate
from vibrafeed.core.motion import SYSTEMS
from vibrafeed.core.motion.feeding import effective_distance, parts_per_minute, velocity_for
from vibrafeed.core.motion.plate import PLATE
from vibrafeed.core.motion.systems import CONTACTS
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.watch import Watch
from waiting import PATIENCE

CONFIGS = Path(__file__).parents[3] / "configs"
HOP = {
    "frequency": "60 Hz", "amplitude": "0.4 mm", "beta": "25 deg", "friction": 0.4, "gravity": 9.8,
}  # fmt: skip
LEAN = {"alpha": "2 deg", "delta": "20 deg", "radius": "0.2 m", "amplitude": "0.25 mm"}
HOP_SPEED = MEAN_VELOCITIES["hop"].value


def study(scene: str = "rectangle-on-plane", **changes):
    parameters = {**HOP, **changes.pop("parameters", {})}
    parameters = {name: value for name, value in parameters.items() if value is not None}
    content = {"kind": "simulate", "scene": scene, "parameters": parameters, **changes}
    return {name: value for name, value in content.items() if value is not None}


def run(**changes):
    return run_study(parse_study(study(**changes)))


def problems(**changes) -> dict[str, str]:
    with pytest.raises(StudyError) as caught:
        prepare_content(study(**changes))
    return {p.place: f"{p.message}. {p.fix}" for p in caught.value.problems}


class TestMethods:
    @pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
    def test_events_is_the_default_in_a_vertical_plane(self, scene):
        found = run(scene=scene)
        assert found.attrs["method"] == "events"
        assert float(found.conveying_velocity) == pytest.approx(HOP_SPEED, rel=1e-13)

    @pytest.mark.parametrize("scene", [*CONTACTS])
    def test_events_is_the_default_in_space(self, scene):
        speed = "velocity_x" if scene == PLATE else "conveying_velocity"
        found = run(scene=scene, outputs=[speed], parameters={"alpha": [0, 10]})
        assert found.attrs["method"] == "events"
        # The first cell is one of the plane, and gets the plane's answer.
        assert float(found[speed][0]) == pytest.approx(HOP_SPEED, rel=1e-13)

    def test_every_method_has_a_price(self):
        """It decides what becomes a job, and how progress is shared out."""
        for name, system in SYSTEMS.items():
            point_part = "conveying_velocity" in system.outputs(system.default_variant)
            for method in system.variants if point_part else ():
                curved = {"radius": "0.3 m"} if "track" in name else {}
                curved |= {"parts": 4} if "row" in name else {}
                prepared = prepare_content(study(name, method=method, parameters=curved))
                assert 0 < prepared.method.seconds_a_cell < 60, (name, method)

    def test_every_method_agrees_within_its_error(self):
        for method in ("events", "reference"):
            found = run(method=method, outputs=["conveying_velocity", "conveying_velocity_error"])
            away = abs(float(found.conveying_velocity) - HOP_SPEED)
            # The reference's own estimate is that of a transient only; it has some nine digits.
            assert away <= float(found.conveying_velocity_error) + 1e-9 * HOP_SPEED, method

    def test_a_block_and_a_cylinder_differ_across_the_track_only(self):
        changes = {"parameters": {"alpha": "30 deg"}, "max_periods": 40}
        block, cylinder = run(**changes), run(scene="cylinder-on-plane", **changes)
        assert float(block.conveying_velocity) != float(cylinder.conveying_velocity)

    def test_the_track_without_wall_load_is_a_plane(self):
        found, plane = run(scene="rectangle-on-track"), run()
        assert float(found.conveying_velocity) == float(plane.conveying_velocity)


class TestWall:
    @pytest.mark.parametrize("method", ["events", "reference"])
    def test_it_is_like_the_floor_unless_it_is_given(self, method):
        found = [
            float(
                run(
                    scene="rectangle-on-track", method=method, parameters={**LEAN, **more}
                ).conveying_velocity
            )
            for more in (
                {},
                {"wall_friction": HOP["friction"], "wall_restitution": 0},
                {"wall_friction": 0.1},
            )
        ]
        assert found[0] == found[1]
        assert found[0] == pytest.approx(0.03868874124, rel=1e-8)  # by the reference
        assert found[2] == pytest.approx(0.03827239394, rel=1e-8)

    def test_it_rebounds_by_its_own_restitution(self):
        given = {"scene": "rectangle-on-track"}
        hops = {**LEAN, "amplitude": "0.4 mm", "alpha": "5 deg"}
        dead, lively = (
            run(**given, parameters={**hops, "wall_restitution": value}) for value in (0.0, 0.5)
        )
        assert dead.conveying_velocity != lively.conveying_velocity
        assert dead.wall_restitution == 0.0

    def test_it_is_a_parameter_of_the_track_alone(self):
        told = problems(parameters={"wall_friction": 0.1})
        assert "not used" in told["parameters.wall_friction"]


class TestDatasets:
    def test_it_says_where_the_part_sticks_slides_and_hops(self):
        found = run(
            parameters={"amplitude": {"start": "0.02 mm", "stop": "0.7 mm", "num": 69}},
            outputs=["conveying_velocity", "stick_fraction", "flight_fraction"],
        )
        meanings = found.regime.attrs["flag_meanings"].split()
        names = dict(zip(found.regime.attrs["flag_values"].tolist(), meanings, strict=True))
        seen = {names[int(value)] for value in np.unique(found.regime)}
        assert {"stick", "stick_slip", "hopping", "hop_after_hop", "period_doubled"} <= seen
        held = found.regime == next(v for v, name in names.items() if name == "stick")
        assert (found.conveying_velocity.where(held, drop=True) == 0).all()
        assert (found.stick_fraction.where(held, drop=True) == 1).all()
        assert "flag_meanings" in found.motion_status.attrs
        assert found.attrs["study_sha256"]

    def test_scaling_is_exact(self):
        # (A0, w) -> (A0/4, 2w): half the velocity, to the last digit.
        slow = run(parameters={"friction": [0.2, 0.4, 0.9], "gamma": "1 deg"})
        fast = run(parameters={
            "friction": [0.2, 0.4, 0.9], "gamma": "1 deg", "amplitude": "0.1 mm",
            "frequency": "120 Hz",
        })  # fmt: skip
        np.testing.assert_array_equal(2 * fast.conveying_velocity, slow.conveying_velocity)

    def test_only_what_is_asked_runs(self):
        prepared = prepare_content(study(outputs=["flight_fraction"]))
        run_equations = {equation.gives for equation in prepared.plan.equations}
        assert "velocity_scale" not in run_equations
        assert prepared.dims["flight_fraction"] == ()

    def test_a_repeated_or_idle_axis_costs_nothing_more(self, monkeypatch):
        from vibrafeed.core.motion import events

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
        assert found.conveying_velocity.shape == (2, 10) or found.conveying_velocity.size == 20

    def test_a_course_in_time(self):
        found = run(outputs=["hop_height", "landing_speed"], trajectory=2000)
        assert found.sizes["cycle_time"] == 2001
        assert float(found.cycle_time[-1]) == pytest.approx(1 / 60)
        # The top of the flight is met within a step: off by n (step/2)^2/2 at most.
        step = 2 * np.pi / 2000
        bar = float(found.length_scale) * 4 * step**2
        assert float(found.height_above_floor.max()) == pytest.approx(
            float(found.hop_height), abs=bar
        )
        way = float(found.position_along[-1])
        assert way * 60 == pytest.approx(HOP_SPEED, rel=1e-11)

    def test_the_course_at_the_wall(self):
        found = run(scene="rectangle-on-track", trajectory=100,
                    parameters={"alpha": "10 deg", "delta": "5 deg"})  # fmt: skip
        assert float(found.distance_from_wall.min()) >= 0
        assert np.isfinite(found.distance_from_wall).all()

    def test_a_course_at_asked_times(self):
        times = [0.0, 0.001, 0.0123, 0.5]
        found = run(trajectory=times)
        np.testing.assert_array_equal(found.cycle_time, times)
        whole = run(trajectory=[0.0, 0.5])  # thirty periods
        assert float(whole.position_along[-1]) == pytest.approx(0.5 * HOP_SPEED, rel=1e-11)

    def test_a_tumbling_part(self):
        found = run_study(load_study(CONFIGS / "tumbling-course.toml"))
        assert found.attrs["scene"] == "cylinder-isolated"
        assert float(found.settling_time) < 1
        end = found.isel(cycle_time=-1)
        assert float(end.path_height) == pytest.approx(0.004, abs=1e-9)  # on its side
        assert int(end.path_corners) == 2
        other = run_study(parse_study({
            "kind": "simulate", "scene": "rectangle-isolated",
            "outputs": ["resting_side", "final_pitch"],
            "parameters": {"length": "20 mm", "height": "12 mm", "drop_height": "5 mm",
                           "pitch": "20 deg", "friction": 0.3, "restitution": 0.1,
                           "duration": "1 s"},
        }))  # fmt: skip
        assert int(other.resting_side) == 1

    @pytest.mark.parametrize("scene", SYSTEMS)
    def test_every_output_of_every_system_by_every_method(self, scene):
        """Each method gives all of its outputs on one easy point."""
        for method, system in ((m, SYSTEMS[scene]) for m in SYSTEMS[scene].variants):
            parameters = {
                name: value
                for name, value in {
                    **HOP, "delta": "10 deg", "length": "20 mm", "height": "12 mm",
                    "diameter": "8 mm", "restitution": 0.1, "duration": "0.2 s", "radius": "0.3 m",
                    "mass": "2 g", "hold_down_force": "1 mN", "parts": 3, "line_yield": 0.8,
                    "line_purity": 0.9, "burst_periods": 2,
                }.items()
                if name in needed(system, method)
            }  # fmt: skip
            if scene == "disc-on-edge":  # it is to roll, not to slip
                parameters |= {"amplitude": "24 um", "friction": 0.25, "beta": "20 deg"}
            if scene == "row-on-plane":  # parts that rebound from the floor hop out of step
                parameters["restitution"] = 0
            asked = {"method": method, "outputs": list(system.outputs(method))}
            content = {"kind": "simulate", "scene": scene, **asked, "parameters": parameters}
            found = run_study(parse_study(content))
            for name in system.outputs(method):
                assert name in found
                # No bound is known of a drive off the floor, and there is one platoon.
                if name not in ("settling_time", "fastest_velocity", "share_of_fastest") and not (
                    name.startswith("platoon_") and name[-1] != "1"
                ):
                    assert np.isfinite(found[name]).all(), (method, name)


def needed(system, method) -> set[str]:
    from vibrafeed.core.plan.plan import scene_parameters

    return set(scene_parameters(system, method)) - {"friction_static", "friction_kinetic"}


class TestStopping:
    def test_what_is_finished_is_kept(self):
        begun = threading.Event()
        prepared = prepare_content(study(parameters={
            "friction": {"start": 0.2, "stop": 0.9, "num": 3000},
        }))  # fmt: skip
        watch = Watch(lambda share: begun.set(), begun.is_set, threads=1)
        table = tabulate(prepared, watch)
        status = table.variables["motion_status"].values
        left = status == MOTION_STATUSES["not_computed"].value
        assert 0 < left.sum() < status.size
        assert np.isnan(table.variables["conveying_velocity"].values[left]).all()
        whole = tabulate(prepared).variables["conveying_velocity"].values
        np.testing.assert_array_equal(
            table.variables["conveying_velocity"].values[~left], whole[~left]
        )
        regimes = table.variables["regime"]
        by_name = dict(zip(regimes.attributes["flag_meanings"].split(),
                           regimes.attributes["flag_values"], strict=True))  # fmt: skip
        assert (regimes.values[left] == by_name["unresolved"]).all()

    @pytest.mark.parametrize("method", ["events", "reference"])
    def test_a_deadline_in_the_past_starts_nothing(self, method):
        prepared = prepare_content(study(method=method))
        table = tabulate(prepared, Watch(deadline=time.monotonic() - 1))
        assert table.variables["motion_status"].values == 0

    def test_progress_reaches_the_end(self):
        shares: list[float] = []
        prepared = prepare_content(study(parameters={"friction": [0.2, 0.3, 0.4]}))
        tabulate(prepared, Watch(shares.append))
        assert sum(shares) == pytest.approx(1)


class TestProblems:
    def test_everything_at_once(self):
        found = problems(
            scene="rectangle-on-plane", method="event", outputs=["conveying_velocty"],
            tolerance=2, max_period=9, parameters={"friction": None, "mass": "3 g", "betta": 3},
        )  # fmt: skip
        assert "Did you mean 'max_periods'" in found["max_period"]
        assert "2 is too large. Write at most 1" in found["tolerance"]
        assert "Did you mean 'beta'" in found["parameters.betta"]
        assert "Did you mean 'events'" in found["method"]
        assert "Did you mean 'conveying_velocity'" in found["outputs"]

    def test_outputs_and_parameters(self):
        found = problems(outputs=["conveying_velocty"], parameters={"mass": "3 g"})
        assert "Did you mean 'conveying_velocity'" in found["outputs"]
        assert "mass is not used by" in found["parameters.mass"]

    def test_missing_friction(self):
        assert "it is missing" in problems(parameters={"friction": None})["parameters.friction"]

    def test_events_leave_the_plane(self):
        across = {"alpha": ["0 deg", "5 deg"]}
        found = run(method="events", parameters=across).conveying_velocity.values
        other = run(method="reference", parameters=across).conveying_velocity.values
        assert np.abs(found - other).max() <= 1e-9 * HOP_SPEED
        assert found[0] == float(run(method="events").conveying_velocity)

    def test_settings_belong_to_methods(self):
        told = problems(method="reference", tolerance=1e-9)["tolerance"]
        assert told == ("the method reference does not use it. Remove it, or set method to events")

    @pytest.mark.parametrize("method", ["time-stepping", "regularised", "regularised-LSODA"])
    def test_a_method_of_old_names_the_one_that_stays(self, method):
        assert "This method is gone: 'events' is exact" in problems(method=method)["method"]

    @pytest.mark.parametrize("key", ["steps_per_period", "slip_speed", "contact_stiffness"])
    def test_a_setting_of_old_says_that_it_is_gone(self, key):
        told = problems(**{key: 100})[key]
        assert (
            told == f"'{key}' is not a key of kind 'simulate'. Remove it: its method is gone, "
            "and 'events' is exact without it"
        )

    def test_scenes_that_are_snapshots_only(self):
        found = problems(scene="rectangle-pair-impact", parameters=dict.fromkeys(HOP))
        assert "cannot be simulated" in found["scene"]
        assert "rectangle-on-plane" in found["scene"]

    def test_no_drive(self):
        assert "no period" in problems(parameters={"frequency": 0})["parameters.frequency"]
        still = run(parameters={"amplitude": 0}, outputs=["conveying_velocity", "efficiency"])
        assert (float(still.conveying_velocity), float(still.efficiency)) == (0, 0)

    def test_static_friction_below_kinetic(self):
        found = problems(parameters={
            "friction": None, "friction_static": 0.2, "friction_kinetic": 0.3,
        })  # fmt: skip
        assert "friction_static" in " ".join(found)

    @pytest.mark.parametrize(
        "wrong", [1, 0, -3, "many", [], [1, 0.5], [-1.0], True, [float("nan")]]
    )
    def test_trajectories(self, wrong):
        assert "whole number" in problems(trajectory=wrong)["trajectory"]

    def test_a_trajectory_shows_one_point(self):
        found = problems(trajectory=50, parameters={"friction": [0.1, 0.2]})
        assert "trajectory shows one point" in found["trajectory"]

    def test_the_reference_gives_means_only(self):
        found = problems(method="reference", trajectory=50)["trajectory"]
        assert "Set method to events" in found

    def test_settings_and_courses_are_told_beside_all_else(self):
        found = problems(
            method="reference", tolerance=1e-4, trajectory=10,
            parameters={"friction": [0.1, 0.2], "alpha": 3, "frequency": 0, "mass": 3},
        )  # fmt: skip
        assert set(found) == {
            "tolerance", "trajectory", "parameters.frequency", "parameters.mass",
        }  # fmt: skip

    def test_reference_keeps_to_friction_that_it_can_integrate(self):
        found = problems(method="reference", parameters={"friction": 1e4})
        assert "at most 1000" in found["parameters.friction"]

    def test_unknown_keys_are_those_of_the_kind(self):
        assert "is not a key of kind 'simulate'" in problems(variant="thesis")["variant"]

    def test_kinds_are_not_mixed_up(self):
        with pytest.raises(StudyError, match="not a kind"):
            prepare_content(study() | {"kind": "simulat"})


class TestNoAnswer:
    def test_reference_knows_what_runs_away(self):
        found = run(method="reference", parameters={"gamma": "60 deg"})
        assert int(found.motion_status) == MOTION_STATUSES["runaway"].value

    def test_a_part_that_never_lands_has_no_mean(self):
        given = {"amplitude": "1 m", "alpha": "10 deg"}
        found = run(parameters=given)
        assert int(found.motion_status) == MOTION_STATUSES["limit_reached"].value
        assert np.isnan(found.conveying_velocity)

    @pytest.mark.parametrize("amplitude", [0, 5e-324, 1e-300, 1e300])
    def test_amplitudes_at_the_ends_of_floating_numbers(self, amplitude):
        found = run(parameters={"amplitude": amplitude})
        answered = np.isfinite(found.conveying_velocity)
        assert answered == (int(found.motion_status) in (1, 2, 3, 5))


class TestRates:
    def test_parts_per_minute_and_back(self):
        rate = parts_per_minute(velocity=np.array([0.05]), length=np.array([0.02]), gap=0.005)
        assert rate == pytest.approx([120])
        speed = velocity_for(parts_per_minute=rate, length=np.array([0.02]), gap=0.005)
        assert speed == pytest.approx([0.05])

    def test_the_effective_distance_gives_the_speed_back(self):
        content = {
            "kind": "sweep", "scene": "rectangle-on-track", "variant": "derived",
            "outputs": ["starting_acceleration", "transport_velocity"],
            "parameters": {**HOP, "delta": "10 deg", "radius": "0.2 m", "distance": "0.1 mm"},
        }  # fmt: skip
        simulated = run()
        K = run_study(parse_study(content)).starting_acceleration
        distance = effective_distance(
            velocity=simulated.conveying_velocity.values, starting_acceleration=K.values,
            friction_kinetic=np.array(0.4), radius=np.array(0.2),
        )  # fmt: skip
        content["parameters"]["distance"] = float(distance)
        again = run_study(parse_study(content)).transport_velocity
        assert float(again) == pytest.approx(HOP_SPEED, rel=1e-13)

    def test_there_is_none_beyond_the_terminal_velocity(self):
        far = effective_distance(
            velocity=np.array([10.0, 1.0]), starting_acceleration=np.array([1.0, -1.0]),
            friction_kinetic=np.array(0.4), radius=np.array(0.2),
        )  # fmt: skip
        assert np.isinf(far).all()

    def test_there_is_none_for_a_part_that_goes_backward(self):
        at = {
            "starting_acceleration": np.array(1.0), "friction_kinetic": np.array(0.4),
            "radius": np.array(0.2),
        }  # fmt: skip
        there, back, still = effective_distance(velocity=np.array([0.1, -0.1, 0.0]), **at)
        assert 0.005 < there < 0.0051  # v^2/(2 K) and a little
        assert back == np.inf
        assert still == 0


def test_it_runs_where_no_cache_can_be_written():
    """A read-only installation compiles in memory."""
    code = (
        "import numba.core.caching as c\n"
        "class Nowhere(c.CacheImpl):\n"
        "    _locator_classes = []\n"
        "c.CompileResultCacheImpl._locator_classes = []\n"
        "from vibrafeed.core.compiled import compiled\n"
        "@compiled\n"
        "def double(x):\n"
        "    return 2 * x\n"
        "assert double(2.0) == 4.0\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=PATIENCE)
