"""Drive units: worked values, the linear system itself, the balance of power, and limits."""

import inspect

import mpmath
import numpy as np
import pytest
from scipy.optimize import brentq

import vibrafeed
from night import count
from vibrafeed.core.errors import StudyError
from vibrafeed.core.mechanics import drive_unit
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import drive_units

LINEAR = {
    "scene": "linear-drive-unit", "moving_mass": 10, "base_mass": 30, "damping_ratio": 0.02,
    "frequency": 50, "drive_force": 100,
}  # fmt: skip
RUNG = {**LINEAR, "variant": "measured", "ring_down_frequency": 53}
LEAVES = {
    "spring_count": 8, "spring_width": "40 mm", "spring_thickness": "3 mm",
    "spring_length": "100 mm", "elastic_modulus": "206 GPa",
}  # fmt: skip
BOWL = {
    "scene": "bowl-drive-unit", "moving_mass": 12, "base_mass": 40, "moving_inertia": 0.25,
    "base_inertia": 0.9, "spring_radius": "150 mm", "spring_angle": 20, "spring_count": 4,
    "spring_width": "50 mm", "spring_thickness": "4 mm", "spring_length": "120 mm",
    "elastic_modulus": "206 GPa", "frequency": 50, "drive_force": 100, "damping_ratio": 0.02,
}  # fmt: skip
RANDOM = count(2_000, 100_000)
EPS = float(np.finfo(float).eps)
ROUNDING = 1e-12
"""Some hundred roundings, where nothing cancels but near a zero of the response."""


def one(outputs, **given):
    found = vibrafeed.sweep(**given, outputs=outputs)
    return [float(found[name]) for name in outputs]


# --- worked values, of the problem's own statement


def test_leaves_and_their_natural_frequency():
    # 8 leaves of 40 x 3 x 100 mm: 8 E b (t/L)^3 = 1 779 840 N/m; masses of 10 and 30 kg.
    k = drive_unit.leaf_stiffness(
        spring_count=8.0, elastic_modulus=206e9, spring_width=0.04, spring_thickness=0.003,
        spring_length=0.1, clamp_factor=1.0,
    )  # fmt: skip
    assert k == pytest.approx(1_779_840, rel=1e-14)
    f, _ = one(["natural_frequency", "stroke"], **LINEAR, **LEAVES)
    assert f == pytest.approx(77.5318205, abs=5e-8)
    held, _ = one(["natural_frequency", "stroke"], **{**LINEAR, "base_mass": 1e12}, **LEAVES)
    assert held == pytest.approx(67.1445261, abs=5e-8)
    stress = drive_unit.spring_stress(
        elastic_modulus=206e9, spring_thickness=0.003, spring_length=0.1, stroke=5e-4
    )
    assert stress == pytest.approx(92.7e6, rel=1e-14)


def test_a_leaf_by_itself():
    names = ["leaf_frequency", "leaf_mass"]
    f, mass = one(names, scene="linear-drive-unit", **LEAVES, spring_density=7850)
    assert f == pytest.approx(1579.717, abs=5e-4)
    assert mass == pytest.approx(13 / 35 * 8 * 7850 * 0.04 * 0.003 * 0.1, rel=1e-9)
    root = brentq(lambda x: np.cos(x) - 1 / np.cosh(x), 4.5, 5, xtol=1e-14)
    assert root**2 == pytest.approx(drive_unit.FIRST_MODE, rel=1e-13)


def test_the_response_of_a_tuned_unit():
    names = ["stroke", "track_amplitude", "phase", "drive_unit_power"]
    found = one(names, **RUNG)
    known = [1.03386110e-3, 0.77539583e-3, -18.934125, 5.2695209]
    assert (np.abs(np.array(found) - known) <= [5e-12, 5e-12, 5e-7, 5e-8]).all()


def test_a_load_raises_the_amplitude_of_a_stiff_unit_and_lowers_that_of_a_soft_one():
    # Tuned to 47 Hz by other springs, beside the same dampers.
    soft = {**RUNG, "ring_down_frequency": 47, "damping_ratio": 0.02 * 53 / 47}
    loaded = {"load_mass": 0.3}
    found = [one(["track_amplitude"], **unit)[0] for unit in (RUNG | loaded, soft, soft | loaded)]
    assert found == pytest.approx([0.9160307e-3, 0.81788543e-3, 0.69324416e-3], abs=5e-11)


@pytest.mark.parametrize(
    ("unit", "elasticities"),
    [
        # To k -8.133483887 at constant c; c grows with the root of k, and k with f^2.
        (RUNG, {"ring_down_frequency": (-8.133483887, 2), "drive_force": (1, 0)}),
        # To m_r 7.238771705 at constant k and c; c grows with its root, m_r by m2/(m1 + m2) of m1.
        (
            {**LINEAR, "spring_stiffness": (2 * np.pi * 53) ** 2 * 7.5},
            {"moving_mass": (7.238771705, 0.75)},
        ),
    ],
)
def test_elasticities_are_derivatives_of_the_sweep(unit, elasticities):
    asked = vibrafeed.sweep(**unit, outputs=["stroke"], sensitivities=[*elasticities])
    to_c = -((2 * np.pi * 50 * 99.90264638415542) ** 2) * (1.0338611024090685e-3 / 100) ** 2
    for name, (to_itself, share) in elasticities.items():
        expected = share * (to_itself + to_c / 2) if share else to_itself
        assert float(asked[f"sensitivity_stroke_to_{name}"]) == pytest.approx(expected, abs=1e-8)


def test_a_bowl_and_the_angle_of_its_vibration():
    names = ["natural_frequency", "vibration_angle", "stroke"]
    f, angle, _ = one(names, **BOWL, radius=0.25)
    assert f == pytest.approx(66.4321356, abs=5e-8)
    assert angle == pytest.approx(12.114663, abs=5e-7)
    held = {**BOWL, "base_mass": 1e12, "base_inertia": 1e12, "radius": 0.25}
    assert one(["vibration_angle"], **held) == pytest.approx([12.318971], abs=5e-7)
    lifts = vibrafeed.sweep(**BOWL, outputs=["bowl_lift"], radius=[0.1, 0.2, 0.3])
    assert np.ptp(lifts.bowl_lift.values) == 0, "the lift is the same at every radius"


# --- another method, and laws


def units(seed: int) -> dict[str, np.ndarray]:
    pick = np.random.default_rng(seed)
    return {
        "drive_force": pick.uniform(1, 500, RANDOM),
        "circular_frequency": 2 * np.pi * pick.uniform(10, 120, RANDOM),
        "spring_stiffness": 10 ** pick.uniform(4, 7, RANDOM),
        "damping": 10 ** pick.uniform(0, 3, RANDOM),
        "foot_stiffness": 10 ** pick.uniform(3, 6, RANDOM) * (pick.random(RANDOM) < 0.8),
        "foot_damping": pick.uniform(0, 500, RANDOM),
        "loaded_mass": 10 ** pick.uniform(-0.5, 2, RANDOM),
        "load_damping": pick.uniform(0, 200, RANDOM) * (pick.random(RANDOM) < 0.8),
        "base_mass": 10 ** pick.uniform(-0.5, 2.5, RANDOM),
    }


def test_strokes_solve_the_linear_system_and_power_is_that_of_the_dampers():
    unit = units(37)
    real, imag, x1, x2 = drive_units.stroke_response(**unit)
    w, c, c_f = unit["circular_frequency"], unit["damping"], unit["foot_damping"]
    z = unit["spring_stiffness"] + 1j * w * c
    feet = unit["foot_stiffness"] + 1j * w * c_f
    system = np.empty((RANDOM, 2, 2), dtype=complex)
    c_l = unit["load_damping"]
    system[:, 0, 0], system[:, 0, 1] = z - unit["loaded_mass"] * w**2 + 1j * w * c_l, -z
    system[:, 1, 0], system[:, 1, 1] = -z, z + feet - unit["base_mass"] * w**2
    force = np.stack([unit["drive_force"], -unit["drive_force"]], axis=1)[..., np.newaxis]
    # Gauss loses what the condition of the system is; the closed form does not.
    loss = np.linalg.cond(system) * 1e-15
    right = np.linalg.solve(system, force)[..., 0]
    s = right[:, 0] - right[:, 1]
    size = np.abs(right).max(axis=1)
    assert (np.abs(real + 1j * imag - s) <= (ROUNDING + loss) * size).all()
    assert (np.abs(x1 - np.abs(right[:, 0])) <= (ROUNDING + loss) * size).all()
    assert (np.abs(x2 - np.abs(right[:, 1])) <= (ROUNDING + loss) * size).all()
    power = drive_unit.drive_unit_power(
        drive_force=unit["drive_force"], circular_frequency=w, stroke_response=(real, imag, x1, x2)
    )
    lost = (c * (w * np.hypot(real, imag)) ** 2 + c_f * (w * x2) ** 2 + c_l * (w * x1) ** 2) / 2
    assert power == pytest.approx(lost, rel=ROUNDING)


def size_of(*numbers):
    return sum(abs(number) for number in numbers)


def bowl_by_definition(F, w, k, c, m1, m2, i1, i2, c_l, r_l, r_s, th):
    m1, i1 = mpmath.mpc(m1, -c_l / w), mpmath.mpc(i1, -c_l * r_l**2 / w)
    m = (
        i1 * i2 / (i1 + i2) * (mpmath.cos(th) / r_s) ** 2
        + m1 * m2 / (m1 + m2) * mpmath.sin(th) ** 2
    )
    d = k - m * w * w + 1j * w * c
    return F / d, size_of(k, m * w * w, w * c) / abs(d)


def of_bowl(F, w, k, c, m1, m2, i1, i2, c_l, r_l, r_s, th):
    return drive_unit.bowl_response(
        drive_force=F, circular_frequency=w, spring_stiffness=k, damping=c, loaded_mass=m1,
        base_mass=m2, loaded_inertia=i1, base_inertia=i2, load_damping=c_l, load_radius=r_l,
        spring_radius=r_s, spring_angle=th,
    )  # fmt: skip


DECADES = {
    "F": (-4, 4), "w": (-2, 5), "k": (2, 10), "c": (-9, 4), "k_f": (0, 8), "c_f": (-9, 4),
    "m1": (-6, 5), "m2": (-6, 5), "i1": (-9, 2), "i2": (-9, 2), "c_l": (-9, 4), "r_l": (-2, 0),
    "r_s": (-2, 0), "along": (-3, 0), "upward": (-3, 0), "th": (-2, 0),
}  # fmt: skip


def test_the_power_of_extreme_units_has_the_digits_of_its_inputs():
    pick = np.random.default_rng(41)
    for _ in range(count(150, 5_000)):
        names = inspect.signature(of_bowl).parameters
        given = {name: float(10 ** pick.uniform(*DECADES[name])) for name in names}
        real, imag = of_bowl(**{name: np.array(value) for name, value in given.items()})[:2]
        power = drive_unit.drive_unit_power(
            drive_force=given["F"], circular_frequency=given["w"], stroke_response=(real, imag)
        )
        with mpmath.workdps(60):
            exact = {name: mpmath.mpf(value) for name, value in given.items()}
            stroke, condition = bowl_by_definition(**exact)
            right = -exact["F"] * exact["w"] * stroke.imag / 2
            assert abs(power - right) <= 64 * EPS * condition * right, given


@pytest.mark.parametrize(
    ("k_f", "c_f", "c_l", "right"),
    [
        (50, 1, 0, 1.02223031465e-28),  # once 1.02223029922e-28
        (0, 1e-6, 1, 3.49173100998e-31),  # once 3.49172802520e-31
        (0, 0, 0, 3.48946339002e-31),
    ],
)
def test_the_power_keeps_its_digits_far_from_resonance(k_f, c_f, c_l, right):
    """A damping ratio of 1e-8, driven at 4e-6 of the natural frequency; by F Q/D in 50 digits."""
    (power,) = one(
        ["drive_unit_power"], scene="linear-drive-unit", variant="measured", moving_mass=1938.7,
        base_mass=3.24, ring_down_frequency=14031, damping_ratio=1.02e-8, frequency=0.0528,
        drive_force=8.3e-4, foot_stiffness=k_f, foot_damping=c_f, load_damping=c_l,
    )  # fmt: skip
    assert power == pytest.approx(right, rel=3e-12)


def test_both_natural_frequencies_are_those_of_the_matrices():
    unit = units(38)
    names = ("spring_stiffness", "foot_stiffness", "loaded_mass", "base_mass")
    k, k_f, m1, m2 = (unit[name] for name in names)
    matrix = np.empty((RANDOM, 2, 2))
    matrix[:, 0, 0], matrix[:, 1, 1] = k / m1, (k + k_f) / m2
    matrix[:, 0, 1] = matrix[:, 1, 0] = -k / np.sqrt(m1 * m2)
    low, high = np.linalg.eigvalsh(matrix).T
    given = {name: unit[name] for name in names}
    top = drive_units.natural_frequency(**given)
    assert (2 * np.pi * top) ** 2 == pytest.approx(high, rel=ROUNDING)
    bottom = (2 * np.pi * drive_units.foot_frequency(**given)) ** 2
    # An eigenvalue of a symmetric matrix is known to the rounding of the largest.
    assert (np.abs(bottom - low) <= ROUNDING * high).all()


STILL = {name: value for name, value in RUNG.items() if name != "drive_force"}


@pytest.mark.parametrize(
    ("given", "force"),
    [
        # Driven with the square of the frequency.
        ({"unbalance": "0.002 kg m"}, 0.002 * (2 * np.pi * 50) ** 2),
        # 1 T on 1 cm2 pulls with B^2 A/(2 mu_0) = 39.7887 N at most: an amplitude of half of that.
        ({"flux_density": "1 T", "pole_area": "1 cm^2"}, 39.7887 / 2),
    ],
)
def test_an_unbalance_and_a_magnet_drive_with_known_forces(given, force):
    (driven,) = one(["stroke"], **STILL, **given)
    by_hand = one(["stroke"], **{**RUNG, "drive_force": force})[0]
    assert driven == pytest.approx(by_hand, rel=2e-6)


@pytest.mark.parametrize(
    ("given", "outputs", "regime"),
    [
        ({}, ["stroke"], "tuned_stiff"),
        ({"ring_down_frequency": 47}, ["stroke"], "tuned_soft"),
        ({"ring_down_frequency": 50.5}, ["stroke"], "resonance"),
        ({"air_gap": "1 mm"}, ["air_gap_margin"], "hits_magnet"),
        ({"air_gap": "3 mm"}, ["air_gap_margin"], "tuned_stiff"),
        ({"foot_stiffness": 1e6}, ["foot_force"], "isolation_poor"),
        ({"foot_stiffness": 1e4}, ["foot_force"], "tuned_stiff"),
        ({"foot_stiffness": 1e6, "ring_down_frequency": 46.9}, ["foot_force"], "resonance"),
        (
            {"allowable_stress": 1e8, "elastic_modulus": "206 GPa", "spring_thickness": "3 mm",
             "spring_length": "100 mm"},
            ["stress_margin"], "overstressed",
        ),
    ],
)  # fmt: skip
def test_regimes_tell_the_side_of_the_tuning_and_what_does_not_last(given, outputs, regime):
    found = vibrafeed.sweep(**{**RUNG, **given}, outputs=outputs)
    assert int(found.regime) == REGIMES[regime].value


def test_the_second_harmonic_of_a_half_wave():
    # F_2/F_1 = 1/4, f_n 53 Hz, f 50 Hz: 0.01074 of the displacement, 4.3 % of the acceleration,
    # by |w_n^2 - w^2|/|w_n^2 - 4 w^2| without damping; the side of the pull changes no size.
    still = {**STILL, "damping_ratio": 1e-9}
    share, back = (one(["second_harmonic"], **still, force_harmonic=h)[0] for h in (0.25, -0.25))
    assert share == back == pytest.approx(4 * 0.01074, abs=2e-5)


def turning_by_newton(unit, w):
    """Two free bodies in the plane, joined by a guide along e: Newton and Euler, solved by Gauss.

    Unknown are the six accelerations' amplitudes, and force across and couple in the guide.
    """
    m1, m2, i1, i2, k, c, force, d, e, p = unit
    z, across = k + 1j * w * c, np.array([-e[1], e[0]])
    system, right = np.zeros((8, 8), dtype=complex), np.zeros(8, dtype=complex)
    # x1, z1, turn 1, x2, z2, turn 2, force across, couple; the guide's force acts at centre 1.
    s = np.zeros(8)
    s[0:2], s[3:5] = e, -e
    # The base's point below centre 1 moves by its own turning, too: d behind centre 2.
    s[5] = -(e[1] * d[0] - e[0] * d[1])
    for axis in range(2):
        system[axis, axis] = -m1 * w * w
        system[3 + axis, 3 + axis] = -m2 * w * w
        system[axis] += z * e[axis] * s
        system[3 + axis] -= z * e[axis] * s
        system[axis, 6], system[3 + axis, 6] = across[axis], -across[axis]
        right[axis], right[3 + axis] = force * e[axis], -force * e[axis]
    system[2, 2], system[5, 5] = -i1 * w * w, -i2 * w * w
    system[2, 7], system[5, 7] = 1.0, -1.0
    lever = d[0] * e[1] - d[1] * e[0]
    system[5] -= z * lever * s
    right[5] = -force * lever
    system[5, 6] = -(d[0] * across[1] - d[1] * across[0])
    # No motion across the guide, no turn of one against the other.
    system[6, 0:2], system[6, 3:5] = across, -across
    system[6, 5] = -(across[1] * d[0] - across[0] * d[1])
    system[7, 2], system[7, 5] = 1.0, -1.0
    found = np.linalg.solve(system, right)
    at_place = found[0:2] + found[2] * np.array([-p[1], p[0]])
    return s @ found, at_place


def test_a_unit_whose_line_of_action_misses_its_mass_centres_turns():
    pick = np.random.default_rng(39)
    for _ in range(50):
        m1, m2 = pick.uniform(3, 20), pick.uniform(10, 60)
        i1, i2 = pick.uniform(0.05, 0.6), pick.uniform(0.2, 2)
        d, p = pick.uniform(-0.15, 0.15, 2), pick.uniform(-0.4, 0.4, 2)
        th, k, f = np.radians(pick.uniform(10, 40)), pick.uniform(3e5, 2e6), pick.uniform(30, 70)
        force = 100.0
        given = {
            "scene": "linear-drive-unit", "variant": "springs_turning", "frequency": f,
            "moving_mass": m1, "base_mass": m2, "moving_inertia": i1, "base_inertia": i2,
            "spring_stiffness": k, "spring_angle": float(np.degrees(th)), "drive_force": force,
            "offset_along": d[0], "offset_upward": d[1], "spot_along": p[0], "spot_upward": p[1],
        }  # fmt: skip
        e = np.array([np.cos(th), np.sin(th)])
        names = ["stroke", "track_amplitude", "vibration_angle", "damping"]
        stroke, amplitude, angle, c = one(names, **given, damping_ratio=0.01)
        s, moved = turning_by_newton((m1, m2, i1, i2, k, c, force, d, e, p), 2 * np.pi * f)
        assert stroke == pytest.approx(abs(s), rel=1e-9)
        assert amplitude == pytest.approx(np.linalg.norm(np.abs(moved)), rel=1e-9)
        way = (moved / s).real
        assert np.tan(np.radians(angle)) == pytest.approx(way[1] / way[0], rel=1e-7)


# --- the best unit


BEST = {
    "scene": "linear-drive-unit",
    "criterion": {"kind": "maximise", "output": "track_amplitude"},
    "constraints": [{"output": "stress_margin", "lower": 0}],
    "frequency": 50, "moving_mass": 10, "damping_ratio": 0.02, "drive_force": 60,
    "spring_width": 0.04, "spring_thickness": 0.0025, "spring_length": 0.1, "clamp_factor": 0.9,
    "elastic_modulus": 206e9, "allowable_stress": 150e6,
}  # fmt: skip


def best(**more):
    given = {**BEST, **more}
    keys = {name: given.pop(name) for name in ("scene", "criterion", "constraints", "variables")}
    return vibrafeed.optimise(**keys, parameters=given)


MEASURED = {"measured_voltage": "150 V", "measured_amplitude": "0.15 mm", "measured_frequency": 48}
TURNING = {
    **LINEAR, "variant": "measured_turning", "ring_down_frequency": 53, "moving_inertia": 0.3,
    "base_inertia": 1, "offset_along": 0.05, "offset_upward": 0.1, "spot_along": 0.1,
    "spring_angle": 20,
}  # fmt: skip


@pytest.mark.parametrize("unit", [RUNG, TURNING, {**BOWL, "radius": 0.2, "measured_radius": 0.2}])
def test_a_voltage_gives_the_force_from_one_measured_amplitude(unit):
    """The unit has the measured amplitude there, and another with a load and elsewhere."""
    unit = {name: value for name, value in unit.items() if name != "drive_force"} | MEASURED
    at = {**unit, "frequency": 48}
    for voltage, exponent, amplitude in ((150, {}, 0.15e-3), (180, {}, 0.216e-3),
                                         (180, {"force_exponent": 1}, 0.18e-3)):  # fmt: skip
        found = one(["track_amplitude"], **at, **exponent, drive_voltage=voltage)
        assert found == [pytest.approx(amplitude, rel=1e-13)]
    given = {name: value for name, value in unit.items() if not name.startswith("measured_")}
    (there,) = one(["track_amplitude"], **unit, drive_voltage=150, load_mass=0.5)
    (here,) = one(["track_amplitude"], **{**given, "frequency": 48}, drive_force=1)
    (other,) = one(["track_amplitude"], **given, drive_force=1, load_mass=0.5)
    assert there == pytest.approx(0.15e-3 * other / here, rel=1e-12)


def test_a_voltage_alone_is_asked_for_its_measured_amplitude():
    unit = {name: value for name, value in RUNG.items() if name != "drive_force"}
    with pytest.raises(StudyError) as caught:
        one(["track_amplitude"], **unit, drive_voltage=150)
    places = [problem.place for problem in caught.value.problems]
    assert places == [f"parameters.{name}" for name in MEASURED]


def test_the_number_of_leaves_is_chosen_among_whole_numbers():
    """As the best of every single number; bounds that are none are those of the numbers between."""
    ends = {"base_mass": {"lower": 15, "upper": 60}}
    every = best(variables=ends, spring_count=list(range(3, 13)))
    chosen = best(variables={**ends, "spring_count": {"lower": 2.6, "upper": 12.4}})
    assert float(chosen.best_spring_count) == int(every.objective.values.argmax()) + 3
    assert float(chosen.objective) == pytest.approx(float(every.objective.max()), rel=1e-6)
    with pytest.raises(StudyError, match="no two whole numbers"):
        best(variables={"spring_count": {"lower": 5.2, "upper": 6.4}}, base_mass=30)
