"""The result of a calibration in sentences."""

from collections.abc import Iterator
from functools import cached_property
from itertools import combinations

import numpy as np

from vibrafeed.core.calibrate.calibration import DEVIATION_AFTER, Calibration, columns_of
from vibrafeed.core.calibrate.model import Unknown
from vibrafeed.core.calibrate.posterior import Posterior
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.distributions import Normal
from vibrafeed.core.study.shown import SI, ShownUnits

HARDLY = 0.7
"""Share of the prior deviation: above it, the runs say next to nothing about an unknown."""
AT_BOUND = 0.1  # of the top of the density: with more at a bound, values beyond it are likely
ALIKE = 0.2
"""Share of both deviations: below it, only the product or ratio of two unknowns is known."""
TOGETHER = 0.9  # size of a correlation from which a sentence is said about it
FAR = 3.5  # errors: a run with a larger residual is named
LITTLE = 0.1  # bit: a candidate run that adds less is not proposed


def format_rounded(value: float, deviation: float, unit: str, units: ShownUnits) -> str:
    """Return a value with a readable unit as text, with the digits that its deviation justifies.

    `value` and its standard deviation `deviation` are in the unit `unit`; `units` chooses the one
    that is shown. A value 10 times its deviation has three digits; there are 2 to 6, and 3 without
    a deviation.
    """
    shown = units.of(unit, abs(value))
    value, deviation = shown.factor * value, abs(shown.factor * deviation)
    digits = 3
    if deviation > 0 and value:
        digits = int(np.clip(np.floor(np.log10(abs(value) / deviation)) + 2, 2, 6))
    text = f"{value:#.{digits}g}".rstrip(".")
    if "e" in text or abs(float(text)) >= 10.0**digits:
        text = f"{value:.{digits}g}"
    return f"{text} {shown.unit}".rstrip()


class Findings:
    """Says what a calibration found.

    Parameters
    ----------
    prepared : Calibration
        The study.
    posterior : Posterior
        What came of it.
    arrays : mapping
        The variables of the result.
    misfit : tuple, optional
        Of the run that does not fit: its number, its distance from what the other runs give, in
        errors, and the posterior without it.
    """

    def __init__(
        self,
        prepared: Calibration,
        posterior: Posterior,
        arrays: dict[str, Array],
        misfit: tuple[int, float, Posterior] | None = None,
    ):
        """Describe the posterior and the arrays of a calibration."""
        self.prepared, self.posterior, self.arrays = prepared, posterior, arrays
        self.misfit = misfit
        self.model = prepared.model
        self.units = ShownUnits()
        self.output = QUANTITIES[self.model.runs.output]

    def text(self) -> str:
        """Return all findings as sentences, one per line, the most important first."""
        sentences = [
            *self._trustworthiness(),
            *self._misfit(),
            *self._estimates(),
            *self._modes(),
            *self._undetermined(),
            *self._unknowns_at_bounds(),
            *self._scatter(),
            *self._outlying_runs(),
            *self._next_measurement(),
        ]
        return "\n".join(f"{sentence}." for sentence in sentences)

    def _value(self, name: str) -> float:
        return float(self.arrays[name])

    def _trustworthiness(self) -> Iterator[str]:
        if not np.isfinite(self.posterior.explored.log_mass.max()):
            yield "No values of the unknowns explain the observations: widen their ranges"
        if self.posterior.explored.remaining_score > 0.3:
            yield (
                f"The grid of {self.posterior.explored.points:,} points is too coarse for these "
                "runs: give more points"
            )

    def _estimates(self) -> Iterator[str]:
        several = len(self.arrays["mode_share"]) > 1
        for unknown in self.model.unknowns:
            deviation = self._value(f"deviation_{unknown.name}")
            best, low, high = (
                format_rounded(
                    self._value(f"{estimate}_{unknown.name}"), deviation, unknown.unit, self.units
                )
                for estimate in ("best", "lower_95", "upper_95")
            )
            shown_best = "" if several or unknown.name in self.unsettled else f"best {best}; "
            yield f"{unknown.label} ({unknown.name}): {shown_best}{low} to {high} with 95 %"

    def _modes(self) -> Iterator[str]:
        shares = self.arrays["mode_share"]
        if len(shares) < 2:
            return
        modes = []
        for k, share in enumerate(shares):
            values = [
                f"{one.name} {self.units.text(self.arrays[f'mode_{one.name}'][k], one.unit)}"
                for one in self.model.unknowns
            ]
            modes.append(f"{', '.join(values)} ({100 * share:.0f} %)")
        yield f"The data cannot separate {' from '.join(modes)}: each explains the runs"

    @cached_property
    def _pairs(self) -> dict[tuple[str, str], str]:
        if len(self.arrays["mode_share"]) > 1:
            return {}
        pairs = combinations(enumerate(self.model.unknowns), 2)
        sentences = {(first.name, second.name): self._pair(first, second, j, k)
                for (j, first), (k, second) in pairs}  # fmt: skip
        return {names: sentence for names, sentence in sentences.items() if sentence}

    @property
    def unsettled(self) -> set[str]:
        """The unknowns that the runs cannot separate from others: their best values mean little."""
        return {name for names in self._pairs for name in names}

    def _undetermined(self) -> Iterator[str]:
        yield from self._pairs.values()
        for unknown in self.model.unknowns:
            deviation = self._value(f"deviation_{unknown.name}")
            if unknown.name not in self.unsettled and deviation > HARDLY * _deviation_before(
                unknown
            ):
                yield f"The runs say next to nothing about {unknown.name}: it is as it was given"

    def _pair(self, unknown: Unknown, other: Unknown, j: int, k: int) -> str:
        points, weights = self.posterior.points, self.posterior.weights
        correlation = self._value(f"correlation_{unknown.name}_{other.name}")
        # A ratio or product that varies much less than either is all that the runs determine.
        if min(unknown.lower, other.lower) > 0:
            logs = [np.log(points[:, j]), np.log(points[:, k])]
            least_deviation = min(_deviation(log, weights) for log in logs)
            for sign, word, mark in ((-1.0, "ratio", "/"), (1.0, "product", "*")):
                joint = logs[0] + sign * logs[1]
                if _deviation(joint, weights) < ALIKE * least_deviation:
                    lower, middle, upper = np.exp(
                        self.posterior.quantiles(joint, (0.025, 0.5, 0.975))
                    )
                    unit = _joint_unit(unknown.unit, other.unit, mark)
                    return (
                        f"The runs determine only the {word} {unknown.name} {mark} {other.name}, "
                        f"{middle:.4g}{unit} ({lower:.4g} to {upper:.4g} with 95 %); what "
                        f"{unknown.name} and {other.name} are by themselves the data cannot settle"
                    )
        if abs(correlation) > TOGETHER:
            how = "the more" if correlation > 0 else "the less"
            return (
                f"The runs hardly separate {unknown.name} and {other.name}: the more of one, {how} "
                f"of the other (correlation {correlation:.2f})"
            )
        return ""

    def _unknowns_at_bounds(self) -> Iterator[str]:
        for unknown in self.model.unknowns:
            is_determined = self._value(f"deviation_{unknown.name}") < (
                HARDLY * _deviation_before(unknown)
            )
            if isinstance(unknown.prior, Normal) or not is_determined:
                continue
            axis, density = self.arrays[unknown.name], self.arrays[f"density_{unknown.name}"]
            for position, bound, word in (
                (0, unknown.lower, "lower"),
                (-1, unknown.upper, "upper"),
            ):
                is_at_bound = abs(axis[position] - bound) < 1e-9 * unknown.width
                if is_at_bound and density[position] > AT_BOUND * density.max():
                    value = self.units.text(bound, unknown.unit)
                    beyond = f"its {word} bound, {value}: widen its range"
                    yield f"{unknown.name} may lie beyond {beyond}"

    def _scatter(self) -> Iterator[str]:
        runs = self.model.runs
        sizes = self.prepared.likelihood.scatter.sizes
        if sizes.size == 1:
            return
        size = self.units.text(self._value("discrepancy"), self.output.unit)
        rms = float(np.sqrt(np.nanmean(np.square(self.arrays["residual"]))))
        residual = self.units.text(rms, self.output.unit, 4)
        if not runs.errors_known:
            yield (
                f"The best values leave residuals of {residual} (rms); no errors were given to "
                "explain them"
            )
            return
        probability = self._value("discrepancy_probability")
        if probability < 0.5:
            yield f"Their errors explain what was measured; the residuals are {residual} (rms)"
        else:
            percent = "more than 99" if probability > 0.99 else f"{100 * probability:.0f}"
            yield (
                f"The measured values scatter by about {size} more than their errors allow "
                f"({percent} % likely); no unknown explains it"
            )

    def _misfit(self) -> Iterator[str]:
        if self.misfit is None:
            return
        run, distance, posterior = self.misfit
        quantiles = posterior.quantiles(posterior.points, (0.5, 0.025, 0.975))
        deviations = np.sqrt(np.diag(posterior.covariance()))
        without = []
        for k, unknown in enumerate(self.model.unknowns):
            middle, low, high = (
                format_rounded(float(quantile), deviations[k], unknown.unit, self.units)
                for quantile in quantiles[:, k]
            )
            without.append(f"{unknown.name} is {middle} ({low} to {high} with 95 %)")
        yield (
            f"Run {run} does not fit: it is {distance:.1f} errors from what the other runs give. "
            f"Without it {', '.join(without)}"
        )

    def _outlying_runs(self) -> Iterator[str]:
        relative = np.abs(np.nan_to_num(self.arrays["residual_over_error"]))
        far = [
            f"{k + 1} ({relative[k]:.1f} errors)"
            for k in np.argsort(-relative)
            if relative[k] > FAR
        ]
        if far:
            yield f"Far from the best fit: run {', '.join(far[:5])}"
        probability = self.arrays.get("probability_of_seen")
        if probability is not None:
            unexpected = [
                f"{k + 1} ({self.model.runs.seen[k]})" for k in np.flatnonzero(probability < 0.1)
            ]
            if unexpected:
                yield f"Not as it was seen: run {', '.join(unexpected[:5])}"

    def _next_measurement(self) -> Iterator[str]:
        grid = self.prepared.candidates
        if grid is None:
            return
        gain = self.arrays["information"].ravel()
        best = int(np.argmax(gain))
        values = {name: column[best] for name, column in columns_of(grid).items()}
        parameters = ", ".join(
            f"{name} {self.units.text(value, QUANTITIES[name].unit)}"
            for name, value in values.items()
            if name in grid.along or len(grid.axes) == 0
        )
        interval = self._narrowed_interval(best)
        if gain[best] < LITTLE:
            yield f"No candidate would add much: after the best of them {interval}"
            return
        expected, spread = (
            self.units.text(self.arrays[statistic].ravel()[best], self.output.unit)
            for statistic in ("expected", "expected_deviation")
        )
        yield (
            f"Measure next at {parameters}, where {expected} +- {spread} is to be expected: after "
            f"it {interval}"
        )

    def _narrowed_interval(self, candidate: int) -> str:
        ratios = {
            unknown: self.arrays[f"{DEVIATION_AFTER}{unknown.name}"].ravel()[candidate]
            / self._value(f"deviation_{unknown.name}")
            for unknown in self.model.unknowns
        }
        narrowest = min(ratios, key=lambda unknown: ratios[unknown])
        width = self._value(f"upper_95_{narrowest.name}") - self._value(
            f"lower_95_{narrowest.name}"
        )
        now = self.units.text(width, narrowest.unit, 2)
        after = self.units.text(width * float(ratios[narrowest]), narrowest.unit, 2)
        return (
            f"the 95 % interval of {narrowest.name} is expected to be {after} wide, and not {now}"
        )


def _deviation_before(unknown: Unknown) -> float:
    given = unknown.prior.deviation if isinstance(unknown.prior, Normal) else np.inf
    return float(min(unknown.width / np.sqrt(12.0), given))


def _deviation(values: Array, weights: Array) -> float:
    mean = weights @ values
    return float(np.sqrt(weights @ np.square(values - mean)))


def _joint_unit(first: str, second: str, mark: str) -> str:
    read = ["" if unit == "1" else SI.get(unit, unit) for unit in (first, second)]
    if mark == "/" and read[0] == read[1]:
        return ""
    if mark == "/":
        return f" {read[0]} per {read[1]}".replace("  ", " ") if read[1] else f" {read[0]}".rstrip()
    return f" {' '.join(filter(None, read))}".rstrip()
