"""A key of a service for tests: its text is known before it stands in the ledger."""

import http.client
import time
import urllib.request
import uuid
from pathlib import Path
from urllib.error import HTTPError

from vibrafeed.app.jobs.keys import hash_of, new_key
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.tables import KEYS
from waiting import PATIENCE, wait_for

KEY, HASH = new_key()
BEARER = {"Authorization": f"Bearer {KEY}"}


def give_key(data: Path, key: str = KEY) -> None:
    """Put a key of the role admin into the ledger of a data directory."""
    ledger = Ledger(data / "jobs.sqlite3")
    with ledger.database.transaction() as connection:
        about = {"id": uuid.uuid4().hex, "created": time.time(), "role": "admin"}
        connection.execute(KEYS.insert().values(**about, name=key[3:11], hash=hash_of(key)))
    ledger.close()


def lock(address: str, data: Path) -> None:
    """Give a key to a service that runs, and wait until it asks for one."""
    give_key(data)

    def is_locked() -> bool:
        try:
            urllib.request.urlopen(f"{address}/scenes", timeout=PATIENCE).close()
        except HTTPError as refused:
            return refused.code == http.client.UNAUTHORIZED
        return False

    wait_for(is_locked)
