"""The plan: what outputs pull, what they leave out, and what is said where something is wrong."""

import numpy as np
import pytest

from night import spread
from plans import make_plan
from refusals import problems_of, told_of
from surfaces import box
from vibrafeed.core.catalogue import describe
from vibrafeed.core.errors import LimitError, SceneError, StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.intake.part import read_part
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.evaluate import empty_results, evaluate_in_blocks
from vibrafeed.core.plan.plan import scene_parameters
from vibrafeed.core.quantities import FLAGS, QUANTITIES, REGIMES
from vibrafeed.core.scenes import SCENES, Condition, Equation
from vibrafeed.core.scenes.scene import Scene

DRIVE = ("frequency", "amplitude", "beta")
EVERY_VARIANT = [(name, variant) for name, scene in SCENES.items() for variant in scene.variants]
VALUES = {
    "frequency": 50.0, "amplitude": 5e-4, "beta": 20.0, "alpha": 10.0, "gamma": 3.0, "delta": 2.0,
    "yaw": 5.0, "radius": 0.5, "gravity": 9.8, "friction": 0.3, "width": 0.008, "height": 0.0015,
    "length": 0.05, "diameter": 0.008, "mass": 0.01, "speed": 0.1, "distance": 2e-4, "time": 1e-3,
    "axis_yaw": 5.0, "spin_rate": 40.0, "yaw_rate": 2.0, "drilling_moment": 1e-4,
    "pitch": 40.0, "pitch_rate": 2.0, "centre_along": 0.01, "centre_height": 0.02,
    "velocity_along": 0.1, "velocity_upward": 0.0,
    # two bodies that touch, nearly, and approach
    "position_x_1": 0.005, "position_y_1": 0.02097, "angle_1": 30.0, "velocity_x_1": 0.1,
    "velocity_y_1": -0.2, "spin_1": 3.0, "length_1": 0.05, "width_1": 0.008, "mass_1": 0.01,
    "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.0, "velocity_x_2": 0.0,
    "velocity_y_2": 0.1, "spin_2": -1.0, "length_2": 0.04, "width_2": 0.01, "mass_2": 0.02,
    "restitution": 0.5, "contact_tolerance": 0.1,
    "position_z_1": 0.0, "azimuth_1": 90.0, "elevation_1": 20.0, "velocity_z_1": -0.3,
    "spin_x_1": 1.0, "spin_y_1": 2.0, "spin_z_1": 3.0, "diameter_1": 0.02,
    "position_z_2": -0.0285, "azimuth_2": 20.0, "elevation_2": 0.0, "velocity_z_2": 0.2,
    "spin_x_2": -1.0, "spin_y_2": 2.0, "spin_z_2": 1.0, "diameter_2": 0.02,
    # two masses on leaf springs
    "moving_mass": 10.0, "base_mass": 30.0, "load_mass": 0.5, "moving_inertia": 0.25,
    "base_inertia": 0.9, "spring_radius": 0.15, "spring_angle": 20.0, "spring_count": 8.0,
    "spring_width": 0.04, "spring_thickness": 0.003, "spring_length": 0.1,
    "elastic_modulus": 206e9, "clamp_factor": 0.9, "allowable_stress": 250e6,
    "ring_down_frequency": 53.0, "damping_ratio": 0.02, "drive_force": 60.0, "air_gap": 0.003,
    "foot_stiffness": 4e4, "foot_damping": 100.0, "load_damping": 20.0, "force_harmonic": 0.25,
    "offset_along": 0.02, "offset_upward": 0.05, "spot_along": 0.1, "spot_upward": 0.03,
    "spring_density": 7850.0,
    # rows of parts
    "parts": 3.0, "row_velocity": 0.08, "inflow": 60.0, "lane_length": 0.5, "closed_time": 0.2,
    "open_time": 0.1, "part_width": 0.01, "bend_radius": 0.2, "bend_length": 0.2,
    "bend_friction": 0.3, "line_push": 1.0, "forward_acceleration": 2.0,
    "return_acceleration": 9.0, "row_mass": 0.1, "part_restitution": 0.2,
    "front_velocity": 0.06, "part_gap": 0.002, "part_mass_1": 0.01, "part_mass_2": 0.02,
    "part_friction_1": 0.3, "part_friction_2": 0.4,
    # parts that come to rest
    "small_diameter": 0.005, "centre_of_mass": 0.0006, "radius_of_gyration": 0.002, "sides": 6.0,
    "aspect": 1.0, "part_density": 7850.0,
    # balls, rollers, discs
    "inner_diameter": 0.002,
    # contacts that give
    "restitution_speed": 0.1, "impact_speed": 0.2, "contact_damping_ratio": 0.2,
    "lining_stiffness": 2e4, "contact_modulus": 1e11, "contact_radius": 0.004,
    # lines of devices; an order counts from 1
    "arrival_rate": 300.0, "wanted_aspect": 1.0, "shank_diameter": 0.004, "device_order": 2.0,
    "lap_time": 40.0, "drop_count_1": 129.0, "drop_count_2": 49.0, "drop_count_3": 22.0,
    **dict.fromkeys((f"drop_count_{k}" for k in range(4, 10)), 5.0),
    **{
        f"{name}_{place}": value
        for place in range(1, 7)
        for name, value in (
            ("wiper_height", 0.1), ("ledge_width", 0.1), ("gap_length", 1e-4),
            ("rail_width", 0.006), ("outlet_capacity", 250.0), ("turned_share", 0.6),
            ("turn", 21.0), ("passed_aspect", 1.0),
        )
    },
}  # fmt: skip


def content(scene: str, outputs: list[str], **parameters: object) -> dict[str, object]:
    return {"kind": "sweep", "scene": scene, "outputs": outputs, "parameters": parameters}


def test_a_plan_of_the_drive_alone_assesses_no_contact():
    plan = make_plan("rectangle-on-track", None, ["vibration_acceleration"], DRIVE[:2])
    assert (plan.conditions, plan.regimes) == ((), ("not_assessed",))


@pytest.mark.parametrize(("name", "variant"), spread(EVERY_VARIANT, 8))
def test_every_equation_of_a_plan_is_needed(name, variant):
    scene = SCENES[name]
    described = {o["name"]: o["parameters"] for o in describe(name, variant)["outputs"]}
    for output in scene.outputs(variant):
        needed = described.get(output, [])
        # The counts of a drop test stand for shares by the part's sizes.
        parameters = [
            p for p in VALUES
            if p in scene_parameters(scene, variant) and (p in needed or "drop_count" not in p)
        ]  # fmt: skip
        plan = make_plan_with_what_it_needs(name, variant, output, parameters)
        assert set(needed) - {"friction", "peak_to_peak"} <= {
            *plan.parameters, *plan.defaults, "friction_static", "friction_kinetic",
        }  # fmt: skip
        conditions = [c for c in scene.conditions[variant] if output in c.outputs]
        assert list(plan.conditions) == conditions
        users = {n for part in (*plan.equations, *plan.conditions) for n in part.inputs}
        assert {equation.gives for equation in plan.equations} <= users | {output}


def make_plan_with_what_it_needs(name, variant, output, parameters):
    """Return the plan of one output, giving only the parameters that it accepts."""
    try:
        return make_plan(name, variant, [output], parameters)
    except StudyError as error:
        unused = {p.place.removeprefix("parameters.") for p in error.problems}
        return make_plan(name, variant, [output], [p for p in parameters if p not in unused])


@pytest.mark.parametrize(("name", "variant"), EVERY_VARIANT)
def test_every_output_evaluates_to_a_finite_value_and_a_known_regime(name, variant):
    scene = SCENES[name]
    outputs = list(scene.outputs(variant))
    # Where one aspect alone passes, and rails leave another, none does.
    listed = [n for n in scene_parameters(scene, variant) if "passed_aspect" not in n]
    parameters = {n: VALUES[n] for n in VALUES if n in listed}
    study = {**content(name, outputs, **parameters), "variant": variant}
    if variant == "mesh":  # of three aspects
        study["part"] = read_part(box(30, 20, 10), files=False).model_dump(mode="json")
        for k in range(4, 10):
            study["parameters"].pop(f"drop_count_{k}", None)
    dataset = run_study(parse_study(study))
    # What is infinite is so for a reason: this drive does not stop the part, nor lets it hover;
    # in flight the floor has no wrench; this corner can be trapped in slip to the right only.
    unbounded = {
        "stopping_distance", "stopping_time", "pressure_offset_x", "pressure_offset_y",
        "pressure_offset_axial", "required_friction", "push_over_load", "limiting_friction_left",
        *(name for name in outputs if name.startswith("floor_") and name != "floor_force"),
    }  # fmt: skip
    for output in set(outputs) - {"regime"}:
        assert np.isfinite(dataset[output]) or output in unbounded, output
        assert dataset[output].attrs["units"] == QUANTITIES[output].unit
    assert int(dataset.regime) in dataset.regime.attrs["flag_values"]


def test_an_output_keeps_only_the_dimensions_that_it_depends_on():
    ends = {
        "frequency": (20, 100), "amplitude": (1e-4, 1e-3), "alpha": (0, 80), "beta": (0, 80),
        "gamma": (0, 8), "friction": (0.1, 0.9), "yaw": (0, 80),
    }  # fmt: skip
    axes = {name: {"start": a, "stop": b, "num": 9} for name, (a, b) in ends.items()}
    outputs = ["normal_acceleration", "acceleration_x", "rotated_acceleration_x"]
    prepared = prepare_content(content("rectangle-on-plane", outputs, **axes))
    assert prepared.dims["normal_acceleration"] == ("frequency", "amplitude", "beta", "gamma")
    assert [len(prepared.dims[name]) for name in outputs] == [4, 6, 7]
    assert prepared.grid.size(prepared.dims["normal_acceleration"]) == 9**4
    assert prepared.cells == 9**7


TRACK = content(
    "rectangle-on-track", ["transport_velocity", "acceleration_x", "throw_number"],
    frequency={"start": 20, "stop": 100, "num": 7}, amplitude=[1e-4, 5e-4],
    alpha={"start": 0, "stop": 80, "num": 5}, beta={"start": 0, "stop": 80, "num": 6},
    friction=[0.1, 0.5], radius=0.5, distance=2e-4,
)  # fmt: skip


BUNDLES = content(
    "cylinder-rolling", ["floor_pitch", "force_axis_rolling", "cone_margin"],
    frequency=50, amplitude=4e-4, alpha=12, beta=6, diameter=0.008, length=0.02, friction=0.35,
    mass=[0.001, 0.005], axis_yaw={"start": 0, "stop": 90, "num": 7}, yaw_rate=[1, 2, 3],
    spin_rate={"start": -50, "stop": 50, "num": 5}, drilling_moment=1e-6,
)  # fmt: skip


@pytest.mark.parametrize("study", [TRACK, BUNDLES])
def test_results_do_not_depend_on_blocks(study):
    prepared = prepare_content(study)
    plan, grid = prepared.plan, prepared.grid
    whole, parts = empty_results(plan, grid), empty_results(plan, grid)
    evaluate_in_blocks(plan, grid, whole, block_cells=10**9)
    for block_cells in (1, 7, 60, 500):
        done: list[float] = []
        evaluate_in_blocks(plan, grid, parts, block_cells=block_cells, progress=done.append)
        assert sum(done) == pytest.approx(1)
        for name, values in whole.items():
            np.testing.assert_array_equal(parts[name], values)


def test_results_do_not_depend_on_the_presence_of_other_axes():
    dataset = run_study(parse_study(TRACK))
    cell = dataset.isel(frequency=3, amplitude=1, alpha=2, beta=4, friction=1)
    axes = {name: float(cell[name]) for name in dataset.dims}
    point = run_study(parse_study({**TRACK, "parameters": {**TRACK["parameters"], **axes}}))
    assert all(float(cell[name]) == float(point[name]) for name in point.data_vars)


def test_a_parameter_of_the_scene_that_moves_no_output_is_a_warning():
    """No dimension of the part enters its velocity; a range of it is no axis of the result."""
    content = {
        "kind": "sweep", "scene": VELOCITY[0], "outputs": VELOCITY[1],
        "parameters": {**DRIVEN, "radius": 0.5, "distance": 1e-4, "width": [1e-3, 2e-3],
                       "mass": 5e-3},
    }  # fmt: skip
    prepared = prepare_content(content)
    says = "{} changes nothing: no requested output of rectangle-on-track depends on it"
    assert prepared.questions == (says.format("width"), says.format("mass"))
    assert prepared.cells == 1
    kinds = {
        "optimise": {"criterion": {"kind": "maximise", "output": "transport_velocity"},
                     "variables": {"beta": {"lower": 5, "upper": 20}}},
        "sensitivity": {"uncertain": {"beta": {"lower": 5, "upper": 20}}},
    }  # fmt: skip
    fixed = {name: value for name, value in content["parameters"].items() if name != "beta"}
    for kind, more in kinds.items():
        other = {**content, "kind": kind, "parameters": fixed, **more}
        assert says.format("mass") in prepare_content(other).questions
    apart = {**other, "uncertain": {"mass": {"lower": 1e-3, "upper": 2e-3}}}
    del apart["parameters"]["mass"]
    with pytest.raises(StudyError, match=r"uncertain.mass: mass is not used by"):
        prepare_content({**apart, "parameters": {**fixed, "beta": 20}})


MOVED = {"frequency": "50 Hz", "amplitude": "0.5 mm", "beta": 20}


DRIVEN = {**MOVED, "friction": 0.3}


ACCELERATION = ("rectangle-on-plane", ["acceleration_x"])


VELOCITY = ("rectangle-on-track", ["transport_velocity"])


@pytest.mark.parametrize(
    ("asked", "parameters", "problems"),
    [
        (ACCELERATION, {**DRIVEN, "amplitude": "0.5 kg"}, {"amplitude": "mm"}),
        (ACCELERATION, {**DRIVEN, "gama": 3}, {"gama": "Did you mean 'gamma' (climb)?"}),
        (ACCELERATION, {**DRIVEN, "radius": 0.5}, {"radius": "not used by rectangle"}),
        (VELOCITY, {**DRIVEN, "radius": 0.5}, {"distance": "missing"}),
        (ACCELERATION, {**DRIVEN, "beta": {"start": 90, "stop": 90, "num": 9}},
         {"beta": "both 90"}),
        (ACCELERATION, {**DRIVEN, "friction": -0.3}, {"friction": "at least 0"}),
        (("rectangle-on-track", ["wall_force_front"]),
         {**DRIVEN, "length": 1.2, "radius": 0.5, "width": 0.01, "mass": 1},
         {"length": "twice the radius"}),
        # Problems of values and of the plan come together.
        (VELOCITY, {**DRIVEN, "frequency": "5 kg", "diameter": 0.01, "radius": 0.5},
         {"frequency": "", "diameter": "", "distance": ""}),
        # Friction is one number or two, and static is the larger.
        (ACCELERATION, {**DRIVEN, "friction_static": 0.4}, {"friction": "either"}),
        (ACCELERATION, {**MOVED, "friction_static": 0.2, "friction_kinetic": 0.4},
         {"friction_static": "raise it"}),
        (ACCELERATION, MOVED, {"friction": "missing"}),
        # A radius is needed only where speed makes it matter.
        (("rectangle-on-track", ["acceleration_x"]), {**DRIVEN, "speed": 0.2},
         {"radius": "missing"}),
    ],
)  # fmt: skip
def test_likely_mistakes_get_one_message_each(asked, parameters, problems):
    told = told_of(prepare_content, content(*asked, **parameters))
    assert told.keys() == {f"parameters.{name}" for name in problems}
    assert all(words in told[f"parameters.{name}"] for name, words in problems.items())


def test_a_study_that_is_too_large_is_told_what_fits():
    axis = {"start": 0, "stop": 1e-3, "num": 1_000_000}
    large = {**DRIVEN, "amplitude": axis, "friction": {**axis, "stop": 1}}
    prepared = prepare_content(content(*ACCELERATION, **large))
    with pytest.raises(LimitError, match=r"1,000,000,000,000 cells.*It fits with"):
        prepared.check_limits(cells=10**8, bytes_=10**9)


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"scene": "rectangle-on-plain"}, "scene", "Did you mean 'rectangle-on-plane'?"),
        ({"variant": "phisical"}, "variant", "Did you mean 'physical'?"),
        ({"outputs": ["acceleration"]}, "outputs", "Did you mean"),
        (
            {"outputs": ["z_residual"], "scene": "rectangle-on-track"},
            "outputs",
            "thesis or derived",
        ),
    ],
)
def test_wrong_names_are_answered_with_the_right_ones(change, place, words):
    study = content("rectangle-on-plane", ["throw_number"], **MOVED)
    assert any(
        p.place == place and words in p.fix
        for p in problems_of(prepare_content, {**study, **change})
    )


@pytest.mark.parametrize(
    ("scene", "variant", "output", "used"),
    [
        ("rectangle-on-track", "physical", "acceleration_x", "physical"),
        ("rectangle-on-track", "physical", "transport_velocity", "derived"),
        ("rectangle-on-track", "physical", "starting_acceleration", "derived"),
        ("rectangle-on-track", "physical", "wall_speed", "physical"),
        ("rectangle-on-track", "thesis", "acceleration_x", "thesis"),
        ("rectangle-on-track", "thesis", "transport_velocity", "thesis"),
        ("rectangle-on-track", "derived", "acceleration_y", "derived"),
        ("rectangle-on-plane", "derived", "acceleration_x", "thesis"),
        ("cylinder-on-plane", "derived", "angular_acceleration", "derived"),
        ("cylinder-on-plane", "physical", "rotated_acceleration_x", "physical"),
    ],
)
def test_every_output_names_the_variant_that_it_really_uses(scene, variant, output, used):
    assert SCENES[scene].variant_of(variant, output) == used


def test_radius_is_needed_only_where_speed_makes_it_matter():
    track = ("rectangle-on-track", ["acceleration_x"])
    at_rest = prepare_content(content(*track, **DRIVEN))
    assert "centripetal_acceleration" in at_rest.plan.defaults
    prepare_content(content(*track, **DRIVEN, radius=0.5))


class TestScenes:
    def test_what_the_catalogue_lists_can_be_asked_for(self):
        for system in SYSTEMS.values():
            for method in system.variants:
                listed = [one["name"] for one in describe(system.name, method=method)["outputs"]]
                assert listed == [n for n in system.outputs(method) if n != "regime"]

    def test_regime_values_are_distinct_and_without_gaps(self):
        values = [regime.value for regime in REGIMES.values()]
        assert sorted(values) == list(range(len(values)))

    @pytest.mark.parametrize(
        ("equations", "conditions", "words"),
        [
            ([("mass", "width"), ("mass", "height")], [], "two equations"),
            ([("speed", "time"), ("time", "speed")], [], "needs"),
            ([("nonsense", "mass")], [], "not declared"),
            ([("speed", "wall_force")], [], "nothing gives"),
            ([("speed", "mass")], ["typo"], "which no variant gives"),
        ],
    )
    def test_an_unsound_scene_is_refused(self, equations, conditions, words):
        def function(argument):
            namespace: dict[str, object] = {}
            exec(f"def f(*, {argument}): return {argument}", namespace)
            return namespace["f"]

        with pytest.raises(SceneError, match=words):
            Scene(
                "s", "t", "1", "v",
                {"only": tuple(Equation(g, function(n), "1") for g, n in equations)},
                "only",
                {"only": tuple(
                    Condition("slip", function("mass"), frozenset((n,))) for n in conditions
                )},
            )  # fmt: skip


def test_a_problem_says_which_name_it_is_about_beside_what_users_see():
    long = "speed_" + 70 * "x"
    (problem, *_) = [
        p
        for p in problems_of(make_plan, "rectangle-on-plane", None, [long], ())
        if p.place == "outputs"
    ]
    # The message shows the first 60 characters; the field has them all.
    assert problem.about == long
    assert long not in f"{problem!r} {problem}"


def test_what_one_output_needs_is_found_once():
    outputs = ("acceleration_x", "throw_number")
    plan = make_plan("rectangle-on-plane", None, outputs, (*DRIVE, "friction"))
    assert plan.only("throw_number") is plan.only("throw_number")
    assert plan.only("throw_number").parameters == DRIVE
    plan.depends_on({"beta": "beta"})["throw_number"] = frozenset()  # the caller's own
    assert plan.depends_on({"beta": "beta"})["throw_number"] == {"beta"}


ERRORS = {
    "conveying_velocity_error", "conveying_velocity_spread", "yield_deviation",
    "transit_time_error", "bottleneck_velocity_error", "velocity_error",
}  # fmt: skip
COUNTS = {
    "period_multiple", "impacts_per_period", "impact_count", "platoons", "friction_seed",
    "device_order", "spring_count", *(f"platoon_size_{n}" for n in range(1, 11)),
}  # fmt: skip


def test_flags_counts_and_errors_have_no_derivative():
    none = {name for name, quantity in QUANTITIES.items() if not quantity.is_derived}
    assert none == {*FLAGS, *ERRORS, *COUNTS, "design"}
    assert all(QUANTITIES[name].error_of in QUANTITIES for name in ERRORS)


@pytest.mark.parametrize("name", FLAGS)
def test_a_flag_takes_a_byte_and_its_values_fit(name):
    values = [flag.value for flag in FLAGS[name].values()]
    assert (QUANTITIES[name].width, QUANTITIES[name].compared) == (1, False)
    assert values == [*range(len(values))]
    assert len(values) <= 128


def test_words_of_numbers_from_0_on_leave_none_out():
    said = [[*one.words] for one in QUANTITIES.values() if one.words and 0 in one.words]
    assert said == [[*range(len(numbers))] for numbers in said]
