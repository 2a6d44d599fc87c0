"""The likelihood of runs, and a grid of the unknowns that is fine where the posterior has mass.

The box between the bounds is cut into equal boxes, and whichever box holds much mass over which
the predictions change is halved along each unknown, again and again. How much predictions change
within a box is known from its neighbours, and counts as an error of theirs: a mode that is far
narrower than the first boxes cannot be missed as long as they see the speeds rise and fall.
"""

from dataclasses import dataclass, fields
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.calibrate.model import Model, Predicted
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.watch import Watch

NONE_BEFORE = 0.9
"""Prior probability that the errors explain all scatter."""
KNOWN_SIZES, UNKNOWN_SIZES = 18, 28
"""Number of sizes of the discrepancy that are tried, with known errors and without."""
FINER = 24  # number of sizes, once it is known which are likely
HARDLY = 1e-5  # of the largest probability of a size: less likely ones are left out
REACH = 3.0  # standard deviations about the centre of a box within which all its values lie
DEGREES_OF_FREEDOM = 4.0  # of robust errors: z = 10 counts as 4
HOPELESS = 1e60  # a residual where a motion has no speed


@dataclass(frozen=True)
class Scatter:
    """Sizes that the discrepancy may have: the scatter of speeds that no unknown explains.

    Attributes
    ----------
    sizes : ndarray, shape (sizes,)
        Standard deviations, in the unit of what was measured.
    log_prior : ndarray, shape (sizes,)
        Logarithms of their prior probabilities.
    """

    sizes: Array
    log_prior: Array

    @classmethod
    def of(cls, model: Model, *, wanted: bool) -> "Scatter":
        """Return the sizes that the discrepancy may have, and logs of their prior probabilities.

        The discrepancy is the scatter of the measured values beyond errors and unknowns; its sizes
        are standard deviations in the unit of the output. There is only size 0 if no value is
        measured, or if errors are known and a discrepancy is not `wanted`. `model` has the measured
        runs.
        """
        # With known errors the prior is 0 with probability 0.9, else half a Cauchy distribution as
        # wide as the errors, F(r) = 2/pi atan(r) of the ratio r = size/error. Without errors the
        # discrepancy is the whole scatter: sizes at even steps of their logarithm, all as probable.
        runs = model.runs
        if not runs.measured.any() or (runs.errors_known and not wanted):
            return cls(np.zeros(1), np.zeros(1))
        if not runs.errors_known:
            values = runs.value[runs.measured]
            rms = max(float(np.sqrt(np.mean(np.square(values)))), 1e-12)
            sizes = rms * np.logspace(-4.0, 0.5, UNKNOWN_SIZES)
            return cls(sizes, np.full(sizes.size, -np.log(sizes.size)))
        typical_error = float(np.median(runs.error[runs.measured]))
        ratios = np.logspace(-1.5, 2.5, KNOWN_SIZES)
        # A size has the mass between its geometric means with its neighbours, the ends the rest.
        cumulative = np.arctan(np.sqrt(ratios[1:] * ratios[:-1])) * 2.0 / np.pi
        prior = (1.0 - NONE_BEFORE) * np.diff(cumulative, prepend=0.0, append=1.0)
        sizes = typical_error * ratios
        return cls(np.concatenate([[0.0], sizes]), np.log(np.concatenate([[NONE_BEFORE], prior])))

    def finer(self, probability: Array) -> "Scatter":
        """Return sizes of the discrepancy that lie closer together where they are likely.

        `probability` is that of the present sizes given the runs, shape (sizes,). Size 0
        stays among them if it is one now; prior probabilities are interpolated.
        """
        sizes, log_prior = self.sizes[self.sizes > 0], self.log_prior[self.sizes > 0]
        probability = probability[self.sizes > 0]
        if not sizes.size or not probability.sum() > 0:
            return self
        probable = np.flatnonzero(probability > HARDLY * probability.max())
        first, last = max(probable[0] - 1, 0), min(probable[-1] + 1, sizes.size - 1)
        log_sizes = np.log(sizes)
        fine_log_sizes = np.linspace(log_sizes[first], log_sizes[last], FINER)
        # A size stands for the mass around it, which is as wide as the spacing of sizes.
        log_spacing_ratio = np.log(
            (fine_log_sizes[1] - fine_log_sizes[0]) / (log_sizes[1] - log_sizes[0])
        )
        scatter = Scatter(
            np.exp(fine_log_sizes),
            np.interp(fine_log_sizes, log_sizes, log_prior) + log_spacing_ratio,
        )
        if sizes.size == self.sizes.size:
            return scatter
        return Scatter(
            np.concatenate([self.sizes[:1], scatter.sizes]),
            np.concatenate([self.log_prior[:1], scatter.log_prior]),
        )


@dataclass(frozen=True)
class Likelihood:
    """The likelihood of the observations of a calibration.

    Attributes
    ----------
    model : Model
        The motions.
    scatter : Scatter
        The sizes that the discrepancy may have.
    outlier_probability : float
        Probability that an observed behaviour is wrong.
    is_robust : bool
        True for errors with the tails of Student's t distribution.
    """

    model: Model
    scatter: Scatter
    outlier_probability: float
    is_robust: bool = False

    def penalty(self, square: Array) -> Array:
        """Return -2 log of the density of squared residuals over their variances, less its top.

        z^2 of a normal distribution, (n + 1) log(1 + z^2/n) of Student's t with n = 4 degrees of
        freedom (Lange, Little and Taylor, JASA 84 (1989) 881).
        """
        n = DEGREES_OF_FREEDOM
        return np.asarray((n + 1.0) * np.log1p(square / n)) if self.is_robust else square

    def log(
        self,
        value: Array,
        variance: Array,
        seen_fraction: Array,
        points: Array,
        box_variance: Array | float = 0.0,
    ) -> Array:
        """Return log(likelihood times prior) of points, for each assumed size of the discrepancy.

        The discrepancy is the scatter of measurements beyond their errors; its sizes and their
        prior are in `self.scatter`. A behaviour that was seen ("hops") counts by `seen_fraction`.
        `box_variance` is that of values in the box about a point.
        """
        runs = self.model.runs
        where = runs.measured
        residual = value[:, where] - runs.value[where]  # (points, measured runs)
        square = np.square(np.where(np.isnan(residual), HOPELESS, residual))
        error_variance = variance[:, where] + np.square(runs.error[where])
        within_box = np.broadcast_to(box_variance, value.shape)[:, where]
        nearest = np.square(np.maximum(0.0, np.sqrt(square) - REACH * np.sqrt(within_box)))
        log = np.empty((len(points), self.scatter.sizes.size))
        for k, size in enumerate(self.scatter.sizes):
            point_variance = error_variance + size**2
            total_variance = point_variance + within_box
            # A wide box would explain too much by its variance alone: it explains a run no better
            # than a point would at which its value comes nearest to the measured one.
            at_centre = self.penalty(square / total_variance) + np.log(total_variance)
            at_nearest = self.penalty(nearest / point_variance) + np.log(point_variance)
            log[:, k] = -0.5 * np.maximum(at_centre, at_nearest).sum(axis=1)
        log_of_seen = np.log(
            self.outlier_probability + (1.0 - 2.0 * self.outlier_probability) * seen_fraction
        ).sum(axis=1)
        log += (log_of_seen + self.model.log_prior(points))[:, np.newaxis] + self.scatter.log_prior
        return np.asarray(log)

    def seen_fraction(self, predicted: Predicted) -> Array:
        """Return 1 where a part shows the regime that was observed in a run, else 0.

        `predicted` are the motions at points of the unknowns. The result is an array of floats of
        shape (points, runs with an observed regime).
        """
        columns = [
            predicted.shows(word)[:, k] for k, word in enumerate(self.model.runs.seen) if word
        ]
        if not columns:
            return np.zeros((len(predicted.value), 0))
        return np.asarray(np.stack(columns, axis=1), dtype=np.float64)


def log_sum(log: Array) -> Array:
    """Return log(sum exp(log)) over the last axis, without overflow of the exponential.

    `log` holds logarithms of probabilities, minus infinity for 0; the result has its shape without
    the last axis. It sums probabilities that are too small to be represented.
    """
    top = log.max(axis=-1, keepdims=True)
    top = np.where(np.isfinite(top), top, 0.0)  # else -inf - -inf is NaN
    with np.errstate(divide="ignore"):
        total: Array = np.log(np.exp(log - top).sum(axis=-1)) + top[..., 0]
    return total


def weights_from_logs(log: Array) -> Array:
    """Return exp(log) over its sum; all equal if no logarithm is finite."""
    top = log.max()
    weights = np.exp(log - top) if np.isfinite(top) else np.ones(log.shape)
    return np.asarray(weights / weights.sum())


FIRST_SHARE = 4  # the first boxes take at most this fraction (1/4) of all points
FINEST_FIRST = 8  # halvings of the range of an unknown for the first boxes, at most
MAX_BITS = 60  # bits of a box's number: halvings times unknowns
ROUND = 0.8  # share of the whole score that is refined in one round
ENOUGH = 0.01  # score at which refining ends: predictions change by a tenth of their errors
BENT = 0.25  # share of the squared error of a box's forecast that is left in its halves
FAR = 3.0  # errors: a residual beyond them is not by chance
UNIFORM = 1.0 / 12.0  # variance of a uniform distribution, over its squared width


@dataclass(frozen=True)
class PosteriorBoxes:
    """Boxes of the unknowns, in shares of the way from bound to bound.

    Attributes
    ----------
    centre : ndarray, shape (boxes, unknowns)
        Centres of the boxes, 0 to 1.
    halvings : ndarray of int, shape (boxes,)
        Each box has a width of 1/2 to that power, along every unknown.
    value, variance : ndarray, shape (boxes, runs)
        Predicted values of the runs at the centres, and their variances.
    slope : ndarray, shape (boxes, runs, unknowns)
        Derivatives of the values by the shares.
    curvature_variance : ndarray, shape (boxes, runs)
        Variance of the values within a box that the slopes do not explain.
    seen_fraction : ndarray, shape (boxes, watched runs)
        The fraction of a box in which the part does what was seen.
    """

    centre: Array
    halvings: NDArray[np.int64]
    value: Array
    variance: Array
    slope: Array
    curvature_variance: Array
    seen_fraction: Array

    def __len__(self) -> int:
        """Return the number of boxes."""
        return len(self.halvings)

    @property
    def width(self) -> Array:
        """The widths, shape (boxes,)."""
        return np.exp2(-self.halvings.astype(np.float64))

    @property
    def log_volume(self) -> Array:
        """Logarithms of the volumes, shape (boxes,)."""
        return -self.halvings * self.centre.shape[1] * np.log(2.0)

    @property
    def slope_variance(self) -> Array:
        """Variance of values within a box by their slopes, shape (boxes, runs)."""
        steps: Array = np.square(self.slope).sum(axis=2)
        return steps * (UNIFORM * np.square(self.width))[:, np.newaxis]

    def only(self, where: NDArray[np.bool_] | NDArray[np.int64]) -> "PosteriorBoxes":
        """Return a selection of the boxes, by mask or by index."""
        return PosteriorBoxes(*(getattr(self, field.name)[where] for field in fields(self)))

    def joined(self, other: "PosteriorBoxes") -> "PosteriorBoxes":
        """Return these boxes and further ones together."""
        both = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return PosteriorBoxes(*(np.concatenate(pair) for pair in both))


@dataclass(frozen=True)
class Explored:
    """The adaptive grid of a posterior.

    Attributes
    ----------
    boxes : PosteriorBoxes
        The boxes.
    log_mass : ndarray, shape (boxes,)
        Logarithms of the mass in each.
    points : int
        Number of points at which motions were predicted.
    size_probabilities : ndarray, shape (sizes,)
        Probability of each size of the discrepancy.
    remaining_score : float
        The mean of how far predictions change in a box, over errors.
    """

    boxes: PosteriorBoxes
    log_mass: Array
    points: int
    size_probabilities: Array
    remaining_score: float


def explore(likelihood: Likelihood, max_points: int, watch: Watch) -> Explored:
    """Return the adaptive grid of a posterior: boxes of the unknowns, small where the mass is.

    Boxes that hold much mass and over which predictions change are halved along each unknown, until
    little is left to refine or `max_points` were predicted.
    """
    unknowns = len(likelihood.model.unknowns)
    boxes = _first_boxes(likelihood, max_points, watch)
    predicted_points = len(boxes)
    while True:
        points = points_of(likelihood, boxes.centre)
        box_variance = boxes.curvature_variance + boxes.slope_variance
        log = likelihood.log(boxes.value, boxes.variance, boxes.seen_fraction, points, box_variance)
        log = log + boxes.log_volume[:, np.newaxis]  # density to mass
        score = _refinement_score(likelihood, boxes, log)
        total_score = float(score.sum())
        # Halve the fewest boxes that have most of the score; each gives 2^unknowns children.
        order = np.argsort(-score)
        halved = int(np.searchsorted(np.cumsum(score[order]), ROUND * total_score)) + 1
        halved = min(halved, (max_points - predicted_points) >> unknowns, int((score > 0).sum()))
        if total_score < ENOUGH or halved < 1:
            probabilities = _size_probabilities(log)
            return Explored(boxes, log_sum(log), predicted_points, probabilities, total_score)
        chosen = order[:halved]
        kept = np.ones(len(boxes), dtype=bool)
        kept[chosen] = False
        children = halved << unknowns
        finer = _halved(likelihood, boxes.only(chosen), watch.part(children / max_points))
        boxes = boxes.only(kept).joined(finer)
        predicted_points += children


def points_of(likelihood: Likelihood, centre: Array) -> Array:
    """Return the values of the unknowns, in the units of studies, shape (points, unknowns).

    `centre` are the points as shares of the way between the bounds of each unknown.
    """
    model = likelihood.model
    return np.asarray(model.lower + centre * model.width)


def _first_boxes(likelihood: Likelihood, max_points: int, watch: Watch) -> PosteriorBoxes:
    unknowns = len(likelihood.model.unknowns)
    halvings = int(np.log2(max_points / FIRST_SHARE) / unknowns)
    halvings = max(2, min(FINEST_FIRST, halvings))
    per_unknown = 2**halvings  # boxes along each unknown
    midpoints = (np.arange(per_unknown) + 0.5) / per_unknown
    centre = np.stack(np.meshgrid(*(midpoints,) * unknowns, indexing="ij"), axis=-1).reshape(
        -1, unknowns
    )
    part_watch = watch.part(min(1.0, len(centre) / max_points))
    predicted = likelihood.model.predict(points_of(likelihood, centre), part_watch)
    seen_fraction = likelihood.seen_fraction(predicted)
    shape, runs = (per_unknown,) * unknowns, predicted.value.shape[1]
    values = np.nan_to_num(predicted.value, nan=0.0).reshape(*shape, runs)
    slopes = [np.gradient(values, 1.0 / per_unknown, axis=k) for k in range(unknowns)]
    slope = np.stack(slopes, axis=-1).reshape(-1, runs, unknowns)
    curvature_variance = sum(np.square(_bend(values, axis)) for axis in range(unknowns))
    return PosteriorBoxes(
        centre,
        np.full(len(centre), halvings),
        predicted.value,
        predicted.variance,
        slope,
        np.asarray(curvature_variance).reshape(-1, runs),
        _blurred(seen_fraction.reshape(*shape, -1)).reshape(len(centre), -1),
    )


def _bend(values: Array, axis: int) -> Array:
    # A quarter of the second difference: distance from a straight line within half a box.
    near = np.pad(values, [(1, 1) if k == axis else (0, 0) for k in range(values.ndim)], "reflect",
                  reflect_type="odd")  # fmt: skip
    return np.asarray(0.25 * np.diff(near, 2, axis=axis))


def _blurred(fraction: Array) -> Array:
    # Blurred by 1/4, 1/2, 1/4: boxes at the border of a regime are neither certain nor excluded.
    blurred = fraction
    for axis in range(fraction.ndim - 1):
        padded = np.pad(
            blurred, [(1, 1) if k == axis else (0, 0) for k in range(blurred.ndim)], "edge"
        )
        before, after = (
            np.take(padded, range(start, start + blurred.shape[axis]), axis) for start in (0, 2)
        )
        blurred = 0.25 * before + 0.5 * blurred + 0.25 * after
    return blurred


def _halved(likelihood: Likelihood, parents: PosteriorBoxes, watch: Watch) -> PosteriorBoxes:
    unknowns = parents.centre.shape[1]
    signs = np.array([*product((-1.0, 1.0), repeat=unknowns)])  # (children, unknowns)
    step = 0.25 * parents.width[:, np.newaxis, np.newaxis]
    centre = parents.centre[:, np.newaxis] + step * signs  # (parents, children, unknowns)
    centres = centre.reshape(-1, unknowns)
    predicted = likelihood.model.predict(points_of(likelihood, centres), watch)
    seen_fraction = likelihood.seen_fraction(predicted)
    runs, children = predicted.value.shape[1], len(signs)
    child_values = np.nan_to_num(predicted.value, nan=0.0).reshape(-1, children, runs)
    # Least squares of value = mean + slope * step * sign: the columns of `signs` are orthogonal.
    slope = np.einsum("pcr,ck->prk", child_values, signs) / (children * step)
    plane = np.einsum("prk,ck->pcr", slope * step, signs) + child_values.mean(axis=1, keepdims=True)
    # Two halves always lie on a straight line: also compare with the value by the parent's slope.
    by_parent = np.nan_to_num(parents.value)[:, np.newaxis] + np.einsum(
        "prk,ck->pcr", parents.slope * step, signs
    )
    curvature = np.maximum(
        np.square(child_values - plane), BENT * np.square(child_values - by_parent)
    ).mean(axis=1)
    parent_fraction = seen_fraction.reshape(len(parents), children, seen_fraction.shape[1]).mean(
        axis=1
    )
    # Boxes at the border of a regime are neither certain nor excluded.
    seen_fraction = np.where(
        np.repeat((parent_fraction > 0) & (parent_fraction < 1), children, axis=0),
        0.5 * (seen_fraction + np.repeat(parent_fraction, children, axis=0)),
        seen_fraction,
    )
    return PosteriorBoxes(
        centres,
        np.repeat(parents.halvings + 1, children),
        predicted.value,
        predicted.variance,
        np.repeat(slope, children, axis=0),
        np.repeat(curvature, children, axis=0),
        seen_fraction,
    )


def _size_probabilities(log: Array) -> Array:
    top = log.max()
    if not np.isfinite(top):
        return np.full(log.shape[1], 1.0 / log.shape[1])
    mass: Array = np.exp(log - top).sum(axis=0)
    return mass / mass.sum()


def _refinement_score(likelihood: Likelihood, boxes: PosteriorBoxes, log: Array) -> Array:
    runs = likelihood.model.runs
    if not np.isfinite(log.max()):
        return np.zeros(len(boxes))
    mass = weights_from_logs(log)  # (boxes, sizes)
    where, sizes = runs.measured, likelihood.scatter.sizes
    discrepancy_variance = float(mass.sum(axis=0) @ np.square(sizes))
    if runs.errors_known:
        discrepancy_variance = float(np.square(sizes[np.argmax(mass.sum(axis=0))]))
    error_variance = boxes.variance[:, where] + np.square(runs.error[where]) + discrepancy_variance
    residual = np.nan_to_num(boxes.value[:, where] - runs.value[where])
    # Far from the measured value a small change of the prediction changes the likelihood much.
    sensitivity = np.maximum(1.0, np.square(residual / FAR) / error_variance)
    smooth = (boxes.slope_variance[:, where] / error_variance * sensitivity).sum(axis=1)
    curvature = (boxes.curvature_variance[:, where] / error_variance * sensitivity).sum(axis=1)
    border = (boxes.seen_fraction * (1.0 - boxes.seen_fraction)).sum(axis=1)
    score: Array = mass.sum(axis=1) * np.minimum(0.1 * smooth + curvature + border, 10.0)
    # Numbers of finer boxes do not fit into an integer.
    score[boxes.halvings >= MAX_BITS // boxes.centre.shape[1]] = 0.0
    return score
