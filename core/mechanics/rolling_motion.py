"""Round parts on a vibrating floor, in the mean over a period (theory 18.2).

Numbers as of motion in time: accelerations over g, velocities over g/w. The slip of a round part,
s = u - r w, obeys

    s' = D + (1 + kap) f,   |f| <= mu n,        u' = (s' + kap D)/(1 + kap)

While the slip stays bounded its mean change is 0, so that the mean of u' is kap/(1 + kap) times
that of D, whatever the drive, friction and rebounds: friction conveys no ball. On a slope that is
steeper than (1 + kap) mu the slip runs away, and the mean of u' is that of D + mu n. Rolling
resistance c (a couple c r n against the turning) conveys: in pure rolling
u' = kap/(1 + kap) (D - c n sgn(u)), a block of friction c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask


class RollingContact(NamedTuple):
    """The contact of a round part with floor and wall; all fields broadcast.

    Attributes
    ----------
    share, factor : ndarray
        kap/(1 + kap) and kap = m r^2/I [1].
    static, kinetic : ndarray
        Static and kinetic friction coefficients of the floor.
    restitution : ndarray
        Restitution of impacts on the floor.
    resistance : ndarray
        Coefficient of rolling resistance.
    drag : ndarray
        Friction force of the wall on the face, over the weight [1].
    load : ndarray
        Mean load on the floor, over the weight [1].
    uphill : ndarray
        Gravity against the direction of travel, over gravity: sin(gamma) [1].
    along, normal : ndarray
        Peak acceleration of the drive along the track and normal to it, over gravity [1].
    """

    share: Array
    factor: Array
    static: Array
    kinetic: Array
    restitution: Array
    resistance: Array
    drag: Array
    load: Array
    uphill: Array
    along: Array
    normal: Array

    @property
    def pull(self) -> Array:
        """Size of gravity along the track, over gravity [1]."""
        return np.abs(self.uphill)

    @property
    def resisting(self) -> Array:
        """Mean force that keeps the part from running down, over its weight [1].

        Rolling resistance, or the floor's friction if that is less: the part then slides.
        """
        resisting: Array = np.minimum(self.resistance, self.static) * self.load + self.drag
        return resisting

    @property
    def free(self) -> Mask:
        """True where nothing resists the motion in the mean."""
        return np.asarray(self.resisting == 0)

    @property
    def runs_away(self) -> Mask:
        """True where gravity is more than what resists the motion, rolling or slipping."""
        return np.asarray(self.pull > self.resisting)

    @property
    def rolling_down(self) -> Array:
        """Mean acceleration downhill while the slip stays bounded, over gravity [1].

        kap/(1 + kap) (|sin(gamma)| - c n - w), with the load n and the wall's friction w; 0 where
        rolling resistance and wall hold the part.
        """
        left = self.pull - self.resistance * self.load - self.drag
        return np.asarray(self.share * np.maximum(left, 0.0))

    @property
    def slipping_down(self) -> Array:
        """Mean acceleration downhill once the slip runs away, over gravity [1].

        |sin(gamma)| - mu_k n - w, with the load n and the wall's friction w; 0 where kinetic
        friction would stop the part.
        """
        left = self.pull - self.kinetic * self.load - self.drag
        return np.asarray(np.maximum(left, 0.0))

    @property
    def unbounded_slip(self) -> Mask:
        """True where gravity is more than static friction can turn into rolling.

        |sin(gamma)| > ((1 + kap) mu_s - kap c) n + w, for c up to mu_s: rolling down takes the
        friction (|sin(gamma)| - w + kap c n)/(1 + kap). With a larger c the part does not turn.
        """
        turning = self.factor * np.maximum(self.static - self.resistance, 0.0)
        return np.asarray(self.pull > (self.static + turning) * self.load + self.drag)

    @property
    def lifts(self) -> Mask:
        """True where the part leaves the floor."""
        return np.asarray(np.abs(self.normal) > self.load)

    def at_ends(self, sign: float) -> tuple[Array, Array]:
        """Return push along the track and load on the floor at a peak of the drive [1].

        Both are accelerations over gravity.

        `sign` is 1 where the drive is at its peak, -1 where it is opposite.
        """
        return sign * self.along - self.uphill, self.load - sign * self.normal

    @property
    def traction(self) -> tuple[Array, Array]:
        """Bounds of the friction that rolling takes: the largest in a period, at least and at most.

        Both are friction over load times (1 + kap) [1], kap = m r^2/I. Where (1 + kap) mu_s reaches
        the second the part always rolls; where (1 + kap) times the larger of mu_s and c is below
        the first it slips at times. D is the push, w the wall's friction, c n the rolling
        resistance: the quotient (D -+ w +- kap c n)/n grows or falls steadily with the sine of the
        drive, so that its ends count. Infinite where the part leaves the floor.
        """
        least, most = np.zeros(()), np.zeros(())
        for sign in (1.0, -1.0):
            push, load = self.at_ends(sign)
            carried = np.where(load > 0, load, 1.0)
            resisted = self.factor * self.resistance + self.drag / carried
            ends = np.abs(push) / carried
            least = np.maximum(least, np.where(load > 0, ends - resisted, np.inf))
            most = np.maximum(most, np.where(load > 0, ends + resisted, np.inf))
        return least, most

    @property
    def surely_rolls(self) -> Mask:
        """True where the floor has the friction to roll at every instant of any motion."""
        return np.asarray(self.traction[1] <= (1 + self.factor) * self.static)

    @property
    def surely_slips(self) -> Mask:
        """True where it has too little at some instant of any motion."""
        enough = (1 + self.factor) * np.maximum(self.static, self.resistance)
        return np.asarray(self.lifts | (self.traction[0] > enough))
