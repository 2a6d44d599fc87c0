"""A measured drive on the command line: a table, and the parameters of a study."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from vibrafeed import core
from vibrafeed.app.cli.console import document, say, table
from vibrafeed.core.measured import Fit, RingDown
from vibrafeed.core.study.shown import ShownUnits

MICRO = 1e6  # micrometres in a metre
PERCENT = 100.0
PLUS_MINUS = "\N{PLUS-MINUS SIGN}"


def show_fit(fit: Fit, recording: Path, units: ShownUnits) -> None:
    """Print the frequency, harmonics and errors of a drive that was fitted to a recording."""
    say(f"{recording}: {fit.samples:,} samples, {fit.periods:.1f} periods")
    for name, text in facts(fit, units):
        say(f"  {name}: {text}")
    length = units.of("m", float(np.nanmax(np.abs(fit.amplitudes))))
    angle = units.of("degree", 0.0)
    rows = [
        (axis, str(order), *_harmonic_cells(fit, row, position, length.factor, angle.factor))
        for row, axis in enumerate(fit.axes)
        for position, order in enumerate(fit.orders)
    ]
    headings = f"amplitude ({length.unit})", PLUS_MINUS, f"phase ({angle.unit})", PLUS_MINUS
    table(("axis", "order", *headings), rows, right=("order", *headings))
    if not fit.significant.all():
        say("  -: not distinguishable from zero; left out of the study's parameters")


def document_of(fit: Fit, recording: Path) -> dict[str, Any]:
    """Return a fitted drive as a JSON document: lengths in metres, angles in degrees, Hz.

    `recording` is the file of the recording.
    """
    harmonics = [
        {
            "axis": axis,
            "order": int(order),
            "told": bool(fit.significant[row, position]),
            "amplitude": float(fit.amplitudes[row, position]),
            "amplitude_error": float(fit.amplitude_errors[row, position]),
            "phase": float(np.degrees(fit.phases[row, position])),
            "phase_error": float(np.degrees(fit.phase_errors[row, position])),
        }
        for row, axis in enumerate(fit.axes)
        for position, order in enumerate(fit.orders)
    ]
    return {
        "recording": str(recording),
        "samples": int(fit.samples),
        "periods": float(fit.periods),
        "frequency": float(fit.frequency),
        "frequency_error": float(fit.frequency_error),
        "in_words": dict(facts(fit)),
        "harmonics": harmonics,
    }


def facts(fit: Fit, units: ShownUnits | None = None) -> Iterator[tuple[str, str]]:
    """Yield name and value, as texts, of each result that holds for the whole fit of a drive.

    They are the stroke along the line of vibration, peak to peak, and its angle; the frequency; the
    ellipse; the error of the recorder's clock; the share of the recording that the fit does not
    explain, drift, and the tilt of the sensor, as far as they are known. `units` are those for
    printing lengths.
    """
    units = units or ShownUnits()
    stroke = fit.stroke
    if stroke is not None:
        stroke_error = float(np.max(fit.amplitude_errors[:, fit.orders.index(stroke.order)]))
        # As if the end of the stroke were off by its error at right angles.
        angle_error = float(np.degrees(stroke_error / stroke.major))
        angle = _with_error(*_round_to_error(float(np.degrees(stroke.angle)), angle_error))
        length = _peak_to_peak(stroke.major, stroke_error, units)
        order = "" if stroke.order == 1 else f", of order {stroke.order}"
        yield "stroke", f"{length} along the line of vibration, at {angle} degrees{order}"
    else:
        strokes = (
            f"{_peak_to_peak(float(amplitude), float(error), units)} {axis}"
            for axis, amplitude, error in zip(
                fit.axes, fit.amplitudes[:, 0], fit.amplitude_errors[:, 0], strict=True
            )
        )
        yield "stroke", ", ".join(strokes)
    frequency, error = _round_to_error(fit.frequency, fit.frequency_error)
    yield "frequency", f"{frequency} Hz" + (f" {PLUS_MINUS} {error} Hz" if error else ", as given")
    if stroke is not None:
        width = _peak_to_peak(stroke.minor, stroke_error, units)
        verb = "leads" if stroke.phase > 0 else "lags"
        phase = f"normal {verb} along by {abs(np.degrees(stroke.phase)):.1f} degrees"
        yield "ellipse", f"{width} across that line; {phase}"
    if fit.clock is not None:
        clock, error = _round_to_error(
            PERCENT * fit.clock.error, PERCENT * fit.clock.standard_error
        )
        pace = "slow" if fit.clock.error > 0 else "fast"
        yield "clock", f"{clock.lstrip('-')} % {PLUS_MINUS} {error or 0} % {pace}"
    unit = ("m", "m/s", "m/s\N{SUPERSCRIPT TWO}")[fit.signal.derivative]
    residuals = ", ".join(f"{residual:.2g}" for residual in fit.rest)
    unexplained = _percent_of_axes(fit, fit.left_over)
    yield "not explained by the fit", f"{unexplained}; {residuals} {unit} rms"
    yield "drift", _percent_of_axes(fit, fit.drifting)
    for number, note in enumerate(fit.signal.notes, 1):
        yield "note" if number == 1 else f"note {number}", note
    if fit.tilt is not None:
        climb, lean = np.degrees(fit.tilt.climb), np.degrees(fit.tilt.lean)
        side_text = "" if np.isnan(lean) else f", rises to its left by {lean:.2f} degrees"
        yield "tilt", f"climbs by {climb:.2f} degrees{side_text}"


def _percent_of_axes(fit: Fit, fractions: np.ndarray) -> str:
    pairs = zip(fit.axes, PERCENT * fractions, strict=True)
    return ", ".join(f"{axis} {percentage:.2g} %" for axis, percentage in pairs) + " of the drive"


def _peak_to_peak(amplitude: float, error: float, units: ShownUnits) -> str:
    shown = units.of("m", 2.0 * amplitude)
    texts = _round_to_error(2.0 * shown.factor * amplitude, 2.0 * shown.factor * error)
    return f"{_with_error(*texts)} {shown.unit} peak to peak"


def _with_error(value: str, error: str) -> str:
    return f"{value} {PLUS_MINUS} {error}" if error else value


def show_ring_down(
    recording: Path,
    result: RingDown,
    mass: tuple[float, float] | None,
    *,
    toml: bool,
    as_json: bool,
) -> str:
    """Print the free vibration of a struck feeder; return its parameters as TOML.

    `mass` is the moving mass with its error [kg], if it is known. `toml` prints the parameters
    only, `as_json` a JSON document.
    """
    quantities = [
        ("ring_down_frequency", "natural frequency", "Hz",
         result.natural_frequency, result.natural_frequency_error),
        ("damping_ratio", "damping ratio", "", result.damping_ratio, result.damping_ratio_error),
    ]  # fmt: skip
    if mass is not None:
        quantities.append(("moving_mass", "moving mass", "kg", *mass))
    lines = [f"# Fitted to {recording.name!a} by vibrafeed {core.__version__}", "[parameters]"]
    rounded_texts = {name: _round_to_error(value, error) for name, _, _, value, error in quantities}
    for name, _, unit, _, _ in quantities:
        value, error = (f"{text} {unit}".strip() for text in rounded_texts[name])
        lines.append(_toml_line(name, value, error))
    text = "\n".join(lines)
    if toml:
        say(text)
    elif as_json:
        numbers = {name: value for name, _, _, value, _ in quantities}
        errors = {f"{name}_error": error for name, _, _, _, error in quantities}
        more = {"other_frequencies": [*result.other_frequencies], "left_over": result.left_over}
        document({"recording": str(recording), **numbers, **errors, **more})
    else:
        say(f"{recording}: {result.samples:,} samples from {result.start:.4g} s")
        for name, label, unit, _, _ in quantities:
            say(f"  {label}: {_with_error(*rounded_texts[name])} {unit}".rstrip())
        others = ", ".join(f"{frequency:.4g} Hz" for frequency in result.other_frequencies)
        if others:
            say(f"  other modes: {others}")
        say(f"  not explained by the fit: {PERCENT * result.left_over:.2g} % of the ring-down")
    return text


def toml_of(fit: Fit, recording: Path) -> str:
    """Return a fitted drive as TOML parameters of a study, with standard errors as comments.

    `recording` is the file, which the first line names. Amplitudes are in um, phases in degrees;
    harmonics that are not distinguishable from zero are left out.
    """
    lines = [f"# Fitted to {recording.name!a} by vibrafeed {core.__version__}"]
    lines += [f"# {name}: {text}" for name, text in facts(fit)]
    frequency, error = _round_to_error(fit.frequency, fit.frequency_error)
    lines += [
        "[parameters]",
        _toml_line("frequency", f"{frequency} Hz", f"{error} Hz" if error else ""),
    ]
    for row, axis in enumerate(fit.axes):
        for position, order in enumerate(fit.orders):
            if fit.significant[row, position]:
                amplitude, amplitude_error, phase, phase_error = _harmonic_cells(fit, row, position)
                suffix = f"{axis}_{order}"
                error_text = f"{amplitude_error} um"
                lines.append(_toml_line(f"amplitude_{suffix}", f"{amplitude} um", error_text))
                error_text = f"{phase_error} deg" if phase_error else ""
                lines.append(_toml_line(f"phase_{suffix}", f"{phase} deg", error_text))
    return "\n".join(lines)


def _toml_line(name: str, value: str, error: str) -> str:
    return f'{name} = "{value}"' + (f"  # +- {error}" if error else "  # exact")


def _harmonic_cells(
    fit: Fit, row: int, position: int, length: float = MICRO, angle: float = 1.0
) -> tuple[str, str, str, str]:
    """Return the texts of one harmonic: amplitude, its error, phase, its error.

    A harmonic that is not distinguishable from zero has dashes.

    Parameters
    ----------
    fit : Fit
        The fitted drive.
    row, position : int
        Index of the axis in `fit.axes`, and of the harmonic in `fit.orders`.
    length, angle : float
        Factors from metres and degrees to the units for printing.
    """
    if not fit.significant[row, position]:
        return "-", "", "-", ""
    at = row, position
    amplitude, amplitude_error = length * fit.amplitudes[at], length * fit.amplitude_errors[at]
    phase = angle * np.degrees(fit.phases[at])
    phase_error = angle * np.degrees(fit.phase_errors[at])
    return *_round_to_error(amplitude, amplitude_error), *_round_to_error(phase, phase_error)


def _round_to_error(value: float, error: float) -> tuple[str, str]:
    """Return a value and its error as texts, rounded to two digits of the error.

    The error's text is empty if the error is unknown or 0; the value has ten digits then.
    """
    if not (np.isfinite(error) and error > 1e-12 * abs(value)):
        return f"{value:.10g}", ""
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{value:.{digits}f}", f"{error:.{digits}f}"
