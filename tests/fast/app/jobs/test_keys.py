"""Keys in the ledger: made, found, over, withdrawn; and the audit."""

import hashlib
import time

import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app as commands
from vibrafeed.app.jobs import audit, keys
from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.keys import InvalidKeyError, Key, Keys, NoSuchKeyError, hash_of


@pytest.fixture
def database(tmp_path):
    found = Database(tmp_path / "jobs.sqlite3")
    yield found
    found.close()


def test_a_key_is_found_by_its_hash_and_kept_nowhere(database, tmp_path):
    made, kept = Keys(database).add(Key("lab", "run", requests=3, jobs=2, cells=10, bytes=99), 1)
    assert kept.hash == hashlib.sha256(made.encode()).hexdigest()
    assert kept.ends == pytest.approx(kept.created + 86_400)
    other = Keys(database)
    other.refresh()
    assert other.of_hash(hash_of(made)) == kept
    assert other.of_hash(hash_of("vf_other")) is None
    database.close()
    assert made.encode() not in (tmp_path / "jobs.sqlite3").read_bytes()


def test_all_that_is_wrong_is_told_at_once(database):
    with pytest.raises(InvalidKeyError) as caught:
        Keys(database).add(Key("a b", "root", requests=0, jobs=-1, cells=0, bytes=10**19), 0)
    places = [problem.place for problem in caught.value.problems]
    assert places == ["name", "role", "requests", "jobs", "cells", "bytes", "days"]
    assert Keys(database).all() == []


def test_a_name_is_free_again_once_its_key_is_withdrawn_or_over(database):
    here = Keys(database)
    here.add(Key("lab", "run"))
    with pytest.raises(InvalidKeyError, match="exists already"):
        here.add(Key("lab", "read"))
    here.withdraw("lab")
    with pytest.raises(NoSuchKeyError):
        here.withdraw("lab")
    here.add(Key("lab", "read"), days=1e-6)
    time.sleep(0.1)
    here.add(Key("lab", "admin"))
    assert [key.in_force(time.time()) for key in here.all()] == [False, False, True]


def test_others_see_a_change_soon(database, monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(keys.time, "monotonic", lambda: clock[0])
    here, there = Keys(database), Keys(database)
    there.refresh()
    assert not there.are_needed
    made, _ = here.add(Key("lab", "run"))
    clock[0] = 0.9 * keys.CHECK_INTERVAL
    assert not there.is_due
    clock[0] = 1.1 * keys.CHECK_INTERVAL
    assert there.is_due
    there.refresh()
    assert there.of_hash(hash_of(made)).in_force(time.time())
    here.withdraw("lab")
    clock[0] = 2.3 * keys.CHECK_INTERVAL
    there.refresh()
    assert not there.of_hash(hash_of(made)).in_force(time.time())
    assert there.are_needed, "withdrawing the last key has opened the service"


def test_what_was_known_stays_while_the_ledger_cannot_be_read(database, monkeypatch):
    made, _ = Keys(database).add(Key("lab", "run"))
    found = Keys(database)
    found.refresh()

    def fails():
        raise OSError("gone")

    monkeypatch.setattr(found, "all", fails)
    monkeypatch.setattr(found, "_read_at", -100.0)
    found.refresh()
    assert found.of_hash(hash_of(made)) is not None
    never = Keys(database)
    monkeypatch.setattr(never, "all", fails)
    with pytest.raises(OSError, match="gone"):
        never.refresh()


def test_the_audit_keeps_the_latest(database):
    for number in range(5):
        audit.note(database, "lab", "post", str(number))
    assert [entry.object for entry in audit.latest(database, 2)] == ["4", "3"]
    audit.forget(database, most=3)
    assert [entry.object for entry in audit.latest(database, 10)] == ["4", "3", "2"]


class TestCommands:
    @pytest.fixture(autouse=True)
    def _directory(self, tmp_path, monkeypatch):
        monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))

    def run(self, *words):
        return CliRunner().invoke(commands, ["key", *words])

    def test_add_list_withdraw_audit(self, database):
        made = self.run("add", "lab", "--requests", "10", "--cells", "1e6", "--days", "90")
        assert made.exit_code == 0, made.output
        secret = made.output.split()[0]
        (kept,) = Keys(database).all()
        assert kept.hash == hash_of(secret)
        assert (kept.role, kept.requests, kept.cells, kept.jobs) == ("run", 10, 10**6, None)
        listed = self.run("list").output
        for word, is_told in {"lab": 1, "1,000,000": 1, secret: 0, kept.hash: 0}.items():
            assert (word in listed) == is_told
        assert self.run("withdraw", "lab").exit_code == 0
        assert "withdrawn" in self.run("list").output
        again = self.run("withdraw", "lab")
        assert again.exit_code == 2
        assert "There are none" in again.output
        told = self.run("audit").output
        assert told.index("add key") < told.index("withdraw key")

    def test_what_is_wrong_is_told(self, tmp_path, monkeypatch):
        words = ["add", "a b", "--role", "x", "--jobs", "0", "--cells", "1.5", "--bytes", "inf"]
        wrong = self.run(*words)
        assert (wrong.exit_code, "5 problems" in wrong.output) == (2, True)
        (tmp_path / "file").write_text("")
        monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path / "file"))
        wrong = self.run("list")
        assert (wrong.exit_code, len(wrong.output.splitlines())) == (2, 1)
