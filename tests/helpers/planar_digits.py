"""Mean velocities of planar motions to 20 digits, by a program of its own in mpmath.

`python tests/helpers/planar_digits.py` writes tests/data/planar_digits.json: where the errors that
`events` states are hard to state. Just above throw number 1, at huge friction, and just above the
threshold of slip with static above kinetic friction; and ordinary parts. It shares nothing with the
kernels but the laws: a part without restitution, flows in closed form, events by bisection on
monotone pieces.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from mpmath import asin, cos, floor, mp, mpf, pi, sin

PERIODS = 40
CONVERGED = 1e-17
TARGET = Path(__file__).parents[1] / "data" / "planar_digits.json"

mp.dps = 30
TURN = 2 * pi


def root(value: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Return where a function that changes its sign once between two phases is 0."""
    before = value(low) > 0
    while high - low > mpf(10) ** -27:
        middle = (low + high) / 2
        if (value(middle) > 0) == before:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def after(target: Any, phase: Any) -> list[Any]:
    """Return the next phases from `phase` on that are `target` modulo a turn."""
    first = floor((phase - target) / TURN)
    return [
        t for t in (target + (first + k) * TURN for k in range(3)) if t >= phase - mpf(10) ** -22
    ]


class Part:
    """One part: drive (c, s), gravity (gs, gn), friction at rest and in motion."""

    def __init__(self, cell: tuple[float, ...]):
        self.c, self.s, self.gs, self.gn, self.at_rest, self.sliding = map(mpf, cell)
        self.phase, self.u, self.x = mpf(0), mpf(0), mpf(0)
        self.way = 0  # of the slip; 0 in stick
        self.lift = asin(self.gn / self.s) if self.s > self.gn else None
        self.ends: list[tuple[Any, Any]] = []

    def normal(self, phase: Any) -> Any:
        """Return the normal force per mass of a part on the floor."""
        return self.gn - self.s * sin(phase)

    def push(self, phase: Any) -> Any:
        """Return what drives a part at rest along the track."""
        return self.c * sin(phase) - self.gs

    def run(self) -> tuple[Any, Any]:
        """Return the mean velocity of the last period, and its change from the one before."""
        while len(self.ends) < PERIODS:
            end = (len(self.ends) + 1) * TURN
            later = after(self.lift, self.phase + mpf(10) ** -20) if self.lift is not None else []
            stop = min([end, *later])
            if not (self.slide(stop) if self.way else self.rest(stop)):
                continue
            if stop == end:
                self.ends.append((self.x, self.u))
            else:
                self.fly()
        first, second, third = (x for x, _ in self.ends[-3:])
        return (third - second) / TURN, abs(third - 2 * second + first) / TURN

    def rest(self, stop: Any) -> bool:
        """Stick until a slip starts; return whether none does before the stop."""
        starts = []
        for way in (1, -1):
            drive = way * self.c + self.at_rest * self.s
            hold = self.at_rest * self.gn + way * self.gs
            if drive != 0 and abs(hold / drive) < 1:
                angle = asin(hold / drive)
                starts += [(t, way) for b in (angle, pi - angle) for t in after(b, self.phase)]
        soon = mpf(10) ** -12
        for phase, way in sorted(starts):
            if phase > stop:
                break
            hold = self.at_rest * self.normal(phase + soon)
            if way * self.push(phase + soon) > hold and self.normal(phase) >= 0:
                self.phase, self.way = phase, way
                return False
        self.phase = stop
        return True

    def slide(self, stop: Any) -> bool:
        """Slide until the velocity is 0; return whether it is not before the stop."""
        way, start, u = self.way, self.phase, self.u
        drive = self.c + way * self.sliding * self.s
        drag = self.gs + way * self.sliding * self.gn

        def velocity(t: Any) -> Any:
            return u + drive * (cos(start) - cos(t)) - drag * (t - start)

        def travel(t: Any) -> Any:
            d = t - start
            return u * d + drive * (cos(start) * d - sin(t) + sin(start)) - drag * d * d / 2

        turns = []
        if abs(drag) < abs(drive):
            angle = asin(drag / drive)
            turns = [t for b in (angle, pi - angle) for t in after(b, start) if start < t < stop]
        for low, high in pairwise([start, *sorted(turns), stop]):
            if way * velocity(high) > 0:
                continue
            if low == start and u == 0:  # it speeds up first
                low += (high - low) * mpf(10) ** -6
            end = root(lambda t: -way * velocity(t), low, high)
            self.x, self.u, self.phase = self.x + travel(end), mpf(0), end
            self.way = self.way_on(end)
            return False
        self.x, self.u, self.phase = self.x + travel(stop), velocity(stop), stop
        return True

    def way_on(self, phase: Any) -> int:
        """Return the way in which a part that has just stopped goes on."""
        push = self.push(phase)
        if abs(push) <= self.at_rest * self.normal(phase):
            return 0
        return 1 if push > 0 else -1

    def fly(self) -> None:
        """Fly from lift-off to the landing, without rebound."""
        start, u = self.phase, self.u

        def height(d: Any) -> Any:
            rise = d * cos(start) - (sin(start + d) - sin(start))
            return self.s * rise - self.gn * d * d / 2

        def travel(d: Any) -> Any:
            swing = cos(start) * d - (sin(start + d) - sin(start))
            return u * d + self.c * swing - self.gs * d * d / 2

        def velocity(d: Any) -> Any:
            return u + self.c * (cos(start) - cos(start + d)) - self.gs * d

        step = (pi - 2 * self.lift) / 40
        d = step
        while height(d) > 0:
            d += step
        d = root(lambda q: -height(q), d - step, d)
        while (end := (len(self.ends) + 1) * TURN) <= start + d:
            self.ends.append((self.x + travel(end - start), velocity(end - start)))
        speed = self.gn * d - self.s * (cos(start) - cos(start + d))
        self.x, self.u, self.phase = self.x + travel(d), velocity(d), start + d
        if self.normal(self.phase) < 0:
            raise ValueError("it lifts off again at once")
        impulse = self.sliding * speed
        sign = 1 if self.u > 0 else -1
        self.u = mpf(0) if abs(self.u) <= impulse else self.u - sign * impulse
        self.way = sign if self.u else self.way_on(self.phase)


def cells() -> dict[str, list[tuple[float, ...]]]:
    """Return the groups (c, s, gs, gn, mu_s, mu_k) of some parts of each family."""
    random = np.random.default_rng(3)
    families: dict[str, list[tuple[float, ...]]] = {"throw": [], "friction": [], "slip": []}
    for _ in range(10):
        slope, mu = math.tan(math.radians(random.uniform(15, 50))), random.uniform(0.3, 0.7)
        gamma = math.radians(random.uniform(0, 3))
        gs, gn = math.sin(gamma), math.cos(gamma)
        s = gn * (1 + 10.0 ** -random.uniform(2, 12))
        families["throw"].append((s / slope, s, gs, gn, mu, mu))
        s, mu = random.uniform(1.05, 2.5), 10.0 ** random.uniform(4, 9)
        families["friction"].append((s / slope, s, gs, gn, mu, mu))
        static, s = random.uniform(0.3, 0.6), random.uniform(0.2, 0.6)
        c = static * (1 - s) * (1 + 10.0 ** -random.uniform(6, 14))
        kinetic = static * random.uniform(0.4, 0.8)
        families["slip"].append((c, s, 0.0, 1.0, static, kinetic))
    families["any"] = [*ordinary()]
    return families


def ordinary() -> Iterator[tuple[float, ...]]:
    """Yield parts that stick, slip and hop, half of them with static above kinetic friction."""
    random = np.random.default_rng(7)
    for number in range(30):
        beta, gamma = math.radians(random.uniform(8, 70)), math.radians(random.uniform(-4, 4))
        s, mu = random.uniform(0.5, 3.0) * math.cos(gamma), random.uniform(0.15, 1.2)
        slope = math.sin(gamma), math.cos(gamma)
        yield (s / math.tan(beta), s, *slope, mu * (1.3 if number % 2 else 1.0), mu)


def main() -> None:
    """Write the velocities of all parts whose motion has settled."""
    found = []
    for family, parts in cells().items():
        for cell in parts:
            try:
                velocity, change = Part(cell).run()
            except ValueError:  # it hops on
                continue
            if change < CONVERGED:
                digits = mp.nstr(velocity, 20)
                found.append({"family": family, "groups": cell, "velocity": digits})
                print(family, digits)
    TARGET.parent.mkdir(exist_ok=True)
    TARGET.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
