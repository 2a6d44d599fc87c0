"""Contacts that give: restitution over impact speed, damping, contact times (theory 18.3).

Arrays broadcast; SI units.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene

STEPS, OUTER_STEPS, DAMPING_STEPS = 7, 7, 8
"""Newton's steps for the speed after an impact, and for the damping by a restitution of both laws:
two more than the tests need over twelve orders of magnitude."""
SMALL, TERMS = 0.5, 16
"""Size of x below which exp(x) - 1 - x is a series, and the last power in that series."""
LITTLE = 1e-3  # impact number below which the slope is that at 0
HERTZ = 2.9432751843247043
"""Duration of a Hertz contact without loss, over depth/speed: 4 sqrt(pi) Gamma(2/5)/(5
Gamma(9/10))."""
LEAST_RATIO = 5.0
"""Natural frequency of a part on its lining over that of the drive, from which contacts count as
rigid."""


def _excess(x: Array) -> Array:
    # exp(x) - 1 - x, for small x by its series x^2/2 (1 + x/3 (1 + x/4 (1 + ...))).
    is_small = np.abs(x) < SMALL
    small = np.where(is_small, x, 0.0)
    series = np.ones(())
    for k in range(TERMS, 2, -1):
        series = 1 + small / k * series
    return np.where(is_small, small * small / 2 * series, np.expm1(np.where(is_small, 1.0, x)) - x)


def hunt_crossley(impact_number: Array) -> Array:
    """Return the restitution e of Hunt and Crossley's contact law for an impact number d = b v [1].

    The contact force is F = k x^n (1 + b x') at depth x, with any exponent n; v is the impact
    speed, so that e falls with it. e solves d - ln(1 + d) = -e d - ln(1 - e d). With s = ln(1 + d)
    and t = -ln(1 - e d) both sides are exp(x) - 1 - x, at x = s and x = -t: t is found by Newton's
    method, from s (theory 18.3).
    """
    s = np.log1p(impact_number)
    left_side, t = _excess(s), s
    for _ in range(STEPS):
        t = t - ratio(_excess(-t) - left_side, -np.expm1(-t), 0.0)
    return ratio(-np.expm1(-t), impact_number, 1.0)


def damped_number(restitution: Array) -> Array:
    """Return the impact number d = b v at which Hunt and Crossley's law has a restitution [1].

    The inverse of `hunt_crossley`; infinite for restitution 0. 1/e - 1 is nearly linear in d, 2 d/3
    for small and d - 1 for large d, so that Newton's method in it converges fast.
    """
    rebounds = restitution > 0
    target = 1 / np.where(rebounds, restitution, 0.5) - 1  # 1/e - 1
    d = 1.5 * target
    for _ in range(OUTER_STEPS):
        e = hunt_crossley(d)
        # d(1/e)/dd, by d(e d)/dd = d (1 - e d)/((1 + d) e d).
        slope = (1 - (1 - e * d) / ((1 + d) * (e * e))) / np.where(d > 0, e * d, 1.0)
        slope = np.where(d < LITTLE, 2.0 / 3.0, slope)
        d = np.maximum(d - (1 / e - 1 - target) / slope, 0.0)
    return np.where(rebounds, d, np.inf)


def impact_damping(*, restitution: Array, restitution_speed: Array) -> Array:
    """Return the damping of Hunt and Crossley's law from the restitution at a speed [s m-1]."""
    return damped_number(restitution) / restitution_speed


def restitution_at(*, impact_damping: Array, impact_speed: Array) -> Array:
    """Return the restitution at an impact speed: it falls as the speed grows [1].

    `impact_damping` is that of Hunt and Crossley's law [s m-1]; infinite damping gives 0.
    """
    is_infinite = np.isinf(impact_damping)
    impact_number = np.where(is_infinite, 1.0, impact_damping) * impact_speed
    return np.where(is_infinite, 0.0, hunt_crossley(impact_number))


# --- a linear spring and damper that never pulls


def restitution_of_damping(*, contact_damping_ratio: Array) -> Array:
    """Return the restitution of a linear spring and damper that never pulls, at any speed [1].

    exp(-(pi - 2 a) tan(a)) with sin(a) = zeta, the damping ratio [1]; beyond zeta = 1 the same with
    hyperbolic functions, exp(-2 zeta acosh(zeta)/sqrt(zeta^2 - 1)).
    """
    # With pi - 2 a = 2 acos(zeta) and tan(a) = zeta/sqrt(1 - zeta^2).
    zeta = contact_damping_ratio
    return np.exp(-2 * zeta * _arc(zeta))


def _arc(zeta: Array) -> Array:
    # acos(zeta)/sqrt(1 - zeta^2), and beyond 1 acosh(zeta)/sqrt(zeta^2 - 1) [1].
    low, high = np.minimum(zeta, 1.0), np.maximum(zeta, 1.0)
    root = np.sqrt((1 - low) * (1 + low))
    beyond = np.sqrt(high - 1) * np.sqrt(high + 1)
    light = ratio(np.arctan2(root, low), root, 1.0)
    return np.where(zeta < 1, light, ratio(np.log1p(high - 1 + beyond), beyond, 1.0))


def damping_of_restitution(*, restitution: Array) -> Array:
    """Return the damping ratio of a linear spring and damper contact with a restitution [1].

    The inverse of `restitution_of_damping`, 2 zeta _arc(zeta) = -ln(restitution), by Newton's
    method. Below exp(-2) = 0.135 the damping is more than critical; infinite for restitution 0.
    """
    rebounds = restitution > 0
    loss = 0.0 - np.log(np.where(rebounds, restitution, 1.0))
    # The logarithm is concave in zeta: pi zeta near 0, 2 ln(2 zeta) far beyond 1.
    zeta = np.where(loss < 2, loss / np.pi, np.cosh(loss / 2))
    for _ in range(DAMPING_STEPS):
        arc = _arc(zeta)
        is_near_1 = np.abs(zeta - 1) < LITTLE
        # d(_arc)/dzeta = (zeta _arc - 1)/(1 - zeta^2), -1/3 at 1.
        arc_slope = (zeta * arc - 1) / np.where(is_near_1, 1.0, 1 - zeta) / (1 + zeta)
        slope = 2 * (arc + zeta * np.where(is_near_1, -1 / 3, arc_slope))
        zeta = zeta - (2 * zeta * arc - loss) / slope
    return np.where(rebounds, zeta, np.inf)


# --- when contacts are rigid


def lining_frequency(*, lining_stiffness: Array, mass: Array) -> Array:
    """Return the natural frequency of a part on its lining, sqrt(k/m)/(2 pi) [Hz]."""
    return np.sqrt(lining_stiffness / mass) / (2 * np.pi)


def lining_sag(*, lining_stiffness: Array, mass: Array, gravity: Array) -> Array:
    """Return the depth to which a part sinks into its lining by its weight, m g/k [m]."""
    return mass * gravity / lining_stiffness


def stiffness_ratio(*, lining_frequency: Array, frequency: Array) -> Array:
    """Return the natural frequency of a part on its lining over that of the drive, f_c/f [1]."""
    return lining_frequency / frequency


def hertz_depth(
    *, mass: Array, contact_modulus: Array, contact_radius: Array, impact_speed: Array
) -> Array:
    """Return the largest depth x_max of a Hertz contact in an impact, (5 m v^2/(4 k))^(2/5) [m].

    The force is k x^(3/2), k = (4/3) E sqrt(R), with the contact modulus E and the contact radius
    R; v is the impact speed.
    """
    stiffness = 4 / 3 * contact_modulus * np.sqrt(contact_radius)
    return (1.25 * mass * np.square(impact_speed) / stiffness) ** 0.4


def hertz_time(*, hertz_depth: Array, impact_speed: Array) -> Array:
    """Return the duration of a Hertz contact without loss, 2.943 x_max/v [s].

    x_max is the largest depth [m], v the impact speed.
    """
    return HERTZ * hertz_depth / impact_speed


SOURCE = "theory 18.3"
EQUATIONS = (
    Equation("impact_damping", impact_damping, SOURCE),
    Equation("restitution_at_impact", restitution_at, SOURCE),
    Equation("damping_of_restitution", damping_of_restitution, SOURCE),
    Equation("restitution_of_damping", restitution_of_damping, SOURCE),
    Equation("lining_frequency", lining_frequency, SOURCE),
    Equation("lining_sag", lining_sag, SOURCE),
    Equation("stiffness_ratio", stiffness_ratio, SOURCE),
    Equation("hertz_depth", hertz_depth, SOURCE),
    Equation("hertz_time", hertz_time, SOURCE),
)
CONDITIONS = (
    Condition(
        "unbounded",
        lambda *, restitution: restitution == 0,
        frozenset(("damping_of_restitution", "impact_damping")),
        otherwise="contact",
        says="True where the restitution is 0, which no finite damping gives.",
    ),
    Condition(
        "soft_contact",
        lambda *, stiffness_ratio: stiffness_ratio < LEAST_RATIO,
        frozenset(("stiffness_ratio",)),
        otherwise="contact",
        says="True where the lining is too soft for rigid contacts: f_c < 5 f.",
    ),
)

SCENE = Scene(
    name="soft-contact",
    title="Compliant contact: restitution over speed, lined tracks",
    source="",
    validity="The results describe one impact of a rigid part on a contact without adhesion. By "
    "the law of Hunt and Crossley, the restitution falls with the speed; with a spring and a "
    "damper that never pull, it does not. Contacts count as rigid if the part's natural "
    "frequency on its lining is at least five times the drive frequency.",
    variants={"physical": EQUATIONS},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
    defaults={"gravity": STANDARD_GRAVITY},
    constraints=(),
)
