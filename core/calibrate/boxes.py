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
    log_before : ndarray, shape (sizes,)
        Logarithms of their prior probabilities.
    """

    sizes: Array
    log_before: Array

    @classmethod
    def of(cls, model: Model, *, wanted: bool) -> "Scatter":
        """Return the sizes that the discrepancy may have, and logs of their prior probabilities.

        The discrepancy is the scatter of the measured values beyond errors and unknowns; its sizes
        are standard deviations in the unit of the output. There is only size 0 if no value is
        measured, or if errors are known and a discrepancy is not `wanted`. `model` has the measured
        runs.
        """
        # Where errors are known it is 0 in nine of ten calibrations before any measurement, else
        # spread as half a Cauchy distribution as wide as the errors. Where none is known it is
        # all the scatter there is, and each size of it is as likely as its double.
        runs = model.runs
        if not runs.measured.any() or (runs.errors_known and not wanted):
            return cls(np.zeros(1), np.zeros(1))
        if not runs.errors_known:
            values = runs.value[runs.measured]
            size = max(float(np.sqrt(np.mean(np.square(values)))), 1e-12)
            sizes = size * np.logspace(-4.0, 0.5, UNKNOWN_SIZES)
            return cls(sizes, np.full(sizes.size, -np.log(sizes.size)))
        typical = float(np.median(runs.error[runs.measured]))
        shares = np.logspace(-1.5, 2.5, KNOWN_SIZES)
        # A size has the mass from halfway to its neighbours; the ends have all that lies beyond.
        below = np.arctan(np.sqrt(shares[1:] * shares[:-1])) * 2.0 / np.pi
        before = (1.0 - NONE_BEFORE) * np.diff(below, prepend=0.0, append=1.0)
        sizes = typical * shares
        return cls(np.concatenate([[0.0], sizes]), np.log(np.concatenate([[NONE_BEFORE], before])))

    def finer(self, likely: Array) -> "Scatter":
        """Return sizes of the discrepancy that lie closer together where they are likely.

        `likely` are the probabilities of the present sizes given the runs, shape (sizes,). Size 0
        stays among them if it is one now; prior probabilities are interpolated.
        """
        sizes, before = self.sizes[self.sizes > 0], self.log_before[self.sizes > 0]
        likely = likely[self.sizes > 0]
        if not sizes.size or not likely.sum() > 0:
            return self
        held = np.flatnonzero(likely > HARDLY * likely.max())
        first, last = max(held[0] - 1, 0), min(held[-1] + 1, sizes.size - 1)
        logs = np.log(sizes)
        fine = np.linspace(logs[first], logs[last], FINER)
        step = np.log((fine[1] - fine[0]) / (logs[1] - logs[0]))
        scatter = Scatter(np.exp(fine), np.interp(fine, logs, before) + step)
        if sizes.size == self.sizes.size:
            return scatter
        return Scatter(
            np.concatenate([self.sizes[:1], scatter.sizes]),
            np.concatenate([self.log_before[:1], scatter.log_before]),
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
        shown: Array,
        points: Array,
        within: Array | float = 0.0,
    ) -> Array:
        """Return log(likelihood times prior) of points, for each assumed size of the discrepancy.

        The discrepancy is the scatter of measurements beyond their errors; its sizes and their
        prior are in `self.scatter`. A run with a behaviour that was seen ("hops") counts by its
        probability.
        """
        runs = self.model.runs
        where = runs.measured
        residual = value[:, where] - runs.value[where]
        square = np.square(np.where(np.isnan(residual), HOPELESS, residual))
        known = variance[:, where] + np.square(runs.error[where])
        around = np.broadcast_to(within, value.shape)[:, where]
        nearest = np.square(np.maximum(0.0, np.sqrt(square) - REACH * np.sqrt(around)))
        log = np.empty((len(points), self.scatter.sizes.size))
        for k, size in enumerate(self.scatter.sizes):
            own = known + size**2
            whole = own + around
            # A wide box would explain too much by its variance alone: it explains a run no better
            # than a point would at which its value comes nearest to the measured one.
            spent = self.penalty(square / whole) + np.log(whole)
            least = self.penalty(nearest / own) + np.log(own)
            log[:, k] = -0.5 * np.maximum(spent, least).sum(axis=1)
        seen = np.log(
            self.outlier_probability + (1.0 - 2.0 * self.outlier_probability) * shown
        ).sum(axis=1)
        log += (seen + self.model.log_prior(points))[:, np.newaxis] + self.scatter.log_before
        return np.asarray(log)

    def shown(self, predicted: Predicted) -> Array:
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
    top = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total: Array = np.log(np.exp(log - top).sum(axis=-1)) + top[..., 0]
    return total


def shares_of(log: Array) -> Array:
    """Return the shares of a whole from their logarithms; all equal if none is finite."""
    top = log.max()
    mass = np.exp(log - top) if np.isfinite(top) else np.ones(log.shape)
    return np.asarray(mass / mass.sum())


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
    rough : ndarray, shape (boxes, runs)
        Variance of the values within a box that the slopes do not explain.
    shown : ndarray, shape (boxes, watched runs)
        The share of a box in which the part does what was seen.
    """

    centre: Array
    halvings: NDArray[np.int64]
    value: Array
    variance: Array
    slope: Array
    rough: Array
    shown: Array

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
    def change(self) -> Array:
        """Variance of values within a box, shape (boxes, runs)."""
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
    sizes : ndarray, shape (sizes,)
        Probability of each size of the discrepancy.
    left : float
        What is left to refine: the mean of how far predictions change in a box, over errors.
    """

    boxes: PosteriorBoxes
    log_mass: Array
    points: int
    sizes: Array
    left: float


def explore(likelihood: Likelihood, most: int, watch: Watch) -> Explored:
    """Return the adaptive grid of a posterior: boxes of the unknowns, small where the mass is.

    Boxes that hold much mass and over which predictions change are halved along each unknown, until
    little is left to refine or `most` points were predicted.
    """
    count = len(likelihood.model.unknowns)
    boxes = _first(likelihood, most, watch)
    tried = len(boxes)
    while True:
        points, within = points_of(likelihood, boxes.centre), boxes.rough + boxes.change
        log = likelihood.log(boxes.value, boxes.variance, boxes.shown, points, within)
        log = log + boxes.log_volume[:, np.newaxis]
        log_mass = log_sum(log)
        score = _score(likelihood, boxes, log)
        left = float(score.sum())
        order = np.argsort(-score)
        wanted = int(np.searchsorted(np.cumsum(score[order]), ROUND * left)) + 1
        wanted = min(wanted, (most - tried) >> count, int((score > 0).sum()))
        if left < ENOUGH or wanted < 1:
            return Explored(boxes, log_mass, tried, _sizes(log), left)
        chosen = order[:wanted]
        kept = np.ones(len(boxes), dtype=bool)
        kept[chosen] = False
        parents = boxes.only(chosen)
        children = wanted << count
        finer = _split(likelihood, parents, watch.part(children / most))
        boxes = boxes.only(kept).joined(finer)
        tried += children


def points_of(likelihood: Likelihood, centre: Array) -> Array:
    """Return the values of the unknowns, in the units of studies, shape (points, unknowns).

    `centre` are the points as shares of the way between the bounds of each unknown.
    """
    model = likelihood.model
    return np.asarray(model.lower + centre * model.width)


def _first(likelihood: Likelihood, most: int, watch: Watch) -> PosteriorBoxes:
    count = len(likelihood.model.unknowns)
    halvings = int(np.log2(most / FIRST_SHARE) / count)
    halvings = max(2, min(FINEST_FIRST, halvings))
    size = 2**halvings
    along = (np.arange(size) + 0.5) / size
    centre = np.stack(np.meshgrid(*(along,) * count, indexing="ij"), axis=-1).reshape(-1, count)
    share = watch.part(min(1.0, len(centre) / most))
    predicted = likelihood.model.predict(points_of(likelihood, centre), share)
    shown = likelihood.shown(predicted)
    shape, runs = (size,) * count, predicted.value.shape[1]
    values = np.nan_to_num(predicted.value, nan=0.0).reshape(*shape, runs)
    slopes = [np.gradient(values, 1.0 / size, axis=k) for k in range(count)]
    slope = np.stack(slopes, axis=-1).reshape(-1, runs, count)
    rough = sum(np.square(_bend(values, axis)) for axis in range(count))
    return PosteriorBoxes(
        centre,
        np.full(len(centre), halvings),
        predicted.value,
        predicted.variance,
        slope,
        np.asarray(rough).reshape(-1, runs),
        _softened(shown.reshape(*shape, -1)).reshape(len(centre), -1),
    )


def _bend(values: Array, axis: int) -> Array:
    # A quarter of the second difference: distance from a straight line within half a box.
    near = np.pad(values, [(1, 1) if k == axis else (0, 0) for k in range(values.ndim)], "reflect",
                  reflect_type="odd")  # fmt: skip
    return np.asarray(0.25 * np.diff(near, 2, axis=axis))


def _softened(shown: Array) -> Array:
    # Blurred by 1/4, 1/2, 1/4: boxes at the border of a regime are neither certain nor excluded.
    soft = shown
    for axis in range(shown.ndim - 1):
        near = np.pad(soft, [(1, 1) if k == axis else (0, 0) for k in range(soft.ndim)], "edge")
        before, after = (np.take(near, range(s, s + soft.shape[axis]), axis) for s in (0, 2))
        soft = 0.25 * before + 0.5 * soft + 0.25 * after
    return soft


def _split(likelihood: Likelihood, parents: PosteriorBoxes, watch: Watch) -> PosteriorBoxes:
    count = parents.centre.shape[1]
    signs = np.array([*product((-1.0, 1.0), repeat=count)])  # (children, unknowns)
    step = 0.25 * parents.width[:, np.newaxis, np.newaxis]
    centre = parents.centre[:, np.newaxis] + step * signs  # (parents, children, unknowns)
    flat = centre.reshape(-1, count)
    predicted = likelihood.model.predict(points_of(likelihood, flat), watch)
    shown = likelihood.shown(predicted)
    runs, children = predicted.value.shape[1], len(signs)
    family = np.nan_to_num(predicted.value, nan=0.0).reshape(-1, children, runs)
    # Over all signs, which are orthogonal, a plane through the children is a sum of products.
    slope = np.einsum("pcr,ck->prk", family, signs) / (children * step)
    plane = np.einsum("prk,ck->pcr", slope * step, signs) + family.mean(axis=1, keepdims=True)
    # Halves of a box lie on a straight line whatever it is; what the box foretold tells more.
    foretold = np.nan_to_num(parents.value)[:, np.newaxis] + np.einsum(
        "prk,ck->pcr", parents.slope * step, signs
    )
    rough = np.maximum(np.square(family - plane), BENT * np.square(family - foretold)).mean(axis=1)
    mixed = shown.reshape(len(parents), children, shown.shape[1]).mean(axis=1)
    shown = np.where(
        np.repeat((mixed > 0) & (mixed < 1), children, axis=0),
        0.5 * (shown + np.repeat(mixed, children, axis=0)),
        shown,
    )
    return PosteriorBoxes(
        flat,
        np.repeat(parents.halvings + 1, children),
        predicted.value,
        predicted.variance,
        np.repeat(slope, children, axis=0),
        np.repeat(rough, children, axis=0),
        shown,
    )


def _sizes(log: Array) -> Array:
    top = log.max()
    if not np.isfinite(top):
        return np.full(log.shape[1], 1.0 / log.shape[1])
    found: Array = np.exp(log - top).sum(axis=0)
    return found / found.sum()


def _score(likelihood: Likelihood, boxes: PosteriorBoxes, log: Array) -> Array:
    runs = likelihood.model.runs
    if not np.isfinite(log.max()):
        return np.zeros(len(boxes))
    mass = shares_of(log)
    where, size = runs.measured, likelihood.scatter.sizes
    usual = float(mass.sum(axis=0) @ np.square(size))
    if runs.errors_known:
        usual = float(np.square(size[np.argmax(mass.sum(axis=0))]))
    known = boxes.variance[:, where] + np.square(runs.error[where]) + usual
    # Far from what was measured a small change of a value changes the likelihood much.
    residual = np.nan_to_num(boxes.value[:, where] - runs.value[where])
    slope = np.maximum(1.0, np.square(residual / FAR) / known)
    smooth = (boxes.change[:, where] / known * slope).sum(axis=1)
    rough = (boxes.rough[:, where] / known * slope).sum(axis=1)
    border = (boxes.shown * (1.0 - boxes.shown)).sum(axis=1)
    score: Array = mass.sum(axis=1) * np.minimum(0.1 * smooth + rough + border, 10.0)
    score[boxes.halvings >= MAX_BITS // boxes.centre.shape[1]] = 0.0
    return score
