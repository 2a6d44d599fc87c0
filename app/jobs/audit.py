"""The audit table of the ledger: who posted, dismissed or shared what, and changes of keys."""

from __future__ import annotations

import time
import uuid
from typing import Any, Literal

from sqlalchemy import Row, select

from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.tables import AUDIT

MAX_ENTRIES = 100_000  # the latest; older ones go when the service tidies up

Action = Literal["post", "dismiss", "share", "unshare", "add key", "withdraw key", "refuse key"]


def note(database: Database, name: str, action: Action, object_: str) -> None:
    """Write an action of an API key into the audit log, in the transaction of the caller if any.

    Parameters
    ----------
    database : Database
        The ledger's.
    name : str
        Name of the key; empty where no keys are needed, or the key is unknown.
    action : str
        The action, such as `post`.
    object_ : str
        Its object: a job, a study, a key's name, or the address that a refused key came from.
    """
    entry = {"id": uuid.uuid4().hex, "time": time.time(), "name": name, "action": action}
    with database.transaction() as connection:
        connection.execute(AUDIT.insert().values(**entry, object=object_))


def latest(database: Database, most: int) -> list[Row[*tuple[Any, ...]]]:
    """Return the latest entries of the audit log, at most `most`, newest first.

    Each has `time` [s since the epoch], `name`, `action` and `object`, as `note` wrote them.
    """
    newest = select(AUDIT).order_by(AUDIT.c.time.desc(), AUDIT.c.id).limit(most)
    return database.read(newest)


def forget(database: Database, most: int = MAX_ENTRIES) -> None:
    """Remove all entries of the audit log but the latest `most`."""
    oldest = select(AUDIT.c.id).order_by(AUDIT.c.time.desc(), AUDIT.c.id).offset(most)
    with database.transaction() as connection:
        connection.execute(AUDIT.delete().where(AUDIT.c.id.in_(oldest)))
