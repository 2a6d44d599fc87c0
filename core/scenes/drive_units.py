"""Drive units of linear and bowl feeders; the equations of the linear one (theory 15.2).

A linear unit has trough and base, on a line through both mass centres, on feet; its leaves are
tilted from the vertical by the angle of the line above the horizontal.
"""

import numpy as np

from vibrafeed.core.mechanics import drive_unit
from vibrafeed.core.mechanics.arrays import Array, cosine, hypot, sine
from vibrafeed.core.scenes.scene import Condition, Equation, Scene, fields, under_names


def natural_frequency(
    *, spring_stiffness: Array, foot_stiffness: Array, loaded_mass: Array, base_mass: Array
) -> Array:
    """Return the undamped natural frequency of trough against base on the leaf springs [Hz].

    The higher root of m1 m2 w^4 - (k (m1 + m2) + k_f m1) w^2 + k k_f = 0, with the stiffness k of
    the leaves and k_f of the feet, m1 of the loaded trough, m2 of the base.
    """
    upper, _ = _squared_roots(spring_stiffness, foot_stiffness, loaded_mass, base_mass)
    return np.sqrt(upper) / (2 * np.pi)


def foot_frequency(
    *, spring_stiffness: Array, foot_stiffness: Array, loaded_mass: Array, base_mass: Array
) -> Array:
    """Return the natural frequency of the whole unit on its feet; 0 with free feet [Hz].

    The lower root, as of `natural_frequency`.
    """
    _, lower = _squared_roots(spring_stiffness, foot_stiffness, loaded_mass, base_mass)
    return np.sqrt(lower) / (2 * np.pi)


def _squared_roots(k: Array, k_f: Array, m1: Array, m2: Array) -> tuple[Array, Array]:
    # The roots w^2 of `natural_frequency`, the lower from the product of both, without
    # cancellation.
    half_sum = (k * (m1 + m2) + k_f * m1) / 2
    product = (m1 * m2) * (k * k_f)
    # half_sum^2 - product = (k (m1 + m2) - k_f m1)^2/4 + k k_f m1^2: never below 0.
    half_difference = (k * (m1 + m2) - k_f * m1) / 2
    root = hypot(half_difference, m1 * np.sqrt(k * k_f))
    upper = (half_sum + root) / (m1 * m2)
    return upper, product / ((half_sum + root) * (m1 * m2))


def stroke_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    foot_stiffness: Array, foot_damping: Array, loaded_mass: Array, load_damping: Array,
    base_mass: Array,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Return stroke between trough and base (real, imaginary), and the amplitudes of both [m].

    Force and stroke are the real parts of F e^(iwt) and s e^(iwt). With Z = k + i w c of the
    springs, Z_f = k_f + i w c_f of the feet, a = m1 w^2 - i w c_l of the loaded trough and of the
    damper from it to the ground, b = m2 w^2, P = Z_f - b, Q = P - a: s = F Q/D, X1 = F P/D, X2 = F
    a/D, D = Z Q - a P. Im(s) = -F w (c |Q|^2 + c_l |P|^2 + c_f |a|^2)/|D|^2, a sum of what the
    dampers take: the power keeps its digits however little that is.
    """
    w = circular_frequency
    a_real, a_imag = loaded_mass * w * w, -w * load_damping
    p_real, p_imag = foot_stiffness - base_mass * w * w, w * foot_damping
    q_real, q_imag = p_real - a_real, p_imag - a_imag
    z_real, z_imag = spring_stiffness, w * damping
    d_real = z_real * q_real - z_imag * q_imag - (a_real * p_real - a_imag * p_imag)
    d_imag = z_real * q_imag + z_imag * q_real - (a_real * p_imag + a_imag * p_real)
    d = hypot(d_real, d_imag)
    force_over_d = drive_force / d
    a, p, q = hypot(a_real, a_imag), hypot(p_real, p_imag), hypot(q_real, q_imag)
    # (c |Q|^2 + c_l |P|^2 + c_f |a|^2)/|D|
    dissipation = damping * q * (q / d) + load_damping * p * (p / d) + foot_damping * a * (a / d)
    return (
        force_over_d * (q_real * (d_real / d) + q_imag * (d_imag / d)),
        -force_over_d * w * dissipation,
        force_over_d * p,
        force_over_d * a,
    )


def measured_response(
    *, measured_frequency: Array, spring_stiffness: Array, damping: Array, foot_stiffness: Array,
    foot_damping: Array, moving_mass: Array, base_mass: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the empty track by a force of 1 N, X1/F [m N-1]."""
    zero = 0.0 * measured_frequency
    return stroke_response(
        drive_force=1.0 + zero, circular_frequency=2 * np.pi * measured_frequency,
        spring_stiffness=spring_stiffness, damping=damping, foot_stiffness=foot_stiffness,
        foot_damping=foot_damping, loaded_mass=moving_mass, load_damping=zero,
        base_mass=base_mass,
    )[2]  # fmt: skip


def track_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    foot_stiffness: Array, foot_damping: Array, loaded_mass: Array, load_damping: Array,
    base_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return sine and cosine part of the second harmonic of a linear unit's track, over the first.

    As of `drive_unit.second_over_first` (theory 15.5).
    """
    springs = (spring_stiffness, damping, foot_stiffness, foot_damping)
    masses = (loaded_mass, load_damping, base_mass)
    first = _track_per_force(circular_frequency, *springs, *masses)
    second = _track_per_force(2.0 * circular_frequency, *springs, *masses)
    return drive_unit.second_over_first(force_harmonic, first, second)


def _track_per_force(
    w: Array, k: Array, c: Array, k_f: Array, c_f: Array, m1: Array, c_l: Array, m2: Array
) -> tuple[Array, Array]:
    # Real and imaginary part of X1/F = P/D of `stroke_response`.
    a_real, a_imag = m1 * w * w, -w * c_l
    p_real, p_imag = k_f - m2 * w * w, w * c_f
    q_real, q_imag = p_real - a_real, p_imag - a_imag
    d_real = k * q_real - w * c * q_imag - (a_real * p_real - a_imag * p_imag)
    d_imag = k * q_imag + w * c * q_real - (a_real * p_imag + a_imag * p_real)
    square = d_real * d_real + d_imag * d_imag
    real, imag = p_real * d_real + p_imag * d_imag, p_imag * d_real - p_real * d_imag
    return real / square, imag / square


def floor_force(
    *, stroke_response: tuple[Array, ...], circular_frequency: Array, foot_stiffness: Array,
    foot_damping: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the force of the feet on the floor, |k_f + i w c_f| X2 [N].

    X2, the amplitude of the base, is the fourth entry of `stroke_response`.
    """
    return hypot(foot_stiffness, circular_frequency * foot_damping) * stroke_response[3]


def linear_angle(*, spring_angle: Array, gamma: Array) -> Array:
    """Return the angle of the vibration above the track, th - gamma [rad]."""
    return spring_angle - gamma


# --- A drive unit whose line misses its mass centres: trough and base turn together (theory 15.2).


def turning_mass(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass that the stroke of the empty unit moves, m_r - m_r^2 (d x e)^2/I_t [kg].

    m_r (I1 + I2 + m_r (d.e)^2)/I_t, m_r = m1 m2/(m1 + m2) of trough and base: d leads from the
    base's mass centre to the trough's, e is the unit vector along the stroke; I_t = I1 + I2 + m_r
    d^2. A load is taken at the trough's mass centre (theory 15.2).
    """
    m_r = moving_mass * (base_mass / (moving_mass + base_mass))
    _, inertia = _arm(m_r, moving_inertia, base_inertia, offset_along, offset_upward, spring_angle)
    # d^2 - (d x e)^2 = (d.e)^2: the difference cancels where the masses are light to turn.
    reach = offset_along * cosine(spring_angle) + offset_upward * sine(spring_angle)
    return m_r * ((moving_inertia + base_inertia + m_r * reach * reach) / inertia)


def _arm(
    m_r: Array, i1: Array, i2: Array, along: Array, upward: Array, th: Array
) -> tuple[Array, Array]:
    # The lever d x e of the drive, and I_t = i1 + i2 + m_r d^2.
    arm = along * sine(th) - upward * cosine(th)
    return arm, i1 + i2 + m_r * (along * along + upward * upward)


def turning_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    turning_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return real and imaginary part of the stroke, s = F/(k - m w^2 + i w c) [m].

    s in s e^(iwt) for the force F cos(wt), m the mass that the stroke moves (theory 15.2).
    """
    w = circular_frequency
    real, imag = spring_stiffness - turning_mass * w * w, w * damping
    size = hypot(real, imag)
    amplitude = drive_force / size
    return amplitude * (real / size), -amplitude * (imag / size)


def turning_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    turning_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return sine and cosine part, at 2 tau, of the track's second harmonic over its first [1].

    As of `drive_unit.second_over_first`. Both harmonics move a spot of the trough along one line:
    on a free base the turn goes with the stroke.
    """
    first_and_second = [
        turning_response(
            drive_force=1.0 + 0.0 * circular_frequency, circular_frequency=w,
            spring_stiffness=spring_stiffness, damping=damping, turning_mass=turning_mass,
        )
        for w in (circular_frequency, 2.0 * circular_frequency)
    ]  # fmt: skip
    return drive_unit.second_over_first(force_harmonic, *first_and_second)


def trough_turn(
    *, stroke: Array, loaded_mass: Array, base_mass: Array, moving_inertia: Array,
    base_inertia: Array, offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the trough's turning, up in front, -(m_r/I_t) (d x e) s [rad].

    Symbols as of `turning_mass` (theory 15.2).
    """
    m_r = loaded_mass * (base_mass / (loaded_mass + base_mass))
    arm, inertia = _arm(
        m_r, moving_inertia, base_inertia, offset_along, offset_upward, spring_angle
    )
    return -(m_r / inertia) * arm * stroke


def turning_track(
    *, stroke: Array, trough_turn: Array, loaded_mass: Array, base_mass: Array,
    offset_along: Array, offset_upward: Array, spot_along: Array, spot_upward: Array,
    spring_angle: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the amplitudes of a spot of a turning trough along the floor and upward, signed [m].

    (m2/M) (s e + phi k x d) + phi k x b, with the mass m2 of the base and M of both and the turning
    phi; k is the unit vector to the left, d leads from the base's mass centre to the trough's, b
    from there to the spot (theory 15.2).
    """
    trough_part, phi = base_mass / (loaded_mass + base_mass), trough_turn  # m2/M
    along = trough_part * (stroke * cosine(spring_angle) - phi * offset_upward) - phi * spot_upward
    upward = trough_part * (stroke * sine(spring_angle) + phi * offset_along) + phi * spot_along
    return along, upward


def turning_amplitude(*, track_motion: tuple[Array, Array]) -> Array:
    """Return the amplitude of the track at its place [m]."""
    return hypot(*track_motion)


def turning_angle(*, track_motion: tuple[Array, Array], gamma: Array) -> Array:
    """Return the angle of the vibration above the track at its place [rad]."""
    return np.arctan2(track_motion[1], track_motion[0]) - gamma


def turning_measured(
    *, measured_frequency: Array, spring_stiffness: Array, damping: Array, generalised_mass: Array,
    moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spot_along: Array, spot_upward: Array,
    spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the empty track at its place by a force of 1 N [m N-1]."""
    response = turning_response(
        drive_force=1.0 + 0.0 * measured_frequency,
        circular_frequency=2 * np.pi * measured_frequency, spring_stiffness=spring_stiffness,
        damping=damping, turning_mass=generalised_mass,
    )  # fmt: skip
    stroke, unit = hypot(*response), {
        "loaded_mass": moving_mass, "base_mass": base_mass, "offset_along": offset_along,
        "offset_upward": offset_upward, "spring_angle": spring_angle,
    }  # fmt: skip
    turn = trough_turn(
        stroke=stroke, moving_inertia=moving_inertia, base_inertia=base_inertia, **unit
    )
    return turning_amplitude(
        track_motion=turning_track(
            stroke=stroke, trough_turn=turn, spot_along=spot_along, spot_upward=spot_upward,
            **unit,
        )
    )  # fmt: skip


SPRINGS = (Equation("spring_stiffness", drive_unit.leaf_stiffness, "theory 15.1", "springs"),)
MEASURED = (Equation("spring_stiffness", drive_unit.tuned_stiffness, "theory 15.1", "measured"),)
SHARED = (
    Equation("circular_frequency", drive_unit.circular_frequency, "theory 15.1"),
    Equation("damping", drive_unit.damping, "theory 15.1"),
    Equation("loaded_mass", drive_unit.loaded_mass, "theory 15.1"),
    Equation("stroke", drive_unit.stroke, "theory 15.2"),
    Equation("phase", drive_unit.phase, "theory 15.2"),
    Equation("amplification", drive_unit.amplification, "theory 15.2"),
    Equation("drive_unit_power", drive_unit.drive_unit_power, "theory 15.2"),
    Equation("spring_stress", drive_unit.spring_stress, "theory 15.1"),
    Equation("stress_margin", drive_unit.stress_margin, "theory 15.1"),
    Equation("leaf_frequency", drive_unit.leaf_frequency, "theory 15.1"),
    Equation("leaf_mass", drive_unit.leaf_mass, "theory 15.1"),
    Equation("air_gap_margin", drive_unit.air_gap_margin, "theory 15.2"),
    Equation("second_harmonic", drive_unit.second_harmonic, "theory 15.2"),
)
DEFAULTS = {
    "load_mass": 0.0,
    "load_damping": 0.0,
    "gamma": 0.0,
    "clamp_factor": 1.0,
    "force_harmonic": 0.0,
    "force_exponent": 2.0,
}

STROKES = frozenset(
    (
        *("stroke", "phase", "amplification", "drive_unit_power", "spring_stress"),
        *("stress_margin", "air_gap_margin", "track_amplitude", "second_harmonic"),
    )
)
LIMITS = (
    Condition(
        "hits_magnet",
        lambda *, air_gap_margin: air_gap_margin <= 0,
        frozenset(("air_gap_margin",)),
        says="True where the stroke closes the air gap.",
    ),
    Condition(
        "overstressed",
        lambda *, stress_margin: stress_margin < 0,
        frozenset(("stress_margin",)),
        says="True where the leaves bend by more than they may.",
    ),
)


def tuning(*outputs: str) -> tuple[Condition, ...]:
    """Return the conditions for a drive unit at resonance, tuned stiff or tuned soft.

    The regime is looked at if a study asks for a stroke or one of the given `outputs`.
    """
    concerned = STROKES | frozenset(outputs)
    return (
        Condition(
            "resonance",
            lambda *, natural_frequency, frequency, damping_ratio: (
                np.abs(natural_frequency / frequency - 1) < damping_ratio
            ),
            concerned,
            says="True where the drive is within the damping ratio of the natural frequency.",
        ),
        Condition(
            "tuned_stiff",
            lambda *, natural_frequency, frequency: natural_frequency > frequency,
            concerned,
            otherwise="tuned_soft",
            says="True where the unit is tuned above its drive.",
        ),
    )


# --- A linear feeder's drive unit: trough and base on leaf springs, the base on feet.

LINEAR = (
    *SHARED,
    Equation("generalised_mass", drive_unit.reduced_mass, "theory 15.2"),
    Equation("natural_frequency", natural_frequency, "theory 15.2"),
    Equation("foot_frequency", foot_frequency, "theory 15.2"),
    Equation("stroke_response", stroke_response, "theory 15.2"),
    Equation("measured_response", measured_response, "theory 15.1"),
    *fields(
        "stroke_response", "theory 15.2", track_amplitude=(2, "the amplitude of the track, X1 [m]")
    ),
    Equation("vibration_angle", linear_angle, "theory 15.2"),
    Equation("foot_force", floor_force, "theory 15.2"),
    Equation("track_harmonic", track_harmonic, "theory 15.2"),
)
TURNING = (
    *SHARED,
    Equation("generalised_mass", turning_mass, "theory 15.2"),
    under_names(
        "turning_mass", turning_mass, "theory 15.2",
        "the mass that the stroke of a loaded drive unit moves, if its masses turn [kg]",
        moving_mass="loaded_mass",
    ),
    under_names(
        "natural_frequency", drive_unit.bowl_frequency, "theory 15.2",
        "the natural frequency of a unit that turns, sqrt(k/m)/(2 pi) [Hz]",
        spring_stiffness="spring_stiffness", bowl_mass="turning_mass",
    ),
    Equation("stroke_response", turning_response, "theory 15.2"),
    Equation("measured_response", turning_measured, "theory 15.1"),
    Equation("track_harmonic", turning_harmonic, "theory 15.2"),
    Equation("trough_turn", trough_turn, "theory 15.2"),
    Equation("track_motion", turning_track, "theory 15.2"),
    Equation("track_amplitude", turning_amplitude, "theory 15.2"),
    Equation("vibration_angle", turning_angle, "theory 15.2"),
)  # fmt: skip
_RESONANCE, *_SIDES = tuning("foot_force")
LINEAR_CONDITIONS = (
    *LIMITS,
    _RESONANCE,
    Condition(
        "isolation_poor",
        lambda *, foot_frequency, frequency: foot_frequency > frequency / 3,
        frozenset(("foot_force",)),
        says="True where the unit rocks on its feet at more than a third of the drive's frequency.",
    ),
    *_SIDES,
)
OF_TURNING = (*LIMITS, *tuning("trough_turn"))
STRAIGHT_DEFAULTS = {"foot_stiffness": 0.0, "foot_damping": 0.0}
TURNING_DEFAULTS = dict.fromkeys(
    ("offset_along", "offset_upward", "spot_along", "spot_upward"), 0.0
)

LINEAR_SCENE = Scene(
    name="linear-drive-unit",
    title="Drive unit of a linear feeder",
    source="",
    validity="The unit is two rigid masses in small, steady harmonic motion, below a third of "
    "the first natural frequency of a leaf or of the trough. The force acts through both mass "
    "centres, so that amplitude and angle are the same along the track. If it does not, use the "
    "variants springs_turning and measured_turning, in which both masses turn and the base is "
    "free. A load lies at rest on the track.",
    variants={
        "springs": (*LINEAR, *SPRINGS),
        "measured": (*LINEAR, *MEASURED),
        "springs_turning": (*TURNING, *SPRINGS),
        "measured_turning": (*TURNING, *MEASURED),
    },
    default_variant="springs",
    conditions={
        "springs": LINEAR_CONDITIONS,
        "measured": LINEAR_CONDITIONS,
        "springs_turning": OF_TURNING,
        "measured_turning": OF_TURNING,
    },
    defaults=DEFAULTS,
    variant_defaults={
        "springs": STRAIGHT_DEFAULTS,
        "measured": STRAIGHT_DEFAULTS,
        "springs_turning": TURNING_DEFAULTS,
        "measured_turning": TURNING_DEFAULTS,
    },
    constraints=(),
)


# --- A bowl feeder's drive unit: bowl and base on tilted leaf springs around their axis.

BOWL = (
    *SHARED,
    Equation("generalised_mass", drive_unit.bowl_mass, "theory 15.3"),
    *fields(
        "radius",
        "theory 15.3",
        load_radius=(
            "the radius at which the load acts, equal to the part's radius by default [m]",
        ),
    ),
    Equation("loaded_inertia", drive_unit.loaded_inertia, "theory 15.3"),
    under_names(
        "bowl_mass", drive_unit.bowl_mass, "theory 15.3",
        "the moved mass of the loaded unit, I_r (cos th/r_s)^2 + m_r sin^2 th [kg]",
        moving_mass="loaded_mass", base_mass="base_mass", moving_inertia="loaded_inertia",
    ),
    Equation("natural_frequency", drive_unit.bowl_frequency, "theory 15.3"),
    Equation("stroke_response", drive_unit.bowl_response, "theory 15.3"),
    Equation("measured_response", drive_unit.bowl_measured, "theory 15.1"),
    Equation("track_harmonic", drive_unit.bowl_harmonic, "theory 15.3"),
    Equation("bowl_turn", drive_unit.bowl_turn, "theory 15.3"),
    Equation("bowl_lift", drive_unit.bowl_lift, "theory 15.3"),
    Equation("track_amplitude", drive_unit.bowl_amplitude, "theory 15.3"),
    Equation("vibration_angle", drive_unit.bowl_angle, "theory 15.3"),
)  # fmt: skip
BOWL_CONDITIONS = (*LIMITS, *tuning("bowl_turn", "bowl_lift"))

BOWL_SCENE = Scene(
    name="bowl-drive-unit",
    title="Drive unit of a bowl feeder",
    source="",
    validity="Bowl and base are rigid bodies that turn about one axis and lift along it, in "
    "small, steady harmonic motion. The base is free to move. The leaf springs bend but do not "
    "twist; real ones are stiffer. The force acts along the stroke of the leaf springs. A load "
    "lies at rest on the track.",
    variants={"springs": (*BOWL, *SPRINGS), "measured": (*BOWL, *MEASURED)},
    default_variant="springs",
    conditions={"springs": BOWL_CONDITIONS, "measured": BOWL_CONDITIONS},
    defaults=DEFAULTS,
    constraints=(),
)
