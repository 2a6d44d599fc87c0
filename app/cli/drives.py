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
    """Print the frequency, harmonics and errors of a drive that was fitted to a recording.

    `recording` is its file, `units` those for printing.
    """
    say(f"{recording}: {fit.samples:,} samples, {fit.periods:.1f} periods")
    for name, text in facts(fit, units):
        say(f"  {name}: {text}")
    length = units.of("m", float(np.nanmax(np.abs(fit.amplitudes))))
    angle = units.of("degree", 0.0)
    rows = [
        (axis, str(order), *_harmonic_cells(fit, row, place, length.factor, angle.factor))
        for row, axis in enumerate(fit.axes)
        for place, order in enumerate(fit.orders)
    ]
    measured = f"amplitude ({length.unit})", PLUS_MINUS, f"phase ({angle.unit})", PLUS_MINUS
    table(("axis", "order", *measured), rows, right=("order", *measured))
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
        off = float(np.max(fit.amplitude_errors[:, fit.orders.index(stroke.order)]))
        angle = float(np.degrees(stroke.angle)), float(np.degrees(off / stroke.major))
        order = "" if stroke.order == 1 else f", of order {stroke.order}"
        line = _peak_to_peak(stroke.major, off, units)
        shown = _with_error(*_round_to_error(*angle))
        yield "stroke", f"{line} along the line of vibration, at {shown} degrees{order}"
    else:
        strokes = (
            f"{_peak_to_peak(float(size), float(error), units)} {axis}"
            for axis, size, error in zip(
                fit.axes, fit.amplitudes[:, 0], fit.amplitude_errors[:, 0], strict=True
            )
        )
        yield "stroke", ", ".join(strokes)
    frequency, error = _round_to_error(fit.frequency, fit.frequency_error)
    yield "frequency", f"{frequency} Hz" + (f" {PLUS_MINUS} {error} Hz" if error else ", as given")
    if stroke is not None:
        across = _peak_to_peak(stroke.minor, off, units)
        turn = "leads" if stroke.phase > 0 else "lags"
        yield (
            "ellipse",
            (
                f"{across} across that line; normal {turn} along by "
                f"{abs(np.degrees(stroke.phase)):.1f} degrees"
            ),
        )
    if fit.clock is not None:
        clock, error = _round_to_error(
            PERCENT * fit.clock.error, PERCENT * fit.clock.standard_error
        )
        pace = "slow" if fit.clock.error > 0 else "fast"
        yield "clock", f"{clock.lstrip('-')} % {PLUS_MINUS} {error or 0} % {pace}"
    unit = ("m", "m/s", "m/s\N{SUPERSCRIPT TWO}")[fit.signal.derivative]
    for name, shares in (("not explained by the fit", fit.left_over), ("drift", fit.drifting)):
        each = zip(fit.axes, PERCENT * shares, strict=True)
        listed = ", ".join(f"{axis} {share:.2g} %" for axis, share in each)
        rest = ", ".join(f"{one:.2g}" for one in fit.rest)
        rms = f"; {rest} {unit} rms" if shares is fit.left_over else ""
        yield name, f"{listed} of the drive{rms}"
    for number, note in enumerate(fit.signal.notes, 1):
        yield "note" if number == 1 else f"note {number}", note
    if fit.tilt is not None:
        climb, lean = np.degrees(fit.tilt.climb), np.degrees(fit.tilt.lean)
        left = "" if np.isnan(lean) else f", rises to its left by {lean:.2f} degrees"
        yield "tilt", f"climbs by {climb:.2f} degrees{left}"


def _peak_to_peak(amplitude: float, error: float, units: ShownUnits) -> str:
    """Return the text of a length from peak to peak, with its error; the arguments are half of it.

    `units` are those for printing.
    """
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
    each = [
        ("ring_down_frequency", "natural frequency", "Hz",
         result.natural_frequency, result.natural_frequency_error),
        ("damping_ratio", "damping ratio", "", result.damping_ratio, result.damping_ratio_error),
    ]  # fmt: skip
    if mass is not None:
        each.append(("moving_mass", "moving mass", "kg", *mass))
    lines = [f"# Fitted to {recording.name!a} by vibrafeed {core.__version__}", "[parameters]"]
    texts = {name: _round_to_error(value, error) for name, _, _, value, error in each}
    for name, _, unit, _, _ in each:
        value, error = (f"{text} {unit}".strip() for text in texts[name])
        lines.append(_toml_line(name, value, error))
    text = "\n".join(lines)
    if toml:
        say(text)
    elif as_json:
        numbers = {name: value for name, _, _, value, _ in each}
        errors = {f"{name}_error": error for name, _, _, _, error in each}
        more = {"other_frequencies": [*result.other_frequencies], "left_over": result.left_over}
        document({"recording": str(recording), **numbers, **errors, **more})
    else:
        say(f"{recording}: {result.samples:,} samples from {result.start:.4g} s")
        for name, label, unit, _, _ in each:
            say(f"  {label}: {_with_error(*texts[name])} {unit}".rstrip())
        others = ", ".join(f"{one:.4g} Hz" for one in result.other_frequencies)
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
        for place, order in enumerate(fit.orders):
            if fit.significant[row, place]:
                amplitude, off, phase, away = _harmonic_cells(fit, row, place)
                end = f"{axis}_{order}"
                lines.append(_toml_line(f"amplitude_{end}", f"{amplitude} um", f"{off} um"))
                why = f"{away} deg" if away else ""
                lines.append(_toml_line(f"phase_{end}", f"{phase} deg", why))
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
    one = row, position
    amplitude = _round_to_error(length * fit.amplitudes[one], length * fit.amplitude_errors[one])
    phase, away = angle * np.degrees(fit.phases[one]), angle * np.degrees(fit.phase_errors[one])
    return *amplitude, *_round_to_error(phase, away)


def _round_to_error(value: float, error: float) -> tuple[str, str]:
    """Return a value and its error as texts, rounded to two digits of the error.

    The error's text is empty if the error is unknown or 0; the value has ten digits then.
    """
    if not (np.isfinite(error) and error > 1e-12 * abs(value)):
        return f"{value:.10g}", ""
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{value:.{digits}f}", f"{error:.{digits}f}"
