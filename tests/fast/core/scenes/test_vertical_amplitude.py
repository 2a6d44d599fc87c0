"""The vertical amplitude that a stroke gauge reads, beside the angle of the drive."""

import numpy as np
import pytest

import vibrafeed
from refusals import problems_of
from vibrafeed.core.catalogue import asked_parameters, describe, needed_parameters
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.plan import plan_scene, run_equations, scene_parameters
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.unusual import questions

PLANE = {"scene": "rectangle-on-plane", "frequency": "50 Hz", "gamma": 2, "friction": 0.3}
ORDINARY = {
    "frequency": 50.0, "beta": 0.4, "amplitude": 1e-4, "height": 0.01, "length": 0.03,
    "diameter": 0.02, "small_diameter": 0.01, "sides": 6.0, "centre_of_mass": 0.01,
    "radius_of_gyration": 0.01, "friction_static": 0.4, "friction_kinetic": 0.3, "row_mass": 0.02,
}  # fmt: skip
DRIVEN = [
    (known, name, variant)
    for known in (SCENES, SYSTEMS)
    for name, scene in known.items()
    for variant in scene.variants
    if {"amplitude", "beta"} <= {*scene_parameters(scene, variant)} and variant != "mesh"
]


def simulated(**more):
    return float(
        vibrafeed.simulate(outputs=["conveying_velocity"], **PLANE, **more).conveying_velocity
    )


def refusal(**more):
    return [
        str(problem)
        for problem in problems_of(vibrafeed.sweep, outputs=["acceleration_x"], **{**PLANE, **more})
    ]


def test_the_speed_of_a_bowl_whose_gauge_reads_the_vertical_stroke():
    """0.4 mm from peak to peak: 80 mm/s if it is the vertical one, 7 mm/s if it is along.

    The right value is that of the amplitude 0.2 mm/sin(25 deg) along the drive, as a designer
    works it out by hand: throw number 0.2 mm (2 pi 50 Hz)^2/(g cos(2 deg)) = 2.014.
    """
    for given, speed in (
        ({"vertical_amplitude": "0.2 mm"}, 0.0805),
        ({"vertical_peak_to_peak": "0.4 mm"}, 0.0805),
        ({"amplitude": 0.2e-3 / float(np.sin(np.deg2rad(25.0)))}, 0.0805),
        ({"peak_to_peak": "0.4 mm"}, 0.0070),
    ):
        assert simulated(beta=25, **given) == pytest.approx(speed, abs=1e-4)
    by_hand = 0.2e-3 * (2 * np.pi * 50) ** 2 / (9.80665 * np.cos(np.deg2rad(2)))
    for beta in ([10, 25, 70], -30):  # whatever the angle; downwards the amplitude is the same
        thrown = vibrafeed.sweep(
            scene="rectangle-on-plane", outputs=["throw_number"], frequency=50, gamma=2,
            beta=beta, vertical_amplitude="0.2 mm",
        )  # fmt: skip
        assert np.abs(thrown.throw_number.values) == pytest.approx(by_hand, rel=1e-14)


@pytest.mark.parametrize(
    ("known", "name", "variant"), DRIVEN, ids=[f"{name}-{v}" for _, name, v in DRIVEN]
)
def test_every_scene_with_amplitude_and_angle_takes_it(known, name, variant):
    scene = known[name]
    output = next(
        one
        for one in scene.outputs(variant)
        if {"amplitude", "beta"} <= {*needed_parameters(scene, variant, one)}
    )
    # A system's output needs its status as a rule, but numbers of the drive do not.
    needed = {*asked_parameters(scene, variant, output, required=True), "beta", "amplitude"}
    if known is SYSTEMS and output.startswith("drive_number"):
        needed = {*needed_parameters(scene, variant, output)} - {*scene.defaults_of(variant)}
    plain = plan_scene(scene, variant, [output], needed)
    for vertical, factor in (("vertical_amplitude", 1.0), ("vertical_peak_to_peak", 2.0)):
        plan = plan_scene(scene, variant, [output], needed - {"amplitude"} | {vertical})
        # A study with an amplitude carries nothing of it.
        more = {e.gives for e in plan.equations} - {e.gives for e in plain.equations}
        assert more == {"amplitude"}
        if known is SCENES:
            cells = {n: np.array([ORDINARY[n]]) for n in needed}
            expected = run_equations(plain, cells)[output]
            cells[vertical] = factor * cells.pop("amplitude") * np.sin(ORDINARY["beta"])
            assert run_equations(plan, cells)[output] == pytest.approx(expected, rel=1e-13)


def test_it_is_an_axis_a_variable_and_uncertain():
    sweep = {"scene": "rectangle-on-plane", "frequency": 50}
    grid = {"vertical_amplitude": ["0.1 mm", "0.2 mm"], "beta": [20, 30]}
    found = vibrafeed.sweep(outputs=["vibration_acceleration"], **sweep, **grid)
    by_hand = np.outer([1e-4, 2e-4], 1 / np.sin(np.deg2rad([20, 30]))) * (100 * np.pi) ** 2
    assert found.vibration_acceleration.values == pytest.approx(by_hand, rel=1e-14)
    best = vibrafeed.optimise(
        criterion={"kind": "maximise", "output": "throw_number"}, beta=20, gamma=2, **sweep,
        variables={"vertical_amplitude": {"lower": "0.01 mm", "upper": "0.09 mm"}},
    )  # fmt: skip
    assert float(best.best_vertical_amplitude) == pytest.approx(0.09e-3)
    normal = {"vertical_amplitude": {"mean": "0.2 mm", "deviation": "0.01 mm"}}
    spread = vibrafeed.sensitivity(outputs=["drive_normal"], beta=20, **sweep, uncertain=normal)
    deviation = 0.01e-3 * (100 * np.pi) ** 2  # of the part normal to the floor
    assert float(spread.drive_normal_deviation) == pytest.approx(deviation, rel=1e-3)


def test_it_is_refused_where_the_drive_has_no_vertical_part():
    for beta in (0, 180, [0, 10], {"start": -10, "stop": 10, "num": 4}):
        (problem,) = refusal(beta=beta, vertical_amplitude="0.2 mm")
        assert problem.startswith("parameters.beta: beta reaches 0 or 180 degrees")
    (problem,) = refusal(vertical_amplitude="0.2 mm")
    assert problem.startswith("parameters.beta: it is missing; amplitude of")
    with pytest.raises(StudyError, match="the angle of the drive above the floor is missing"):
        vibrafeed.simulate(
            scene="rectangle-isolated", outputs=["final_pitch"], frequency=50, friction=0.3,
            vertical_amplitude="0.2 mm", height="5 mm", length="20 mm", restitution=0.3,
            duration="0.1 s", drop_height="1 mm",
        )  # fmt: skip


@pytest.mark.parametrize("other", ["amplitude", "peak_to_peak", "vertical_peak_to_peak"])
def test_an_amplitude_is_given_once(other):
    problems = refusal(beta=20, vertical_amplitude="0.2 mm", **{other: "0.3 mm"})
    assert any("set the same quantity" in one for one in problems)


def test_the_catalogue_says_what_it_is_given_for():
    told = {one["name"]: one for one in describe("rectangle-on-plane")["parameters"]}
    for name in ("vertical_amplitude", "vertical_peak_to_peak", "peak_to_peak"):
        assert told[name]["instead_of"] == ["amplitude"]
    assert told["beta"]["instead_of"] == []


def test_the_amplitude_that_it_makes_is_judged():
    for parameters, more, words in (
        ({"vertical_amplitude": "20 mm", "beta": "10 deg"}, {},
         "vertical_amplitude and beta make amplitude = 115.175 mm along the drive; usual values "
         "are 0.0001 to 25 mm. Is that what you mean?"),
        ({"vertical_peak_to_peak": ["1 mm", "6 mm"]},
         {"variables": {"beta": {"lower": 5, "upper": 60}}}, "make peak_to_peak = 68.8423 mm"),
        ({"vertical_amplitude": 0.2, "beta": 20}, {}, 'Did you mean "0.2 mm"?'),
    ):  # fmt: skip
        (question,) = questions({"parameters": parameters, **more})
        assert words in question
    assert questions({"parameters": {"vertical_amplitude": "0.2 mm", "beta": 20}}) == []
