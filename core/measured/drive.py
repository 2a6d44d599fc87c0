"""A drive as a recording tells it: harmonics, their errors, and what is left over."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legval
from numpy.typing import NDArray

from vibrafeed.core.measured.harmonics import Array
from vibrafeed.core.measured.recording import Signal


class Clock(NamedTuple):
    """Error of the recorder's clock: measured frequency over the true one, less 1.

    A positive error is a slow clock, which counts too few seconds; `standard_error` is how well
    the recording tells it.
    """

    error: float
    standard_error: float


class Tilt(NamedTuple):
    """The tilt of the track, from the constant of a sensor.

    Attributes
    ----------
    climb, lean : float
        Angles [rad] by which the track rises in transport direction, and to its left; NaN without a
        channel across.
    gravity : float
        Size of the constant [m s-2].
    """

    climb: float
    lean: float
    gravity: float


class StrokeEllipse(NamedTuple):
    """The ellipse of one order in the plane of along and normal; a line if `minor` is 0.

    Attributes
    ----------
    order : int
        The lowest order that the recording tells from zero.
    major, minor : float
        Semi-axes [m]: the amplitude along the line of the stroke, and across that line.
    angle : float
        Of the line to the transport direction, upwards [rad], in (-pi/2, pi/2].
    """

    order: int
    major: float
    minor: float
    angle: float


class Fold(NamedTuple):
    """All samples within one period.

    Attributes
    ----------
    phase : ndarray, shape (n,)
        w t, from 0 to 2 pi [rad], in the order of the samples.
    accelerations, residual : ndarray, shape (axes, n)
        Without constant and drift, and what is left over [m s-2].
    """

    phase: Array
    accelerations: Array
    residual: Array


@dataclass(frozen=True, eq=False)
class Fit:
    """A drive of harmonics, and what the recording tells of its errors.

    Displacement of the track along an axis: sum_k A_k sin(k w t + phi_k). Its acceleration, which
    a sensor on the track shows beside a constant and a drift, is
    -sum_k A_k (k w)^2 sin(k w t + phi_k).

    The time origin is free: it is chosen near the middle of the recording such that the phase of
    the lowest order told, order 1 unless it is absent, is 0 in the axis where it is largest.

    Attributes
    ----------
    axes : tuple of str
        Which of along, across, normal.
    orders : tuple of int
        Orders fitted.
    frequency, frequency_error : float
        Fundamental and its standard error [Hz]; the error of a given line frequency is 0.
    clock : Clock, optional
        If a line frequency is given.
    amplitudes, phases : ndarray, shape (axes, orders)
        A_k >= 0 [m] and phi_k in [-pi, pi) [rad].
    significant : ndarray of bool, shape (axes, orders)
        Which the recording tells from zero; if their number was given, all are stated.
    covariance : ndarray, shape (1 + 2 axes orders, 1 + 2 axes orders)
        Of the frequency [Hz], then A_k cos(phi_k) and A_k sin(phi_k) [m] by axis and order.
    constant : ndarray, shape (axes,)
        Mean acceleration [m s-2]: gravity, if the sensor shows it, and its offset.
    drift : ndarray, shape (axes, degree)
        Coefficients of the Legendre polynomials 1, 2, ... over the recording [m s-2].
    left_over, drifting : ndarray, shape (axes,)
        Rms of the residual and of the drift as shares of the rms of all harmonics of all axes.
    effective_samples : ndarray, shape (axes,)
        Number of samples with white noise of the residual's size that would tell as much.
    tilt : Tilt, optional
        If there are axes along and normal, and their constant has the size of gravity.
    origin : float
        Time by the recorder's clock at which t is 0, from the first sample [s].
    signal : Signal
        What was fitted.
    """

    axes: tuple[str, ...]
    orders: tuple[int, ...]
    frequency: float
    frequency_error: float
    clock: Clock | None
    amplitudes: Array
    phases: Array
    significant: NDArray[np.bool_]
    covariance: Array = field(repr=False)
    constant: Array
    drift: Array
    left_over: Array
    drifting: Array
    effective_samples: Array
    tilt: Tilt | None
    origin: float
    signal: Signal = field(repr=False)

    @property
    def samples(self) -> int:
        """The number of samples."""
        return self.signal.times.size

    @property
    def recorded_frequency(self) -> float:
        """The fundamental frequency by the recorder's clock [Hz]."""
        return self.frequency * (1.0 + (self.clock.error if self.clock else 0.0))

    @property
    def periods(self) -> float:
        """The number of recorded periods."""
        return self.recorded_frequency * float(np.ptp(self.signal.times))

    @property
    def amplitude_errors(self) -> Array:
        """The standard errors of the amplitudes [m], shape (axes, orders)."""
        return np.sqrt(self._turned(0))

    @property
    def phase_errors(self) -> Array:
        """The standard errors of the phases [rad], shape (axes, orders).

        Infinite without amplitude.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = np.sqrt(self._turned(1)) / self.amplitudes
        return np.where(self.amplitudes > 0.0, errors, np.inf)

    def _turned(self, part: int) -> Array:
        """Return variances of the displacement of each harmonic, shape (axes, orders) [m2].

        For the standard errors of amplitude and phase: `part` is 0 for the variance of the
        component in phase with the harmonic, 1 for that of the component a quarter period ahead.
        The covariance of the coefficients is turned by the fitted phases.
        """
        blocks = self.covariance[1:, 1:].reshape(*self.phases.shape, 2, *self.phases.shape, 2)
        own = np.einsum("jkajkb->jkab", blocks)
        cosine, sine = np.cos(self.phases), np.sin(self.phases)
        unit = np.stack([cosine, sine] if part == 0 else [-sine, cosine], axis=-1)
        return np.maximum(np.einsum("jka,jkab,jkb->jk", unit, own, unit), 0.0)

    @property
    def stroke(self) -> StrokeEllipse | None:
        """The line of the stroke and its angle; None unless there are axes along and normal.

        With complex amplitudes a along and n normal, and D^2 = (|a|^2 - |n|^2)^2 + 4 Re(a n*)^2,
        the larger semi-axis squared is (|a|^2 + |n|^2 + D)/2, the product of both |Im(a n*)|, and
        twice the angle has the tangent 2 Re(a n*)/(|a|^2 - |n|^2): the Stokes parameters of Born
        and Wolf, Principles of Optics, section 1.4.2.
        """
        if not {"along", "normal"} <= set(self.axes):
            return None
        rows = [self.axes.index(axis) for axis in ("along", "normal")]
        lowest = int(np.flatnonzero(self.significant[rows].any(axis=0))[:1].sum())
        waves = np.where(self.significant, self.amplitudes * np.exp(1j * self.phases), 0.0)
        along, normal = waves[rows, lowest]
        product = complex(along * np.conj(normal))
        sizes = abs(along) ** 2, abs(normal) ** 2
        spread = float(np.hypot(sizes[0] - sizes[1], 2.0 * product.real))
        major = float(np.sqrt((sum(sizes) + spread) / 2.0))
        minor = abs(product.imag) / major if major else 0.0
        angle = float(np.arctan2(2.0 * product.real, sizes[0] - sizes[1]) / 2.0)
        return StrokeEllipse(self.orders[lowest], major, minor, angle)

    def parameters(self) -> dict[str, float]:
        """Return the fitted drive as study parameters: SI units, phases in degrees."""
        return self._named(self.frequency, self.amplitudes * np.exp(1j * self.phases))

    def draw(self, rng: np.random.Generator, count: int) -> list[dict[str, float]]:
        """Return `count` random drives that are consistent with the recording, for error estimates.

        They are normally distributed about the fit with its covariance; each is a mapping of a
        study's parameters, such as `frequency` and `amplitude_along_1`. `rng` makes the random
        numbers.
        """
        displacement = self.amplitudes * np.exp(1j * self.phases)
        parts = np.stack([displacement.real, displacement.imag], axis=-1)
        # Scaled, since a frequency and a displacement differ by many powers of ten.
        scale = np.sqrt(np.maximum(np.diag(self.covariance), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(self.covariance / np.outer(scale, scale))
        root = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
        drawn = rng.standard_normal((count, scale.size)) @ root.T
        drawn += np.concatenate([[self.frequency], parts.ravel()])
        pairs = drawn[:, 1:].reshape(count, *parts.shape)
        return [
            self._named(float(frequency), pair[..., 0] + 1j * pair[..., 1])
            for frequency, pair in zip(drawn[:, 0], pairs, strict=True)
        ]

    def _named(self, frequency: float, displacement: NDArray[np.complex128]) -> dict[str, float]:
        """Return frequency and significant harmonics of the fit as parameters of a study, by name.

        `frequency` is in Hz; `displacement` holds complex amplitudes A exp(i phi), shape (axes,
        orders) [m]. Names are such as `amplitude_along_1` [m] and `phase_along_1`, in degrees.
        """
        named = {"frequency": frequency}
        for axis, row, kept in zip(self.axes, displacement, self.significant, strict=True):
            for order, wave, significant in zip(self.orders, row, kept, strict=True):
                if significant:
                    named[f"amplitude_{axis}_{order}"] = float(np.abs(wave))
                    named[f"phase_{axis}_{order}"] = float(
                        np.degrees(wrap_angle(float(np.angle(wave))))
                    )
        return named

    def model(self, times: Array) -> Array:
        """Return the accelerations of the fit at times of the recording, shape (axes, n) [m s-2].

        Harmonics, constant and drift, to compare with what was recorded; `times` are by the
        recorder's clock [s].
        """
        first, last = self.signal.times[[0, -1]]
        place = 2.0 * (np.asarray(times) - first) / (last - first) - 1.0
        series = np.hstack([self.constant[:, None], self.drift])
        return np.asarray(legval(place, series.T)) + self.periodic(self._phase(times))

    def periodic(self, phase: Array) -> Array:
        """Return the accelerations of the fitted harmonics at phases w t, shape (axes, n).

        In m s-2, without constant and drift; `phase` is w t [rad], shape (n,), w the fundamental.
        """
        orders = np.array(self.orders)
        peaks = self.amplitudes * (2.0 * np.pi * self.frequency * orders) ** 2
        angles = orders[:, None] * phase + self.phases[..., None]
        return -np.einsum("jk,jkn->jn", peaks, np.sin(angles))

    def displacement(self, phase: Array) -> Array:
        """Return the displacements of the track at phases w t [rad], shape (axes, n) [m]."""
        angles = np.array(self.orders)[:, None] * phase + self.phases[..., None]
        return np.einsum("jk,jkn->jn", self.amplitudes, np.sin(angles))

    def fold(self) -> Fold:
        """Return all samples folded into one period, without constant and drift."""
        phase = np.mod(self._phase(self.signal.times), 2.0 * np.pi)
        residual = self.signal.accelerations - self.model(self.signal.times)
        return Fold(phase, self.periodic(phase) + residual, residual)

    def _phase(self, times: Array) -> Array:
        """Return the phase of the drive at times of the recording [rad]."""
        since = np.asarray(times) - self.signal.times[0] - self.origin
        return 2.0 * np.pi * self.recorded_frequency * since


def wrap_angle(angle: float | Array) -> Array:
    """Return an angle reduced to [-pi, pi)."""
    return np.mod(np.asarray(angle) + np.pi, 2.0 * np.pi) - np.pi
