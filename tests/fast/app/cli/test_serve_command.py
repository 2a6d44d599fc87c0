"""`vibrafeed serve` says in one line why it does not start, and changes nothing then."""

import json
import os
import socket
import tempfile
from types import SimpleNamespace

import pytest

from benchmarks.serving import free_port
from commands import run, tells

SERVE = "serve --port 0"


@pytest.fixture(autouse=True)
def served(here, monkeypatch):
    """Return the temporary folders of the services that would be running: here none runs."""
    found: list[str] = []
    monkeypatch.setattr(
        "vibrafeed.app.web.server.serve_until_stopped",
        lambda *_, **__: found.append(tempfile.gettempdir()),
    )
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(here))
    return found


def refused(line: str = SERVE) -> str:
    """Return the only line that the command prints."""
    (told,) = run(line, 2).stderr.splitlines()
    return told


def test_settings_come_from_the_environment(monkeypatch):
    monkeypatch.setenv("VIBRAFEED_MAX_CELLS", "1234")
    assert json.loads(run("serve --show-settings").output)["max_cells"] == 1234
    monkeypatch.setenv("VIBRAFEED_MAX_CELLS", "many")
    tells("serve --show-settings", "VIBRAFEED_MAX_CELLS", code=2)


def test_who_starts_it_by_hand_reads_which_address_to_open(monkeypatch):
    terminal = SimpleNamespace(stdout=SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr("vibrafeed.app.cli.serve.sys", terminal)
    port = free_port()
    words = f"Open http://127.0.0.1:{port}/ in a browser; Ctrl-C stops the service."
    tells(f"serve --port {port}", words)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("file", "it is not a directory"),
        ("file/data", "Not a directory"),
        ("/proc/data", "No such file"),  # where nobody makes any
        ("odd", "its jobs.sqlite3: unable to open database file"),
    ],
)
def test_a_data_directory_that_cannot_be_used(name, why, here, monkeypatch):
    (here / "file").touch()
    (here / "odd" / "jobs.sqlite3").mkdir(parents=True)
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(here / name))
    told = refused()
    assert told.startswith(f"The data directory {here / name} cannot be used: {why}")
    assert told.endswith("VIBRAFEED_DATA_DIRECTORY to a directory that can be written.")


def test_a_ledger_that_is_none_is_left_alone(here):
    ledger = here / "jobs.sqlite3"
    ledger.write_bytes(b"no ledger " * 1000)
    assert refused() == (
        f"The ledger is damaged: file is not a database. Restore the backup of {ledger}; studies "
        "and results are not affected."
    )
    assert ledger.read_bytes() == b"no ledger " * 1000


def test_temporary_files_go_to_the_data_directory_where_the_system_has_no_folder(
    here, monkeypatch, served
):
    monkeypatch.setenv("TMPDIR", "/proc/none")
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(
        tempfile, "_candidate_tempdir_list", lambda: [os.environ["TMPDIR"], "/proc/none"]
    )
    (here / "tmp").touch()
    assert f"{here} cannot be used: it can hold no folder for temporary" in refused()
    (here / "tmp").unlink()
    run(SERVE)
    assert served == [str(here / "tmp")]


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_an_empty_ledger_beside_studies_is_not_taken_for_a_new_one(here, served, host):
    (here / "studies" / ("0" * 64)).mkdir(parents=True)
    (here / "jobs.sqlite3").touch()
    told = refused(f"{SERVE} --host {host}")
    assert told.startswith(f"The ledger is empty, but {here / 'studies'} holds studies: ")
    assert "--new-ledger" in told
    run(f"{SERVE} --new-ledger")
    assert served


def test_a_port_that_is_taken(here):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert refused(f"serve --port {port}").startswith(f"Port {port} of 127.0.0.1 is taken.")
    assert list(here.iterdir()) == []
