"""The devices of a line, by the names of the numbers that a study gives of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from vibrafeed.core.mechanics import orienting
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.orienting import Matrix, PassedShares
from vibrafeed.core.scenes.scene import Equation, Function, arguments_of


@dataclass(frozen=True)
class Device:
    """The device at a place: what parts have to pass there, by the names of its numbers."""

    place: int
    numbers: tuple[str, ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that a device of an orienting line needs, without the shares.

        They are its own numbers, such as a wiper's height, with its place in the line behind the
        name, and sizes of the parts with which these are compared.
        """
        needs = {
            "wiper_height": ("aspect_sizes",), "gap_length": ("aspect_sizes",),
            "ledge_width": ("aspect_sizes", "centre_heights", "delta"),
            "rail_width": ("shank_diameter", "diameter"), "outlet_capacity": ("arrival_rate",),
        }  # fmt: skip
        more = [name for number in self.numbers for name in needs.get(number, ())]
        turns = ("turned_share", "turn") if self.turns else ()
        own = dict.fromkeys((*self.numbers, *turns))
        return (*(f"{number}_{self.place}" for number in own), *more)

    @property
    def turns(self) -> bool:
        """True if the device turns parts."""
        return bool({"turned_share", "turn"} & set(self.numbers))

    def number(self, name: str, parameters: dict[str, Any]) -> Array:
        """Return a number of the device from the parameters."""
        value: Array = parameters[f"{name}_{self.place}"]
        return value

    def matrix(self, aspects: int, parameters: dict[str, Any]) -> Matrix:
        """Return the effect of an orienting device on parts, as a matrix over their aspects.

        An aspect is a way in which a part lies. Entry j of row i is the share of the parts that
        arrive in aspect i and go on in aspect j, an array over cells; the others fall back.
        `aspects` is the number of aspects, `parameters` has the study's parameters and bundles by
        name, SI units.
        """
        tests = [self._kept(number, aspects, parameters) for number in self.numbers]
        tests = [kept for kept in tests if kept]
        matrix = orienting.unchanged(aspects)
        for kept in tests:
            matrix = orienting.product(matrix, orienting.test_of(kept))
        if "rail_width" in self.numbers:
            matrix = orienting.product(matrix, self._rail(parameters))
        if self.turns:
            share, turn = self.number("turned_share", parameters), self.number("turn", parameters)
            matrix = orienting.turning(matrix, share, turn, failed=bool(tests))
        return matrix

    def _kept(self, number: str, aspects: int, parameters: dict[str, Any]) -> list[Array]:
        """Return the share of each aspect that a test of the device passes; empty if it is none.

        An aspect is a way in which a part lies. `number` is the kind of the device's number, such
        as `wiper_height`, `aspects` is how many aspects there are, and `parameters` has sizes of
        parts and devices by name, SI units.
        """
        sizes: Sequence[orienting.Aspect] = parameters.get("aspect_sizes", ())
        if number == "wiper_height":
            height = self.number(number, parameters)
            return [orienting.passes_wiper(size, height) for size in sizes]
        if number == "gap_length":
            gap = self.number(number, parameters)
            return [orienting.passes_gap(size, gap) for size in sizes]
        if number == "passed_aspect":
            passed = self.number(number, parameters)
            return [orienting.passes_aspect(k, passed) for k in range(1, aspects + 1)]
        if number == "ledge_width":
            width, delta = self.number(number, parameters), parameters["delta"]
            both = zip(sizes, parameters["centre_heights"], strict=True)
            return [orienting.passes_ledge(size, centre, width, delta) for size, centre in both]
        return []

    def _rail(self, parameters: dict[str, Any]) -> Matrix:
        """Return the effect of two rails on turned parts, as a matrix over their aspects.

        The aspects are upright, on its side, inverted; entry j of row i is the share that goes from
        i to j. Parts on their side or inverted go on inverted if they hang by their head; all
        others fall. `parameters` has the width of the rails and the diameters of head and shank, SI
        units.
        """
        width = self.number("rail_width", parameters)
        hangs = orienting.hangs_on_rail(width, parameters["shank_diameter"], parameters["diameter"])
        zero = np.zeros(())
        return [[zero, zero, zero], [zero, zero, hangs], [zero, zero, hangs]]


@dataclass(frozen=True)
class DeviceLine:
    """A line of devices: what passes it.

    Attributes
    ----------
    devices : tuple of Device
        In the order of their places.
    aspects : int
        How many aspects parts have.
    ordered : bool
        Whether the study says in which order they stand.
    """

    devices: tuple[Device, ...]
    aspects: int
    ordered: bool

    def equation(self, gives: str, shares: str, source: str) -> Equation:
        """Return the equation of what passes of parts that arrive in these `shares`, a quantity."""
        own = [name for device in self.devices for name in device.inputs]
        needs = (shares, *own, *(["device_order"] * self.ordered))
        says = "Return what passes the devices of a line, one after another [1]."
        return Equation(gives, partial(self._passed, shares), source, needs=needs, says=says)

    def _passed(self, arriving: str, **values: Any) -> PassedShares:
        matrices = [device.matrix(self.aspects, values) for device in self.devices]
        outlets = [
            device.number("outlet_capacity", values)
            if "outlet_capacity" in device.numbers
            else None
            for device in self.devices
        ]
        shares, passed = values[arriving], orienting.unchanged(self.aspects)
        if self.ordered:
            matrices, outlets = self._in_order(matrices, outlets, values["device_order"])
        for matrix, outlet in zip(matrices, outlets, strict=True):
            passed = orienting.product(passed, matrix)
            if outlet is not None:
                taken = orienting.outlet_share(shares, passed, values["arrival_rate"], outlet)
                passed = [[one * taken for one in row] for row in passed]
        return orienting.passed(shares, passed)

    def _in_order(
        self, matrices: list[Matrix], outlets: list[Array | None], order: Array
    ) -> tuple[list[Matrix], list[Array | None]]:
        """Return matrices and outlet capacities of the devices, rearranged for each cell.

        Parameters
        ----------
        matrices : list of Matrix
            What each device does to parts: shares over cells, by aspect before and after.
        outlets : list of ndarray or None
            The capacities of the outlets [1/s]; None, a device without outlet, counts as infinite.
        order : ndarray
            For each cell the number, from 1, of a permutation of the devices, as
            `orienting.devices_in_order` counts them.

        Returns
        -------
        tuple of list
            The same lists, rearranged; a capacity is None where no device has an outlet.
        """
        capacities = [np.asarray(np.inf) if one is None else one for one in outlets]
        chosen: list[Matrix] = []
        at: list[Array | None] = []
        places = range(self.aspects)
        for device in orienting.devices_in_order(order, len(matrices)):
            pick = [device == k for k in range(len(matrices))]
            chosen.append(
                [[_pick(pick, [m[i][j] for m in matrices]) for j in places] for i in places]
            )
            at.append(
                None if all(o is None for o in outlets) else _pick(pick, capacities)
            )  # fmt: skip
        return chosen, at


def _pick(pick: list[Any], values: list[Array]) -> Array:
    """Return, in each cell, the one of several values whose mask is true there.

    `pick` has a mask for each of the `values`, arrays over cells that broadcast. Where no mask is
    true it is the first value.
    """
    picked = values[0]
    for mask, value in zip(pick[1:], values[1:], strict=True):
        picked = np.where(mask, value, picked)
    return picked


def end_of(name: str, function: Function, upper: bool, says: str) -> Equation:
    """Return the equation of the lesser or the larger value at both ends of a line's shares.

    `function` gives the output `name` from a `line`; `upper` is True for the larger one; `says`
    describes the output in words, with its unit.
    """

    def value(*, line_ends: tuple[PassedShares, PassedShares], **values: Any) -> Array:
        both = [function(line=line, **values) for line in line_ends]
        end: Array = (np.maximum if upper else np.minimum)(*both)
        return end

    needs = ("line_ends", *(one for one in arguments_of(function) if one != "line"))
    gives = f"{name}_{'upper' if upper else 'lower'}"
    says = f"Return the {'largest' if upper else 'least'} {says}."
    return Equation(gives, value, "theory 16.3", needs=needs, says=says)
