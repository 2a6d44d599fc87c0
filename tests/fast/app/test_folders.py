"""Where the service keeps what nobody has told it where to keep."""

from pathlib import Path

import pytest

from vibrafeed.app.cli.serve import _tell_of_older_data
from vibrafeed.app.folders import data_folder
from vibrafeed.app.settings import Settings


@pytest.mark.parametrize(
    ("platform", "data", "folder"),
    [
        ("linux", "", ".local/share/vibrafeed"),
        ("linux", "/srv/share", "/srv/share/vibrafeed"),
        ("linux", "share", ".local/share/vibrafeed"),  # no relative ones
        ("darwin", "", "Library/Application Support/vibrafeed"),
        ("win32", "/srv/share", "AppData/Local/vibrafeed"),  # the variable of others
    ],
)
def test_the_folder_is_that_of_the_platform(platform, data, folder, monkeypatch):
    home = Path("/home/ann")
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("LOCALAPPDATA", str(home / "AppData" / "Local"))
    monkeypatch.setenv("XDG_DATA_HOME", data)
    monkeypatch.delenv("VIBRAFEED_DATA_DIRECTORY", raising=False)
    assert data_folder() == home / folder
    assert Settings().data_directory == data_folder()
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", "/data")
    assert Settings().data_directory == Path("/data")


def test_a_user_without_home_has_a_folder_here(monkeypatch):
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: (_ for _ in ()).throw(RuntimeError("no home")))
    assert data_folder() == Path("data")


def test_studies_in_the_folder_of_before_are_named(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("VIBRAFEED_DATA_DIRECTORY", raising=False)
    monkeypatch.chdir(tmp_path)
    _tell_of_older_data(Settings())
    assert not capsys.readouterr().err
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "jobs.sqlite3").touch()
    _tell_of_older_data(Settings(data_directory=tmp_path / "elsewhere"))
    assert not capsys.readouterr().err
    _tell_of_older_data(Settings())
    assert str(tmp_path / "data") in capsys.readouterr().err.replace("\n", "")
