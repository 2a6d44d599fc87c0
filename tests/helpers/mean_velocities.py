"""Worked mean velocities of known answers, as tests of kernels take them."""

import math
from types import SimpleNamespace

from benchmarks.known_answers import known_answers

GRAVITY = 9.8  # m s-2


class MeanVelocity(SimpleNamespace):
    """The mean velocity of a part that starts at rest on the floor; SI units, degrees."""

    value: float
    frequency: float
    amplitude: float

    @property
    def circular_frequency(self) -> float:
        """The circular frequency, 2 pi f [rad s-1]."""
        return 2.0 * math.pi * self.frequency

    @property
    def scaled(self) -> float:
        """The mean velocity in g/w, the unit of simulation methods."""
        return self.value * self.circular_frequency / GRAVITY

    def groups(self) -> dict[str, float]:
        """Return the groups of `vibrafeed.core.motion.method.Groups`, without those that are 0."""
        w = self.circular_frequency
        drive = self.amplitude * w * w / GRAVITY
        beta, gamma = math.radians(self.beta), math.radians(self.gamma)
        return {
            "drive_number_along": drive * math.cos(beta),
            "drive_number_normal": drive * math.sin(beta),
            "gravity_number_along": math.sin(gamma),
            "gravity_number_normal": math.cos(gamma),
            "friction_static": self.friction_static,
            "friction_kinetic": self.friction_kinetic,
            "restitution": self.restitution,
        }


MEAN_VELOCITIES = {
    one.title.partition(":")[0]: MeanVelocity(**one.study["parameters"], value=one.value)
    for one in known_answers("worked-values")
    if one.name.startswith("V-mean-velocity")
}
