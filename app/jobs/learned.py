"""Factors on prices by formula, one for each kind and method, learned from studies that ended.

A formula is wrong in the same way for all studies of a method on a machine. The ledger keeps the
last of each kind and method that ended; the median of their ratios is the factor on the next price.
"""

from __future__ import annotations

import statistics
import time
import uuid

from sqlalchemy import select

from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.tables import PRICES

KEPT = 31
"""Studies of each kind and method that are kept, the latest."""
FEWEST = 5
"""Studies from which on their median counts; fewer may be chance."""
LARGEST = 10.0
"""Largest factor, and the inverse of the smallest [1]."""
TELLING = 0.05
"""Shortest time that tells anything of a price [s]: shorter ones are those of files and labels."""


def learn(database: Database, name: str, stated: float, took: float) -> None:
    """Keep what a study was said to take by formula, and what it took on one core [s].

    `name` is its kind and method; `database` is the ledger's.
    """
    if took < TELLING or stated <= 0.0:
        return
    row = {"id": uuid.uuid4().hex, "name": name, "finished": time.time()}
    older = (
        select(PRICES.c.id)
        .where(PRICES.c.name == name)
        .order_by(PRICES.c.finished.desc(), PRICES.c.id)
        .offset(KEPT)
    )
    with database.transaction() as connection:
        connection.execute(PRICES.insert().values(**row, stated=stated, took=took))
        gone = [found.id for found in connection.execute(older)]
        connection.execute(PRICES.delete().where(PRICES.c.id.in_(gone)))


def factor(database: Database, name: str) -> float:
    """Return the factor on the price by formula of a study of a kind and method [1].

    The median of measured over stated times of the latest, from 1/10 to 10; 1 before there are
    five.
    """
    rows = database.read(select(PRICES.c.stated, PRICES.c.took).where(PRICES.c.name == name))
    if len(rows) < FEWEST:
        return 1.0
    found = statistics.median(row.took / row.stated for row in rows)
    return min(max(found, 1.0 / LARGEST), LARGEST)
