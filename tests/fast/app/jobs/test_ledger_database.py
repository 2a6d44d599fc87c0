"""The database of the ledger: its tables, upgrades of older ones, what it says when it fails."""

import contextlib
import sqlite3

import pytest
from pydantic import ValidationError
from sqlalchemy import event, inspect

from vibrafeed.app.jobs import audit, database
from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.errors import DamagedLedgerError, LaterLedgerError
from vibrafeed.app.jobs.ledger import Ledger, Wanted
from vibrafeed.app.jobs.tables import TABLES, UPGRADES
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.settings import Settings

# The tables as they were before versions of them were kept.
OLD = """
CREATE TABLE IF NOT EXISTS work (
    key TEXT PRIMARY KEY,
    process TEXT NOT NULL,
    cells INTEGER NOT NULL,
    block_cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    bytes INTEGER NOT NULL,
    done INTEGER NOT NULL DEFAULT 0,
    seconds REAL NOT NULL DEFAULT 0,
    created REAL NOT NULL,
    began REAL,
    done_then INTEGER,
    owner TEXT,
    lease REAL NOT NULL DEFAULT 0
) STRICT;
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    process TEXT NOT NULL,
    state TEXT NOT NULL,
    cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    created REAL NOT NULL,
    started REAL,
    finished REAL,
    seconds REAL,
    problem TEXT
) STRICT;
CREATE INDEX IF NOT EXISTS jobs_by_key ON jobs (key);
CREATE INDEX IF NOT EXISTS jobs_by_time ON jobs (created);
CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state);
"""


def test_a_file_of_the_time_before_versions_keeps_its_jobs(tmp_path):
    path = tmp_path / "jobs.sqlite3"
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as old:
        old.execute("PRAGMA journal_mode = WAL")
        old.executescript(OLD)
        old.execute(
            "INSERT INTO work (key, process, cells, block_cells, blocks, bytes, done, created) "
            "VALUES ('k', 'sweep', 100, 10, 10, 1000, 3, 1.5)"
        )
        old.execute(
            "INSERT INTO jobs (id, key, process, state, cells, blocks, created) "
            "VALUES ('a', 'k', 'sweep', 'accepted', 100, 10, 1.5)"
        )
    ledger = Ledger(path)
    try:
        job = ledger.job("a")
        assert (job.state, job.done, job.created) == ("accepted", 3, 1.5)
        work = ledger.claim("server", 9.0)
        ledger.end(work, None, 1)
        assert ledger.job("a").state == "successful"
    finally:
        ledger.close()


def test_the_tables_that_upgrades_make_are_those_of_the_statements(tmp_path):
    book = Database(tmp_path / "jobs.sqlite3")
    try:
        with book.transaction() as connection:
            found = inspect(connection)
            assert set(found.get_table_names()) == set(TABLES.tables)
            for name, table in TABLES.tables.items():
                columns = {column["name"]: column for column in found.get_columns(name)}
                assert set(columns) == set(table.columns.keys())
                for column in table.columns:
                    if not column.primary_key:
                        assert columns[column.name]["nullable"] == column.nullable, column
    finally:
        book.close()


def has_further(path):
    """Return whether the table of a further upgrade is there."""
    book = Database(path)
    with book.transaction() as connection:
        found = inspect(connection).has_table("further")
    book.close()
    return found


def test_upgrades_are_carried_out_once_and_a_later_ledger_is_left_alone(tmp_path, monkeypatch):
    path = tmp_path / "jobs.sqlite3"
    later = (*UPGRADES, ("CREATE TABLE further (id {whole} NOT NULL) {strict}",))
    for upgrades in (UPGRADES, later, later):
        monkeypatch.setattr(database, "UPGRADES", upgrades)
        assert has_further(path) == (upgrades is later)
    monkeypatch.setattr(database, "UPGRADES", UPGRADES)
    with pytest.raises(LaterLedgerError, match="made by a later vibrafeed"):
        Database(path).transaction().__enter__()


def test_an_upgrade_that_fails_changes_nothing(tmp_path, monkeypatch):
    fault = (*UPGRADES, ("CREATE TABLE further (id INTEGER) STRICT", "nonsense"))
    with monkeypatch.context() as patch:
        patch.setattr(database, "UPGRADES", fault)
        with pytest.raises(sqlite3.Error):
            Ledger(tmp_path / "jobs.sqlite3").counts()
    assert not has_further(tmp_path / "jobs.sqlite3")


SCHEME = "postgresql:" + "//"


@pytest.mark.parametrize(
    "url",
    [
        "mysql:" + "//u:sesame@h/d",
        SCHEME + "u:sesame@h",
        SCHEME + "u:ses@ame@h/d",
        SCHEME + "u:ses/ame@h/d",
        SCHEME + "u:ses#ame@h/d",
        SCHEME + "u@h:sesame/d",
    ],
)
def test_a_url_that_is_wrong_is_refused_without_a_part_of_it(url):
    with pytest.raises(ValidationError) as refused:
        Settings(ledger_url=url)
    assert "ame" not in refused.value.errors(include_input=False)[0]["msg"].replace("name", "")


def test_a_password_is_shown_nowhere():
    settings = Settings(ledger_url=SCHEME + "u:sesame@127.0.0.1:9/d")
    assert "sesame" not in settings.model_dump_json() + repr(settings)
    ledger = Ledger(settings.ledger_url.get_secret_value())
    assert ledger.fault() == "The database of the ledger cannot be reached."
    ledger.close()


def test_a_damaged_file_is_found_at_the_start_and_when_it_is_read(tmp_path):
    path = tmp_path / "jobs.sqlite3"
    whole = Ledger(path)
    whole.counts()
    whole.database.check()
    assert whole.fault() is None
    whole.close()
    content, page = path.read_bytes(), 4096
    path.write_bytes(content[:page] + b"\x01" * (len(content) - page))  # the first names tables
    ledger = Ledger(path)
    for read in (ledger.counts, ledger.database.check):
        with pytest.raises(DamagedLedgerError):
            read()
    assert ledger.fault() == "The ledger is damaged: restore the backup."
    ledger.close()


def test_a_ledger_is_empty_until_something_is_entered(tmp_path):
    ledger = Ledger(tmp_path / "jobs.sqlite3")
    assert ledger.is_empty()
    audit.note(ledger.database, "", "post", "a study")
    assert not ledger.is_empty()
    ledger.close()


@pytest.mark.parametrize("states", [(), ("successful",)])
def test_a_page_of_many_jobs_is_found_without_sorting_them(tmp_path, states):
    ledger = Ledger(tmp_path / "jobs.sqlite3")
    for number in range(3):
        ledger.post(Task(str(number), "sweep", "", 1, 1, 1, 1, 0.0), finished_seconds=1.0)
    asked = []
    event.listen(
        ledger.database._engine(), "before_cursor_execute", lambda *a: asked.append(a[2:4])
    )
    (latest,) = ledger.jobs(limit=1)
    seen = Wanted(states=states, seen_by="one")
    ledger.jobs(seen, limit=10, after=(latest.created, latest.id))
    query, values = asked[-1]
    with contextlib.closing(sqlite3.connect(tmp_path / "jobs.sqlite3")) as file:
        plan = [row[3] for row in file.execute(f"EXPLAIN QUERY PLAN {query}", values)]
    assert any("USING INDEX jobs_by_" in step for step in plan), plan
    assert not any("TEMP B-TREE" in step for step in plan), plan
    ledger.close()
