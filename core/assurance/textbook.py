"""Textbook formulas in many digits, and what an error of the inputs does to them.

They share nothing with `vibrafeed.core.mechanics`: no rearranged forms, no limits taken, no
scaling; the digits make up for the cancellation. Inputs are in the units of studies, angles in
degrees.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

from vibrafeed.core.assurance.case import Truth

DIGITS = 700
"""Enough for 1 - exp(-s) at s = 1e-300."""

EPSILON = 2.0**-52

BAR = 8
"""Roundings that an output may be off by, each as large as one of every input."""

Formula = Callable[..., Any]


def exact(formula: Formula, **numbers: float) -> Callable[[], Truth]:
    """Return a function that computes the true value of a textbook formula with a tolerance.

    The formula is evaluated in 700 digits. The tolerance is 8 kappa ulp: kappa = sum |x dF/dx|/|F|
    over the inputs x is what one rounding of each input does to the value F.

    Parameters
    ----------
    formula : callable
        Takes the inputs as mpmath numbers by keyword.
    **numbers : float
        The inputs in the units of studies.
    """

    def truth() -> Truth:
        """Return the exact value with the error by rounding its inputs."""
        with mp.workdps(DIGITS):
            inputs = {name: mpf(value) for name, value in numbers.items()}
            value = formula(**inputs)
            total = abs(value)
            for name, number in inputs.items():
                step = abs(number) * mpf(10) ** -20
                if step:
                    after = formula(**(inputs | {name: number + step}))
                    before = formula(**(inputs | {name: number - step}))
                    total += abs(after - before) / 2 / mpf(10) ** -20
            # A value in the subnormal range has an absolute rounding.
            error = BAR * float(total) * EPSILON + BAR * 5e-324
            return Truth(float(value), error, "closed form in 700 digits; 8 kappa ulp")

    return truth


def exact_of_floats(formula: Formula, **values: float) -> Callable[[], Truth]:
    """Return a function that computes the true value of a formula, with a tolerance of 8 ulp.

    It is for formulas whose inputs cancel without rounding, so that their condition number does not
    count: the difference of two floats within a factor of 2 of each other is exact (Sterbenz).
    Inputs are `**values`, in the units of studies.
    """

    def truth() -> Truth:
        """Return the value of the formula."""
        with mp.workdps(DIGITS):
            value = float(formula(**{name: mpf(number) for name, number in values.items()}))
        error = BAR * abs(value) * EPSILON + BAR * 5e-324
        return Truth(value, error, "closed form of the floats in 700 digits; 8 ulp")

    return truth


def _radians(degrees: Any) -> Any:
    """Return an angle in radians."""
    return degrees * mp.pi / 180


def _sin_cos(degrees: Any) -> tuple[Any, Any]:
    """Return sine and cosine of an angle in degrees."""
    angle = _radians(degrees)
    return mp.sin(angle), mp.cos(angle)


def drive(*, frequency: Any, amplitude: Any) -> Any:
    """Return the amplitude of the drive acceleration, P = A0 (2 pi f)^2 [m s-2]."""
    return amplitude * (2 * mp.pi * frequency) ** 2


def throw_number(*, frequency: Any, amplitude: Any, beta: Any, gravity: Any, gamma: Any = 0) -> Any:
    """Return the throw number, P sin(beta)/(g cos(gamma)) (theory 13.2) [1]."""
    P = drive(frequency=frequency, amplitude=amplitude)
    return P * _sin_cos(beta)[0] / (gravity * _sin_cos(gamma)[1])


def starting_acceleration(
    *, frequency: Any, amplitude: Any, alpha: Any, beta: Any, gamma: Any, delta: Any, gravity: Any,
    friction: Any,
) -> Any:  # fmt: skip
    """Return the starting acceleration of a part at a bowl's wall, variant `derived` [m s-2].

    K = P cos(beta)(cos(alpha) + mu sin(alpha)) - g (sin(gamma) + mu cos(gamma) sin(delta)), with P
    = A0 (2 pi f)^2 and the friction mu (theory 4.2). Angles are in degrees, all numbers those of
    mpmath.
    """
    P = drive(frequency=frequency, amplitude=amplitude)
    (sa, ca), (_, cb) = _sin_cos(alpha), _sin_cos(beta)
    (sg, cg), (sd, _) = _sin_cos(gamma), _sin_cos(delta)
    return P * cb * (ca + friction * sa) - gravity * (sg + friction * cg * sd)


def velocity_after(*, radius: Any, distance: Any, friction: Any, **drive: Any) -> Any:
    """Return the velocity of a part after a distance from rest on a curved track [m s-1].

    v(x) = sqrt(K R/mu (1 - exp(-2 mu x/R))), 0 for K <= 0 (theory 4.5), with the distance x, the
    radius R of the bowl, the friction mu and the starting acceleration K of the drive (`**drive`:
    its other inputs). All numbers are those of mpmath.
    """
    K = starting_acceleration(friction=friction, **drive)
    if K <= 0:
        return mp.zero
    if friction == 0:
        return mp.sqrt(2 * K * distance)
    return mp.sqrt(K * radius / friction * -mp.expm1(-2 * friction * distance / radius))


def time_over(*, radius: Any, distance: Any, friction: Any, **drive: Any) -> Any:
    """Return the time of a part for a distance from rest on a curved track [s].

    t(x) = acosh(exp(mu x/R))/sqrt(mu K/R) (theory 4.5), with the distance x, the radius R of the
    bowl, the friction mu and the starting acceleration K of the drive (`**drive`: its other
    inputs). All numbers are those of mpmath.
    """
    K = starting_acceleration(friction=friction, **drive)
    if friction == 0:
        return mp.sqrt(2 * distance / K)
    k = mp.sqrt(friction * K / radius)
    s = friction * distance / radius
    # acosh(exp(s)) with the exponential taken out, lest it fill the memory.
    return (s + mp.log1p(mp.sqrt(-mp.expm1(-2 * s)))) / k


def velocity_at(*, radius: Any, time: Any, friction: Any, **drive: Any) -> Any:
    """Return the velocity of a part at a time after it started from rest on a curved track [m s-1].

    v(t) = sqrt(K R/mu) tanh(t sqrt(mu K/R)) (theory 4.5), with the radius R of the bowl, the
    friction mu and the starting acceleration K of the drive (`**drive`: its other inputs).
    """
    K = starting_acceleration(friction=friction, **drive)
    return mp.sqrt(K * radius / friction) * mp.tanh(time * mp.sqrt(friction * K / radius))


def distance_at(*, radius: Any, time: Any, friction: Any, **drive: Any) -> Any:
    """Return the distance of a part at a time after it started from rest on a curved track [m].

    x(t) = R/mu ln(cosh(u)), u = t sqrt(mu K/R) (theory 4.5), with the radius R of the bowl, the
    friction mu and the starting acceleration K of the drive (`**drive`: its other inputs).
    """
    K = starting_acceleration(friction=friction, **drive)
    u = time * mp.sqrt(friction * K / radius)
    return radius / friction * (u + mp.log1p(mp.exp(-2 * u)) - mp.log(2))


def chord_cosine(*, length: Any, radius: Any) -> Any:
    """Return the cosine of half the angle of a chord, sqrt(1 - (h/2R)^2) (theory 4.1) [1]."""
    return mp.sqrt(1 - (length / (2 * radius)) ** 2)


def normal_response(*, height: Any, length: Any, pitch: Any, friction: Any) -> Any:
    """Return a corner's response to normal force in slip to the right, m tau (theory 2.2) [1]."""
    s = mp.atan2(height, length) + _radians(pitch)
    return 1 + 3 * mp.cos(s) * (mp.cos(s) - friction * mp.sin(s))


def contact_acceleration(
    *, height: Any, length: Any, pitch: Any, friction: Any, pitch_rate: Any, gravity: Any
) -> Any:
    """Return the normal force per mass of a corner slipping right, -chi/(m tau) [m s-2].

    The reference value, by many digits, for a rectangle on one corner on a plane at rest. chi = rho
    xi'^2 sin(s) - g, with half the diagonal rho, the pitch rate xi' and the angle s of the diagonal
    above the plane; m tau is the corner's response to a force (theory 2.2). `height`, `length` in
    m, `pitch` in degrees, `pitch_rate` in rad/s, `gravity` in m s-2; numbers of mpmath.
    """
    s = mp.atan2(height, length) + _radians(pitch)
    rho = mp.hypot(height, length) / 2
    chi = rho * pitch_rate**2 * mp.sin(s) - gravity
    response = normal_response(height=height, length=length, pitch=pitch, friction=friction)
    return -chi / response


def hop_after_hop(*, frequency: Any, beta: Any, gamma: Any, gravity: Any) -> Any:
    """Return the mean velocity if each hop begins where the last one ended, one a period."""
    return gravity * mp.cos(_radians(beta + gamma)) / (2 * frequency * _sin_cos(beta)[0])
