"""One unilateral contact: force or separation, never both (theory 2.3).

A contact presses with a force per mass n >= 0 and opens with an acceleration a >= 0, one of which
is 0, where a = response * n + free. Friction can make the response negative; then there may be two
solutions or none (Painleve's paradox). The comparisons are exact, at 0 too.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array

SEPARATION, SLIDING, STICK, TWO_SOLUTIONS, NO_SOLUTION = 0.0, 1.0, 2.0, 3.0, 4.0
"""The cases. `contact_case` of `vibrafeed.core.mechanics.corner` adds STICK to those of `case`."""


def case(response: Array, free: Array) -> Array:
    """Return the case of a contact: number and kind of its forces n.

    n is the force per mass, a the acceleration that opens the gap [m s-2]: n >= 0,
    a = response n + free >= 0, and one of both is 0. `free` is a without a force, `response` what
    a unit of n adds to it [1].

    ========  =====  ================================  =============
    response  free   solutions                         case
    ========  =====  ================================  =============
    > 0       > 0    n = 0                             SEPARATION
    > 0       <= 0   n = -free/response                SLIDING
    < 0       > 0    both of these                     TWO_SOLUTIONS
    < 0       = 0    n = 0, grazing                    SLIDING
    < 0       < 0    none                              NO_SOLUTION
    = 0       > 0    n = 0                             SEPARATION
    = 0       = 0    every n >= 0                      TWO_SOLUTIONS
    = 0       < 0    none                              NO_SOLUTION
    ========  =====  ================================  =============
    """
    opens = np.where(response < 0, TWO_SOLUTIONS, SEPARATION)
    presses = np.where(response > 0, SLIDING, NO_SOLUTION)
    touches = np.where(response == 0, TWO_SOLUTIONS, SLIDING)
    return np.where(free > 0, opens, np.where(free < 0, presses, touches))


def contact_force(response: Array, free: Array) -> Array:
    """Return the contact force per mass, n = -free/response, of the solution that stays in contact.

    In m/s^2. `free` is the acceleration that opens the gap without a force [m s-2], `response` what
    a unit of n adds [1]. 0 in separation; NaN where there is no solution and where every n >= 0 is
    one.
    """
    solution = case(response, free)
    unknown = (solution == NO_SOLUTION) | (response == 0)
    with np.errstate(over="ignore"):  # next to response 0 the force may exceed every float
        quotient = -free / np.where(response == 0, 1.0, response)
    force = np.where(free == 0, 0.0, quotient)
    return np.where(solution == SEPARATION, 0.0, np.where(unknown, np.nan, force))
